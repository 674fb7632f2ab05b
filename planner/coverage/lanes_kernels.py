"""Compiled choice of the order in which parallel lanes are flown, and of the state each is flown in.

They know nothing but numbers. A lane n has B states, n·B and on; poses of states are float64 (S, 3): east_m,
north_m, angle_rad; discs float64 (K, 3).
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from planner.dubins.estimate_kernels import detour_m
from planner.dubins.kernels import dubins_length
from planner.orders_kernels import best_orders

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

#: Up to this many lanes every order is tried, by dynamic programming; beyond, the known patterns.
EXACT_UP_TO = 8
#: Widest stride of the patterns.
STRIDES = 12
#: Where an order begins, in the first or the second half of the lanes, times the way that it ends.
VARIANTS = 4


@njit(cache=True)
def turns_between(
    entries: Floats,
    exits: Floats,
    own_m: Floats,
    cramped_m: Floats,
    states: int,
    reach: int,
    radius_m: float,
    discs: Floats,
) -> Floats:
    """Lengths of the turns between lanes no more than ``reach`` apart, with what discs and want of room add.

    Parameters
    ----------
    entries, exits, own_m
        Of each state, S = N · ``states``, lane by lane; ``own_m`` is inf where it may not be flown.
    cramped_m
        What each state's entry and exit cost where no full turn fits, shape (S, 2).

    Returns
    -------
    ndarray
        Shape (S, 2 · reach + 1, states): from a state to those of the lane ``reach`` before its own, and so
        on to those of the lane ``reach`` after; inf where there is none.
    """
    count = len(own_m)
    lanes = count // states
    turns = np.full((count, 2 * reach + 1, states), np.inf)
    for i in range(count):
        if not own_m[i] < np.inf:
            continue
        lane = i // states
        for other in range(max(0, lane - reach), min(lanes, lane + reach + 1)):
            if other == lane:
                continue
            for b in range(states):
                j = other * states + b
                if not own_m[j] < np.inf:
                    continue
                turn = dubins_length(
                    exits[i, 0],
                    exits[i, 1],
                    exits[i, 2],
                    entries[j, 0],
                    entries[j, 1],
                    entries[j, 2],
                    radius_m,
                )
                turn += detour_m(exits[i, 0], exits[i, 1], entries[j, 0], entries[j, 1], discs)
                turns[i, other - lane + reach, b] = turn + max(cramped_m[i, 1], cramped_m[j, 0])
    return turns


@njit(cache=True)
def best_order(turns: Floats, own_m: Floats, before_m: Floats, behind_m: Floats) -> tuple[float, Ints]:
    """The cheapest way to fly every lane once, in one of its states each; exact.

    Dynamic programming over subsets of lanes and the state flown last (Held and Karp 1962, clustered).

    Parameters
    ----------
    turns, own_m
        Between all lanes, and of each state: see ``turns_between``.
    before_m, behind_m
        What coming to a state first and going on from it last costs, inf where it may not be; shape (S,).

    Returns
    -------
    tuple
        The cost of all, inf where there is no way, and the states in order, shape (N,).
    """
    count, width, states = turns.shape
    reach = width // 2
    costs_m = np.full((count, count), np.inf)
    for i in range(count):
        for j in range(count):
            if abs(j // states - i // states) <= reach:
                costs_m[i, j] = turns[i, j // states - i // states + reach, j % states] + own_m[j]
    costs, tours = best_orders(before_m + own_m, costs_m, behind_m, np.arange(0, count + 1, states))
    found = int(np.argmin(costs))
    return costs[found], tours[found]


@njit(cache=True)
def racetrack(lanes: int, stride: int) -> Ints:
    """Lanes in racetrack order: blocks of 2·stride lanes, each going to and fro between its halves.

    Stride 0 is boustrophedon, one lane after its neighbour.
    """
    order = np.empty(lanes, dtype=np.int64)
    if stride <= 0:
        order[:] = np.arange(lanes)
        return order
    at = 0
    for begin in range(0, lanes, 2 * stride):
        size = min(2 * stride, lanes - begin)
        half = (size + 1) // 2
        for k in range(half):
            order[at] = begin + k
            at += 1
            if half + k < size:
                order[at] = begin + half + k
                at += 1
    return order


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
def best_states(
    turns: Floats, own_m: Floats, before_m: Floats, behind_m: Floats, order: Ints
) -> tuple[float, Ints]:
    """The cheapest states for a given order of lanes: a shortest path through layers. Arrays as above."""
    lanes = len(order)
    states = turns.shape[2]
    reach = turns.shape[1] // 2
    best = np.full((lanes, states), np.inf)
    came_from = np.full((lanes, states), -1, dtype=np.int64)
    for b in range(states):
        best[0, b] = before_m[order[0] * states + b] + own_m[order[0] * states + b]
    for k in range(1, lanes):
        step = order[k] - order[k - 1] + reach
        for a in range(states):
            if not best[k - 1, a] < np.inf:
                continue
            for b in range(states):
                cost = best[k - 1, a] + own_m[order[k] * states + b]
                cost += turns[order[k - 1] * states + a, step, b]
                if cost < best[k, b]:
                    best[k, b] = cost
                    came_from[k, b] = a
    total, state = np.inf, -1
    for b in range(states):
        cost = best[lanes - 1, b] + behind_m[order[-1] * states + b]
        if cost < total:
            total, state = cost, b
    chosen = np.full(lanes, -1, dtype=np.int64)
    for k in range(lanes - 1, -1, -1):
        if state < 0:
            break
        chosen[k] = order[k] * states + state
        state = came_from[k, state]
    return total, chosen


@njit(cache=True)
def pattern_order(
    turns: Floats, own_m: Floats, before_m: Floats, behind_m: Floats, skips: bool
) -> tuple[float, Ints]:
    """The cheapest of boustrophedon and racetracks of every stride the turns reach, from any end.

    With ``skips`` also of orders that skip lanes, of the same strides. Other arrays as for ``best_order``.
    """
    states = turns.shape[2]
    lanes = len(own_m) // states
    total = np.inf
    chosen = np.full(lanes, -1, dtype=np.int64)
    widest = min(turns.shape[1] // 2, (lanes + 1) // 2)
    for kind in range(2 if skips else 1):
        # Skipping with a stride of 1 is lane after lane, as a racetrack of stride 0.
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
    begins: Flags,
    onward: Flags,
    skips: bool,
    strides: int,
    radius_m: float,
    discs: Floats,
) -> tuple[Floats, Ints]:
    """The best order of lanes for many headings and offsets, by where it begins and which way it ends.

    Parameters
    ----------
    entries, exits, own_m, cramped_m
        Shapes (P, N, B, 3), (P, N, B, 3), (P, N, B) and (P, N, B, 2): problem, lane, state.
    before_m, behind_m
        What coming to a state first and going on from it last costs, shape (P, N, B).
    begins
        In which states the first lane may be flown, shape (B,).
    onward
        Which states fly in the problem's own direction, shape (B,).
    skips
        Whether orders may skip lanes, as well as run in racetracks, where not every order is tried.
    strides
        Widest stride of either.

    Returns
    -------
    tuple
        Costs of all (P, 4), inf where there is none, and states in order (P, 4, N). Variant 2·b + e begins
        in the first (b = 0) or second half of the lanes, and ends onward (e = 0) or flying back.
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
                    in_half = (2 * lane >= lanes) == (variant >= 2)
                    if in_half and begins[b]:
                        first[lane * states + b] = before_m[p, lane, b]
                    if onward[b] == (variant % 2 == 0):
                        last[lane * states + b] = behind_m[p, lane, b]
            if lanes <= EXACT_UP_TO:
                cost, order = best_order(turns, own, first, last)
            else:
                cost, order = pattern_order(turns, own, first, last, skips)
            costs[p, variant] = cost
            orders[p, variant] = order
    return costs, orders
