"""Compiled parts of the lower bound: cells of passes. Numbers only.

A *box* of passes is float64 (5,): family, theta, alpha, eta, half_eta; its passes have headings
``theta + x·alpha`` and offsets ``eta + y·half_eta``, x and y from −1 to 1.

A *family* of passes is float64 (``FIXED``,) or more: kind (below), side (1 looks right, −1 left), near edge,
swath, run-in before the ground seen, settling run, east and north of the middle of its region, how many
strips it is one of, how many of these may be more than the fewest that see the region, which of them it is,
counted from the line's side, and run-out. Where near edge, swath, run-in and run-out change with the heading,
as with an antenna that crabs in the wind, these follow: by how much each may differ from a straight line
between two samples, and samples of each at equal steps of the heading from 0 on.

A *cell* is what is known of a box, float64 (``WIDTH``,): entry, exit and inner cost of its middle pass, how
they change with x and y, and by how much at most that change differs anywhere in the box.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from planner.jit import njit

Floats = NDArray[np.float64]

#: What a pass of a family sees: the whole region; of two passes each as long as the whole region, the strip
#: on the side of its line; a strip, flown as far as the region reaches in it.
WHOLE, LONG, STRIP = 0.0, 1.0, 2.0
ROUNDING_M = 5e-4
#: Numbers of a family that are always there, and those that the samples of the heading begin after.
FIXED, SAMPLED = 12, 16

#: Heading, half the headings, 1 where the box holds a pass at all; the middle pass's inner cost, what that
#: gains with x, by how much at most the gain differs because of what changes evenly over the box and because
#: of corners of the region; by how much the pass may lie elsewhere for reasons that x and y do not tell.
THETA, ALPHA, HOLDS, INNER, INNER_GAIN, INNER_DEV, INNER_JUMP, LOOSE = range(8)
#: Change of place with y, the same for both ends: east, north, by how much at most it differs.
Y_E, Y_N, Y_DEV = 8, 9, 10
#: Of the entry, then of the exit: place, its change with x, by how much at most that differs, evenly and
#: because of corners, and how far away the end can be.
ENTRY, EXIT = 11, 18
E, N, X_E, X_N, X_DEV, X_JUMP, REACH = range(7)
#: Of the heading.
COS, SIN = 25, 26
WIDTH = 27


@njit(cache=True)
def support(hull: Floats, angle: float, alpha: float) -> tuple[float, float, float, float]:
    """How far a convex ring reaches in a direction, and how that changes as the direction turns by ± alpha.

    The change is the place, across the direction, of the vertex that reaches furthest. Vertices that do so
    for some direction of the interval are those met going round from one end of it to the other.

    Parameters
    ----------
    hull
        Counter-clockwise, (V, 2).

    Returns
    -------
    float, float, float, float
        Reach in the middle direction; middle and half of the range of its derivative over these vertices;
        how far any of these is from the origin, which is what the derivative changes by per radian.
    """
    count = len(hull)
    cos, sin = math.cos(angle), math.sin(angle)
    reach = -np.inf
    for k in range(count):
        reach = max(reach, cos * hull[k, 0] + sin * hull[k, 1])
    first = _furthest(hull, angle - alpha)
    last = _furthest(hull, angle + alpha)
    low, high, far = np.inf, -np.inf, 0.0
    k = first
    while True:
        across = -sin * hull[k, 0] + cos * hull[k, 1]
        low, high = min(low, across), max(high, across)
        far = max(far, math.hypot(hull[k, 0], hull[k, 1]))
        if k == last:
            break
        k = k + 1 if k + 1 < count else 0
    return reach, 0.5 * (low + high), 0.5 * (high - low), far


@njit(cache=True)
def _furthest(hull: Floats, angle: float) -> int:
    cos, sin = math.cos(angle), math.sin(angle)
    best, at = -np.inf, 0
    for k in range(len(hull)):
        reach = cos * hull[k, 0] + sin * hull[k, 1]
        if reach > best:
            best, at = reach, k
    return at


@njit(cache=True)
def extremes(x: Floats, y: Floats, least: float, most: float) -> tuple[float, float, float, float]:
    """The points of a closed ring furthest back and furthest ahead in x whose y lies within bounds.

    Their x and y; inf and −inf if there are none.
    """
    low, low_y, high, high_y = np.inf, 0.0, -np.inf, 0.0
    for k in range(len(x)):
        m = k + 1 if k + 1 < len(x) else 0
        for which in range(3):
            at_x, at_y = x[k], y[k]
            if which > 0:
                level = least if which == 1 else most
                if (y[k] - level) * (y[m] - level) >= 0.0:
                    continue
                at_x, at_y = x[k] + (x[m] - x[k]) * (level - y[k]) / (y[m] - y[k]), level
            if not least <= at_y <= most:
                continue
            if at_x < low:
                low, low_y = at_x, at_y
            if at_x > high:
                high, high_y = at_x, at_y
    return low, low_y, high, high_y


@njit(cache=True)
def by_heading(family: Floats, which: int, theta: float, alpha: float) -> tuple[float, float, float]:
    """What changes with the heading, at θ, its gain by the heading, and by how much at most it is off that.

    ``which`` is 0 for the near edge, 1 for the swath, 2 for the run-in, 3 for the run-out. A straight line is
    laid through the samples within α of θ; between two samples, too, no value is further from it than these
    and what their own straight line may be off.
    """
    count = (len(family) - SAMPLED) // 4
    if count <= 0:
        return family[11] if which == 3 else family[2 + which], 0.0, 0.0
    step = 2.0 * math.pi / count
    begin = math.floor((theta - alpha) / step)
    end = max(math.ceil((theta + alpha) / step), begin + 1)
    table = SAMPLED + which * count
    first, last = family[table + begin % count], family[table + end % count]
    gain = (last - first) / ((end - begin) * step)
    low, high = np.inf, -np.inf
    for k in range(begin, end + 1):
        rest = family[table + k % count] - gain * (k * step - theta)
        low, high = min(low, rest), max(high, rest)
    return 0.5 * (low + high), gain, 0.5 * (high - low) + family[FIXED + which]


@njit(cache=True)
def cell(ring: Floats, hull: Floats, family: Floats, box: Floats) -> Floats:
    """What is known of a box of passes of a family.

    ``ring`` and ``hull`` are the region's, (V, 2), counter-clockwise and relative to its middle. An offset η
    lays the outermost of n strips beyond the region's edge by η times what the strips have to spare, or half
    of that; what is left to spare is shared by the overlaps of neighbours.
    """
    kind, side, settle = family[0], family[1], family[5]
    strips, fewest, index = family[8], family[8] - family[9], family[10]
    theta, alpha, eta, half_eta = box[1], box[2], box[3], box[4]
    near, near_gain, near_off = by_heading(family, 0, theta, alpha)
    swath, swath_gain, swath_off = by_heading(family, 1, theta, alpha)
    run_in, in_gain, in_off = by_heading(family, 2, theta, alpha)
    run_out, out_gain, out_off = by_heading(family, 3, theta, alpha)
    near_range, swath_range = alpha * abs(near_gain) + near_off, alpha * abs(swath_gain) + swath_off
    out = np.zeros(WIDTH)
    # Turning within the box moves no point of the region further.
    margin = alpha * math.sqrt((hull[:, 0] ** 2 + hull[:, 1] ** 2).max())
    # Ahead and behind, then towards the line and away from it.
    x_max, ahead, ahead_jump, ahead_far = support(hull, theta, alpha)
    x_min, behind, behind_jump, behind_far = support(hull, theta + math.pi, alpha)
    y_max, to, to_jump, to_far = support(hull, theta + side * 0.5 * math.pi, alpha)
    y_min, fro, fro_jump, fro_far = support(hull, theta - side * 0.5 * math.pi, alpha)
    x_min, y_min, behind, fro = -x_min, -y_min, -behind, -fro
    across = y_max - y_min
    if across - 2.0 * margin > strips * (swath + swath_range) + ROUNDING_M:
        return out
    if across + 2.0 * margin < (fewest - 1.0) * (swath - swath_range) - ROUNDING_M:
        return out
    spare = strips * swath - across
    spare_gain = fro - to + strips * swath_gain
    spare_jump, spare_dev = to_jump + fro_jump, alpha * (to_far + fro_far)
    # The line lies off the region's edge by so many swaths and this share of the spare, which goes with η.
    share, by_eta = eta, 1.0
    if kind == STRIP:
        by_eta = 0.5 - index / (strips - 1.0)
        share = index / (strips - 1.0) + eta * by_eta
    line, line_y = y_max + near - index * swath + share * spare, by_eta * spare
    line_gain = (1.0 - share) * to + share * fro + near_gain + (share * strips - index) * swath_gain
    line_jump = (1.0 - share) * to_jump + share * fro_jump
    # The line moves by its own change with the heading and, less evenly, by what the offset adds.
    line_dev = alpha * max(to_far, fro_far) + half_eta * abs(by_eta) * (abs(spare_gain) + spare_dev)
    line_jump += half_eta * abs(by_eta) * spare_jump
    # What near edge and swath are off their straight lines by moves it besides.
    line_off = near_off + (abs(share * strips - index) + half_eta * abs(by_eta) * strips) * swath_off
    line_reach = alpha * (abs(line_gain) + line_dev + line_jump) + half_eta * abs(line_y) + line_off
    loose = 0.0
    if kind == STRIP:
        # What the strip holds with every pass of the box: the points of the region furthest back and ahead
        # there must be seen, wherever else the pass goes.
        x = math.cos(theta) * ring[:, 0] + math.sin(theta) * ring[:, 1]
        y = side * (math.cos(theta) * ring[:, 1] - math.sin(theta) * ring[:, 0])
        least, most = line_reach + margin + near_range + swath_range, line_reach + margin + near_range
        low = line - near - swath + least if index < strips - 1.0 else -np.inf
        high = line - near - most if index > 0.0 else np.inf
        from_x, from_y, to_x, to_y = extremes(x, y, low, high)
        if from_x > to_x:
            # Somewhere it holds something.
            loose = margin + 0.5 * (x_max - x_min)
            from_x, from_y = 0.5 * (x_min + x_max), 0.0
            to_x, to_y = from_x, 0.0
        x_min, behind, behind_jump, behind_far = from_x, side * from_y, 0.0, math.hypot(from_x, from_y)
        x_max, ahead, ahead_jump, ahead_far = to_x, side * to_y, 0.0, math.hypot(to_x, to_y)
    out[INNER_GAIN] = alpha * (ahead - behind + in_gain + out_gain)
    out[INNER_DEV] = alpha * alpha * (ahead_far + behind_far)
    out[INNER_JUMP] = alpha * (ahead_jump + behind_jump) + in_off + out_off
    line *= side
    line_y *= side
    line_gain *= side
    cos, sin = math.cos(theta), math.sin(theta)
    for end in (ENTRY, EXIT):
        if end == ENTRY:
            along, gain, jump, far = x_min - run_in - settle, behind - in_gain, behind_jump, behind_far
            off = in_off
        else:
            along, gain, jump, far = x_max + run_out, ahead + out_gain, ahead_jump, ahead_far
            off = out_off
        # In axes turned by the heading, which turn with it.
        change_x, change_y = gain - line, along + line_gain
        reach_x = alpha * (abs(gain) + jump + alpha * far) + off
        dev = math.hypot(alpha * far + line_reach, reach_x + line_dev)
        dev += alpha * math.hypot(change_x, change_y)
        out[end + E] = family[6] + cos * along - sin * line
        out[end + N] = family[7] + sin * along + cos * line
        out[end + X_E] = alpha * (cos * change_x - sin * change_y)
        out[end + X_N] = alpha * (sin * change_x + cos * change_y)
        out[end + X_DEV] = alpha * dev
        out[end + X_JUMP] = alpha * math.hypot(jump, line_jump) + math.hypot(off, line_off)
        out[end + REACH] = (
            alpha * (math.hypot(change_x, change_y) + dev) + out[end + X_JUMP] + half_eta * abs(line_y)
        )
    out[THETA], out[ALPHA], out[HOLDS], out[LOOSE] = theta, alpha, 1.0, loose
    out[COS], out[SIN] = cos, sin
    out[INNER] = x_max - x_min + run_in + run_out + settle
    out[Y_E], out[Y_N] = -half_eta * sin * line_y, half_eta * cos * line_y
    out[Y_DEV] = half_eta * alpha * abs(by_eta) * (abs(spare_gain) + spare_jump + spare_dev + abs(spare))
    return out


@njit(cache=True)
def parts(box: Floats, cell: Floats) -> Floats:
    """A box in two or four, (2 or 4, 5): half the headings, half the offsets or both, what moves it more."""
    by_x = max(
        math.hypot(cell[ENTRY + X_E], cell[ENTRY + X_N]), math.hypot(cell[EXIT + X_E], cell[EXIT + X_N])
    )
    by_y = math.hypot(cell[Y_E], cell[Y_N])
    ways_x = 1 if box[2] == 0.0 or by_y > 2.0 * by_x else 2
    ways_y = 1 if box[2] > 0.0 and by_x > 2.0 * by_y else 2
    out = np.empty((ways_x * ways_y, 5))
    for k in range(ways_x):
        for m in range(ways_y):
            part = out[k * ways_y + m]
            part[:] = box
            if ways_x == 2:
                part[2] = 0.5 * box[2]
                part[1] = box[1] + (k - 0.5) * box[2]
            if ways_y == 2:
                part[4] = 0.5 * box[4]
                part[3] = box[3] + (m - 0.5) * box[4]
    return out


@njit(cache=True)
def cells(ring: Floats, hull: Floats, families: Floats, boxes: Floats) -> Floats:
    """The cells of boxes (B, 5), (B, ``WIDTH``)."""
    out = np.empty((len(boxes), WIDTH))
    for k in range(len(boxes)):
        out[k] = cell(ring, hull, families[int(boxes[k, 0])], boxes[k])
    return out
