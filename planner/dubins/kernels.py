"""Compiled lengths of Dubins lines; ``words.py`` is the plain twin and cites the equations.

A line from many poses to many needs one sine and one cosine a pose, then one square root and one arctangent a
word; words whose middle part alone is longer than the best line so far are not finished.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

FULL_TURN_SNAP = 1e-9
TWO_PI = 2.0 * math.pi
HALF_PI = 0.5 * math.pi

Array = NDArray[np.float64]


@njit(cache=True, inline="always")
def _arc(turn_rad: float, straight_radii: float) -> float:
    turn_rad -= TWO_PI * math.floor(turn_rad / TWO_PI)
    if (TWO_PI - turn_rad) * (1.0 + straight_radii) < FULL_TURN_SNAP:
        return 0.0
    return turn_rad


@njit(cache=True)
def _length_radii(
    de: float, dn: float, alpha: float, sa: float, ca: float, beta: float, sb: float, cb: float
) -> float:
    """Length in radii of the shortest word for an offset (de, dn) in radii."""
    best = np.inf
    for k in range(2):
        s = 1.0 - 2.0 * k
        ce = de - s * sb + s * sa
        cn = dn + s * cb - s * ca
        square = ce * ce + cn * cn
        p = math.sqrt(square)
        if p < FULL_TURN_SNAP:
            best = min(best, _arc(s * (beta - alpha), 0.0))
            continue
        if p >= best and p > 4.0:
            continue
        phi = math.atan2(cn, ce)
        if p < best:
            best = min(best, _arc(s * (phi - alpha), p) + p + _arc(s * (beta - phi), p))
        if p <= 4.0:
            lean = math.acos(p / 4.0) + HALF_PI
            if 2.0 * lean < best:
                best = min(
                    best,
                    _arc(s * (phi - alpha) + lean, 0.0) + 2.0 * lean + _arc(s * (beta - phi) + lean, 0.0),
                )
    for k in range(2):
        s = 1.0 - 2.0 * k
        ce = de + s * sb + s * sa
        cn = dn - s * cb - s * ca
        square = ce * ce + cn * cn - 4.0
        if square < -FULL_TURN_SNAP:
            continue
        p = math.sqrt(max(square, 0.0))
        if p >= best:
            continue
        phi = math.atan2(2.0 * s * ce + p * cn, p * ce - 2.0 * s * cn)
        best = min(best, _arc(s * (phi - alpha), p) + p + _arc(s * (phi - beta), p))
    return best


@njit(cache=True)
def dubins_length(e0: float, n0: float, a0: float, e1: float, n1: float, a1: float, radius: float) -> float:
    """Length in metres of the shortest line from pose (e0, n0, a0) to (e1, n1, a1), turns of ``radius``."""
    return radius * _length_radii(
        (e1 - e0) / radius,
        (n1 - n0) / radius,
        a0,
        math.sin(a0),
        math.cos(a0),
        a1,
        math.sin(a1),
        math.cos(a1),
    )


@njit(cache=True)
def dubins_lengths(starts: Array, goals: Array, radius: float) -> Array:
    """Lengths in metres, shape (N,), from each of ``starts`` to its like of ``goals``, both (N, 3).

    Columns are east_m, north_m, angle_rad.
    """
    count = starts.shape[0]
    lengths = np.empty(count)
    for i in range(count):
        lengths[i] = dubins_length(
            starts[i, 0], starts[i, 1], starts[i, 2], goals[i, 0], goals[i, 1], goals[i, 2], radius
        )
    return lengths


@njit(cache=True)
def dubins_matrix(starts: Array, goals: Array, radius: float) -> Array:
    """Lengths in metres, shape (N, M), from each of ``starts`` (N, 3) to each of ``goals`` (M, 3).

    Columns are east_m, north_m, angle_rad.
    """
    rows, columns = starts.shape[0], goals.shape[0]
    sines = np.sin(goals[:, 2])
    cosines = np.cos(goals[:, 2])
    lengths = np.empty((rows, columns))
    for i in range(rows):
        e0, n0, a0 = starts[i, 0], starts[i, 1], starts[i, 2]
        sa, ca = math.sin(a0), math.cos(a0)
        for j in range(columns):
            lengths[i, j] = radius * _length_radii(
                (goals[j, 0] - e0) / radius,
                (goals[j, 1] - n0) / radius,
                a0,
                sa,
                ca,
                goals[j, 2],
                sines[j],
                cosines[j],
            )
    return lengths
