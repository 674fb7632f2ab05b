"""How high to fly over a raster so that no ground ahead is too steep to climb, compiled."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from planner.jit import njit

Array = NDArray[np.float64]

#: Steps to neighbours on one side of a post, rows and columns: distances along them are never shorter than
#: straight ones, and no more than this much longer.
STEPS = ((0, -1), (-1, 0), (-1, -1), (-1, 1), (-1, -2), (-1, 2), (-2, -1), (-2, 1))
LONGER = 1.0275


@njit(cache=True, nogil=True)
def envelope(heights_m: Array, step_m: float, slope: float) -> Array:
    """The lowest surface on or over a raster that is nowhere steeper than a slope.

    The greatest of h − slope · d over all posts, d being the distance along steps to neighbours: one sweep
    with those behind, and one back with those ahead (chamfer distances; G. Borgefors, "Distance
    transformations in digital images", 1986).

    Parameters
    ----------
    heights_m
        float64, shape (rows, columns); NaN where nothing is known, which lifts nothing.
    step_m
        Distance between posts.
    slope
        Metres up for one along.

    Returns
    -------
    Array
        float64, shape (rows, columns); -inf where no post is known at all.
    """
    rows, columns = heights_m.shape
    found = np.where(np.isnan(heights_m), -math.inf, heights_m)
    for sign in (1, -1):
        for k in range(rows):
            i = k if sign > 0 else rows - 1 - k
            for m in range(columns):
                j = m if sign > 0 else columns - 1 - m
                best_m = found[i, j]
                for down, right in STEPS:
                    row, column = i + sign * down, j + sign * right
                    if row < 0 or row >= rows or column < 0 or column >= columns:
                        continue
                    along_m = step_m * math.sqrt(float(down * down + right * right))
                    best_m = max(best_m, found[row, column] - slope * along_m)
                found[i, j] = best_m
    return found
