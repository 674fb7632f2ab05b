"""Boustrophedon cells: free ground between the places where a slice of it is cut or joined (Choset 2000)."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.affinity import rotate
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from planner.coverage.urban.lanes_kernels import level_pieces
from planner.coverage.urban.visibility import edges_of

Floats = NDArray[np.float64]

#: Slices nearer than this are one.
GRID_M = 1e-6
#: Pieces of two slices that share less are not joined.
LEAST_SHARED_M = 1e-5
#: Smaller cells are rounding.
LEAST_CELL_M2 = 1e-3


@dataclass(frozen=True, slots=True)
class Cell:
    """A cell that every slice meets in one piece.

    Parameters
    ----------
    outline
        As the ground lies.
    halves
        The same cut in two down the middle of its slices, western half first.
    low, high
        The nodes of the Reeb graph that it lies between: critical places of the slice.
    """

    outline: BaseGeometry
    halves: tuple[BaseGeometry, BaseGeometry]
    low: int
    high: int


def cells(ground: BaseGeometry, direction_rad: float) -> tuple[Cell, ...]:
    """Cells of free ground for slices along a direction, swept to the left of it.

    A cell begins and ends where slices split, join, appear or vanish; bends of its sides do not end it.
    """
    turned = shapely.set_precision(
        rotate(ground, -direction_rad, origin=(0.0, 0.0), use_radians=True), GRID_M
    )
    edges = edges_of(turned)
    levels = np.unique(edges[:, 1])
    mirrored = edges * np.array([1.0, -1.0, 1.0, -1.0])
    growing: list[_Growing] = []
    done: list[_Growing] = []
    node = 0
    above: list[Floats] = []
    for low, high in itertools.pairwise(levels):
        # just above the lower level and just below the upper one the same edges are crossed
        bottoms, _ = level_pieces(edges, np.array([low]), -1.0)
        tops, _ = level_pieces(mirrored, np.array([-high]), -1.0)
        shared = [
            [k for k, bottom in enumerate(bottoms) if _overlap(before, bottom) > LEAST_SHARED_M]
            for before in above
        ]
        here: list[_Growing | None] = [None] * len(bottoms)
        for group_below, group_above in _groups(shared, len(bottoms)):
            if len(group_below) == 1 and len(group_above) == 1:
                here[group_above[0]] = growing[group_below[0]]
                continue
            for k in group_below:
                growing[k].high = node
                done.append(growing[k])
            for k in group_above:
                here[k] = _Growing(node)
            node += 1
        growing = [each for each in here if each is not None]
        for cell, bottom, top in zip(growing, bottoms, tops, strict=True):
            cell.rows += [(low, *bottom), (high, *top)]
        above = list(tops)
    for cell in growing:
        cell.high = node
        node += 1
        done.append(cell)
    made = (cell.made(direction_rad) for cell in done)
    return tuple(cell for cell in made if cell.outline.area >= LEAST_CELL_M2)


class _Growing:
    """A cell while slices are added: ordinate, west and east."""

    def __init__(self, low: int) -> None:
        self.low, self.high = low, -1
        self.rows: list[tuple[float, float, float]] = []

    def made(self, direction_rad: float) -> Cell:
        rows = np.array(self.rows)
        level, west, east = rows.T
        middle = (west + east) / 2.0
        shapes = [
            _between(level, *sides, direction_rad) for sides in ((west, east), (west, middle), (middle, east))
        ]
        return Cell(shapes[0], (shapes[1], shapes[2]), self.low, self.high)


def _between(level: Floats, west: Floats, east: Floats, direction_rad: float) -> BaseGeometry:
    ring = np.vstack([np.column_stack([west, level]), np.column_stack([east, level])[::-1]])
    shape: BaseGeometry = rotate(Polygon(ring), direction_rad, origin=(0.0, 0.0), use_radians=True)
    if shape.is_valid:
        return shape
    # a half is pinched where a slice jumps so far aside that its middle is outside of the one before
    made: BaseGeometry = shapely.make_valid(shape, method="structure", keep_collapsed=False)
    return made


def _overlap(one: Floats, other: Floats) -> float:
    return float(min(one[1], other[1]) - max(one[0], other[0]))


def _groups(shared: list[list[int]], count: int) -> list[tuple[list[int], list[int]]]:
    """Pieces below and above a level that hang together, those that nothing joins each for itself."""
    groups: list[tuple[list[int], list[int]]] = []
    owner: dict[int, int] = {}
    for below, aboves in enumerate(shared):
        at = {owner[k] for k in aboves if k in owner}
        members: tuple[list[int], list[int]] = ([below], [k for k in aboves if k not in owner])
        for index in sorted(at):
            members[0].extend(groups[index][0])
            members[1].extend(groups[index][1])
            groups[index] = ([], [])
        groups.append(members)
        owner.update(dict.fromkeys(members[1], len(groups) - 1))
    loose: list[tuple[list[int], list[int]]] = [([], [k]) for k in range(count) if k not in owner]
    return [group for group in [*groups, *loose] if group[0] or group[1]]
