"""Compiled estimates of what lies between poses: shortest turns, and what going round zones adds.

Poses are float64 (N, 3): east_m, north_m, angle_rad. Discs are float64 (K, 3): east_m, north_m, radius_m, or
(K, 8) as in ``planner.airspace.barriers``.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from planner.dubins.kernels import dubins_length
from planner.jit import njit

Floats = NDArray[np.float64]


@njit(cache=True)
def crosses(e0: float, n0: float, e1: float, n1: float, half_e: float, half_n: float) -> bool:
    """Whether a straight line meets the inside of a rectangle about the origin, along the axes."""
    low, high = 0.0, 1.0
    for a, b, half in ((e0, e1, half_e), (n0, n1, half_n)):
        half *= 1.0 - 1e-9
        if abs(b - a) < 1e-12:
            if abs(a) >= half:
                return False
            continue
        one, other = (-half - a) / (b - a), (half - a) / (b - a)
        low, high = max(low, min(one, other)), min(high, max(one, other))
    return low < high


@njit(cache=True)
def round_rectangle_m(e0: float, n0: float, e1: float, n1: float, half_e: float, half_n: float) -> float:
    """What going round a rectangle about the origin, along the axes, adds to a straight line.

    By one corner or by two next to each other; nothing where it holds one of the ends.
    """
    if not crosses(e0, n0, e1, n1, half_e, half_n):
        return 0.0
    if (abs(e0) < half_e and abs(n0) < half_n) or (abs(e1) < half_e and abs(n1) < half_n):
        return 0.0
    to = np.empty(4)
    on = np.empty(4)
    for c in range(4):
        ce = half_e if c == 0 or c == 3 else -half_e
        cn = half_n if c < 2 else -half_n
        to[c] = np.inf if crosses(e0, n0, ce, cn, half_e, half_n) else math.hypot(ce - e0, cn - n0)
        on[c] = np.inf if crosses(ce, cn, e1, n1, half_e, half_n) else math.hypot(e1 - ce, n1 - cn)
    best = np.inf
    for c in range(4):
        after = (c + 1) % 4
        edge = 2.0 * half_e if c % 2 == 0 else 2.0 * half_n
        best = min(best, to[c] + on[c], to[c] + edge + on[after], to[after] + edge + on[c])
    return best - math.hypot(e1 - e0, n1 - n0) if best < np.inf else 0.0


@njit(cache=True)
def detour_m(e0: float, n0: float, e1: float, n1: float, discs: Floats) -> float:
    """What going round zones adds to a straight line, each by itself: tangent, arc, tangent.

    A zone that holds one of the ends cannot be gone round and adds nothing. A disc with a price is crossed
    where that is cheaper, and a zone with a rectangle is gone round by its corners; see ``barriers``.
    """
    direct_m = math.hypot(e1 - e0, n1 - n0)
    if direct_m < 1e-9:
        return 0.0
    ue, un = (e1 - e0) / direct_m, (n1 - n0) / direct_m
    extra_m = 0.0
    for k in range(discs.shape[0]):
        ce, cn, r = discs[k, 0] - e0, discs[k, 1] - n0, discs[k, 2]
        along = ce * ue + cn * un
        across = abs(cn * ue - ce * un)
        if across >= r:
            continue
        if discs.shape[1] > 3 and discs[k, 6] > 0.0:
            if along <= -r or along >= direct_m + r:
                continue
            xe, xn = discs[k, 4], discs[k, 5]
            de, dn = ce - direct_m * ue, cn - direct_m * un
            extra_m += round_rectangle_m(
                -ce * xe - cn * xn,
                ce * xn - cn * xe,
                -de * xe - dn * xn,
                de * xn - dn * xe,
                discs[k, 6],
                discs[k, 7],
            )
            continue
        if along <= 0.0 or along >= direct_m:
            continue
        d0 = math.hypot(along, across)
        d1 = math.hypot(direct_m - along, across)
        if d0 <= r or d1 <= r:
            continue
        between = math.atan2(along, across) + math.atan2(direct_m - along, across)
        arc = between - math.acos(r / d0) - math.acos(r / d1)
        round_m = math.sqrt(d0 * d0 - r * r) + math.sqrt(d1 * d1 - r * r) + r * max(arc, 0.0) - direct_m
        if discs.shape[1] > 3:
            round_m = min(round_m, discs[k, 3] * 2.0 * math.sqrt(r * r - across * across))
        extra_m += round_m
    return extra_m


@njit(cache=True)
def point_to_pose_m(e0: float, n0: float, e1: float, n1: float, a1: float, radius: float) -> float:
    """Shortest line of bounded curvature from a place, in any direction, to a pose: a tangent and an arc."""
    best = np.inf
    for side in (1.0, -1.0):
        ce = e1 - side * radius * math.sin(a1)
        cn = n1 + side * radius * math.cos(a1)
        de, dn = e0 - ce, n0 - cn
        d = math.hypot(de, dn)
        if d < radius:
            continue
        touch = math.atan2(dn, de) + side * math.acos(min(1.0, radius / d))
        turn = side * (a1 - side * math.pi / 2.0 - touch)
        turn -= 2.0 * math.pi * math.floor(turn / (2.0 * math.pi))
        if turn > 2.0 * math.pi - 1e-9:
            turn = 0.0
        best = min(best, math.sqrt(max(d * d - radius * radius, 0.0)) + radius * turn)
    return best


@njit(cache=True)
def transit_costs(exits: Floats, entries: Floats, radius: float, discs: Floats) -> Floats:
    """Estimated lengths, shape (N, M): the Dubins word and what going round discs adds to it."""
    costs = np.empty((exits.shape[0], entries.shape[0]))
    for i in range(exits.shape[0]):
        e0, n0, a0 = exits[i]
        for j in range(entries.shape[0]):
            e1, n1, a1 = entries[j]
            costs[i, j] = dubins_length(e0, n0, a0, e1, n1, a1, radius) + detour_m(e0, n0, e1, n1, discs)
    return costs


@njit(cache=True)
def point_costs(e0: float, n0: float, entries: Floats, radius: float, discs: Floats) -> Floats:
    """The same from a place in any direction, shape (M,)."""
    costs = np.empty(entries.shape[0])
    for j in range(entries.shape[0]):
        e1, n1, a1 = entries[j]
        costs[j] = point_to_pose_m(e0, n0, e1, n1, a1, radius) + detour_m(e0, n0, e1, n1, discs)
    return costs
