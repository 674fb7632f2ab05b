"""Whether cameras take photos as fast as their overlaps ask for: else the flight is slower, or refused.

An aircraft flies all of its flight at one airspeed: a multirotor, or wings that say how slowly they may be
flown, at the greatest that leaves every camera the time between two photos.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from planner.errors import InfeasibleError
from planner.geojson.fields import Findings
from planner.scenario import Scenario
from planner.sensors.camera import CameraSensor
from planner.sensors.suite import camera_on
from planner.vehicle.aircraft import Aircraft
from planner.vehicle.atmosphere import true_over_equivalent
from planner.vehicle.model import FlightModel
from planner.wishes import HIGHEST_M, Region

#: Courses looked at where a region allows any: there and back is one.
COURSES_RAD = np.radians(np.arange(0.0, 180.0, 15.0))
#: No multirotor is flown slower than this for a camera.
SLOWEST_M_S = 0.5
#: An airspeed is above the wind by this part at least.
OVER_WIND = 1.05
_HALVINGS = 13


@dataclass(frozen=True, slots=True)
class _Shooting:
    """One region, seen with a camera from a height over its ground."""

    region: Region
    camera: CameraSensor
    height_m: float

    def short(self, aircraft: Aircraft, scenario: Scenario) -> tuple[float, float]:
        """The way that the camera needs between photos, by what its overlap leaves; on which course least."""
        model = FlightModel.of(aircraft, scenario.wind)
        flown = camera_on(self.camera, aircraft, scenario.level.amsl_m)
        camera = flown.in_wind(model.drift, scenario.wind.toward_rad)
        return min((self._worse(camera, course_rad), course_rad) for course_rad in self._courses())

    def _courses(self) -> Sequence[float]:
        allowed = self.region.approach_rad
        return COURSES_RAD.tolist() if allowed is None else allowed

    def _worse(self, camera: CameraSensor, course_rad: float) -> float:
        """There, and back where that is allowed."""
        ways = [course_rad, course_rad + math.pi]
        allowed = self.region.approach_rad
        if allowed is not None and not any(
            abs(math.remainder(ways[1] - each, math.tau)) < 1e-3 for each in allowed
        ):
            ways = ways[:1]
        spacings_m = [camera.photo_spacing_m(self.height_m, way_rad) for way_rad in ways]
        if min(spacings_m) <= 0.0:
            return math.inf
        return max(
            camera.least_spacing_m(way_rad) / spacing_m
            for way_rad, spacing_m in zip(ways, spacings_m, strict=True)
        )


def at_camera_speed(scenario: Scenario, findings: Findings) -> Scenario:
    """The scenario flown no faster than its cameras take photos, and its cameras told how fast that is.

    Of several aircraft each by the cameras on board; they are told by ``Scenario.of_one``.
    """
    if len(scenario.aircraft) == 1:
        return _alone(scenario, findings)
    flown = [_alone(scenario.of_one(aircraft), findings).aircraft[0] for aircraft in scenario.aircraft]
    return replace(scenario, aircraft=tuple(flown))


def _alone(scenario: Scenario, findings: Findings) -> Scenario:
    shootings = _shootings(scenario)
    if not shootings or not scenario.aircraft:
        return scenario
    aircraft = scenario.aircraft[0]
    if scenario.wind.speed_m_s >= aircraft.airspeed_m_s:
        return scenario
    hurried = [each for each in shootings if each.short(aircraft, scenario)[0] > 1.0]
    if hurried:
        slower = _slower(aircraft, scenario, hurried)
        if slower is None:
            for each in hurried:
                _refuse(each, aircraft, scenario, findings)
            return scenario
        findings.warning(
            f"vehicle {aircraft.name}",
            "speed-lowered",
            f"is flown at {slower.airspeed_m_s:g} m/s, not {aircraft.airspeed_m_s:g}: "
            + "; ".join(sorted({_needs(each) for each in hurried})),
            "Lower forward_overlap, or fly higher, for it to fly faster.",
        )
        aircraft = slower
    amsl_m = scenario.level.amsl_m
    sensors = tuple(
        camera_on(sensor, aircraft, amsl_m) if isinstance(sensor, CameraSensor) else sensor
        for sensor in scenario.sensors
    )
    return replace(scenario, aircraft=(aircraft,), sensors=sensors)


def _shootings(scenario: Scenario) -> list[_Shooting]:
    found = []
    for region in scenario.regions:
        if not isinstance(scenario.sensor_for(region), CameraSensor):
            continue
        try:
            camera, height_m = scenario.suite.over(
                region.sensor, region.area, scenario.airspace, scenario.level.of(region)
            )
        except InfeasibleError:
            continue
        if not isinstance(camera, CameraSensor) or height_m <= camera.relief_m:
            continue
        if camera.photo_spacing_m(height_m, 0.0) > 0.0:
            found.append(_Shooting(region, camera, height_m))
    return found


def _slower(aircraft: Aircraft, scenario: Scenario, hurried: Sequence[_Shooting]) -> Aircraft | None:
    """At the greatest airspeed that leaves the time; None where the slowest is too fast."""
    least_m_s = SLOWEST_M_S if aircraft.hovers else aircraft.airspeed_m_s
    if aircraft.min_airspeed_m_s is not None:
        least_m_s = aircraft.min_airspeed_m_s
    low_m_s = max(least_m_s, OVER_WIND * scenario.wind.speed_m_s)

    def kept(speed_m_s: float) -> bool:
        slower = replace(aircraft, airspeed_m_s=speed_m_s)
        return all(each.short(slower, scenario)[0] <= 1.0 for each in hurried)

    high_m_s = aircraft.airspeed_m_s
    if low_m_s >= high_m_s or not kept(low_m_s):
        return None
    for _ in range(_HALVINGS):
        middle_m_s = (low_m_s + high_m_s) / 2.0
        low_m_s, high_m_s = (middle_m_s, high_m_s) if kept(middle_m_s) else (low_m_s, middle_m_s)
    # Told to a hundredth; below it is slower still.
    rounded_m_s = math.floor(100.0 * low_m_s) / 100.0
    return replace(aircraft, airspeed_m_s=rounded_m_s if kept(rounded_m_s) else low_m_s)


def _needs(each: _Shooting) -> str:
    spacing_m = each.camera.photo_spacing_m(each.height_m, 0.0)
    return (
        f"{each.camera.name} takes a photo every {each.camera.min_interval_s:g} s, and over "
        f"{each.region.name} is to take one every {spacing_m:.1f} m"
    )


def _refuse(each: _Shooting, aircraft: Aircraft, scenario: Scenario, findings: Findings) -> None:
    over, _ = each.short(aircraft, scenario)
    camera = each.camera
    told = f"{_needs(each)}, {aircraft.name} flies too fast for that: "
    if math.isinf(over):
        findings.error(
            each.region.name, "interval-too-short", f"{told}no overlap is left", "Lower the margins."
        )
        return
    higher_m = _higher_m(each, over, aircraft, scenario)
    fixes = []
    overlap = _overlap(each, aircraft, scenario)
    if overlap is not None:
        fixes.append(f"set forward_overlap to {overlap:g} or less")
    most_m = HIGHEST_M if scenario.max_height_m is None else scenario.max_height_m - camera.relief_m
    asks = any((each.region.gsd_m, each.region.min_niirs, each.region.min_resolution_m))
    if not asks and higher_m <= most_m:
        fixes.append(f"fly it from {higher_m:g} m over its ground or more")
    slowest = replace(aircraft, min_airspeed_m_s=SLOWEST_M_S)
    slower = _slower(slowest, scenario, [each])
    if slower is not None:
        fixes.append(f"let {aircraft.name} fly at {slower.airspeed_m_s:g} m/s (min_airspeed_m_s)")
    least_s = camera.min_interval_s / over
    fix = ", or ".join(fixes) or f"use a camera with min_interval_s {_floor(least_s):g} or less"
    findings.error(
        each.region.name,
        "interval-too-short",
        f"{told}it would take one every {least_s:.2f} s",
        f"{fix[0].upper()}{fix[1:]}.",
    )


def _floor(value: float) -> float:
    """Three digits of it, not more than it is."""
    scale = 10.0 ** (2 - math.floor(math.log10(value)))
    return math.floor(value * scale) / scale


def _higher_m(each: _Shooting, over: float, aircraft: Aircraft, scenario: Scenario) -> int:
    """The height over the mean ground that leaves the time, in the thinner air there."""
    relief_m, amsl_m = each.camera.relief_m, scenario.level.amsl_m
    height_m = over * (each.height_m - relief_m) + relief_m
    for _ in range(4):
        up_m = amsl_m + height_m - each.height_m
        thinner = 1.0 if aircraft.hovers else true_over_equivalent(up_m) / true_over_equivalent(amsl_m)
        height_m = over * thinner * (each.height_m - relief_m) + relief_m
    return math.ceil(height_m)


def _overlap(each: _Shooting, aircraft: Aircraft, scenario: Scenario) -> float | None:
    """The greatest forward overlap, in hundredths, that leaves the time; None where none does."""

    def kept(hundredths: int) -> bool:
        tried = replace(each, camera=replace(each.camera, forward_overlap=hundredths / 100.0))
        return tried.short(aircraft, scenario)[0] <= 1.0

    low, high = 0, math.floor(100.0 * each.camera.forward_overlap) + 1
    if not kept(low):
        return None
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if kept(middle) else (low, middle)
    return low / 100.0
