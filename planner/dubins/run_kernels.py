"""Compiled choice of the direction in which a flight leaves a place that it first flies straight on from.

Poses are float64 (N, 3): east_m, north_m, angle_rad. Discs as in ``estimate_kernels``.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from planner.dubins.estimate_kernels import detour_m
from planner.dubins.kernels import dubins_length
from planner.jit import njit

Floats = NDArray[np.float64]

NO_DISCS = np.empty((0, 3))
#: Directions no further apart than this may be flown between, too.
APART_RAD = math.tau / 47.0
#: Lengths change by a turn where an arc vanishes, and the shortest line is often just before that: so, about
#: so many of the best directions given, others are tried in ever smaller steps.
MINIMA, ROUNDS = 2, 9


@njit(cache=True)
def run_costs(
    e0: float, n0: float, run_m: float, runs_rad: Floats, entries: Floats, radius: float, discs: Floats
) -> tuple[Floats, Floats]:
    """Estimated lengths from a place by a straight run to poses, and the directions of the runs.

    Parameters
    ----------
    runs_rad
        Directions a run may have, ascending, within one turn, shape (K,).

    Returns
    -------
    tuple
        Lengths, run included, and directions; both (N,).
    """
    count = len(runs_rad)
    costs = np.empty(len(entries))
    angles = np.empty(len(entries))
    found = np.empty(count)
    for j in range(len(entries)):
        e1, n1, a1 = entries[j]
        if count > 1:
            # Where the line without a run begins with a longer straight, the run is part of it.
            direct_m, angle = _tangent(e0, n0, e1, n1, a1, radius, run_m)
            if direct_m < np.inf and _between(angle, runs_rad):
                costs[j] = direct_m + detour_m(e0, n0, e1, n1, discs)
                angles[j] = angle
                continue
        for k in range(count):
            found[k] = _by_run_m(e0, n0, run_m, runs_rad[k], e1, n1, a1, radius, discs)
        best = int(np.argmin(found))
        costs[j], angles[j] = found[best], runs_rad[best]
        for _ in range(MINIMA if count > 1 else 0):
            k = int(np.argmin(found))
            if not found[k] < np.inf:
                break
            before, after = (k - 1) % count, (k + 1) % count
            low, high = _gap(runs_rad[before], runs_rad[k]), _gap(runs_rad[k], runs_rad[after])
            middle, middle_m = runs_rad[k], found[k]
            least = middle - (low if low <= APART_RAD else 0.0)
            most = middle + (high if high <= APART_RAD else 0.0)
            found[before] = found[k] = found[after] = np.inf
            width = APART_RAD
            for _ in range(ROUNDS):
                at = middle
                for part in (-2.0 / 3.0, -1.0 / 3.0, 1.0 / 3.0, 2.0 / 3.0):
                    trial = min(max(at + part * width, least), most)
                    trial_m = _by_run_m(e0, n0, run_m, trial, e1, n1, a1, radius, discs)
                    if trial_m < middle_m:
                        middle, middle_m = trial, trial_m
                width *= 0.5
            if middle_m < costs[j]:
                costs[j], angles[j] = middle_m, middle
    return costs, angles


@njit(cache=True)
def _by_run_m(
    e0: float,
    n0: float,
    run_m: float,
    angle: float,
    e1: float,
    n1: float,
    a1: float,
    radius: float,
    discs: Floats,
) -> float:
    e, n = e0 + run_m * math.cos(angle), n0 + run_m * math.sin(angle)
    return run_m + dubins_length(e, n, angle, e1, n1, a1, radius) + detour_m(e, n, e1, n1, discs)


@njit(cache=True)
def _tangent(
    e0: float, n0: float, e1: float, n1: float, a1: float, radius: float, least_m: float
) -> tuple[float, float]:
    """The shortest line from a place to a pose, and its direction; inf where its straight is too short."""
    best, angle, fits = np.inf, 0.0, False
    for side in (1.0, -1.0):
        ce = e1 - side * radius * math.sin(a1)
        cn = n1 + side * radius * math.cos(a1)
        d = math.hypot(e0 - ce, n0 - cn)
        if d < radius:
            continue
        straight_m = math.sqrt(d * d - radius * radius)
        touch = math.atan2(n0 - cn, e0 - ce) + side * math.acos(min(1.0, radius / d))
        turn = side * (a1 - side * math.pi / 2.0 - touch)
        turn -= 2.0 * math.pi * math.floor(turn / (2.0 * math.pi))
        if turn > 2.0 * math.pi - 1e-9:
            turn = 0.0
        length_m = straight_m + radius * turn
        if length_m < best:
            best = length_m
            angle = touch + side * math.pi / 2.0
            fits = straight_m >= least_m
    return (best, angle) if fits else (np.inf, 0.0)


@njit(cache=True)
def _gap(one: float, other: float) -> float:
    """From one direction on to another, counter-clockwise."""
    return (other - one) % (2.0 * math.pi)


@njit(cache=True)
def _between(angle: float, runs_rad: Floats) -> bool:
    """Whether a run may have a direction."""
    at = _gap(runs_rad[0], angle)
    before = 0.0
    for k in range(1, len(runs_rad)):
        after = _gap(runs_rad[0], runs_rad[k])
        if at <= after:
            return after - before <= APART_RAD
        before = after
    return 2.0 * math.pi - before <= APART_RAD
