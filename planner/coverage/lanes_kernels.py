"""Compiled choice of the order in which parallel lanes are flown, and of the state each is flown in.

They know nothing but numbers. A lane n has B states, n·B and on; poses of states are float64 (S, 3): east_m,
north_m, angle_rad; discs float64 (K, 3).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from planner.coverage.turns_kernels import SLACK, UNKNOWN, ends_of, least_turns, turn_m
from planner.jit import njit
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
def turns_between(ends: Floats, own_m: Floats, states: int, radius_m: float, discs: Floats) -> Floats:
    """Lengths of the turns between all lanes, with what discs and want of room add.

    Parameters
    ----------
    ends, own_m
        Of each state, S = N · ``states``, lane by lane; ``own_m`` is inf where it may not be flown.

    Returns
    -------
    ndarray
        Shape (S, S): from one state to another; inf where there is none.
    """
    count = len(own_m)
    turns = np.full((count, count), np.inf)
    for i in range(count):
        if not own_m[i] < np.inf:
            continue
        for j in range(count):
            if j // states != i // states and own_m[j] < np.inf:
                turns[i, j] = turn_m(ends, i, j, radius_m, discs)
    return turns


@njit(cache=True)
def best_order(
    turns: Floats, own_m: Floats, before_m: Floats, behind_m: Floats, states: int
) -> tuple[float, Ints]:
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
    count = len(own_m)
    costs_m = turns + own_m[None, :]
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
    turns: Floats,
    least: Floats,
    ends: Floats,
    own_m: Floats,
    before_m: Floats,
    behind_m: Floats,
    order: Ints,
    rest_m: Floats,
    most_m: float,
    radius_m: float,
    discs: Floats,
) -> tuple[float, Ints]:
    """The cheapest states for a given order of lanes: a shortest path through layers.

    Parameters
    ----------
    turns, least
        What is known of the turns, and what none is shorter than (``turns_kernels``); what is reckoned here
        is written down in the first.
    rest_m
        What all after the lane at each place of the order costs at least, (N,).
    most_m
        What costs more is not looked for: inf is given back.
    """
    lanes = len(order)
    states = turns.shape[2]
    reach = turns.shape[1] // 2
    best = np.full((lanes, states), np.inf)
    came_from = np.full((lanes, states), -1, dtype=np.int64)
    chosen = np.full(lanes, -1, dtype=np.int64)
    lower = np.empty(states)
    for b in range(states):
        best[0, b] = before_m[order[0] * states + b] + own_m[order[0] * states + b]
    for k in range(1, lanes):
        if not best[k - 1].min() + rest_m[k - 1] <= most_m:
            return np.inf, chosen
        step = order[k] - order[k - 1] + reach
        for b in range(states):
            j = order[k] * states + b
            if not own_m[j] < np.inf:
                continue
            for a in range(states):
                known = turns[order[k - 1] * states + a, step, b]
                lower[a] = best[k - 1, a] + own_m[j] + (known if known >= 0.0 else least[step, a, b])
            for _ in range(states):
                # What promises most is reckoned first; where that is as short, the rest is not at all.
                a = int(np.argmin(lower))
                if not lower[a] < np.inf or lower[a] > best[k, b]:
                    break
                lower[a] = np.inf
                i = order[k - 1] * states + a
                if turns[i, step, b] < 0.0:
                    turns[i, step, b] = turn_m(ends, i, j, radius_m, discs)
                cost = best[k - 1, a] + own_m[j]
                cost += turns[i, step, b]
                if cost < best[k, b] or (cost == best[k, b] and a < came_from[k, b]):
                    best[k, b] = cost
                    came_from[k, b] = a
    total, state = np.inf, -1
    for b in range(states):
        cost = best[lanes - 1, b] + behind_m[order[-1] * states + b]
        if cost < total:
            total, state = cost, b
    for k in range(lanes - 1, -1, -1):
        if state < 0:
            break
        chosen[k] = order[k] * states + state
        state = came_from[k, state]
    return total, chosen


@njit(cache=True)
def patterns(lanes: int, widest: int, skips: bool) -> Ints:
    """Boustrophedon and racetracks of every stride up to the widest, from any end; (P, N).

    With ``skips`` also orders that skip lanes, of the same strides.
    """
    # Skipping with a stride of 1 is lane after lane, as a racetrack of stride 0.
    first = np.array([0, 2])
    kinds = 2 if skips else 1
    count = 0
    for kind in range(kinds):
        count += 4 * max(widest + 1 - first[kind], 0)
    orders = np.empty((count, lanes), dtype=np.int64)
    at = 0
    for kind in range(kinds):
        for stride in range(first[kind], widest + 1):
            pattern = racetrack(lanes, stride) if kind == 0 else skipping(lanes, stride)
            for way in range(4):
                order = pattern if way % 2 == 0 else lanes - 1 - pattern
                orders[at] = order if way < 2 else order[::-1]
                at += 1
    return orders


@njit(cache=True)
def rests(orders: Ints, least: Floats, own_m: Floats) -> Floats:
    """What all after the lane at each place of each order costs at least: (P, N)."""
    reach, states = least.shape[0] // 2, least.shape[1]
    lanes = len(own_m) // states
    steps_m = np.empty(least.shape[0])
    for step in range(least.shape[0]):
        steps_m[step] = least[step].min()
    lanes_m = np.empty(lanes)
    for lane in range(lanes):
        lanes_m[lane] = own_m[lane * states : (lane + 1) * states].min()
    rest_m = np.zeros(orders.shape)
    for p in range(orders.shape[0]):
        for k in range(lanes - 2, -1, -1):
            step = orders[p, k + 1] - orders[p, k] + reach
            rest_m[p, k] = rest_m[p, k + 1] + lanes_m[orders[p, k + 1]] + steps_m[step]
    return SLACK * rest_m


@njit(cache=True)
def pattern_order(
    orders: Ints,
    rest_m: Floats,
    turns: Floats,
    least: Floats,
    ends: Floats,
    own_m: Floats,
    before_m: Floats,
    behind_m: Floats,
    radius_m: float,
    discs: Floats,
) -> tuple[float, Ints]:
    """The cheapest of some orders of lanes, the first of those that cost the same.

    Those that promise most are looked at first, none that cannot be the cheapest. Arrays as for
    ``best_states``, of ``patterns`` and ``rests``.
    """
    count, lanes = orders.shape
    states = turns.shape[2]
    total, number = np.inf, count
    chosen = np.full(lanes, -1, dtype=np.int64)
    promised = np.empty(count)
    for p in range(count):
        first = orders[p, 0] * states
        promised[p] = (before_m[first : first + states] + own_m[first : first + states]).min() + rest_m[p, 0]
    for p in np.argsort(promised, kind="mergesort"):
        if not promised[p] < np.inf or promised[p] > total:
            break
        cost, found = best_states(
            turns,
            least,
            ends,
            own_m,
            before_m,
            behind_m,
            orders[p],
            rest_m[p],
            total,
            radius_m,
            discs,
        )
        if cost < total or (cost == total and p < number and cost < np.inf):
            total, chosen, number = cost, found, p
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
    wanted: Flags,
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
    wanted
        Which variants are looked for, shape (4,).
    skips
        Whether orders may skip lanes, as well as run in racetracks, where not every order is tried.
    strides
        Widest stride of either.

    Returns
    -------
    tuple
        Costs of all (P, 4), inf where there is none or it is not wanted, and states in order (P, 4, N).
        Variant 2·b + e begins in the first (b = 0) or second half of the lanes, and ends onward (e = 0) or
        flying back.
    """
    problems, lanes, states = own_m.shape
    costs = np.full((problems, VARIANTS), np.inf)
    orders = np.full((problems, VARIANTS, lanes), -1, dtype=np.int64)
    count = lanes * states
    every = lanes <= EXACT_UP_TO
    reach = max(1, min(strides, (lanes + 1) // 2))
    tried = np.empty((0, lanes), dtype=np.int64) if every else patterns(lanes, reach, skips)
    for p in range(problems):
        entry = entries[p].copy().reshape(count, 3)
        leave = exits[p].copy().reshape(count, 3)
        own = own_m[p].copy().reshape(count)
        cramped = cramped_m[p].copy().reshape(count, 2)
        ends = ends_of(entry, leave, cramped)
        if every:
            between = turns_between(ends, own, states, radius_m, discs)
        else:
            turns = np.full((count, 2 * reach + 1, states), UNKNOWN)
            least = least_turns(ends, own, states, reach, radius_m)
            rest_m = rests(tried, least, own)
        for variant in np.flatnonzero(wanted):
            first = np.full(count, np.inf)
            last = np.full(count, np.inf)
            for lane in range(lanes):
                for b in range(states):
                    in_half = (2 * lane >= lanes) == (variant >= 2)
                    if in_half and begins[b]:
                        first[lane * states + b] = before_m[p, lane, b]
                    if onward[b] == (variant % 2 == 0):
                        last[lane * states + b] = behind_m[p, lane, b]
            if every:
                cost, order = best_order(between, own, first, last, states)
            else:
                cost, order = pattern_order(
                    tried, rest_m, turns, least, ends, own, first, last, radius_m, discs
                )
            costs[p, variant] = cost
            orders[p, variant] = order
    return costs, orders
