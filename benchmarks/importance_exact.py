"""The most that any closed walk on a grid is paid, by dynamic programming over cells and what was seen.

A state is a cell and the set of cells seen after so many moves: what it is worth follows. States that cannot
come to more than a known walk are dropped, by the Lagrangean bound (prices of visits, straight back unpaid)
of the moves left plus what the cells not yet seen are worth beyond their price. Sets are told apart by 128
random bits. Where the states of a layer are too many, the model does not close: the bound is all there is.
"""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planner.jit import njit
from planner.search.importance.bound import bounded
from planner.search.importance.grid import ImportanceGrid
from planner.search.importance.walk_kernels import distances

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: States of one layer at most: what fits a few gigabytes.
STATES = 2_000_000


@dataclass(frozen=True, slots=True)
class Optimum:
    """``value`` is the optimum where the model closed, else None; ``bound`` holds in any case."""

    value: float | None
    bound: float
    seconds: float


@njit(cache=True, nogil=True)
def _ahead(beside: Ints, away: Ints, price: Floats, move: float, base: int, moves: int) -> Floats:
    """float64 (moves + 1, cells, 5): the most that is paid by direction of the last move, 4 for none."""
    best = np.full((moves + 1, len(beside), 5), -np.inf)
    best[0, base, :] = 0.0
    for left in range(1, moves + 1):
        for cell in range(len(beside)):
            if away[cell] < 0 or away[cell] > left:
                continue
            for last in range(5):
                most = 0.0 if cell == base else -np.inf
                for k in range(4):
                    there = beside[cell, k]
                    if there < 0:
                        continue
                    paid = 0.0 if there == base or (last < 4 and k == (last + 2) % 4) else price[there]
                    most = max(most, paid + move + best[left - 1, there, k])
                best[left, cell, last] = most
    return best


def optimum(
    grid: ImportanceGrid,
    base: int,
    battery: int,
    revisit: float,
    unspent: float,
    known: float,
    limit_s: float,
) -> Optimum:
    """Close the model within a time, or not; ``known`` is what some walk is paid."""
    began = time.perf_counter()
    root = bounded(grid, base, battery, revisit, unspent)
    beside = grid.neighbours()
    away = distances(beside, base)
    within = (away >= 0) & (2 * away <= battery)
    worth = grid.worth.reshape(-1) + revisit
    move = unspent - revisit
    fixed = worth[base] - unspent * battery
    beyond = np.where(within, worth - root.prices, 0.0)
    beyond[base] = 0.0
    ahead = _ahead(beside, away, root.prices, move, base, battery)
    random = np.random.default_rng(0).integers(1, 2**63, (grid.worth.size, 2)).astype(np.uint64)
    words = (grid.worth.size + 63) // 64
    index = np.arange(grid.worth.size)
    word, bit = index // 64, np.uint64(1) << (index % 64).astype(np.uint64)
    # By state: cell, what is paid, what cells not yet seen are worth beyond their price; the set, its mark.
    cell = np.array([base])
    paid = np.array([fixed])
    rest = np.array([beyond.sum()])
    seen = np.zeros((1, words), dtype=np.uint64)
    seen[0, word[base]] |= bit[base]
    mark = random[[base]]
    # Staying at the base is a walk, too.
    best = max(known, float(grid.worth.reshape(-1)[base]) - unspent * battery)
    if root.total <= best + 1e-6:
        return Optimum(best, best, time.perf_counter() - began)
    for step in range(1, battery + 1):
        parts = []
        for k in range(4):
            there = beside[cell, k]
            ok = there >= 0
            to = np.where(ok, there, 0)
            new = (seen[np.arange(len(cell)), word[to]] & bit[to]) == 0
            value = paid + move + np.where(new, worth[to], 0.0)
            left = rest - np.where(new, beyond[to], 0.0)
            ok &= value + left + ahead[battery - step, to, k] > best + 1e-6
            index = np.flatnonzero(ok)
            to, new = to[index], new[index]
            after = seen[index]
            after[np.arange(len(index)), word[to]] |= bit[to]
            marks = mark[index] ^ np.where(new[:, None], random[to], np.uint64(0))
            parts.append((to, value[index], left[index], after, marks))
        cell, paid, rest, seen, mark = (np.concatenate(each) for each in zip(*parts, strict=True))
        key = mark ^ (random[cell] * np.uint64(3))
        order = np.lexsort((key[:, 1], key[:, 0]))
        first = np.ones(len(order), dtype=np.bool_)
        first[1:] = (key[order[1:]] != key[order[:-1]]).any(axis=1)
        order = order[first]
        cell, paid, rest, seen, mark = cell[order], paid[order], rest[order], seen[order], mark[order]
        home = cell == base
        if home.any():
            # The last move home is no look again, which its cell's worth paid for: the fixed part has it.
            best = max(best, float(paid[home].max()))
        if not len(cell):
            break
        if len(cell) > STATES or time.perf_counter() - began > limit_s:
            return Optimum(None, root.total, time.perf_counter() - began)
    return Optimum(best, best, time.perf_counter() - began)
