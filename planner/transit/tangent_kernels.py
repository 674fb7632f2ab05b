"""Compiled search of the shortest way over common tangents of directed circles.

A *wheel* is a circle flown one way round: one row east_m, north_m of its centre and its signed radius,
positive counter-clockwise, 0 for a place passed in any direction. A place on it is named by the direction φ
of flight there: centre - i s e^{iφ} as a complex number. Two wheels have one common tangent from the first to
the second, of length p: centres = e^{iφ} (p - i (s1 - s2)).
"""

# mypy: allow-untyped-decorators

from __future__ import annotations

import heapq
import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

TWO_PI = 2.0 * math.pi

#: Wheels that touch within this many metres have a tangent of no length.
TOUCHING_M = 1e-6

#: Arcs this close to a full turn, in radians, are arcs of no length.
FULL_TURN_SNAP = 1e-10

Array = NDArray[np.float64]


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
def search(
    wheels: Array, starts: Array, goals: Array, goal_place: Array, discs: Array, edges: Array
) -> tuple[float, Array]:
    """Shortest way from one of ``starts`` over tangents and arcs to one of ``goals`` (A*).

    A state is the arrival on a wheel by one tangent. Tangents are tested against the zones when first taken
    from the queue; how far a wheel can be followed is found once a state.

    Parameters
    ----------
    wheels
        Shape (W, 3): east_m, north_m, signed radius.
    starts, goals
        Shape (S, 3), (G, 3): wheel, direction of flight on it, metres flown before (after).
    goal_place
        Shape (2,): where the way ends, for the heuristic.
    discs, edges
        Shape (K, 3), (E, 4): what the way may not enter or cross.

    Returns
    -------
    length_m, visits
        ``visits``, shape (1 + V, 3): a row of the indices of the start and the goal taken, then in flight
        order wheel, arriving and leaving direction. Empty where there is no way.
    """
    count = wheels.shape[0]
    begin = count * count
    size = begin + starts.shape[0]
    done = np.zeros(size, dtype=np.bool_)
    best = np.full(size, np.inf)
    parent = np.full(size, -1, dtype=np.int64)
    tangent_phi = np.empty((count, count))
    tangent_p = np.empty((count, count))
    known = np.zeros(count, dtype=np.bool_)
    goal_best = np.full(goals.shape[0], np.inf)
    goal_parent = np.full(goals.shape[0], -1, dtype=np.int64)
    queue = [(0.0, np.int64(-1), np.int64(-1))]
    queue.clear()
    for k in range(starts.shape[0]):
        best[begin + k] = starts[k, 2]
        wheel = wheels[int(starts[k, 0])]
        at_e = wheel[0] + wheel[2] * math.sin(starts[k, 1])
        at_n = wheel[1] - wheel[2] * math.cos(starts[k, 1])
        to_go = math.hypot(goal_place[0] - at_e, goal_place[1] - at_n)
        heapq.heappush(queue, (starts[k, 2] + to_go, np.int64(begin + k), np.int64(-1)))
    while len(queue) > 0:
        entry = heapq.heappop(queue)
        state, goal = int(entry[1]), int(entry[2])
        if goal >= 0:
            return goal_best[goal], _visits(
                starts, goals, parent, int(goal_parent[goal]), goal, begin, count, tangent_phi
            )
        if done[state]:
            continue
        done[state] = True
        if state >= begin:
            j = int(starts[state - begin, 0])
            arriving = starts[state - begin, 1]
        else:
            i, j = state // count, state % count
            arriving = tangent_phi[i, j]
            from_e = wheels[i, 0] + wheels[i, 2] * math.sin(arriving)
            from_n = wheels[i, 1] - wheels[i, 2] * math.cos(arriving)
            if not _straight_clear(from_e, from_n, arriving, tangent_p[i, j], discs, edges):
                continue
        wheel = wheels[j]
        radius = abs(wheel[2])
        free = _free_turn(wheel, arriving, discs, edges)
        for k in range(goals.shape[0]):
            if int(goals[k, 0]) == j:
                turn = turn_between(wheel[2], arriving, goals[k, 1])
                length = best[state] + radius * turn + goals[k, 2]
                if turn <= free and length < goal_best[k]:
                    goal_best[k] = length
                    goal_parent[k] = state
                    heapq.heappush(queue, (length, np.int64(state), np.int64(k)))
        if not known[j]:
            known[j] = True
            for k in range(count):
                phi, p = tangent(wheels, j, k) if k != j else (0.0, -1.0)
                tangent_phi[j, k] = phi
                tangent_p[j, k] = p
        for k in range(count):
            p = tangent_p[j, k]
            onward = j * count + k
            if p < 0.0 or done[onward]:
                continue
            phi = tangent_phi[j, k]
            turn = turn_between(wheel[2], arriving, phi)
            length = best[state] + radius * turn + p
            if turn <= free and length < best[onward]:
                best[onward] = length
                parent[onward] = state
                at_e = wheels[k, 0] + wheels[k, 2] * math.sin(phi)
                at_n = wheels[k, 1] - wheels[k, 2] * math.cos(phi)
                to_go = math.hypot(goal_place[0] - at_e, goal_place[1] - at_n)
                heapq.heappush(queue, (length + to_go, np.int64(onward), np.int64(-1)))
    return np.inf, np.empty((0, 3))


@njit(cache=True)
def _visits(
    starts: Array,
    goals: Array,
    parent: NDArray[np.int64],
    last: int,
    goal: int,
    begin: int,
    count: int,
    tangent_phi: Array,
) -> Array:
    """Wheels of the way that ends with state ``last``, after a first row (start, goal, 0)."""
    steps = 0
    state = last
    while state >= 0:
        steps += 1
        state = parent[state]
    visits = np.empty((steps + 1, 3))
    leaving = goals[goal, 1]
    state = last
    for row in range(steps, 0, -1):
        visits[row, 2] = leaving
        if state >= begin:
            visits[row, 0] = starts[state - begin, 0]
            visits[row, 1] = starts[state - begin, 1]
            visits[0, 0] = state - begin
        else:
            visits[row, 0] = state % count
            visits[row, 1] = tangent_phi[state // count, state % count]
        leaving = visits[row, 1]
        state = parent[state]
    visits[0, 1] = goal
    visits[0, 2] = 0.0
    return visits
