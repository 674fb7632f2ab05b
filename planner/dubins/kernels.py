"""Compiled lengths of Dubins lines; ``words.py`` is the plain twin and cites the equations.

A line from many poses to many needs one sine and one cosine a pose, then a square root a word. Angles cost
most: LSL and RSR are decided by signs without one, and a word is given up as soon as what is known of it,
its middle part and the quadrants of its arcs, is longer than the best line so far.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

FULL_TURN_SNAP = 1e-9
#: Arcs nearer to a full turn than this, in radians, may be arcs of no length: the angles themselves decide.
NEAR = 1e-6
TWO_PI = 2.0 * math.pi
HALF_PI = 0.5 * math.pi

Array = NDArray[np.float64]


@njit(cache=True, inline="always")
def _arc(turn_rad: float, straight_radii: float) -> float:
    turn_rad -= TWO_PI * math.floor(turn_rad / TWO_PI)
    if (TWO_PI - turn_rad) * (1.0 + straight_radii) < FULL_TURN_SNAP:
        return 0.0
    return turn_rad


@njit(cache=True, inline="always")
def _quarters_rad(cosine: float, sine: float, noise: float) -> float:
    """The multiple of π/2 at or below an angle in [0, 2π) given by its cosine and sine, of any scale.

    A sine within ``noise`` of 0 may belong to an arc of no length.
    """
    if sine >= -noise:
        return 0.0 if cosine >= 0.0 else HALF_PI
    return math.pi if cosine < 0.0 else 1.5 * math.pi


@njit(cache=True)
def _length_radii(
    de: float, dn: float, alpha: float, sa: float, ca: float, beta: float, sb: float, cb: float
) -> float:
    """Length in radii of the shortest word for an offset (de, dn) in radii."""
    best = np.inf
    turned = beta - alpha
    turned -= TWO_PI * math.floor(turned / TWO_PI)
    least = min(turned, TWO_PI - turned)
    nearest = np.inf
    for k in range(2):
        # LSL, RSR: t + q is the turn w from pose to pose, or, where the straight's direction does not lie
        # on that turn, a full turn more; which of them, signs tell but where an arc may be of no length.
        s = 1.0 - 2.0 * k
        ce = de - s * sb + s * sa
        cn = dn + s * cb - s * ca
        p = math.sqrt(ce * ce + cn * cn)
        nearest = min(nearest, p)
        if p < FULL_TURN_SNAP:
            best = min(best, _arc(s * (beta - alpha), 0.0))
            continue
        w = turned if k == 0 else TWO_PI - turned
        if p + w - NEAR >= best and least > NEAR:
            continue
        sine_t = s * (ca * cn - sa * ce)
        sine_q = s * (sb * ce - cb * cn)
        if least < NEAR or abs(sine_t) < NEAR * p or abs(sine_q) < NEAR * p:
            phi = math.atan2(cn, ce)
            best = min(best, _arc(s * (phi - alpha), p) + p + _arc(s * (beta - phi), p))
            continue
        between = sine_q > 0.0 if (sine_t > 0.0) == (w < math.pi) else sine_t > 0.0
        best = min(best, w + p if between else w + TWO_PI + p)
    for k in range(2):
        # LSR, RSL: t and q differ by the turn from pose to pose, or by what is left of a full turn.
        s = 1.0 - 2.0 * k
        ce = de + s * sb + s * sa
        cn = dn - s * cb - s * ca
        square = ce * ce + cn * cn - 4.0
        if square < -FULL_TURN_SNAP:
            continue
        p = math.sqrt(max(square, 0.0))
        if p + (least if least > NEAR else 0.0) - NEAR >= best:
            continue
        ue = p * ce - 2.0 * s * cn
        un = 2.0 * s * ce + p * cn
        noise = NEAR * (square + 4.0)
        quarters = _quarters_rad(ca * ue + sa * un, s * (ca * un - sa * ue), noise)
        quarters += _quarters_rad(cb * ue + sb * un, s * (cb * un - sb * ue), noise)
        if p + quarters - NEAR >= best:
            continue
        phi = math.atan2(un, ue)
        best = min(best, _arc(s * (phi - alpha), p) + p + _arc(s * (phi - beta), p))
    if nearest > 4.0 or best <= math.pi:
        # The middle arc of LRL and RLR is more than half a turn.
        return best
    for k in range(2):
        s = 1.0 - 2.0 * k
        ce = de - s * sb + s * sa
        cn = dn + s * cb - s * ca
        p = math.sqrt(ce * ce + cn * cn)
        # acos x >= (1 - x) π/2
        if p < FULL_TURN_SNAP or p > 4.0 or TWO_PI - 0.25 * math.pi * p >= best:
            continue
        middle = 2.0 * math.acos(p / 4.0) + math.pi
        if middle >= best:
            continue
        w = s * (beta - alpha) + middle
        w -= TWO_PI * math.floor(w / TWO_PI)
        if NEAR < w < TWO_PI - NEAR and middle + w - NEAR >= best:
            continue
        phi = math.atan2(cn, ce)
        lean = 0.5 * middle
        best = min(best, _arc(s * (phi - alpha) + lean, 0.0) + middle + _arc(s * (beta - phi) + lean, 0.0))
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
