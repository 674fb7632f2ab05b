"""Compiled sweeps that see all that is to be seen, from below upwards. Arrays as in ``columns_kernels``.

``ground`` with ``offsets`` is to be seen; ``middles`` with ``ways`` is where columns may be flown through.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from planner.coverage.urban.columns_kernels import LEAST_M, flown, is_open, wider
from planner.jit import njit

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@njit(cache=True, nogil=True)
def _worth(
    row: float, k: int, at: Ints, unseen: Floats, ground: Floats, offsets: Ints, across: float
) -> float:
    """What a sweep at an ordinate sees of a column beyond what it has to for the column to need one less.

    Negative where the column would need as many without it; -inf where nothing is to be seen, inf where
    nothing of the interval is left then.
    """
    i = at[k]
    if i >= offsets[k + 1] or unseen[k] > row + 0.5 * across - LEAST_M:
        return -np.inf
    top = row + 0.5 * across
    if top >= ground[i, 1] - LEAST_M:
        return np.inf
    left = ground[i, 1] - unseen[k]
    spare = math.ceil((left - LEAST_M) / across) * across - left
    worth: float = (top - unseen[k]) - (across - spare)
    return worth


@njit(cache=True, nogil=True)
def _see(k: int, upto: float, at: Ints, unseen: Floats, ground: Floats, offsets: Ints) -> None:
    """Mark what lies below an ordinate as seen."""
    while at[k] < offsets[k + 1]:
        i = at[k]
        unseen[k] = max(ground[i, 0], upto)
        if unseen[k] < ground[i, 1] - LEAST_M:
            return
        at[k] += 1
    unseen[k] = np.inf


@njit(cache=True, nogil=True)
def _row(low: float, k: int, across: float, middles: Floats, ways: Ints) -> float:
    """The highest ordinate that a column may be flown through at and that sees from a height on."""
    best = -np.inf
    for j in range(ways[k], ways[k + 1]):
        row = min(low + 0.5 * across, middles[j, 1])
        if row >= middles[j, 0] and row > best:
            best = row
    return best if best + 0.5 * across > low + LEAST_M else low


@njit(cache=True, nogil=True)
def frontier_sweeps(
    ground: Floats,
    offsets: Ints,
    middles: Floats,
    ways: Ints,
    borders: Floats,
    across: float,
    along: float,
    gap_m: float,
    bent_m: float,
    each_m: float,
    most_m: float,
) -> Floats:
    """Sweeps that see all ground; not all of them where they cost more than ``most_m``, each ``each_m`` more.

    Always the lowest ground unseen yet comes next: the sweep lies as high as may be to see it, and goes on
    to both sides as long as columns may be flown through and need it less ``bent_m``, or do so again within
    ``gap_m``.
    """
    columns = len(borders) - 1
    half = 0.5 * across
    at = offsets[:-1].copy()
    unseen = np.empty(columns)
    for k in range(columns):
        unseen[k] = ground[at[k], 0] if at[k] < offsets[k + 1] else np.inf
    found = np.empty((256, 5))
    used = 0
    cost = 0.0
    while columns > 0 and cost <= most_m:
        seed = int(np.argmin(unseen))
        low = unseen[seed]
        if low == np.inf:
            break
        row = _row(low, seed, across, middles, ways)
        first, last = seed, seed
        for ahead in (-1, 1):
            k = seed + ahead
            while 0 <= k < columns and is_open(row, k, middles, ways) and unseen[k] >= row - half - LEAST_M:
                apart = borders[k] - borders[last + 1] if ahead > 0 else borders[first] - borders[k + 1]
                if apart > gap_m:
                    break
                if _worth(row, k, at, unseen, ground, offsets, across) >= -bent_m - LEAST_M:
                    if ahead > 0:
                        last = k
                    else:
                        first = k
                k += ahead
        west, east = borders[first], borders[last + 1]
        # a frame sees beyond the line's ends, where the way is barred
        while last < columns - 1 and borders[last + 2] - east <= 0.5 * along:
            k = last + 1
            if is_open(row, k, middles, ways) or not row - half - LEAST_M <= unseen[k] < row + half:
                break
            last = k
        while first > 0 and west - borders[first - 1] <= 0.5 * along:
            k = first - 1
            if is_open(row, k, middles, ways) or not row - half - LEAST_M <= unseen[k] < row + half:
                break
            first = k
        found = wider(found, used)
        found[used, 0], found[used, 1] = flown(borders, first, last, west, east, along)
        found[used, 2], found[used, 3], found[used, 4] = row, first, last
        cost += found[used, 1] - found[used, 0] + each_m
        used += 1
        for k in range(first, last + 1):
            if unseen[k] >= row - half - LEAST_M:
                _see(k, row + half, at, unseen, ground, offsets)
    return found[:used].copy()
