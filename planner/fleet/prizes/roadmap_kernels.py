"""Compiled roadmap: which poses are joined by a line among polygons, and the shortest ways over it.

Poses of places come first, the same number of headings for each; poses at corners of polygons follow. A way
leads from a pose of a place over poses at corners to a pose of another place.
"""

# mypy: allow-untyped-decorators

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from planner.fleet.prizes.lines_kernels import shortest_clear, straight_clear
from planner.jit import njit
from planner.transit.kernels import pop, push

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

#: From corner to corner a way is taut: no longer than the straight by this factor and so many radii.
TAUT, TAUT_RADII = 1.1, 0.3
#: Any other line is longer than the straight by no more radii than the longest detour to a pose nearby.
DETOUR_RADII = 2.4 * math.pi


@njit(cache=True, nogil=True)
def sight(points: Floats, first: int, last: int, edges: Floats, offsets: Ints, boxes: Floats) -> Flags:
    """Which points see those of ``first`` to ``last``, (last - first, N)."""
    seen = np.zeros((last - first, len(points)), dtype=np.bool_)
    for i in range(first, last):
        for j in range(len(points)):
            if i != j:
                seen[i - first, j] = straight_clear(
                    points[i, 0], points[i, 1], points[j, 0], points[j, 1], edges, offsets, boxes
                )
    return seen


@njit(cache=True, nogil=True)
def links(
    poses: Floats,
    point_of: Ints,
    seen: Flags,
    places: int,
    first: int,
    last: int,
    radius: float,
    most: float,
    edges: Floats,
    offsets: Ints,
    boxes: Floats,
) -> tuple[Ints, Ints, Floats]:
    """Lines from the poses ``first`` to ``last``: starts of rows (last - first + 1,), poses, lengths.

    ``places`` is how many poses are of places.
    """
    count = len(poses)
    starts = np.zeros(last - first + 1, dtype=np.int64)
    to, lengths = np.empty(1024, dtype=np.int64), np.empty(1024)
    size = 0
    for i in range(first, last):
        for j in range(count):
            if not seen[point_of[i], point_of[j]]:
                continue
            de, dn = poses[j, 0] - poses[i, 0], poses[j, 1] - poses[i, 1]
            straight = math.hypot(de, dn)
            if straight >= most:
                continue
            longest = straight + DETOUR_RADII * radius
            if i >= places and j >= places:
                longest = TAUT * straight + TAUT_RADII * radius
                ahead_i = de * math.cos(poses[i, 2]) + dn * math.sin(poses[i, 2])
                ahead_j = de * math.cos(poses[j, 2]) + dn * math.sin(poses[j, 2])
                if straight > radius and (ahead_i < 0.7 * straight or ahead_j < 0.7 * straight):
                    continue
            _, length = shortest_clear(poses[i], poses[j], radius, min(longest, most), edges, offsets, boxes)
            if length < np.inf:
                if size == len(to):
                    more = np.empty(size, dtype=np.int64)
                    to = np.concatenate((to, more))
                    lengths = np.concatenate((lengths, np.empty(size)))
                to[size], lengths[size] = j, length
                size += 1
        starts[i - first + 1] = size
    return starts, to[:size].copy(), lengths[:size].copy()


@njit(cache=True, nogil=True)
def ways(
    starts: Ints, to: Ints, lengths: Floats, places: int, first: int, last: int, most: float
) -> tuple[Floats, Ints]:
    """Shortest ways from the poses ``first`` to ``last`` of places to all, over corners alone (Dijkstra).

    Lengths, inf where there is none, and the pose before each, -1 where there is none: (last - first, N).
    """
    count = len(starts) - 1
    found = np.full((last - first, count), np.inf)
    before = np.full((last - first, count), -1)
    keys, items = np.empty(len(to) + 1), np.empty(len(to) + 1, dtype=np.int64)
    for i in range(first, last):
        row, back = found[i - first], before[i - first]
        done = np.zeros(count, dtype=np.bool_)
        size = 0
        at, flown = i, 0.0
        while True:
            for k in range(starts[at], starts[at + 1]):
                j = to[k]
                length = flown + lengths[k]
                if length < row[j] and length < most:
                    row[j] = length
                    back[j] = at
                    if j >= places:
                        size = push(keys, items, size, length, j)
            while size > 0 and done[items[0]]:
                _, size = pop(keys, items, size)
            if size == 0:
                break
            at, size = pop(keys, items, size)
            done[at] = True
            flown = row[at]
    return found, before
