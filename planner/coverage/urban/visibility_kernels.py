"""Compiled ways among obstacles: what sees what, and shortest lines round corners.

Arrays: ``edges`` float64 (E, 4), east0, north0, east1, north1, of the rings not to be crossed; ``corners``
float64 (N, 2). The graph of corners that see each other is in rows: neighbours of corner i are
``towards[starts[i]:starts[i + 1]]`` at ``lengths`` of the same places.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]


@njit(cache=True, nogil=True)
def crosses(edges: Floats, e0: float, n0: float, e1: float, n1: float) -> bool:
    """Whether a straight line meets an edge."""
    west, east = min(e0, e1), max(e0, e1)
    south, north = min(n0, n1), max(n0, n1)
    de, dn = e1 - e0, n1 - n0
    for k in range(len(edges)):
        a, b, c, d = edges[k, 0], edges[k, 1], edges[k, 2], edges[k, 3]
        if max(a, c) < west or min(a, c) > east or max(b, d) < south or min(b, d) > north:
            continue
        first = de * (b - n0) - dn * (a - e0)
        second = de * (d - n0) - dn * (c - e0)
        if (first > 0.0 and second > 0.0) or (first < 0.0 and second < 0.0):
            continue
        fe, fn = c - a, d - b
        third = fe * (n0 - b) - fn * (e0 - a)
        fourth = fe * (n1 - b) - fn * (e1 - a)
        if (third > 0.0 and fourth > 0.0) or (third < 0.0 and fourth < 0.0):
            continue
        return True
    return False


@njit(cache=True, nogil=True)
def straight(edges: Floats, starts: Floats, ends: Floats) -> Flags:
    """Of pairs of places, (M, 2) each, which see each other, (M,)."""
    seen = np.empty(len(starts), dtype=np.bool_)
    for m in range(len(starts)):
        seen[m] = not crosses(edges, starts[m, 0], starts[m, 1], ends[m, 0], ends[m, 1])
    return seen


@njit(cache=True, nogil=True)
def corner_graph(edges: Floats, corners: Floats) -> tuple[Ints, Ints, Floats]:
    """The graph of corners that see each other: starts (N + 1,), towards, lengths."""
    count = len(corners)
    seen = np.zeros((count, count), dtype=np.bool_)
    for i in range(count):
        for j in range(i + 1, count):
            if not crosses(edges, corners[i, 0], corners[i, 1], corners[j, 0], corners[j, 1]):
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
def ways_from(
    edges: Floats,
    corners: Floats,
    starts: Ints,
    towards: Ints,
    lengths: Floats,
    east_m: float,
    north_m: float,
) -> tuple[Floats, Ints]:
    """Shortest lengths from a place to all corners, (N,), and the corner before each, -1 for the place."""
    count = len(corners)
    best = np.full(count, np.inf)
    before = np.full(count, -1, dtype=np.int64)
    done = np.zeros(count, dtype=np.bool_)
    for i in range(count):
        if not crosses(edges, east_m, north_m, corners[i, 0], corners[i, 1]):
            best[i] = math.hypot(corners[i, 0] - east_m, corners[i, 1] - north_m)
    for _ in range(count):
        nearest, least = -1, np.inf
        for i in range(count):
            if not done[i] and best[i] < least:
                nearest, least = i, best[i]
        if nearest < 0:
            break
        done[nearest] = True
        for at in range(starts[nearest], starts[nearest + 1]):
            j = towards[at]
            if best[nearest] + lengths[at] < best[j] - 1e-12:
                best[j] = best[nearest] + lengths[at]
                before[j] = nearest
    return best, before


@njit(cache=True, nogil=True)
def way_lengths(
    edges: Floats,
    corners: Floats,
    starts: Ints,
    towards: Ints,
    lengths: Floats,
    origins: Floats,
    goals: Floats,
) -> Floats:
    """Shortest lengths from each origin (M, 2) to each goal (K, 2), (M, K); inf where there is no way."""
    count = len(corners)
    reach = np.full((len(goals), count), np.inf)
    for g in range(len(goals)):
        for i in range(count):
            if not crosses(edges, goals[g, 0], goals[g, 1], corners[i, 0], corners[i, 1]):
                reach[g, i] = math.hypot(corners[i, 0] - goals[g, 0], corners[i, 1] - goals[g, 1])
    out = np.full((len(origins), len(goals)), np.inf)
    for m in range(len(origins)):
        e, n = origins[m, 0], origins[m, 1]
        known, _ = ways_from(edges, corners, starts, towards, lengths, e, n)
        for g in range(len(goals)):
            if not crosses(edges, e, n, goals[g, 0], goals[g, 1]):
                out[m, g] = math.hypot(goals[g, 0] - e, goals[g, 1] - n)
                continue
            for i in range(count):
                length = known[i] + reach[g, i]
                if length < out[m, g]:
                    out[m, g] = length
    return out
