"""Places of a region at which the judge looks at what photos see, and finer ones where none sees it."""

from __future__ import annotations

import math

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import MultiPolygon, Polygon

Floats = NDArray[np.float64]

#: Places are a metre apart, or so that a region has no more than this many.
MOST_PLACES = 60_000
#: Where a place is not seen, its square is looked at in so many parts either way.
PARTS = 20


def grid_over(area: Polygon | MultiPolygon) -> Floats:
    """Places of a grid inside an area, and of its outline just inside, (M, 2)."""
    step_m = _step_m(area)
    west, south, east, north = area.bounds
    east_m, north_m = np.meshgrid(
        np.arange(west + step_m / 2.0, east, step_m), np.arange(south + step_m / 2.0, north, step_m)
    )
    shapely.prepare(area)
    inside = shapely.contains_xy(area, east_m, north_m)
    inner = area.buffer(-min(0.01, step_m / 100.0))
    outline = shapely.get_coordinates(shapely.segmentize(inner, step_m))
    return np.concatenate([np.column_stack([east_m[inside], north_m[inside]]), outline])


def subdivided(area: Polygon | MultiPolygon, places_m: Floats) -> tuple[Floats, float]:
    """Of the squares that places of a grid over an area stand for, what lies inside, by a finer grid.

    Returns
    -------
    ndarray
        The finer grid's places, (N, 2), each once.
    float
        Ground that each stands for, in m².
    """
    step_m = _step_m(area)
    fine_m = step_m / PARTS
    cells = np.floor(places_m / fine_m).astype(np.int64)
    around = np.arange(-(PARTS // 2) - 1, PARTS // 2 + 1)
    offsets = np.stack(np.meshgrid(around, around), axis=-1).reshape(-1, 2)
    found = (np.unique((cells[:, None] + offsets).reshape(-1, 2), axis=0) + 0.5) * fine_m
    shapely.prepare(area)
    return found[shapely.contains_xy(area, found[:, 0], found[:, 1])], fine_m**2


def _step_m(area: Polygon | MultiPolygon) -> float:
    return max(1.0, math.sqrt(area.area / MOST_PLACES))
