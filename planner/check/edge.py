"""Where a flight comes nearer to the edge of the operating area than the autopilot keeps to its line.

Inside is inside, and nothing is wrong with such a plan. But the area goes up as a fence, and an aircraft that
is off its line crosses it there.
"""

from __future__ import annotations

from collections.abc import Iterator

import shapely
from shapely.geometry import LineString

from planner.check.places import PLACE_TOLERANCE_M, lonlat
from planner.errors import Finding
from planner.plan import Plan
from planner.scenario import Scenario


def near_edge(scenario: Scenario, plan: Plan) -> Iterator[Finding]:
    """A warning for each aircraft, with the place where it comes nearest.

    Of lines that leave the area the verdict tells. Distances are of the published lines, in metres.
    """
    area, kept_m = scenario.area, scenario.clearance_m
    if area is None:
        return
    for name in dict.fromkeys(path.vehicle for path in plan.paths):
        lines = [
            LineString(scenario.frame.to_local([place[:2] for place in path.line]))
            for path in plan.paths
            if path.vehicle == name
        ]
        nearest = min(lines, key=area.boundary.distance)
        away_m = float(area.boundary.distance(nearest))
        if away_m >= kept_m - PLACE_TOLERANCE_M or not area.covers(nearest):
            continue
        place = shapely.shortest_line(nearest, area.boundary).coords[0]
        lon_deg, lat_deg = lonlat(scenario, (place[0], place[1]))
        yield Finding(
            name,
            "edge-near",
            f"comes to {away_m:.1f} m from the edge of the operating area at {lat_deg:.6f}, {lon_deg:.6f}, "
            f"and {kept_m:g} m (clearance_m) are what it may be off its line: "
            "as a fence the edge may be crossed",
            "Draw the area larger there, or set clearance_m to what the aircraft really keeps to its line.",
            "warning",
        )
