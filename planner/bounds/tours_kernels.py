"""Compiled parts of the lower bound: tours over cells. Numbers only.

Cells of one node are a cluster; ``offsets``, int64 (C + 1,), says where each begins. A tour goes through one
cell of each.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from planner.jit import njit

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]


@njit(cache=True)
def ahead_costs(first: Floats, between: Floats, offsets: Ints) -> Floats:
    """Least cost (2^C, N) from the start through a set of clusters, the cell it ends with given.

    ``first`` (N,) is from the start, ``between`` (N, N) from cell to cell, inf where there is no way.
    """
    clusters = len(offsets) - 1
    best = np.full((1 << clusters, len(first)), np.inf)
    for c in range(clusters):
        best[1 << c, offsets[c] : offsets[c + 1]] = first[offsets[c] : offsets[c + 1]]
    for visited in range(1, 1 << clusters):
        for c in range(clusters):
            if not visited >> c & 1 or visited == 1 << c:
                continue
            before = visited ^ (1 << c)
            for b in range(clusters):
                if not before >> b & 1:
                    continue
                for i in range(offsets[b], offsets[b + 1]):
                    so_far = best[before, i]
                    if so_far < np.inf:
                        for j in range(offsets[c], offsets[c + 1]):
                            cost = so_far + between[i, j]
                            if cost < best[visited, j]:
                                best[visited, j] = cost
    return best


@njit(cache=True)
def through_costs(ahead: Floats, behind: Floats, between: Floats, offsets: Ints) -> tuple[Floats, Ints, Ints]:
    """Least cost (N,) of a whole tour through each cell, and which cells that tour has before and after it.

    ``ahead`` is ``ahead_costs`` from the start; ``behind`` the same from the end, with ``between`` the other
    way round, so that it holds the cost from the given cell on. −1 stands for start and end.
    """
    clusters = len(offsets) - 1
    count = ahead.shape[1]
    full = (1 << clusters) - 1
    out = np.full(count, np.inf)
    prior, after = np.full(count, -1), np.full(count, -1)
    for c in range(clusters):
        for j in range(offsets[c], offsets[c + 1]):
            best_visited = 0
            for visited in range(1, full + 1):
                if not visited >> c & 1:
                    continue
                cost = ahead[visited, j] + behind[(full ^ visited) | (1 << c), j]
                if cost < out[j]:
                    out[j], best_visited = cost, visited
            if best_visited == 0:
                continue
            before, rest = best_visited ^ (1 << c), full ^ best_visited
            least = np.inf
            for b in range(clusters):
                if before >> b & 1:
                    for i in range(offsets[b], offsets[b + 1]):
                        if ahead[before, i] + between[i, j] < least:
                            least, prior[j] = ahead[before, i] + between[i, j], i
            least = np.inf
            for b in range(clusters):
                if rest >> b & 1:
                    for i in range(offsets[b], offsets[b + 1]):
                        if between[j, i] + behind[rest, i] < least:
                            least, after[j] = between[j, i] + behind[rest, i], i
    return out, prior, after


@njit(cache=True)
def short_pairs(ahead: Floats, behind: Floats, between: Floats, offsets: Ints, target: float) -> Flags:
    """Which cells may come right after which, (N, N), in a whole tour shorter than the target."""
    clusters = len(offsets) - 1
    count = ahead.shape[1]
    full = (1 << clusters) - 1
    out = np.zeros((count, count), dtype=np.bool_)
    widest = int((offsets[1:] - offsets[:-1]).max())
    half = 1 << max(clusters - 2, 0)
    before, rest = np.empty((widest, half)), np.empty((widest, half))
    for b in range(clusters):
        for c in range(clusters):
            if b == c:
                continue
            # Sets of clusters visited before the line that hold the one and not the other.
            sets = 0
            for visited in range(1, full + 1):
                if visited >> b & 1 and not visited >> c & 1:
                    for i in range(offsets[b], offsets[b + 1]):
                        before[i - offsets[b], sets] = ahead[visited, i]
                    for j in range(offsets[c], offsets[c + 1]):
                        rest[j - offsets[c], sets] = behind[full ^ visited, j]
                    sets += 1
            for i in range(offsets[b], offsets[b + 1]):
                for j in range(offsets[c], offsets[c + 1]):
                    if between[i, j] == np.inf:
                        continue
                    room = target - between[i, j]
                    least = np.inf
                    for k in range(sets):
                        least = min(least, before[i - offsets[b], k] + rest[j - offsets[c], k])
                    out[i, j] = least < room
    return out
