"""A scenario whose passes follow the ground: which regions, how high over it, and between which heights."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import shapely

from planner.airspace.envelope import SMOOTH_M
from planner.airspace.terrain import Ground
from planner.geojson.fields import Findings
from planner.scenario import Scenario
from planner.sensors.registry import KINDS
from planner.wishes import Region


def followed(
    scenario: Scenario,
    regions: Sequence[Region],
    ground: Ground,
    clearance_m: float,
    level_m: float,
    findings: Findings,
) -> tuple[list[Region], float, float] | None:
    """Regions with the height over ground of their passes, and between which altitudes the flight lies.

    Regions of sensors that want level passes get the altitude that they would have on a level flight.

    Parameters
    ----------
    regions
        Their altitudes over mean sea level, each over its own ground.
    level_m
        Altitude of the scenario, likewise.

    Returns
    -------
    tuple or None
        Regions, the highest and the lowest altitude over mean sea level; None after a finding.
    """
    if scenario.altitude_reference != "terrain":
        findings.error(
            "scenario",
            "terrain-following",
            f"follows the terrain, but altitude_m counts over {scenario.altitude_reference}",
            "Set altitude_reference to terrain: altitude_m is the height over the ground below.",
        )
        return None
    found: list[Region] = []
    asked = {region.name: region.altitude_m for region in scenario.regions}
    for region in regions:
        if not may_follow(scenario, region):
            found.append(region if region.altitude_m is not None else replace(region, altitude_m=level_m))
            continue
        height_m = scenario.altitude_m if asked[region.name] is None else asked[region.name]
        if height_m is None or height_m - 2.0 * SMOOTH_M < clearance_m:
            findings.error(
                region.name,
                "altitude-below-clearance",
                f"is to be seen from {height_m:g} m over the ground, of which {clearance_m:g} m are kept "
                f"clear and {2.0 * SMOOTH_M:g} m are how well it is followed",
                f"Raise altitude_m to {clearance_m + 2.0 * SMOOTH_M:g} m or more, or lower clearance_m.",
            )
            return None
        found.append(replace(region, altitude_m=None, over_ground_m=height_m))
    follow_m = [region.over_ground_m for region in found if region.over_ground_m is not None]
    if not follow_m:
        findings.warning(
            "scenario",
            "terrain-following",
            "follows the terrain, but no region is seen by a sensor that may: passes are level",
            "Leave terrain_following out.",
        )
        return found, level_m, level_m
    places = [region.area for region in found]
    ends = [shapely.Point(end.position) for end in (scenario.start, scenario.end, *scenario.bases)]
    # Between regions the flight keeps over what lies there.
    low_m, high_m = ground.range_over(shapely.union_all([*places, *ends]).convex_hull)
    return found, max(high_m + max(*follow_m, clearance_m), level_m), low_m + min(*follow_m, clearance_m)


def may_follow(scenario: Scenario, region: Region) -> bool:
    """Whether the sensor of a region sees it from passes that follow the ground."""
    sensor = next((s for s in scenario.sensors if s.name == region.sensor), scenario.sensors[0])
    return KINDS[sensor.kind].follows
