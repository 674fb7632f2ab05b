"""The flight's heights: from the ground and back, no steeper than the aircraft climbs, level on passes."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from shapely.geometry import LineString, MultiLineString

from planner.check.times import SPOT_M
from planner.plan import Collect, FlownPath, PlanVehicle, Violation
from planner.scenario import Scenario

#: Rounding of coordinates makes a short edge look steeper than it is.
SLOPE_TOLERANCE_DEG = 0.05
HEIGHT_TOLERANCE_M = 0.05
#: Heights between collects are looked at so far apart.
TRANSIT_STEP_M = 20.0

Floats = NDArray[np.float64]


def slope_violations(
    path: FlownPath, vehicle: PlanVehicle, line_m: Floats, altitudes_m: Floats
) -> Iterator[Violation]:
    """The steepest edge, and climbs on the spot of what cannot hover."""
    over_ground_m = np.hypot(*np.diff(line_m, axis=0).T)
    rises_m = np.diff(altitudes_m)
    spot = over_ground_m <= SPOT_M
    if vehicle.type == "fixed_wing" and float(np.abs(rises_m[spot]).sum()) > HEIGHT_TOLERANCE_M:
        where = int(np.argmax(np.where(spot, np.abs(rises_m), 0.0)))
        yield Violation(
            "climb",
            path.vehicle,
            f"{abs(rises_m[where]):.1f} m are climbed on the spot, which a fixed wing cannot",
            float(abs(rises_m[where])),
            "m",
            path.line[where][:2],
        )
    slopes_deg = np.degrees(np.arctan2(np.abs(rises_m), np.where(spot, np.inf, over_ground_m)))
    worst = int(np.argmax(slopes_deg))
    if slopes_deg[worst] > vehicle.max_climb_deg + SLOPE_TOLERANCE_DEG:
        yield Violation(
            "climb",
            path.vehicle,
            f"a slope of {slopes_deg[worst]:.1f}°, the limit is {vehicle.max_climb_deg:g}°",
            float(slopes_deg[worst] - vehicle.max_climb_deg),
            "deg",
            path.line[worst][:2],
        )


def ground_violations(
    path: FlownPath, vehicle: PlanVehicle, altitudes_m: Floats, grounds_m: tuple[float, float]
) -> Iterator[Violation]:
    """The path begins on the ground, and ends there where it is to land.

    Parameters
    ----------
    grounds_m
        Altitude at its first place, of the ground or of an aircraft in the air, and of the ground at its
        last, over the plan's datum.
    """
    ends = [("begins", 0, grounds_m[0])]
    if vehicle.finish == "land":
        ends.append(("ends", -1, grounds_m[1]))
    for word, index, ground_m in ends:
        off_m = float(altitudes_m[index]) - ground_m
        if abs(off_m) > HEIGHT_TOLERANCE_M:
            yield Violation(
                "continuity",
                path.vehicle,
                f"the path {word} {off_m:.1f} m over the ground",
                abs(off_m),
                "m",
                path.line[index][:2],
            )


def level_violations(scenario: Scenario, collects: tuple[Collect, ...]) -> Iterator[Violation]:
    """Collects are flown level, but for those that are to follow the ground."""
    follow = _followed(scenario)
    for collect in collects:
        if follow.issuperset(collect.regions):
            continue
        rise_m = abs(collect.line[1][2] - collect.line[0][2])
        if rise_m > HEIGHT_TOLERANCE_M:
            yield Violation(
                "collect-level",
                collect.roi,
                f"collect {collect.seq} rises or falls by {rise_m:.2f} m",
                rise_m,
                "m",
                collect.line[0][:2],
            )


def altitude_violations(scenario: Scenario, collects: tuple[Collect, ...]) -> Iterator[Violation]:
    """Level collects are flown at the altitude that their regions ask for, else at the scenario's."""
    follow = _followed(scenario)
    asked_m = {
        region.name: scenario.altitude_m if region.altitude_m is None else region.altitude_m
        for region in scenario.regions
    }
    for collect in collects:
        if follow.issuperset(collect.regions):
            continue
        off_m = max(abs(collect.line[0][2] - asked_m[name]) for name in collect.regions)
        if off_m > HEIGHT_TOLERANCE_M:
            yield Violation(
                "collect-altitude",
                collect.roi,
                f"collect {collect.seq} is flown {off_m:.1f} m off the altitude asked for",
                off_m,
                "m",
                collect.line[0][:2],
            )


def transit_violations(
    scenario: Scenario,
    path: FlownPath,
    collects: tuple[Collect, ...],
    line_m: Floats,
    altitudes_m: Floats,
) -> Iterator[Violation]:
    """Between collects nothing is flown lower or higher than they are, but for what the scenario leaves open.

    Before the first and behind the last collect the flight comes from the ground, and goes there.
    """
    if not collects or scenario.lowest_amsl_m is not None:
        return
    steps_m = np.hypot(np.hypot(*np.diff(line_m, axis=0).T), np.diff(altitudes_m))
    reached_m = np.concatenate([[0.0], np.cumsum(steps_m)])
    first_m, last_m = min(c.start_m for c in collects), max(c.end_m for c in collects)
    marks_m = np.union1d(reached_m, np.arange(first_m, last_m, TRANSIT_STEP_M))
    marks_m = marks_m[(first_m <= marks_m) & (marks_m <= last_m)]
    places_m = np.column_stack([np.interp(marks_m, reached_m, line_m[:, k]) for k in (0, 1)])
    flown_m = np.interp(marks_m, reached_m, altitudes_m)
    own_m = [scenario.altitude_m if r.altitude_m is None else r.altitude_m for r in scenario.regions]
    low_m, high_m = np.full(len(marks_m), min(own_m)), np.full(len(marks_m), max(own_m))
    if scenario.band is not None:
        datum_amsl_m = scenario.level.amsl_m - scenario.level.altitude_m
        ground_m = np.full(len(marks_m), scenario.level.altitude_m - scenario.level.height_m)
        if scenario.terrain is not None:
            ground_m = scenario.terrain.at(places_m) - datum_amsl_m
        if scenario.band.low_m is not None:
            low_m = np.fmin(low_m, ground_m + scenario.band.low_m)
        if scenario.band.high_m is not None:
            high_m = np.fmax(high_m, ground_m + scenario.band.high_m)
    off_m = np.maximum(low_m - flown_m, flown_m - high_m)
    worst = int(np.argmax(off_m))
    if off_m[worst] > HEIGHT_TOLERANCE_M:
        lon, lat = (float(value) for value in scenario.frame.to_wgs84(places_m[worst : worst + 1])[0])
        yield Violation(
            "transit-height",
            path.vehicle,
            f"is at an altitude of {flown_m[worst]:.1f} m between collects, and {low_m[worst]:.1f} m to "
            f"{high_m[worst]:.1f} m are left open there",
            float(off_m[worst]),
            "m",
            (lon, lat),
        )


def _followed(scenario: Scenario) -> set[str]:
    """Regions whose collects follow the ground."""
    return {region.name for region in scenario.regions if region.over_ground_m is not None}


def phase_violations(path: FlownPath) -> Iterator[Violation]:
    """Phases follow each other over the whole path."""
    reached_m = 0.0
    for phase in path.phases:
        gap_m = abs(phase.start_m - reached_m)
        if gap_m > HEIGHT_TOLERANCE_M or phase.end_m < phase.start_m:
            yield Violation(
                "phases", path.vehicle, f"the phase {phase.kind} begins {gap_m:.2f} m off", gap_m, "m"
            )
        reached_m = phase.end_m
    if abs(reached_m - path.length_m) > HEIGHT_TOLERANCE_M:
        off_m = abs(reached_m - path.length_m)
        yield Violation(
            "phases", path.vehicle, f"the phases end {off_m:.2f} m off the path's end", off_m, "m"
        )


def between(line_m: Floats, heights_m: Floats, low_m: float, high_m: float) -> MultiLineString:
    """What of a line lies between two heights, both included."""
    lowest_m, highest_m = float(np.min(heights_m)), float(np.max(heights_m))
    if low_m <= lowest_m and highest_m <= high_m:
        return MultiLineString([line_m])
    if highest_m < low_m or high_m < lowest_m:
        return MultiLineString()
    parts: list[Floats] = []
    run: list[Floats] = []
    for (a, b), (h0, h1) in zip(pairwise(line_m), pairwise(heights_m), strict=True):
        first, last = _inside(float(h0), float(h1), low_m, high_m)
        if first > last:
            parts, run = _closed(parts, run), []
            continue
        if not run or first > 0.0:
            parts, run = _closed(parts, run), [a + first * (b - a)]
        run.append(a + last * (b - a))
        if last < 1.0:
            parts, run = _closed(parts, run), []
    return MultiLineString([LineString(part) for part in _closed(parts, run)])


def _inside(from_m: float, to_m: float, low_m: float, high_m: float) -> tuple[float, float]:
    """Between which parts of an edge its height lies between two; an empty interval where nowhere."""
    if from_m == to_m:
        return (0.0, 1.0) if low_m <= from_m <= high_m else (1.0, 0.0)
    parts = sorted(((low_m - from_m) / (to_m - from_m), (high_m - from_m) / (to_m - from_m)))
    return max(parts[0], 0.0), min(parts[1], 1.0)


def _closed(parts: list[Floats], run: list[Floats]) -> list[Floats]:
    """The parts, with one more where a run has two places."""
    return [*parts, np.array(run)] if len(run) > 1 else parts
