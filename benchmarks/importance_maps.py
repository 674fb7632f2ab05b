"""Twenty pinned maps of importance of 15 × 15 cells, after Snyder et al. (2021), and a large one.

The paper's scores are 0, 1, 10 and 100, its bases (7, 6) and (13, 8) (column and row; row 0 in the south
here), its batteries 20 to 60 moves. It draws two maps, one of normal distributions and one of an island, and
prints neither: these are of its kinds, hills of scores and flows from a summit over an island, and scattered
cells as in its figure 4.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planner.search.importance.grid import ImportanceGrid

SIDE = 15
SCORES = np.array([0.0, 1.0, 10.0, 100.0])
BASES = ((7, 6), (13, 8))
BATTERIES = (20, 30, 40, 50, 60)
KINDS = ("hills", "scattered", "island", "scattered")

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class ImportanceMap:
    """One map: its kind, worth by cell, the base's cell and the battery in moves."""

    name: str
    grid: ImportanceGrid
    base: int
    battery: int


def maps() -> Iterator[ImportanceMap]:
    """The twenty."""
    generator = np.random.default_rng(2021)
    for index in range(20):
        kind = KINDS[index % len(KINDS)]
        worth = {"hills": _hills, "scattered": _scattered, "island": _island}[kind](generator)
        column, row = BASES[(index // 2) % 2]
        yield ImportanceMap(
            f"{index:02d}-{kind}", _open(worth), row * SIDE + column, BATTERIES[index % len(BATTERIES)]
        )


def large(side: int = 200) -> ImportanceMap:
    """Hills on a large map, worth by the height of the hill."""
    generator = np.random.default_rng(200)
    worth = 100.0 * _bells(generator, side, 12, (0.04, 0.15))
    return ImportanceMap(f"hills-{side}", _open(worth), side // 2 * side + side // 2, side)


def _open(worth: Floats) -> ImportanceGrid:
    return ImportanceGrid(worth, np.zeros(worth.shape, dtype=np.bool_))


def _bells(generator: np.random.Generator, side: int, count: int, spread: tuple[float, float]) -> Floats:
    row, column = np.mgrid[0:side, 0:side]
    height = np.zeros((side, side))
    for _ in range(count):
        north, east = generator.uniform(0.0, side, 2)
        wide = side * generator.uniform(*spread)
        top = generator.uniform(0.5, 1.0)
        height += top * np.exp(-((row - north) ** 2 + (column - east) ** 2) / (2.0 * wide**2))
    return height


def _graded(height: Floats, parts: tuple[float, float, float]) -> Floats:
    return SCORES[np.searchsorted(np.quantile(height, parts), height)]


def _hills(generator: np.random.Generator) -> Floats:
    return _graded(_bells(generator, SIDE, 3, (0.1, 0.27)), (0.4, 0.7, 0.9))


def _scattered(generator: np.random.Generator) -> Floats:
    return generator.choice(SCORES, p=(0.25, 0.35, 0.25, 0.15), size=(SIDE, SIDE))


def _island(generator: np.random.Generator) -> Floats:
    """An island round: nothing at sea, flows of most importance down from a summit, less beside them."""
    row, column = np.mgrid[0:SIDE, 0:SIDE]
    middle = (SIDE - 1) / 2.0
    shore = middle * (0.95 + 0.1 * generator.uniform(-1.0, 1.0))
    land = np.hypot(row - middle, column - middle) <= shore
    near = np.full((SIDE, SIDE), np.inf)
    for _ in range(3):
        at = np.array([middle, middle]) + generator.uniform(-2.0, 2.0, 2)
        course = generator.uniform(0.0, 2.0 * np.pi)
        for _ in range(8):
            near = np.minimum(near, np.hypot(row - at[0], column - at[1]))
            course += generator.normal(0.0, 0.5)
            at = at + np.array([np.sin(course), np.cos(course)])
    score = np.select([near < 0.6, near < 1.6, near < 3.0], [100.0, 10.0, 1.0], 0.0)
    return np.where(land, score, 0.0)
