"""Compiled search for the shortest tour that flies each of many lines once, either way.

Line k has the ends 2 k and 2 k + 1. A tour is an order of ends, int64 (2 N,), in which both of a line lie
side by side, the first at an even place; from an odd place to the next, and from the last to the first,
leads a *join*. Costs of joins are float64 (2 N, 2 N), symmetric. Moves are 2-opt and Or-opt over
neighbours, so that lines keep whole; what they cannot better is shaken by the exchange of two neighbouring
runs (the double bridge of O. Martin, S. W. Otto and E. W. Felten, "Large-step Markov chains for the
traveling salesman problem", Complex Systems 5, 1991) and kept where it came out no longer.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from planner.jit import njit

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: A change must shorten the tour by more than rounding can, or the search might not end.
LEAST_GAIN = 1e-7
#: Longest run of lines that is moved, and longest that is exchanged.
MOVED = 3
EXCHANGED = 30


@njit(cache=True)
def neighbours(costs: Floats, most: int) -> Ints:
    """Of each end so many others of least cost, cheapest first, none of its own line, (2 N, M)."""
    count = len(costs)
    width = max(min(most, count - 2), 0)
    near = np.empty((count, width), dtype=np.int64)
    away = np.empty(width)
    for end in range(count):
        away[:] = np.inf
        for other in range(count):
            cost = costs[end, other]
            if width == 0 or other >> 1 == end >> 1 or cost >= away[width - 1]:
                continue
            at = width - 1
            while at > 0 and away[at - 1] > cost:
                away[at], near[end, at] = away[at - 1], near[end, at - 1]
                at -= 1
            away[at], near[end, at] = cost, other
        for at in range(width):
            if away[at] == np.inf:
                near[end, at] = near[end, 0] if away[0] < np.inf else (end ^ 2) % count
    return near


@njit(cache=True)
def nearest_first(costs: Floats, first: int) -> Ints:
    """The tour that goes from a line's second end to the nearest line not flown yet, each time."""
    count = len(costs)
    tour = np.empty(count, dtype=np.int64)
    left = np.ones(count, dtype=np.bool_)
    here = first
    for place in range(0, count, 2):
        tour[place], tour[place + 1] = here, here ^ 1
        left[here] = False
        left[here ^ 1] = False
        nearest, least = -1, np.inf
        for end in range(count):
            if left[end] and (costs[here ^ 1, end] < least or nearest < 0):
                nearest, least = end, costs[here ^ 1, end]
        here = nearest
    return tour


@njit(cache=True)
def tour_cost(costs: Floats, tour: Ints) -> float:
    """What the joins of a tour cost."""
    total = 0.0
    count = len(tour)
    for place in range(1, count, 2):
        total += costs[tour[place], tour[(place + 1) % count]]
    return total


@njit(cache=True)
def _reverse(tour: Ints, place: Ints, i: int, j: int) -> None:
    while i < j:
        a, b = tour[i], tour[j]
        tour[i], tour[j] = b, a
        place[b], place[a] = i, j
        i += 1
        j -= 1


@njit(cache=True)
def _joined(tour: Ints, at: int) -> int:
    """The end that a join leads to from a place."""
    count = len(tour)
    end: int = tour[(at + 1) % count] if at & 1 else tour[(at - 1) % count]
    return end


@njit(cache=True)
def _move(tour: Ints, place: Ints, i: int, j: int, q: int, turned: bool) -> None:
    """Put the run at places i to j behind place q, outside of it; turned round or not."""
    if q > j:
        length = j - i
        _reverse(tour, place, i, q)
        _reverse(tour, place, i, i + q - j - 1)
        if not turned:
            _reverse(tour, place, q - length, q)
    else:
        length = j - i
        _reverse(tour, place, q + 1, j)
        _reverse(tour, place, q + 2 + length, j)
        if not turned:
            _reverse(tour, place, q + 1, q + 1 + length)


@njit(cache=True)
def _better(a: int, costs: Floats, near: Ints, tour: Ints, place: Ints, touched: Ints) -> int:
    """Make the best move that joins an end to one of its neighbours; how many ends it touched, 0 for none."""
    count = len(tour)
    pa = place[a]
    b = _joined(tour, pa)
    old = costs[a, b]
    best = -LEAST_GAIN
    kind, bi, bj, bq = 0, 0, 0, 0
    for m in range(near.shape[1]):
        c = near[a, m]
        gain = costs[a, c] - old
        if gain >= -LEAST_GAIN:
            break
        pc = place[c]
        if (pa ^ pc) & 1 == 0:
            d = _joined(tour, pc)
            delta = gain + costs[b, d] - costs[c, d]
            if delta < best:
                best, kind = delta, 1
                if pa & 1:
                    bi, bj = min(pa, pc) + 1, max(pa, pc)
                else:
                    bi, bj = min(pa, pc), max(pa, pc) - 1
        # A run of lines that begins with c is put between a and b.
        if c >> 1 == a >> 1:
            continue
        # place of the join between a and b, named by the place before it
        q = pa if pa & 1 else (pa - 1) % count
        for lines in range(1, MOVED + 1):
            if pc & 1:
                i, j = pc - 2 * lines + 1, pc
            else:
                i, j = pc, pc + 2 * lines - 1
            if i < 0 or j >= count:
                break
            if i <= pa <= j or i - 1 == q or j == q or (q == count - 1 and i == 0):
                break
            e = tour[i] if pc & 1 else tour[j]
            before, behind = tour[(i - 1) % count], tour[(j + 1) % count]
            delta = gain + costs[e, b] + costs[before, behind]
            delta -= costs[before, tour[i]] + costs[tour[j], behind]
            if delta < best:
                best, bi, bj, bq = delta, i, j, q
                # a at an odd place is left for c: the run is turned where c is its last end
                kind = 3 if (pa & 1) == (pc & 1) else 2
    if kind == 0:
        return 0
    if kind == 1:
        touched[0], touched[1] = tour[(bi - 1) % count], tour[bi]
        touched[2], touched[3] = tour[bj], tour[(bj + 1) % count]
        _reverse(tour, place, bi, bj)
        return 4
    touched[0], touched[1] = tour[(bi - 1) % count], tour[bi]
    touched[2], touched[3] = tour[bj], tour[(bj + 1) % count]
    touched[4], touched[5] = a, b
    _move(tour, place, bi, bj, bq, kind == 3)
    return 6


@njit(cache=True)
def _settle(
    costs: Floats, near: Ints, tour: Ints, place: Ints, waiting: Ints, listed: Ints, size: int
) -> None:
    """Better a tour until no end has a better move. ``waiting`` is a stack; ``listed`` marks its ends."""
    touched = np.empty(6, dtype=np.int64)
    while size > 0:
        size -= 1
        a = waiting[size]
        listed[a] = 0
        found = _better(a, costs, near, tour, place, touched)
        while found > 0:
            for k in range(found):
                end = touched[k]
                if listed[end] == 0:
                    listed[end] = 1
                    waiting[size] = end
                    size += 1
            found = _better(a, costs, near, tour, place, touched)


@njit(cache=True)
def shortest_tour(costs: Floats, near: Ints, tour: Ints, rounds: int, seed: int) -> Ints:
    """A tour no longer than the one given, after so many shakes.

    ``near`` is int64 (2 N, M): of each end other ends, nearest first, none of its own line.
    """
    count = len(tour)
    tour = tour.copy()
    place = np.empty(count, dtype=np.int64)
    for k in range(count):
        place[tour[k]] = k
    waiting = np.empty(count, dtype=np.int64)
    listed = np.zeros(count, dtype=np.int64)
    if count < 6:
        rounds = 0
    for k in range(count):
        waiting[k] = tour[count - 1 - k]
        listed[k] = 1
    _settle(costs, near, tour, place, waiting, listed, count)
    best = tour_cost(costs, tour)
    kept, kept_place = tour.copy(), place.copy()
    lines = count // 2
    state = np.uint64(seed * 2 + 1)
    draws = np.empty(3)
    for _ in range(rounds):
        for k in range(3):
            state = state * np.uint64(6364136223846793005) + np.uint64(1442695040888963407)
            draws[k] = np.float64(state >> np.uint64(11)) / 9007199254740992.0
        longest = min(EXCHANGED, (lines - 1) // 2)
        first = 1 + int(draws[0] * longest)
        second = 1 + int(draws[1] * longest)
        start = 2 * int(draws[2] * (lines - first - second + 1))
        i, j, q = start, start + 2 * first - 1, start + 2 * (first + second) - 1
        ends = (tour[i - 1], tour[i], tour[j], tour[j + 1], tour[q], tour[(q + 1) % count])
        _move(tour, place, i, j, q, False)
        size = 0
        for end in ends:
            if listed[end] == 0:
                listed[end] = 1
                waiting[size] = end
                size += 1
        _settle(costs, near, tour, place, waiting, listed, size)
        now = tour_cost(costs, tour)
        if now <= best + LEAST_GAIN:
            best = now
            kept[:] = tour
            kept_place[:] = place
        else:
            tour[:] = kept
            place[:] = kept_place
    return kept
