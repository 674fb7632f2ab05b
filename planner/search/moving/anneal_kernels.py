"""Compiled annealing of the strips of flights: steps that find more, or a little less at first."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from planner.jit import njit
from planner.search.chance_kernels import drawn
from planner.search.moving.move_kernels import moved, put_best, taken_out
from planner.search.moving.strip_kernels import (
    COLUMNS,
    LEAST_PASS_M,
    clear,
    cost_m,
    leg_m,
    look,
    passed,
    reach_of,
)

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Looks = NDArray[np.signedinteger[Any]]
State = NDArray[np.uint64]

#: A flight over its budget is made shorter in so many steps at most, each by so much more than it lacks.
SHORTENED, OVER = 4, 1.02
#: Of several flights a strip is given to another in this part of the steps.
GIVEN = 0.06


@njit(cache=True, nogil=True)
def _same(one: Floats, other: Floats) -> bool:
    return bool(
        one[0, 0] == other[0, 0] and one[0, 1] == other[0, 1] and one[1, 0] == other[1, 0]
        and one[1, 1] == other[1, 1]
    )  # fmt: skip


@njit(cache=True, nogil=True)
def _follow(
    strips: Floats,
    count: int,
    rows: Floats,
    old: Floats,
    had: int,
    old_rows: Floats,
    flight: Floats,
    table: Floats,
    free: Floats,
    turning: Floats,
    legs: Floats,
    old_legs: Floats,
) -> bool:
    """Passes of strips and legs between, of those there before as they were; False where one is not flown."""
    last = -1
    for k in range(count):
        back = k - count + had
        came = -2
        if k < had and _same(strips[k], old[k]):
            rows[k] = old_rows[k]
            came = k
        elif 0 <= back < had and _same(strips[k], old[back]):
            rows[k] = old_rows[back]
            came = back
        elif not passed(strips[k], table, flight[5], rows[k]) or not clear(
            rows[k], flight[5], flight[4], free, turning
        ):
            return False
        # A leg is as it was where both its passes are, one behind the other.
        legs[k] = old_legs[came] if came >= 0 and last == came - 1 else leg_m(rows, k - 1, k, flight, table)
        last = came
    if count and last == had - 1:
        legs[count] = old_legs[had]
    else:
        legs[count] = leg_m(rows, count - 1, -1, flight, table)
    return True


@njit(cache=True, nogil=True)
def _cost_m(rows: Floats, count: int, legs: Floats) -> float:
    """Metres through the air of a flight whose legs are known: before each pass, and to the end."""
    total_m = float(legs[count])
    for k in range(count):
        total_m += rows[k, 11] + legs[k]
    return float(total_m)


@njit(cache=True, nogil=True)
def _legs_about(rows: Floats, count: int, k: int, legs: Floats, flight: Floats, table: Floats) -> None:
    """Reckon anew the legs to the k-th of so many passes, or to the end, and from it."""
    legs[k] = leg_m(rows, k - 1, k if k < count else -1, flight, table)
    if k < count:
        legs[k + 1] = leg_m(rows, k, k + 1 if k + 1 < count else -1, flight, table)


@njit(cache=True, nogil=True)
def _within(
    strips: Floats,
    count: int,
    rows: Floats,
    flight: Floats,
    table: Floats,
    free: Floats,
    turning: Floats,
    state: State,
    legs: Floats,
) -> tuple[int, float]:
    """A flight made as short as its budget, at ends drawn by chance: its strips then, and its cost.

    The cost is inf where that does not come about.
    """
    total_m = _cost_m(rows, count, legs)
    for _ in range(SHORTENED):
        if total_m <= flight[7]:
            return count, total_m
        if count == 0:
            break
        k = int(drawn(state) * count)
        e, n = strips[k, 1, 0] - strips[k, 0, 0], strips[k, 1, 1] - strips[k, 0, 1]
        length_m = math.sqrt(e * e + n * n)
        pass_m = math.hypot(rows[k, 8] - rows[k, 0], rows[k, 9] - rows[k, 1])
        off_m = OVER * (total_m - flight[7]) * (pass_m + flight[5]) / max(rows[k, 11], 1e-9)
        if length_m - off_m < LEAST_PASS_M:
            count = taken_out(strips, count, k)
            for i in range(k, count):
                rows[i], legs[i + 1] = rows[i + 1], legs[i + 2]
        else:
            end = int(2.0 * drawn(state))
            sign = 1.0 - 2.0 * end
            strips[k, end, 0] += sign * off_m * e / length_m
            strips[k, end, 1] += sign * off_m * n / length_m
            if not passed(strips[k], table, flight[5], rows[k]) or not clear(
                rows[k], flight[5], flight[4], free, turning
            ):
                return count, np.inf
        _legs_about(rows, count, k, legs, flight, table)
        total_m = _cost_m(rows, count, legs)
    return count, total_m if total_m <= flight[7] else np.inf


@njit(cache=True, nogil=True)
def _changed(
    looks: Looks,
    scores: Floats,
    pays: Floats,
    corner: Floats,
    strips: Floats,
    count: int,
    rows: Floats,
    other: Floats,
    many: int,
    by: int,
    reach: Ints,
) -> float:
    """The worth of looks of those strips, added or taken away, that are not the same among the others.

    ``reach`` is widened to the cells looked at.
    """
    gained = 0.0
    for k in range(count):
        back = k - count + many
        if (k < many and _same(strips[k], other[k])) or (0 <= back < many and _same(strips[k], other[back])):
            continue
        gained += look(looks, scores, pays, corner[0], corner[1], corner[2], rows[k], by)
        reach_of(rows[k], corner, scores.shape[0], scores.shape[1], reach)
    return gained


@njit(cache=True, nogil=True)
def _copy(source: Looks, target: Looks, reach: Ints) -> None:
    """The cells of a range as they are elsewhere."""
    for i in range(reach[0], reach[1]):
        target[i, reach[2] : reach[3]] = source[i, reach[2] : reach[3]]


@njit(cache=True, nogil=True)
def annealed(
    scores: Floats,
    pays: Floats,
    corner: Floats,
    tables: Floats,
    flights: Floats,
    widths_m: Floats,
    free: Floats,
    free_ends: Ints,
    turning: Floats,
    turning_ends: Ints,
    strips: Floats,
    counts: Ints,
    best: Floats,
    best_counts: Ints,
    figures: Floats,
    state: State,
    first: int,
    last: int,
    total: int,
    heat: float,
    price: float,
) -> None:
    """Steps ``first`` to ``last`` of ``total`` from the strips of flights, (F, K, 2, 2), changed in place.

    Parameters
    ----------
    scores, pays, corner
        Worth of cells by square metre, what each look finds of it, and west, south and a cell's edge.
    tables, flights, widths_m
        Of each flight: swaths by course (T, 5), what it is (8,), how wide it sees.
    free, free_ends, turning, turning_ends
        Edges (N, 4) of where passes and turns may be, of each flight up to its number of edges.
    best, best_counts, figures
        The best found so far, its goodness and its worth; kept between calls, goodness -inf at first.
    heat, price
        What a step may lose at first, and what a metre costs, in worth.
    """
    many, most = strips.shape[0], strips.shape[1]
    looks = np.zeros(scores.shape, dtype=np.int32)
    rows = np.empty((many, most, COLUMNS))
    costs_m, legs = np.empty(many), np.empty((many, most + 1))
    worth = 0.0
    for f in range(many):
        count = 0
        for k in range(counts[f]):
            if passed(strips[f, k], tables[f], flights[f, 5], rows[f, count]):
                strips[f, count] = strips[f, k]
                worth += look(looks, scores, pays, corner[0], corner[1], corner[2], rows[f, count], 1)
                count += 1
        counts[f] = count
        costs_m[f] = cost_m(rows[f], count, flights[f], tables[f])
        while costs_m[f] > flights[f, 7] and counts[f] > 0:
            # What comes last is left out until the rest can be flown.
            counts[f] -= 1
            worth += look(looks, scores, pays, corner[0], corner[1], corner[2], rows[f, counts[f]], -1)
            costs_m[f] = cost_m(rows[f], counts[f], flights[f], tables[f])
        for k in range(counts[f] + 1):
            legs[f, k] = leg_m(rows[f], k - 1, k if k < counts[f] else -1, flights[f], tables[f])
    if figures[0] == -np.inf:
        figures[0], figures[1] = worth - price * costs_m.sum(), worth
        best[:] = strips
        best_counts[:] = counts
    new, new_rows = np.empty((2, most, 2, 2)), np.empty((2, most, COLUMNS))
    new_counts, new_costs, new_legs = np.zeros(2, dtype=np.int64), np.empty(2), np.empty((2, most + 1))
    # What was looked at before a step, and where steps look.
    kept, reach = looks.copy(), np.zeros(4, dtype=np.int64)
    touched = np.zeros(2, dtype=np.int64)
    room = np.empty((most + 1, COLUMNS))
    for number in range(first, last):
        left = 1.0 - number / total
        f = int(drawn(state) * many)
        touched[0], touching = f, 1
        new[0, : counts[f]] = strips[f, : counts[f]]
        new_counts[0] = counts[f]
        if many > 1 and counts[f] > 0 and drawn(state) < GIVEN:
            g = (f + 1 + int(drawn(state) * (many - 1))) % many
            if counts[g] >= most - 1:
                continue
            touched[1], touching = g, 2
            new[1, : counts[g]] = strips[g, : counts[g]]
            k = int(drawn(state) * counts[f])
            given = new[0, k].copy()
            new_counts[0] = taken_out(new[0], counts[f], k)
            new_counts[1] = put_best(new[1], counts[g], given, flights[g], tables[g], room, state)
        else:
            new_counts[0] = moved(
                new[0], counts[f], widths_m[f], scores, looks, corner, flights[f], tables[f], room, state
            )
        flown = True
        gained, more_m = 0.0, 0.0
        for t in range(touching):
            f = touched[t]
            edges = free[free_ends[f] : free_ends[f + 1]]
            turns = turning[turning_ends[f] : turning_ends[f + 1]]
            flown = flown and _follow(
                new[t], new_counts[t], new_rows[t], strips[f], counts[f], rows[f], flights[f], tables[f],
                edges, turns, new_legs[t], legs[f],
            )  # fmt: skip
            if flown:
                new_counts[t], new_costs[t] = _within(
                    new[t], new_counts[t], new_rows[t], flights[f], tables[f], edges, turns, state,
                    new_legs[t],
                )  # fmt: skip
                flown = new_costs[t] < np.inf
                more_m += new_costs[t] - costs_m[f]
        if not flown:
            continue
        reach[0], reach[1], reach[2], reach[3] = len(scores), 0, len(scores[0]), 0
        for t in range(touching):
            f = touched[t]
            had, has = counts[f], new_counts[t]
            old_looks = (strips[f], had, rows[f], new[t], has, -1, reach)
            gained += _changed(looks, scores, pays, corner, *old_looks)
            new_looks = (new[t], has, new_rows[t], strips[f], had, 1, reach)
            gained += _changed(looks, scores, pays, corner, *new_looks)
        better = gained - price * more_m
        if better < 0.0 and drawn(state) >= math.exp(better / max(heat * left * left, 1e-300)):
            _copy(kept, looks, reach)
            continue
        _copy(looks, kept, reach)
        for t in range(touching):
            f = touched[t]
            counts[f], costs_m[f] = new_counts[t], new_costs[t]
            strips[f, : counts[f]] = new[t, : counts[f]]
            rows[f, : counts[f]] = new_rows[t, : counts[f]]
            legs[f, : counts[f] + 1] = new_legs[t, : counts[f] + 1]
        worth += gained
        goodness = worth - price * costs_m.sum()
        if goodness > figures[0]:
            figures[0], figures[1] = goodness, worth
            best[:] = strips
            best_counts[:] = counts
