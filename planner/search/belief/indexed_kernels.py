"""Compiled: what lines find of many places, of which only those near are looked at; lines from corners.

Places lie in square cells, sorted anew for each span of time, in a frame that goes along with their mean
drift. A line is float64 (M, 3): east_m, north_m, time_s.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from planner.jit import njit
from planner.search.belief.kernels import home_m

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Shorts = NDArray[np.int32]


@njit(cache=True, nogil=True)
def sorted_by_cell(
    places: Floats,
    drifts: Floats,
    mean: Floats,
    middles: Floats,
    corner: Floats,
    cell: float,
    columns: int,
    rows: int,
) -> tuple[Shorts, Shorts]:
    """Places by their cell at each of some times: int32 (T, N), and where each cell begins, (T, cells + 1).

    Parameters
    ----------
    mean
        Drift of the frame.
    middles
        The times, (T,).
    corner
        West and south of the first cell, in that frame.
    """  # fmt: skip
    count = len(places)
    order = np.zeros((len(middles), count), dtype=np.int32)
    begins = np.zeros((len(middles), rows * columns + 1), dtype=np.int32)
    cells = np.zeros(count, dtype=np.int64)
    for t in range(len(middles)):
        for i in range(count):
            east = places[i, 0] + middles[t] * (drifts[i, 0] - mean[0])
            north = places[i, 1] + middles[t] * (drifts[i, 1] - mean[1])
            column = min(max(int((east - corner[0]) / cell), 0), columns - 1)
            row = min(max(int((north - corner[1]) / cell), 0), rows - 1)
            cells[i] = row * columns + column
            begins[t, cells[i] + 1] += 1
        for k in range(rows * columns):
            begins[t, k + 1] += begins[t, k]
        at = begins[t, :-1].copy()
        for i in range(count):
            order[t, at[cells[i]]] = i
            at[cells[i]] += 1
    return order, begins


@njit(cache=True, nogil=True)
def found_by_time(
    lines: Floats,
    offsets: Ints,
    halves: Floats,
    misses: Floats,
    soft: float,
    places: Floats,
    drifts: Floats,
    weights: Floats,
    times: Floats,
    middles: Floats,
    mean: Floats,
    apart: float,
    corner: Floats,
    cell: float,
    columns: int,
    rows: int,
    order: Shorts,
    begins: Shorts,
    first_span: int,
    found: Floats,
    lefts: Floats,
    keep: bool,
) -> Floats:
    """float64 (T,): weight of what looks from all lines have found by each time.

    Parameters
    ----------
    lines, offsets
        One behind the other, line k from ``offsets[k]`` up to ``offsets[k + 1]``.
    halves, misses
        Half of what each sees across its course, and how probable it is that a look misses.
    soft
        Over this width at either edge a look finds less and less: a place stands for ground round it.
    apart
        No drift is farther from the mean, m/s.
    first_span
        Spans before it are as ``found`` (T,) and ``lefts`` (T, N) tell: what looks have missed by each.
    keep
        Write both from there on.
    """  # fmt: skip
    left = np.ones(len(places))
    total = 0.0
    by = np.zeros(len(times))
    at = offsets[:-1].copy()
    if first_span > 0:
        left[:] = lefts[first_span - 1]
        total = found[first_span - 1]
        by[:first_span] = found[:first_span]
        for a in range(len(halves)):
            while at[a] + 1 < offsets[a + 1] and lines[at[a] + 1, 2] <= times[first_span - 1] + 1e-9:
                at[a] += 1
    drift = math.hypot(mean[0], mean[1])
    for t in range(first_span, len(times)):
        for a in range(len(halves)):
            half, miss = halves[a], misses[a]
            while at[a] + 1 < offsets[a + 1] and lines[at[a] + 1, 2] <= times[t] + 1e-9:
                e0, n0, t0 = lines[at[a]]
                e1, n1, t1 = lines[at[a] + 1]
                at[a] += 1
                length = math.hypot(e1 - e0, n1 - n0)
                if length < 1e-9:
                    continue
                ue, un = (e1 - e0) / length, (n1 - n0) / length
                # As far beside it as places may have moved since the cells' time.
                beside = half + 0.5 * soft + apart * abs(t0 - middles[t])
                ahead = (apart + drift) * (t1 - t0)
                fe, fn = e0 - mean[0] * t0, n0 - mean[1] * t0
                south = (min(fn, fn + length * un - ahead) - beside - corner[1]) / cell
                north = (max(fn, fn + length * un + ahead) + beside - corner[1]) / cell
                west = (min(fe, fe + length * ue - ahead) - beside - corner[0]) / cell
                east = (max(fe, fe + length * ue + ahead) + beside - corner[0]) / cell
                first_column = min(max(math.floor(west), 0), columns - 1)
                last_column = min(max(math.floor(east), 0), columns - 1)
                first_row = min(max(math.floor(south), 0), rows - 1)
                for row in range(first_row, min(max(math.floor(north), 0), rows - 1) + 1):
                    first = begins[t, row * columns + first_column]
                    for k in range(first, begins[t, row * columns + last_column + 1]):
                        i = order[t, k]
                        de = places[i, 0] + t0 * drifts[i, 0] - e0
                        dn = places[i, 1] + t0 * drifts[i, 1] - n0
                        inside = half + 0.5 * soft - abs(ue * dn - un * de)
                        if inside <= 0.0:
                            continue
                        along = ue * de + un * dn
                        on = ue * drifts[i, 0] + un * drifts[i, 1]
                        if along >= 0.0 and along + (t1 - t0) * on < length:
                            looks = (1.0 - miss) * (1.0 if inside >= soft else inside / soft)
                            total += weights[i] * left[i] * looks
                            left[i] *= 1.0 - looks
        by[t] = total
        if keep:
            found[t] = total
            lefts[t] = left
    return by


@njit(cache=True, nogil=True)
def _put(line: Floats, count: int, east: float, north: float, step: float, speed: float) -> int:
    """Go on straight to a place, in pieces of a step at most."""
    e0, n0, t0 = line[count - 1]
    length = math.hypot(east - e0, north - n0)
    if length <= 1e-6:
        return count
    pieces = max(1, math.ceil(length / step))
    for k in range(1, pieces + 1):
        if count >= len(line):
            return count
        part = k / pieces
        line[count, 0] = e0 + part * (east - e0)
        line[count, 1] = n0 + part * (north - n0)
        line[count, 2] = t0 + part * length / speed
        count += 1
    return count


@njit(cache=True, nogil=True)
def _bent(
    line: Floats,
    count: int,
    ce: float,
    cn: float,
    radius: float,
    begin: float,
    turn: float,
    step: float,
    straight: float,
    speed: float,
) -> int:
    """Go on round a centre, from an angle of the circle on."""  # fmt: skip
    pieces = max(1, math.ceil(radius * abs(turn) / step))
    for k in range(pieces + 1):
        angle = begin + turn * k / pieces
        count = _put(
            line, count, ce + radius * math.cos(angle), cn + radius * math.sin(angle), straight, speed
        )
    return count


@njit(cache=True, nogil=True)
def line_by(
    corners: Floats, radius: float, speed: float, until: float, step: float, straight: float
) -> Floats:
    """The line along corners, rounded, from the first of them and back to it in time; ``lines`` says how.

    Parameters
    ----------
    corners
        (K, 2); the first is where it starts and ends.
    step, straight
        Samples on arcs and on straights are no farther apart.
    """
    most = int(3.0 * until * speed / min(step, straight)) + 8 * len(corners) + 64
    line = np.zeros((most, 3))
    line[0, 0], line[0, 1] = corners[0]
    count = 1
    for k in range(1, len(corners)):
        if line[count - 1, 2] > until:
            break
        he, hn = corners[k]
        if k == len(corners) - 1:
            count = _put(line, count, he, hn, straight, speed)
            break
        ie, jn = he - corners[k - 1, 0], hn - corners[k - 1, 1]
        oe, on = corners[k + 1, 0] - he, corners[k + 1, 1] - hn
        long_in, long_out = math.hypot(ie, jn), math.hypot(oe, on)
        if min(long_in, long_out) < 1e-6:
            continue
        ie, jn, oe, on = ie / long_in, jn / long_in, oe / long_out, on / long_out
        turn = math.atan2(ie * on - jn * oe, ie * oe + jn * on)
        if abs(turn) < 1e-6:
            count = _put(line, count, he, hn, straight, speed)
            continue
        half = math.tan(0.5 * min(abs(turn), 3.0))
        cut = min(radius * half, min(0.5 * long_in, 0.5 * long_out))
        own = cut / half
        side = 1.0 if turn > 0.0 else -1.0
        be, bn = he - cut * ie, hn - cut * jn
        ce, cn = be - side * own * jn, bn + side * own * ie
        begin = math.atan2(bn - cn, be - ce)
        count = _bent(line, count, ce, cn, own, begin, turn, step, straight, speed)
    base_e, base_n = corners[0]
    for last in range(count - 1, -1, -1):
        e, n, t = line[last]
        if t > until:
            continue
        near = max(last, 1)
        angle = math.atan2(line[near, 1] - line[near - 1, 1], line[near, 0] - line[near - 1, 0])
        if t + home_m(e, n, angle, base_e, base_n, radius) / speed <= until + 1e-6:
            return _homeward(line, last + 1, angle, base_e, base_n, radius, speed, step, straight)
    return line[:1].copy()


@njit(cache=True, nogil=True)
def _homeward(
    line: Floats,
    count: int,
    angle: float,
    to_e: float,
    to_n: float,
    radius: float,
    speed: float,
    step: float,
    straight: float,
) -> Floats:
    """A line's beginning and the shortest arc and straight line to a place."""  # fmt: skip
    e, n = line[count - 1, 0], line[count - 1, 1]
    best, best_side, best_begin, best_turn = np.inf, 0.0, 0.0, 0.0
    for side in (1.0, -1.0):
        ce, cn = e - side * radius * math.sin(angle), n + side * radius * math.cos(angle)
        away = math.hypot(to_e - ce, to_n - cn)
        if away < radius:
            continue
        leave = math.atan2(to_n - cn, to_e - ce) - side * math.acos(radius / away)
        begin = angle - side * 0.5 * math.pi
        turn = (side * (leave - begin)) % (2.0 * math.pi)
        if turn > 2.0 * math.pi - 1e-9:
            turn = 0.0
        length = radius * turn + math.sqrt(away * away - radius * radius)
        if length < best:
            best, best_side, best_begin, best_turn = length, side, begin, side * turn
    if best < np.inf:
        ce, cn = e - best_side * radius * math.sin(angle), n + best_side * radius * math.cos(angle)
        count = _bent(line, count, ce, cn, radius, best_begin, best_turn, step, straight, speed)
    count = _put(line, count, to_e, to_n, straight, speed)
    return line[:count].copy()
