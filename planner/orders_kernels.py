"""Compiled choice of one option of each of several groups, and of the groups' order."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from planner.jit import njit

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@njit(cache=True)
def best_orders(first: Floats, between: Floats, last: Floats, offsets: Ints) -> tuple[Floats, Ints]:
    """Cheapest open tours through one option of each cluster, exact: one for each cluster visited last.

    Dynamic programming over subsets of clusters and the option visited last.

    Parameters
    ----------
    first, between, last
        Costs from the start to an option (N,), from an option to another (N, N), from an option to the end
        (N,); an option's own cost is in the first two.
    offsets
        int64 (C + 1,): where the options of each cluster begin.

    Returns
    -------
    tuple
        Costs (C,), inf where there is none, and options in visiting order (C, C).
    """
    clusters = len(offsets) - 1
    count = len(first)
    full = 1 << clusters
    best = np.full((full, count), np.inf)
    came_from = np.full((full, count), -1, dtype=np.int32)
    for c in range(clusters):
        for j in range(offsets[c], offsets[c + 1]):
            best[1 << c, j] = first[j]
    for visited in range(1, full):
        for c in range(clusters):
            if not visited >> c & 1 or visited == 1 << c:
                continue
            before = visited ^ (1 << c)
            for b in range(clusters):
                if not before >> b & 1:
                    continue
                for i in range(offsets[b], offsets[b + 1]):
                    so_far = best[before, i]
                    if not so_far < np.inf:
                        continue
                    for j in range(offsets[c], offsets[c + 1]):
                        cost = so_far + between[i, j]
                        if cost < best[visited, j]:
                            best[visited, j] = cost
                            came_from[visited, j] = i
    costs = np.full(clusters, np.inf)
    tours = np.full((clusters, clusters), -1, dtype=np.int64)
    for c in range(clusters):
        option = -1
        for j in range(offsets[c], offsets[c + 1]):
            cost = best[full - 1, j] + last[j]
            if cost < costs[c]:
                costs[c] = cost
                option = j
        if option < 0:
            continue
        visited = full - 1
        for position in range(clusters - 1, -1, -1):
            tours[c, position] = option
            before_option = came_from[visited, option]
            for b in range(clusters):
                if offsets[b] <= option < offsets[b + 1]:
                    visited ^= 1 << b
                    break
            option = before_option
    return costs, tours


@njit(cache=True)
def best_options(
    first: Floats, between: Floats, last: Floats, offsets: Ints, order: Ints
) -> tuple[float, Ints]:
    """Cheapest options for a given order of clusters: a shortest path through layers. Arrays as above."""
    clusters = len(order)
    count = len(first)
    best = np.full(count, np.inf)
    came_from = np.full(count, -1, dtype=np.int64)
    for j in range(offsets[order[0]], offsets[order[0] + 1]):
        best[j] = first[j]
    for position in range(1, clusters):
        b, c = order[position - 1], order[position]
        for i in range(offsets[b], offsets[b + 1]):
            so_far = best[i]
            if not so_far < np.inf:
                continue
            for j in range(offsets[c], offsets[c + 1]):
                cost = so_far + between[i, j]
                if cost < best[j]:
                    best[j] = cost
                    came_from[j] = i
    total = np.inf
    option = -1
    for j in range(offsets[order[-1]], offsets[order[-1] + 1]):
        if best[j] + last[j] < total:
            total = best[j] + last[j]
            option = j
    chosen = np.full(clusters, -1, dtype=np.int64)
    for position in range(clusters - 1, -1, -1):
        if option < 0:
            break
        chosen[position] = option
        option = came_from[option]
    return total, chosen


@njit(cache=True)
def improve_order(
    first: Floats, between: Floats, last: Floats, offsets: Ints, order: Ints, evaluations: int
) -> Ints:
    """Move and reverse runs of clusters as long as the best options get cheaper (Or-opt and 2-opt).

    ``evaluations`` bounds the work, so that the same input gives the same order on any machine.
    """
    n = len(order)
    best_cost, _ = best_options(first, between, last, offsets, order)
    used = 0
    improved = True
    while improved:
        improved = False
        for i in range(n):
            for j in range(i + 1, n + 1):
                # Reverse order[i:j]; move a run of up to three to each other place.
                for move in range(-1, n):
                    if move >= 0 and (j - i > 3 or i <= move <= j):
                        continue
                    if move < 0 and j - i < 2:
                        continue
                    if used >= evaluations:
                        return order
                    trial = np.empty_like(order)
                    if move < 0:
                        trial[:] = order
                        trial[i:j] = order[i:j][::-1]
                    else:
                        rest = np.concatenate((order[:i], order[j:]))
                        at = move if move < i else move - (j - i)
                        trial[:at] = rest[:at]
                        trial[at : at + j - i] = order[i:j]
                        trial[at + j - i :] = rest[at:]
                    used += 1
                    cost, _ = best_options(first, between, last, offsets, trial)
                    if cost < best_cost - 1e-6:
                        order, best_cost, improved = trial, cost, True
    return order
