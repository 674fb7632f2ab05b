"""Walks over cells as strips of ground to see, in flight order: importance for aircraft that turn.

Cells are as wide as the swath. A straight run of the walk is a strip; where the walk turns, the corner's cell
belongs to the strip before the turn. Runs over cells seen before are no strips: the flight goes on as is
shortest.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry

from planner.progress import Stop, never
from planner.search.importance.auto import auto
from planner.search.importance.grid import ImportanceGrid, Ints
from planner.search.importance.snyder2021 import snyder2021
from planner.search.importance.walk import Walk
from planner.search.values import Worth

Floats = NDArray[np.float64]
Place = tuple[float, float]

#: Cells to a side, and moves, at most: wider cells then leave gaps, or less of the budget is walked.
MOST_SIDE, MOST_MOVES = 100, 400
#: Parts of the budget that are walked: turns take the rest.
PARTS = (1.0, 0.85, 0.7, 0.55, 0.4)

#: The paper's largest score, on whose scale its distances and penalties are.
TOP_SCORE = 100.0


def _ours(grid: ImportanceGrid, base: int, battery: int, enough: Stop) -> Walk:
    return auto(grid, base, battery, enough=enough, thorough=False)


def _published(grid: ImportanceGrid, base: int, battery: int, _: Stop) -> Walk:
    """The published algorithm, with worth on the paper's scale."""
    top = float(grid.worth.max())
    scaled = replace(grid, worth=grid.worth * (TOP_SCORE / top)) if top > 0.0 else grid
    return snyder2021(scaled, base, battery)


#: How a walk is planned, by name. Its strips are refined as those of any pattern.
WALKS: dict[str, Callable[[ImportanceGrid, int, int, Stop], Walk]] = {
    "importance": _ours,
    "snyder2021": _published,
}


@dataclass(frozen=True, slots=True, eq=False)
class Cells:
    """Cells as wide as a swath over ground, with where they lie."""

    grid: ImportanceGrid
    west_m: float
    south_m: float

    @classmethod
    def of(cls, worth: Worth, width_m: float, free: BaseGeometry) -> Cells:
        """Cells of the worth of ground, those blocked whose middle is not free."""
        rows, columns = worth.scores.shape
        side_m = worth.cell_m * max(rows, columns)
        cell_m = max(width_m, side_m / MOST_SIDE)
        north_count = max(1, math.ceil(rows * worth.cell_m / cell_m - 1e-9))
        east_count = max(1, math.ceil(columns * worth.cell_m / cell_m - 1e-9))
        centres = worth.centres_m
        row = np.minimum(((centres[..., 1] - worth.south_m) / cell_m).astype(np.int64), north_count - 1)
        column = np.minimum(((centres[..., 0] - worth.west_m) / cell_m).astype(np.int64), east_count - 1)
        total = np.zeros((north_count, east_count))
        np.add.at(total, (row, column), worth.scores * worth.cell_m**2)
        east = worth.west_m + cell_m * (np.arange(east_count) + 0.5)
        north = worth.south_m + cell_m * (np.arange(north_count) + 0.5)
        shapely.prepare(free)
        blocked = np.logical_not(shapely.intersects_xy(free, *np.meshgrid(east, north)))
        return cls(ImportanceGrid(total, blocked, cell_m), worth.west_m, worth.south_m)

    def centre_m(self, cell: int) -> Floats:
        """Of a cell."""
        row, column = divmod(cell, self.grid.shape[1])
        return np.array([self.west_m, self.south_m]) + self.grid.cell_m * (np.array([column, row]) + 0.5)

    def nearest(self, place_m: Place) -> int | None:
        """The open cell nearest to a place; None where all are blocked."""
        free = np.flatnonzero(~self.grid.blocked.reshape(-1))
        if not len(free):
            return None
        row, column = np.divmod(free, self.grid.shape[1])
        east = self.west_m + self.grid.cell_m * (column + 0.5)
        north = self.south_m + self.grid.cell_m * (row + 0.5)
        return int(free[np.argmin(np.hypot(east - place_m[0], north - place_m[1]))])

    def strips(self, walk: Ints) -> Floats:
        """Middle lines (N, 2, 2) of the walk's runs over cells not seen before."""
        half = 0.5 * self.grid.cell_m
        seen: set[int] = set()
        found: list[tuple[Floats, Floats]] = []
        for run in _runs(walk, self.grid.shape[1]):
            new = [cell for cell in run if cell not in seen]
            seen.update(run)
            if not new:
                continue
            first, last = self.centre_m(new[0]), self.centre_m(new[-1])
            ahead = self.centre_m(run[-1]) - self.centre_m(run[0])
            ahead = ahead / max(float(np.hypot(*ahead)), 1e-9) if len(run) > 1 else np.array([1.0, 0.0])
            found.append((first - half * ahead, last + half * ahead))
        return np.array(found) if found else np.empty((0, 2, 2))


def _runs(walk: Ints, columns: int) -> Iterator[list[int]]:
    """Straight runs of a walk, the corners in both."""
    cells = walk.tolist()
    run = cells[:1]
    for k in range(1, len(cells)):
        if len(run) > 1 and cells[k] - cells[k - 1] != run[-1] - run[-2]:
            yield run
            run = run[-1:]
        run.append(cells[k])
    yield run


def walked(
    name: str,
    worth: Worth,
    width_m: float,
    free: BaseGeometry,
    ends_m: tuple[Place, Place],
    budget_m: float,
    enough: Stop = never,
) -> Iterator[Floats]:
    """Strips of walks within parts of a budget, from and to the cell nearest to the ends.

    Parameters
    ----------
    name
        One of ``WALKS``.
    ends_m
        Where the flight begins and ends.
    budget_m
        For all of it; inf walks no farther than ``MOST_MOVES``.
    enough
        Asked between steps: each walk is then the best found.
    """
    cells = Cells.of(worth, width_m, free)
    base = cells.nearest(ends_m[0])
    if base is None:
        return
    there = tuple(cells.centre_m(base).tolist())
    spare_m = budget_m - math.dist(ends_m[0], there) - math.dist(there, ends_m[1])
    tried = set()
    for part in PARTS:
        moves = int(min(part * max(spare_m, 0.0) / cells.grid.cell_m, MOST_MOVES, 2 * cells.grid.worth.size))
        if moves < 2 or moves in tried:
            continue
        tried.add(moves)
        strips = cells.strips(WALKS[name](cells.grid, base, moves, enough).cells)
        if len(strips):
            yield strips
