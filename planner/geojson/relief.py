"""A scenario set on its terrain.

Passes over terrain are level, unless the flight follows the ground (``planner.geojson.followed``). With
``altitude_reference: terrain`` their level is ``altitude_m`` over the highest ground of the regions, a
region's own over its own highest ground. Ground that comes within ``clearance_m`` of a level is a no-fly zone
there, flown round like any other. What stands on the ground, threats and obstacles, is lifted or lowered to
its ground, so that all heights in the scenario count from home.
"""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from planner.airspace.shapes import without_holes
from planner.airspace.terrain import Ground, Terrain, local_ground
from planner.airspace.values import NoFlyZone, Obstacle, Threat
from planner.geojson.fields import Findings
from planner.geojson.followed import followed, may_follow
from planner.geojson.heights import Heights
from planner.scenario import Scenario
from planner.sensors.camera import CameraSensor
from planner.sensors.wanted import UnknownQualityError, wanted_of
from planner.wishes import Region

#: Kept over the ground where the scenario names no ``clearance_m``.
OVER_GROUND_M = 30.0
#: Without an operating area the flight may go this far beyond what is on the map; with one, only the look
#: at the ground beside it may.
OPEN_MARGIN_M = 5_000.0
AREA_MARGIN_M = 500.0
#: More zones than this are not worth flying round one by one.
MAX_ZONES = 200


def set_on_terrain(
    scenario: Scenario, terrain: Terrain, heights: Heights, clearance_given: bool, findings: Findings
) -> Scenario:
    """The scenario with its ground, level and clearance; unchanged after a finding that refuses it.

    Parameters
    ----------
    heights
        Between which those that nothing gives are chosen.
    clearance_given
        Whether the document named a clearance; else ``OVER_GROUND_M`` is kept over the ground.
    """
    ground = local_ground(terrain, scenario.frame, _bounds(scenario))
    home_amsl_m = float(ground.at(scenario.start.position))
    ranges_m = _ranges(scenario, ground, findings)
    if ranges_m is None:
        return scenario
    tops_m = {name: top_m for name, (_, top_m) in ranges_m.items()}
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
    clearance_m = scenario.clearance_m if clearance_given else OVER_GROUND_M
    reference = scenario.altitude_reference
    highest_m = max(tops_m.values())
    level_m = scenario.altitude_m + {"amsl": 0.0, "home": home_amsl_m, "terrain": highest_m}[reference]
    standing = replace(scenario, terrain=ground, over_ground_m=clearance_m)
    regions: list[Region] = []
    asked: list[Region] = []
    for region in scenario.regions:
        low_m, top_m = ranges_m[region.name]
        follows = scenario.terrain_following and may_follow(scenario, region)
        if follows:
            low_m = top_m - _beside_m(scenario, region, ground)
        given_m = level_m if heights.altitude_given else None
        if region.altitude_m is not None:
            over_m = {"amsl": 0.0, "home": home_amsl_m, "terrain": top_m}[reference]
            given_m = region.altitude_m + over_m
        of_top_m = None if given_m is None else given_m - top_m
        beside_m = 0.0 if follows else _lower_beside_m(scenario, region, ground, heights)
        chosen_m = heights.over_top_m(region, standing, top_m - low_m, of_top_m, findings, beside_m)
        asked.append(region if chosen_m is None else replace(region, altitude_m=chosen_m))
        if chosen_m is not None:
            regions.append(replace(region, altitude_m=top_m + chosen_m))
            continue
        if region.altitude_m is None or given_m is None:
            regions.append(region)
            continue
        regions.append(replace(region, altitude_m=given_m))
        if not _above(region.name, given_m, top_m, clearance_m, findings):
            return scenario
    if not heights.altitude_given:
        level_m = max((r.altitude_m for r in regions if r.altitude_m is not None), default=level_m)
    of_route = [tops_m[region.name] for region in regions if region.altitude_m is None]
    if of_route and heights.altitude_given:
        if not _above("scenario", level_m, max(of_route), clearance_m, findings):
            return scenario
        if reference == "terrain" and not scenario.terrain_following:
            findings.warning(
                "scenario",
                "terrain-level",
                f"the flight is level at {level_m:.1f} m amsl: {scenario.altitude_m:g} m over the highest "
                f"ground of the regions, {highest_m:.1f} m",
                "Give altitude_reference amsl for another level.",
            )
    lowest_amsl_m = None
    if scenario.terrain_following:
        found = followed(
            replace(scenario, regions=tuple(asked)), regions, ground, clearance_m, level_m, findings
        )
        if found is None:
            return scenario
        regions, level_m, lowest_amsl_m = found
    levels_m = [
        level_m if region.altitude_m is None else region.altitude_m
        for region in regions
        if region.over_ground_m is None
    ]
    return replace(
        scenario,
        regions=tuple(regions),
        altitude_m=level_m,
        altitude_reference="amsl",
        home_amsl_m=home_amsl_m,
        over_ground_m=clearance_m,
        terrain=ground,
        lowest_amsl_m=lowest_amsl_m,
        no_fly=scenario.no_fly + _high_ground(scenario, ground, sorted(set(levels_m)), clearance_m),
        threats=tuple(_raised_threat(threat, ground, home_amsl_m) for threat in scenario.threats),
        obstacles=tuple(_raised_obstacle(obstacle, ground, home_amsl_m) for obstacle in scenario.obstacles),
    )


def _beside_m(scenario: Scenario, region: Region, ground: Ground) -> float:
    """How much lower than below passes that follow it the ground beside them is, as far as photos show it."""
    sensor = scenario.sensor_for(region)
    try:
        most_m = min((wanted.height_m for wanted in wanted_of(region, sensor)), default=0.0)
    except UnknownQualityError:
        return 0.0
    return ground.relief_beside_m(region.area, sensor.swath_m(max(most_m, 0.0)) / 2.0)


def _lower_beside_m(scenario: Scenario, region: Region, ground: Ground, heights: Heights) -> float:
    """How much lower than all of it ground is that level passes over it end above: half a photo beyond."""
    known = region.sensor is None or any(each.name == region.sensor for each in scenario.sensors)
    sensor = scenario.sensor_for(region) if known else None
    if heights.max_m is None or not isinstance(sensor, CameraSensor):
        return 0.0
    reach_m = heights.max_m * math.tan(sensor.optics.half_height_rad)
    beyond_m = ground.posts_of(region.area.buffer(reach_m))[:, 2]
    lower_m = ground.range_over(region.area)[0] - np.nanmin(beyond_m)
    return max(float(lower_m), 0.0)


def _above(name: str, level_m: float, top_m: float, clearance_m: float, findings: Findings) -> bool:
    """Whether a level is above the ground seen from it; a warning where it is by less than is kept."""
    if level_m <= top_m:
        findings.error(
            name,
            "altitude-below-ground",
            f"the flight at {level_m:.0f} m amsl is not above the ground seen from it, up to {top_m:.0f} m",
            "Raise altitude_m.",
        )
        return False
    if level_m - top_m < clearance_m:
        findings.warning(
            name,
            "low-over-region",
            f"the flight is only {level_m - top_m:.0f} m over the highest ground of the regions",
            "Raise altitude_m.",
        )
    return True


def _bounds(scenario: Scenario) -> tuple[float, float, float, float]:
    parts: list[BaseGeometry] = [region.area for region in scenario.regions]
    parts += [shapely.Point(end.position) for end in (scenario.start, scenario.end, *scenario.bases)]
    margin_m = OPEN_MARGIN_M
    if scenario.area is not None:
        parts.append(scenario.area)
        margin_m = AREA_MARGIN_M
    west, south, east, north = shapely.total_bounds(parts)
    return (west - margin_m, south - margin_m, east + margin_m, north + margin_m)


def _ranges(scenario: Scenario, ground: Ground, findings: Findings) -> dict[str, tuple[float, float]] | None:
    """Lowest and highest ground of each region; None after a finding where some that must be known is not."""
    ranges_m: dict[str, tuple[float, float]] = {}
    known = True
    places = (scenario.start, scenario.end, *scenario.bases)
    ends = {end.name: shapely.Point(end.position).buffer(1.0) for end in places}
    for name, area in [(region.name, region.area) for region in scenario.regions] + list(ends.items()):
        low_m, top_m = ground.range_over(area)
        if math.isnan(top_m):
            known = False
            findings.error(
                name,
                "terrain-gap",
                f"lies, in part, where the raster {ground.name} has no heights",
                "Use a raster that covers it, or fill the gap.",
            )
        elif name not in ends:
            ranges_m[name] = (low_m, top_m)
    return ranges_m if known else None


def _high_ground(
    scenario: Scenario, ground: Ground, levels_m: list[float], clearance_m: float
) -> tuple[NoFlyZone, ...]:
    """Ground that comes too near to a level, and ground unknown, as zones up to below the next level.

    The judge measures the clearance itself.
    """
    west, south, east, north = _bounds(scenario)
    within = shapely.box(west, south, east, north) if scenario.area is None else scenario.area
    zones: list[NoFlyZone] = []
    # A flight that only follows the ground is kept out of what is not known of it.
    for level_m, next_m in pairwise([*(levels_m or [math.inf]), math.inf]):
        high = ground.above(level_m - clearance_m, within)
        parts = [part for zone in high for part in without_holes(zone)]
        parts.sort(key=lambda polygon: -polygon.area)
        zones += [
            NoFlyZone(
                f"terrain-{len(zones) + number}",
                part,
                ceiling_m=_ceiling_m(part, ground, next_m, clearance_m),
                of_ground=True,
            )
            for number, part in enumerate(parts[:MAX_ZONES], start=1)
        ]
    return tuple(zones)


def _ceiling_m(part: shapely.Polygon, ground: Ground, next_m: float, clearance_m: float) -> float:
    """Where it is high enough over the highest of it; under the next level, which has zones of its own."""
    if math.isinf(next_m):
        return math.inf
    below_m = math.nextafter(next_m, -math.inf)
    top_m = ground.range_over(part)[1]
    return below_m if math.isnan(top_m) else min(below_m, top_m + clearance_m)


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
    # Its base stays over its own ground: it says whether there is ground to be seen below it.
    return replace(obstacle, height_m=obstacle.height_m + lift_m)
