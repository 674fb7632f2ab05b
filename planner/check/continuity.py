"""Whether the line joins what it must: start, end and every collect."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from shapely.geometry import LineString, Point

from planner.check.kinematics import LENGTH_TOLERANCE, MAX_ARC_EDGE_M
from planner.check.places import PLACE_TOLERANCE_M, lonlat
from planner.check.stretches import Measured
from planner.check.times import SPOT_M
from planner.plan import Collect, FlownPath, Plan, Violation
from planner.scenario import Scenario
from planner.sensors.camera import CameraSensor

#: Patterns that straight down are chords round a place.
RINGS = {"orbit", "spiral"}
#: Directions at the ends count as met up to this.
END_ANGLE_TOLERANCE_RAD = math.radians(1.0)


def terminal_violations(
    scenario: Scenario,
    path: FlownPath,
    line_m: NDArray[np.float64],
    radius_m: float,
    circling: Collection[str] = (),
    returning: Collection[str] = (),
) -> Iterator[Violation]:
    """The path begins at the start and ends at the end, in their directions.

    Where the flight ends in a circle, the path passes over the end before that. The first and the last edge
    may be chords of arcs of ``radius_m`` or wider, which begin and end off the chord's direction by half of
    what they turn.

    Parameters
    ----------
    circling
        Vehicles whose flight ends in a circle.
    returning
        Vehicles that come down where they started.
    """
    edges = np.diff(line_m, axis=0)
    flown = edges[np.hypot(edges[:, 0], edges[:, 1]) > SPOT_M]
    ends = [(scenario.start, line_m[0], flown[0])]
    circles_at_end = path.vehicle in circling
    if not circles_at_end:
        home = replace(scenario.start, position=scenario.start.ground, angle_rad=None)
        last = home if path.vehicle in returning else scenario.end
        ends.append((last, line_m[-1], flown[-1]))
    else:
        yield from _passed_over(scenario, LineString(line_m))
    for terminal, place, direction in ends:
        gap_m = math.dist(terminal.position, place)
        if gap_m > PLACE_TOLERANCE_M:
            yield Violation(
                "continuity",
                terminal.name,
                f"the path misses {terminal.name} by {gap_m:.2f} m",
                gap_m,
                "m",
                lonlat(scenario, place),
            )
        if terminal.angle_rad is not None:
            off_rad = abs(
                math.remainder(math.atan2(direction[1], direction[0]) - terminal.angle_rad, math.tau)
            )
            if off_rad > END_ANGLE_TOLERANCE_RAD + _chord_rad(math.hypot(*direction), radius_m):
                yield Violation(
                    "continuity",
                    terminal.name,
                    f"the path's direction at {terminal.name} is {math.degrees(off_rad):.1f}° off",
                    math.degrees(off_rad),
                    "deg",
                    lonlat(scenario, place),
                )


def _passed_over(scenario: Scenario, line: LineString) -> Iterator[Violation]:
    gap_m = line.distance(Point(scenario.end.position))
    if gap_m > PLACE_TOLERANCE_M:
        yield Violation(
            "continuity",
            scenario.end.name,
            f"the path misses {scenario.end.name} by {gap_m:.2f} m",
            gap_m,
            "m",
        )


def _chord_rad(edge_m: float, radius_m: float) -> float:
    """How far the direction at an end of an arc may be off its chord; none for edges too long for one."""
    return 0.0 if edge_m > MAX_ARC_EDGE_M else math.asin(min(1.0, edge_m / (2.0 * radius_m)))


def collect_violations(
    scenario: Scenario,
    plan: Plan,
    path: FlownPath,
    line: Measured,
    over_ground_m: Callable[[float], float],
    settle_m: float,
    radius_m: float,
) -> Iterator[Violation]:
    """Each collect lies on the path where it says, in its direction, and what is flown before is straight.

    Not between chords of a ring that are flown on within a quarter of a turn.

    Parameters
    ----------
    over_ground_m
        Distance over the ground along the line at a distance along it in three dimensions.
    radius_m
        Of the tightest turn.
    """
    quarter_m = 0.5 * math.pi * radius_m * (1.0 + LENGTH_TOLERANCE)
    ended_m: dict[str, float] = {}
    for collect in plan.collects_of(path.vehicle):
        (east0, north0), (east1, north1) = scenario.frame.to_local([place[:2] for place in collect.line])
        length_m = math.hypot(east1 - east0, north1 - north0)
        # Distances along the published line are those of arcs, the line's own are those of its chords: after
        # many turns a collect begins some metres sooner on the line than it says.
        start_m, end_m = over_ground_m(collect.start_m), over_ground_m(collect.end_m)
        allowed_m = PLACE_TOLERANCE_M + LENGTH_TOLERANCE * start_m
        from_m = line.nearest_m((east0, north0), start_m - allowed_m, end_m + allowed_m)
        flown = line.between(from_m, from_m + length_m)
        along = np.array([east1 - east0, north1 - north0]) / length_m
        offset = flown - np.array([east0, north0])
        across_m = np.abs(offset[:, 0] * along[1] - offset[:, 1] * along[0])
        ends_m = max(math.dist(flown[0], (east0, north0)), math.dist(flown[-1], (east1, north1)))
        off_m = max(float(across_m.max()), ends_m)
        if off_m > PLACE_TOLERANCE_M:
            yield Violation(
                "collect-straight",
                collect.roi,
                f"collect {collect.seq} and the path are {off_m:.2f} m apart",
                off_m,
                "m",
                collect.line[0][:2],
            )
        straight_m = _straight_before_m(line, from_m, (east0, north0), along)
        goes_on = start_m - ended_m.get(collect.roi, -math.inf) <= quarter_m and _in_a_ring(scenario, collect)
        ended_m[collect.roi] = end_m
        if straight_m < settle_m - PLACE_TOLERANCE_M and not goes_on:
            yield Violation(
                "settling",
                collect.roi,
                f"{straight_m:.1f} m before collect {collect.seq} are straight, {settle_m:.1f} m are wanted",
                settle_m - straight_m,
                "m",
                collect.line[0][:2],
            )


def _in_a_ring(scenario: Scenario, collect: Collect) -> bool:
    """Whether a collect is one of the chords that a region is flown round by."""
    sensor = scenario.suite.named(collect.sensor)
    patterns = [region.pattern for region in scenario.regions if region.name in collect.regions]
    straight_down = isinstance(sensor, CameraSensor) and sensor.tilt_rad == 0.0
    return straight_down and bool(patterns) and set(patterns) <= RINGS


def _straight_before_m(
    line: Measured, at_m: float, place: tuple[float, float], along: NDArray[np.float64]
) -> float:
    """How far back from a place on it a line is flown straight in a direction."""
    before = line.between(0.0, at_m)[::-1]
    offset = before - np.array(place)
    behind_m = -(offset @ along)
    across_m = np.abs(offset[:, 0] * along[1] - offset[:, 1] * along[0])
    off = (across_m > PLACE_TOLERANCE_M) | (np.diff(behind_m, prepend=-PLACE_TOLERANCE_M) < 0.0)
    first = int(np.argmax(off)) if off.any() else len(behind_m)
    return float(behind_m[:first].max(initial=0.0))
