"""Compiled crossing of two routes: what both visit, and stretches of what one of them does."""

# mypy: allow-untyped-decorators

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from planner.fleet.prizes.draw_kernels import State, draw
from planner.fleet.prizes.route_kernels import BLINK, cheapest_place, fill
from planner.jit import njit

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Along the first route the other's opinion is heard, or no longer heard, with this chance a place.
TURN = 0.25


@njit(cache=True, nogil=True)
def crossed(
    costs: Floats,
    rewards: Floats,
    budget: float,
    one: Ints,
    one_size: int,
    other: Ints,
    other_size: int,
    state: State,
    order: Ints,
) -> int:
    """A route within the budget of places of two routes, in ``order``; its size.

    In the order of the first: places of both, and stretches of those of the first alone; then what fits of
    those of the second alone.
    """
    count = costs.shape[0]
    last = count - 1
    liked, on = np.zeros(count, dtype=np.bool_), np.zeros(count, dtype=np.bool_)
    for k in range(other_size):
        liked[other[k]] = True
    after = np.full(count, -1)
    here, length, keep = 0, 0.0, draw(state) < 0.5
    for k in range(1, one_size):
        node = one[k]
        if not liked[node] and draw(state) < TURN:
            keep = not keep
        if liked[node] or keep or node == last:
            length += costs[here, node]
            after[here] = node
            on[node] = True
            here = node
    way, at = np.full(count, np.inf), np.full(count, -1)
    outside, worth = np.empty(count, dtype=np.int64), np.zeros(count)
    total = 0
    for node in range(1, last):
        if liked[node] and not on[node]:
            outside[total] = node
            total += 1
            worth[node] = rewards[node]
            cheapest_place(costs, after, node, way, at)
    fill(costs, worth, budget, length, after, outside, total, way, at, state, BLINK)
    size, here = 0, 0
    while here != last:
        order[size] = here
        size += 1
        here = after[here]
    order[size] = last
    return size + 1
