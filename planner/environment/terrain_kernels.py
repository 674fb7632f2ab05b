"""Heights on the local grid, compiled: between its posts the surface is bilinear."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]


@njit(cache=True)
def ground_at(
    heights_m: Array, west_m: float, south_m: float, step_m: float, e_m: float, n_m: float
) -> float:
    """Height at one place; NaN off the grid and beside a post without height.

    Parameters
    ----------
    heights_m
        float64, shape (rows, columns): northward, then eastward.
    west_m, south_m, step_m
        Place of ``heights_m[0, 0]`` and the distance between posts.
    """
    x, y = (e_m - west_m) / step_m, (n_m - south_m) / step_m
    rows, columns = heights_m.shape
    if not (0.0 <= x <= columns - 1.0 and 0.0 <= y <= rows - 1.0):
        return math.nan
    i, j = min(int(y), rows - 2), min(int(x), columns - 2)
    u, v = x - j, y - i
    low = heights_m[i, j] * (1.0 - u) + heights_m[i, j + 1] * u
    high = heights_m[i + 1, j] * (1.0 - u) + heights_m[i + 1, j + 1] * u
    height_m: float = low * (1.0 - v) + high * v
    return height_m


@njit(cache=True)
def grounds_at(heights_m: Array, west_m: float, south_m: float, step_m: float, places_m: Array) -> Array:
    """Heights at places, float64 (N, 2) east_m and north_m; returns float64 (N,)."""
    found = np.empty(len(places_m))
    for k in range(len(places_m)):
        found[k] = ground_at(heights_m, west_m, south_m, step_m, places_m[k, 0], places_m[k, 1])
    return found
