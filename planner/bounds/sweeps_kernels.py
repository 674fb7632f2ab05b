"""Compiled parts of the lower bound for whole regions: what their strips cost, and how far apart they are.

A *stay* at a region is all its passes at one heading, or at its opposite: so many strips side by side. What
it takes at least are its passes and a turn between any two. Numbers only.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from planner.bounds.cells_kernels import (
    ENTRY,
    EXIT,
    HOLDS,
    INNER,
    INNER_DEV,
    INNER_GAIN,
    INNER_JUMP,
    LONG,
    LOOSE,
    REACH,
    STRIP,
    WIDTH,
    E,
    N,
    by_heading,
    cell,
    support,
)
from planner.bounds.sets_kernels import LEAST_X, LEAST_Y, MOST_X, MOST_Y
from planner.jit import njit

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

#: Turns of more strips than this are each taken for the least there is.
MOST_ORDERED = 8


@njit(cache=True)
def back_m(least: float, most: float, radius: float) -> float:
    """Least to turn back onto a line beside the one flown on, somewhere between two distances from it.

    The shortest way to a line, wherever along it, ends with nothing to gain along the line: its straight, if
    it has one, is at a right angle to it (Pontryagin). Two quarter turns and a straight are π·R and what the
    distance is beyond 2·R; nearer, a turn away by φ and one back by π + φ, 2·R·cos φ being the distance.
    """
    off = min(max(2.0 * radius, least), most)
    if off >= 2.0 * radius:
        return math.pi * radius + off - 2.0 * radius
    return radius * (math.pi + 2.0 * math.acos(max(off, 0.0) / (2.0 * radius)))


@njit(cache=True)
def _apart(least: float, most: float) -> tuple[float, float]:
    """Least and most of the size of what lies between two values."""
    if least <= 0.0 <= most:
        return 0.0, max(-least, most)
    return min(abs(least), abs(most)), max(abs(least), abs(most))


@njit(cache=True)
def _backs(
    count: int,
    step: tuple[float, float],
    flip: tuple[float, float],
    looks: Floats,
    radius: float,
    out: Floats,
) -> None:
    """Least to turn back from one strip into another, (2, 2·count − 1): way before; strips to the right.

    ``step`` is from how far to how far neighbouring strips lie apart, ``flip`` by how much the lines on
    either side of one strip do, ``looks`` the sides seen: 1 to the right, −1 to the left.
    """
    for k in range(1 - count, count):
        low, high = min(k * step[0], k * step[1]), max(k * step[0], k * step[1])
        for way in range(2):
            best = np.inf
            for look in looks:
                # Seen to the right, the line onward lies left of its strip, the line back right of it.
                if (look > 0.0) == (way == 0):
                    off = _apart(low + flip[0], high + flip[1])
                else:
                    off = _apart(low - flip[1], high - flip[0])
                best = min(best, back_m(off[0], off[1], radius))
            if len(looks) > 1:
                off = _apart(low, high)
                best = min(best, back_m(off[0], off[1], radius))
            out[way, k + count - 1] = best


@njit(cache=True)
def turns_m(count: int, backs: Floats, on: float, ways: Flags, out: Floats) -> None:
    """Least of all turns of a stay, (4, 4) by where it begins and ends: 2·way, 1 more in the right half.

    Parameters
    ----------
    backs
        Of ``_backs``, (2, 2·count − 1).
    on
        Least from the end of one strip to the beginning of another flown the same way.
    """
    full = (1 << count) - 1
    out[:] = np.inf
    best = np.empty((full + 1, count, 2))
    for begin in range(4):
        if not ways[begin // 2]:
            continue
        best[:] = np.inf
        for i in range(count):
            if half_of(i, count) == begin % 2:
                best[1 << i, i, begin // 2] = 0.0
        for flown in range(1, full):
            for i in range(count):
                if not flown >> i & 1:
                    continue
                for way in range(2):
                    so_far = best[flown, i, way]
                    if so_far == np.inf:
                        continue
                    for j in range(count):
                        if flown >> j & 1:
                            continue
                        more = flown | 1 << j
                        best[more, j, way] = min(best[more, j, way], so_far + on)
                        if ways[1 - way]:
                            turned = so_far + backs[way, j - i + count - 1]
                            best[more, j, 1 - way] = min(best[more, j, 1 - way], turned)
        for j in range(count):
            for way in range(2):
                end = 2 * way + half_of(j, count)
                out[begin, end] = min(out[begin, end], best[full, j, way])


@njit(cache=True)
def half_of(strip: int, count: int) -> int:
    """0 for a strip in the left half, the middle one and the only one included, 1 in the right."""
    return 0 if 2 * strip < count else 1


@njit(cache=True)
def _on_least(cells: Floats, ways: Flags, theta: float, radius: float) -> float:
    """Least from the end of one strip to the beginning of another that is flown the same way.

    ``cells`` is (2, L, M, ``WIDTH``): way, look, strip.
    """
    best = np.inf
    for way in range(2):
        if not ways[way]:
            continue
        cos, sin = math.cos(theta + way * math.pi), math.sin(theta + way * math.pi)
        for a in range(cells.shape[1]):
            for i in range(cells.shape[2]):
                here = cells[way, a, i]
                if here[HOLDS] == 0.0:
                    continue
                for b in range(cells.shape[1]):
                    for j in range(cells.shape[2]):
                        there = cells[way, b, j]
                        if i == j or there[HOLDS] == 0.0:
                            continue
                        e = there[ENTRY + E] - here[EXIT + E]
                        n = there[ENTRY + N] - here[EXIT + N]
                        slack = here[EXIT + REACH] + there[ENTRY + REACH] + here[LOOSE] + there[LOOSE]
                        least = max(math.hypot(e, n) - slack, 0.0)
                        # Flown on at the same heading from there, it lies behind: a half turn and one back.
                        if cos * e + sin * n + slack <= 0.0:
                            least = max(least, math.pi * radius)
                        best = min(best, least)
    return best


@njit(cache=True)
def stays(
    ring: Floats,
    hull: Floats,
    families: Floats,
    rows: Ints,
    thetas: Floats,
    alpha: float,
    ways: Flags,
    etas: int,
    per_set: int,
    radius: float,
) -> tuple[Floats, Floats, Floats, Floats]:
    """What stays take at least, and where their passes begin and end.

    Parameters
    ----------
    ring, hull, families
        See ``cells_kernels``.
    rows
        Which families strips are of, −1 for none: group, look, which strip counted from the line, (G, L, M).
    thetas, alpha
        Headings, (H,), and half their range.
    ways
        Whether passes are flown at the heading and at its opposite, bool (H, 2).
    etas
        Of strips of several the offsets are divided into so many parts.
    per_set
        So many headings, one after the other, share their sets of ends.

    Returns
    -------
    ndarray, ndarray, ndarray, ndarray
        All passes of each group and part of the offsets at each heading, the least turn between two,
        (H, G, K), and all turns, (H, G, K, 4, 4) as ``turns_m``; inf where there are none. Bounds of the
        sets, (H / per_set, 4, L, 2, 4): way and half, look, entry or exit.
    """
    groups, looks, most = rows.shape
    passes_m = np.full((len(thetas), groups, etas), np.inf)
    turn_m = np.full((len(thetas), groups, etas), np.inf)
    all_turns_m = np.full((len(thetas), groups, etas, 4, 4), np.inf)
    sides = np.array([families[rows[0, look, 0], 1] for look in range(looks)])
    backs = np.empty((2, 2 * most - 1))
    sets = np.empty((len(thetas) // per_set, 4, looks, 2, 4))
    sets[..., LEAST_X], sets[..., MOST_X] = np.inf, -np.inf
    sets[..., LEAST_Y], sets[..., MOST_Y] = np.inf, -np.inf
    far = math.sqrt((hull[:, 0] ** 2 + hull[:, 1] ** 2).max())
    cells = np.empty((2, looks, most, WIDTH))
    box = np.empty(5)
    for h in range(len(thetas)):
        theta = thetas[h]
        of_set = h // per_set
        middle = 0.5 * (thetas[of_set * per_set] + thetas[of_set * per_set + per_set - 1])
        left, _, _, _ = support(hull, theta + 0.5 * math.pi, alpha)
        right, _, _, _ = support(hull, theta - 0.5 * math.pi, alpha)
        across, margin = left + right, 2.0 * alpha * far
        for g in range(groups):
            first = families[rows[g, 0, 0]]
            count, kind = int(first[8]), first[0]
            near, near_gain, near_off = by_heading(first, 0, theta, alpha)
            swath, swath_gain, swath_off = by_heading(first, 1, theta, alpha)
            near_off, swath_off = near_off + alpha * abs(near_gain), swath_off + alpha * abs(swath_gain)
            if across - margin > count * (swath + swath_off) + 1e-6:
                continue
            parts = etas if kind == STRIP else 1
            for k in range(parts):
                box[1], box[2], box[3], box[4] = theta, alpha, (k + 0.5) / parts, 0.5 / parts
                total, holds = 0.0, True
                cells[:, :, :, HOLDS] = 0.0
                for m in range(count):
                    least = np.inf
                    for way in range(2):
                        if not ways[h, way]:
                            continue
                        box[1] = theta + way * math.pi
                        for look in range(looks):
                            side = families[rows[g, look, 0], 1]
                            # Strips are counted from the left, families from the line's side.
                            index = m if (side > 0.0) == (way == 0) else count - 1 - m
                            if rows[g, look, index] < 0:
                                continue
                            found = cell(ring, hull, families[rows[g, look, index]], box)
                            if found[HOLDS] == 0.0:
                                continue
                            cells[way, look, m] = found
                            inner = (
                                found[INNER] - abs(found[INNER_GAIN]) - found[INNER_DEV] - found[INNER_JUMP]
                            )
                            least = min(least, inner)
                    if least == np.inf:
                        holds = False
                        break
                    total += least
                if not holds:
                    continue
                passes_m[h, g, k] = total
                if count == 1:
                    turn_m[h, g, k] = 0.0
                    for way in range(2):
                        all_turns_m[h, g, k, 2 * way, 2 * way] = 0.0 if ways[h, way] else np.inf
                else:
                    flip = (
                        swath - swath_off + 2.0 * (near - near_off),
                        swath + swath_off + 2.0 * (near + near_off),
                    )
                    spare = (
                        max(count * (swath - swath_off) - across - margin, 0.0),
                        max(count * (swath + swath_off) - across + margin, 0.0),
                    )
                    step = (
                        swath - swath_off - spare[1] * (1.0 - k / parts) / (count - 1.0),
                        swath + swath_off - spare[0] * (1.0 - (k + 1.0) / parts) / (count - 1.0),
                    )
                    if kind == LONG:
                        # Each strip by itself anywhere, so long as the two of them hold the region.
                        step = (0.0, swath + swath_off)
                    of_count = backs[:, : 2 * count - 1]
                    _backs(count, step, flip, sides, radius, of_count)
                    on = _on_least(cells[:, :, :count], ways[h], theta, radius)
                    least = on
                    if ways[h, 0] and ways[h, 1]:
                        for m in range(2 * count - 1):
                            if m != count - 1:
                                least = min(least, of_count[0, m], of_count[1, m])
                    turn_m[h, g, k] = least
                    if count <= MOST_ORDERED:
                        turns_m(count, of_count, on, ways[h], all_turns_m[h, g, k])
                    else:
                        all_turns_m[h, g, k] = (count - 1.0) * least
                for way in range(2):
                    cos, sin = math.cos(middle), math.sin(middle)
                    for look in range(looks):
                        for m in range(count):
                            found = cells[way, look, m]
                            if found[HOLDS] == 0.0:
                                continue
                            for which in range(2):
                                end = ENTRY if which == 0 else EXIT
                                reach = found[end + REACH] + found[LOOSE]
                                x = cos * found[end + E] + sin * found[end + N]
                                y = cos * found[end + N] - sin * found[end + E]
                                into = sets[of_set, 2 * way + half_of(m, count), look, which]
                                into[LEAST_X] = min(into[LEAST_X], x - reach)
                                into[MOST_X] = max(into[MOST_X], x + reach)
                                into[LEAST_Y] = min(into[LEAST_Y], y - reach)
                                into[MOST_Y] = max(into[MOST_Y], y + reach)
    return passes_m, turn_m, all_turns_m, sets
