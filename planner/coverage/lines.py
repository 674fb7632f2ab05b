"""Straight passes among surroundings: which may be flown, what each costs, and where turns have room."""

from __future__ import annotations

import math

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry

from planner.airspace.prices import risks_m
from planner.airspace.room_kernels import circles_fit, inside_m
from planner.airspace.surroundings import Surroundings
from planner.vehicle.wind import still_air_factor

Floats = NDArray[np.float64]

#: An option without room for a full turn at one of its ends is taken only where all others are worse.
NO_ROOM_M = 5_000.0


def inside(lines: Floats, area: BaseGeometry | None) -> NDArray[np.bool_]:
    """Which of the lines, shape (..., 2, 2), stay in the operating area (constraint c4); shape (...)."""
    if area is None:
        return np.ones(lines.shape[:-2], dtype=np.bool_)
    shapely.prepare(area)
    return np.asarray(shapely.covers(area, shapely.linestrings(lines)), dtype=np.bool_)


def flown_straight(lines: Floats, settle_m: float) -> Floats:
    """What is flown straight for passes along lines, shape (..., 2, 2): settling run and pass."""
    if settle_m == 0.0:
        return lines
    ahead = lines[..., 1, :] - lines[..., 0, :]
    ahead = ahead / np.hypot(ahead[..., 0], ahead[..., 1])[..., None]
    return np.stack([lines[..., 0, :] - settle_m * ahead, lines[..., 1, :]], axis=-2)


def judge_lines(lines: Floats, around: Surroundings) -> tuple[NDArray[np.bool_], Floats]:
    """Which lines (M, K, 2, 2), settled before, keep the hard constraints, and what each costs."""
    shape = lines.shape[:2]
    lines = flown_straight(lines, around.settle_m)
    good = inside(lines, around.area)
    geometry = shapely.linestrings(lines)
    for polygon in around.hard_polygons:
        good &= ~shapely.intersects(polygon, geometry)
    delta = lines[:, :, 1] - lines[:, :, 0]
    cost_m = np.hypot(delta[..., 0], delta[..., 1])
    if around.wind.speed_m_s > 0.0:
        courses_rad = np.arctan2(delta[..., 1], delta[..., 0])
        cost_m = cost_m * still_air_factor(courses_rad, around.airspeed_m_s, around.wind)
    cost_m = cost_m + around.stops_m
    flat = np.ascontiguousarray(lines).reshape(-1, 2, 2)
    if len(around.hard):
        good &= (inside_m(flat, around.hard) == 0.0).reshape(shape)
    if len(around.soft):
        cost_m[good] += risks_m(flat[good.reshape(-1)], around.priced)
    return good, cost_m


def poses_of(line: Floats, angles_rad: Floats, settle_m: float) -> tuple[Floats, Floats]:
    """Entry and exit poses of lines (N, 2, 2) flown at angles (N,)."""
    ahead = np.stack([np.cos(angles_rad), np.sin(angles_rad)], axis=1)
    wrapped = np.mod(angles_rad + math.pi, 2.0 * math.pi) - math.pi
    entry = np.column_stack([line[:, 0] - settle_m * ahead, wrapped])
    return entry, np.column_stack([line[:, 1], wrapped])


def cramped_m(arriving: Floats, leaving: Floats, around: Surroundings) -> Floats:
    """What two poses cost where a full turn fits at neither side of one of them."""
    return NO_ROOM_M * (~(roomy(arriving, around) & roomy(leaving, around))).astype(np.float64)


def roomy(poses: Floats, around: Surroundings) -> NDArray[np.bool_]:
    """Whether a full turn to one side or the other fits: inside the area, outside every disc."""
    roomy = np.zeros(len(poses), dtype=np.bool_)
    discs = np.concatenate([around.hard, around.soft])
    for side in (1.0, -1.0):
        free = circles_fit(poses, side, around.radius_m, discs)
        east_m = poses[:, 0] - side * around.radius_m * np.sin(poses[:, 2])
        north_m = poses[:, 1] + side * around.radius_m * np.cos(poses[:, 2])
        if around.room is not None:
            free &= shapely.contains_xy(around.room, east_m, north_m)
        if around.cramped is not None:
            shapely.prepare(around.cramped)
            free &= ~shapely.contains_xy(around.cramped, east_m, north_m)
        roomy |= free
    return roomy
