"""Compiled pieces of level lines within polygons.

``edges`` float64 (E, 4): east0, north0, east1, north1 of all rings.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from planner.jit import njit

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@njit(cache=True, nogil=True)
def level_pieces(edges: Floats, heights: Floats, least_m: float) -> tuple[Floats, Ints]:
    """Where lines at these ordinates are inside, even-odd: west and east ends (K, 2), and of which line (K,).

    An edge counts from its lower end up to, and without, its upper one, so that a line through a corner is
    inside as one just above it is.
    """
    room = 4 * len(heights) + 16
    ends = np.empty((room, 2))
    owners = np.empty(room, dtype=np.int64)
    crossings = np.empty(len(edges))
    used = 0
    for k in range(len(heights)):
        height = heights[k]
        count = 0
        for e in range(len(edges)):
            low, high = edges[e, 1], edges[e, 3]
            if (low <= height) == (high <= height):
                continue
            crossings[count] = edges[e, 0] + (edges[e, 2] - edges[e, 0]) * (height - low) / (high - low)
            count += 1
        ordered = np.sort(crossings[:count])
        for i in range(0, count - 1, 2):
            if ordered[i + 1] - ordered[i] <= least_m:
                continue
            if used == room:
                room *= 2
                more_ends, more_owners = np.empty((room, 2)), np.empty(room, dtype=np.int64)
                more_ends[:used], more_owners[:used] = ends, owners
                ends, owners = more_ends, more_owners
            ends[used, 0], ends[used, 1] = ordered[i], ordered[i + 1]
            owners[used] = k
            used += 1
    return ends[:used].copy(), owners[:used].copy()


@njit(cache=True, nogil=True)
def clip_rows(edges: Floats, rows: Floats, ahead_m: float, least_m: float) -> tuple[Floats, Floats]:
    """The parts of level lines that are inside, and where those see less than the whole lines would.

    ``rows`` float64 (N, 3): west end, east end, ordinate. Parts are as these, each about as long as
    ``least_m``, a line of less being made so long; what is not seen any more, ``ahead_m`` beyond ends.
    """
    parts, lost = np.empty((len(rows) + 16, 3)), np.empty((16, 3))
    used, gone = 0, 0
    crossings = np.empty(len(edges))
    for k in range(len(rows)):
        west, east, height = rows[k, 0], rows[k, 1], rows[k, 2]
        if east - west < least_m:
            middle = 0.5 * (west + east)
            west, east = middle - 0.5 * least_m, middle + 0.5 * least_m
        count = 0
        for e in range(len(edges)):
            low, high = edges[e, 1], edges[e, 3]
            if (low <= height) == (high <= height):
                continue
            crossings[count] = edges[e, 0] + (edges[e, 2] - edges[e, 0]) * (height - low) / (high - low)
            count += 1
        ordered = np.sort(crossings[:count])
        reached = west - ahead_m
        for i in range(0, count - 1, 2):
            begin, end = max(ordered[i], west), min(ordered[i + 1], east)
            if end - begin < 0.5 * least_m:
                continue
            if begin - ahead_m > reached:
                lost = _room(lost, gone)
                lost[gone, 0], lost[gone, 1], lost[gone, 2] = reached, begin - ahead_m, height
                gone += 1
            reached = max(reached, end + ahead_m)
            parts = _room(parts, used)
            parts[used, 0], parts[used, 1], parts[used, 2] = begin, end, height
            used += 1
        if reached < east + ahead_m:
            lost = _room(lost, gone)
            lost[gone, 0], lost[gone, 1], lost[gone, 2] = reached, east + ahead_m, height
            gone += 1
    return parts[:used].copy(), lost[:gone].copy()


@njit(cache=True, nogil=True)
def _room(rows: Floats, used: int) -> Floats:
    """The same rows with room for one more at least."""
    if used < len(rows):
        return rows
    more = np.empty((2 * len(rows) + 16, rows.shape[1]))
    more[:used] = rows[:used]
    return more
