"""Ways among obstacles, against shapely and a plain search."""

import math

import numpy as np
import pytest
import shapely
import shapely.affinity
from shapely.geometry import LineString, MultiPolygon, Polygon, box

from planner.coverage.urban.visibility import Ways, edges_of, walls_of
from planner.coverage.urban.visibility_kernels import crosses


def ground(seed: int) -> tuple[Polygon, np.random.Generator]:
    rng = np.random.default_rng(seed)
    blocks = [
        shapely.affinity.rotate(box(x, y, x + w, y + h), a)
        for x, y, w, h, a in rng.uniform((5, 5, 5, 5, 0), (85, 85, 25, 25, 90), (9, 5))
    ]
    free = box(0, 0, 100, 100).difference(shapely.union_all(blocks))
    return max(shapely.get_parts(free), key=lambda part: part.area), rng


def places(free: Polygon, rng: np.random.Generator, count: int) -> list[tuple[float, float]]:
    found: list[tuple[float, float]] = []
    while len(found) < count:
        place = tuple(float(v) for v in rng.uniform(0, 100, 2))
        if free.contains(shapely.Point(place)):
            found.append(place)  # type: ignore[arg-type]
    return found


def plain_length(free: Polygon, start: tuple[float, float], end: tuple[float, float]) -> float:
    """Bellman and Ford over all corners, with shapely for eyes."""
    grown = free.buffer(1e-3, join_style="mitre")
    corners = [start, end, *map(tuple, shapely.get_coordinates(free).tolist())]
    sees = [[grown.covers(LineString([a, b])) for b in corners] for a in corners]
    best = [0.0] + [math.inf] * (len(corners) - 1)
    for _ in corners:
        for i, a in enumerate(corners):
            for j, b in enumerate(corners):
                if sees[i][j]:
                    best[j] = min(best[j], best[i] + math.dist(a, b))
    return best[1]


@pytest.mark.parametrize("seed", [1, 2])
def test_ways_are_shortest(seed: int) -> None:
    """A way stays within the ground and is as long as the plain search says; so is the table of lengths."""
    free, rng = ground(seed)
    ways = Ways.through(free)
    ends = places(free, rng, 4)
    table = ways.lengths_m(np.array(ends[:2]), np.array(ends[2:]))
    for i, start in enumerate(ends[:2]):
        for j, end in enumerate(ends[2:]):
            line = ways.way(start, end)
            assert line is not None
            assert free.buffer(2e-3).covers(LineString(line))
            expected = plain_length(free, start, end)
            assert LineString(line).length == pytest.approx(expected, abs=1e-6)
            assert table[i, j] == pytest.approx(expected, abs=1e-6)


def test_places_apart_have_no_way() -> None:
    """Two pieces of ground are not joined."""
    ways = Ways.through(MultiPolygon([box(0, 0, 10, 10), box(20, 0, 30, 10)]))
    assert ways.way((5, 5), (25, 5)) is None
    assert np.isinf(ways.lengths_m(np.array([(5.0, 5.0)]), np.array([(25.0, 5.0)]))).all()


def test_a_way_along_a_wall_is_clear() -> None:
    """Sweeps end on the edge of the ground: a line along it, or from it, is no crossing."""
    ways = Ways.through(box(0, 0, 100, 100).difference(box(40, 0, 60, 50)))
    assert ways.is_clear((40, 0), (40, 50))
    assert ways.is_clear((0, 0), (0, 100))
    line = ways.way((40, 10), (60, 10))
    assert line is not None
    assert LineString(line).length == pytest.approx(40.0 + 40.0 + 20.0)


def test_a_grid_finds_what_looking_at_all_edges_finds() -> None:
    """Random lines, some beyond the ground, level and upright ones too."""
    free, rng = ground(3)
    walls = walls_of(edges_of(free))
    rings = shapely.union_all([free.exterior, *free.interiors])
    lines = rng.uniform(-20, 120, (400, 4))
    lines[:50, 3], lines[50:100, 2] = lines[:50, 1], lines[50:100, 0]
    for line in lines.tolist():
        assert crosses(walls, *line) == rings.intersects(LineString([line[:2], line[2:]]))
