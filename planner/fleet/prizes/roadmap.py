"""Flyable ways between places among polygons: poses at places and at corners, joined by Dubins lines."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import Point, Polygon

from planner.fleet.prizes.roadmap_kernels import links, sight, ways

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Places = Sequence[tuple[float, float]]

#: Lines keep this far from polygons, less where a place lies nearer; corners are passed twice as far out.
CLEAR_M = 0.02
#: Places no further from an edge lie on it.
TOUCH_M = 1e-6
#: Headings at a corner are no further apart.
CORNER_STEP_RAD = math.radians(25.0)
#: Headings at each place: so many poses in all, between these numbers for each.
POSES, FEWEST, MOST = 850, 8, 24

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Fence:
    """What lines may not cross: edges (E, 4), the first of each polygon (K + 1,), boxes (K, 4)."""

    edges: Floats
    offsets: Ints
    boxes: Floats

    @property
    def arrays(self) -> tuple[Floats, Ints, Floats]:
        """As the kernels take them."""
        return self.edges, self.offsets, self.boxes


@dataclass(frozen=True, slots=True)
class Roadmap:
    """Poses joined by lines.

    Parameters
    ----------
    poses
        Shape (N, 3), those of places first, ``headings`` each.
    headings
        At each place.
    costs
        Shape (P, P, H, H): the shortest way from each place at each heading to each at each; inf without one.
    fence, radius
        What the lines go round, and the radius of their turns; 0 for straights with corners.
    """

    poses: Floats
    headings: int
    costs: Floats
    fence: Fence
    radius: float
    starts: Ints
    to: Ints
    lengths: Floats

    def way(self, leaving: int, arriving: int) -> tuple[int, ...]:
        """Poses of the shortest way between two poses of places, both among them."""
        places = len(self.costs) * self.headings
        _, before = ways(self.starts, self.to, self.lengths, places, leaving, leaving + 1, math.inf)
        chain = [arriving]
        while chain[-1] != leaving:
            chain.append(int(before[0, chain[-1]]))
        return tuple(reversed(chain))


def headings_for(places: int) -> int:
    """How many headings each of so many places gets: even, so that each has its opposite."""
    return 2 * (min(max(POSES // max(places, 1), FEWEST), MOST) // 2)


def roadmap(
    places: Places,
    polygons: Sequence[Polygon],
    border: Polygon | None,
    radius: float,
    most: float,
    threads: int = 1,
) -> Roadmap:
    """The roadmap among polygons, inside a border.

    Parameters
    ----------
    polygons
        May be touched, not entered.
    radius
        Of turns; 0 for straights with corners.
    most
        Longer ways are not wanted.
    threads
        Side by side; the answer does not depend on them.
    """
    fence = fence_of(places, polygons, border)
    headings = headings_for(len(places)) if radius > 0.0 else 1
    angles = np.arange(headings) * (2.0 * math.pi / headings)
    spots, at_corners = _corners(polygons, border, places, radius)
    points = np.array([*places, *spots], dtype=np.float64).reshape(-1, 2)
    poses = np.array(
        [(*place, angle) for place in places for angle in angles]
        + [(*spots[spot], angle) for spot, angle in at_corners]
    )
    point_of = np.array(
        [k // headings for k in range(len(places) * headings)]
        + [len(places) + spot for spot, _ in at_corners]
    )
    own = len(places) * headings
    seen = np.concatenate(_split(len(points), threads, lambda a, b: sight(points, a, b, *fence.arrays)))
    if radius > 0.0:
        parts = _split(
            len(poses),
            threads,
            lambda a, b: links(poses, point_of, seen, own, a, b, radius, most, *fence.arrays),
        )
    else:
        parts = [_straights(points, seen)]
    steps = np.concatenate([np.diff(part[0]) for part in parts])
    starts = np.concatenate([[0], np.cumsum(steps)])
    to, lengths = (np.concatenate([part[k] for part in parts]) for k in (1, 2))
    found = _split(own, threads, lambda a, b: ways(starts, to, lengths, own, a, b, most)[0][:, :own].copy())
    costs = np.concatenate(found).reshape(len(places), headings, len(places), headings).transpose(0, 2, 1, 3)
    return Roadmap(poses, headings, np.ascontiguousarray(costs), fence, radius, starts, to, lengths)


def fence_of(places: Places, polygons: Sequence[Polygon], border: Polygon | None) -> Fence:
    """Edges of the polygons, a little larger, and of the border where all places lie inside."""
    rings = []
    points = [Point(place) for place in places]
    for polygon in polygons:
        rings.append(_grown(polygon, _clearance(polygon, points)).exterior.coords)
    if border is not None and all(border.covers(point) for point in points):
        rings.append(border.exterior.coords)
    edges = [(*a, *b) for ring in rings for a, b in itertools.pairwise(ring)]
    table = np.array(edges, dtype=np.float64).reshape(-1, 4)
    offsets = np.cumsum([0, *(len(ring) - 1 for ring in rings)])
    boxes = np.array(
        [
            (
                min(x for x, _ in ring),
                min(y for _, y in ring),
                max(x for x, _ in ring),
                max(y for _, y in ring),
            )
            for ring in rings
        ]
    )
    return Fence(table, offsets, boxes.reshape(-1, 4))


def _clearance(polygon: Polygon, points: list[Point]) -> float:
    """How far lines keep from a polygon; a hair less than nothing where a place lies on its edge."""
    clear = CLEAR_M
    for point in points:
        away = polygon.exterior.distance(point)
        if away <= TOUCH_M:
            return -TOUCH_M
        if not polygon.covers(point):
            clear = min(clear, 0.5 * away)
    return clear


def _grown(polygon: Polygon, by: float) -> Polygon:
    return polygon.buffer(by, join_style="mitre", mitre_limit=10.0)


def _corners(
    polygons: Sequence[Polygon], border: Polygon | None, places: Places, radius: float
) -> tuple[list[tuple[float, float]], list[tuple[int, float]]]:
    """Places at convex corners, and poses there: which, and headings from one edge to the other."""
    spots: list[tuple[float, float]] = []
    poses: list[tuple[int, float]] = []
    grown = [_grown(polygon, 2.0 * CLEAR_M) for polygon in polygons]
    solid = shapely.union_all([_grown(polygon, CLEAR_M) for polygon in polygons])
    shapely.prepare(solid)
    for polygon in grown:
        ring = list(shapely.geometry.polygon.orient(polygon).exterior.coords)[:-1]
        for before, here, after in zip([ring[-1], *ring], ring, [*ring[1:], ring[0]], strict=False):
            arriving = math.atan2(here[1] - before[1], here[0] - before[0])
            leaving = math.atan2(after[1] - here[1], after[0] - here[0])
            turn = (leaving - arriving + math.pi) % (2.0 * math.pi) - math.pi
            if turn <= 1e-6 or solid.covers(Point(here)):
                continue
            if border is not None and not border.covers(Point(here)):
                continue
            spot = len(spots)
            spots.append((here[0], here[1]))
            steps = 1 + math.ceil(turn / CORNER_STEP_RAD) if radius > 0.0 else 0
            for k in range(steps):
                angle = arriving + turn * k / (steps - 1)
                poses += [(spot, angle), (spot, angle + math.pi)]
            if radius <= 0.0:
                poses.append((spot, 0.0))
    return spots, poses


def _straights(points: Floats, seen: NDArray[np.bool_]) -> tuple[Ints, Ints, Floats]:
    """What sees each other, joined by straights."""
    rows, columns = np.nonzero(seen)
    starts = np.concatenate([[0], np.cumsum(seen.sum(axis=1))])
    return starts, columns, np.hypot(*(points[rows] - points[columns]).T)


def _split(count: int, threads: int, work: Callable[[int, int], T]) -> list[T]:
    """Work on so many rows in slices, as many side by side as there are threads."""
    if threads == 1:
        return [work(0, count)]
    # More slices than threads: rows differ in what they take.
    bounds = np.linspace(0, count, 8 * threads + 1).astype(int)
    slices = [(int(a), int(b)) for a, b in itertools.pairwise(bounds) if b > a]
    with ThreadPoolExecutor(threads) as pool:
        return list(pool.map(lambda each: work(*each), slices))
