"""Compiled ways among obstacles: what sees what, and shortest lines round corners.

``walls`` are the rings not to be crossed, in cells of a grid; ``corners`` float64 (N, 2); ``between`` float64
(N, N), lengths of ways from corner to corner, inf where there is none.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from planner.jit import njit

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

#: Rounding of where a line leaves a column of cells.
SPARE_M = 1e-6


class Walls(NamedTuple):
    """Edges not to be crossed, found by the cells of a grid that they lie in.

    Parameters
    ----------
    edges
        float64 (E, 4): east0, north0, east1, north1.
    starts, listed
        Edges whose box meets cell c, ``listed[starts[c]:starts[c + 1]]``; cell (i, j) is c = i * rows + j.
    frame
        float64 (6,): least east and north, cells a metre east and north, columns, rows.
    """

    edges: Floats
    starts: Ints
    listed: Ints
    frame: Floats


@njit(cache=True, nogil=True)
def _cell(value: float, least: float, a_metre: float, count: int) -> int:
    """Which of so many cells a coordinate lies in, the nearest where in none."""
    return int(min(max((value - least) * a_metre, 0.0), count - 1.0))


@njit(cache=True, nogil=True)
def gridded(edges: Floats, frame: Floats) -> tuple[Ints, Ints]:
    """Starts and lists of a grid, see ``Walls``."""
    columns, rows = int(frame[4]), int(frame[5])
    counts = np.zeros(columns * rows + 1, dtype=np.int64)
    filled = np.zeros(columns * rows, dtype=np.int64)
    listed = np.empty(0, dtype=np.int64)
    for fill in range(2):
        for k in range(len(edges)):
            west, east = min(edges[k, 0], edges[k, 2]), max(edges[k, 0], edges[k, 2])
            south, north = min(edges[k, 1], edges[k, 3]), max(edges[k, 1], edges[k, 3])
            last_column = _cell(east, frame[0], frame[2], columns)
            last_row = _cell(north, frame[1], frame[3], rows)
            for i in range(_cell(west, frame[0], frame[2], columns), last_column + 1):
                for j in range(_cell(south, frame[1], frame[3], rows), last_row + 1):
                    if fill == 0:
                        counts[i * rows + j + 1] += 1
                    else:
                        listed[filled[i * rows + j]] = k
                        filled[i * rows + j] += 1
        if fill == 0:
            counts = np.cumsum(counts)
            filled = counts[:-1].copy()
            listed = np.empty(counts[-1], dtype=np.int64)
    return counts, listed


@njit(cache=True, nogil=True)
def _meets(edges: Floats, k: int, e0: float, n0: float, e1: float, n1: float) -> bool:
    """Whether a straight line meets an edge."""
    a, b, c, d = edges[k, 0], edges[k, 1], edges[k, 2], edges[k, 3]
    if max(a, c) < min(e0, e1) or min(a, c) > max(e0, e1):
        return False
    if max(b, d) < min(n0, n1) or min(b, d) > max(n0, n1):
        return False
    de, dn = e1 - e0, n1 - n0
    first = de * (b - n0) - dn * (a - e0)
    second = de * (d - n0) - dn * (c - e0)
    if (first > 0.0 and second > 0.0) or (first < 0.0 and second < 0.0):
        return False
    fe, fn = c - a, d - b
    third = fe * (n0 - b) - fn * (e0 - a)
    fourth = fe * (n1 - b) - fn * (e1 - a)
    return not ((third > 0.0 and fourth > 0.0) or (third < 0.0 and fourth < 0.0))


@njit(cache=True, nogil=True)
def crosses(walls: Walls, e0: float, n0: float, e1: float, n1: float) -> bool:
    """Whether a straight line meets an edge: looked for in the cells along it, from its start on."""
    edges, starts, listed, frame = walls
    columns, rows = int(frame[4]), int(frame[5])
    first, last = _cell(e0, frame[0], frame[2], columns), _cell(e1, frame[0], frame[2], columns)
    step = 1 if last >= first else -1
    slope = (n1 - n0) / (e1 - e0) if e1 != e0 else 0.0
    i = first
    while True:
        south, north = n0, n1
        if first != last:
            # the line's ordinates within this column of cells, the outer columns having no outer border
            if i != first:
                border = frame[0] + (i if step > 0 else i + 1) / frame[2]
                south = n0 + slope * (border - e0)
            if i != last:
                border = frame[0] + (i + 1 if step > 0 else i) / frame[2]
                north = n0 + slope * (border - e0)
        low = _cell(min(south, north) - SPARE_M, frame[1], frame[3], rows)
        high = _cell(max(south, north) + SPARE_M, frame[1], frame[3], rows)
        for j in range(low, high + 1):
            for at in range(starts[i * rows + j], starts[i * rows + j + 1]):
                if _meets(edges, listed[at], e0, n0, e1, n1):
                    return True
        if i == last:
            return False
        i += step


@njit(cache=True, nogil=True)
def corner_graph(walls: Walls, corners: Floats) -> tuple[Ints, Ints, Floats]:
    """The graph of corners that see each other, in rows: starts (N + 1,), towards, lengths."""
    count = len(corners)
    seen = np.zeros((count, count), dtype=np.bool_)
    for i in range(count):
        for j in range(i + 1, count):
            if not crosses(walls, corners[i, 0], corners[i, 1], corners[j, 0], corners[j, 1]):
                seen[i, j] = True
                seen[j, i] = True
    starts = np.zeros(count + 1, dtype=np.int64)
    for i in range(count):
        starts[i + 1] = starts[i] + seen[i].sum()
    towards = np.empty(starts[count], dtype=np.int64)
    lengths = np.empty(starts[count])
    for i in range(count):
        at = starts[i]
        for j in range(count):
            if seen[i, j]:
                towards[at] = j
                lengths[at] = math.hypot(corners[j, 0] - corners[i, 0], corners[j, 1] - corners[i, 1])
                at += 1
    return starts, towards, lengths


@njit(cache=True, nogil=True)
def bends_of_way(
    walls: Walls, corners: Floats, between: Floats, e0: float, n0: float, e1: float, n1: float
) -> tuple[int, int, float]:
    """First and last corner of the shortest way between places that do not see each other, and its length.

    -1, -1 and inf where there is none. Corners come in the order of the least way that can lead by them.
    """
    count = len(corners)
    off = np.hypot(corners[:, 0] - e0, corners[:, 1] - n0)
    on = np.hypot(corners[:, 0] - e1, corners[:, 1] - n1)
    least = off + on
    firsts, lasts = np.empty(count, dtype=np.int64), np.empty(count, dtype=np.int64)
    left, right = 0, 0
    best, first, last = np.inf, -1, -1
    for c in np.argsort(least):
        if least[c] >= best:
            break
        if not crosses(walls, e0, n0, corners[c, 0], corners[c, 1]):
            firsts[left] = c
            left += 1
            for k in range(right):
                length = off[c] + between[c, lasts[k]] + on[lasts[k]]
                if length < best:
                    best, first, last = length, c, lasts[k]
        if not crosses(walls, corners[c, 0], corners[c, 1], e1, n1):
            lasts[right] = c
            right += 1
            for k in range(left):
                length = off[firsts[k]] + between[firsts[k], c] + on[c]
                if length < best:
                    best, first, last = length, firsts[k], c
    return first, last, best


@njit(cache=True, nogil=True)
def way_lengths(walls: Walls, corners: Floats, between: Floats, origins: Floats, goals: Floats) -> Floats:
    """Shortest lengths from each origin (M, 2) to each goal (K, 2), (M, K); inf where there is no way."""
    count = len(corners)
    reach = np.full((len(goals), count), np.inf)
    for g in range(len(goals)):
        for i in range(count):
            if not crosses(walls, goals[g, 0], goals[g, 1], corners[i, 0], corners[i, 1]):
                reach[g, i] = math.hypot(corners[i, 0] - goals[g, 0], corners[i, 1] - goals[g, 1])
    out = np.full((len(origins), len(goals)), np.inf)
    known = np.empty(count)
    for m in range(len(origins)):
        e, n = origins[m, 0], origins[m, 1]
        known[:] = np.inf
        for i in range(count):
            if not crosses(walls, e, n, corners[i, 0], corners[i, 1]):
                first = math.hypot(corners[i, 0] - e, corners[i, 1] - n)
                for j in range(count):
                    known[j] = min(known[j], first + between[i, j])
        for g in range(len(goals)):
            if not crosses(walls, e, n, goals[g, 0], goals[g, 1]):
                out[m, g] = math.hypot(goals[g, 0] - e, goals[g, 1] - n)
                continue
            for i in range(count):
                length = known[i] + reach[g, i]
                if length < out[m, g]:
                    out[m, g] = length
    return out
