"""Shortest lines of bounded curvature between two poses, written plainly.

L. E. Dubins (1957): the shortest line is one of six words of arcs (L left, R right) of the smallest radius
and straights (S). Names, the parameters t, p, q and the choice of the long middle arc follow A. M. Shkel and
V. Lumelsky, "Classification of the Dubins set", Robotics and Autonomous Systems 34 (2001), 179-202. Their
closed form of each word (section 3) is solved here on the turning circles themselves, which needs no rotated
frame and loses no digits where the poses are close. ``kernels.py`` holds the same equations compiled.

Where the direction at one end is free the shortest line is an arc and a straight, or two arcs of which the
second is longer than half a turn (X.-N. Bui, P. Souères, J.-D. Boissonnat, J.-P. Laumond, "Shortest path
synthesis for Dubins non-holonomic robot", ICRA 1994).
"""

from __future__ import annotations

import cmath
import math

from planner.angles import TWO_PI, wrap_two_pi
from planner.dubins.path import Path, Segment, SegmentKind
from planner.route import Anchor, Pose

#: Arcs this close to a full turn, in radians for a straight of no length, are arcs of no length.
FULL_TURN_SNAP = 1e-9

#: A line of several radii: turn at the start, middle (straight in radii, or arc), turn at the end.
Parameters = tuple[str, float, float, float]


def arc_rad(turn_rad: float, straight_radii: float = 0.0) -> float:
    """An arc in [0, 2π) that is 0, not almost 2π, where rounding made ``turn_rad`` slightly negative.

    ``straight_radii`` is the length flown along the direction concerned: the further, the less is forgiven.
    """
    turn_rad = wrap_two_pi(turn_rad)
    return 0.0 if (TWO_PI - turn_rad) * (1.0 + straight_radii) < FULL_TURN_SNAP else turn_rad


def _phase(vector: complex) -> float:
    # cmath.phase and abs() raise on the tiniest vectors; math's functions do not.
    return math.atan2(vector.imag, vector.real)


def _modulus(vector: complex) -> float:
    return math.hypot(vector.real, vector.imag)


def word_parameters(start: Pose, goal: Pose, radius_m: float) -> list[Parameters]:
    """The feasible words with their parameters t, p, q (Shkel & Lumelsky 2001): radians, a straight in radii.

    A complex number is a vector, its real part east. A vehicle at z with direction φ circles about
    z + i s e^{iφ}, s = +1 on a left circle and -1 on a right one (lengths in radii).
    """
    alpha, beta = start.angle_rad, goal.angle_rad
    offset = complex(goal.east_m - start.east_m, goal.north_m - start.north_m) / radius_m
    to_left_start = complex(-math.sin(alpha), math.cos(alpha))
    to_left_goal = complex(-math.sin(beta), math.cos(beta))
    found: list[Parameters] = []

    for word, s in (("LSL", 1.0), ("RSR", -1.0)):
        # LSL, RSR: the straight is the vector between the centres.
        centres = offset + s * to_left_goal - s * to_left_start
        p = _modulus(centres)
        if p < FULL_TURN_SNAP:
            found.append((word, arc_rad(s * (beta - alpha)), 0.0, 0.0))
            continue
        phi = _phase(centres)
        found.append((word, arc_rad(s * (phi - alpha), p), p, arc_rad(s * (beta - phi), p)))

    for word, s in (("LSR", 1.0), ("RSL", -1.0)):
        # LSR, RSL: centres = e^{iφ} (p - 2 i s), the inner tangent of two circles.
        centres = offset - s * to_left_goal - s * to_left_start
        square = centres.real**2 + centres.imag**2 - 4.0
        if square < -FULL_TURN_SNAP:
            continue
        p = math.sqrt(max(square, 0.0))
        phi = _phase(centres * complex(p, 2.0 * s))
        found.append((word, arc_rad(s * (phi - alpha), p), p, arc_rad(s * (phi - beta), p)))

    for word, s in (("LRL", 1.0), ("RLR", -1.0)):
        # LRL, RLR: three circles in a triangle of sides 2, 2, d; the middle arc is the one above π.
        centres = offset + s * to_left_goal - s * to_left_start
        distance = _modulus(centres)
        if distance > 4.0:
            continue
        psi, gamma = _phase(centres), math.acos(distance / 4.0)
        lean = gamma + math.pi / 2.0
        found.append((word, arc_rad(s * (psi - alpha) + lean), 2.0 * lean, arc_rad(s * (beta - psi) + lean)))
    return found


def candidates(start: Pose, goal: Pose, radius_m: float) -> list[Path]:
    """All feasible words between two poses, shortest first.

    Parameters
    ----------
    start, goal
        First and last pose.
    radius_m
        Radius of every arc, > 0.

    Returns
    -------
    list of Path
        At least two: LSL and RSR always exist. Arcs and straights of no length are left out.
    """
    words = sorted(word_parameters(start, goal, radius_m), key=lambda word: word[1] + word[2] + word[3])
    return [_path(start, word, (t, p, q), radius_m) for word, t, p, q in words]


def shortest(start: Pose, goal: Pose, radius_m: float) -> Path:
    """The shortest line from pose to pose with turns of ``radius_m`` or wider."""
    word, t, p, q = min(
        word_parameters(start, goal, radius_m), key=lambda parameters: math.fsum(parameters[1:])
    )
    return _path(start, word, (t, p, q), radius_m)


def candidates_to_point(start: Pose, east_m: float, north_m: float, radius_m: float) -> list[Path]:
    """Lines from a pose to a place, any direction there, shortest first: LS, RS, LR, RL where they exist."""
    alpha = start.angle_rad
    offset = complex(east_m - start.east_m, north_m - start.north_m) / radius_m
    to_left = complex(-math.sin(alpha), math.cos(alpha))
    found: list[tuple[str, float, float]] = []
    if _modulus(offset) < FULL_TURN_SNAP:
        return [_path(start, "S", (0.0,), radius_m)]
    for side, other, s in (("L", "R", 1.0), ("R", "L", -1.0)):
        to_place = offset - s * to_left
        square = to_place.real**2 + to_place.imag**2 - 1.0
        if square >= -3.0 * FULL_TURN_SNAP:
            # The tangent from the circle to the place: to_place = e^{iφ} (p - i s).
            p = math.sqrt(max(square, 0.0))
            phi = _phase(to_place * complex(p, s))
            found.append((side + "S", arc_rad(s * (phi - alpha), p), p))
        distance = _modulus(to_place)
        if 1.0 <= distance <= 3.0:
            # The second circle is 2 from the first and 1 from the place: a triangle of sides 2, 1, distance.
            gamma = math.acos(min(1.0, (distance * distance + 3.0) / (4.0 * distance)))
            for lean in (gamma, -gamma):
                to_second = 2.0 * cmath.rect(1.0, _phase(to_place) + lean)
                phi = _phase(to_second) + s * math.pi / 2.0
                last = _phase(to_place - to_second) - s * math.pi / 2.0
                found.append((side + other, arc_rad(s * (phi - alpha)), arc_rad(s * (phi - last))))
    found.sort(key=lambda word: word[1] + word[2])
    return [_path(start, word, (first, second), radius_m) for word, first, second in found]


def candidates_between(start: Anchor, goal: Anchor, radius_m: float) -> list[Path]:
    """Lines between two anchors, shortest first; a direction that is None is free.

    With both directions given these are ``candidates``; with one free, the two-piece words to or from the
    place; with both free, the straight.
    """
    if start.angle_rad is not None and goal.angle_rad is not None:
        return candidates(
            Pose(start.east_m, start.north_m, start.angle_rad),
            Pose(goal.east_m, goal.north_m, goal.angle_rad),
            radius_m,
        )
    if start.angle_rad is not None:
        pose = Pose(start.east_m, start.north_m, start.angle_rad)
        return candidates_to_point(pose, goal.east_m, goal.north_m, radius_m)
    if goal.angle_rad is not None:
        # Flown backwards, this is the problem above.
        pose = Pose(goal.east_m, goal.north_m, goal.angle_rad + math.pi)
        return [path.reverse() for path in candidates_to_point(pose, start.east_m, start.north_m, radius_m)]
    offset = complex(goal.east_m - start.east_m, goal.north_m - start.north_m)
    pose = Pose(start.east_m, start.north_m, _phase(offset))
    return [_path(pose, "S", (_modulus(offset) / radius_m,), radius_m)]


def shortest_between(start: Anchor, goal: Anchor, radius_m: float) -> Path:
    """The shortest line between two anchors; a direction that is None is free."""
    return candidates_between(start, goal, radius_m)[0]


def _path(start: Pose, word: str, parameters: tuple[float, ...], radius_m: float) -> Path:
    """The segments of a word, those of no length left out."""
    kinds: dict[str, SegmentKind] = {"L": "left", "R": "right", "S": "straight"}
    segments: list[Segment] = []
    pose = start
    for letter, parameter in zip(word, parameters, strict=True):
        if parameter * radius_m <= FULL_TURN_SNAP:
            continue
        radius = math.inf if letter == "S" else radius_m
        segment = Segment(kinds[letter], pose, parameter * radius_m, radius)
        segments.append(segment)
        pose = segment.end
    return Path(tuple(segments) or (Segment("straight", start, 0.0),))
