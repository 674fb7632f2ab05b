"""Whether a scenario that is refused can be flown after all, by a search over shapes alone."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import shapely
from shapely.geometry import LineString, Point
from shapely.geometry.base import BaseGeometry

from tests.planner.random.judge import Ground, hard_zones, heights_m, sensor_of, turn_radius_m, wind_m_s


def possible(document: dict[str, Any]) -> bool:
    """Whether every region that is required surely has a pass: one heading and offset of a coarse grid, tried
    on shapes alone, at which settling run and pass keep clear of all zones and both turning circles to one
    side of each end do.

    False says nothing.
    """
    ground = Ground.of(document)
    zones = shapely.union_all([zone.buffer(15.0 + ground.slack_m) for zone in hard_zones(ground).values()])
    areas = ground.of_role("area")
    area = ground.shape(areas[0]).buffer(-5.0 - ground.slack_m) if areas else None
    return all(
        _some_pass(ground, feature, zones, area)
        for feature in ground.of_role("roi")
        if feature["properties"].get("required", True)
    )


def _some_pass(
    ground: Ground, feature: dict[str, Any], zones: BaseGeometry, area: BaseGeometry | None
) -> bool:
    sensor = sensor_of(ground, feature["properties"].get("sensor"))
    vehicle = ground.document["vehicles"][0]
    if sensor.get("squint_deg") or wind_m_s(ground).any() or feature["properties"].get("revisits", 1) > 1:
        return False
    height_m, _ = heights_m(ground)
    half_deg = sensor["elevation_beamwidth_deg"] * sensor.get("sub_swaths", 1) / 2.0
    near_m = height_m * math.tan(math.radians(sensor["incidence_deg"] - half_deg))
    far_m = height_m * math.tan(math.radians(sensor["incidence_deg"] + half_deg))
    half_m = height_m * math.radians(sensor["azimuth_beamwidth_deg"])
    half_m /= 2.0 * math.cos(math.radians(sensor["incidence_deg"]))
    radius_m, settle_m = 1.01 * turn_radius_m(ground), vehicle.get("settle_m", 0.0)
    corners = shapely.get_coordinates(ground.shape(feature))
    allowed = feature["properties"].get("approach_deg") or np.arange(0.0, 360.0, 5.0).tolist()
    looks = {"left": (1.0,), "right": (-1.0,), "both": (1.0, -1.0)}[sensor.get("look", "right")]
    for heading in allowed:
        course = math.radians(90.0 - heading)
        ahead, left = (
            np.array([math.cos(course), math.sin(course)]),
            np.array([-math.sin(course), math.cos(course)]),
        )
        along, across = corners @ ahead, corners @ left
        spare_m = far_m - near_m - (across.max() - across.min()) - 2.0 * ground.slack_m
        for side in looks if spare_m > 0.0 else ():
            for share in (0.1, 0.5, 0.9):
                edge = across.min() if side > 0.0 else across.max()
                beside = edge - side * (near_m + ground.slack_m + share * spare_m)
                begin = (along.min() - half_m - settle_m) * ahead + beside * left
                end = (along.max() + half_m) * ahead + beside * left
                taken = [LineString([begin, end]).buffer(1.0)]
                circles = [
                    [Point(place + turn * radius_m * left).buffer(radius_m) for turn in (1.0, -1.0)]
                    for place in (begin, end)
                ]
                if all(
                    any(_free(shape, zones, area) for shape in shapes) for shapes in ([taken[0]], *circles)
                ):
                    return True
    return False


def _free(shape: BaseGeometry, zones: BaseGeometry, area: BaseGeometry | None) -> bool:
    return not shape.intersects(zones) and (area is None or bool(area.covers(shape)))
