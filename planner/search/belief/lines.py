"""Lines as searches fly them: corners rounded by the turn, cut to what may be flown, timed."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from planner.search.belief.kernels import home_m

Floats = NDArray[np.float64]

#: Samples no farther apart than this on arcs, and on straights.
STEP_M, STRAIGHT_M = 40.0, 120.0


def rounded(corners: Floats, radius_m: float) -> Floats:
    """Points (M, 2) along a polyline (K, 2) whose corners are cut by arcs as tight as flown, or as fit."""
    found: list[Floats] = [corners[:1]]
    for k in range(1, len(corners) - 1):
        before, here, after = corners[k - 1 : k + 2]
        into, out = here - before, after - here
        long_in, long_out = math.hypot(*into), math.hypot(*out)
        if min(long_in, long_out) < 1e-6:
            continue
        into, out = into / long_in, out / long_out
        turn = math.atan2(into[0] * out[1] - into[1] * out[0], float(into @ out))
        if abs(turn) < 1e-6:
            found.append(here[None])
            continue
        half = math.tan(0.5 * min(abs(turn), 3.0))
        cut_m = min(radius_m * half, 0.5 * long_in, 0.5 * long_out)
        radius = cut_m / half
        side = math.copysign(1.0, turn)
        begin = here - cut_m * into
        centre = begin + side * radius * np.array([-into[1], into[0]])
        count = max(2, math.ceil(radius * abs(turn) / STEP_M) + 1)
        angles = math.atan2(*(begin - centre)[::-1]) + np.linspace(0.0, turn, count)
        found.append(centre + radius * np.stack([np.cos(angles), np.sin(angles)], axis=1))
    found.append(corners[-1:])
    return _sampled(np.concatenate(found))


def _sampled(points: Floats) -> Floats:
    lengths = np.hypot(*np.diff(points, axis=0).T)
    points = points[np.concatenate([[True], lengths > 1e-6])]
    parts = []
    for begin, end in pairwise(points):
        count = max(1, math.ceil(math.dist(begin, end) / STRAIGHT_M))
        parts.append(begin + np.linspace(0.0, 1.0, count, endpoint=False)[:, None] * (end - begin))
    return np.concatenate([*parts, points[-1:]])


def timed(points: Floats, speed_m_s: float, start_s: float = 0.0) -> Floats:
    """Line (M, 3) of points flown at a speed."""
    lengths = np.hypot(*np.diff(points, axis=0).T)
    return np.column_stack([points, start_s + np.concatenate([[0.0], lengths.cumsum()]) / speed_m_s])


def homeward(
    line: Floats, end: tuple[float, float], speed_m_s: float, radius_m: float, until_s: float
) -> Floats:
    """As much of a line as leaves time to get to its end, and the way there."""
    steps = np.diff(line[:, :2], axis=0)
    angles = np.arctan2(steps[:, 1], steps[:, 0])
    angles = np.concatenate([angles[:1], angles])
    for last in range(len(line) - 1, -1, -1):
        east, north, time_s = line[last]
        way_m = home_m(east, north, angles[last], *end, radius_m)
        if time_s + way_m / speed_m_s <= until_s + 1e-6:
            home = _to(east, north, float(angles[last]), end, radius_m)
            return np.concatenate([line[:last], timed(home, speed_m_s, float(time_s))])
    return line[:1]


def _to(east: float, north: float, angle: float, end: tuple[float, float], radius_m: float) -> Floats:
    """Points of the shortest arc and straight line to a place."""
    best: tuple[float, Floats] | None = None
    for side in (1.0, -1.0):
        centre = np.array(
            [east - side * radius_m * math.sin(angle), north + side * radius_m * math.cos(angle)]
        )
        away = math.dist(centre, end)
        if away < radius_m:
            continue
        leave = math.atan2(end[1] - centre[1], end[0] - centre[0]) - side * math.acos(radius_m / away)
        begin = angle - side * 0.5 * math.pi
        turn = (side * (leave - begin)) % math.tau
        turn = 0.0 if turn > math.tau - 1e-9 else turn
        length = radius_m * turn + math.sqrt(away * away - radius_m * radius_m)
        if best is None or length < best[0]:
            angles = begin + side * np.linspace(0.0, turn, max(2, math.ceil(radius_m * turn / STEP_M) + 1))
            arc = centre + radius_m * np.stack([np.cos(angles), np.sin(angles)], axis=1)
            best = (length, np.concatenate([arc, [end]]))
    return np.array([[east, north], end]) if best is None else _sampled(best[1])
