"""Elevation rasters for tests: surfaces known in closed form, round a place."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from planner.airspace.terrain import Ground, Terrain
from planner.frames import LocalFrame

Surface = Callable[[NDArray[np.float64], NDArray[np.float64]], NDArray[np.float64]]


def raster(
    surface: Surface, frame: LocalFrame, half_deg: float = 0.1, posts: int = 241, name: str = "t"
) -> Terrain:
    """A surface, a function of metres east and north of a frame's origin, sampled on a grid of degrees."""
    lon = frame.lon_deg + np.linspace(-half_deg, half_deg, posts)
    lat = frame.lat_deg + np.linspace(half_deg, -half_deg, posts)
    places = frame.north_up(frame.to_local(np.stack(np.meshgrid(lon, lat), axis=-1)))
    step_deg = 2.0 * half_deg / (posts - 1)
    affine = (step_deg, 0.0, float(lon[0]), 0.0, -step_deg, float(lat[0]))
    heights = surface(places[..., 0], places[..., 1])
    return Terrain(name, np.asarray(heights, dtype=np.float32), affine)


def grid(surface: Surface, half_m: float = 3000.0, step_m: float = 10.0) -> Ground:
    """A surface on a local grid round the origin."""
    axis = np.arange(-half_m, half_m + step_m / 2.0, step_m)
    east, north = np.meshgrid(axis, axis)
    return Ground("t", "EGM96", np.asarray(surface(east, north), dtype=np.float64), -half_m, -half_m, step_m)
