"""A polyline made flyable by turns of a name, one at each waypoint.

``three-arc``, ``past-target`` and ``short-turn`` keep the paper's rules (``turns``, ``segment_arcs``): an
egress arc where the line begins in a direction (Algorithm 6), the named turn at every waypoint, an ingress
arc where it ends in one (Algorithm 5). Waypoints that the straight line past them makes needless are left out
first ("in the process of smoothing the flight path, the number of waypoints is minimized"). Where a leg is
too short for its turns, or a turn enters a zone, the line is that of ``smoothing.smooth`` by fillets.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from planner.dubins.path import Path, Segment, join
from planner.dubins.segment_arcs import egress, ingress
from planner.dubins.smoothing import SAME_PLACE_M, SmoothingMethod, distinct, smooth
from planner.dubins.turns import Turn, past_target, short_turn, three_arc
from planner.route import Point, Pose

TurnName = Literal["three-arc", "past-target", "short-turn"]
RoundingMethod = SmoothingMethod | TurnName

TURNS: dict[TurnName, Callable[[Point, Point, Point, float], Turn | None]] = {
    "three-arc": three_arc,
    "past-target": past_target,
    "short-turn": short_turn,
}

Array = NDArray[np.float64]


def round_off(
    waypoints: ArrayLike,
    start_angle_rad: float | None,
    end_angle_rad: float | None,
    radius_m: float,
    clear: Callable[[Path], bool],
    method: RoundingMethod = "fillet",
) -> Path:
    """A line along a polyline with no turn tighter than a radius, by any name; see ``smoothing.smooth``."""
    if method == "fillet" or method == "shortcut":
        return smooth(waypoints, start_angle_rad, end_angle_rad, radius_m, clear, method)
    points = distinct(np.asarray(waypoints, dtype=np.float64))
    for tried in _fewer(points, clear):
        path = by_turns(tried, start_angle_rad, end_angle_rad, radius_m, method)
        if path is not None and clear(path):
            return path
    return smooth(points, start_angle_rad, end_angle_rad, radius_m, clear)


def by_turns(
    waypoints: Array,
    start_angle_rad: float | None,
    end_angle_rad: float | None,
    radius_m: float,
    method: TurnName,
) -> Path | None:
    """The line with the named turn at every waypoint; None where a leg has no room for its turns.

    Parameters
    ----------
    waypoints
        Shape (N, 2), N >= 2, no two in succession in one place.
    start_angle_rad, end_angle_rad
        Direction at the first and the last waypoint, any where None.
    """
    first, *rest = [(float(east_m), float(north_m)) for east_m, north_m in waypoints]
    begun = _begun(first, rest[0], start_angle_rad, radius_m)
    if begun is None:
        return None
    pieces = begun
    came_from = first
    for waypoint, after in pairwise(rest):
        straight = pieces.pop()
        before = straight.start.position
        turn = TURNS[method](before, waypoint, after, radius_m) if straight.length_m > SAME_PLACE_M else None
        left_m = math.dist(waypoint, after) - (turn.after_m if turn and math.isfinite(turn.after_m) else 0.0)
        if turn is None or straight.length_m < turn.before_m or left_m < 0.0:
            return None
        pieces.append(Segment("straight", straight.start, straight.length_m - turn.before_m))
        pieces.extend(turn.path.segments)
        if math.isfinite(turn.after_m):
            pieces.append(Segment("straight", turn.path.end, left_m))
        came_from = waypoint
    if end_angle_rad is None:
        return join(Path(tuple(pieces)))
    straight = pieces.pop()
    arc = pieces.pop() if pieces and pieces[-1].kind != "straight" else straight.start.position
    ended = ingress(arc, came_from, Pose(*rest[-1], end_angle_rad), radius_m)
    return None if ended is None else join(Path((*pieces, *ended.segments)))


def _begun(first: Point, second: Point, angle_rad: float | None, radius_m: float) -> list[Segment] | None:
    """From the first waypoint towards the second, the last piece a straight."""
    if angle_rad is not None:
        path = egress(Pose(*first, angle_rad), second, radius_m)
        return None if path is None else list(path.segments)
    bearing_rad = math.atan2(second[1] - first[1], second[0] - first[0])
    return [Segment("straight", Pose(*first, bearing_rad), math.dist(first, second))]


def _fewer(points: Array, clear: Callable[[Path], bool]) -> list[Array]:
    """The polyline without needless waypoints, then with those beside its ends, then as it is."""
    tried = [fewest(points, clear)]
    if len(points) > 3:
        tried.append(np.vstack([points[:1], fewest(points[1:-1], clear), points[-1:]]))
    if len(tried[-1]) < len(points):
        tried.append(points)
    return tried


def fewest(points: Array, clear: Callable[[Path], bool]) -> Array:
    """The fewest of a polyline's waypoints that clear straights join, ends included; of these the shortest.

    Parameters
    ----------
    points
        Shape (N, 2), N >= 2. Its own legs count as clear.
    """
    count = len(points)
    best = [(0, 0.0, 0)] + [(count, math.inf, 0)] * (count - 1)
    for here in range(count - 1):
        legs, length_m, _ = best[here]
        for there in range(here + 1, count):
            east_m, north_m = (float(value) for value in points[there] - points[here])
            reached = (legs + 1, length_m + math.hypot(east_m, north_m), here)
            if reached[:2] >= best[there][:2]:
                continue
            pose = Pose(float(points[here, 0]), float(points[here, 1]), math.atan2(north_m, east_m))
            if there == here + 1 or clear(Path((Segment("straight", pose, math.hypot(east_m, north_m)),))):
                best[there] = reached
    kept = [count - 1]
    while kept[-1] > 0:
        kept.append(best[kept[-1]][2])
    return points[kept[::-1]]
