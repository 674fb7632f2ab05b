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
        ŷ of each strip's edges, shape (M, K, N).

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
                    low, high = low_m[m, k, n], high_m[m, k, n]
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
def turn_m(
    exits: Floats, entries: Floats, i: int, j: int, cramped_m: Floats, radius_m: float, discs: Floats
) -> float:
    """Length of the turn from state i to state j, with what discs and want of room add.

    ``cramped_m``, shape (S, 2), is what each state's entry and exit cost where no full turn fits.
    """
    turn = dubins_length(
        exits[i, 0], exits[i, 1], exits[i, 2], entries[j, 0], entries[j, 1], entries[j, 2], radius_m
    )
    turn += detour_m(exits[i, 0], exits[i, 1], entries[j, 0], entries[j, 1], discs)
    return float(turn + max(cramped_m[i, 1], cramped_m[j, 0]))


@njit(cache=True)
def best_order(
    entries: Floats,
    exits: Floats,
    own_m: Floats,
    cramped_m: Floats,
    states: int,
    first: Flags,
    last: Flags,
    radius_m: float,
    discs: Floats,
) -> tuple[float, Ints]:
    """The cheapest way to fly every lane once, in one of its states each; exact.

    Dynamic programming over subsets of lanes and the state flown last (Held and Karp 1962, clustered).

    Parameters
    ----------
    entries, exits, own_m
        Of each state, S = N · ``states``, lane by lane; ``own_m`` is inf where it may not be flown.
    first, last
        Which states may come first and last, shape (S,).

    Returns
    -------
    tuple
        The cost, inf where there is no way, and the states in order, shape (N,).
    """
    count = len(own_m)
    turns = np.empty((count, count))
    for i in range(count):
        for j in range(count):
            if i // states != j // states and own_m[i] < np.inf and own_m[j] < np.inf:
                turns[i, j] = turn_m(exits, entries, i, j, cramped_m, radius_m, discs) + own_m[j]
            else:
                turns[i, j] = np.inf
    begin_m = np.where(first, own_m, np.inf)
    end_m = np.where(last, 0.0, np.inf)
    costs, tours = best_orders(begin_m, turns, end_m, np.arange(0, count + 1, states))
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
    entries: Floats,
    exits: Floats,
    own_m: Floats,
    cramped_m: Floats,
    states: int,
    first: Flags,
    last: Flags,
    radius_m: float,
    discs: Floats,
    order: Ints,
) -> tuple[float, Ints]:
    """The cheapest states for a given order of lanes: a shortest path through layers. Arrays as above."""
    lanes = len(order)
    best = np.full((lanes, states), np.inf)
    came_from = np.full((lanes, states), -1, dtype=np.int64)
    for b in range(states):
        if first[order[0] * states + b]:
            best[0, b] = own_m[order[0] * states + b]
    for k in range(1, lanes):
        for a in range(states):
            if not best[k - 1, a] < np.inf:
                continue
            for b in range(states):
                i, j = order[k - 1] * states + a, order[k] * states + b
                if not own_m[j] < np.inf:
                    continue
                cost = best[k - 1, a] + own_m[j] + turn_m(exits, entries, i, j, cramped_m, radius_m, discs)
                if cost < best[k, b]:
                    best[k, b] = cost
                    came_from[k, b] = a
    total, state = np.inf, -1
    for b in range(states):
        if last[order[-1] * states + b] and best[lanes - 1, b] < total:
            total, state = best[lanes - 1, b], b
    chosen = np.full(lanes, -1, dtype=np.int64)
    for k in range(lanes - 1, -1, -1):
        if state < 0:
            break
        chosen[k] = order[k] * states + state
        state = came_from[k, state]
    return total, chosen


@njit(cache=True)
def pattern_order(
    entries: Floats,
    exits: Floats,
    own_m: Floats,
    cramped_m: Floats,
    states: int,
    first: Flags,
    last: Flags,
    radius_m: float,
    discs: Floats,
) -> tuple[float, Ints]:
    """The cheapest of boustrophedon and racetracks of every stride, from either end. As ``best_order``."""
    lanes = len(own_m) // states
    total = np.inf
    chosen = np.full(lanes, -1, dtype=np.int64)
    for stride in range(min(STRIDES, (lanes + 1) // 2) + 1):
        pattern = racetrack(lanes, stride)
        for way in range(4):
            order = pattern.copy()
            if way % 2 == 1:
                order = lanes - 1 - order
            if way >= 2:
                order = order[::-1].copy()
            cost, found = best_states(
                entries, exits, own_m, cramped_m, states, first, last, radius_m, discs, order
            )
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
    onward: Flags,
    radius_m: float,
    discs: Floats,
) -> tuple[Floats, Ints]:
    """The best order of lanes for many headings and offsets, by where it begins and which way it ends.

    Parameters
    ----------
    entries, exits, own_m, cramped_m
        Shapes (P, N, B, 3), (P, N, B, 3), (P, N, B) and (P, N, B, 2): problem, lane, state.
    onward
        Which states fly in the problem's own direction, shape (B,); the first lane is one of these.

    Returns
    -------
    tuple
        Costs (P, 4), inf where there is none, and states in order (P, 4, N). Variant 2·b + e begins in the
        left (b = 0) or right half of the lanes, and ends onward (e = 0) or flying back.
    """
    problems, lanes, states = own_m.shape
    costs = np.full((problems, 4), np.inf)
    orders = np.full((problems, 4, lanes), -1, dtype=np.int64)
    count = lanes * states
    for p in range(problems):
        entry = entries[p].copy().reshape(count, 3)
        leave = exits[p].copy().reshape(count, 3)
        own = own_m[p].copy().reshape(count)
        cramped = cramped_m[p].copy().reshape(count, 2)
        for variant in range(4):
            first = np.zeros(count, dtype=np.bool_)
            last = np.zeros(count, dtype=np.bool_)
            for lane in range(lanes):
                for b in range(states):
                    in_half = (2 * lane >= lanes) == (variant >= 2)
                    first[lane * states + b] = in_half and onward[b]
                    last[lane * states + b] = onward[b] == (variant % 2 == 0)
            if lanes <= EXACT_UP_TO:
                cost, order = best_order(entry, leave, own, cramped, states, first, last, radius_m, discs)
            else:
                cost, order = pattern_order(entry, leave, own, cramped, states, first, last, radius_m, discs)
            costs[p, variant] = cost
            orders[p, variant] = order
    return costs, orders
