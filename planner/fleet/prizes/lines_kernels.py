"""Compiled Dubins words among polygons: which is the shortest that enters none. Numbers only.

``planner.dubins.words`` is the plain twin of the words and cites the equations. A fence is the edges of all
polygons, (E, 4), those of polygon k from ``offsets[k]`` to ``offsets[k + 1]``, and their boxes, (K, 4). A
line that starts outside and crosses no edge enters nothing.
"""

# mypy: allow-untyped-decorators

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from planner.dubins.kernels import dubins_length
from planner.jit import njit

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

TWO_PI = 2.0 * math.pi
#: Arcs this close to a full turn are arcs of no length.
SNAP = 1e-9
#: Words in this order: LSL, RSR, LSR, RSL, LRL, RLR; of their arcs, left is 1 and right is -1.
WORDS = 6
FIRST = (1.0, -1.0, 1.0, -1.0, 1.0, -1.0)
LAST = (1.0, -1.0, -1.0, 1.0, 1.0, -1.0)


@njit(cache=True, nogil=True)
def _arc(turn: float) -> float:
    turn -= TWO_PI * math.floor(turn / TWO_PI)
    return 0.0 if TWO_PI - turn < SNAP else turn


@njit(cache=True, nogil=True)
def word(k: int, start: Floats, goal: Floats, radius: float) -> tuple[float, float, float]:
    """Parameters t, p, q of a word: arcs in radians, a straight in radii; t is -1 where there is none."""
    alpha, beta = start[2], goal[2]
    s = FIRST[k]
    last = LAST[k]
    ce = (goal[0] - start[0]) / radius - last * math.sin(beta) + s * math.sin(alpha)
    cn = (goal[1] - start[1]) / radius + last * math.cos(beta) - s * math.cos(alpha)
    if k < 2:
        p = math.hypot(ce, cn)
        if p < SNAP:
            return _arc(s * (beta - alpha)), 0.0, 0.0
        phi = math.atan2(cn, ce)
        return _arc(s * (phi - alpha)), p, _arc(s * (beta - phi))
    if k < 4:
        square = ce * ce + cn * cn - 4.0
        if square < 0.0:
            return -1.0, 0.0, 0.0
        p = math.sqrt(square)
        phi = math.atan2(cn * p + 2.0 * s * ce, ce * p - 2.0 * s * cn)
        return _arc(s * (phi - alpha)), p, _arc(s * (phi - beta))
    distance = math.hypot(ce, cn)
    if distance > 4.0:
        return -1.0, 0.0, 0.0
    psi = math.atan2(cn, ce)
    lean = math.acos(distance / 4.0) + 0.5 * math.pi
    return _arc(s * (psi - alpha) + lean), 2.0 * lean, _arc(s * (beta - psi) + lean)


@njit(cache=True, nogil=True)
def straight_clear(
    e0: float, n0: float, e1: float, n1: float, edges: Floats, offsets: Ints, boxes: Floats
) -> bool:
    """Whether a straight crosses no edge."""
    west, east = min(e0, e1), max(e0, e1)
    south, north = min(n0, n1), max(n0, n1)
    de, dn = e1 - e0, n1 - n0
    for k in range(len(boxes)):
        if boxes[k, 0] > east or boxes[k, 2] < west or boxes[k, 1] > north or boxes[k, 3] < south:
            continue
        for j in range(offsets[k], offsets[k + 1]):
            ae, an, be, bn = edges[j, 0] - e0, edges[j, 1] - n0, edges[j, 2] - e0, edges[j, 3] - n0
            a_side, b_side = de * an - dn * ae, de * bn - dn * be
            if (a_side > 0.0) == (b_side > 0.0):
                continue
            fe, fn = be - ae, bn - an
            near, far = fe * -an - fn * -ae, fe * (dn - an) - fn * (de - ae)
            if (near > 0.0) != (far > 0.0):
                return False
    return True


@njit(cache=True, nogil=True)
def arc_clear(
    e0: float,
    n0: float,
    angle: float,
    side: float,
    turn: float,
    radius: float,
    edges: Floats,
    offsets: Ints,
    boxes: Floats,
) -> bool:
    """Whether an arc from a pose, to the left where ``side`` is 1, crosses no edge."""
    if turn <= 0.0:
        return True
    ce, cn = e0 - side * radius * math.sin(angle), n0 + side * radius * math.cos(angle)
    polar = angle - side * 0.5 * math.pi
    for k in range(len(boxes)):
        if (
            boxes[k, 0] > ce + radius
            or boxes[k, 2] < ce - radius
            or boxes[k, 1] > cn + radius
            or boxes[k, 3] < cn - radius
        ):
            continue
        for j in range(offsets[k], offsets[k + 1]):
            ee, en = edges[j, 2] - edges[j, 0], edges[j, 3] - edges[j, 1]
            oe, on = edges[j, 0] - ce, edges[j, 1] - cn
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
                    at = side * (math.atan2(on + share * en, oe + share * ee) - polar)
                    if at - TWO_PI * math.floor(at / TWO_PI) <= turn:
                        return False
    return True


@njit(cache=True, nogil=True)
def word_clear(
    k: int, start: Floats, parts: tuple[float, float, float], radius: float, edges: Floats, offsets: Ints,
    boxes: Floats,
) -> bool:  # fmt: skip
    """Whether a word crosses no edge."""
    t, p, q = parts
    if t < 0.0:
        return False
    side, last = FIRST[k], LAST[k]
    e, n, angle = start[0], start[1], start[2]
    if not arc_clear(e, n, angle, side, t, radius, edges, offsets, boxes):
        return False
    turned = angle + side * t
    e += side * radius * (math.sin(turned) - math.sin(angle))
    n -= side * radius * (math.cos(turned) - math.cos(angle))
    angle = turned
    if k < 4:
        further_e, further_n = e + p * radius * math.cos(angle), n + p * radius * math.sin(angle)
        if not straight_clear(e, n, further_e, further_n, edges, offsets, boxes):
            return False
        e, n = further_e, further_n
    else:
        if not arc_clear(e, n, angle, -side, p, radius, edges, offsets, boxes):
            return False
        turned = angle - side * p
        e -= side * radius * (math.sin(turned) - math.sin(angle))
        n += side * radius * (math.cos(turned) - math.cos(angle))
        angle = turned
    return arc_clear(e, n, angle, last, q, radius, edges, offsets, boxes)


@njit(cache=True, nogil=True)
def shortest_clear(
    start: Floats, goal: Floats, radius: float, most: float, edges: Floats, offsets: Ints, boxes: Floats
) -> tuple[int, float]:
    """The shortest word that crosses no edge, and its length; -1 where none is shorter than ``most``."""
    if dubins_length(start[0], start[1], start[2], goal[0], goal[1], goal[2], radius) >= most:
        return -1, np.inf
    lengths = np.empty(WORDS)
    for k in range(WORDS):
        t, p, q = word(k, start, goal, radius)
        lengths[k] = np.inf if t < 0.0 else radius * (t + p + q)
    for _ in range(WORDS):
        k = int(np.argmin(lengths))
        length = lengths[k]
        if length >= most:
            break
        if word_clear(k, start, word(k, start, goal, radius), radius, edges, offsets, boxes):
            return k, length
        lengths[k] = np.inf
    return -1, np.inf
