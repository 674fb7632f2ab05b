"""How many photos see each cell of a grid, and how finely, compiled: each cell is put into each image."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from planner.airspace.terrain_kernels import ground_at
from planner.jit import njit

Floats = NDArray[np.float64]


@njit(cache=True, nogil=True)
def lay_photos(
    counts: NDArray[np.uint16],
    finest_m: NDArray[np.float32],
    west_m: float,
    south_m: float,
    step_m: float,
    cells_m: Floats,
    shots: Floats,
    half: Floats,
    pixel: float,
    flattest_tan: float,
    ground_m: Floats,
    ground_west_m: float,
    ground_south_m: float,
    ground_step_m: float,
) -> None:
    """Add photos to a grid.

    Parameters
    ----------
    counts, finest_m
        How many see each cell, and the least ground sampled distance; (rows, columns), northward.
    west_m, south_m, step_m
        Of the grid's corner and cells.
    cells_m
        Heights of the ground in the cells' middles, NaN where unknown; (rows, columns).
    shots
        (N, 12): see ``Shots.rows``.
    half
        Tangents of half the angles of view, across and upward: (2,).
    pixel
        Pixel pitch over focal length.
    flattest_tan
        Ground seen farther from the vertical than by this tangent is not looked at.
    ground_m, ground_west_m, ground_south_m, ground_step_m
        Terrain that may hide; empty for none.
    """
    rows, columns = cells_m.shape
    lowest_m, highest_m = math.inf, -math.inf
    for r in range(rows):
        for c in range(columns):
            if not math.isnan(cells_m[r, c]):
                lowest_m = min(lowest_m, cells_m[r, c])
    for r in range(ground_m.shape[0]):
        for c in range(ground_m.shape[1]):
            if not math.isnan(ground_m[r, c]):
                highest_m = max(highest_m, ground_m[r, c])
    for n in range(len(shots)):
        east, north, up = shots[n, 0], shots[n, 1], shots[n, 2]
        deepest_m = up - lowest_m
        if not deepest_m > 0.0:
            continue
        low_e, high_e, low_n, high_n = east, east, north, north
        for k in range(4):
            x = half[0] if k in (1, 2) else -half[0]
            y = half[1] if k >= 2 else -half[1]
            ray_e = shots[n, 3] + x * shots[n, 6] + y * shots[n, 9]
            ray_n = shots[n, 4] + x * shots[n, 7] + y * shots[n, 10]
            ray_u = shots[n, 5] + x * shots[n, 8] + y * shots[n, 11]
            flat = math.hypot(ray_e, ray_n)
            reach_m = flattest_tan * deepest_m
            if ray_u < 0.0 and flat < -ray_u * flattest_tan:
                reach_m = deepest_m * flat / -ray_u
                at_e = east + ray_e / max(flat, 1e-12) * reach_m
                at_n = north + ray_n / max(flat, 1e-12) * reach_m
                low_e, high_e = min(low_e, at_e), max(high_e, at_e)
                low_n, high_n = min(low_n, at_n), max(high_n, at_n)
            else:
                low_e, high_e = min(low_e, east - reach_m), max(high_e, east + reach_m)
                low_n, high_n = min(low_n, north - reach_m), max(high_n, north + reach_m)
        first_c = max(math.floor((low_e - west_m) / step_m), 0)
        last_c = min(math.floor((high_e - west_m) / step_m), columns - 1)
        first_r = max(math.floor((low_n - south_m) / step_m), 0)
        last_r = min(math.floor((high_n - south_m) / step_m), rows - 1)
        for r in range(first_r, last_r + 1):
            for c in range(first_c, last_c + 1):
                ground = cells_m[r, c]
                if math.isnan(ground):
                    continue
                d_e = west_m + (c + 0.5) * step_m - east
                d_n = south_m + (r + 0.5) * step_m - north
                d_u = ground - up
                if math.hypot(d_e, d_n) > -d_u * flattest_tan:
                    continue
                depth = d_e * shots[n, 3] + d_n * shots[n, 4] + d_u * shots[n, 5]
                if depth <= 0.0:
                    continue
                x = (d_e * shots[n, 6] + d_n * shots[n, 7] + d_u * shots[n, 8]) / depth
                y = (d_e * shots[n, 9] + d_n * shots[n, 10] + d_u * shots[n, 11]) / depth
                if abs(x) > half[0] or abs(y) > half[1]:
                    continue
                if ground_m.size and _hidden(
                    d_e, d_n, d_u, east, north, up, highest_m,
                    ground_m, ground_west_m, ground_south_m, ground_step_m,
                ):  # fmt: skip
                    continue
                # How the image moves with the place: over level ground its inverse is a pixel's ground.
                a = (shots[n, 6] - x * shots[n, 3]) / depth
                b = (shots[n, 7] - x * shots[n, 4]) / depth
                e = (shots[n, 9] - y * shots[n, 3]) / depth
                f = (shots[n, 10] - y * shots[n, 4]) / depth
                area = abs(a * f - b * e)
                if area <= 0.0:
                    continue
                gsd_m = pixel * math.sqrt(a * a + b * b + e * e + f * f + 2.0 * area) / (2.0 * area)
                if counts[r, c] < 65535:
                    counts[r, c] += 1
                finest_m[r, c] = min(finest_m[r, c], np.float32(gsd_m))


@njit(cache=True, nogil=True)
def _hidden(
    d_e: float,
    d_n: float,
    d_u: float,
    east: float,
    north: float,
    up: float,
    highest_m: float,
    ground_m: Floats,
    ground_west_m: float,
    ground_south_m: float,
    ground_step_m: float,
) -> bool:
    """Whether ground stands between a place, told from the camera, and the camera."""
    flat = math.hypot(d_e, d_n)
    count = int(flat / (0.5 * ground_step_m))
    for k in range(1, count + 1):
        share = 1.0 - k / (count + 1.0)
        level_m = up + share * d_u
        if level_m > highest_m:
            return False
        there_m = ground_at(
            ground_m, ground_west_m, ground_south_m, ground_step_m, east + share * d_e, north + share * d_n
        )
        # Unknown ground may stand there; a decimetre is what interpolation between posts may say too much.
        if math.isnan(there_m) or there_m > level_m + 0.1:
            return True
    return False
