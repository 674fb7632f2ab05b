"""Compiled annealing of closed walks over a grid: stretches are taken out and searched through again."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from planner.jit import njit
from planner.search.chance_kernels import drawn
from planner.search.importance.walk_kernels import gain_of

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Steps of a segment that is searched through at most.
LONGEST = 16


@njit(cache=True, nogil=True)
def _best_between(
    beside: Ints,
    columns: int,
    worth: Floats,
    again: float,
    revisit: float,
    looks: Ints,
    start: int,
    end: int,
    steps: int,
    nodes: int,
    state: NDArray[np.uint64],
    ahead: Floats,
    found: Ints,
) -> float:
    """The best path of so many steps between two cells, by a depth-first search of so many nodes at most.

    ``found`` (steps + 1,) takes the path; what it gains is returned, -inf where there is none. ``looks`` is
    what the rest of the walk sees, and is left as it was. ``ahead`` is room for (LONGEST + 1, cells).
    """
    row, column = start // columns, start % columns
    to_row, to_column = end // columns, end % columns
    if abs(row - to_row) + abs(column - to_column) > steps:
        return -np.inf
    # What each number of steps left could collect at most, with no memory of what the segment sees.
    rows = len(beside) // columns
    for left in range(steps + 1):
        for r in range(max(0, to_row - left), min(rows, to_row + left + 1)):
            reach = left - abs(r - to_row)
            for c in range(max(0, to_column - reach), min(columns, to_column + reach + 1)):
                cell = r * columns + c
                if left == 0:
                    ahead[0, cell] = 0.0
                    continue
                most = -np.inf
                for k in range(beside.shape[1]):
                    there = beside[cell, k]
                    if there < 0:
                        continue
                    tr, tc = there // columns, there % columns
                    if abs(tr - to_row) + abs(tc - to_column) > left - 1:
                        continue
                    value = gain_of(worth[there], again, revisit, looks[there]) if left > 1 else 0.0
                    most = max(most, value + ahead[left - 1, there])
                ahead[left, cell] = most
    path = np.empty(steps + 1, dtype=np.int64)
    turn = np.zeros(steps + 1, dtype=np.int64)
    order = np.zeros(steps + 1, dtype=np.int64)
    gained = np.zeros(steps + 1)
    path[0] = start
    depth = 0
    order[0] = int(drawn(state) * 4.0)
    best = -np.inf
    visited = 0
    while depth >= 0:
        if turn[depth] == beside.shape[1] or visited >= nodes:
            if depth > 0:
                looks[path[depth]] -= 1
            depth -= 1
            continue
        there = beside[path[depth], (turn[depth] + order[depth]) % beside.shape[1]]
        turn[depth] += 1
        if there < 0:
            continue
        left = steps - depth - 1
        if left == 0:
            if there == end and gained[depth] > best:
                best = gained[depth]
                for k in range(steps):
                    found[k] = path[k]
                found[steps] = end
            continue
        tr, tc = there // columns, there % columns
        away = abs(tr - to_row) + abs(tc - to_column)
        if away > left or (left - away) % 2 == 1:
            continue
        value = gain_of(worth[there], again, revisit, looks[there])
        if gained[depth] + value + ahead[left, there] <= best + 1e-12:
            continue
        visited += 1
        depth += 1
        path[depth] = there
        gained[depth] = gained[depth - 1] + value
        looks[there] += 1
        turn[depth] = 0
        order[depth] = int(drawn(state) * 4.0)
    return best


@njit(cache=True, nogil=True)
def _without(
    walk: Ints, looks: Ints, worth: Floats, again: float, revisit: float, first: int, last: int
) -> float:
    """Take the looks strictly between two places of the walk away; what they were worth."""
    lost = 0.0
    for at in range(first + 1, last):
        cell = walk[at]
        looks[cell] -= 1
        lost += gain_of(worth[cell], again, revisit, looks[cell])
    return lost


@njit(cache=True, nogil=True)
def _put(walk: Ints, length: int, looks: Ints, first: int, last: int, path: Ints, steps: int) -> int:
    """Put a path of so many steps between two places of the walk; its new length in moves."""
    shift = steps - (last - first)
    if shift > 0:
        for at in range(length, last - 1, -1):
            walk[at + shift] = walk[at]
    elif shift < 0:
        for at in range(last, length + 1):
            walk[at + shift] = walk[at]
    for k in range(1, steps):
        walk[first + k] = path[k]
        looks[path[k]] += 1
    return length + shift


@njit(cache=True, nogil=True)
def improve(
    beside: Ints,
    columns: int,
    worth: Floats,
    again: float,
    revisit: float,
    move: float,
    begun: Ints,
    moves: int,
    rounds: int,
    nodes: int,
    heat: float,
    seed: int,
) -> tuple[Ints, float]:
    """Annealing over closed walks: a stretch is taken out and the best found in its place; moves shift about.

    Parameters
    ----------
    move
        What a move is worth by itself.
    begun
        Cells of a walk from the base back to it.
    moves
        Moves at most.
    rounds, nodes
        How many stretches are tried, and how far each is searched.
    heat
        Loss that is accepted about as often as not at first, in worth.

    Returns
    -------
    tuple
        Cells of the best walk, and its worth without the base's.
    """
    length = len(begun) - 1
    walk = np.empty(moves + 3, dtype=np.int64)
    walk[: length + 1] = begun
    looks = np.zeros(len(beside), dtype=np.int64)
    # The base is seen at the start; coming home to it at the end is no look.
    now = length * move
    looks[walk[0]] = 1
    for at in range(1, length):
        now += gain_of(worth[walk[at]], again, revisit, looks[walk[at]])
        looks[walk[at]] += 1
    best, best_length = now, length
    kept = walk.copy()
    state = np.array([np.uint64(seed) * np.uint64(2685821657736338717) + np.uint64(88172645463325252)])
    if state[0] == 0:
        state[0] = np.uint64(1)
    drawn(state)
    ahead = np.zeros((LONGEST + 1, len(beside)))
    path = np.empty(LONGEST + 1, dtype=np.int64)
    other = np.empty(LONGEST + 1, dtype=np.int64)
    if length == 0:
        # Something to start from: there and back.
        for k in range(beside.shape[1]):
            there = beside[walk[0], k]
            if there >= 0 and moves >= 2:
                walk[1], walk[2] = there, walk[0]
                looks[there] += 1
                now = worth[there] + 2.0 * move
                length = 2
                break
        if length == 0:
            return walk[:1].copy(), 0.0
    before = walk.copy()
    for index in range(rounds):
        warm = heat * (1.0 - index / rounds)
        bar = now + warm * np.log(max(drawn(state), 1e-300))
        before[: length + 1] = walk[: length + 1]
        old_length, old = length, now
        # A second stretch made shorter first, where there are no moves left to spend.
        changed = now
        spare = moves - length
        take = drawn(state)
        shortened = False
        if spare < 2 and take < 0.5 and length >= 6:
            span = 3 + int(drawn(state) * 8.0)
            span = min(span, length)
            first = int(drawn(state) * (length - span + 1))
            lost = _without(walk, looks, worth, again, revisit, first, first + span)
            gain = _best_between(
                beside,
                columns,
                worth,
                again,
                revisit,
                looks,
                walk[first],
                walk[first + span],
                span - 2,
                nodes,
                state,
                ahead,
                other,
            )
            if gain == -np.inf:
                for at in range(first + 1, first + span):
                    looks[walk[at]] += 1
                continue
            changed += gain - lost - 2.0 * move
            length = _put(walk, length, looks, first, first + span, other, span - 2)
            spare = moves - length
            shortened = True
        longer = 2 if spare >= 2 and (shortened or drawn(state) < 0.7) else 0
        span = 1 + int(drawn(state) * (LONGEST - 2.0))
        span = min(span, length)
        if not shortened and revisit > move and span > 3 and drawn(state) < 0.1:
            # Where looks again cost more than moves pay, a shorter walk may be better.
            longer = -2
        first = int(drawn(state) * (length - span + 1))
        lost = _without(walk, looks, worth, again, revisit, first, first + span)
        gain = _best_between(
            beside,
            columns,
            worth,
            again,
            revisit,
            looks,
            walk[first],
            walk[first + span],
            span + longer,
            nodes,
            state,
            ahead,
            path,
        )
        accepted = False
        if gain > -np.inf and changed + gain - lost + longer * move >= bar:
            length = _put(walk, length, looks, first, first + span, path, span + longer)
            now = changed + gain - lost + longer * move
            accepted = True
        if not accepted:
            # As it was.
            for at in range(length + 1):
                looks[walk[at]] = 0
            for at in range(old_length + 1):
                looks[before[at]] = 0
                walk[at] = before[at]
            looks[before[0]] = 1
            for at in range(1, old_length):
                looks[before[at]] += 1
            length, now = old_length, old
        elif now > best + 1e-9:
            best, best_length = now, length
            kept[: length + 1] = walk[: length + 1]
    return kept[: best_length + 1].copy(), best
