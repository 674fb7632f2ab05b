"""The judge of a line that no stage of ours has made: where it may be, how low, how tightly it turns."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from planner.check.clearance import clearance_violations, place_violations
from planner.check.kinematics import limit_violations
from planner.plan import FlownPath, LonLat, LonLatAlt, Plan, Violation
from planner.scenario import Scenario
from planner.vehicle.aircraft import Aircraft


def judge_line(
    scenario: Scenario,
    aircraft: Aircraft,
    plan: Plan,
    path: FlownPath,
    lines: Sequence[tuple[LonLatAlt, ...]],
) -> tuple[Violation, ...]:
    """What of a line is outside the area, in a zone, too near to the ground, or beyond its aircraft's limits.

    Parameters
    ----------
    plan
        Its altitudes count from home.
    lines
        The line as it may be flown, once with its corners cut and once through them; what several of them
        break is told once, at its worst.
    """
    found: dict[tuple[str, str], Violation] = {}
    for line in lines:
        if len(line) < 2:
            continue
        line_m = scenario.frame.to_local([place[:2] for place in line])
        heights_m = np.array([place[2] for place in line])
        for violation in (
            *place_violations(scenario, path, line_m, heights_m),
            *clearance_violations(scenario, plan, _along(path, line), line_m),
        ):
            key = (violation.constraint, violation.feature)
            if key not in found or violation.amount > found[key].amount:
                found[key] = violation
    flown = (path.length_m, path.duration_s, path.energy_wh)
    return (*found.values(), *limit_violations(aircraft, path, *flown))


def _along(path: FlownPath, line: tuple[LonLatAlt, ...]) -> FlownPath:
    return FlownPath(path.vehicle, line, (), path.length_m, path.duration_s, None, None)


def tight_turns(
    vehicle: str, limit_m: float, turns: Iterable[tuple[float, LonLat, int]], *, hard: bool = True
) -> Iterator[Violation]:
    """The tightest turn, where it is tighter than the aircraft flies, and how many more are."""
    tight = sorted(turn for turn in turns if turn[0] < limit_m)
    if tight:
        radius_m, where, item = tight[0]
        more = f", and {len(tight) - 1} more turns are too tight" if len(tight) > 1 else ""
        yield Violation(
            "turn-radius",
            vehicle,
            f"item {item} leaves room for a turn of {radius_m:.1f} m, the limit is {limit_m:.1f} m{more}",
            limit_m - radius_m,
            "m",
            where,
            hard,
        )
