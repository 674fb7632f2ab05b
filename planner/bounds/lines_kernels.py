"""Compiled parts of the lower bound: lines between cells of passes. Numbers only.

A line between passes of two cells is bounded over all passes of both by the mean value theorem: its length
between the middle passes, less what it can lose by its gradient anywhere in the cells. The gradient of a
Dubins line turn–straight–turn is known: by its end's place it is the direction of the straight, by the end's
heading what the turn reaches aside of the straight, R·(1 − cos τ) for a turn by τ.

*Slopes* are added at one end of a pass and taken away at the other, so that no tour gets longer or shorter
by them: a line out of a cell costs ``slope · (x, y)`` more, a line into it that much less, (x, y) being where
in its cell the pass lies. With slopes near the gradients, what a line out wins by a shifted pass is what the
line in loses, and no longer given away twice.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from planner.bounds.cells_kernels import (
    ALPHA,
    COS,
    ENTRY,
    EXIT,
    INNER,
    INNER_DEV,
    INNER_GAIN,
    INNER_JUMP,
    LOOSE,
    REACH,
    SIN,
    THETA,
    WIDTH,
    X_DEV,
    X_E,
    X_JUMP,
    X_N,
    Y_DEV,
    Y_E,
    Y_N,
    E,
    N,
)
from planner.jit import njit

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

TWO_PI = 2.0 * math.pi
#: Headings asked for are flown to within this, rad.
SAME_RAD = 2e-4


@njit(cache=True)
def _wrapped(turn: float) -> float:
    """From 0 to 2π."""
    return turn - TWO_PI * math.floor(turn / TWO_PI)


@njit(cache=True)
def _turn_least(turn: float, slack: float) -> float:
    """Least of a turn known to within ``slack``: none at all where it may be a full one or less than none."""
    turn = _wrapped(turn)
    if turn + slack >= TWO_PI:
        return 0.0
    return max(turn - slack, 0.0)


@njit(cache=True)
def _signed(turn: float, slack: float) -> float:
    """A turn at the middle, less than none where it may be none: beyond, a turn to the other side is shorter.

    A full turn less a little is never part of a shortest line; a little less than none continues the word
    smoothly, below what is really flown there.
    """
    turn = _wrapped(turn)
    return turn - TWO_PI if turn + slack >= TWO_PI else turn


@njit(cache=True)
def _aside(cell: Floats, end: int, cos: float, sin: float) -> float:
    """How far an end can lie off its middle across a direction."""
    by_x = abs(cos * cell[end + X_N] - sin * cell[end + X_E]) + cell[end + X_DEV] + cell[end + X_JUMP]
    return float(by_x + abs(cos * cell[Y_N] - sin * cell[Y_E]) + cell[Y_DEV] + cell[LOOSE])


@njit(cache=True)
def _losses(
    cell: Floats,
    end: int,
    slope_x: float,
    slope_y: float,
    cos: float,
    sin: float,
    sense: float,
    off: float,
    radius: float,
    share: float,
) -> tuple[float, float, float]:
    """What a word can lose over one of its cells, and its gradient there by x and y, without the slopes.

    Parameters
    ----------
    cos, sin
        Direction of the straight; backwards for a line that leaves the cell, so that it is the gradient.
    sense
        How the gradient of the turn at this end by the heading is signed.
    off
        By how much the direction can differ.
    share
        Of what the gradient gains evenly from the middle outwards, the mean counts: a half.
    """
    alpha = cell[ALPHA]
    x_e, x_n, y_e, y_n = cell[end + X_E], cell[end + X_N], cell[Y_E], cell[Y_N]
    ahead_x, ahead_y = cos * x_e + sin * x_n, cos * y_e + sin * y_n
    turned_cos = cos * cell[COS] + sin * cell[SIN]
    if end == EXIT:
        turned_cos = -turned_cos
    turned_sin = abs(sin * cell[COS] - cos * cell[SIN])
    gain_x = ahead_x + sense * alpha * radius * (1.0 - turned_cos)
    # A direction that differs by ω counts (1 − cos ω) of what lies along it and sin ω of what lies across.
    along = 0.5 * off * off
    even = off * (abs(cos * x_n - sin * x_e) + abs(cos * y_n - sin * y_e)) + cell[end + X_DEV] + cell[Y_DEV]
    even += along * (abs(ahead_x) + abs(ahead_y))
    more = off + alpha
    even += alpha * radius * min(turned_sin * more + 0.5 * more * more, 2.0)
    jump = cell[end + X_JUMP] + cell[LOOSE]
    if end == ENTRY:
        gain_x += cell[INNER_GAIN]
        even += cell[INNER_DEV]
        jump += cell[INNER_JUMP]
    return abs(gain_x + slope_x) + abs(ahead_y + slope_y) + share * even + jump, gain_x, ahead_y


@njit(cache=True)
def _three_turns(
    s: float, t0: float, t1: float, a0: float, a1: float, ce: float, cn: float, slack: float, radius: float
) -> float:
    """Least of three turns, the middle one more than half round and the other way, by intervals alone.

    The middle turn's centre is two radii from both others: seen from either at an angle γ to the line between
    them, of which the cosine is a quarter of their distance in radii.
    """
    d = math.hypot(ce, cn)
    wide = math.acos(min(max(d - slack, 0.0) / (4.0 * radius), 1.0))
    narrow = math.acos(min((d + slack) / (4.0 * radius), 1.0))
    gamma, gamma_off = 0.5 * (wide + narrow), 0.5 * (wide - narrow)
    bearing = math.atan2(cn, ce)
    off = gamma_off + (math.asin(slack / d) if slack < d else math.pi)
    turn0 = _turn_least(s * (bearing - t0) + gamma + 0.5 * math.pi, off + a0)
    turn1 = _turn_least(s * (t1 - bearing) + gamma + 0.5 * math.pi, off + a1)
    return radius * (turn0 + math.pi + 2.0 * narrow + turn1)


@njit(cache=True)
def between(
    here: Floats,
    there: Floats,
    slope0: Floats,
    slope1: Floats,
    radius: float,
    gains: Floats,
) -> float:
    """Least cost from the exits of one cell to the exits of another, over all their passes.

    Parameters
    ----------
    here, there
        Cells, (``WIDTH``,).
    slope0, slope1
        Their slopes by x and y, (2,).
    gains
        Is given the gradient of the word that bounds: by x and y of ``here``, then of ``there``; (4,).

    Returns
    -------
    float
        A lower bound of the line's length plus the inner cost of the pass it leads to plus ``slope0`` times
        where the former pass lies less ``slope1`` times where the latter does.
    """
    e = there[ENTRY + E] - here[EXIT + E]
    n = there[ENTRY + N] - here[EXIT + N]
    t0, t1, a0, a1 = here[THETA], there[THETA], here[ALPHA], there[ALPHA]
    loose = here[LOOSE] + there[LOOSE]
    slack = here[EXIT + REACH] + there[ENTRY + REACH] + loose
    apart = max(math.hypot(e, n) - slack, 0.0)
    slack += radius * (a0 + a1)
    share = 0.5 if loose == 0.0 else 1.0
    inner = there[INNER]
    # Where nothing better is known: least inner cost, all slopes against us.
    flat = inner - abs(there[INNER_GAIN] - slope1[0]) - there[INNER_DEV] - there[INNER_JUMP]
    flat -= abs(slope0[0]) + abs(slope0[1]) + abs(slope1[1])
    best = np.inf
    gains[:] = 0.0
    for k in range(4):
        s0 = 1.0 if k < 2 else -1.0
        s1 = 1.0 if k % 2 == 0 else -1.0
        ce = e - s1 * radius * there[SIN] + s0 * radius * here[SIN]
        cn = n + s1 * radius * there[COS] - s0 * radius * here[COS]
        d = math.hypot(ce, cn)
        low, high = d - slack, d + slack
        shift = 0.0 if s0 == s1 else 2.0 * radius
        if high < shift:
            continue
        # With intervals alone: the straight and, both turning one way, the sum of the turns are known.
        word = math.sqrt(max(max(low, 0.0) ** 2 - shift * shift, 0.0))
        if s0 == s1:
            word += radius * _turn_least(s0 * (t1 - t0), a0 + a1)
        else:
            turned = _wrapped(t1 - t0)
            word += radius * max(min(turned, TWO_PI - turned) - a0 - a1, 0.0)
        word = max(word, apart) + flat
        if low > shift and slack < d:
            lean, lean_off = 0.0, 0.0
            straight = d
            if s0 != s1:
                straight = math.sqrt(d * d - shift * shift)
                lean = math.asin(shift / d)
                lean_off = math.asin(shift / low) - lean
            direction = math.atan2(cn, ce) + s0 * lean
            # Seen from one centre the other lies off by what is across, no nearer than ``low``.
            across = _aside(here, EXIT, ce / d, cn / d) + _aside(there, ENTRY, ce / d, cn / d)
            off = (across + radius * (a0 + a1)) / low + lean_off
            turn0 = _signed(s0 * (direction - t0), off + a0)
            turn1 = _signed(s1 * (t1 - direction), off + a1)
            # The straight's direction is the one between the centres turned by the lean.
            along, aside = straight / d, s0 * math.sqrt(max(1.0 - straight * straight / (d * d), 0.0))
            cos, sin = (ce * along - cn * aside) / d, (cn * along + ce * aside) / d
            lost0, x0, y0 = _losses(here, EXIT, slope0[0], slope0[1], -cos, -sin, -s0, off, radius, share)
            lost1, x1, y1 = _losses(there, ENTRY, -slope1[0], -slope1[1], cos, sin, s1, off, radius, share)
            fine = straight + radius * (turn0 + turn1) + inner - lost0 - lost1
            if fine > word:
                word = fine
            if word < best:
                gains[0], gains[1], gains[2], gains[3] = x0, y0, x1, y1
        best = min(best, word)
        if s0 == s1 and low < 4.0 * radius:
            best = min(best, max(_three_turns(s0, t0, t1, a0, a1, ce, cn, slack, radius), apart) + flat)
    return best


@njit(cache=True)
def from_place(
    e0: float, n0: float, cell: Floats, end: int, slope: Floats, radius: float, gains: Floats
) -> float:
    """The same from a place left in any direction to a cell's entries, or from its exits to such a place.

    ``gains``, (2,), is given the gradient by x and y. Inner costs count at the entry.
    """
    arriving = end == ENTRY
    # A line flown backwards is as long.
    t1 = cell[THETA] if arriving else cell[THETA] + math.pi
    a1 = cell[ALPHA]
    e, n = cell[end + E] - e0, cell[end + N] - n0
    slack = cell[end + REACH] + cell[LOOSE]
    apart = max(math.hypot(e, n) - slack, 0.0)
    slack += radius * a1
    share = 0.5 if cell[LOOSE] == 0.0 else 1.0
    sign = -1.0 if arriving else 1.0
    inner = cell[INNER] if arriving else 0.0
    flat = inner - abs(slope[1])
    if arriving:
        flat -= abs(cell[INNER_GAIN] - slope[0]) + cell[INNER_DEV] + cell[INNER_JUMP]
    else:
        flat -= abs(slope[0])
    best = np.inf
    gains[:] = 0.0
    for k in range(2):
        s = 1.0 - 2.0 * k
        ce = e - s * radius * math.sin(t1)
        cn = n + s * radius * math.cos(t1)
        d = math.hypot(ce, cn)
        low = d - slack
        if low <= radius:
            return float(apart + flat)
        lean = math.asin(radius / d)
        off = (_aside(cell, end, ce / d, cn / d) + radius * a1) / low + math.asin(radius / low) - lean
        direction = math.atan2(cn, ce) - s * lean
        turn = _signed(s * (t1 - direction), off + a1)
        cos, sin = math.cos(direction), math.sin(direction)
        # Backwards the line arrives where the pass leaves: of its heading only the direction is turned round.
        lost, x, y = _losses(cell, end, sign * slope[0], sign * slope[1], cos, sin, s, off, radius, share)
        word = max(math.sqrt(d * d - radius * radius) + radius * turn + inner - lost, apart + flat)
        if word < best:
            best, gains[0], gains[1] = word, x, y
    return best


@njit(cache=True)
def from_terminal(
    terminal: Floats, cell: Floats, end: int, slope: Floats, radius: float, gains: Floats
) -> float:
    """The same from a terminal to a cell's entries, or from its exits to it.

    ``terminal`` is (4,): east, north, 1 where its heading is fixed, heading.
    """
    if terminal[2] == 0.0:
        return from_place(terminal[0], terminal[1], cell, end, slope, radius, gains)
    pose, none, four = np.zeros(WIDTH), np.zeros(2), np.zeros(4)
    pose[THETA] = terminal[3]
    pose[COS], pose[SIN] = math.cos(terminal[3]), math.sin(terminal[3])
    pose[ENTRY + E], pose[ENTRY + N] = terminal[0], terminal[1]
    pose[EXIT + E], pose[EXIT + N] = terminal[0], terminal[1]
    if end == ENTRY:
        least = between(pose, cell, none, slope, radius, four)
        gains[0], gains[1] = four[2], four[3]
    else:
        least = between(cell, pose, slope, none, radius, four)
        gains[0], gains[1] = four[0], four[1]
    return least


@njit(cache=True)
def together(here: Floats, there: Floats) -> bool:
    """Whether two cells hold passes at the same or at opposite headings."""
    apart = here[THETA] - there[THETA]
    apart -= math.pi * math.floor(apart / math.pi + 0.5)
    return bool(abs(apart) <= here[ALPHA] + there[ALPHA] + 1e-9)


@njit(cache=True)
def along(here: Floats, there: Floats, slope0: Floats, slope1: Floats) -> float:
    """The same where a pass of either cell is part of one longer pass: straight on from exit to exit.

    Both lie on one line then, flown one way; inf where none of the cells do.
    """
    apart = here[THETA] - there[THETA]
    apart -= TWO_PI * math.floor(apart / TWO_PI + 0.5)
    if abs(apart) > here[ALPHA] + there[ALPHA] + SAME_RAD:
        return np.inf
    e = there[EXIT + E] - here[EXIT + E]
    n = there[EXIT + N] - here[EXIT + N]
    loose = here[LOOSE] + there[LOOSE]
    slack = here[EXIT + REACH] + there[EXIT + REACH] + loose
    far = math.hypot(e, n)
    aside = abs(here[COS] * n - here[SIN] * e)
    ahead = here[COS] * e + here[SIN] * n
    off = math.sin(min(here[ALPHA] + SAME_RAD, 0.5 * math.pi)) * (far + slack)
    if aside > slack + off or ahead < -slack - off:
        return np.inf
    flat = abs(slope0[0]) + abs(slope0[1]) + abs(slope1[0]) + abs(slope1[1])
    best = max(far - slack, 0.0) - flat
    if far > slack:
        cos, sin = e / far, n / far
        turned = (_aside(here, EXIT, cos, sin) + _aside(there, EXIT, cos, sin)) / (far - slack)
        share = 0.5 if loose == 0.0 else 1.0
        # A line without turns: its radius counts for nothing.
        lost0, _, _ = _losses(here, EXIT, slope0[0], slope0[1], -cos, -sin, 0.0, turned, 0.0, share)
        lost1, _, _ = _losses(there, EXIT, -slope1[0], -slope1[1], cos, sin, 0.0, turned, 0.0, share)
        best = max(best, far - lost0 - lost1)
    return float(best)
