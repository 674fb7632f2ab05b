"""Compiled searches for closed walks over a grid. They know cells, their neighbours and worths only.

What a look at a cell gains after k looks before is ``worth[cell] * again ** k``, less ``revisit`` where
k > 0: with ``again`` 0 a cell pays once.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from planner.jit import njit

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@njit(cache=True, nogil=True)
def gain_of(worth: float, again: float, revisit: float, looks: int) -> float:
    """What one more look gains."""
    if looks == 0:
        return worth
    return (worth * again**looks if again > 0.0 else 0.0) - revisit


@njit(cache=True, nogil=True)
def distances(beside: Ints, base: int) -> Ints:
    """int64 (cells,): fewest moves from the base, -1 where there is no way."""
    away = np.full(len(beside), -1, dtype=np.int64)
    queue = np.empty(len(beside), dtype=np.int64)
    away[base] = 0
    queue[0] = base
    first, last = 0, 1
    while first < last:
        here = queue[first]
        first += 1
        for k in range(beside.shape[1]):
            there = beside[here, k]
            if there >= 0 and away[there] < 0:
                away[there] = away[here] + 1
                queue[last] = there
                last += 1
    return away


@njit(cache=True, nogil=True)
def guide(beside: Ints, away: Ints, price: Floats, base: int, moves: int) -> Floats:
    """float64 (moves + 1, cells): the most that the moves left collect at a price a visit, to the base.

    Every visit is paid, a waiting at the base is not; -inf where the base is too far.
    """
    best = np.full((moves + 1, len(beside)), -np.inf)
    best[0, base] = 0.0
    for left in range(1, moves + 1):
        for cell in range(len(beside)):
            if away[cell] < 0 or away[cell] > left:
                continue
            most = best[left - 1, cell] if cell == base else -np.inf
            for k in range(beside.shape[1]):
                there = beside[cell, k]
                if there >= 0:
                    most = max(most, price[there] + best[left - 1, there])
            best[left, cell] = most
    return best


@njit(cache=True, nogil=True)
def beam(
    beside: Ints,
    worth: Floats,
    again: float,
    revisit: float,
    ahead: Floats,
    base: int,
    moves: int,
    width: int,
) -> Ints:
    """A walk of ``moves`` moves or fewer, by a beam search led by what ``ahead`` promises for the moves left.

    Returns
    -------
    int64
        The cells, padded with -1 to moves + 1.
    """
    cells = np.full((moves + 1, width), -1, dtype=np.int64)
    parents = np.full((moves + 1, width), -1, dtype=np.int64)
    gained = np.zeros((moves + 1, width))
    seen_by = np.zeros((2, width), dtype=np.uint64)
    cells[0, 0] = base
    alive = 1
    marks = np.empty(len(beside), dtype=np.uint64)
    state = np.uint64(88172645463325252)
    for cell in range(len(beside)):
        state ^= state << np.uint64(13)
        state ^= state >> np.uint64(7)
        state ^= state << np.uint64(17)
        marks[cell] = state
    best_gain, best_at, best_index = 0.0, 0, 0
    promise = np.empty(width * 4)
    of = np.empty((width * 4, 2), dtype=np.int64)
    gain = np.empty(width * 4)
    code = np.empty(width * 4, dtype=np.uint64)
    for step in range(moves):
        found = 0
        left = moves - step - 1
        for index in range(alive):
            here = cells[step, index]
            for k in range(beside.shape[1]):
                there = beside[here, k]
                if there < 0 or ahead[left, there] == -np.inf:
                    continue
                looks = 0
                at, back = step, index
                while at >= 0:
                    if cells[at, back] == there:
                        looks += 1
                        if again == 0.0:
                            break
                    back = parents[at, back]
                    at -= 1
                gain[found] = gained[step, index]
                code[found] = seen_by[step % 2, index]
                if left > 0 or there != base:
                    gain[found] += gain_of(worth[there], again, revisit, looks)
                if looks == 0:
                    code[found] ^= marks[there]
                promise[found] = gain[found] + ahead[left, there]
                of[found, 0], of[found, 1] = index, there
                found += 1
        if found == 0:
            break
        order = np.argsort(-promise[:found], kind="mergesort")
        alive = 0
        kept = {(np.uint64(0), np.int64(-1))}
        for rank in range(found):
            option = order[rank]
            key = (code[option], of[option, 1])
            if key in kept:
                continue
            kept.add(key)
            cells[step + 1, alive] = of[option, 1]
            parents[step + 1, alive] = of[option, 0]
            gained[step + 1, alive] = gain[option]
            seen_by[(step + 1) % 2, alive] = code[option]
            if of[option, 1] == base and gain[option] > best_gain:
                best_gain, best_at, best_index = gain[option], step + 1, alive
            alive += 1
            if alive == width:
                break
    walk = np.full(moves + 1, -1, dtype=np.int64)
    index = best_index
    for step in range(best_at, -1, -1):
        walk[step] = cells[step, index]
        index = parents[step, index]
    return walk
