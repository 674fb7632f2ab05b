"""Heights on the local grid, compiled: between its posts the surface is bilinear."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from planner.jit import njit

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


@njit(cache=True)
def heights_between(
    heights_m: Array, west_m: float, south_m: float, step_m: float, box: Array
) -> tuple[float, float]:
    """Lowest and highest of the posts round a box (west, south, east, north): no ground in it is beyond.

    inf and -inf where the grid knows none.
    """
    rows, columns = heights_m.shape
    lowest_m, highest_m = math.inf, -math.inf
    if not (box[0] <= box[2] and box[1] <= box[3]):
        return lowest_m, highest_m
    first_row = max(0, math.floor((box[1] - south_m) / step_m) - 1)
    last_row = min(rows, math.ceil((box[3] - south_m) / step_m) + 2)
    first = max(0, math.floor((box[0] - west_m) / step_m) - 1)
    last = min(columns, math.ceil((box[2] - west_m) / step_m) + 2)
    for i in range(first_row, last_row):
        for j in range(first, last):
            # Comparisons with NaN are false: posts without height do not count.
            if heights_m[i, j] < lowest_m:
                lowest_m = heights_m[i, j]
            if heights_m[i, j] > highest_m:
                highest_m = heights_m[i, j]
    return lowest_m, highest_m
