"""The ground a collect sees, drawn from the published line and the sensor's angles."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray
from shapely.geometry import MultiPolygon, Polygon

from planner.airspace.airspace import Airspace, Level
from planner.airspace.values import STILL_AIR, Wind
from planner.check.camera_print import camera_footprint
from planner.check.followed import along
from planner.plan import Collect, Plan
from planner.route import Look
from planner.scenario import Scenario
from planner.sensors.sar import SarSensor
from planner.sensors.view import seen_on_flat, seen_on_terrain

Floats = NDArray[np.float64]

#: Rays from the near to the far edge of a beam that crabs; an odd number, so that one is its middle.
RAYS = 129


class Footprint(Protocol):
    """Ground that a sensor of one kind sees; the judge's own, drawn from the published line."""

    def __call__(
        self,
        sensor: Any,
        line_m: Floats,
        look: Look,
        altitude_m: Any,
        airspeed_m_s: float,
        airspace: Airspace,
        level: Level,
    ) -> Polygon | MultiPolygon:
        """Seen at full resolution with the sensor on all along a line (2, 2); without what terrain hides.

        ``altitude_m`` is one, or, where the ground is followed, those of places evenly along the line.
        """


def footprint(scenario: Scenario, collect: Collect, plan: Plan | None = None) -> Polygon | MultiPolygon:
    """Ground seen at full resolution during a collect, in the local frame; without what terrain hides.

    The plan's path says how high a collect that follows the ground is; without it, it is level.
    """
    sensor = scenario.suite.named(collect.sensor)
    line_m = scenario.frame.to_local([place[:2] for place in collect.line])
    aircraft = next(a for a in scenario.aircraft if a.name == collect.vehicle)
    # What hovers points its nose along the line: as in still air.
    airspace = replace(scenario.airspace, wind=STILL_AIR) if aircraft.hovers else scenario.airspace
    altitude_m = collect.line[0][2]
    flown_m: float | Floats = altitude_m
    if (
        plan is not None
        and scenario.terrain is not None
        and any(
            region.over_ground_m is not None and region.name in collect.regions for region in scenario.regions
        )
    ):
        flown_m = along(scenario, plan, collect, scenario.terrain.step_m)[1]
    where = (flown_m, aircraft.airspeed_m_s, airspace, scenario.level.at(altitude_m))
    return FOOTPRINTS[sensor.kind](sensor, line_m, collect.look, *where)


def sar_footprint(
    sensor: SarSensor,
    line_m: Floats,
    look: Look,
    altitude_m: float,
    airspeed_m_s: float,
    airspace: Airspace,
    level: Level,
) -> Polygon | MultiPolygon:
    """What a SAR sees.

    Between half an aperture after sensor on and half an aperture before sensor off every point between the
    near and the far edge of the beam is lit over a whole aperture.
    """
    wind = airspace.wind
    if airspace.terrain is not None:
        sensor = sensor.in_wind(wind.speed_m_s / airspeed_m_s, wind.toward_rad)
        return seen_on_terrain(sensor, line_m, look, altitude_m, airspace.terrain).area
    (east0, north0), (east1, north1) = line_m
    length_m = math.hypot(east1 - east0, north1 - north0)
    along = np.array([east1 - east0, north1 - north0]) / length_m
    side = np.array([along[1], -along[0]]) * (1.0 if look == "right" else -1.0)
    height_m = level.height_m
    if wind.speed_m_s > 0.0 and not sensor.stabilised and sensor.mode != "spotlight":
        return _crabbing(sensor, wind, height_m, airspeed_m_s, line_m, along, side)
    if sensor.squint_rad != 0.0 or sensor.mode == "spotlight":
        return seen_on_flat(sensor, line_m, look, height_m)
    half_beam_rad = sensor.elevation_beamwidth_rad / 2.0
    near_m = height_m * math.tan(sensor.incidence_rad - half_beam_rad)
    far_m = height_m * math.tan(sensor.incidence_rad + half_beam_rad)
    half_aperture_m = height_m * sensor.azimuth_beamwidth_rad / math.cos(sensor.incidence_rad) / 2.0
    if length_m <= 2.0 * half_aperture_m:
        return Polygon()
    first = np.array([east0, north0]) + along * half_aperture_m
    last = np.array([east1, north1]) - along * half_aperture_m
    return Polygon([first + side * near_m, last + side * near_m, last + side * far_m, first + side * far_m])


def _crabbing(
    sensor: SarSensor,
    wind: Wind,
    height_m: float,
    airspeed_m_s: float,
    line_m: Floats,
    along: Floats,
    side: Floats,
) -> Polygon:
    """The same with an antenna fixed to an aircraft that crabs: where its rays meet the ground, swept along.

    The nose points along the velocity through the air, which is that over the ground less the wind. Rays lie
    on the antenna's cone of squint, from the near to the far edge of the beam.
    """
    wind_m_s = wind.speed_m_s * np.array([math.cos(wind.toward_rad), math.sin(wind.toward_rad)])
    # |v·along − wind| = airspeed, for the ground speed v.
    tail_m_s = float(along @ wind_m_s)
    ground_m_s = tail_m_s + math.sqrt(tail_m_s**2 + airspeed_m_s**2 - float(wind_m_s @ wind_m_s))
    nose = (ground_m_s * along - wind_m_s) / airspeed_m_s
    out = np.array([nose[1], -nose[0]]) * math.copysign(1.0, float(side @ [along[1], -along[0]]))
    half_rad = sensor.elevation_beamwidth_rad / 2.0
    look_rad = np.linspace(sensor.incidence_rad - half_rad, sensor.incidence_rad + half_rad, RAYS)[:, None]
    squint_tan = math.tan(sensor.squint_rad)
    rays_m = height_m * (np.tan(look_rad) * out + squint_tan / np.cos(look_rad) * nose)
    # The antenna passes the ray's place at the rate of the angle between its axis and the way to the place.
    middle = np.array([*(rays_m[RAYS // 2]), -height_m])
    range_m = float(np.hypot(np.hypot(middle[0], middle[1]), height_m))
    toward = middle / range_m
    axis, flown = np.array([*nose, 0.0]), np.array([*along, 0.0])
    sine = float(axis @ toward)
    rate = float(axis @ flown - sine * (flown @ toward)) / (range_m * math.sqrt(1.0 - sine**2))
    half_m = 0.5 * sensor.azimuth_beamwidth_rad / rate
    if math.dist(*line_m) <= 2.0 * half_m:
        return Polygon()
    first, last = line_m[0] + half_m * along + rays_m, line_m[1] - half_m * along + rays_m
    return Polygon([*first, *last[::-1]])


#: By kind of sensor.
FOOTPRINTS: dict[str, Footprint] = {"sar": sar_footprint, "camera": camera_footprint}


def register(kind: str, of_kind: Footprint) -> None:
    """Have collects with sensors of a kind judged by a footprint."""
    FOOTPRINTS[kind] = of_kind
