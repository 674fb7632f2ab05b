"""The ground inside a camera's image: a closed loop on a plane, the ellipsoid, or an elevation raster.

The image's edges are the planes of the algorithm: two through the upright of the image at half its width
either side, two through its level line at half its height. Where such a plane meets the ground is the loop's
edge; here rays within the planes are followed to the ground.

Source: Stecz and Gromada 2020 (see ``optics``), Algorithm 2 and figure 3.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

Points = NDArray[np.float64]
#: Heights of the ground at places (n, 2) of the local frame; NaN where it is not known.
GroundAt = Callable[[Points], NDArray[np.float64]]

#: Semi-axes of WGS 84.
_EQUATOR_M, _POLE_M = 6_378_137.0, 6_356_752.314245179
_HALVINGS = 40


class HorizonError(ValueError):
    """A part of the image shows no ground."""


def edge_rays(
    camera_m: ArrayLike, target_m: ArrayLike, half_width_rad: float, half_height_rad: float, per_edge: int = 1
) -> Points:
    """Unit vectors round the image's edge, shape (4 · per_edge, 3), counter-clockwise from its lower left.

    Parameters
    ----------
    camera_m, target_m
        P_cam and P_POI, east, north and up. The image is upright: its lower edge is level. Straight down its
        upper edge is north.
    per_edge
        Rays along each edge; 1 for the corners alone.
    """
    axis = np.asarray(target_m, dtype=np.float64) - np.asarray(camera_m, dtype=np.float64)
    length = float(np.linalg.norm(axis))
    if not length > 0.0:
        raise ValueError("the camera looks at itself")
    axis /= length
    level = np.cross(axis, (0.0, 0.0, 1.0))
    size = float(np.linalg.norm(level))
    level = level / size if size > 1e-12 else np.array([1.0, 0.0, 0.0])
    upright = np.cross(level, axis)
    wide, high = math.tan(half_width_rad), math.tan(half_height_rad)
    corners = np.array([[-wide, -high], [wide, -high], [wide, high], [-wide, high]])
    share = np.arange(per_edge)[:, None] / per_edge
    round_it = [corners[k] + share * (corners[(k + 1) % 4] - corners[k]) for k in range(4)]
    image = np.concatenate(round_it)
    rays = axis + image[:, :1] * level + image[:, 1:] * upright
    unit: Points = rays / np.linalg.norm(rays, axis=1, keepdims=True)
    return unit


def loop_on_plane(camera_m: ArrayLike, rays: Points, ground_m: float = 0.0) -> Points:
    """Where rays meet level ground, shape (n, 2); straight between the corners. Raises HorizonError."""
    camera = np.asarray(camera_m, dtype=np.float64)
    down = -rays[:, 2]
    if camera[2] <= ground_m or not (down > 1e-12).all():
        raise HorizonError("a part of the image looks over the horizon")
    loop: Points = camera[:2] + rays[:, :2] * ((camera[2] - ground_m) / down)[:, None]
    return loop


def loop_on_ellipsoid(
    lon_deg: float, lat_deg: float, height_m: float, rays: Points, ground_m: float = 0.0
) -> Points:
    """Where rays meet WGS 84 raised by a height, as longitude and latitude in degrees, shape (n, 2).

    Parameters
    ----------
    height_m, ground_m
        Of the camera and of the ground, over the ellipsoid.
    rays
        East, north and up at the camera.

    Raises
    ------
    HorizonError
        A ray passes the Earth by.
    """
    from pyproj import Transformer

    to_centre = Transformer.from_crs("EPSG:4979", "EPSG:4978", always_xy=True)
    place = np.array(to_centre.transform(lon_deg, lat_deg, height_m))
    lon, lat = math.radians(lon_deg), math.radians(lat_deg)
    east = np.array([-math.sin(lon), math.cos(lon), 0.0])
    up = np.array([math.cos(lat) * math.cos(lon), math.cos(lat) * math.sin(lon), math.sin(lat)])
    directions = rays @ np.array([east, np.cross(up, east), up])
    axes = np.array([_EQUATOR_M + ground_m, _EQUATOR_M + ground_m, _POLE_M + ground_m])
    start, along = place / axes, directions / axes
    a, b, c = (along**2).sum(axis=1), (along * start).sum(axis=1), float((start**2).sum() - 1.0)
    root = b * b - a * c
    if c <= 0.0 or not ((root >= 0.0) & (b < 0.0)).all():
        raise HorizonError("a part of the image looks past the Earth")
    hits = place + directions * ((-b - np.sqrt(root)) / a)[:, None]
    back = Transformer.from_crs("EPSG:4978", "EPSG:4979", always_xy=True)
    lons, lats, _ = back.transform(hits[:, 0], hits[:, 1], hits[:, 2])
    return np.column_stack([lons, lats])


def loop_on_terrain(
    camera_m: ArrayLike, rays: Points, ground: GroundAt, step_m: float, most_m: float
) -> Points:
    """Where rays first meet the ground of a raster, shape (n, 2) in the local frame.

    Parameters
    ----------
    camera_m
        East, north, and altitude in the raster's datum.
    ground
        Its height at places.
    step_m
        How far over the ground a ray goes between two looks: half of a post's distance finds every ridge that
        the raster has.
    most_m
        Rays longer than this over the ground are given up.

    Raises
    ------
    HorizonError
        A ray meets no ground that is known within that distance.
    """
    camera = np.asarray(camera_m, dtype=np.float64)
    flat = np.hypot(rays[:, 0], rays[:, 1])
    # A ray straight down goes no way over the ground: it is followed by its height instead.
    pace = step_m / np.maximum(flat, 1e-3)
    below = np.zeros(len(rays))
    over = np.zeros(len(rays))
    open_ = np.ones(len(rays), dtype=bool)
    while open_.any():
        ahead = np.where(open_, over + pace, over)
        if (ahead[open_] * flat[open_] > most_m).any() or (ahead[open_] > 100.0 * most_m).any():
            raise HorizonError(f"a part of the image meets no ground within {most_m:g} m")
        at = camera + rays * ahead[:, None]
        height = ground(at[:, :2])
        if np.isnan(height[open_]).any():
            raise HorizonError("a part of the image lies on ground whose height is not known")
        under = open_ & (at[:, 2] <= height)
        below = np.where(under, ahead, below)
        over = np.where(open_ & ~under, ahead, over)
        open_ &= ~under
    for _ in range(_HALVINGS):
        middle = (over + below) / 2.0
        at = camera + rays * middle[:, None]
        under = at[:, 2] <= ground(at[:, :2])
        below, over = np.where(under, middle, below), np.where(under, over, middle)
    loop: Points = (camera + rays * below[:, None])[:, :2]
    return loop
