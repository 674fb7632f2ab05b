"""Compiled dynamic programming over subsets of places and the ways to pass them. Numbers only.

M. Held and R. M. Karp, "A dynamic programming approach to sequencing problems", Journal of the Society for
Industrial and Applied Mathematics 10 (1962), each place with several ways; of all subsets that a route within
the budget passes, the one of most reward.
"""

# mypy: allow-untyped-decorators

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from planner.jit import njit

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@njit(cache=True, nogil=True)
def best_subset(costs: Floats, rewards: Floats, budget: float) -> tuple[Ints, float, float]:
    """Order, reward and cost of the best route; costs are blocks (P, P, H, H). Empty where none is within."""
    inner, ways = costs.shape[0] - 2, costs.shape[2]
    end = inner + 1
    table = np.full((1 << inner, max(inner, 1), ways), np.inf)
    best_set, best_last, best_way = -1, -1, -1
    most, least = -np.inf, np.inf
    home = np.inf
    for g in range(ways):
        for h in range(ways):
            home = min(home, costs[0, end, g, h])
    if home <= budget:
        best_set, most, least = 0, rewards[0] + rewards[end], home
    for j in range(inner):
        for h in range(ways):
            for g in range(ways):
                table[1 << j, j, h] = min(table[1 << j, j, h], costs[0, j + 1, g, h])
    for subset in range(1, 1 << inner):
        reward = rewards[0] + rewards[end]
        for j in range(inner):
            if subset >> j & 1:
                reward += rewards[j + 1]
        for j in range(inner):
            if not subset >> j & 1:
                continue
            for h in range(ways):
                so_far = table[subset, j, h]
                if so_far > budget:
                    continue
                for g in range(ways):
                    whole = so_far + costs[j + 1, end, h, g]
                    if whole <= budget and (reward > most or (reward == most and whole < least)):
                        most, least = reward, whole
                        best_set, best_last, best_way = subset, j, h
                for k in range(inner):
                    if subset >> k & 1:
                        continue
                    for g in range(ways):
                        further = so_far + costs[j + 1, k + 1, h, g]
                        if further < table[subset | 1 << k, k, g]:
                            table[subset | 1 << k, k, g] = further
    if best_set < 0:
        return np.empty(0, dtype=np.int64), 0.0, np.inf
    size = 2
    for j in range(inner):
        size += best_set >> j & 1
    order = np.zeros(size, dtype=np.int64)
    order[size - 1] = end
    subset, last, way = best_set, best_last, best_way
    for place in range(size - 2, 0, -1):
        order[place] = last + 1
        rest = subset ^ (1 << last)
        if rest == 0:
            break
        so_far, before, before_way = np.inf, -1, -1
        for j in range(inner):
            if rest >> j & 1:
                for h in range(ways):
                    whole = table[rest, j, h] + costs[j + 1, last + 1, h, way]
                    if whole < so_far:
                        so_far, before, before_way = whole, j, h
        subset, last, way = rest, before, before_way
    return order, most, least
