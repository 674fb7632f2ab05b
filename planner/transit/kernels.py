"""Compiled parts of tree searches: a binary heap and a hash grid of poses.

Both live in arrays of the caller's: ``keys`` float64 and ``items`` int64 hold the heap; ``heads`` int64
(BUCKETS), all -1 at first, and ``chain`` int64 (one an item) hold the grid.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from planner.jit import njit

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

BUCKETS = 1 << 16


@njit(cache=True)
def wrap(angle_rad: float) -> float:
    """The same angle in [-π, π)."""
    return (angle_rad + math.pi) % (2.0 * math.pi) - math.pi


@njit(cache=True)
def push(keys: Array, items: Indices, size: int, key: float, item: int) -> int:
    """Binary heap; equal keys leave in order of item, so runs repeat exactly."""
    place = size
    while place > 0:
        above = (place - 1) >> 1
        if keys[above] < key or (keys[above] == key and items[above] < item):
            break
        keys[place] = keys[above]
        items[place] = items[above]
        place = above
    keys[place] = key
    items[place] = item
    return size + 1


@njit(cache=True)
def pop(keys: Array, items: Indices, size: int) -> tuple[int, int]:
    """The item of least key, and how many are left."""
    top = items[0]
    size -= 1
    key, item = keys[size], items[size]
    place = 0
    while True:
        below = 2 * place + 1
        if below >= size:
            break
        right = below + 1
        if right < size and (
            keys[right] < keys[below] or (keys[right] == keys[below] and items[right] < items[below])
        ):
            below = right
        if key < keys[below] or (key == keys[below] and item < items[below]):
            break
        keys[place] = keys[below]
        items[place] = items[below]
        place = below
    keys[place] = key
    items[place] = item
    return top, size


@njit(cache=True)
def _bucket(column: int, row: int) -> int:
    return ((column * 73856093) ^ (row * 19349663)) & (BUCKETS - 1)


@njit(cache=True)
def remember(east: float, north: float, item: int, heads: Indices, chain: Indices, cell_m: float) -> None:
    """Put an item at a place: a hash grid of square cells, items of one bucket chained."""
    bucket = _bucket(math.floor(east / cell_m), math.floor(north / cell_m))
    chain[item] = heads[bucket]
    heads[bucket] = item


@njit(cache=True)
def forget(east: float, north: float, item: int, heads: Indices, chain: Indices, cell_m: float) -> None:
    """Take an item away from the place it was put at."""
    bucket = _bucket(math.floor(east / cell_m), math.floor(north / cell_m))
    if heads[bucket] == item:
        heads[bucket] = chain[item]
        return
    other = heads[bucket]
    while chain[other] != item:
        other = chain[other]
    chain[other] = chain[item]


@njit(cache=True)
def nearest(
    east: float,
    north: float,
    angle_rad: float,
    poses: Array,
    heads: Indices,
    chain: Indices,
    within_m: float,
    within_rad: float,
) -> int:
    """Nearest remembered item closer than ``within_m`` and within ``within_rad`` in direction, else -1.

    ``poses`` has east_m, north_m, angle_rad in its first columns; ``within_m`` is also the grid's cell size.
    Of two at one distance the older is taken.
    """
    column, row = math.floor(east / within_m), math.floor(north / within_m)
    best = -1
    # in square millimetres: places equally far stay so whatever the last bit says
    best_square = math.floor(within_m * within_m * 1e6)
    for i in range(column - 1, column + 2):
        for j in range(row - 1, row + 2):
            other = heads[_bucket(i, j)]
            while other >= 0:
                delta_e, delta_n = poses[other, 0] - east, poses[other, 1] - north
                square = math.floor((delta_e * delta_e + delta_n * delta_n) * 1e6)
                if (square < best_square or (square == best_square and 0 <= other < best)) and (
                    abs(wrap(poses[other, 2] - angle_rad)) <= within_rad
                ):
                    best = other
                    best_square = square
                other = chain[other]
    return best
