"""Points along straights and arcs, compiled; ``path.Segment.at`` is the plain twin.

A *segment* is one row: side (0 straight, +1 left, -1 right), east_m, north_m and angle_rad of its start,
length_m, radius_m.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from planner.jit import njit

TWO_PI = 2.0 * math.pi

Array = NDArray[np.float64]


@njit(cache=True)
def wrapped(angle_rad: float) -> float:
    """The same angle in (-π, π]; without rounding, as ``angles.wrap_pi``."""
    rest_rad = float(np.fmod(angle_rad, TWO_PI))
    if rest_rad > math.pi:
        return rest_rad - TWO_PI
    return rest_rad + TWO_PI if rest_rad <= -math.pi else rest_rad


@njit(cache=True)
def pieces(length_m: float, spacing_m: float) -> int:
    """How many equal parts a segment is cut into; 1 for an infinite spacing."""
    return max(1, math.ceil(length_m / spacing_m)) if math.isfinite(spacing_m) else 1


@njit(cache=True)
def sampled(segments: Array, max_chord_m: float, max_straight_m: float) -> Array:
    """Points along segments end to end; see ``path.Path.sample``.

    Returns
    -------
    ndarray
        float64, shape (N, 4): east_m, north_m, angle_rad, distance_m along the line.
    """
    count = 1
    for k in range(len(segments)):
        count += pieces(segments[k, 4], max_straight_m if segments[k, 0] == 0.0 else max_chord_m)
    points = np.empty((count, 4))
    at = 0
    travelled_m = 0.0
    for k in range(len(segments)):
        side, east_m, north_m, angle_rad = segments[k, 0], segments[k, 1], segments[k, 2], segments[k, 3]
        length_m, radius_m = segments[k, 4], segments[k, 5]
        parts = pieces(length_m, max_straight_m if side == 0.0 else max_chord_m)
        cosine, sine = math.cos(angle_rad), math.sin(angle_rad)
        for part in range(0 if k == 0 else 1, parts + 1):
            along_m = length_m * part / parts
            if side == 0.0:
                points[at, 0] = east_m + along_m * cosine
                points[at, 1] = north_m + along_m * sine
                points[at, 2] = angle_rad
            else:
                turned_rad = angle_rad + side * along_m / radius_m
                points[at, 0] = east_m + side * radius_m * (math.sin(turned_rad) - sine)
                points[at, 1] = north_m - side * radius_m * (math.cos(turned_rad) - cosine)
                points[at, 2] = wrapped(turned_rad)
            points[at, 3] = travelled_m + along_m
            at += 1
        travelled_m += length_m
    return points
