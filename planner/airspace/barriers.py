"""Zones as rows for the first estimates of what lies between two poses.

A disc is a row (east, north, radius). Where some are polygons or may be crossed at a price, rows have eight
columns: a price for each metre inside (inf where there is none), the unit vector along a polygon's rectangle,
and half its length and half its width, 0 for discs. A polygon's radius is that of the circle round it.
"""

from __future__ import annotations

import math

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import Polygon

Floats = NDArray[np.float64]

COLUMNS = 8


def polygon_rows(polygons: tuple[Polygon, ...]) -> Floats:
    """Polygons as rectangles, (P, 8): the least one round each, as large as the hull's area makes it.

    What is not in the hull, at corners that a triangle lacks, is not to be gone round: the rectangle is made
    smaller by as much.
    """
    rows = []
    for polygon in polygons:
        hull = polygon.convex_hull
        corners = shapely.get_coordinates(shapely.minimum_rotated_rectangle(hull))[:4]
        if len(corners) < 4:
            continue
        along, across = corners[1] - corners[0], corners[2] - corners[1]
        length_m, width_m = float(np.hypot(*along)), float(np.hypot(*across))
        if length_m * width_m <= 0.0:
            continue
        scale = math.sqrt(hull.area / (length_m * width_m))
        half = scale * length_m / 2.0, scale * width_m / 2.0
        middle, unit = corners.mean(axis=0), along / length_m
        rows.append((*middle, math.hypot(*half), math.inf, *unit, *half))
    return np.array(rows, dtype=np.float64).reshape(-1, COLUMNS)


def rows_of(hard: Floats, soft: Floats, prices: Floats, polygons: Floats) -> Floats:
    """All zones: (K, 3) where discs that are gone round are all there is, else (K, 8).

    ``prices`` are those of the soft discs, inf where a way round is always taken.
    """
    if len(polygons) == 0 and not np.isfinite(prices).any():
        return np.concatenate([hard, soft])
    discs = np.concatenate([hard, soft])
    rows = np.zeros((len(discs), COLUMNS))
    rows[:, :3] = discs
    rows[:, 3] = np.inf
    rows[len(hard) :, 3] = prices
    return np.concatenate([rows, polygons])
