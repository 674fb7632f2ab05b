"""Make a polyline flyable.

Along the polyline stand poses the aircraft may fly through: the start, the middle of every leg in the leg's
direction, the end. Lines from each to every later one make a graph without cycles; the best way through it
is a line continuous in place and direction. Its edges are the fillet (straight, arc, straight) where the legs
are long enough for one, and the Dubins words.

Edges are tested against the zones only once they lie on the best way (lazy search), since the test costs far
more than the length.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from planner.angles import wrap_pi
from planner.dubins.kernels import cheapest_steps, dubins_matrix
from planner.dubins.path import Path, Segment, join
from planner.dubins.words import candidates
from planner.route import Pose

SmoothingMethod = Literal["fillet", "shortcut"]

#: Waypoints nearer than this to their forerunner are the same waypoint.
SAME_PLACE_M = 1e-6

#: Directions this close, in radians, are the same.
STRAIGHT_RAD = 1e-9

Array = NDArray[np.float64]


def smooth(
    waypoints: ArrayLike,
    start_angle_rad: float | None,
    end_angle_rad: float | None,
    radius_m: float,
    clear: Callable[[Path], bool],
    method: SmoothingMethod = "fillet",
) -> Path:
    """A line along a polyline with no turn tighter than a radius.

    Parameters
    ----------
    waypoints
        Shape (N, 2), N >= 2: east_m, north_m.
    start_angle_rad, end_angle_rad
        Direction at the first and the last waypoint; that of the first or last leg where None.
    radius_m
        Smallest turn radius, > 0.
    clear
        Says whether a piece may be flown.
    method
        ``"fillet"`` keeps to the legs: it skips as few as it can of those too short to turn between, and
        avoids loops. ``"shortcut"`` is the shortest way through the poses.

    Returns
    -------
    Path
        From the first waypoint to the last, exactly in the directions given, turns never tighter than the
        radius. Pieces for which ``clear`` is false are in it only where every way has one; the fewest then.
    """
    points = distinct(np.asarray(waypoints, dtype=np.float64))
    poses, along_m = _poses(points, start_angle_rad, end_angle_rad)
    graph = _Graph(poses, along_m, radius_m, clear, method)
    while True:
        way = graph.best_way()
        if not graph.test(way):
            return join(*(graph.pieces[edge] for edge in way))


def fillet(start: Pose, goal: Pose, radius_m: float) -> Path | None:
    """Straight on, one arc, straight on: the rounded corner between two poses; None where there is no room.

    The tangents of an arc that turns by τ meet r tan(τ/2) before and after it.
    """
    turn_rad = wrap_pi(goal.angle_rad - start.angle_rad)
    east_m, north_m = goal.east_m - start.east_m, goal.north_m - start.north_m
    cosine, sine = math.cos(start.angle_rad), math.sin(start.angle_rad)
    ahead_m, aside_m = east_m * cosine + north_m * sine, north_m * cosine - east_m * sine
    if abs(math.sin(turn_rad)) < STRAIGHT_RAD:
        if math.cos(turn_rad) < 0.0 or abs(aside_m) > SAME_PLACE_M or ahead_m < 0.0:
            return None
        return Path((Segment("straight", start, ahead_m),))
    after_m = aside_m / math.sin(turn_rad)
    before_m = ahead_m - after_m * math.cos(turn_rad)
    tangent_m = radius_m * math.tan(abs(turn_rad) / 2.0)
    if min(before_m, after_m) < tangent_m:
        return None
    straight = Segment("straight", start, before_m - tangent_m)
    arc = Segment("left" if turn_rad > 0.0 else "right", straight.end, abs(turn_rad) * radius_m, radius_m)
    return join(Path((straight, arc, Segment("straight", arc.end, after_m - tangent_m))))


class _Graph:
    """Poses in flight order, and what each Dubins line between them costs as far as is known.

    The cost counts, each outweighing all that follow: pieces not clear, loops and poses skipped (for
    ``"fillet"``), metres.
    """

    def __init__(
        self,
        poses: Array,
        along_m: Array,
        radius_m: float,
        clear: Callable[[Path], bool],
        method: SmoothingMethod,
    ) -> None:
        self.poses = poses
        self.radius_m = radius_m
        self.clear = clear
        self.method = method
        self.pieces: dict[tuple[int, int], Path] = {}
        count = len(poses)
        lengths_m = dubins_matrix(poses, poses, radius_m)
        unit = float(10.0 * (np.diagonal(lengths_m, 1).sum() + radius_m))
        self.loop_cost = unit * count if method == "fillet" else 0.0
        skip_cost = unit if method == "fillet" else 0.0
        self.blocked_cost = unit * count * count
        # A line this much longer than the polyline between its ends turns round once more than needed.
        self.loop_length_m = along_m[None, :] - along_m[:, None] + math.pi * radius_m
        index = np.arange(count)
        skipped = index[None, :] - index[:, None] - 1.0
        self.extra = skip_cost * skipped
        self.cost = self._cost(lengths_m)
        self.cost[skipped < 0.0] = math.inf

    def _cost(self, lengths_m: Array) -> Array:
        return lengths_m + self.extra + np.where(lengths_m > self.loop_length_m, self.loop_cost, 0.0)

    def best_way(self) -> list[tuple[int, int]]:
        """Edges of the cheapest way from the first pose to the last."""
        before = cheapest_steps(self.cost)
        way: list[tuple[int, int]] = []
        j = len(before) - 1
        while j > 0:
            way.append((int(before[j]), j))
            j = int(before[j])
        return way[::-1]

    def _lines(self, edge: tuple[int, int]) -> Iterator[Path]:
        """Lines that may serve as an edge, the preferred first; made when asked for."""
        (start, goal) = (Pose(*map(float, self.poses[node])) for node in edge)
        corner = fillet(start, goal, self.radius_m)
        if corner is None:
            yield from candidates(start, goal, self.radius_m)
        elif self.method == "fillet":
            yield corner
            yield from candidates(start, goal, self.radius_m)
        else:
            yield from sorted(
                [corner, *candidates(start, goal, self.radius_m)], key=lambda path: path.length_m
            )

    def test(self, way: list[tuple[int, int]]) -> bool:
        """Test the edges of a way that were not yet; whether any turned out dearer than was thought."""
        dearer = False
        for edge in way:
            if edge in self.pieces:
                continue
            piece = next((line for line in self._lines(edge) if self.clear(line)), None)
            self.pieces[edge] = piece or next(self._lines(edge))
            length_m = self.pieces[edge].length_m
            cost = length_m + float(self.extra[edge])
            cost += self.loop_cost if length_m > self.loop_length_m[edge] else 0.0
            cost += self.blocked_cost if piece is None else 0.0
            dearer = dearer or cost > self.cost[edge] + 1e-6
            self.cost[edge] = cost
        return dearer


def distinct(points: Array) -> Array:
    """The waypoints without those that repeat their forerunner; at least two."""
    if points.ndim != 2 or points.shape[1] != 2 or len(points) < 2 or not np.isfinite(points).all():
        raise ValueError(f"waypoints need the shape (N, 2), N >= 2, finite, not {points.shape}")
    kept = [0]
    for i in range(1, len(points)):
        if np.hypot(*(points[i] - points[kept[-1]])) > SAME_PLACE_M:
            kept.append(i)
    if kept[-1] != len(points) - 1 and len(kept) > 1:
        kept[-1] = len(points) - 1
    return points[kept] if len(kept) > 1 else points[[0, -1]]


def _poses(points: Array, start_angle_rad: float | None, end_angle_rad: float | None) -> tuple[Array, Array]:
    """Poses (K, 3) to fly through, and how far along the polyline they stand (K)."""
    legs = np.diff(points, axis=0)
    lengths_m = np.hypot(legs[:, 0], legs[:, 1])
    angles = np.arctan2(legs[:, 1], legs[:, 0])
    reached_m = np.concatenate([[0.0], np.cumsum(lengths_m)])
    middles = np.column_stack([points[:-1] + 0.5 * legs, angles])
    first = [*points[0], angles[0] if start_angle_rad is None else start_angle_rad]
    last = [*points[-1], angles[-1] if end_angle_rad is None else end_angle_rad]
    along_m = np.concatenate([[0.0], reached_m[:-1] + 0.5 * lengths_m, reached_m[-1:]])
    return np.vstack([first, middles, last]), along_m
