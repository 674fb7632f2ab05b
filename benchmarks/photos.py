"""Photos of passes on level ground, by a geometry of their own: which places each of them sees."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import Polygon

from planner.airspace.values import Wind
from planner.route import CollectPass
from planner.sensors.camera import CameraSensor

Floats = NDArray[np.float64]

#: Places this near to a photo's edge are in it: those of plans are rounded.
WITHIN_M = 1e-3


@dataclass(frozen=True, slots=True)
class Photo:
    """One photo: which pass it is of, where its middle lies, and the ground it sees."""

    lane: int
    middle: tuple[float, float]
    ground: Polygon


def nose_rad(course_rad: float, airspeed_m_s: float, wind: Wind) -> float:
    """Where the nose points on a course: along the velocity through the air."""
    course = np.array([math.cos(course_rad), math.sin(course_rad)])
    drift = wind.speed_m_s * np.array([math.cos(wind.toward_rad), math.sin(wind.toward_rad)])
    along = float(course @ drift)
    across = float(drift @ np.array([-course[1], course[0]]))
    ground_m_s = along + math.sqrt(airspeed_m_s**2 - across**2)
    air = ground_m_s * course - drift
    return math.atan2(air[1], air[0])


def photos(
    passes: Sequence[CollectPass], camera: CameraSensor, height_m: float, airspeed_m_s: float, wind: Wind
) -> list[Photo]:
    """All photos: the first at a pass's start, the last at its end, evenly and near enough in between."""
    optics = camera.optics
    wide_m = optics.columns * optics.pixel_pitch_m / optics.focal_length_m * height_m
    long_m = optics.rows * optics.pixel_pitch_m / optics.focal_length_m * height_m
    image = np.array([[-long_m, -wide_m], [long_m, -wide_m], [long_m, wide_m], [-long_m, wide_m]]) / 2.0
    found = []
    for lane, one in enumerate(passes):
        course_rad = math.atan2(one.end[1] - one.start[1], one.end[0] - one.start[0])
        turned = nose_rad(course_rad, airspeed_m_s, wind) if wind.speed_m_s else course_rad
        cos, sin = math.cos(turned), math.sin(turned)
        length_m = math.dist(one.start, one.end)
        gaps = max(1, math.ceil(length_m / camera.photo_spacing_m(height_m, course_rad) - 1e-9))
        for share in np.linspace(0.0, 1.0, gaps + 1):
            middle = np.array(one.start) + share * (np.array(one.end) - np.array(one.start))
            ring = middle + image @ np.array([[cos, sin], [-sin, cos]])
            found.append(Photo(lane, (float(middle[0]), float(middle[1])), Polygon(ring)))
    return found


def places(area: Polygon, step_m: float = 1.0) -> Floats:
    """Places of a region on a grid, with its corners; (N, 2)."""
    west, south, east, north = area.bounds
    grid = np.stack(np.meshgrid(np.arange(west, east, step_m), np.arange(south, north, step_m)), axis=-1)
    inside = grid.reshape(-1, 2)
    inside = inside[shapely.contains_xy(area, inside[:, 0], inside[:, 1])]
    return np.concatenate([inside, shapely.get_coordinates(area)])


def seen_by(taken: Sequence[Photo], at: Floats) -> NDArray[np.int64]:
    """How many photos of each lane see each place, (lanes, places)."""
    counts = np.zeros((max(photo.lane for photo in taken) + 1, len(at)), dtype=np.int64)
    for photo in taken:
        ring = shapely.get_coordinates(photo.ground)[:-1]
        inside = np.ones(len(at), dtype=np.bool_)
        for (x0, y0), (x1, y1) in zip(ring, np.roll(ring, -1, axis=0), strict=True):
            from_edge = ((x1 - x0) * (at[:, 1] - y0) - (y1 - y0) * (at[:, 0] - x0)) / math.dist(
                (x0, y0), (x1, y1)
            )
            inside &= from_edge >= -WITHIN_M
        counts[photo.lane] += inside
    return counts
