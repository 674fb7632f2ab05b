"""Compiled pieces of level lines within polygons.

``edges`` float64 (E, 4): east0, north0, east1, north1 of all rings.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

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
