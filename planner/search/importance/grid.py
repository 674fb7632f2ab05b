"""Importance on a grid of square cells, whatever it was given as."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from shapely import area, box, covers, intersection, points, prepare
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

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
        Side of a cell.
    west_m, south_m
        The grid's south-west corner in the local frame.
    """

    worth: Floats
    blocked: Bools
    cell_m: float = 1.0
    west_m: float = 0.0
    south_m: float = 0.0

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

    def centres_m(self) -> tuple[Floats, Floats]:
        """East and north of the centres, each (rows, columns)."""
        rows, columns = self.shape
        east = self.west_m + self.cell_m * (np.arange(columns) + 0.5)
        north = self.south_m + self.cell_m * (np.arange(rows) + 0.5)
        grid: tuple[Floats, ...] = tuple(np.meshgrid(east, north))
        return grid[0], grid[1]

    def neighbours(self) -> Ints:
        """int64 (cells, 4): the open cells that share an edge with each (row by row), -1 where there is none."""
        rows, columns = self.shape
        index = np.arange(rows * columns).reshape(rows, columns)
        padded = np.full((rows + 2, columns + 2), -1, dtype=np.int64)
        padded[1:-1, 1:-1] = np.where(self.blocked, -1, index)
        found = [
            padded[1 + north : 1 + north + rows, 1 + east : 1 + east + columns] for north, east in MOVES
        ]
        beside = np.stack(found, axis=-1).reshape(-1, 4)
        beside[self.blocked.reshape(-1)] = -1
        return np.ascontiguousarray(beside)

    def seen(self, fraction: Floats, detection: float = 1.0) -> ImportanceGrid:
        """The grid after a part of each cell was seen, by a sensor that finds with a probability what it sees."""
        left = 1.0 - np.clip(fraction, 0.0, 1.0) * detection
        return replace(self, worth=self.worth * left)


def framed(outline: BaseGeometry, cell_m: float) -> ImportanceGrid:
    """A grid of nothing over an outline (metres in the local frame); cells centred outside it are blocked."""
    west, south, east, north = outline.bounds
    columns = max(1, math.ceil((east - west) / cell_m - 1e-9))
    rows = max(1, math.ceil((north - south) / cell_m - 1e-9))
    empty = ImportanceGrid(
        np.zeros((rows, columns)), np.zeros((rows, columns), dtype=np.bool_), cell_m, west, south
    )
    prepare(outline)
    return replace(empty, blocked=~covers(outline, points(*empty.centres_m())))


def with_polygons(grid: ImportanceGrid, scored: Sequence[tuple[Polygon, float]]) -> ImportanceGrid:
    """Add polygons of a score per square metre: a cell gets that of the part of it that they cover."""
    east, north = grid.centres_m()
    half = 0.5 * grid.cell_m
    cells = box(east - half, north - half, east + half, north + half)
    worth = grid.worth.copy()
    for polygon, score in scored:
        worth += score * area(intersection(cells, polygon))
    return replace(grid, worth=worth)


def with_points(grid: ImportanceGrid, weighted: Sequence[tuple[float, float, float, float]]) -> ImportanceGrid:
    """Add points that spread: each east, north, spread (all metres) and what all of it is worth.

    The worth lies about the point as a normal distribution of that standard deviation.
    """
    east, north = grid.centres_m()
    worth = grid.worth.copy()
    for at_east, at_north, spread_m, total in weighted:
        bell = np.exp(-0.5 * ((east - at_east) ** 2 + (north - at_north) ** 2) / spread_m**2)
        worth += total * bell * grid.cell_m**2 / (2.0 * math.pi * spread_m**2)
    return replace(grid, worth=worth)


def with_samples(grid: ImportanceGrid, per_m2: Floats) -> ImportanceGrid:
    """Add a raster sampled at the centres of the cells, worth a square metre; not a number is nothing."""
    return replace(grid, worth=grid.worth + np.nan_to_num(per_m2, nan=0.0) * grid.cell_m**2)
