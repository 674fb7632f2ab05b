"""Compiled parts of sweeps: what each strip has to span, and the best order of lanes.

They know nothing but numbers. Poses are float64 (S, 3): east_m, north_m, angle_rad; discs float64 (K, 3).
"""

from __future__ import annotations

import math

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
#: An edge along a strip's own edge is in it or not, whatever the last digit of a coordinate.
WITHIN_M = 2.5e-4
#: Widest stride of the racetrack patterns.
STRIDES = 12


@njit(cache=True)
def strip_extents(edges: Floats, angles_rad: Floats, low_m: Floats, high_m: Floats) -> Floats:
    """Along-track extent of an outline within strips.

    Parameters
    ----------
    edges
        Shape (E, 4): both ends of each edge, east_m, north_m, east_m, north_m.
    angles_rad
        Flight directions, shape (M,); x̂ ahead, ŷ to the left.
    low_m, high_m
        ŷ of each strip's edges, shape (M, K, N); what is less than ``WITHIN_M`` inside them is another's.

    Returns
    -------
    ndarray
        Shape (M, K, N, 2): least and largest x̂, (inf, −inf) for a strip the outline does not touch.
    """
    extents = np.empty((*low_m.shape, 2))
    extents[..., 0] = np.inf
    extents[..., 1] = -np.inf
    for m in range(len(angles_rad)):
        cos, sin = math.cos(angles_rad[m]), math.sin(angles_rad[m])
        for i in range(edges.shape[0]):
            x0 = cos * edges[i, 0] + sin * edges[i, 1]
            y0 = cos * edges[i, 1] - sin * edges[i, 0]
            x1 = cos * edges[i, 2] + sin * edges[i, 3]
            y1 = cos * edges[i, 3] - sin * edges[i, 2]
            if y0 > y1:
                x0, y0, x1, y1 = x1, y1, x0, y0
            for k in range(low_m.shape[1]):
                for n in range(low_m.shape[2]):
                    low, high = low_m[m, k, n] + WITHIN_M, high_m[m, k, n] - WITHIN_M
                    if y1 < low or y0 > high:
                        continue
                    xa, xb = x0, x1
                    if y0 < low:
                        xa = x0 + (x1 - x0) * (low - y0) / (y1 - y0)
                    if y1 > high:
                        xb = x0 + (x1 - x0) * (high - y0) / (y1 - y0)
                    extents[m, k, n, 0] = min(extents[m, k, n, 0], xa, xb)
                    extents[m, k, n, 1] = max(extents[m, k, n, 1], xa, xb)
    return extents


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
def pattern_order(turns: Floats, own_m: Floats, before_m: Floats, behind_m: Floats) -> tuple[float, Ints]:
    """The cheapest of boustrophedon and racetracks of every stride the turns reach, from either end.

    Arrays as for ``best_order``.
    """
    states = turns.shape[2]
    lanes = len(own_m) // states
    total = np.inf
    chosen = np.full(lanes, -1, dtype=np.int64)
    for stride in range(min(turns.shape[1] // 2, (lanes + 1) // 2) + 1):
        pattern = racetrack(lanes, stride)
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
    onward: Flags,
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
    onward
        Which states fly in the problem's own direction, shape (B,); the first lane is one of these.
    strides
        Widest stride of racetracks.

    Returns
    -------
    tuple
        Costs of all (P, 4), inf where there is none, and states in order (P, 4, N). Variant 2·b + e begins
        in the left (b = 0) or right half of the lanes, and ends onward (e = 0) or flying back.
    """
    problems, lanes, states = own_m.shape
    costs = np.full((problems, 4), np.inf)
    orders = np.full((problems, 4, lanes), -1, dtype=np.int64)
    count = lanes * states
    reach = lanes - 1 if lanes <= EXACT_UP_TO else max(1, min(strides, (lanes + 1) // 2))
    for p in range(problems):
        entry = entries[p].copy().reshape(count, 3)
        leave = exits[p].copy().reshape(count, 3)
        own = own_m[p].copy().reshape(count)
        cramped = cramped_m[p].copy().reshape(count, 2)
        turns = turns_between(entry, leave, own, cramped, states, reach, radius_m, discs)
        for variant in range(4):
            first = np.full(count, np.inf)
            last = np.full(count, np.inf)
            for lane in range(lanes):
                for b in range(states):
                    in_half = (2 * lane >= lanes) == (variant >= 2)
                    if in_half and onward[b]:
                        first[lane * states + b] = before_m[p, lane, b]
                    if onward[b] == (variant % 2 == 0):
                        last[lane * states + b] = behind_m[p, lane, b]
            if lanes <= EXACT_UP_TO:
                cost, order = best_order(turns, own, first, last)
            else:
                cost, order = pattern_order(turns, own, first, last)
            costs[p, variant] = cost
            orders[p, variant] = order
    return costs, orders
