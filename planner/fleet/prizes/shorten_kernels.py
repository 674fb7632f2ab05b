"""Compiled shortening of a route among places by 2-opt and moves of up to three places. Numbers only."""

# mypy: allow-untyped-decorators

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from planner.jit import njit

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Ways that differ by no more than this are equal: the rest is rounding.
SLACK = 1e-9


@njit(cache=True, nogil=True)
def shorten(costs: Floats, near: Ints, order: Ints, size: int, place: Ints, symmetric: bool) -> float:
    """2-opt and moves of up to three places among near ones, until none helps; what was saved.

    ``order[:size]`` is the route from first to last, both fixed; ``place`` of each node on it, -1 outside.
    """
    saved = 0.0
    better = True
    while better:
        better = False
        for i in range(1, size - 1):
            here = order[i]
            moved = False
            most = max(costs[order[i - 1], here], costs[here, order[i + 1]])
            for k in range(near.shape[1]):
                there = near[here, k]
                if costs[here, there] >= most:
                    break
                j = place[there]
                if j < 0:
                    continue
                if symmetric:
                    gain, low, high = _cross(costs, order, size, i, j)
                    if gain > SLACK:
                        while low < high:
                            order[low], order[high] = order[high], order[low]
                            place[order[low]], place[order[high]] = low, high
                            low += 1
                            high -= 1
                        saved += gain
                        moved = True
                        break
                gain, long, flip, spot = _shift(costs, order, size, i, j, symmetric)
                if gain > SLACK:
                    _carry(order, place, i, long, flip, spot)
                    saved += gain
                    moved = True
                    break
            better = better or moved
    return saved


@njit(cache=True, nogil=True)
def _cross(costs: Floats, order: Ints, size: int, i: int, j: int) -> tuple[float, int, int]:
    """Gain of joining places i and j by turning round what lies between, and which stretch to turn."""
    best, low, high = 0.0, 0, 0
    if i + 1 < j < size - 1:
        a, b, c, d = order[i], order[i + 1], order[j], order[j + 1]
        gain = costs[a, b] + costs[c, d] - costs[a, c] - costs[b, d]
        if gain > best:
            best, low, high = gain, i + 1, j
    if j < i - 1:
        a, b, c, d = order[j], order[j + 1], order[i], order[i + 1]
        gain = costs[a, b] + costs[c, d] - costs[a, c] - costs[b, d]
        if gain > best:
            best, low, high = gain, j + 1, i
        if j > 0:
            a, b, c, d = order[j - 1], order[j], order[i - 1], order[i]
            gain = costs[a, b] + costs[c, d] - costs[a, c] - costs[b, d]
            if gain > best:
                best, low, high = gain, j, i - 1
    return best, low, high


@njit(cache=True, nogil=True)
def _shift(
    costs: Floats, order: Ints, size: int, i: int, j: int, symmetric: bool
) -> tuple[float, int, bool, int]:
    """Gain of moving up to three places from i on beside place j: how many, turned round, behind which."""
    best, most, turned, spot = 0.0, 0, False, 0
    for long in range(1, 4):
        end = i + long - 1
        if end >= size - 1:
            break
        if i <= j <= end:
            break
        a, b, c, d = order[i - 1], order[i], order[end], order[end + 1]
        out = costs[a, b] + costs[c, d] - costs[a, d]
        if out <= SLACK:
            continue
        for behind in (j - 1, j):
            if behind < 0 or behind >= size - 1 or i - 1 <= behind <= end:
                continue
            p, q = order[behind], order[behind + 1]
            gone = costs[p, q]
            gain = out - (costs[p, b] + costs[c, q] - gone)
            if gain > best:
                best, most, turned, spot = gain, long, False, behind
            if symmetric:
                gain = out - (costs[p, c] + costs[b, q] - gone)
                if gain > best:
                    best, most, turned, spot = gain, long, True, behind
    return best, most, turned, spot


@njit(cache=True, nogil=True)
def _carry(order: Ints, place: Ints, i: int, long: int, flip: bool, spot: int) -> None:
    """Move ``long`` places from i on to behind place ``spot``."""
    held = order[i : i + long].copy()
    if flip:
        held = held[::-1].copy()
    if spot > i:
        for k in range(i, spot - long + 1):
            order[k] = order[k + long]
            place[order[k]] = k
        first = spot - long + 1
    else:
        for k in range(i + long - 1, spot + long, -1):
            order[k] = order[k - long]
            place[order[k]] = k
        first = spot + 1
    for k in range(long):
        order[first + k] = held[k]
        place[held[k]] = first + k
