"""What can be planned and is hardly meant: told, not refused."""

from __future__ import annotations

import math

import numpy as np
from shapely.geometry import Point

from planner.geojson.fields import Findings
from planner.scenario import Scenario
from planner.sensors.camera import CameraSensor
from planner.sensors.cameras import hangs_level

#: Photos are hardly meant from higher.
HIGH_M = 1_500.0
#: A lean of what hovers that its effect is told for.
LEAN_RAD = math.radians(5.0)
#: From this part of the airspeed on a wind decides the flight.
NEAR_AIRSPEED = 0.6
#: Flight from the start to the nearest region, and of the whole, that is more than most are meant to be.
FAR_S, LONG_S = 1800.0, 7200.0
#: A place farther from the others than this, that is so much nearer with its axes exchanged, looks swapped.
AWAY_M, NEARER = 20_000.0, 0.2


def check_plausible(scenario: Scenario, findings: Findings) -> None:
    """Warnings of what looks like a slip of the pen."""
    if not scenario.aircraft or not scenario.regions:
        return
    airspeed_m_s = min(aircraft.airspeed_m_s for aircraft in scenario.aircraft)
    wind_m_s = scenario.wind.speed_m_s
    _wind(airspeed_m_s, wind_m_s, findings)
    if wind_m_s < airspeed_m_s:
        # There and back in a wind takes this speed's time at best, whatever the direction.
        _times(scenario, math.sqrt(airspeed_m_s**2 - wind_m_s**2), findings)
    _swapped(scenario, findings)
    _high(scenario, findings)
    _bolted(scenario, findings)


def _bolted(scenario: Scenario, findings: Findings) -> None:
    """Cameras without a gimbal under rotors, which lean by what nobody has stated."""
    for sensor in scenario.sensors:
        if not isinstance(sensor, CameraSensor) or hangs_level(sensor.model):
            continue
        if sensor.stabilised or sensor.steady_overlap:
            continue
        seen = [region for region in scenario.regions if scenario.sensor_for(region) is sensor]
        rotors = [each.name for each in scenario.aircraft if each.hovers and each.carries(sensor.name)]
        if not seen or not rotors:
            continue
        high_m = max(
            scenario.level.of(each).height_m if each.over_ground_m is None else each.over_ground_m
            for each in seen
        )
        into = "its way" if scenario.wind.speed_m_s == 0.0 else "its way and the wind"
        findings.warning(
            f"sensor {sensor.name}",
            "leans",
            f"has no gimbal that is known of: bolted to {rotors[0]} it looks aside of the ground below by as "
            f"much as that leans into {into}, from {high_m:.0f} m by {high_m * math.tan(LEAN_RAD):.0f} m for "
            f"{math.degrees(LEAN_RAD):g}°, and less sharply at the far edge; it is planned as if it looked "
            "straight down, so that less may be seen as sharply as planned",
            "Hang it in a gimbal (stabilised: true, or a model that comes in one), or state how far it leans "
            "as pointing_margin_deg.",
        )


def _high(scenario: Scenario, findings: Findings) -> None:
    """Cameras so high that a length was meant in another unit."""
    for region in scenario.regions:
        sensor, level = scenario.sensor_for(region), scenario.level.of(region)
        height_m = level.height_m if region.over_ground_m is None else region.over_ground_m
        if isinstance(sensor, CameraSensor) and height_m > HIGH_M:
            asked = f", for gsd_m {region.gsd_m:g}" if region.gsd_m is not None else ""
            findings.warning(
                region.name,
                "height-unlikely",
                f"is to be photographed from {height_m:.0f} m{asked}",
                "Lengths are metres: 2.5 cm a pixel is gsd_m 0.025. Give max_height_m to stay lower.",
            )


def _wind(airspeed_m_s: float, wind_m_s: float, findings: Findings) -> None:
    if not NEAR_AIRSPEED * airspeed_m_s <= wind_m_s < airspeed_m_s:
        return
    findings.warning(
        "wind",
        "wind-near-airspeed",
        f"blows at {wind_m_s:g} m/s, {100.0 * wind_m_s / airspeed_m_s:.0f} % of the airspeed of "
        f"{airspeed_m_s:g} m/s: {airspeed_m_s - wind_m_s:.2g} m/s are left over the ground against it, and a "
        "gust blows the aircraft away",
        "Fly in less wind, or faster.",
    )


def _times(scenario: Scenario, ground_speed_m_s: float, findings: Findings) -> None:
    """Of the way to the nearest region, and of a flight that only reaches the farthest and sees all."""
    start, end = (Point(terminal.position) for terminal in (scenario.start, scenario.end))
    away_m = [(region.area.distance(start), region.name) for region in scenario.regions]
    near_m, nearest = min(away_m)
    if near_m / ground_speed_m_s > FAR_S:
        findings.warning(
            scenario.start.name,
            "start-far",
            f"lies {near_m / 1000.0:.0f} km, {_hours(near_m / ground_speed_m_s)} of flight, from the nearest "
            f"region, {nearest}",
            "Check the place (longitude first), or start nearer.",
        )
    way_m = max(region.area.distance(start) + region.area.distance(end) for region in scenario.regions)
    level, suite, airspace = scenario.level, scenario.suite, scenario.airspace
    for region in scenario.regions:
        # Where terrain leaves a sensor no height, that is found elsewhere.
        sensor = suite.of(region)
        swath_m = sensor.swath_m(level.of(region).height_m) if airspace.terrain is None else 0.0
        if isinstance(sensor, CameraSensor):
            swath_m *= 1.0 - sensor.side_overlap
        way_m += region.revisits * region.area.area / swath_m if swath_m > 0.0 else 0.0
    if way_m / ground_speed_m_s > LONG_S and scenario.task != "search":
        findings.warning(
            "scenario",
            "flight-long",
            f"takes {_hours(way_m / ground_speed_m_s)} of flight at least: {way_m / 1000.0:.0f} km",
            "Check altitude_m and what gives the swath, a beam or a camera's overlap; or cut the regions.",
        )


def _hours(time_s: float) -> str:
    return f"{time_s / 60.0:.0f} min" if time_s < 3600.0 else f"{time_s / 3600.0:.1f} h"


def _swapped(scenario: Scenario, findings: Findings) -> None:
    """Places that lie beside the others once latitude and longitude are exchanged."""
    places = {region.name: region.area.centroid.coords[0] for region in scenario.regions}
    ends = (scenario.start, scenario.end, *scenario.bases)
    places |= {terminal.name: terminal.position for terminal in ends}
    names, at_m = list(places), np.array(list(places.values()))
    middle = np.median(at_m, axis=0)
    for name, place in zip(names, at_m, strict=True):
        away_m = math.dist(place, middle)
        if away_m < AWAY_M:
            continue
        lon_deg, lat_deg = (float(value) for value in scenario.frame.to_wgs84(place))
        if abs(lon_deg) > 90.0:
            continue
        nearer_m = math.dist(scenario.frame.to_local((lat_deg, lon_deg)), middle)
        if nearer_m < NEARER * away_m:
            findings.warning(
                name,
                "axes-maybe-swapped",
                f"lies {away_m / 1000.0:.0f} km from the others, {nearer_m / 1000.0:.0f} km with its axes "
                "exchanged",
                "Write [longitude, latitude].",
            )
