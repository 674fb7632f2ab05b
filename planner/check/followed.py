"""Collects that follow the ground: how high over it they are flown."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from planner.check.kinematics import LENGTH_TOLERANCE
from planner.check.places import PLACE_TOLERANCE_M, lonlat
from planner.check.stretches import Measured
from planner.plan import FlownPath, Plan, Violation
from planner.scenario import Scenario

Floats = NDArray[np.float64]

#: The height over ground that is asked for is the greatest; lines of straights come so much lower.
FOLLOWED_WITHIN_M = 4.0


def followed_violations(
    scenario: Scenario,
    plan: Plan,
    path: FlownPath,
    line: Measured,
    over_ground_m: Callable[[float], float],
    altitudes_m: Floats,
) -> Iterator[Violation]:
    """Collects that follow the ground come nowhere lower over it than asked for, less ``FOLLOWED_WITHIN_M``.

    How high they come is judged by what their photos are worth. Looked at no farther apart than half the
    ground's posts.

    Parameters
    ----------
    line, altitudes_m
        The flown line over the ground, and the altitudes of its vertices over the sea, (N,).
    over_ground_m
        Distance over the ground along the line at a distance along it in three dimensions.
    """
    ground = scenario.terrain
    asked_m = {r.name: r.over_ground_m for r in scenario.regions if r.over_ground_m is not None}
    if ground is None or not asked_m:
        return
    for collect in plan.collects_of(path.vehicle):
        wanted_m = max((asked_m[name] for name in collect.regions if name in asked_m), default=0.0)
        (east_m, north_m), last = scenario.frame.to_local([place[:2] for place in collect.line])
        allowed_m = PLACE_TOLERANCE_M + LENGTH_TOLERANCE * over_ground_m(collect.start_m)
        low_m, high_m = over_ground_m(collect.start_m), over_ground_m(collect.end_m)
        from_m = line.nearest_m((east_m, north_m), low_m - allowed_m, high_m + allowed_m)
        length_m = math.hypot(last[0] - east_m, last[1] - north_m)
        at_m = from_m + np.linspace(0.0, length_m, max(2, math.ceil(2.0 * length_m / ground.step_m) + 1))
        places = np.array([line.place(float(along_m)) for along_m in at_m])
        over_m = np.interp(at_m, line.along_m, altitudes_m) - ground.at(places)
        short_m = wanted_m - FOLLOWED_WITHIN_M - over_m
        worst = int(np.argmax(np.where(np.isnan(short_m), np.inf, short_m)))
        if not short_m[worst] <= PLACE_TOLERANCE_M:
            yield Violation(
                "collect-altitude",
                collect.roi,
                f"collect {collect.seq} is only {over_m[worst]:.1f} m over the ground, not {wanted_m:g} m",
                float(np.nan_to_num(short_m[worst], nan=wanted_m)),
                "m",
                lonlat(scenario, places[worst]),
            )
