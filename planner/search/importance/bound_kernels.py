"""Compiled: the most a walk collects at a price a visit, where turning straight back pays nothing."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from planner.jit import njit

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@njit(cache=True, nogil=True)
def dearest(
    beside: Ints, cells: Ints, away: Ints, price: Floats, move: float, base: int, moves: int
) -> tuple[float, Ints]:
    """The dearest closed walk of so many moves at most, and how often it is paid in each cell.

    Parameters
    ----------
    beside
        int64 (cells, 4): neighbours by direction; direction k is undone by direction (k + 2) % 4.
    cells
        int64: cells within reach, nearest first.
    away
        Fewest moves from the base.
    price
        Paid at each visit but one straight back, of the move before the last; at the base nothing is paid.
    move
        Paid for each move.

    Returns
    -------
    tuple
        What is paid at most, and int64 (cells,) of visits paid.
    """
    place = np.full(len(beside), -1, dtype=np.int64)
    for index in range(len(cells)):
        place[cells[index]] = index
    count = len(cells)
    # Best after so many moves, by cell and direction of the last move; whence, as that of the move before.
    now = np.full((count, 4), -np.inf)
    after = np.full((count, 4), -np.inf)
    whence = np.full((moves + 1, count, 4), -1, dtype=np.int8)
    home = place[base]
    best, best_step, best_direction = 0.0, 0, -1
    for step in range(1, moves + 1):
        after[:, :] = -np.inf
        left = moves - step
        for index in range(count):
            here = cells[index]
            reach = away[here]
            # Moves from a cell as far away as that, so early or with as few left, are of no walk home.
            if reach > step - 1 or reach > left + 1 or (step - 1 - reach) % 2 == 1:
                continue
            for k in range(4):
                there = beside[here, k]
                if there < 0 or away[there] > left or place[there] < 0:
                    continue
                to = place[there]
                paid = price[there] if there != base else 0.0
                most, by = -np.inf, -1
                if step == 1:
                    most, by = paid + move, 4
                else:
                    for before in range(4):
                        value = now[index, before]
                        if before != (k + 2) % 4:
                            value += paid
                        if value > most:
                            most, by = value, before
                    most += move
                if most > after[to, k]:
                    after[to, k] = most
                    whence[step, to, k] = by
        now, after = after, now
        for k in range(4):
            if now[home, k] > best:
                best, best_step, best_direction = now[home, k], step, k
    visits = np.zeros(len(beside), dtype=np.int64)
    here, direction = base, best_direction
    for step in range(best_step, 0, -1):
        by = whence[step, place[here], direction]
        if here != base and (step == 1 or by != (direction + 2) % 4):
            visits[here] += 1
        here = beside[here, (direction + 2) % 4]
        direction = by
    return best, visits
