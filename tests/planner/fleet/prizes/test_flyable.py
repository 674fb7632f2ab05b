"""Lines among polygons are judged by geometry of the test's own."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
import shapely
from shapely.geometry import LineString, Point, Polygon

from planner.dubins.words import candidates
from planner.fleet.prizes.flyable import Collected, Field, dense_points, most_reward
from planner.fleet.prizes.lines_kernels import WORDS, shortest_clear, word, word_clear
from planner.fleet.prizes.roadmap import fence_of, headings_for
from planner.route import Pose

RADIUS = 60.0


def _field(seed: int, radius: float, boxes: int = 12, targets: int = 8) -> Field:
    """Turned boxes in a square of 1,500 with a border, and places outside of them."""
    generator = np.random.default_rng(seed)
    polygons: list[Polygon] = []
    while len(polygons) < boxes:
        box = shapely.box(0.0, 0.0, *generator.uniform(60.0, 250.0, 2))
        turned = shapely.affinity.rotate(box, generator.uniform(0.0, 90.0))
        moved = shapely.affinity.translate(turned, *generator.uniform(150.0, 1150.0, 2))
        if all(moved.disjoint(other) for other in polygons):
            polygons.append(moved)
    places: list[tuple[float, float]] = []
    while len(places) < targets + 2:
        place = tuple(float(v) for v in generator.uniform(80.0, 1420.0, 2))
        if all(polygon.distance(Point(place)) > 1.0 for polygon in polygons):
            places.append((place[0], place[1]))
    rewards = tuple(float(v) for v in np.round(generator.uniform(1.0, 30.0, targets)))
    border = shapely.box(0.0, 0.0, 1500.0, 1500.0)
    return Field(places[0], places[1], tuple(places[2:]), rewards, tuple(polygons), border, radius)


def _judged(field: Field, found: Collected, budget: float) -> None:
    """Ends, step, length, polygons, border, curvature, and the targets the line truly passes."""
    ends = [*(field.targets[k] for k in found.targets), field.end]
    points = np.array(dense_points(found, ends, 1.0))
    steps = np.diff(points, axis=0)
    lengths = np.hypot(*steps.T)
    assert points[0].tolist() == pytest.approx(field.start)
    assert points[-1].tolist() == pytest.approx(field.end)
    assert lengths.max() <= 1.0 + 1e-9
    assert lengths.sum() <= budget
    assert lengths.sum() == pytest.approx(found.length, abs=0.05)
    line = LineString(points)
    for polygon in field.polygons:
        assert line.intersection(polygon.buffer(-1e-9)).is_empty
    assert field.border is not None
    assert field.border.covers(line)
    passed = [
        r for place, r in zip(field.targets, field.rewards, strict=True) if line.distance(Point(place)) < 1e-6
    ]
    assert sum(passed) >= found.reward
    assert len(set(found.targets)) == len(found.targets)
    assert found.reward == pytest.approx(sum(field.rewards[k] for k in found.targets))
    if field.radius > 0.0:
        angles = np.arctan2(steps[:, 1], steps[:, 0])
        turns = np.abs((np.diff(angles) + math.pi) % (2.0 * math.pi) - math.pi)
        # The turn between two chords of an arc is that of the arc between their middles.
        assert (turns <= 0.5 * (lengths[1:] + lengths[:-1]) / field.radius + 1e-6).all()


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("radius", [RADIUS, 0.0])
def test_lines_are_flyable(seed: int, radius: float) -> None:
    """Whatever the map, the line keeps to all that is asked of it."""
    field = _field(seed, radius)
    # What the first route found brings is flown as the best is.
    for budget, pools in ((1500.0, 1 if seed == 0 else 0), (3000.0, 0)):
        try:
            found = most_reward(field, budget, seed, pools=pools)
        except ValueError:
            assert math.dist(field.start, field.end) > 0.5 * budget
            continue
        _judged(field, found, budget)


def test_more_budget_brings_no_less() -> None:
    """With a larger budget comes no less reward, and all of it in the end."""
    field = _field(2, RADIUS, boxes=6, targets=5)
    rewards = [most_reward(field, budget, 1).reward for budget in (2000.0, 9000.0)]
    assert rewards == sorted(rewards)
    assert rewards[-1] == sum(field.rewards)


def test_the_same_with_any_seed_and_threads_alike() -> None:
    """One seed and number of threads gives one line."""
    field = _field(3, RADIUS, boxes=6, targets=5)
    assert most_reward(field, 1800.0, 7, threads=2) == most_reward(field, 1800.0, 7, threads=2)


def test_targets_in_polygons_are_left_out() -> None:
    """A place inside a polygon is not reached, one on its edge is."""
    box = shapely.box(400.0, -100.0, 600.0, 100.0)
    field = Field((0.0, 0.0), (1000.0, 0.0), ((500.0, 0.0), (500.0, 100.0)), (9.0, 1.0), (box,), None, RADIUS)
    found = most_reward(field, 5000.0, 0)
    assert found.targets == (1,)


def test_no_way_is_said() -> None:
    """A start that is walled in, or a budget too small, is an error, not an empty line."""
    wall = shapely.box(-100.0, -100.0, 100.0, 100.0).difference(shapely.box(-90.0, -90.0, 90.0, 90.0))
    sides = tuple(shapely.constrained_delaunay_triangles(wall).geoms)
    with pytest.raises(ValueError, match="over the budget"):
        most_reward(Field((0.0, 0.0), (500.0, 0.0), (), (), sides, None, 10.0), 5000.0, 0)
    with pytest.raises(ValueError, match="over the budget"):
        most_reward(Field((0.0, 0.0), (500.0, 0.0), (), (), (), None, 10.0), 499.0, 0)


def test_words_are_those_of_the_plain_twin() -> None:
    """Lengths of all words as ``planner.dubins.words`` has them, and clear where shapely says so."""
    generator = np.random.default_rng(4)
    field = _field(0, RADIUS)
    fence = fence_of((), field.polygons, None)
    whole = shapely.union_all(field.polygons)
    for _ in range(60):
        start, goal = (
            np.array([*generator.uniform(0.0, 1500.0, 2), generator.uniform(-math.pi, math.pi)]) for _ in "ab"
        )
        if whole.buffer(0.1).covers(Point(start[:2])) or whole.buffer(0.1).covers(Point(goal[:2])):
            continue
        plain = candidates(Pose(*start), Pose(*goal), RADIUS)
        parts = [word(k, start, goal, RADIUS) for k in range(WORDS)]
        ours = sorted(RADIUS * sum(part) for part in parts if part[0] >= 0.0)
        assert ours == pytest.approx([path.length_m for path in plain], abs=1e-6)
        clear = [word_clear(k, start, part, RADIUS, *fence.arrays) for k, part in enumerate(parts)]
        lines = [LineString(path.sample(0.5)[:, :2]) for path in plain]
        free = [line.intersection(whole).length == 0.0 for line in lines]
        assert sum(clear) == sum(free)
        _, length = shortest_clear(start, goal, RADIUS, math.inf, *fence.arrays)
        best = min(
            (path.length_m for path, is_free in zip(plain, free, strict=True) if is_free), default=math.inf
        )
        assert length == pytest.approx(best)


def test_straight_ways_are_those_of_a_visibility_graph() -> None:
    """Without turns the way between two places is the shortest over all corners, found by brute force."""
    field = _field(1, 0.0, boxes=3, targets=0)
    found = most_reward(field, 9000.0, 0)
    corners = [point for polygon in field.polygons for point in polygon.exterior.coords[:-1]]
    nodes = [field.start, field.end, *corners]
    inner = [polygon.buffer(-1e-6) for polygon in field.polygons]
    away = np.full((len(nodes), len(nodes)), math.inf)
    for (i, a), (j, b) in itertools.combinations(enumerate(nodes), 2):
        if not any(LineString([a, b]).intersects(polygon) for polygon in inner):
            away[i, j] = away[j, i] = math.dist(a, b)
    for k in range(len(nodes)):
        away = np.minimum(away, away[:, k, None] + away[None, k])
    assert found.length == pytest.approx(away[0, 1], abs=1.0)
    assert found.length >= away[0, 1] - 1e-9


def test_headings_are_even() -> None:
    """Each heading has its opposite, few places have many and many have few."""
    counts = [headings_for(places) for places in (1, 17, 53, 500)]
    assert all(count % 2 == 0 for count in counts)
    assert counts == sorted(counts, reverse=True)
