"""Round one polygon: as short as a fine grid of ways past its corners says, with directions at both ends."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from shapely.geometry import LineString, MultiPoint, Polygon

from planner.airspace.zones import KeepOut, PolygonZone
from planner.dubins.words import candidates
from planner.route import Anchor, Pose
from planner.transit.tangent import connect

RADIUS_M = 100.0
#: Lines are drawn in chords; they may leave the polygon's inside untouched but for this much of its rim.
RIM_M = 0.05

#: A corner and which of its directions.
State = tuple[int, int]


def clear_m(start: Pose, goal: Pose, inside: Polygon) -> float:
    """Length of the shortest Dubins word that shapely finds clear of the polygon; inf without any."""
    for word in candidates(start, goal, RADIUS_M):
        places = word.sample(2.0)[:, :2]
        if len(places) < 2 or not LineString(places).intersects(inside):
            return word.length_m
    return math.inf


class Grid:
    """Directions at corners, and the shortest way past them, one corner after the next on one side."""

    def __init__(self, polygon: Polygon, start: Pose, goal: Pose) -> None:
        self.inside = polygon.buffer(-RIM_M)
        self.corners = shapely.get_coordinates(shapely.geometry.polygon.orient(polygon))[:-1]
        self.start, self.goal = start, goal

    def shortest(self, angles: dict[int, np.ndarray], side: int, known_m: float) -> tuple[float, list[State]]:
        """Its length and what it passes; ways no shorter than ``known_m`` are left out."""
        poses = {
            v: [Pose(self.corners[v, 0], self.corners[v, 1], float(a)) for a in angles[v]] for v in angles
        }
        reached: dict[State, tuple[float, State | None]] = {}
        for v in poses:
            for k, pose in enumerate(poses[v]):
                reached[v, k] = clear_m(self.start, pose, self.inside), None
        for v in [*poses, *poses]:
            after = (v + side) % len(self.corners)
            for k, pose in enumerate(poses[v]):
                so_far = reached[v, k][0]
                for m, other in enumerate(poses.get(after, [])):
                    least_m = so_far + math.dist(pose.position, other.position)
                    if least_m < min(reached[after, m][0], known_m):
                        found_m = so_far + clear_m(pose, other, self.inside)
                        if found_m < reached[after, m][0]:
                            reached[after, m] = found_m, (v, k)
        whole = {
            (v, k): so_far + clear_m(poses[v][k], self.goal, self.inside)
            for (v, k), (so_far, _) in reached.items()
            if so_far < known_m
        }
        if not whole or not math.isfinite(min(whole.values())):
            return math.inf, []
        last: State | None = min(whole, key=lambda state: whole[state])
        best_m, passed = min(whole.values()), []
        while last is not None and len(passed) <= len(self.corners):
            passed.append(last)
            last = reached[last][1]
        return best_m, passed


def reference_m(polygon: Polygon, start: Pose, goal: Pose) -> float:
    """The shortest of: a clear word; clear words from corner to corner, in any direction at each.

    A shortest line round a convex polygon is of arcs and straights that touch it at corners. Directions are
    a grid, finer round the best.
    """
    grid = Grid(polygon, start, goal)
    best_m = clear_m(start, goal, grid.inside)
    for side in (1, -1):
        step = math.tau / 24
        angles = {v: np.arange(24) * step for v in range(len(grid.corners))}
        for _ in range(4):
            found_m, passed = grid.shortest(angles, side, best_m + 50.0)
            best_m = min(best_m, found_m)
            near = np.arange(-6, 7) / 6.0 * step
            angles = {v: angles[v][k] + near for v, k in passed}
            step /= 6.0
    return best_m


@pytest.mark.parametrize("seed", range(12))
def test_as_short_as_the_fine_grid_says(seed: int) -> None:
    """From pose to pose round one polygon: the reference's length to a thousandth, and nothing is entered."""
    rng = np.random.default_rng(seed)
    polygon = MultiPoint(rng.normal(0.0, 400.0, (5, 2))).convex_hull
    assert isinstance(polygon, Polygon)
    far_m = float(np.hypot(*shapely.get_coordinates(polygon).T).max())
    bearing = rng.uniform(-math.pi, math.pi)
    poses = []
    for turned in (bearing, bearing + rng.uniform(0.6, 1.4) * math.pi):
        away_m = far_m + rng.uniform(250.0, 1200.0)
        place = away_m * math.cos(turned), away_m * math.sin(turned)
        poses.append(Pose(*place, float(rng.uniform(-math.pi, math.pi))))
    start, goal = poses
    zones = KeepOut(polygons=(PolygonZone("p", polygon, True),))
    path = connect(
        Anchor(*start.position, start.angle_rad), Anchor(*goal.position, goal.angle_rad), zones, RADIUS_M
    )
    assert not LineString(path.sample(1.0)[:, :2]).intersects(polygon.buffer(-RIM_M))
    reference = reference_m(polygon, start, goal)
    assert reference - 1.0 < path.length_m < reference * 1.001
