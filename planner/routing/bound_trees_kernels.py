"""Compiled parts of the lower bound for many regions: lines between cells of neighbours, and the ascent."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from planner.routing.bound_cells_kernels import ENTRY, EXIT, INNER, INNER_DEV, INNER_GAIN, INNER_JUMP
from planner.routing.bound_lines_kernels import between, from_terminal, together

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@njit(cache=True)
def blocks(
    cells: Floats, slopes: Floats, offsets: Ints, region: Ints, pairs: Ints, begins: Ints, radius: float
) -> Floats:
    """From all cells of one node to all of another, for pairs of nodes (P, 2), one block after the other.

    Block p begins at ``begins[p]`` and is row by row; ``begins`` ends with the length of the result.
    """
    out = np.empty(begins[-1])
    gains = np.empty(4)
    for p in range(len(pairs)):
        b, c = pairs[p, 0], pairs[p, 1]
        at = begins[p]
        for i in range(offsets[b], offsets[b + 1]):
            for j in range(offsets[c], offsets[c + 1]):
                out[at] = np.inf
                if region[b] != region[c] or together(cells[i], cells[j]):
                    out[at] = between(cells[i], cells[j], slopes[i], slopes[j], radius, gains)
                at += 1
    return out


@njit(cache=True)
def along_order(
    order: Ints,
    cells: Floats,
    slopes: Floats,
    offsets: Ints,
    region: Ints,
    start: Floats,
    end: Floats,
    radius: float,
) -> tuple[Floats, Floats, Ints, Ints]:
    """Least costs of the tour in a given order of nodes, up to each cell's exits and from them on.

    Returns
    -------
    ndarray, ndarray
        Float64 (N,).
    ndarray, ndarray
        Which cells are best before and after each, int64 (N,), −1 for the ends.
    """
    count = len(cells)
    ahead, behind = np.full(count, np.inf), np.full(count, np.inf)
    prior, after = np.full(count, -1), np.full(count, -1)
    two, four = np.empty(2), np.empty(4)
    nodes = len(order)
    for j in range(offsets[order[0]], offsets[order[0] + 1]):
        ahead[j] = from_terminal(start, cells[j], ENTRY, slopes[j], radius, two)
    for j in range(offsets[order[-1]], offsets[order[-1] + 1]):
        behind[j] = from_terminal(end, cells[j], EXIT, slopes[j], radius, two)
    widest = 0
    for c in range(nodes):
        widest = max(widest, offsets[c + 1] - offsets[c])
    legs = np.full((nodes, widest, widest), np.inf)
    for k in range(nodes - 1):
        b, c = order[k], order[k + 1]
        for i in range(offsets[b], offsets[b + 1]):
            for j in range(offsets[c], offsets[c + 1]):
                if region[b] == region[c] and not together(cells[i], cells[j]):
                    continue
                leg = between(cells[i], cells[j], slopes[i], slopes[j], radius, four)
                legs[k, i - offsets[b], j - offsets[c]] = leg
                if ahead[i] + leg < ahead[j]:
                    ahead[j], prior[j] = ahead[i] + leg, i
    for k in range(nodes - 2, -1, -1):
        b, c = order[k], order[k + 1]
        for i in range(offsets[b], offsets[b + 1]):
            for j in range(offsets[c], offsets[c + 1]):
                cost = legs[k, i - offsets[b], j - offsets[c]] + behind[j]
                if cost < behind[i]:
                    behind[i], after[i] = cost, j
    return ahead, behind, prior, after


@njit(cache=True)
def reach(cells: Floats, middle: Floats) -> tuple[float, float]:
    """How far entries and exits lie from a place at most, and the least inner cost, slopes left out."""
    far, inner = 0.0, np.inf
    for k in range(len(cells)):
        for end in (ENTRY, EXIT):
            away = math.hypot(cells[k, end] - middle[0], cells[k, end + 1] - middle[1])
            far = max(far, away + cells[k, end + 6])
        inner = min(
            inner, cells[k, INNER] - abs(cells[k, INNER_GAIN]) - cells[k, INNER_DEV] - cells[k, INNER_JUMP]
        )
    return far, inner


@njit(cache=True)
def ascent(
    flat: Floats,
    begins: Ints,
    pairs: Ints,
    base: Floats,
    first: Floats,
    last: Floats,
    slack: Floats,
    offsets: Ints,
    price: Floats,
    potential: Floats,
    target: float,
    steps: int,
) -> tuple[float, Floats, Floats, Ints, Ints, Ints]:
    """Subgradient ascent on prices of nodes and potentials of cells.

    A tour is a tree over the nodes with a line from the start and one to the end, every node with two lines,
    one into and one out of the same cell. Prices on lines at a node and potentials of cells, added to lines
    out and taken from lines in, change all tours alike. Any give a bound: the least tree of the least lines.

    Parameters
    ----------
    flat, begins, pairs
        See ``blocks``.
    base
        Least cost between nodes that are no pair, without slopes, (C, C).
    first, last
        From the start to each cell's exits, from these to the end, (N,).
    slack
        What slopes can make of a line at most, by cell, (N,).
    price, potential
        To begin with, (C,) and (N,).
    target
        Length of a known tour: sets the step.

    Returns
    -------
    float
        The best bound met.
    ndarray, ndarray
        Prices and potentials that give it.
    ndarray, ndarray, ndarray
        How often each cell was in a tree, and the last cells before and after it there, −1 for the ends and
        −2 where there was none; int64 (N,).
    """
    n = len(price)
    price, potential = price.copy(), potential.copy()
    best_price, best_potential = price.copy(), potential.copy()
    used = np.zeros(len(potential), dtype=np.int64)
    came, went = np.full(len(potential), -2), np.full(len(potential), -2)
    best = -np.inf
    scale, idle = 1.0, 0
    key, parent = np.empty(n), np.empty(n, dtype=np.int64)
    done = np.empty(n, dtype=np.bool_)
    lines = np.empty((n, n))
    leaves, arrives = np.empty((n, n), dtype=np.int64), np.empty((n, n), dtype=np.int64)
    low, low_at = np.empty(n), np.empty(n, dtype=np.int64)
    high, high_at = np.empty(n), np.empty(n, dtype=np.int64)
    turn = np.empty(len(potential))
    for _ in range(steps):
        for c in range(n):
            low[c], high[c] = np.inf, -np.inf
            for i in range(offsets[c], offsets[c + 1]):
                if potential[i] - slack[i] < low[c]:
                    low[c], low_at[c] = potential[i] - slack[i], i
                if potential[i] + slack[i] > high[c]:
                    high[c], high_at[c] = potential[i] + slack[i], i
        for b in range(n):
            for c in range(n):
                lines[b, c] = base[b, c] + low[b] - high[c]
                leaves[b, c], arrives[b, c] = low_at[b], high_at[c]
        for p in range(len(pairs)):
            b, c = pairs[p, 0], pairs[p, 1]
            at = begins[p]
            wide = offsets[c + 1] - offsets[c]
            least, leave, arrive = np.inf, 0, 0
            for i in range(offsets[b], offsets[b + 1]):
                row_least, row_at = np.inf, 0
                for j in range(wide):
                    cost = flat[at + j] - potential[offsets[c] + j]
                    if cost < row_least:
                        row_least, row_at = cost, j
                at += wide
                if row_least + potential[i] < least:
                    least, leave, arrive = row_least + potential[i], i, offsets[c] + row_at
            lines[b, c], leaves[b, c], arrives[b, c] = least, leave, arrive
        degree = np.zeros(n, dtype=np.int64)
        turn[:] = 0.0
        key[:] = np.inf
        parent[:] = -1
        done[:] = False
        key[0] = 0.0
        total = 0.0
        for _ in range(n):
            u = -1
            for v in range(n):
                if not done[v] and (u < 0 or key[v] < key[u]):
                    u = v
            done[u] = True
            total += key[u]
            if parent[u] >= 0:
                v = parent[u]
                degree[u] += 1
                degree[v] += 1
                b, c = (u, v) if lines[u, v] < lines[v, u] else (v, u)
                turn[leaves[b, c]] += 1.0
                turn[arrives[b, c]] -= 1.0
                used[leaves[b, c]] += 1
                used[arrives[b, c]] += 1
                went[leaves[b, c]], came[arrives[b, c]] = arrives[b, c], leaves[b, c]
            for v in range(n):
                if not done[v]:
                    cost = min(lines[u, v], lines[v, u]) + price[u] + price[v]
                    if cost < key[v]:
                        key[v], parent[v] = cost, u
        for arriving in (True, False):
            least, at, node = np.inf, 0, 0
            for c in range(n):
                for i in range(offsets[c], offsets[c + 1]):
                    cost = (first[i] - potential[i] if arriving else last[i] + potential[i]) + price[c]
                    if cost < least:
                        least, at, node = cost, i, c
            total += least
            degree[node] += 1
            turn[at] += -1.0 if arriving else 1.0
            if arriving:
                came[at] = -1
            else:
                went[at] = -1
        bound = total - 2.0 * price.sum()
        if bound > best + 1e-6 * target:
            best, idle = bound, 0
            best_price[:], best_potential[:] = price, potential
        else:
            idle += 1
            if idle >= 15:
                scale, idle = scale * 0.7, 0
        norm = 0.0
        for v in range(n):
            norm += float((degree[v] - 2) ** 2)
        norm += (turn**2).sum()
        if norm == 0.0 or scale < 1e-4:
            break
        step = scale * max(target - bound, 1e-3 * target) / norm
        for v in range(n):
            price[v] += step * (degree[v] - 2)
        for i in range(len(potential)):
            potential[i] += step * turn[i]
    return best, best_price, best_potential, used, came, went
