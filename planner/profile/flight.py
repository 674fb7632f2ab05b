"""The whole flight: legs, passes, rise and fall as pieces with heights and times; its phases."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from planner.dubins.path import Path, Segment
from planner.plan import PhaseKind
from planner.profile.heights import SAME_M, Heights
from planner.route import Pose

Times = Callable[[Sequence["Stretch"]], list[float]]


@dataclass(frozen=True, slots=True)
class Stretch:
    """A straight, an arc or a climb on the spot, with an even slope, within one phase.

    Parameters
    ----------
    segment
        Over the ground; None where it climbs on the spot, at ``pose``.
    at_m
        Distance over the ground at which it begins.
    start_altitude_m, end_altitude_m
        Over the flight's datum.
    collects
        Whether it is of a pass: missions name both ends of that.
    most_m_s
        It is flown no faster than this over the ground, where what flies it can be told so.
    """

    phase: PhaseKind
    pose: Pose
    segment: Segment | None
    at_m: float
    start_altitude_m: float
    end_altitude_m: float
    collects: bool = False
    most_m_s: float = math.inf

    @property
    def ground_m(self) -> float:
        """Length over the ground."""
        return 0.0 if self.segment is None else self.segment.length_m

    @property
    def length_m(self) -> float:
        """Length in three dimensions."""
        return math.hypot(self.ground_m, self.end_altitude_m - self.start_altitude_m)


@dataclass(frozen=True, slots=True)
class Flight:
    """A flight from lift-off to its end.

    Parameters
    ----------
    path, heights
        Over the ground, and the altitude along it.
    stretches
        Its pieces in flight order. ``starts_m``, in three dimensions, and ``starts_s`` are where and when
        each begins; last, the whole.
    bounds_m
        Distances over the ground at which phases change, as ``whole_flight`` has them.
    inserted_m
        Length over the ground of climbing and descending turns.
    """

    path: Path
    heights: Heights
    stretches: tuple[Stretch, ...]
    starts_m: tuple[float, ...]
    starts_s: tuple[float, ...]
    bounds_m: tuple[float, float, float, float]
    inserted_m: float

    @property
    def mission_m(self) -> tuple[float, float]:
        """Distances over the ground between which the mission phase lies."""
        return self.bounds_m[1:3]

    @property
    def length_m(self) -> float:
        """Whole length in three dimensions."""
        return self.starts_m[-1]

    @property
    def duration_s(self) -> float:
        """Whole duration."""
        return self.starts_s[-1]

    def along(self, ground_m: float) -> tuple[float, float]:
        """Distance in three dimensions and time at a distance over the ground; past climbs on the spot."""
        for k, stretch in enumerate(self.stretches):
            last = k == len(self.stretches) - 1
            if stretch.ground_m <= 0.0 or (ground_m > stretch.at_m + stretch.ground_m + SAME_M and not last):
                continue
            part = min(max((ground_m - stretch.at_m) / stretch.ground_m, 0.0), 1.0)
            return (
                self.starts_m[k] + part * (self.starts_m[k + 1] - self.starts_m[k]),
                self.starts_s[k] + part * (self.starts_s[k + 1] - self.starts_s[k]),
            )
        return self.starts_m[-1], self.starts_s[-1]

    def phases(self) -> list[tuple[PhaseKind, float, float, float, float]]:
        """Kind, and where and when it begins and ends, of each phase in turn."""
        found: list[tuple[PhaseKind, float, float, float, float]] = []
        for k, stretch in enumerate(self.stretches):
            end = (self.starts_m[k + 1], self.starts_s[k + 1])
            if found and found[-1][0] == stretch.phase:
                kind, start_m, _, start_s, _ = found[-1]
                found[-1] = (kind, start_m, end[0], start_s, end[1])
            else:
                found.append((stretch.phase, self.starts_m[k], end[0], self.starts_s[k], end[1]))
        return found


def whole_flight(
    path: Path,
    heights: Heights,
    bounds_m: tuple[float, float, float, float],
    passes_m: Sequence[tuple[float, float]],
    inserted_m: float,
    times: Times,
    lift_off_m: float,
) -> Flight:
    """A flight of its line, its heights and the distances at which phases change.

    Parameters
    ----------
    bounds_m
        Over the ground: where the take-off, the climbing turns, the mission and the descending turns end.
    passes_m
        Over the ground: where passes begin and end, in order.
    times
        Seconds that each stretch takes.
    lift_off_m
        What is climbed on the spot first counts as take-off up to this height; the rest as climb, unless the
        take-off runs on ahead.
    """
    take_off_m, climbed_m, mission_m, returned_m = bounds_m
    kinds: tuple[tuple[PhaseKind, float], ...] = (
        ("take_off", take_off_m),
        ("climb", climbed_m),
        ("mission", mission_m),
        ("return", returned_m),
        ("landing", math.inf),
    )
    stretches: list[Stretch] = []
    stretches += _up(path.start, heights.knots, take_off_m, lift_off_m)
    marks = sorted({at_m for at_m, _ in heights.knots} | {m for m in bounds_m if m < path.length_m})
    jumps = _jumps(heights.knots, path.length_m)
    begins_m = [begin_m for begin_m, _ in passes_m]
    at_m = 0.0
    for segment in path.segments:
        end_m = at_m + segment.length_m
        cuts = [at_m, *(m for m in marks if at_m + SAME_M < m < end_m - SAME_M), end_m]
        for first_m, last_m in pairwise(cuts):
            pose = segment.at(first_m - at_m)
            piece = replace(segment, start=pose, length_m=last_m - first_m)
            middle_m = 0.5 * (first_m + last_m)
            kind = next(kind for kind, until_m in kinds if middle_m < until_m)
            while jumps and jumps[0][0] < middle_m:
                there_m, *both_m = jumps.pop(0)
                stretches.append(Stretch(kind, pose, None, there_m, both_m[0], both_m[1]))
            # From within: at a place where it climbs on the spot the height is not one.
            low_m, high_m = heights.at([first_m + 2.0 * SAME_M, last_m - 2.0 * SAME_M])
            nearest = bisect_right(begins_m, middle_m) - 1
            collects = nearest >= 0 and middle_m < passes_m[nearest][1]
            stretches.append(Stretch(kind, pose, piece, first_m, float(low_m), float(high_m), collects))
        at_m = end_m
    stretches += _down(path.end, heights.knots)
    starts_m, starts_s = [0.0], [0.0]
    for stretch, time_s in zip(stretches, times(stretches), strict=True):
        starts_m.append(starts_m[-1] + stretch.length_m)
        starts_s.append(starts_s[-1] + time_s)
    return Flight(path, heights, tuple(stretches), tuple(starts_m), tuple(starts_s), bounds_m, inserted_m)


def _jumps(knots: tuple[tuple[float, float], ...], length_m: float) -> list[tuple[float, float, float]]:
    """Where between both ends a height is changed on the spot: at which distance, from and to where."""
    return [
        (at_m, from_m, to_m)
        for (at_m, from_m), (next_m, to_m) in pairwise(knots)
        if SAME_M < at_m < length_m - SAME_M and next_m - at_m <= SAME_M and abs(to_m - from_m) > SAME_M
    ]


def _up(
    pose: Pose, knots: tuple[tuple[float, float], ...], take_off_m: float, lift_off_m: float
) -> list[Stretch]:
    """What is climbed on the spot at the beginning."""
    (_, ground_m), (at_m, top_m) = knots[:2]
    if at_m > SAME_M or top_m - ground_m <= SAME_M:
        return []
    between_m = top_m if take_off_m > 0.0 else min(ground_m + lift_off_m, top_m)
    found = [Stretch("take_off", pose, None, 0.0, ground_m, between_m)]
    if top_m - between_m > SAME_M:
        found.append(Stretch("climb", pose, None, 0.0, between_m, top_m))
    return found


def _down(pose: Pose, knots: tuple[tuple[float, float], ...]) -> list[Stretch]:
    """What is descended on the spot at the end."""
    (before_m, top_m), (end_m, ground_m) = knots[-2:]
    if end_m - before_m > SAME_M or top_m - ground_m <= SAME_M:
        return []
    return [Stretch("landing", pose, None, end_m, top_m, ground_m)]
