"""Whether the line joins what it must: start, end and every collect."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from shapely.geometry import LineString, Point
from shapely.ops import substring

from planner.check.kinematics import LENGTH_TOLERANCE
from planner.check.places import PLACE_TOLERANCE_M, lonlat
from planner.plan import FlownPath, Plan, Violation
from planner.scenario import Scenario

#: A path's first and last edge may be the chord of an arc.
END_ANGLE_TOLERANCE_RAD = math.radians(3.0)


def terminal_violations(
    scenario: Scenario, path: FlownPath, line_m: NDArray[np.float64]
) -> Iterator[Violation]:
    """The path begins at the start and ends at the end, in their directions."""
    for terminal, place, direction in (
        (scenario.start, line_m[0], line_m[1] - line_m[0]),
        (scenario.end, line_m[-1], line_m[-1] - line_m[-2]),
    ):
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
            if off_rad > END_ANGLE_TOLERANCE_RAD:
                yield Violation(
                    "continuity",
                    terminal.name,
                    f"the path's direction at {terminal.name} is {math.degrees(off_rad):.1f}° off",
                    math.degrees(off_rad),
                    "deg",
                    lonlat(scenario, place),
                )


def collect_violations(
    scenario: Scenario, plan: Plan, path: FlownPath, line: LineString
) -> Iterator[Violation]:
    """Each collect lies on the path, where it says, straight and in its direction."""
    for collect in plan.collects_of(path.vehicle):
        (east0, north0), (east1, north1) = scenario.frame.to_local([place[:2] for place in collect.line])
        length_m = math.hypot(east1 - east0, north1 - north0)
        # Distances along the published line are those of arcs, the line's own are those of its chords: after
        # many turns a collect begins some metres sooner on the line than it says.
        allowed_m = PLACE_TOLERANCE_M + LENGTH_TOLERANCE * collect.start_m
        from_m = min(max(collect.start_m - allowed_m, 0.0), line.length)
        near = substring(line, from_m, collect.end_m + allowed_m)
        if isinstance(near, LineString):
            from_m += near.project(Point(east0, north0))
        flown = np.asarray(substring(line, from_m, from_m + length_m).coords)
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
