"""The ground that the photos of a collect see, for the judge: from the image's corners, by turned rays."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.affinity import affine_transform, translate
from shapely.geometry import LineString, MultiPolygon, Polygon, box

from planner.airspace.airspace import Airspace, Level
from planner.airspace.values import Wind
from planner.route import Look
from planner.sensors.camera import CameraSensor
from planner.sensors.camera_view import seen_on_terrain

Floats = NDArray[np.float64]

#: Photos whose overlap is 0 are no farther apart than this part of what one sees along its course.
FARTHEST = 0.98


def nose_off_rad(sensor: CameraSensor, course_rad: float, airspeed_m_s: float, wind: Wind) -> float:
    """How far the image is turned to the left of the course: where the velocity through the air points."""
    if sensor.stabilised or wind.speed_m_s == 0.0:
        return 0.0
    course = np.array([math.cos(course_rad), math.sin(course_rad)])
    wind_m_s = wind.speed_m_s * np.array([math.cos(wind.toward_rad), math.sin(wind.toward_rad)])
    tail_m_s = float(course @ wind_m_s)
    ground_m_s = tail_m_s + math.sqrt(tail_m_s**2 + airspeed_m_s**2 - float(wind_m_s @ wind_m_s))
    nose = ground_m_s * course - wind_m_s
    return math.remainder(math.atan2(nose[1], nose[0]) - course_rad, math.tau)


def photo_corners(sensor: CameraSensor, off_rad: float) -> Floats:
    """Corners of a photo from one metre up, (4, 2): ahead along the course and to its left.

    Rays through the image's corners (ahead, left, up), of a camera that looks straight down, pitched up by
    its tilt and turned by the crab.
    """
    optics, tilt = sensor.optics, sensor.tilt_rad
    wide = optics.columns * optics.pixel_pitch_m / optics.focal_length_m / 2.0
    high = optics.rows * optics.pixel_pitch_m / optics.focal_length_m / 2.0
    rays = np.array([[-high, -wide, -1.0], [high, -wide, -1.0], [high, wide, -1.0], [-high, wide, -1.0]])
    pitch = np.array(
        [[math.cos(tilt), 0.0, -math.sin(tilt)], [0.0, 1.0, 0.0], [math.sin(tilt), 0.0, math.cos(tilt)]]
    )
    yaw = np.array(
        [
            [math.cos(off_rad), -math.sin(off_rad), 0.0],
            [math.sin(off_rad), math.cos(off_rad), 0.0],
            [0.0, 0.0, 1.0],
        ]
    )
    turned = rays @ pitch.T @ yaw.T
    corners: Floats = turned[:, :2] / -turned[:, 2:]
    return corners


def camera_footprint(
    sensor: CameraSensor,
    line_m: Floats,
    look: Look,
    altitude_m: float | Floats,
    airspeed_m_s: float,
    airspace: Airspace,
    level: Level,
) -> Polygon | MultiPolygon:
    """What the photos of a pass see together, taken as far apart as their overlap allows.

    What photos a distance apart leave no gap in is the width that one shares with the next.
    """
    wind = airspace.wind
    if airspace.terrain is not None:
        there = sensor.in_wind(wind.speed_m_s / airspeed_m_s, wind.toward_rad)
        return seen_on_terrain(there, line_m, look, altitude_m, airspace.terrain).area
    (east0, north0), (east1, north1) = line_m
    course_rad, length_m = math.atan2(north1 - north0, east1 - east0), math.dist(*line_m)
    off_rad = nose_off_rad(sensor, course_rad, airspeed_m_s, wind)
    first = Polygon(photo_corners(sensor, off_rad) * level.height_m)
    _, right_m, _, left_m = first.intersection(translate(first, apart_m(first, sensor))).bounds
    swept = shapely.union(first, translate(first, length_m)).convex_hull
    west_m, _, east_m, _ = swept.bounds
    strip: Any = swept.intersection(box(west_m, right_m, east_m, left_m))
    cos, sin = math.cos(course_rad), math.sin(course_rad)
    turned: Polygon = affine_transform(strip, [cos, -sin, sin, cos, float(east0), float(north0)])
    return turned


@lru_cache(maxsize=64)
def apart_m(photo: Polygon, sensor: CameraSensor) -> float:
    """How far along the next photo may be taken for it to share the overlap's part of the ground."""
    west_m, _, east_m, _ = photo.bounds
    slices = [LineString([(west_m, y), (east_m, y)]) for _, y in photo.exterior.coords]
    low, high = 0.0, FARTHEST * max(float(photo.intersection(each).length) for each in slices)
    for _ in range(60):
        middle = (low + high) / 2.0
        kept = photo.intersection(translate(photo, middle)).area >= sensor.forward_overlap * photo.area
        low, high = (middle, high) if kept else (low, middle)
    return low
