"""Compiled: one strip as a pass, whether it may be flown, what it sees, and the ways between passes.

The plain twins are ``choose.Search.sweeps_over``, ``room.Room.flyable``, ``programme.Pricing`` and
``programme.seen_worth``.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from planner.dubins.kernels import dubins_length
from planner.jit import njit

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Looks = NDArray[np.signedinteger[Any]]

#: Columns of a pass: east, north, unit vector along, ahead from and to, aside from and to that it sees (as
#: ``kernels.mark_seen`` has them), its end, its course, and metres through the air that it takes.
COLUMNS = 12
#: Columns of a swath by course: run in and out, middle, metres through the air by metre, then what is seen
#: with no margin used up: run in and out, right and left edge.
SWATH = 8
#: Columns of a flight: start and end, turn radius, settling run, mean of the way through the air in turns,
#: what it may take in all.
FLIGHT = 8
#: A pass is no shorter than this.
LEAST_PASS_M = 2.0
TWO_PI = 2.0 * math.pi
SMALL = 1e-12


@njit(cache=True, nogil=True)
def _of_course(table: Floats, course_rad: float, column: int) -> float:
    """A column of a table by course, between its rows on a line."""
    rows = len(table)
    at = (course_rad / TWO_PI - math.floor(course_rad / TWO_PI)) * rows
    low = min(int(at), rows - 1)
    part = at - low
    return float(table[low, column] * (1.0 - part) + table[(low + 1) % rows, column] * part)


@njit(cache=True, nogil=True)
def passed(strip: Floats, table: Floats, settle_m: float, row: Floats) -> bool:
    """The pass (12,) that sees a strip (2, 2); False where the strip is too short for one."""
    e, n = strip[1, 0] - strip[0, 0], strip[1, 1] - strip[0, 1]
    length_m = math.sqrt(e * e + n * n)
    if length_m < SMALL:
        return False
    e, n = e / length_m, n / length_m
    course_rad = math.atan2(n, e)
    in_m, out_m = _of_course(table, course_rad, 0), _of_course(table, course_rad, 1)
    whole_m = length_m + in_m + out_m
    if whole_m < max(0.0, in_m + out_m) + LEAST_PASS_M:
        return False
    middle_m = _of_course(table, course_rad, 2)
    row[0] = strip[0, 0] + middle_m * n - in_m * e
    row[1] = strip[0, 1] - middle_m * e - in_m * n
    row[2], row[3] = e, n
    row[4] = _of_course(table, course_rad, 4)
    row[5] = whole_m - _of_course(table, course_rad, 5)
    row[6], row[7] = _of_course(table, course_rad, 6), _of_course(table, course_rad, 7)
    row[8], row[9] = row[0] + whole_m * e, row[1] + whole_m * n
    row[10] = course_rad
    row[11] = (whole_m + settle_m) * _of_course(table, course_rad, 3)
    return True


@njit(cache=True, nogil=True)
def _inside(e: float, n: float, edges: Floats) -> bool:
    """Whether a place lies in polygons of these edges (N, 4)."""
    odd = False
    for k in range(len(edges)):
        if (edges[k, 1] > n) != (edges[k, 3] > n):
            part = (n - edges[k, 1]) / (edges[k, 3] - edges[k, 1])
            if e < edges[k, 0] + part * (edges[k, 2] - edges[k, 0]):
                odd = not odd
    return odd


@njit(cache=True, nogil=True)
def _crosses(e0: float, n0: float, e1: float, n1: float, edges: Floats) -> bool:
    """Whether a line crosses any of the edges (N, 4)."""
    low_e, high_e, low_n, high_n = min(e0, e1), max(e0, e1), min(n0, n1), max(n0, n1)
    for k in range(len(edges)):
        a, b, c, d = edges[k, 0], edges[k, 1], edges[k, 2], edges[k, 3]
        if max(a, c) < low_e or min(a, c) > high_e or max(b, d) < low_n or min(b, d) > high_n:
            continue
        first = (e1 - e0) * (b - n0) - (n1 - n0) * (a - e0)
        second = (e1 - e0) * (d - n0) - (n1 - n0) * (c - e0)
        if (first > 0.0) == (second > 0.0):
            continue
        third = (c - a) * (n0 - b) - (d - b) * (e0 - a)
        fourth = (c - a) * (n1 - b) - (d - b) * (e1 - a)
        if (third > 0.0) != (fourth > 0.0):
            return True
    return False


@njit(cache=True, nogil=True)
def clear(row: Floats, settle_m: float, radius_m: float, free: Floats, turning: Floats) -> bool:
    """Whether a pass and its settling run may be flown, with room for a turn to a side before and behind."""
    e, n = row[2], row[3]
    before_e, before_n = row[0] - settle_m * e, row[1] - settle_m * n
    for k in range(2):
        at_e, at_n = (before_e, before_n) if k == 0 else (row[8], row[9])
        left = _inside(at_e - radius_m * n, at_n + radius_m * e, turning)
        if not left and not _inside(at_e + radius_m * n, at_n - radius_m * e, turning):
            return False
    return _inside(before_e, before_n, free) and not _crosses(before_e, before_n, row[8], row[9], free)


@njit(cache=True, nogil=True)
def _through_air_m(length_m: float, e: float, n: float, table: Floats, flight: Floats) -> float:
    """A way of a length to a place off by so much, through the air."""
    direct_m = math.sqrt(e * e + n * n)
    along = _of_course(table, math.atan2(n, e), 3)
    return float(direct_m * along + (length_m - direct_m) * flight[6])


@njit(cache=True, nogil=True)
def leg_m(rows: Floats, before: int, after: int, flight: Floats, table: Floats) -> float:
    """Metres through the air from one pass to another: -1 for the start, and for the end."""
    radius_m = flight[4]
    if after < 0 and before < 0:
        return math.hypot(flight[2] - flight[0], flight[3] - flight[1])
    if after < 0:
        e0, n0, a0 = rows[before, 8], rows[before, 9], rows[before, 10]
        e1, n1 = flight[2], flight[3]
        a1 = math.atan2(n1 - n0, e1 - e0)
    else:
        e1 = rows[after, 0] - flight[5] * rows[after, 2]
        n1 = rows[after, 1] - flight[5] * rows[after, 3]
        a1 = rows[after, 10]
        if before < 0:
            e0, n0 = flight[0], flight[1]
            a0 = math.atan2(n1 - n0, e1 - e0)
        else:
            e0, n0, a0 = rows[before, 8], rows[before, 9], rows[before, 10]
    length_m = dubins_length(e0, n0, a0, e1, n1, a1, radius_m)
    return _through_air_m(length_m, e1 - e0, n1 - n0, table, flight)


@njit(cache=True, nogil=True)
def cost_m(rows: Floats, count: int, flight: Floats, table: Floats) -> float:
    """Metres through the air of all passes (N, 12) from the start to the end."""
    total_m = leg_m(rows, -1, 0 if count > 0 else -1, flight, table)
    for k in range(count):
        total_m += rows[k, 11] + leg_m(rows, k, k + 1 if k + 1 < count else -1, flight, table)
    return total_m


@njit(cache=True, nogil=True)
def look(
    looks: Looks,
    scores: Floats,
    pays: Floats,
    west_m: float,
    south_m: float,
    cell_m: float,
    row: Floats,
    by: int,
) -> float:
    """Add a look of a pass to the cells that it sees, or take it away (``by`` -1): the worth that this is.

    Parameters
    ----------
    pays
        What each look at a place finds of what it is worth, the first one first; later ones find nothing.
    """
    rows, columns = scores.shape
    ae, an = row[2], row[3]
    gained = 0.0
    # Where later looks find nothing those at nothing seen yet are counted alone: most searches are such.
    single, before = len(pays) == 1, 0 if by > 0 else 1
    least_n, most_n = np.inf, -np.inf
    for far in (row[4], row[5]):
        for side in (row[6], row[7]):
            there = row[1] + far * an + side * ae
            least_n, most_n = min(least_n, there), max(most_n, there)
    first = max(0, math.ceil((least_n - south_m) / cell_m - 0.5))
    last = min(rows - 1, math.floor((most_n - south_m) / cell_m - 0.5))
    for i in range(first, last + 1):
        n = south_m + (i + 0.5) * cell_m - row[1]
        low, high = -np.inf, np.inf
        if abs(ae) > SMALL:
            one, other = (row[4] - n * an) / ae, (row[5] - n * an) / ae
            low, high = min(one, other), max(one, other)
        elif not row[4] <= n * an <= row[5]:
            continue
        if abs(an) > SMALL:
            one, other = (n * ae - row[7]) / an, (n * ae - row[6]) / an
            low, high = max(low, min(one, other)), min(high, max(one, other))
        elif not row[6] <= n * ae <= row[7]:
            continue
        left = max(0.0, math.ceil((low + row[0] - west_m) / cell_m - 0.5))
        right = min(columns - 1.0, math.floor((high + row[0] - west_m) / cell_m - 0.5))
        if right < left:
            continue
        there, worth = looks[i, int(left) : int(right) + 1], scores[i, int(left) : int(right) + 1]
        if single:
            for j in range(len(there)):
                had = there[j]
                there[j] = had + by
                gained += worth[j] if had == before else 0.0
            continue
        for j in range(len(there)):
            had = there[j]
            there[j] = had + by
            k = had if by > 0 else had - 1
            if k < len(pays):
                gained += by * pays[k] * worth[j]
    if single:
        gained *= by * pays[0]
    return gained * cell_m * cell_m


@njit(cache=True, nogil=True)
def reach_of(row: Floats, corner: Floats, rows: int, columns: int, reach: Ints) -> None:
    """Widen a range of cells (4,), first and behind the last of rows and columns, to what a pass sees."""
    least_e, most_e, least_n, most_n = np.inf, -np.inf, np.inf, -np.inf
    for far in (row[4], row[5]):
        for side in (row[6], row[7]):
            e, n = row[0] + far * row[2] - side * row[3], row[1] + far * row[3] + side * row[2]
            least_e, most_e = min(least_e, e), max(most_e, e)
            least_n, most_n = min(least_n, n), max(most_n, n)
    reach[0] = min(reach[0], max(0, math.floor((least_n - corner[1]) / corner[2]) - 1))
    reach[1] = max(reach[1], min(rows, math.ceil((most_n - corner[1]) / corner[2]) + 1))
    reach[2] = min(reach[2], max(0, math.floor((least_e - corner[0]) / corner[2]) - 1))
    reach[3] = max(reach[3], min(columns, math.ceil((most_e - corner[0]) / corner[2]) + 1))
