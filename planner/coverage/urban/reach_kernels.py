"""Compiled lengths of joins between many places among obstacles: straight, round corners, or over them.

Arrays as in ``visibility_kernels``; ``outlines`` float64 (E, 4) are edges that a straight line may cross at
a height, ``rises`` float64 (E,) what has to be climbed for each, inf where that is not allowed.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from planner.coverage.urban.visibility_kernels import Walls, crosses
from planner.jit import njit

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Corners nearest to a place that are tried at first, and how many of those that it sees are used.
TRIED_CORNERS, SEEN_CORNERS = 40, 16
#: Cosine of what is no turn.
STRAIGHT = math.cos(math.radians(1.0))


@njit(cache=True, nogil=True)
def over_length(
    outlines: Floats, rises: Floats, steepest: float, e0: float, n0: float, e1: float, n1: float
) -> float:
    """Length of a line over obstacles: up to the first, level, down from the last; inf where it is forbidden.

    ``steepest`` is the greatest tangent of its climb.
    """
    west, east = min(e0, e1), max(e0, e1)
    south, north = min(n0, n1), max(n0, n1)
    de, dn = e1 - e0, n1 - n0
    rise, first, last = 0.0, 1.0, 0.0
    for k in range(len(outlines)):
        a, b, c, d = outlines[k, 0], outlines[k, 1], outlines[k, 2], outlines[k, 3]
        if max(a, c) < west or min(a, c) > east or max(b, d) < south or min(b, d) > north:
            continue
        if (de * (b - n0) - dn * (a - e0)) * (de * (d - n0) - dn * (c - e0)) > 0.0:
            continue
        fe, fn = c - a, d - b
        begin, end = fe * (n0 - b) - fn * (e0 - a), fe * (n1 - b) - fn * (e1 - a)
        if begin * end > 0.0:
            continue
        if rises[k] == np.inf:
            return np.inf
        rise = max(rise, rises[k])
        part = begin / (begin - end) if begin != end else 0.0
        first, last = min(first, part), max(last, part)
    length = math.hypot(de, dn)
    up, down = first * length, (1.0 - last) * length
    if rise > steepest * min(up, down):
        return np.inf
    return math.hypot(up, rise) + max(last - first, 0.0) * length + math.hypot(down, rise)


@njit(cache=True, nogil=True)
def _nearest(places: Floats, east: float, north: float, most: int) -> Ints:
    """Up to so many places nearest to one, nearest first."""
    count = min(most, len(places))
    kept = np.empty(count, dtype=np.int64)
    away = np.full(count, np.inf)
    for i in range(len(places)):
        square = (places[i, 0] - east) ** 2 + (places[i, 1] - north) ** 2
        if count == 0 or square >= away[count - 1]:
            continue
        at = count - 1
        while at > 0 and away[at - 1] > square:
            away[at], kept[at] = away[at - 1], kept[at - 1]
            at -= 1
        away[at], kept[at] = square, i
    return kept


@njit(cache=True, nogil=True)
def _turn(ahead: Floats, p: int, east: float, north: float, bend: float) -> float:
    """What turning into a direction counts at an end: nothing where it is left straight ahead."""
    along = ahead[p, 0] * east + ahead[p, 1] * north
    length = math.hypot(east, north)
    if length == 0.0 or along >= STRAIGHT * length or (ahead[p, 0] == 0.0 and ahead[p, 1] == 0.0):
        return 0.0
    return bend


@njit(cache=True, nogil=True)
def _by_corners(
    walls: Walls, corners: Floats, between: Floats, places: Floats, ahead: Floats, bend: float
) -> Floats:
    """What ways between all places round the corners that both ends see nearest take, (P, P)."""
    count, bends = len(places), len(corners)
    out = np.full((count, count), np.inf)
    reach = np.full((count, bends), np.inf)
    seen = np.empty((count, SEEN_CORNERS), dtype=np.int64)
    found = np.zeros(count, dtype=np.int64)
    for p in range(count):
        e, n = places[p, 0], places[p, 1]
        tried = 0
        most = TRIED_CORNERS
        while found[p] == 0 and tried < bends:
            near = _nearest(corners, e, n, most)
            for i in near[tried:]:
                if found[p] == SEEN_CORNERS:
                    break
                if not crosses(walls, e, n, corners[i, 0], corners[i, 1]):
                    seen[p, found[p]] = i
                    found[p] += 1
            tried = len(near)
            most *= 4
        for k in range(found[p]):
            i = seen[p, k]
            first = math.hypot(corners[i, 0] - e, corners[i, 1] - n)
            first += _turn(ahead, p, corners[i, 0] - e, corners[i, 1] - n, bend)
            for j in range(bends):
                reach[p, j] = min(reach[p, j], first + between[i, j])
    for p in range(count):
        for k in range(found[p]):
            i = seen[p, k]
            de, dn = corners[i, 0] - places[p, 0], corners[i, 1] - places[p, 1]
            first = math.hypot(de, dn) + bend + _turn(ahead, p, de, dn, bend)
            for q in range(p):
                out[p, q] = min(out[p, q], first + reach[q, i])
    return out


@njit(cache=True, nogil=True)
def join_lengths(
    walls: Walls,
    corners: Floats,
    between: Floats,
    outlines: Floats,
    rises: Floats,
    steepest: float,
    places: Floats,
    ahead: Floats,
    bend: float,
    near: int,
) -> Floats:
    """What joins between all places take, (P, P): never too little, and hardly too much.

    To so many of the nearest places straight lines are tried too, and lines over obstacles; to others only
    where no corner leads there.

    ``between`` are the corners' ways, (N, N), with ``bend`` for each of their edges; ``steepest`` is the
    greatest tangent of a climb; ``ahead``, (P, 2), are the directions places are left in without a turn.
    Each turn counts ``bend``, four of them over obstacles.
    """
    count = len(places)
    out = _by_corners(walls, corners, between, places, ahead, bend)
    for p in range(count):
        e, n = places[p, 0], places[p, 1]
        close = _nearest(places, e, n, near + 1)
        wanted = np.zeros(count, dtype=np.bool_)
        wanted[close] = True
        for q in range(count):
            a, b = max(p, q), min(p, q)
            if p == q or not (wanted[q] or (q < p and out[p, q] == np.inf)):
                continue
            de, dn = places[q, 0] - e, places[q, 1] - n
            away = math.hypot(de, dn)
            away += _turn(ahead, p, de, dn, bend) + _turn(ahead, q, -de, -dn, bend)
            if out[a, b] <= away:
                continue
            if not crosses(walls, e, n, places[q, 0], places[q, 1]):
                out[a, b] = away
            elif len(outlines):
                over = over_length(outlines, rises, steepest, e, n, places[q, 0], places[q, 1])
                out[a, b] = min(out[a, b], over + 4.0 * bend)
    for p in range(count):
        out[p, p] = 0.0
        for q in range(p):
            out[q, p] = out[p, q]
    return out
