"""How high over the ground collects are flown: those that follow it, and those with a greatest height."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from planner.check.kinematics import LENGTH_TOLERANCE
from planner.check.places import PLACE_TOLERANCE_M, lonlat
from planner.check.stretches import Measured
from planner.plan import Collect, FlownPath, Plan, Violation
from planner.scenario import Scenario

Floats = NDArray[np.float64]

#: The height over ground that is asked for is the greatest; lines of straights come so much lower.
FOLLOWED_WITHIN_M = 4.0
#: Collects this many times as high over ground as asked for are told of.
MUCH_HIGHER = 1.25


def along(scenario: Scenario, plan: Plan, collect: Collect, step_m: float) -> tuple[Floats, Floats]:
    """Places evenly along a collect, no farther apart than a step, and the altitudes of the path there.

    Returns
    -------
    tuple of ndarray
        (N, 2) metres east and north, and (N,) over the plan's datum.
    """
    path = plan.path_of(collect.vehicle, collect.sortie)
    line = Measured(scenario.frame.to_local([place[:2] for place in path.line]))
    altitudes_m = np.array([place[2] for place in path.line])
    reached_m = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(line.along_m), np.diff(altitudes_m)))])
    start, end = scenario.frame.to_local([place[:2] for place in collect.line])
    low_m, high_m = np.interp([collect.start_m, collect.end_m], reached_m, line.along_m)
    # Distances of the plan are those of arcs, the line's own those of its chords.
    allowed_m = PLACE_TOLERANCE_M + LENGTH_TOLERANCE * float(low_m)
    from_m = line.nearest_m((float(start[0]), float(start[1])), low_m - allowed_m, high_m + allowed_m)
    length_m = float(np.hypot(*(end - start)))
    at_m = np.linspace(0.0, length_m, max(2, math.ceil(length_m / step_m) + 1))
    places = start + at_m[:, None] / max(length_m, 1e-9) * (end - start)
    return places, np.interp(from_m + at_m, line.along_m, altitudes_m)


def followed_violations(scenario: Scenario, plan: Plan, path: FlownPath) -> Iterator[Violation]:
    """Collects that follow the ground come nowhere lower over it than asked for, less ``FOLLOWED_WITHIN_M``.

    Where they come much higher, over ground steeper than is climbed, that is told; above the greatest height
    allowed it is a hard violation. Looked at no farther apart than half the ground's posts.
    """
    ground = scenario.terrain
    asked_m = {r.name: r.over_ground_m for r in scenario.regions if r.over_ground_m is not None}
    if ground is None or not asked_m:
        return
    for collect in plan.collects_of(path.vehicle):
        wanted_m = max((asked_m[name] for name in collect.regions if name in asked_m), default=0.0)
        places, altitudes_m = along(scenario, plan, collect, ground.step_m / 2.0)
        over_m = altitudes_m - ground.at(places)
        high = int(np.argmax(np.where(np.isnan(over_m), -np.inf, over_m)))
        cap_m = math.inf if scenario.max_height_m is None else scenario.max_height_m
        told_m = min(cap_m + PLACE_TOLERANCE_M, MUCH_HIGHER * wanted_m)
        if over_m[high] > told_m:
            limit = f", {cap_m:g} m are the most" if over_m[high] > cap_m else ""
            yield Violation(
                "collect-height",
                collect.roi,
                f"collect {collect.seq} comes to {over_m[high]:.0f} m over the ground, not {wanted_m:g} m"
                f"{limit}: it is steeper there than the aircraft climbs at its speed",
                float(over_m[high] - min(cap_m, wanted_m)),
                "m",
                lonlat(scenario, places[high]),
                hard=bool(over_m[high] > cap_m + PLACE_TOLERANCE_M),
            )
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


def ceiling_violations(scenario: Scenario, plan: Plan, path: FlownPath) -> Iterator[Violation]:
    """No level collect comes higher over the ground below it than ``max_height_m``, its ends included.

    Looked at no farther apart than half the ground's posts.
    """
    cap_m, ground = scenario.max_height_m, scenario.terrain
    if cap_m is None:
        return
    followed = {region.name for region in scenario.regions if region.over_ground_m is not None}
    for collect in plan.collects_of(path.vehicle):
        if followed.intersection(collect.regions):
            continue
        if ground is None:
            places, altitudes_m = along(scenario, plan, collect, math.inf)
            over_m = altitudes_m - (scenario.level.altitude_m - scenario.level.height_m)
        else:
            places, altitudes_m = along(scenario, plan, collect, ground.step_m / 2.0)
            over_m = altitudes_m - ground.at(places)
        high = int(np.argmax(np.where(np.isnan(over_m), np.inf, over_m)))
        if over_m[high] <= cap_m + PLACE_TOLERANCE_M:
            continue
        yield Violation(
            "collect-height",
            collect.roi,
            f"collect {collect.seq} comes to {over_m[high]:.1f} m over the ground, max_height_m is {cap_m:g}",
            float(np.nan_to_num(over_m[high] - cap_m, nan=cap_m)),
            "m",
            lonlat(scenario, places[high]),
        )
