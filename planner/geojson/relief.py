"""A scenario set on its terrain.

Flights over terrain are level. With ``altitude_reference: terrain`` the level is ``altitude_m`` over the
highest ground of the regions; ground that comes within ``clearance_m`` of the level is a no-fly zone, flown
round like any other. What stands on the ground, threats and obstacles, is lifted or lowered to its ground, so
that every height in the scenario counts from home.
"""

from __future__ import annotations

import math
from dataclasses import replace

import shapely
from shapely.geometry.base import BaseGeometry

from planner.airspace.terrain import Ground, Terrain, local_ground
from planner.airspace.values import NoFlyZone, Obstacle, Threat
from planner.geojson.fields import Findings
from planner.scenario import Scenario

#: Kept over the ground where the scenario names no ``clearance_m``.
DEFAULT_CLEARANCE_M = 30.0
#: Without an operating area the flight may go this far beyond what is on the map; with one, only the look
#: at the ground beside it may.
OPEN_MARGIN_M = 5_000.0
AREA_MARGIN_M = 500.0
#: More zones than this are not worth flying round one by one.
MAX_ZONES = 200


def set_on_terrain(
    scenario: Scenario, terrain: Terrain, clearance_given: bool, findings: Findings
) -> Scenario:
    """The scenario with its ground, level and clearance; unchanged after a finding that refuses it.

    Parameters
    ----------
    clearance_given
        Whether the document named a clearance; else ``DEFAULT_CLEARANCE_M`` holds.
    """
    ground = local_ground(terrain, scenario.frame, _bounds(scenario))
    home_amsl_m = float(ground.at(scenario.start.position))
    highest_m = _highest(scenario, ground, findings)
    if highest_m is None:
        return scenario
    if ground.step_m > 1.5 * terrain.resolution_m and ground.step_m > 1.5:
        findings.warning(
            "terrain",
            "terrain-thinned",
            f"has posts every {terrain.resolution_m:.1f} m; over an area this large heights are taken every "
            f"{ground.step_m:.1f} m",
            "Draw a smaller operating area for finer ground.",
        )
    if terrain.datum not in ("EGM96", "EGM2008"):
        findings.warning(
            "terrain",
            "datum-unknown",
            f"has heights over {terrain.datum}, taken for heights over mean sea level",
            "Check them against a known height.",
        )
    reference_m = {"amsl": 0.0, "home": home_amsl_m, "terrain": highest_m}[scenario.altitude_reference]
    level_m = scenario.altitude_m + reference_m
    clearance_m = scenario.clearance_m if clearance_given else DEFAULT_CLEARANCE_M
    if level_m <= highest_m:
        findings.error(
            "scenario",
            "altitude-below-ground",
            f"the flight at {level_m:.0f} m amsl is not above the regions' ground, up to {highest_m:.0f} m",
            "Raise altitude_m.",
        )
        return scenario
    if scenario.altitude_reference == "terrain":
        findings.warning(
            "scenario",
            "terrain-level",
            f"the flight is level at {level_m:.1f} m amsl: {scenario.altitude_m:g} m over the highest ground "
            f"of the regions, {highest_m:.1f} m",
            "Give altitude_reference amsl for another level.",
        )
    else:
        clear_m = level_m - highest_m
        if clear_m < clearance_m:
            findings.warning(
                "scenario",
                "low-over-region",
                f"the flight is only {clear_m:.0f} m over the highest ground of the regions",
                "Raise altitude_m.",
            )
    return replace(
        scenario,
        altitude_m=level_m,
        altitude_reference="amsl",
        home_amsl_m=home_amsl_m,
        clearance_m=clearance_m,
        terrain=ground,
        no_fly=scenario.no_fly + _high_ground(scenario, ground, level_m - clearance_m),
        threats=tuple(_raised_threat(threat, ground, home_amsl_m) for threat in scenario.threats),
        obstacles=tuple(_raised_obstacle(obstacle, ground, home_amsl_m) for obstacle in scenario.obstacles),
    )


def _bounds(scenario: Scenario) -> tuple[float, float, float, float]:
    parts: list[BaseGeometry] = [region.area for region in scenario.regions]
    parts += [shapely.Point(end.position) for end in (scenario.start, scenario.end)]
    margin_m = OPEN_MARGIN_M
    if scenario.area is not None:
        parts.append(scenario.area)
        margin_m = AREA_MARGIN_M
    west, south, east, north = shapely.total_bounds(parts)
    return (west - margin_m, south - margin_m, east + margin_m, north + margin_m)


def _highest(scenario: Scenario, ground: Ground, findings: Findings) -> float | None:
    """Highest ground of all regions; None after a finding where some ground that must be known is not."""
    highest_m = -math.inf
    known = True
    ends = {end.name: shapely.Point(end.position).buffer(1.0) for end in (scenario.start, scenario.end)}
    for name, area in [(region.name, region.area) for region in scenario.regions] + list(ends.items()):
        top_m = ground.range_over(area)[1]
        if math.isnan(top_m):
            known = False
            findings.error(
                name,
                "terrain-gap",
                f"lies, in part, where the raster {ground.name} has no heights",
                "Use a raster that covers it, or fill the gap.",
            )
        elif name not in ends:
            highest_m = max(highest_m, top_m)
    return highest_m if known else None


def _high_ground(scenario: Scenario, ground: Ground, height_m: float) -> tuple[NoFlyZone, ...]:
    """Ground above a height, and ground unknown, as zones; the judge measures the clearance itself."""
    west, south, east, north = _bounds(scenario)
    within = shapely.box(west, south, east, north) if scenario.area is None else scenario.area
    parts = [part for zone in ground.above(height_m, within) for part in _without_holes(zone)]
    parts.sort(key=lambda polygon: -polygon.area)
    return tuple(
        NoFlyZone(f"terrain-{number}", part) for number, part in enumerate(parts[:MAX_ZONES], start=1)
    )


def _without_holes(zone: shapely.Polygon) -> list[shapely.Polygon]:
    """The zone cut through its holes: a fence knows outer rings alone."""
    if not zone.interiors:
        return [zone]
    west, south, east, north = zone.bounds
    cut_m = zone.interiors[0].centroid.x
    halves = (shapely.box(west, south, cut_m, north), shapely.box(cut_m, south, east, north))
    parts = [part for half in halves for part in shapely.get_parts(zone.intersection(half))]
    return [
        piece
        for part in parts
        if isinstance(part, shapely.Polygon) and part.area > 0.0
        for piece in _without_holes(part)
    ]


def _raised_threat(threat: Threat, ground: Ground, home_amsl_m: float) -> Threat:
    if math.isinf(threat.height_m):
        return threat
    there_m = float(ground.at(threat.centre))
    # Where its ground is unknown a threat reaches every height.
    top_m = math.inf if math.isnan(there_m) else threat.height_m + there_m - home_amsl_m
    return replace(threat, height_m=top_m)


def _raised_obstacle(obstacle: Obstacle, ground: Ground, home_amsl_m: float) -> Obstacle:
    top_m = ground.range_over(obstacle.area)[1]
    lift_m = math.inf if math.isnan(top_m) else top_m - home_amsl_m
    return replace(obstacle, base_m=obstacle.base_m + lift_m)
