"""The height of home, and what is to be kept clear at every height while it is unknown.

A zone's floor and ceiling count from the sea, obstacles and threats from the ground: which of them a flight
meets depends on how high home is, unless both count from the same.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from planner.airspace.values import NoFlyZone
from planner.geojson.features import RawFeature
from planner.geojson.fields import Findings, is_finite
from planner.scenario import Scenario

RULE = "home-height-unknown"
FIX = "Give the start a third coordinate, its height above mean sea level in metres."
#: Without terrain the ground is flat at the height of home: bases may say so much else of it.
FLAT_M = 5.0


def home_amsl_m(raws: Sequence[RawFeature], start: str) -> float | None:
    """The third coordinate of the place where the flight starts, where given."""
    own = (_height_m(raw) for raw in raws if raw.role in ("start", "base") and raw.name == start)
    return next((height_m for height_m in own if height_m is not None), None)


def _height_m(raw: RawFeature) -> float | None:
    """The third coordinate of a place."""
    coordinates = raw.geometry.get("coordinates")
    if not isinstance(coordinates, list) or len(coordinates) < 3 or not is_finite(coordinates[2]):
        return None
    return float(coordinates[2])


def check_flat(raws: Sequence[RawFeature], scenario: Scenario, findings: Findings) -> None:
    """Refuse places of one scenario without terrain whose ground is not at one height.

    Heights of such a mission are over the vehicle's own home: flown from a base so much higher, or lower, all
    of it would be as much higher, or lower, than planned, and a landing elsewhere end in the ground or above
    it.
    """
    used = {terminal.name for terminal in scenario.terminals()} | {scenario.start.name}
    told = [
        (raw.name, height_m)
        for raw in raws
        if raw.role in ("start", "end", "base")
        and raw.name in used
        and (height_m := _height_m(raw)) is not None
    ]
    told.sort(key=lambda each: each[0] != scenario.start.name)
    for name, height_m in told[1:]:
        if abs(height_m - told[0][1]) <= FLAT_M:
            continue
        findings.error(
            name,
            "ground-not-flat",
            f"lies at {height_m:g} m, and {told[0][0]} at {told[0][1]:g} m: without terrain the ground is "
            "flat at the height of home; a vehicle that takes off elsewhere flies as much higher or lower",
            "Name an elevation raster as terrain: heights are over the ground of each base then.",
        )


def kept_clear(scenario: Scenario, findings: Findings) -> Scenario:
    """The scenario with nothing left that depends on an unknown height of home, and a warning of each."""
    if scenario.home_amsl_m is not None:
        return scenario
    if scenario.altitude_reference == "amsl":
        return _over_unknown_ground(scenario, findings)
    zones = []
    for zone in scenario.no_fly:
        if math.isinf(zone.floor_m) and math.isinf(zone.ceiling_m):
            zones.append(zone)
            continue
        _warn(
            zone.name,
            f"{_band(zone)} above the sea, and the flight's height from {scenario.altitude_reference}",
            findings,
        )
        zones.append(replace(zone, floor_m=-math.inf, ceiling_m=math.inf))
    return replace(scenario, no_fly=tuple(zones))


def _over_unknown_ground(scenario: Scenario, findings: Findings) -> Scenario:
    findings.warning(
        "scenario",
        RULE,
        "altitude_reference amsl without the height of home: the ground is taken to be at sea level",
        FIX,
    )
    for threat in scenario.threats:
        if math.isfinite(threat.height_m):
            _warn(threat.name, "its height_m counts from the ground, and the flight's from the sea", findings)
    for obstacle in scenario.obstacles:
        _warn(obstacle.name, "its height_m counts from the ground, and the flight's from the sea", findings)
    return replace(
        scenario,
        threats=tuple(replace(threat, height_m=math.inf) for threat in scenario.threats),
        obstacles=tuple(replace(obstacle, height_m=math.inf) for obstacle in scenario.obstacles),
    )


def _warn(name: str, why: str, findings: Findings) -> None:
    findings.warning(
        name, RULE, f"is kept clear at every height: {why}, with the height of home unknown", FIX
    )


def _band(zone: NoFlyZone) -> str:
    ends = [
        f"its {name} counts"
        for name, end_m in (("floor_m", zone.floor_m), ("ceiling_m", zone.ceiling_m))
        if math.isfinite(end_m)
    ]
    return ends[0] if len(ends) == 1 else "its floor_m and ceiling_m count"
