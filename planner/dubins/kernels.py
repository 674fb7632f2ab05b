"""Compiled lengths of Dubins lines, and the cheapest way through a row of them.

``words.py`` is the plain twin and cites the equations.

A line from many poses to many needs one sine and one cosine a pose, then a square root a word. Angles cost
most: LSL and RSR are decided by signs without one, and a word is given up as soon as what is known of it,
its middle part and the quadrants of its arcs, is longer than the best line so far. ``dubins_lengths`` takes
pairs by blocks, the sines and all that needs no angle in loops without branches over one flat array, which
compilers turn into vector instructions; what is left is done pair by pair.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from planner.jit import njit

FULL_TURN_SNAP = 1e-9
#: Arcs nearer to a full turn than this, in radians, may be arcs of no length: the angles themselves decide.
NEAR = 1e-6
TWO_PI = 2.0 * math.pi
HALF_PI = 0.5 * math.pi
ONE_AND_A_HALF_PI = 1.5 * math.pi

#: Pairs in a block, and where in the flat array each quantity of a block begins.
BLOCK = 256
DE, DN, ALPHA, BETA = 0, BLOCK, 2 * BLOCK, 3 * BLOCK
SIN_A, COS_A, SIN_B, COS_B = 4 * BLOCK, 5 * BLOCK, 6 * BLOCK, 7 * BLOCK
BEST, NEAREST = 8 * BLOCK, 9 * BLOCK
#: For LSR, and ``CROSS`` further for RSL: least length, tangent as a vector, straight.
LEAST, TANGENT_E, TANGENT_N, STRAIGHT = 10 * BLOCK, 11 * BLOCK, 12 * BLOCK, 13 * BLOCK
CROSS = 4 * BLOCK
ROOM = 18 * BLOCK

#: π/2 in parts, the first short enough for exact multiples up to ``LARGEST_RAD``.
HALF_PI_HIGH, HALF_PI_MIDDLE, HALF_PI_LOW = 1.5707963267341256, 6.077100506303966e-11, 2.0222662487959506e-21
LARGEST_RAD = 1e5

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
    return dubins_length_by_sines(
        e0, n0, a0, math.sin(a0), math.cos(a0), e1, n1, a1, math.sin(a1), math.cos(a1), radius
    )


@njit(cache=True)
def dubins_length_by_sines(
    e0: float,
    n0: float,
    a0: float,
    s0: float,
    c0: float,
    e1: float,
    n1: float,
    a1: float,
    s1: float,
    c1: float,
    radius: float,
) -> float:
    """The same where sine and cosine of both angles are known."""
    return radius * _length_radii((e1 - e0) / radius, (n1 - n0) / radius, a0, s0, c0, a1, s1, c1)


@njit(cache=True, error_model="numpy")
def _sines(x: Array, angles: int, sines: int, count: int) -> None:
    """Sines, and cosines a block further, of angles: Taylor's series within π/4 of multiples of π/2."""
    for i in range(count):
        k = math.floor(x[angles + i] * (2.0 / math.pi) + 0.5)
        r = ((x[angles + i] - k * HALF_PI_HIGH) - k * HALF_PI_MIDDLE) - k * HALF_PI_LOW
        z = r * r
        tail = -1.0 / 1307674368000.0 + z / 355687428096000.0
        tail = -1.0 / 39916800.0 + z * (1.0 / 6227020800.0 + z * tail)
        sine = r + r * z * (
            -1.0 / 6.0 + z * (1.0 / 120.0 + z * (-1.0 / 5040.0 + z * (1.0 / 362880.0 + z * tail)))
        )
        tail = -1.0 / 87178291200.0 + z / 20922789888000.0
        tail = -1.0 / 3628800.0 + z * (1.0 / 479001600.0 + z * tail)
        cosine = 1.0 + z * (-0.5 + z * (1.0 / 24.0 + z * (-1.0 / 720.0 + z * (1.0 / 40320.0 + z * tail))))
        quarter = k - 4.0 * math.floor(0.25 * k)
        odd = quarter - 2.0 * math.floor(0.5 * quarter) > 0.5
        first = cosine if odd else sine
        second = sine if odd else cosine
        x[sines + i] = -first if quarter > 1.5 else first
        x[sines + BLOCK + i] = -second if abs(quarter - 1.5) < 1.0 else second


@njit(cache=True, inline="always", error_model="numpy")
def _quarters(cosine: float, sine: float, noise: float) -> float:
    """``_quarters_rad`` without a branch."""
    above = 0.0 if cosine >= 0.0 else HALF_PI
    below = math.pi if cosine < 0.0 else ONE_AND_A_HALF_PI
    return above if sine >= -noise else below


@njit(cache=True, error_model="numpy")
def _screen(x: Array, count: int) -> None:
    """What ``_length_radii`` finds without angles, for ``count`` pairs.

    ``BEST`` gets the shorter of LSL and RSR, ``NEAREST`` the lesser of their straights, -1 where an arc may
    be of no length; from ``LEAST`` on come LSR and RSL.
    """
    for i in range(count):
        de, dn = x[DE + i], x[DN + i]
        sa, ca, sb, cb = x[SIN_A + i], x[COS_A + i], x[SIN_B + i], x[COS_B + i]
        left = x[BETA + i] - x[ALPHA + i]
        left -= TWO_PI * math.floor(left / TWO_PI)
        right = TWO_PI - left
        least = min(left, right)
        ce, cn = de - sb + sa, dn + cb - ca
        p = math.sqrt(ce * ce + cn * cn)
        sine_t, sine_q = ca * cn - sa * ce, sb * ce - cb * cn
        unsure = (least < NEAR) | (p < NEAR) | (abs(sine_t) < NEAR * p) | (abs(sine_q) < NEAR * p)
        between = sine_q if (sine_t > 0.0) == (left < math.pi) else sine_t
        best = left + p if between > 0.0 else left + TWO_PI + p
        nearest = p
        ce, cn = de + sb - sa, dn - cb + ca
        p = math.sqrt(ce * ce + cn * cn)
        sine_t, sine_q = sa * ce - ca * cn, cb * cn - sb * ce
        unsure = unsure | (p < NEAR) | (abs(sine_t) < NEAR * p) | (abs(sine_q) < NEAR * p)
        unsure = unsure | (abs(x[ALPHA + i]) > LARGEST_RAD) | (abs(x[BETA + i]) > LARGEST_RAD)
        between = sine_q if (sine_t > 0.0) == (right < math.pi) else sine_t
        x[BEST + i] = min(best, right + p if between > 0.0 else right + TWO_PI + p)
        x[NEAREST + i] = -1.0 if unsure else min(nearest, p)
        ce, cn = de + sb + sa, dn - cb - ca
        square = ce * ce + cn * cn - 4.0
        p = math.sqrt(max(square, 0.0))
        ue, un = p * ce - 2.0 * cn, 2.0 * ce + p * cn
        noise = NEAR * (square + 4.0)
        bound = _quarters(ca * ue + sa * un, ca * un - sa * ue, noise)
        bound += _quarters(cb * ue + sb * un, cb * un - sb * ue, noise)
        x[LEAST + i] = p + max(bound, least) - NEAR if square >= -FULL_TURN_SNAP else np.inf
        x[TANGENT_E + i], x[TANGENT_N + i], x[STRAIGHT + i] = ue, un, p
        ce, cn = de - sb - sa, dn + cb + ca
        square = ce * ce + cn * cn - 4.0
        p = math.sqrt(max(square, 0.0))
        ue, un = p * ce + 2.0 * cn, p * cn - 2.0 * ce
        noise = NEAR * (square + 4.0)
        bound = _quarters(ca * ue + sa * un, sa * ue - ca * un, noise)
        bound += _quarters(cb * ue + sb * un, sb * ue - cb * un, noise)
        x[CROSS + LEAST + i] = p + max(bound, least) - NEAR if square >= -FULL_TURN_SNAP else np.inf
        x[CROSS + TANGENT_E + i], x[CROSS + TANGENT_N + i], x[CROSS + STRAIGHT + i] = ue, un, p


@njit(cache=True)
def dubins_lengths(starts: Array, goals: Array, radius: float) -> Array:
    """Lengths in metres, shape (N,), from each of ``starts`` to its like of ``goals``, both (N, 3).

    Columns are east_m, north_m, angle_rad.
    """
    total = starts.shape[0]
    lengths = np.empty(total)
    x = np.empty(ROOM)
    for first in range(0, total, BLOCK):
        count = min(BLOCK, total - first)
        for i in range(count):
            start, goal = starts[first + i], goals[first + i]
            x[DE + i] = (goal[0] - start[0]) / radius
            x[DN + i] = (goal[1] - start[1]) / radius
            x[ALPHA + i], x[BETA + i] = start[2], goal[2]
        _sines(x, ALPHA, SIN_A, count)
        _sines(x, BETA, SIN_B, count)
        _screen(x, count)
        for i in range(count):
            alpha, beta, best = x[ALPHA + i], x[BETA + i], x[BEST + i]
            if x[NEAREST + i] <= 4.0:
                sa, ca, sb, cb = x[SIN_A + i], x[COS_A + i], x[SIN_B + i], x[COS_B + i]
                if x[NEAREST + i] < 0.0:
                    sa, ca, sb, cb = math.sin(alpha), math.cos(alpha), math.sin(beta), math.cos(beta)
                best = _length_radii(x[DE + i], x[DN + i], alpha, sa, ca, beta, sb, cb)
            else:
                if x[LEAST + i] < best:
                    phi, p = math.atan2(x[TANGENT_N + i], x[TANGENT_E + i]), x[STRAIGHT + i]
                    best = min(best, _arc(phi - alpha, p) + p + _arc(phi - beta, p))
                if x[CROSS + LEAST + i] < best:
                    phi = math.atan2(x[CROSS + TANGENT_N + i], x[CROSS + TANGENT_E + i])
                    p = x[CROSS + STRAIGHT + i]
                    best = min(best, _arc(alpha - phi, p) + p + _arc(beta - phi, p))
            lengths[first + i] = radius * best
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


@njit(cache=True)
def cheapest_steps(costs: Array) -> NDArray[np.int64]:
    """The forerunner of each node on its cheapest way from the first, int64 (N,); steps go forward alone.

    ``costs`` is float64, shape (N, N), read above the diagonal. Of two ways at one cost the one over the
    earlier forerunner is taken; node 0 has itself.
    """
    count = costs.shape[0]
    totals = np.full(count, np.inf)
    before = np.zeros(count, dtype=np.int64)
    totals[0] = 0.0
    for j in range(1, count):
        for i in range(j):
            through = totals[i] + costs[i, j]
            if through < totals[j]:
                totals[j], before[j] = through, i
    return before
