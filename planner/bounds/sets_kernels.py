"""Compiled parts of the lower bound for whole regions: how far apart sets of ends are, and tours of them.

A set is a box in axes turned by a heading. Numbers only.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from planner.jit import njit

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Of a set of ends of passes: least and most ahead, least and most to the left, in axes turned by a heading.
LEAST_X, MOST_X, LEAST_Y, MOST_Y = range(4)


@njit(cache=True)
def corners_of(bounds: Floats, theta: float, out: Floats) -> None:
    """The corners of a set, (4, 2), of places east and north."""
    cos, sin = math.cos(theta), math.sin(theta)
    for k in range(4):
        x = bounds[MOST_X] if k in (1, 2) else bounds[LEAST_X]
        y = bounds[MOST_Y] if k >= 2 else bounds[LEAST_Y]
        out[k, 0], out[k, 1] = cos * x - sin * y, sin * x + cos * y


@njit(cache=True)
def _to_set(places: Floats, bounds: Floats, theta: float) -> tuple[float, float]:
    """Least distance from places to a set, and how far beyond one of its sides all of them lie."""
    cos, sin = math.cos(theta), math.sin(theta)
    nearest = np.inf
    low_x, high_x, low_y, high_y = np.inf, -np.inf, np.inf, -np.inf
    for k in range(places.shape[0]):
        x = cos * places[k, 0] + sin * places[k, 1]
        y = cos * places[k, 1] - sin * places[k, 0]
        low_x, high_x, low_y, high_y = min(low_x, x), max(high_x, x), min(low_y, y), max(high_y, y)
        dx = max(bounds[LEAST_X] - x, x - bounds[MOST_X], 0.0)
        dy = max(bounds[LEAST_Y] - y, y - bounds[MOST_Y], 0.0)
        nearest = min(nearest, math.hypot(dx, dy))
    beyond = max(low_x - bounds[MOST_X], bounds[LEAST_X] - high_x)
    beyond = max(beyond, low_y - bounds[MOST_Y], bounds[LEAST_Y] - high_y)
    return nearest, beyond


@njit(cache=True)
def between_sets(here: Floats, theta0: float, there: Floats, theta1: float) -> float:
    """Distance between two sets: 0 where neither lies beyond a side of the other, else at a corner of one."""
    places = np.empty((4, 2))
    corners_of(here, theta0, places)
    to, beyond = _to_set(places, there, theta1)
    corners_of(there, theta1, places)
    fro, other = _to_set(places, here, theta0)
    return min(to, fro) if max(beyond, other) > 0.0 else 0.0


@njit(cache=True)
def distances(sets: Floats, thetas: Floats, region: Ints) -> Floats:
    """From ends to beginnings of stays, (4·N, 4·N), inf within a region and where there are none.

    ``sets`` is (N, 4, L, 2, 4): cell, way and half, look, entry or exit.
    """
    count, looks = sets.shape[0], sets.shape[2]
    out = np.full((4 * count, 4 * count), np.inf)
    for i in range(count):
        for j in range(count):
            if region[i] == region[j]:
                continue
            for end in range(4):
                for begin in range(4):
                    least = np.inf
                    for a in range(looks):
                        here = sets[i, end, a, 1]
                        if here[LEAST_X] == np.inf:
                            continue
                        for b in range(looks):
                            there = sets[j, begin, b, 0]
                            if there[LEAST_X] < np.inf:
                                least = min(least, between_sets(here, thetas[i], there, thetas[j]))
                    out[4 * i + end, 4 * j + begin] = least
    return out


@njit(cache=True)
def from_place(place: Floats, sets: Floats, thetas: Floats, which: int) -> Floats:
    """Distance from a place to where stays begin (0) or end (1), (4·N,)."""
    out = np.full(4 * sets.shape[0], np.inf)
    places = place.reshape(1, 2)
    for i in range(sets.shape[0]):
        for way in range(4):
            for a in range(sets.shape[2]):
                bounds = sets[i, way, a, which]
                if bounds[LEAST_X] < np.inf:
                    out[4 * i + way] = min(out[4 * i + way], _to_set(places, bounds, thetas[i])[0])
    return out


@njit(cache=True)
def least_tour(first: Floats, between: Floats, last: Floats, stays: Floats, offsets: Ints) -> float:
    """Least over all orders of regions, one cell of each.

    Parameters
    ----------
    first, last
        From the start to where cells' stays begin, from where they end to the end, (4·N,).
    between
        From ends to beginnings, (4·N, 4·N).
    stays
        Cost of a stay by where it begins and ends, (N, 4, 4).
    offsets
        Where the cells of each region begin, int64 (R + 1,).
    """
    regions = len(offsets) - 1
    best = np.full((1 << regions, len(first)), np.inf)
    into = np.empty(len(first))
    for visited in range(1, 1 << regions):
        for c in range(regions):
            if not visited >> c & 1:
                continue
            before = visited ^ (1 << c)
            begin, end = 4 * offsets[c], 4 * offsets[c + 1]
            for j in range(begin, end):
                into[j] = first[j] if before == 0 else np.inf
            for b in range(regions):
                if not before >> b & 1:
                    continue
                for i in range(4 * offsets[b], 4 * offsets[b + 1]):
                    so_far = best[before, i]
                    if so_far < np.inf:
                        for j in range(begin, end):
                            into[j] = min(into[j], so_far + between[i, j])
            for k in range(offsets[c], offsets[c + 1]):
                for a in range(4):
                    for e in range(4):
                        cost = into[4 * k + a] + stays[k, a, e]
                        best[visited, 4 * k + e] = min(best[visited, 4 * k + e], cost)
    return float((best[-1] + last).min())
