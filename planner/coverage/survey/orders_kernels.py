"""Compiled choice of the order in which lanes are flown, and of the way of each.

They know nothing but numbers. A lane n has the states 2·n, onward, and 2·n + 1, back; arrays of states are as
in ``planner.coverage.strips.kernels``.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from planner.coverage.strips.kernels import best_order, best_states, racetrack, turns_between

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Up to this many lanes every order is tried.
EXACT_UP_TO = 8
#: Where an order begins, in the right half of the lanes or the left one, times the way that it ends.
VARIANTS = 4


@njit(cache=True)
def skipping(lanes: int, stride: int) -> Ints:
    """Every ``stride``-th lane out, those beside them back, and so on; each lane once.

    With stride 2 every other lane out and the others back.
    """
    order = np.empty(lanes, dtype=np.int64)
    at = 0
    for first in range(min(stride, lanes)):
        count = (lanes - 1 - first) // stride + 1
        for k in range(count):
            order[at] = first + stride * (k if first % 2 == 0 else count - 1 - k)
            at += 1
    return order


@njit(cache=True)
def pattern_order(turns: Floats, own_m: Floats, before_m: Floats, behind_m: Floats) -> tuple[float, Ints]:
    """The cheapest of racetracks and orders that skip lanes, of every stride the turns reach, from any end.

    Lane after lane is the racetrack of stride 0.
    """
    states = turns.shape[2]
    lanes = len(own_m) // states
    total = np.inf
    chosen = np.full(lanes, -1, dtype=np.int64)
    widest = min(turns.shape[1] // 2, (lanes + 1) // 2)
    for kind in range(2):
        for stride in range(2 * kind, widest + 1):
            pattern = racetrack(lanes, stride) if kind == 0 else skipping(lanes, stride)
            for way in range(4):
                order = pattern.copy()
                if way % 2 == 1:
                    order = lanes - 1 - order
                if way >= 2:
                    order = order[::-1].copy()
                if not np.isfinite(before_m[order[0] * states : (order[0] + 1) * states]).any():
                    continue
                cost, found = best_states(turns, own_m, before_m, behind_m, order)
                if cost < total:
                    total = cost
                    chosen = found
    return total, chosen


@njit(cache=True)
def lane_orders(
    entries: Floats,
    exits: Floats,
    own_m: Floats,
    cramped_m: Floats,
    before_m: Floats,
    behind_m: Floats,
    strides: int,
    radius_m: float,
    discs: Floats,
) -> tuple[Floats, Ints]:
    """The best order of lanes for many headings and offsets, by where it begins and which way it ends.

    Parameters
    ----------
    entries, exits, own_m, cramped_m
        Shapes (P, N, 2, 3), (P, N, 2, 3), (P, N, 2) and (P, N, 2, 2): problem, lane, state.
    before_m, behind_m
        What coming to a state first and going on from it last costs, shape (P, N, 2).
    strides
        Lanes that a turn reaches.

    Returns
    -------
    tuple
        Costs of all (P, 4), inf where there is none, and states in order (P, 4, N). Variant 2·b + e begins in
        the right (b = 0) or left half of the lanes, and ends onward (e = 0) or flying back.
    """
    problems, lanes, states = own_m.shape
    costs = np.full((problems, VARIANTS), np.inf)
    orders = np.full((problems, VARIANTS, lanes), -1, dtype=np.int64)
    count = lanes * states
    reach = lanes - 1 if lanes <= EXACT_UP_TO else max(1, min(strides, (lanes + 1) // 2))
    for p in range(problems):
        entry = entries[p].copy().reshape(count, 3)
        leave = exits[p].copy().reshape(count, 3)
        own = own_m[p].copy().reshape(count)
        cramped = cramped_m[p].copy().reshape(count, 2)
        turns = turns_between(entry, leave, own, cramped, states, reach, radius_m, discs)
        for variant in range(VARIANTS):
            first = np.full(count, np.inf)
            last = np.full(count, np.inf)
            for lane in range(lanes):
                for b in range(states):
                    # One lane lies in either half.
                    if lanes == 1 or (2 * lane >= lanes) == (variant >= 2):
                        first[lane * states + b] = before_m[p, lane, b]
                    if b == variant % 2:
                        last[lane * states + b] = behind_m[p, lane, b]
            if lanes <= EXACT_UP_TO:
                cost, order = best_order(turns, own, first, last)
            else:
                cost, order = pattern_order(turns, own, first, last)
            costs[p, variant] = cost
            orders[p, variant] = order
    return costs, orders
