"""Compiled search for a shorter order of parallel lanes between a first and a last one that stay.

A lane n has two states, 2n and 2n + 1: flown onward and back. Turns are (S, S), from a state to another;
inf where there is none.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from planner.jit import njit

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: So many lanes in a row are moved elsewhere at most.
LONGEST_MOVED = 4
#: Where runs are cut, one time after the other: powers of the root of x⁴ = x + 1, whose multiples fill a cube
#: evenly (Roberts 2018).
_EVENLY = (0.8191725133961645, 0.6710436067037893, 0.5497004779019703)
#: Nothing is changed for less than this, metres.
LEAST_GAIN_M = 1e-6


@njit(cache=True)
def order_m(order: Ints, turns: Floats, own_m: Floats) -> float:
    """What lanes in an order cost."""
    total: float = own_m[order[0]]
    for k in range(1, len(order)):
        total += turns[order[k - 1], order[k]] + own_m[order[k]]
    return total


@njit(cache=True)
def _sums(order: Ints, turns: Floats, own_m: Floats, onward: Floats, back: Floats) -> None:
    """Costs up to each place, its lane included, flown as it is, and all the other way."""
    onward[0], back[0] = own_m[order[0]], own_m[order[0] ^ 1]
    for k in range(1, len(order)):
        onward[k] = onward[k - 1] + turns[order[k - 1], order[k]] + own_m[order[k]]
        back[k] = back[k - 1] + turns[order[k] ^ 1, order[k - 1] ^ 1] + own_m[order[k] ^ 1]


@njit(cache=True)
def _turned(order: Ints, first: int, last: int) -> None:
    """The lanes from one place to another flown the other way."""
    while first < last:
        order[first], order[last] = order[last] ^ 1, order[first] ^ 1
        first, last = first + 1, last - 1
    if first == last:
        order[first] ^= 1


@njit(cache=True)
def _moved(order: Ints, first: int, count: int, behind: int, back: bool) -> None:
    """Some lanes in a row put behind the lane at another place, which is none of them."""
    part = order[first : first + count].copy()
    if back:
        _turned(part, 0, count - 1)
    if behind > first:
        order[first : behind + 1 - count] = order[first + count : behind + 1].copy()
        order[behind + 1 - count : behind + 1] = part
    else:
        order[behind + 1 + count : first + count] = order[behind + 1 : first].copy()
        order[behind + 1 : behind + 1 + count] = part


@njit(cache=True)
def _settled(order: Ints, turns: Floats, own_m: Floats) -> None:
    """An order that neither turning some lanes in a row round nor moving a few elsewhere makes shorter."""
    lanes = len(order)
    onward, back = np.empty(lanes), np.empty(lanes)
    while True:
        _sums(order, turns, own_m, onward, back)
        gain, kind, at, until, to, flipped = LEAST_GAIN_M, 0, 0, 0, 0, False
        for i in range(1, lanes - 1):
            for j in range(i, lanes - 1):
                before = turns[order[i - 1], order[i]] + turns[order[j], order[j + 1]]
                after = turns[order[i - 1], order[j] ^ 1] + turns[order[i] ^ 1, order[j + 1]]
                inner = onward[j] - onward[i] + own_m[order[i]]
                other = back[j] - back[i] + own_m[order[i] ^ 1]
                if before + inner - after - other > gain:
                    gain, kind, at, until = before + inner - after - other, 1, i, j
        for count in range(1, min(LONGEST_MOVED, lanes - 3) + 1):
            for i in range(1, lanes - count):
                j = i + count - 1
                inner = onward[j] - onward[i] + own_m[order[i]]
                other = back[j] - back[i] + own_m[order[i] ^ 1]
                saved = turns[order[i - 1], order[i]] + turns[order[j], order[j + 1]]
                saved -= turns[order[i - 1], order[j + 1]]
                for k in range(lanes - 1):
                    if i - 1 <= k <= j:
                        continue
                    here, there = order[k], order[k + 1]
                    open_m = saved + turns[here, there]
                    same = open_m - turns[here, order[i]] - turns[order[j], there]
                    turned = open_m + inner - other - turns[here, order[j] ^ 1] - turns[order[i] ^ 1, there]
                    if same > gain:
                        gain, kind, at, until, to, flipped = same, 2, i, count, k, False
                    if turned > gain:
                        gain, kind, at, until, to, flipped = turned, 2, i, count, k, True
        if kind == 0:
            return
        if kind == 1:
            _turned(order, at, until)
        else:
            _moved(order, at, until, to, flipped)


@njit(cache=True)
def reordered(order: Ints, turns: Floats, own_m: Floats, rounds: int) -> Ints:
    """An order no longer than the given one, with the same first and last lane in the same states.

    Local search, shaken ``rounds`` times by exchanging two runs of lanes (a double bridge: Martin, Otto and
    Felten 1991), at places that fill all there are evenly.
    """
    lanes = len(order)
    best = order.copy()
    if lanes < 4:
        return best
    _settled(best, turns, own_m)
    best_m = order_m(best, turns, own_m)
    cuts = np.empty(3, dtype=np.int64)
    for shaken in range(rounds):
        for k in range(3):
            cuts[k] = 1 + int((0.5 + shaken * _EVENLY[k]) % 1.0 * (lanes - 1))
        cuts.sort()
        a, b, c = cuts
        if a == b or b == c:
            continue
        tried = np.concatenate((best[:a], best[b:c], best[a:b], best[c:]))
        if not order_m(tried, turns, own_m) < np.inf:
            continue
        _settled(tried, turns, own_m)
        cost_m = order_m(tried, turns, own_m)
        if cost_m < best_m - LEAST_GAIN_M:
            best, best_m = tried, cost_m
    return best
