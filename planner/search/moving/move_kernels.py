"""Compiled: one step from the strips of a flight, drawn by chance."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from planner.jit import njit
from planner.search.chance_kernels import drawn
from planner.search.moving.strip_kernels import leg_m, passed

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Looks = NDArray[np.signedinteger[Any]]
State = NDArray[np.uint64]

#: Steps by the width of the swath, as often small as large.
LEAST, MOST = 0.02, 1.5
#: New strips by the width of the swath, as often short as long.
SHORT, LONG = 0.5, 12.0
#: Of so many cells drawn the one with most that is not seen is where a new strip is laid.
DRAWN = 4


@njit(cache=True, nogil=True)
def _normal(state: State) -> float:
    """Drawn from a normal distribution, by Box and Muller."""
    return math.sqrt(-2.0 * math.log(max(drawn(state), 1e-300))) * math.cos(2.0 * math.pi * drawn(state))


@njit(cache=True, nogil=True)
def _spread(low: float, high: float, state: State) -> float:
    """Drawn evenly by its logarithm."""
    return low * math.exp(drawn(state) * math.log(high / low))


@njit(cache=True, nogil=True)
def taken_out(strips: Floats, count: int, k: int) -> int:
    """Without the k-th of so many strips."""
    for i in range(k, count - 1):
        strips[i] = strips[i + 1]
    return count - 1


@njit(cache=True, nogil=True)
def put_in(strips: Floats, count: int, k: int, strip: Floats) -> int:
    """With a strip before the k-th of so many."""
    for i in range(count, k, -1):
        strips[i] = strips[i - 1]
    strips[k] = strip
    return count + 1


@njit(cache=True, nogil=True)
def put_best(
    strips: Floats, count: int, strip: Floats, flight: Floats, table: Floats, room: Floats, state: State
) -> int:
    """With a strip, flown either way, where it costs least between the others; sometimes anywhere."""
    best_m, place, turned = np.inf, int(drawn(state) * (count + 1)), drawn(state) < 0.5
    other = np.empty((2, 2))
    other[0], other[1] = strip[1], strip[0]
    if drawn(state) < 0.9:
        known = True
        for k in range(count):
            known = known and passed(strips[k], table, flight[5], room[k])
        for way in range(2):
            if not known or not passed(strip if way == 0 else other, table, flight[5], room[count]):
                continue
            for k in range(count + 1):
                after = k if k < count else -1
                more_m = leg_m(room, k - 1, count, flight, table) + leg_m(room, count, after, flight, table)
                more_m -= leg_m(room, k - 1, after, flight, table)
                if more_m < best_m:
                    best_m, place, turned = more_m, k, way == 1
    return put_in(strips, count, place, other if turned else strip)


@njit(cache=True, nogil=True)
def _laid(
    strips: Floats,
    count: int,
    width_m: float,
    scores: Floats,
    looks: Looks,
    corner: Floats,
    state: State,
) -> Floats:
    """A new strip over what is worth something and not seen, often along one that there is."""
    rows, columns = scores.shape
    best, row, column = -1.0, 0, 0
    for _ in range(DRAWN):
        i, j = int(drawn(state) * rows), int(drawn(state) * columns)
        worth = scores[i, j] if looks[i, j] == 0 else 0.0
        if worth > best:
            best, row, column = worth, i, j
    east = corner[0] + (column + drawn(state)) * corner[2]
    north = corner[1] + (row + drawn(state)) * corner[2]
    course_rad = 2.0 * math.pi * drawn(state)
    if count and drawn(state) < 0.5:
        like = strips[int(drawn(state) * count)]
        course_rad = math.atan2(like[1, 1] - like[0, 1], like[1, 0] - like[0, 0])
    half_m = 0.5 * width_m * _spread(SHORT, LONG, state)
    e, n = half_m * math.cos(course_rad), half_m * math.sin(course_rad)
    return np.array([[east - e, north - n], [east + e, north + n]])


@njit(cache=True, nogil=True)
def _aside(strip: Floats, width_m: float, state: State) -> None:
    """A strip aside, longer or shorter, turned, or at one end aside."""
    e, n = strip[1, 0] - strip[0, 0], strip[1, 1] - strip[0, 1]
    length_m = max(math.sqrt(e * e + n * n), 1e-6)
    e, n = e / length_m, n / length_m
    way_m = _normal(state) * width_m * _spread(LEAST, MOST, state)
    kind = drawn(state)
    if kind < 0.3:
        for end in range(2):
            strip[end, 0] -= way_m * n
            strip[end, 1] += way_m * e
    elif kind < 0.6:
        end = int(2.0 * drawn(state))
        sign = 2.0 * end - 1.0
        way_m = max(2.0 * way_m, 1.0 - length_m)
        strip[end, 0] += sign * way_m * e
        strip[end, 1] += sign * way_m * n
    elif kind < 0.7:
        # Along itself.
        for end in range(2):
            strip[end, 0] += 2.0 * way_m * e
            strip[end, 1] += 2.0 * way_m * n
    elif kind < 0.85:
        for end in range(2):
            sign = 2.0 * end - 1.0
            strip[end, 0] -= 0.5 * sign * way_m * n
            strip[end, 1] += 0.5 * sign * way_m * e
    else:
        end = int(2.0 * drawn(state))
        strip[end, 0] += way_m
        strip[end, 1] += _normal(state) * abs(way_m)


@njit(cache=True, nogil=True)
def _together(strips: Floats, count: int, way_m: float, width_m: float, state: State) -> None:
    """All strips moved, or stretched along or across one of them."""
    if drawn(state) < 0.5:
        e, n = way_m, _normal(state) * abs(way_m)
        for k in range(count):
            for end in range(2):
                strips[k, end, 0] += e
                strips[k, end, 1] += n
        return
    like = strips[int(drawn(state) * count)]
    e, n = like[1, 0] - like[0, 0], like[1, 1] - like[0, 1]
    length_m = max(math.sqrt(e * e + n * n), 1e-6)
    e, n = e / length_m, n / length_m
    if drawn(state) < 0.5:
        e, n = -n, e
    middle_e, middle_n, low_m, high_m = 0.0, 0.0, np.inf, -np.inf
    for k in range(count):
        for end in range(2):
            middle_e += strips[k, end, 0] / (2.0 * count)
            middle_n += strips[k, end, 1] / (2.0 * count)
            at_m = strips[k, end, 0] * e + strips[k, end, 1] * n
            low_m, high_m = min(low_m, at_m), max(high_m, at_m)
    part = way_m / max(0.5 * (high_m - low_m), width_m)
    for k in range(count):
        for end in range(2):
            off_m = (strips[k, end, 0] - middle_e) * e + (strips[k, end, 1] - middle_n) * n
            strips[k, end, 0] += part * off_m * e
            strips[k, end, 1] += part * off_m * n


@njit(cache=True, nogil=True)
def moved(
    strips: Floats,
    count: int,
    width_m: float,
    scores: Floats,
    looks: Looks,
    corner: Floats,
    flight: Floats,
    table: Floats,
    room: Floats,
    state: State,
) -> int:
    """One step from so many strips (K, 2, 2), changed in place: how many there are then.

    Parameters
    ----------
    corner
        Of the cells: west, south, and a cell's edge.
    room
        For rows of passes, (K + 1, 12).
    """
    kind = drawn(state)
    full = count >= len(strips) - 1
    if count == 0 or (kind < 0.06 and not full):
        return put_best(strips, count, _laid(strips, count, width_m, scores, looks, corner, state), flight,
                        table, room, state)  # fmt: skip
    k = int(drawn(state) * count)
    if kind < 0.70:
        _aside(strips[k], width_m, state)
    elif kind < 0.73:
        first = strips[k, 0].copy()
        strips[k, 0] = strips[k, 1]
        strips[k, 1] = first
    elif kind < 0.78:
        other = int(drawn(state) * count)
        low, high = min(k, other), max(k, other)
        turned = strips[low : high + 1].copy()
        for i in range(high - low + 1):
            strips[low + i, 0], strips[low + i, 1] = turned[high - low - i, 1], turned[high - low - i, 0]
    elif kind < 0.85:
        strip = strips[k].copy()
        count = put_best(strips, taken_out(strips, count, k), strip, flight, table, room, state)
    elif kind < 0.89:
        count = taken_out(strips, count, k)
    elif kind < 0.93 and not full:
        # The next one beside it, flown back.
        e, n = strips[k, 1, 0] - strips[k, 0, 0], strips[k, 1, 1] - strips[k, 0, 1]
        off = (width_m if drawn(state) < 0.5 else -width_m) / max(math.sqrt(e * e + n * n), 1e-6)
        beside = np.empty((2, 2))
        for end in range(2):
            beside[end, 0] = strips[k, 1 - end, 0] - off * n
            beside[end, 1] = strips[k, 1 - end, 1] + off * e
        count = put_in(strips, count, k + 1, beside)
    elif kind < 0.96 and not full:
        # Cut in two, which then go their own ways.
        part, strip = 0.2 + 0.6 * drawn(state), strips[k].copy()
        count = put_in(strips, count, k, strip)
        strips[k, 1] = strip[0] + part * (strip[1] - strip[0])
        strips[k + 1, 0] = strips[k, 1]
        _aside(strips[k + int(2.0 * drawn(state))], width_m, state)
    else:
        way_m = _normal(state) * width_m * _spread(LEAST, MOST, state)
        _together(strips, count, way_m, width_m, state)
    return count
