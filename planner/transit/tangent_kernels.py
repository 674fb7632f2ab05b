"""Compiled search of the shortest way over common tangents of directed circles.

A *wheel* is a circle flown one way round: one row east_m, north_m of its centre and its signed radius,
positive counter-clockwise, 0 for a place passed in any direction. A place on it is named by the direction φ
of flight there: centre - i s e^{iφ} as a complex number. Two wheels have one common tangent from the first to
the second, of length p: centres = e^{iφ} (p - i (s1 - s2)).
"""

# mypy: allow-untyped-decorators

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from planner.dubins.kernels import dubins_length
from planner.jit import njit
from planner.transit.growing_kernels import longer, longer_indices, more
from planner.transit.kernels import pop, push

TWO_PI = 2.0 * math.pi

#: Wheels that touch within this many metres have a tangent of no length.
TOUCHING_M = 1e-6

#: Arcs this close to a full turn, in radians, are arcs of no length.
FULL_TURN_SNAP = 1e-10

#: Bounds of what is left to fly are taken with a turn radius less by this part.
RADIUS_SLACK = 1e-6

Array = NDArray[np.float64]
Index = NDArray[np.int64]


@njit(cache=True)
def tangent(wheels: Array, i: int, j: int) -> tuple[float, float]:
    """Direction and length of the tangent from wheel i to wheel j; length -1 where there is none."""
    de, dn = wheels[j, 0] - wheels[i, 0], wheels[j, 1] - wheels[i, 1]
    ds = wheels[i, 2] - wheels[j, 2]
    distance = math.sqrt(de * de + dn * dn)
    gap = distance - abs(ds)
    if distance < TOUCHING_M or gap < -TOUCHING_M:
        return 0.0, -1.0
    p = 0.0 if gap < TOUCHING_M else math.sqrt(gap * (distance + abs(ds)))
    return math.atan2(dn * p + de * ds, de * p - dn * ds), p


@njit(cache=True)
def turn_between(signed_radius_m: float, arriving_rad: float, leaving_rad: float) -> float:
    """Turn in [0, 2π) on a wheel between two directions of flight; 0 at a place."""
    if signed_radius_m == 0.0:
        return 0.0
    turn = leaving_rad - arriving_rad if signed_radius_m > 0.0 else arriving_rad - leaving_rad
    turn -= TWO_PI * math.floor(turn / TWO_PI)
    return 0.0 if TWO_PI - turn < FULL_TURN_SNAP else turn


@njit(cache=True)
def _straight_clear(e0: float, n0: float, phi: float, length: float, discs: Array, edges: Array) -> bool:
    cosine, sine = math.cos(phi), math.sin(phi)
    for k in range(discs.shape[0]):
        oe, on = discs[k, 0] - e0, discs[k, 1] - n0
        along = min(max(oe * cosine + on * sine, 0.0), length)
        if (oe - along * cosine) ** 2 + (on - along * sine) ** 2 < discs[k, 2] ** 2:
            return False
    for k in range(edges.shape[0]):
        # An edge is met where its ends are on both sides and the meeting point lies within the length.
        a_e, a_n, b_e, b_n = edges[k, 0] - e0, edges[k, 1] - n0, edges[k, 2] - e0, edges[k, 3] - n0
        a_side, b_side = cosine * a_n - sine * a_e, cosine * b_n - sine * b_e
        if (a_side > 0.0) == (b_side > 0.0):
            continue
        share = a_side / (a_side - b_side)
        a_along, b_along = a_e * cosine + a_n * sine, b_e * cosine + b_n * sine
        along = a_along + share * (b_along - a_along)
        if 0.0 <= along <= length:
            return False
    return True


@njit(cache=True)
def _free_turn(wheel: Array, arriving_rad: float, discs: Array, edges: Array) -> float:
    """How far one can turn on a wheel from a direction until the first zone, in radians; inf for ever."""
    radius = abs(wheel[2])
    if radius == 0.0:
        return np.inf
    way = 1.0 if wheel[2] > 0.0 else -1.0
    polar = arriving_rad - way * 0.5 * math.pi
    free = np.inf
    for k in range(discs.shape[0]):
        oe, on = discs[k, 0] - wheel[0], discs[k, 1] - wheel[1]
        square = oe * oe + on * on
        r = discs[k, 2]
        if square >= (radius + r) ** 2 or r <= 0.0:
            continue
        distance = math.sqrt(square)
        if distance <= radius - r:
            continue
        if distance <= r - radius:
            return 0.0
        half = math.acos((radius * radius + square - r * r) / (2.0 * radius * distance))
        towards = math.atan2(on, oe)
        turn = way * (towards - polar)
        turn -= TWO_PI * math.floor(turn / TWO_PI)
        if turn < half or TWO_PI - turn < half:
            return 0.0
        free = min(free, turn - half)
    for k in range(edges.shape[0]):
        ee, en = edges[k, 2] - edges[k, 0], edges[k, 3] - edges[k, 1]
        oe, on = edges[k, 0] - wheel[0], edges[k, 1] - wheel[1]
        square = ee * ee + en * en
        if square == 0.0:
            continue
        middle = -(oe * ee + on * en) / square
        root = middle * middle - (oe * oe + on * on - radius * radius) / square
        if root < 0.0:
            continue
        root = math.sqrt(root)
        for share in (middle - root, middle + root):
            if 0.0 <= share <= 1.0:
                turn = way * (math.atan2(on + share * en, oe + share * ee) - polar)
                free = min(free, turn - TWO_PI * math.floor(turn / TWO_PI))
    return free


@njit(cache=True)
def least_to_go(east_m: float, north_m: float, angle_rad: float, goal: Array, radius_m: float) -> float:
    """No line from a pose to the goal is shorter: the Dubins line, zones aside.

    Parameters
    ----------
    goal
        Shape (3,): east_m, north_m, angle_rad; NaN where the direction is free.
    radius_m
        Smallest turn radius; taken a little less, so that wheels which only just touch bound nothing.
    """
    radius_m *= 1.0 - RADIUS_SLACK
    if not math.isnan(goal[2]):
        return dubins_length(east_m, north_m, angle_rad, goal[0], goal[1], goal[2], radius_m)
    return _least_to_place(east_m, north_m, angle_rad, goal, radius_m)


@njit(cache=True)
def _least_to_place(east_m: float, north_m: float, angle_rad: float, goal: Array, radius_m: float) -> float:
    """The shortest of the words LS, RS, LR and RL; see ``words.candidates_to_point``."""
    away_e, away_n = (goal[0] - east_m) / radius_m, (goal[1] - north_m) / radius_m
    best = np.inf
    for k in range(2):
        s = 1.0 - 2.0 * k
        to_e, to_n = away_e + s * math.sin(angle_rad), away_n - s * math.cos(angle_rad)
        square = to_e * to_e + to_n * to_n
        if square >= 1.0 - 3.0 * RADIUS_SLACK:
            p = math.sqrt(max(square - 1.0, 0.0))
            phi = math.atan2(to_n * p + s * to_e, to_e * p - s * to_n)
            best = min(best, p + turn_between(s, angle_rad, phi))
        distance = math.sqrt(square)
        if 1.0 <= distance <= 3.0:
            gamma = math.acos(min(1.0, (square + 3.0) / (4.0 * distance)))
            for lean in (gamma, -gamma):
                toward = math.atan2(to_n, to_e) + lean
                last = math.atan2(to_n - 2.0 * math.sin(toward), to_e - 2.0 * math.cos(toward))
                phi = toward + s * 0.5 * math.pi
                back = last - s * 0.5 * math.pi
                best = min(best, turn_between(s, angle_rad, phi) + turn_between(-s, phi, back))
    return radius_m * best


@njit(cache=True)
def _passed_before(
    signed_m: float, newest: int, arriving_rad: float, flown_m: float, passed: Array, older: Index
) -> bool:
    """Whether an earlier arrival on a wheel can be followed to a place on it, for no more than ``flown_m``.

    ``passed`` (N, 3): direction of the arrival, metres flown until there, free turn from there.
    """
    while newest >= 0:
        turn = turn_between(signed_m, passed[newest, 0], arriving_rad)
        if turn <= passed[newest, 2] and passed[newest, 1] + abs(signed_m) * turn <= flown_m:
            return True
        newest = older[newest]
    return False


@njit(cache=True)
def search(
    wheels: Array,
    starts: Array,
    goals: Array,
    goal: Array,
    radius_m: float,
    discs: Array,
    edges: Array,
    most_m: float,
    most_wheels: int,
) -> tuple[float, Array]:
    """Shortest way from one of ``starts`` over tangents and arcs to one of ``goals`` (A*).

    A state is the arrival on a wheel by one tangent. Tangents are tested against the zones when first taken
    from the queue; how far a wheel can be followed is found once a state. An arrival at a place of a wheel
    that an earlier one reaches for less by going on round it leads nowhere new and is left; what is left to
    fly is bounded by the Dubins line, zones aside.

    Parameters
    ----------
    wheels
        Shape (W, 3): east_m, north_m, signed radius.
    starts, goals
        Shape (S, 3), (G, 3): wheel, direction of flight on it, metres flown before (after).
    goal
        Shape (3,): where the way ends, and in which direction; NaN for any.
    radius_m
        No wheel but a place is tighter.
    discs, edges
        Shape (K, 3), (E, 4): what the way may not enter or cross.
    most_m
        Ways of this length and more are not wanted; inf for any.
    most_wheels
        Given up once so many wheels were followed.

    Returns
    -------
    length_m, visits
        ``visits``, shape (1 + V, 3): a row of the indices of the start and the goal taken, then in flight
        order wheel, arriving and leaving direction. Empty where there is no way, and with a length of NaN
        where the search was given up.
    """
    count = wheels.shape[0]
    # A row for each wheel followed so far: the tangents out of it, and the best way to the end of each.
    rows = 0
    row_of = np.full(count, -1, dtype=np.int64)
    wheel_of = np.empty(count, dtype=np.int64)
    phis, lengths = np.empty((8, count)), np.empty((8, count))
    to_go, best = np.empty((8, count)), np.empty((8, count))
    parent = np.empty((8, count))
    newest = np.full(count, -1, dtype=np.int64)
    passed, older = np.empty((64, 3)), np.empty(64, dtype=np.int64)
    kept = 0
    goal_best = np.full(goals.shape[0], most_m)
    goal_parent = np.full(goals.shape[0], -1, dtype=np.int64)
    least_m = most_m
    # Items: state row * count + wheel from ``first`` on, starts before, goals below 0.
    first = starts.shape[0]
    keys, items = np.empty(1024), np.empty(1024, dtype=np.int64)
    size = 0
    for k in range(first):
        wheel = wheels[int(starts[k, 0])]
        at_e = wheel[0] + wheel[2] * math.sin(starts[k, 1])
        at_n = wheel[1] - wheel[2] * math.cos(starts[k, 1])
        if wheel[2] == 0.0:
            left_m = math.hypot(goal[0] - at_e, goal[1] - at_n)
        else:
            left_m = least_to_go(at_e, at_n, starts[k, 1], goal, radius_m)
        if starts[k, 2] + left_m < least_m:
            if size == len(keys):
                keys, items = longer(keys), longer_indices(items)
            size = push(keys, items, size, starts[k, 2] + left_m, k)
    while size > 0:
        item, size = pop(keys, items, size)
        if item < 0:
            k = -1 - item
            return goal_best[k], _visits(
                starts, goals, parent, wheel_of, goal_parent[k], k, first, count, phis
            )
        if item < first:
            j = int(starts[item, 0])
            arriving, flown_m = starts[item, 1], starts[item, 2]
        else:
            row, j = (item - first) // count, (item - first) % count
            arriving, flown_m = phis[row, j], best[row, j]
            # Done with, whatever comes later.
            best[row, j] = -np.inf
            if flown_m < 0.0:
                continue
        wheel = wheels[j]
        radius = abs(wheel[2])
        if _passed_before(wheel[2], newest[j], arriving, flown_m, passed, older):
            continue
        if item >= first:
            i = wheel_of[row]
            from_e = wheels[i, 0] + wheels[i, 2] * math.sin(arriving)
            from_n = wheels[i, 1] - wheels[i, 2] * math.cos(arriving)
            if not _straight_clear(from_e, from_n, arriving, lengths[row, j], discs, edges):
                continue
        free = _free_turn(wheel, arriving, discs, edges)
        if kept == len(older):
            passed, older = more(passed, 0.0), longer_indices(older)
        passed[kept, 0], passed[kept, 1], passed[kept, 2] = arriving, flown_m, free
        older[kept] = newest[j]
        newest[j] = kept
        kept += 1
        for k in range(goals.shape[0]):
            if int(goals[k, 0]) == j:
                turn = turn_between(wheel[2], arriving, goals[k, 1])
                length = flown_m + radius * turn + goals[k, 2]
                if turn <= free and length < goal_best[k]:
                    goal_best[k] = length
                    goal_parent[k] = item
                    least_m = min(least_m, length)
                    if size == len(keys):
                        keys, items = longer(keys), longer_indices(items)
                    size = push(keys, items, size, length, -1 - k)
        if row_of[j] < 0:
            if rows == most_wheels:
                return np.nan, np.empty((0, 3))
            if rows == phis.shape[0]:
                phis, lengths, to_go = more(phis, 0.0), more(lengths, 0.0), more(to_go, 0.0)
                best, parent = more(best, 0.0), more(parent, 0.0)
            for k in range(count):
                phi, p = tangent(wheels, j, k) if k != j else (0.0, -1.0)
                phis[rows, k] = phi
                lengths[rows, k] = p
                to_go[rows, k] = -1.0
                best[rows, k] = np.inf
            row_of[j] = rows
            wheel_of[rows] = j
            rows += 1
        row = row_of[j]
        for k in range(count):
            p = lengths[row, k]
            if p < 0.0 or best[row, k] < 0.0:
                continue
            phi = phis[row, k]
            turn = turn_between(wheel[2], arriving, phi)
            length = flown_m + radius * turn + p
            if turn > free or length >= best[row, k] or length >= least_m:
                continue
            if _passed_before(wheels[k, 2], newest[k], phi, length, passed, older):
                continue
            if to_go[row, k] < 0.0:
                at_e = wheels[k, 0] + wheels[k, 2] * math.sin(phi)
                at_n = wheels[k, 1] - wheels[k, 2] * math.cos(phi)
                if wheels[k, 2] == 0.0:
                    to_go[row, k] = math.hypot(goal[0] - at_e, goal[1] - at_n)
                else:
                    to_go[row, k] = least_to_go(at_e, at_n, phi, goal, radius_m)
            if length + to_go[row, k] >= least_m:
                continue
            best[row, k] = length
            parent[row, k] = item
            if size == len(keys):
                keys, items = longer(keys), longer_indices(items)
            size = push(keys, items, size, length + to_go[row, k], first + row * count + k)
    return np.inf, np.empty((0, 3))


@njit(cache=True)
def _visits(
    starts: Array,
    goals: Array,
    parent: Array,
    wheel_of: Index,
    last: int,
    goal: int,
    first: int,
    count: int,
    phis: Array,
) -> Array:
    """Wheels of the way that ends with item ``last``, after a first row (start, goal, 0)."""
    steps = 1
    item = last
    while item >= first:
        steps += 1
        item = int(parent[(item - first) // count, (item - first) % count])
    visits = np.empty((steps + 1, 3))
    leaving = goals[goal, 1]
    item = last
    for row in range(steps, 0, -1):
        visits[row, 2] = leaving
        if item < first:
            visits[row, 0] = starts[item, 0]
            visits[row, 1] = starts[item, 1]
            visits[0, 0] = item
        else:
            at, wheel = (item - first) // count, (item - first) % count
            visits[row, 0] = wheel
            visits[row, 1] = phis[at, wheel]
            item = int(parent[at, wheel])
        leaving = visits[row, 1]
    visits[0, 1] = goal
    visits[0, 2] = 0.0
    return visits
