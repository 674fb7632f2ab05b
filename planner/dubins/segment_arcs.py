"""Arcs onto a straight that is to be flown, and off it (Stecz and Gromada 2020, Algorithms 5 and 6).

The straight begins or ends at a pose. The arc onto it may have another radius than the arc flown before: the
aircraft may turn at another speed by then.
"""

from __future__ import annotations

import math

from planner.dubins.path import Path, Segment, SegmentKind
from planner.route import Point, Pose

#: Turns this near to a full circle are none.
FULL_TURN_RAD = 1e-9


def ingress(previous: Segment | Point, target: Point, begin: Pose, radius_m: float) -> Path | None:
    """Algorithm 5: from the arc flown before onto the beginning of a straight.

    The arc before (A_prev, of radius R') is left where the tangent to the circle of the ingress arc (C_ingr,
    of radius R) leads off. That circle lies on the side of the straight where the previous target is; where
    both turn opposite ways and are nearer than R + R', on the other.

    Parameters
    ----------
    previous
        The arc flown before, of which the start and the circle count; or the place where it all begins.
    target
        The previous target.
    begin
        First pose of the straight.
    radius_m
        R, > 0.

    Returns
    -------
    Path
        The arc before with its new end, the tangent, the arc onto the straight. None where one circle holds
        the other, so that no tangent leads from it.
    """
    side = 1.0 if _aside(begin, target) >= 0.0 else -1.0
    if isinstance(previous, Segment):
        place, own_m = previous.centre, previous.radius_m if previous.kind == "left" else -previous.radius_m
        if place is None:
            raise ValueError("the manoeuvre before is an arc, not a straight")
    else:
        place, own_m = previous, 0.0
    circle = _beside(begin, side * radius_m)
    if math.dist(place, circle) < abs(own_m) + radius_m and own_m * side <= 0.0:
        side = -side
        circle = _beside(begin, side * radius_m)
    angle_rad = _tangent(place, own_m, circle, side * radius_m)
    if angle_rad is None:
        return None
    leaves = _on(place, own_m, angle_rad)
    arrives = _on(circle, side * radius_m, angle_rad)
    pieces = [
        Segment("straight", leaves, math.dist(leaves.position, arrives.position)),
        _arc(arrives, begin.angle_rad, side * radius_m),
    ]
    if isinstance(previous, Segment):
        pieces.insert(0, _arc(previous.start, angle_rad, own_m))
    return Path(tuple(pieces))


def egress(end: Pose, target: Point, radius_m: float) -> Path | None:
    """Algorithm 6: from the end of a straight round until the next target lies ahead, and on to it.

    The circle (C_egr) lies on the side of the next target; on the other where it would hold the target.

    Parameters
    ----------
    end
        Last pose of the straight.
    target
        w_(i+4), the next waypoint.
    radius_m
        R, > 0.

    Returns
    -------
    Path
        The arc and the tangent to the target. None where both circles hold it, at the pose itself.
    """
    side = 1.0 if _aside(end, target) >= 0.0 else -1.0
    if math.dist(_beside(end, side * radius_m), target) < radius_m:
        side = -side
    circle = _beside(end, side * radius_m)
    angle_rad = _tangent(circle, side * radius_m, target, 0.0)
    if angle_rad is None:
        return None
    arc = _arc(end, angle_rad, side * radius_m)
    return Path((arc, Segment("straight", arc.end, math.dist(arc.end.position, target))))


def _aside(pose: Pose, place: Point) -> float:
    """How far a place lies to the left of a pose's line."""
    east_m, north_m = place[0] - pose.east_m, place[1] - pose.north_m
    return math.cos(pose.angle_rad) * north_m - math.sin(pose.angle_rad) * east_m


def _beside(pose: Pose, signed_m: float) -> Point:
    """Centre of the circle through a pose, counter-clockwise where the radius is positive."""
    return (
        pose.east_m - signed_m * math.sin(pose.angle_rad),
        pose.north_m + signed_m * math.cos(pose.angle_rad),
    )


def _on(centre: Point, signed_m: float, angle_rad: float) -> Pose:
    """Where a circle is flown in a direction."""
    return Pose(
        centre[0] + signed_m * math.sin(angle_rad), centre[1] - signed_m * math.cos(angle_rad), angle_rad
    )


def _tangent(here: Point, here_m: float, there: Point, there_m: float) -> float | None:
    """Direction of the straight from one circle to another, each flown its own way round."""
    apart_m, difference_m = math.dist(here, there), here_m - there_m
    if apart_m == 0.0 or abs(difference_m) > apart_m * (1.0 + 1e-12):
        return None
    bearing_rad = math.atan2(there[1] - here[1], there[0] - here[0])
    return bearing_rad + math.asin(max(-1.0, min(1.0, difference_m / apart_m)))


def _arc(start: Pose, angle_rad: float, signed_m: float) -> Segment:
    """From a pose round until a direction is reached."""
    kind: SegmentKind = "left" if signed_m > 0.0 else "right"
    turn_rad = math.copysign(1.0, signed_m) * (angle_rad - start.angle_rad) % math.tau
    if math.tau - turn_rad < FULL_TURN_RAD:
        turn_rad = 0.0
    return Segment(kind, start, turn_rad * abs(signed_m), abs(signed_m))
