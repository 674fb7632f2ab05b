"""The ground a collect sees, drawn from the published line and the sensor's angles."""

from __future__ import annotations

import math

import numpy as np
from shapely.geometry import MultiPolygon, Polygon

from planner.plan import Collect
from planner.scenario import Scenario
from planner.sensors.view import seen_on_flat, seen_on_terrain


def footprint(scenario: Scenario, collect: Collect) -> Polygon | MultiPolygon:
    """Ground seen at full resolution during a collect, in the local frame; on terrain without what is hidden.

    Between half an aperture after sensor on and half an aperture before sensor off every point between the
    near and the far edge of the beam is lit over a whole aperture.
    """
    sensor = next(s for s in scenario.sensors if s.name == collect.sensor)
    line_m = scenario.frame.to_local([place[:2] for place in collect.line])
    if scenario.terrain is not None:
        level_m = collect.line[0][2]
        return seen_on_terrain(sensor, line_m, collect.look, level_m, scenario.terrain).area
    (east0, north0), (east1, north1) = line_m
    length_m = math.hypot(east1 - east0, north1 - north0)
    along = np.array([east1 - east0, north1 - north0]) / length_m
    side = np.array([along[1], -along[0]]) * (1.0 if collect.look == "right" else -1.0)
    height_m = scenario.height_m
    if sensor.squint_rad != 0.0 or sensor.mode == "spotlight":
        return seen_on_flat(sensor, line_m, collect.look, height_m)
    half_beam_rad = sensor.elevation_beamwidth_rad / 2.0
    near_m = height_m * math.tan(sensor.incidence_rad - half_beam_rad)
    far_m = height_m * math.tan(sensor.incidence_rad + half_beam_rad)
    half_aperture_m = height_m * sensor.azimuth_beamwidth_rad / math.cos(sensor.incidence_rad) / 2.0
    if length_m <= 2.0 * half_aperture_m:
        return Polygon()
    first = np.array([east0, north0]) + along * half_aperture_m
    last = np.array([east1, north1]) - along * half_aperture_m
    return Polygon([first + side * near_m, last + side * near_m, last + side * far_m, first + side * far_m])
