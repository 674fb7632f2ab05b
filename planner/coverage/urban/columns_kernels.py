"""Compiled free intervals of a polygon in columns, and what of them sweeps see.

A column is a strip between two neighbouring abscissas in which no edges cross or end, so that its free parts
are trapezoids. Arrays: ``edges`` float64 (E, 4): east0, north0, east1, north1 of a polygon's rings, turned so
that sweeps run along the first axis; ``borders`` float64 (K + 1,), ascending. Intervals of column k are rows
``offsets[k]:offsets[k + 1]`` of float64 (I, 2), lowest and highest ordinate, from below upwards. Sweeps are
float64 (N, 5): where the line flown begins and ends, its ordinate, the first and last column that it sees.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from planner.jit import njit

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Less than this is not left to be seen, metres.
LEAST_M = 1e-6


@njit(cache=True, nogil=True)
def wider(rows: Floats, used: int) -> Floats:
    """The same rows with room for more, where none is left."""
    if used < len(rows):
        return rows
    more = np.empty((2 * len(rows) + 16, rows.shape[1]))
    more[:used] = rows[:used]
    return more


@njit(cache=True, nogil=True)
def intervals(edges: Floats, borders: Floats) -> tuple[Floats, Floats, Ints]:
    """Of each column what is free anywhere in it, and what is free in its middle: as many intervals each."""
    columns = len(borders) - 1
    low = np.minimum(edges[:, 0], edges[:, 2])
    by_low = np.argsort(low)
    active = np.empty(len(edges), dtype=np.int64)
    crossing = np.empty((len(edges), 3))
    ground, middles = np.empty((256, 2)), np.empty((256, 2))
    offsets = np.zeros(columns + 1, dtype=np.int64)
    count, waiting, used = 0, 0, 0
    for k in range(columns):
        west, east = borders[k], borders[k + 1]
        middle = 0.5 * (west + east)
        while waiting < len(edges) and low[by_low[waiting]] <= middle:
            active[count] = by_low[waiting]
            count += 1
            waiting += 1
        kept = 0
        for i in range(count):
            e = active[i]
            if max(edges[e, 0], edges[e, 2]) <= middle:
                continue
            active[kept] = e
            slope = (edges[e, 3] - edges[e, 1]) / (edges[e, 2] - edges[e, 0])
            crossing[kept, 0] = edges[e, 1] + slope * (middle - edges[e, 0])
            crossing[kept, 1] = edges[e, 1] + slope * (west - edges[e, 0])
            crossing[kept, 2] = edges[e, 1] + slope * (east - edges[e, 0])
            kept += 1
        count = kept
        order = np.argsort(crossing[:count, 0])
        for i in range(0, count - 1, 2):
            below, above = crossing[order[i]], crossing[order[i + 1]]
            ground, middles = wider(ground, used), wider(middles, used)
            ground[used, 0], ground[used, 1] = min(below[1], below[2]), max(above[1], above[2])
            middles[used, 0], middles[used, 1] = below[0], above[0]
            used += 1
        offsets[k + 1] = used
    return ground[:used].copy(), middles[:used].copy(), offsets


@njit(cache=True, nogil=True)
def is_open(row: float, k: int, middles: Floats, offsets: Ints) -> bool:
    """Whether a column may be flown through at an ordinate."""
    for j in range(offsets[k], offsets[k + 1]):
        if middles[j, 0] - LEAST_M <= row <= middles[j, 1] + LEAST_M:
            return True
    return False


@njit(cache=True, nogil=True)
def _in_strip(row: float, half: float, k: int, ground: Floats, offsets: Ints) -> bool:
    """Whether a column has ground within a sweep's strip."""
    for j in range(offsets[k], offsets[k + 1]):
        if min(ground[j, 1], row + half) - max(ground[j, 0], row - half) > LEAST_M:
            return True
    return False


@njit(cache=True, nogil=True)
def flown(
    borders: Floats, first: int, last: int, west: float, east: float, along: float
) -> tuple[float, float]:
    """Where a line begins and ends, between two abscissas, that sees columns ``along`` wide at once."""
    begin, end = borders[first] + 0.5 * along, borders[last + 1] - 0.5 * along
    if begin > end:
        begin = end = 0.5 * (begin + end)
    return min(max(begin, west), east), min(max(end, west), east)


@njit(cache=True, nogil=True)
def level_sweeps(
    ground: Floats,
    offsets: Ints,
    middles: Floats,
    ways: Ints,
    borders: Floats,
    across: float,
    along: float,
    lowest: float,
) -> Floats:
    """Sweeps at ordinates a footprint apart, from the lowest up, wherever they see ground."""
    columns = len(borders) - 1
    half = 0.5 * across
    top = -np.inf
    for j in range(len(ground)):
        top = max(top, ground[j, 1])
    found = np.empty((256, 5))
    used = 0
    row = lowest
    while row - half < top - LEAST_M:
        k = 0
        while k < columns:
            if not is_open(row, k, middles, ways):
                k += 1
                continue
            begin = k
            while k < columns and is_open(row, k, middles, ways):
                k += 1
            first, last = begin, k - 1
            west, east = borders[first], borders[k]
            # a frame sees beyond the line's ends, where the way is barred
            while (
                first > 0
                and west - borders[first - 1] <= 0.5 * along
                and not is_open(row, first - 1, middles, ways)
            ):
                if not _in_strip(row, half, first - 1, ground, offsets):
                    break
                first -= 1
            while (
                last < columns - 1
                and borders[last + 2] - east <= 0.5 * along
                and not is_open(row, last + 1, middles, ways)
            ):
                if not _in_strip(row, half, last + 1, ground, offsets):
                    break
                last += 1
            while first <= last and not _in_strip(row, half, first, ground, offsets):
                first += 1
            while last >= first and not _in_strip(row, half, last, ground, offsets):
                last -= 1
            if first > last:
                continue
            found = wider(found, used)
            found[used, 0], found[used, 1] = flown(borders, first, last, west, east, along)
            found[used, 2], found[used, 3], found[used, 4] = row, first, last
            used += 1
        row += across
    return found[:used].copy()


@njit(cache=True, nogil=True)
def left_over(ground: Floats, offsets: Ints, sweeps: Floats, across: float) -> tuple[Floats, Ints]:
    """Intervals that sweeps leave unseen. Sweeps of one column come from below upwards."""
    columns = len(offsets) - 1
    counts = np.zeros(columns + 1, dtype=np.int64)
    for s in range(len(sweeps)):
        for k in range(int(sweeps[s, 3]), int(sweeps[s, 4]) + 1):
            counts[k + 1] += 1
    begins = np.cumsum(counts)
    filled = begins[:-1].copy()
    rows = np.empty(begins[columns])
    for s in range(len(sweeps)):
        for k in range(int(sweeps[s, 3]), int(sweeps[s, 4]) + 1):
            rows[filled[k]] = sweeps[s, 2]
            filled[k] += 1
    left = np.empty((256, 2))
    left_offsets = np.zeros(columns + 1, dtype=np.int64)
    used = 0
    half = 0.5 * across
    for k in range(columns):
        for j in range(offsets[k], offsets[k + 1]):
            low, high = ground[j, 0], ground[j, 1]
            for r in range(begins[k], begins[k + 1]):
                if rows[r] + half <= low:
                    continue
                if rows[r] - half >= high:
                    break
                if rows[r] - half > low + LEAST_M:
                    left = wider(left, used)
                    left[used, 0], left[used, 1] = low, rows[r] - half
                    used += 1
                low = max(low, rows[r] + half)
            if high > low + LEAST_M:
                left = wider(left, used)
                left[used, 0], left[used, 1] = low, high
                used += 1
        left_offsets[k + 1] = used
    return left[:used].copy(), left_offsets
