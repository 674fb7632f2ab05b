"""Cells to walk over, and the worth of ground from polygons, points that spread and rasters."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from shapely import area, box, covers, intersection, points, prepare
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from planner.search.values import Worth

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]
Ints = NDArray[np.int64]

#: East, north, west and south: moves to the cells that share an edge.
MOVES = ((0, 1), (1, 0), (0, -1), (-1, 0))


@dataclass(frozen=True, slots=True, eq=False)
class ImportanceGrid:
    """What seeing each cell is worth.

    Parameters
    ----------
    worth
        float64 (rows, columns), each finite and >= 0: what seeing the whole cell once is worth. Row 0 is the
        southernmost, column 0 the westernmost.
    blocked
        bool (rows, columns): cells that must not be flown over.
    cell_m
        Edge of a cell.
    """

    worth: Floats
    blocked: Bools
    cell_m: float = 1.0

    def __post_init__(self) -> None:
        if self.worth.ndim != 2 or self.worth.shape != self.blocked.shape or not self.worth.size:
            raise ValueError("worth and blocked: one value for each cell of the same grid")
        if not (np.isfinite(self.worth).all() and (self.worth >= 0.0).all()):
            raise ValueError("worth: every value finite and at least 0")
        if not (math.isfinite(self.cell_m) and self.cell_m > 0.0):
            raise ValueError("cell_m: finite and above 0")

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        rows, columns = self.worth.shape
        return rows, columns

    def neighbours(self) -> Ints:
        """int64 (cells, 4): open cells that share an edge with each, row by row; -1 where there is none."""
        rows, columns = self.shape
        index = np.arange(rows * columns).reshape(rows, columns)
        padded = np.full((rows + 2, columns + 2), -1, dtype=np.int64)
        padded[1:-1, 1:-1] = np.where(self.blocked, -1, index)
        found = [padded[1 + north : 1 + north + rows, 1 + east : 1 + east + columns] for north, east in MOVES]
        beside = np.stack(found, axis=-1).reshape(-1, 4)
        beside[self.blocked.reshape(-1)] = -1
        return np.ascontiguousarray(beside)


def over(worth: Worth, free: BaseGeometry | None = None) -> ImportanceGrid:
    """The cells of searched ground, blocked where their middle is not free."""
    blocked: Bools = np.zeros(worth.scores.shape, dtype=np.bool_)
    if free is not None:
        prepare(free)
        blocked = np.logical_not(covers(free, points(worth.centres_m)))
    return ImportanceGrid(worth.scores * worth.cell_m**2, blocked, worth.cell_m)


def with_polygons(worth: Worth, scored: Sequence[tuple[Polygon, float]]) -> Worth:
    """Add polygons of a score per square metre: a cell gets that of the part of it that they cover."""
    half = 0.5 * worth.cell_m
    east, north = worth.centres_m[..., 0], worth.centres_m[..., 1]
    cells = box(east - half, north - half, east + half, north + half)
    scores = worth.scores.copy()
    for polygon, score in scored:
        scores += score * area(intersection(cells, polygon)) / worth.cell_m**2
    return replace(worth, scores=scores)


def with_points(worth: Worth, weighted: Sequence[tuple[float, float, float, float]]) -> Worth:
    """Add points that spread: each east, north, spread (all metres) and what all of it is worth.

    The worth lies about the point as a normal distribution of that standard deviation.
    """
    east, north = worth.centres_m[..., 0], worth.centres_m[..., 1]
    scores = worth.scores.copy()
    for at_east, at_north, spread_m, total in weighted:
        bell = np.exp(-0.5 * ((east - at_east) ** 2 + (north - at_north) ** 2) / spread_m**2)
        scores += total * bell / (2.0 * math.pi * spread_m**2)
    return replace(worth, scores=scores)


def with_samples(worth: Worth, per_m2: Floats) -> Worth:
    """Add a raster sampled at the middles of the cells; where it tells nothing, NaN, nothing is added."""
    return replace(worth, scores=worth.scores + np.nan_to_num(per_m2, nan=0.0))


def seen(worth: Worth, fraction: Floats, detection: float = 1.0) -> Worth:
    """What is left after a part of each cell was seen, by a sensor of a probability of detection."""
    return replace(worth, scores=worth.scores * (1.0 - np.clip(fraction, 0.0, 1.0) * detection))
