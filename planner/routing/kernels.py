"""Compiled searches for the visiting order. They know nothing but distances.

Arrays: ``legs_m`` float64 (N, N), symmetric, between places; ``first_m`` and ``last_m`` float64 (N,), from
the start to a place and from a place to the end; orders are int64 (N,).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from planner.jit import njit

Floats = NDArray[np.float64]
Order = NDArray[np.int64]

#: A change must shorten the tour by more than rounding can, or the search might not end.
LEAST_GAIN_M = 1e-9


@njit(cache=True)
def held_karp(legs_m: Floats, first_m: Floats, last_m: Floats) -> Order:
    """Shortest order of all places, by dynamic programming over subsets (Held and Karp 1962)."""
    n = len(first_m)
    full = 1 << n
    best = np.full((full, n), np.inf)
    came_from = np.full((full, n), -1, dtype=np.int8)
    for j in range(n):
        best[1 << j, j] = first_m[j]
    for visited in range(1, full):
        for j in range(n):
            if not visited >> j & 1 or not best[visited, j] < np.inf:
                continue
            for k in range(n):
                if visited >> k & 1:
                    continue
                length_m = best[visited, j] + legs_m[j, k]
                if length_m < best[visited | 1 << k, k]:
                    best[visited | 1 << k, k] = length_m
                    came_from[visited | 1 << k, k] = j
    order = np.empty(n, dtype=np.int64)
    visited = full - 1
    place = int(np.argmin(best[visited] + last_m))
    for position in range(n - 1, -1, -1):
        order[position] = place
        before = int(came_from[visited, place])
        visited ^= 1 << place
        place = before
    return order


@njit(cache=True)
def _leg(legs_m: Floats, first_m: Floats, last_m: Floats, order: Order, before: int, after: int) -> float:
    """Distance between two positions of an order; −1 is the start, N the end."""
    if before < 0:
        return float(first_m[order[after]])
    if after >= len(order):
        return float(last_m[order[before]])
    return float(legs_m[order[before], order[after]])


@njit(cache=True)
def improve(legs_m: Floats, first_m: Floats, last_m: Floats, order: Order) -> Order:
    """2-opt and Or-opt from a given order until neither shortens it."""
    n = len(order)
    order = order.copy()
    improved = True
    while improved:
        improved = False
        # 2-opt: turn round the stretch from i to j.
        for i in range(n):
            for j in range(i + 1, n):
                old_m = _leg(legs_m, first_m, last_m, order, i - 1, i)
                old_m += _leg(legs_m, first_m, last_m, order, j, j + 1)
                new_m = first_m[order[j]] if i == 0 else legs_m[order[i - 1], order[j]]
                new_m += last_m[order[i]] if j == n - 1 else legs_m[order[i], order[j + 1]]
                if new_m < old_m - LEAST_GAIN_M:
                    order[i : j + 1] = order[i : j + 1][::-1].copy()
                    improved = True
        # Or-opt: move a stretch of one to three places elsewhere.
        for size in range(1, min(3, n - 1) + 1):
            for i in range(n - size + 1):
                stretch = order[i : i + size].copy()
                rest = np.concatenate((order[:i], order[i + size :]))
                old_m = _leg(legs_m, first_m, last_m, order, i - 1, i)
                old_m += _leg(legs_m, first_m, last_m, order, i + size - 1, i + size)
                old_m -= _leg(legs_m, first_m, last_m, rest, i - 1, i)
                best_gain_m = LEAST_GAIN_M
                best_at = -1
                for at in range(len(rest) + 1):
                    new_m = first_m[stretch[0]] if at == 0 else legs_m[rest[at - 1], stretch[0]]
                    new_m += last_m[stretch[-1]] if at == len(rest) else legs_m[stretch[-1], rest[at]]
                    new_m -= _leg(legs_m, first_m, last_m, rest, at - 1, at)
                    if old_m - new_m > best_gain_m:
                        best_gain_m = old_m - new_m
                        best_at = at
                if best_at >= 0:
                    order = np.concatenate((rest[:best_at], stretch, rest[best_at:]))
                    improved = True
    return order
