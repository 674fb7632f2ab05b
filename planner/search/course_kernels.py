"""Lines through waypoints with corners rounded, and the ground a disc flown along them sees."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from planner.jit import njit

Floats = NDArray[np.float64]

#: Corners bent less than this have no arc.
LEAST_BEND_RAD = 1e-6


@njit(cache=True, nogil=True)
def rounded(waypoints: Floats, radius_m: float, chord_m: float) -> tuple[Floats, float, float]:
    """A line through waypoints (N, 2), each corner an arc of a radius.

    Returns
    -------
    tuple
        Vertices (M, 2), on arcs no farther apart than ``chord_m``; length of straights; length of arcs. The
        latter are inf where the waypoints leave no room for the arcs.
    """
    count = len(waypoints)
    most = 2 + count * (4 + int(math.pi * radius_m / chord_m))
    points = np.empty((most, 2))
    points[0] = waypoints[0]
    size = 1
    straight_m, turned_m, before_m = 0.0, 0.0, 0.0
    for i in range(1, count):
        e, n = waypoints[i, 0] - waypoints[i - 1, 0], waypoints[i, 1] - waypoints[i - 1, 1]
        length_m = math.hypot(e, n)
        bend_rad, cut_m = 0.0, 0.0
        if length_m <= 0.0:
            return points[:1], np.inf, np.inf
        if i < count - 1:
            e2, n2 = waypoints[i + 1, 0] - waypoints[i, 0], waypoints[i + 1, 1] - waypoints[i, 1]
            bend_rad = math.atan2(e * n2 - n * e2, e * e2 + n * n2)
            if abs(bend_rad) > 3.1:
                return points[:1], np.inf, np.inf
            cut_m = radius_m * math.tan(abs(bend_rad) / 2.0)
        if before_m + cut_m > length_m + 1e-9:
            return points[:1], np.inf, np.inf
        straight_m += length_m - before_m - cut_m
        e, n = e / length_m, n / length_m
        begin_e, begin_n = waypoints[i, 0] - cut_m * e, waypoints[i, 1] - cut_m * n
        points[size, 0], points[size, 1] = begin_e, begin_n
        size += 1
        if abs(bend_rad) > LEAST_BEND_RAD:
            side = 1.0 if bend_rad > 0.0 else -1.0
            arc_m = radius_m * abs(bend_rad)
            turned_m += arc_m
            centre_e, centre_n = begin_e - side * radius_m * n, begin_n + side * radius_m * e
            pieces = max(1, math.ceil(arc_m / chord_m))
            for k in range(1, pieces + 1):
                angle = bend_rad * k / pieces
                cos, sin = math.cos(angle), math.sin(angle)
                off_e, off_n = begin_e - centre_e, begin_n - centre_n
                points[size, 0] = centre_e + cos * off_e - sin * off_n
                points[size, 1] = centre_n + sin * off_e + cos * off_n
                size += 1
        before_m = cut_m
    return points[:size], straight_m, turned_m


@njit(cache=True, nogil=True)
def disc_worth(
    points: Floats, reach_m: float, scores: Floats, west_m: float, south_m: float, cell_m: float
) -> float:
    """Sum of scores of the cells whose middle lies within a reach of a line, each once."""
    rows, columns = scores.shape
    seen = np.zeros((rows, columns), dtype=np.bool_)
    total = 0.0
    square = reach_m * reach_m
    for k in range(len(points) - 1):
        e0, n0 = points[k, 0], points[k, 1]
        de, dn = points[k + 1, 0] - e0, points[k + 1, 1] - n0
        squared = de * de + dn * dn
        first_row = max(0, math.floor((min(n0, n0 + dn) - reach_m - south_m) / cell_m))
        last_row = min(rows - 1, math.floor((max(n0, n0 + dn) + reach_m - south_m) / cell_m))
        first_column = max(0, math.floor((min(e0, e0 + de) - reach_m - west_m) / cell_m))
        last_column = min(columns - 1, math.floor((max(e0, e0 + de) + reach_m - west_m) / cell_m))
        for i in range(first_row, last_row + 1):
            n = south_m + (i + 0.5) * cell_m - n0
            for j in range(first_column, last_column + 1):
                if seen[i, j]:
                    continue
                e = west_m + (j + 0.5) * cell_m - e0
                along = 0.0
                if squared > 0.0:
                    along = min(1.0, max(0.0, (e * de + n * dn) / squared))
                off_e, off_n = e - along * de, n - along * dn
                if off_e * off_e + off_n * off_n <= square:
                    seen[i, j] = True
                    total += scores[i, j]
    return total
