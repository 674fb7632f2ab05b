"""Compiled: what looks from lines see of moving places, and a beam search over lines of bounded curvature.

A line is float64 (M, 3): east_m, north_m, time_s. A place is looked at once each time that it falls back
behind the aircraft within half the swath beside it.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from planner.jit import njit

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]


@njit(cache=True, nogil=True)
def looks_by_time(line: Floats, places: Floats, drifts: Floats, half_m: float, times: Floats) -> Ints:
    """int64 (times, places): looks at each place up to each time."""
    found = np.zeros((len(times), len(places)), dtype=np.int64)
    upto = 0
    for k in range(len(line) - 1):
        e0, n0, t0 = line[k]
        e1, n1, t1 = line[k + 1]
        length = math.hypot(e1 - e0, n1 - n0)
        while upto < len(times) and times[upto] < t1 - 1e-9:
            upto += 1
        if upto == len(times):
            break
        if length < 1e-9:
            continue
        ue, un = (e1 - e0) / length, (n1 - n0) / length
        for i in range(len(places)):
            de, dn = places[i, 0] + t0 * drifts[i, 0] - e0, places[i, 1] + t0 * drifts[i, 1] - n0
            aside = ue * dn - un * de
            if aside > half_m or aside < -half_m:
                continue
            along = ue * de + un * dn
            on = ue * drifts[i, 0] + un * drifts[i, 1]
            if along >= 0.0 and along + (t1 - t0) * on < length:
                found[upto, i] += 1
    for k in range(1, len(times)):
        found[k] += found[k - 1]
    return found


@njit(cache=True, nogil=True)
def home_m(east: float, north: float, angle: float, to_east: float, to_north: float, radius: float) -> float:
    """Length of the shortest arc and straight line to a place; inf where it lies within both turns."""
    best = np.inf
    for side in (1.0, -1.0):
        ce, cn = east - side * radius * math.sin(angle), north + side * radius * math.cos(angle)
        away = math.hypot(to_east - ce, to_north - cn)
        if away < radius:
            continue
        # Where the tangent leaves the circle, as an angle of it.
        bearing = math.atan2(to_north - cn, to_east - ce)
        leave = bearing - side * math.acos(radius / away)
        begin = angle - side * 0.5 * math.pi
        turn = (side * (leave - begin)) % (2.0 * math.pi)
        if turn > 2.0 * math.pi - 1e-9:
            turn = 0.0
        best = min(best, radius * turn + math.sqrt(away * away - radius * radius))
    return best


@njit(cache=True, nogil=True)
def _stepped(
    east: float, north: float, angle: float, bend: float, length: float
) -> tuple[float, float, float]:
    """A pose after a way of a curvature."""
    if abs(bend) < 1e-12:
        return east + length * math.cos(angle), north + length * math.sin(angle), angle
    after = angle + bend * length
    return (
        east + (math.sin(after) - math.sin(angle)) / bend,
        north - (math.cos(after) - math.cos(angle)) / bend,
        after,
    )


@njit(cache=True, nogil=True)
def _open(east: float, north: float, blocked: Bools, west: float, south: float, cell: float) -> bool:
    """Whether a place is on the map's free part; all is where there is no map."""
    if blocked.size == 0:
        return True
    row, column = math.floor((north - south) / cell), math.floor((east - west) / cell)
    if row < 0 or column < 0 or row >= blocked.shape[0] or column >= blocked.shape[1]:
        return False
    return not blocked[row, column]


@njit(cache=True, nogil=True)
def beam_line(
    pose: Floats,
    start_s: float,
    end: Floats,
    places: Floats,
    drifts: Floats,
    weights: Floats,
    half_m: float,
    miss: float,
    speed: float,
    radius: float,
    step_m: float,
    chords: int,
    until_s: float,
    width: int,
    pull: float,
    reach_m: float,
    hurry: float,
    blocked: Bools,
    corner: Floats,
) -> tuple[Floats, float]:
    """The line from a pose on that finds most and soonest, and can still get to its end.

    Parameters
    ----------
    pose
        East, north, angle_rad; flown from ``start_s`` on.
    weights
        float64 (N,): how likely each place still is.
    miss
        Probability that a look does not find what it sees.
    chords
        Straight pieces that a step's arc is judged by.
    until_s
        When the end must have been reached.
    pull, reach_m
        Weight of what still lies about, and the distance at which it pulls half.
    hurry
        How much more an early find counts than one at the end.
    blocked, corner
        Map of what is not free, and its west, south and cell; an empty one blocks nothing.

    Returns
    -------
    tuple
        Poses (M, 4): east, north, angle, time; and what was found by the last.
    """
    steps = int((until_s - start_s) * speed / step_m)
    bends = np.array([0.0, 1.0, -1.0, 0.45, -0.45]) / radius
    count = len(weights)
    poses = np.zeros((steps + 1, width, 3))
    parents = np.zeros((steps + 1, width), dtype=np.int64)
    left = np.zeros((2, width, count))
    value = np.zeros((2, width))
    poses[0, 0] = pose
    left[0, 0] = weights
    alive = 1
    n_bends = len(bends)
    child = np.zeros((width * n_bends, 3))
    promise = np.zeros(width * n_bends)
    gains = np.zeros(width * n_bends)
    whence = np.zeros(width * n_bends, dtype=np.int64)
    bent = np.zeros(width * n_bends)
    best_value, best_step, best_index = -1.0, 0, 0
    piece = step_m / chords
    dt = piece / speed
    # Where places are at the ends of each chord of a step.
    at = np.zeros((chords + 1, count, 2))
    for step in range(steps):
        now, after = step % 2, (step + 1) % 2
        time = start_s + step * step_m / speed
        worth = 1.0 + hurry * max(0.0, (until_s - time) / until_s)
        found = 0
        later = time + step_m / speed
        for c in range(chords + 1):
            for i in range(count):
                at[c, i, 0] = places[i, 0] + (time + c * dt) * drifts[i, 0]
                at[c, i, 1] = places[i, 1] + (time + c * dt) * drifts[i, 1]
        for b in range(alive):
            for a in range(n_bends):
                e, n, angle = poses[step, b]
                bend = bends[a]
                ok = True
                gain = 0.0
                for c in range(chords):
                    e1, n1, angle1 = _stepped(e, n, angle, bend, piece)
                    if not _open(e1, n1, blocked, corner[0], corner[1], corner[2]):
                        ok = False
                        break
                    ue, un = e1 - e, n1 - n
                    length = math.hypot(ue, un)
                    ue, un = ue / length, un / length
                    for i in range(count):
                        de, dn = at[c, i, 0] - e, at[c, i, 1] - n
                        aside = ue * dn - un * de
                        if aside > half_m or aside < -half_m:
                            continue
                        ahead = ue * (at[c + 1, i, 0] - e1) + un * (at[c + 1, i, 1] - n1)
                        if ue * de + un * dn >= 0.0 and ahead < 0.0:
                            gain += left[now, b, i]
                    e, n, angle = e1, n1, angle1
                if not ok:
                    continue
                if home_m(e, n, angle, end[0], end[1], radius) > (until_s - later) * speed:
                    continue
                near = 0.0
                for i in range(0, count, 2):
                    de, dn = (at[chords, i, 0] - e) / reach_m, (at[chords, i, 1] - n) / reach_m
                    near += 2.0 * left[now, b, i] / (1.0 + de * de + dn * dn)
                child[found, 0], child[found, 1], child[found, 2] = e, n, angle
                gains[found] = value[now, b] + (1.0 - miss) * gain * worth
                promise[found] = gains[found] + pull * worth * near
                whence[found] = b
                bent[found] = bend
                found += 1
        if found == 0:
            break
        order = np.argsort(-promise[:found], kind="mergesort")
        alive = 0
        for rank in range(found):
            o = order[rank]
            # Beams thin out where lines have come together.
            twin = False
            for k in range(alive):
                if (
                    abs(poses[step + 1, k, 0] - child[o, 0]) + abs(poses[step + 1, k, 1] - child[o, 1])
                    < 0.15 * step_m
                    and math.cos(poses[step + 1, k, 2] - child[o, 2]) > 0.98
                ):
                    twin = True
                    break
            if twin:
                continue
            b = whence[o]
            poses[step + 1, alive] = child[o]
            parents[step + 1, alive] = b
            value[after, alive] = gains[o]
            left[after, alive] = left[now, b]
            e, n, angle = poses[step, b]
            for c in range(chords):
                e1, n1, angle1 = _stepped(e, n, angle, bent[o], piece)
                ue, un = e1 - e, n1 - n
                length = math.hypot(ue, un)
                ue, un = ue / length, un / length
                for i in range(count):
                    de, dn = at[c, i, 0] - e, at[c, i, 1] - n
                    aside = ue * dn - un * de
                    if aside > half_m or aside < -half_m:
                        continue
                    ahead = ue * (at[c + 1, i, 0] - e1) + un * (at[c + 1, i, 1] - n1)
                    if ue * de + un * dn >= 0.0 and ahead < 0.0:
                        left[after, alive, i] *= miss
                e, n, angle = e1, n1, angle1
            if gains[o] > best_value:
                best_value, best_step, best_index = gains[o], step + 1, alive
            alive += 1
            if alive == width:
                break
    line = np.zeros((best_step + 1, 4))
    index = best_index
    for step in range(best_step, -1, -1):
        line[step, :3] = poses[step, index]
        line[step, 3] = start_s + step * step_m / speed
        index = parents[step, index]
    return line, best_value
