"""When a flight in a given order takes off, and where it waits in the air, so that windows are kept.

As in ``schedule`` it lands as early as it can, and takes off as late as that landing allows. What is waited
in the air is flown in whole circles, so it takes as long as one circle at least.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from planner.dubins.path import Path, Segment
from planner.fleet.schedule import TOLERANCE_S
from planner.route import Pose
from planner.vehicle.model import FlightModel

#: Circles are so much wider than the tightest turn, so that no rounding makes them too tight.
EASY_TURN = 1.05
#: Circles that are waited in are no wider than so many of the least, the first that there is room for: few
#: wide ones are held better than many tight ones.
WIDEST = (4.0, 1.9)


@dataclass(frozen=True, slots=True)
class Due:
    """What a flight without waits does, seconds from lift-off, and when it may be by the plan's clock.

    ``held_s`` is as long as waiting before it takes at least, circles being whole. It may be no sooner than
    ``apart_s`` behind the end of another of the same flight, ``behind``.
    """

    start_s: float
    end_s: float
    opens_s: float = 0.0
    closes_s: float = math.inf
    held_s: float = 0.0
    behind: int | None = None
    apart_s: float = 0.0


@dataclass(frozen=True, slots=True)
class Timing:
    """When a flight lifts off, how long it waits before each stop, and by how much it is late at worst."""

    start_s: float
    waits_s: tuple[float, ...]
    late_s: float
    worst: int | None = None

    @property
    def waited_s(self) -> float:
        """In the air, all together."""
        return math.fsum(self.waits_s)


def timing(dues: Sequence[Due], ready_s: float, *, pinned: bool = False) -> Timing:
    """The timing of a flight that may lift off at ``ready_s``, and where it is ``pinned`` begins then."""
    waits_s, _, slack_s = _forward(dues, ready_s)
    start_s = ready_s if pinned else ready_s + max(0.0, min(slack_s, math.fsum(waits_s)))
    waits_s, late, _ = _forward(dues, start_s, whole=True)
    worst = max(range(len(dues)), key=lambda k: late[k], default=None)
    late_s = 0.0 if worst is None else max(late[worst], 0.0)
    return Timing(start_s, tuple(waits_s), late_s, worst if late_s > TOLERANCE_S else None)


def _forward(
    dues: Sequence[Due], start_s: float, *, whole: bool = False
) -> tuple[list[float], list[float], float]:
    """Waits before each stop, by how much each is late, and by how much a later start is no later landing."""
    waits_s: list[float] = []
    late: list[float] = []
    ends: list[float] = []
    slack_s = math.inf
    for due in dues:
        begins_s = start_s + math.fsum(waits_s) + due.start_s
        opens_s = due.opens_s if due.behind is None else max(due.opens_s, ends[due.behind] + due.apart_s)
        wait_s = max(opens_s - begins_s, 0.0)
        if whole and TOLERANCE_S < wait_s < due.held_s:
            wait_s = due.held_s
        waits_s.append(wait_s if wait_s > TOLERANCE_S else 0.0)
        ends_s = begins_s + waits_s[-1] + due.end_s - due.start_s
        late.append(ends_s - due.closes_s)
        ends.append(ends_s)
        slack_s = min(slack_s, due.closes_s - ends_s + math.fsum(waits_s))
    return waits_s, late, slack_s


def least_hold_s(model: FlightModel) -> float:
    """How long one circle takes at least."""
    return model.duration_s(Path((_circle(Pose(0.0, 0.0, 0.0), "left", _radius_m(model), 1),)))


def holds(pose: Pose, wait_s: float, model: FlightModel, told_s: float | None = None) -> tuple[Path, ...]:
    """Whole circles back to a pose that take this long, the fewest first, to the left and to the right.

    As many as for ``wait_s``, as wide as for ``told_s`` where that is given.
    """
    once_s, radius_m = least_hold_s(model), _radius_m(model)
    found: list[Path] = []
    for widest in WIDEST:
        turns = max(1, math.floor(wait_s / once_s / widest))
        if wait_s / (turns * once_s) > widest:
            turns += 1
        wider = max((wait_s if told_s is None else told_s) / (turns * once_s), 1.0)
        for side in ("left", "right"):
            found.append(Path((_circle(pose, side, radius_m * wider, turns),)))
    return tuple(dict.fromkeys(found))


def _radius_m(model: FlightModel) -> float:
    return EASY_TURN * model.turn_radius_m


def _circle(pose: Pose, side: str, radius_m: float, turns: int) -> Segment:
    length_m = math.tau * radius_m * turns
    return Segment("left" if side == "left" else "right", pose, length_m, radius_m)
