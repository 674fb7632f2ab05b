"""Where the aircraft may be: the operating area, zones and threats, and the ground below."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from shapely.geometry import LineString

from planner.airspace.shapes import hard_shapes, soft_shapes
from planner.check.places import PLACE_TOLERANCE_M, lonlat, middle
from planner.plan import FlownPath, Plan, Violation
from planner.scenario import Scenario


def place_violations(scenario: Scenario, path: FlownPath, line: LineString) -> Iterator[Violation]:
    """What of a line is outside the operating area, in a hard zone or in a soft threat."""
    if scenario.area is not None:
        outside = line.difference(scenario.area.buffer(PLACE_TOLERANCE_M))
        if not outside.is_empty:
            yield Violation(
                "area",
                path.vehicle,
                f"{outside.length:.1f} m are flown outside the operating area",
                float(outside.length),
                "m",
                middle(scenario, outside),
            )
    where = (scenario.airspace, scenario.level)
    for hard, shapes in ((True, hard_shapes(*where)), (False, soft_shapes(*where))):
        for shape in shapes:
            depth_m = shape.depth_m(line)
            if depth_m <= 0.0:
                continue
            inside = line.intersection(shape.polygon())
            yield Violation(
                "hard-zone" if hard else "soft-threat",
                shape.name,
                f"{inside.length:.1f} m are flown inside {shape.name}, up to {depth_m:.1f} m deep",
                float(inside.length),
                "m",
                middle(scenario, inside),
                hard=hard,
            )


def clearance_violations(
    scenario: Scenario, plan: Plan, path: FlownPath, line_m: NDArray[np.float64]
) -> Iterator[Violation]:
    """Height over the ground all along the line, no farther apart than half the ground's posts."""
    ground = scenario.terrain
    if ground is None:
        return
    altitude_m = np.array([place[2] for place in path.line])
    if plan.altitude_reference != "amsl":
        altitude_m = altitude_m + (scenario.home_amsl_m or 0.0)
    reached_m = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line_m, axis=0).T))])
    count = max(2, math.ceil(reached_m[-1] / (ground.step_m / 2.0)) + 1)
    at_m = np.union1d(np.linspace(0.0, reached_m[-1], count), reached_m)
    places = np.stack([np.interp(at_m, reached_m, line_m[:, k]) for k in (0, 1)], axis=1)
    clear_m = np.interp(at_m, reached_m, altitude_m) - ground.at(places)
    unknown = np.isnan(clear_m)
    if unknown.any():
        length_m = float(unknown.mean() * reached_m[-1])
        yield Violation(
            "terrain-clearance",
            path.vehicle,
            f"about {length_m:.0f} m are flown where the raster {ground.name} has no heights",
            length_m,
            "m",
            lonlat(scenario, places[int(np.argmax(unknown))]),
        )
    worst = int(np.argmin(np.where(unknown, np.inf, clear_m)))
    if clear_m[worst] < scenario.clearance_m:
        yield Violation(
            "terrain-clearance",
            path.vehicle,
            f"{clear_m[worst]:.1f} m over the ground, {scenario.clearance_m:g} m are to be kept",
            float(scenario.clearance_m - clear_m[worst]),
            "m",
            lonlat(scenario, places[worst]),
        )
