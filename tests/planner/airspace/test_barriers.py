"""Polygon zones in the first estimates: gone round as shapely has it, and known to the order."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from shapely.affinity import rotate, translate
from shapely.geometry import LineString, Point, Polygon, box

from planner.airspace import surroundings as module
from planner.airspace.barriers import COLUMNS, polygon_rows, rows_of
from planner.airspace.zones import keep_out
from planner.dubins.estimate_kernels import detour_m
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from tests.planner.scenarios import feature, small, square

places = st.tuples(st.floats(-1000.0, 1000.0), st.floats(-1000.0, 1000.0))
sides = st.floats(20.0, 900.0)
turns = st.floats(0.0, 360.0)


def by_visibility_m(start: tuple[float, float], end: tuple[float, float], zone: Polygon) -> float:
    """The shortest way round a convex polygon: over its corners, every order of up to three of them."""
    inside = zone.buffer(-1e-6)

    def free(*line: tuple[float, ...]) -> bool:
        return not LineString(line).intersects(inside)

    if free(start, end):
        return math.dist(start, end)
    best = math.inf
    for count in (1, 2, 3):
        for corners in itertools.permutations(list(zone.exterior.coords)[:-1], count):
            line = (start, *corners, end)
            if free(*line):
                best = min(best, sum(math.dist(a, b) for a, b in itertools.pairwise(line)))
    return best


@given(places, places, places, sides, sides, turns)
def test_rectangles_are_gone_round_by_the_shortest_way(
    start: tuple[float, float],
    end: tuple[float, float],
    middle: tuple[float, float],
    length_m: float,
    width_m: float,
    turned_deg: float,
) -> None:
    """Estimate and visibility graph agree; a rectangle that holds an end adds nothing."""
    zone = translate(rotate(box(-length_m, -width_m, length_m, width_m), turned_deg), *middle)
    extra_m = float(detour_m(*start, *end, polygon_rows((zone,))))
    if zone.intersects(Point(start)) or zone.intersects(Point(end)):
        assert extra_m == pytest.approx(0.0, abs=1e-3) or zone.boundary.distance(Point(start)) < 1e-3
        return
    assert math.dist(start, end) + extra_m == pytest.approx(by_visibility_m(start, end, zone), abs=1e-3)


def test_corners_a_polygon_lacks_are_not_gone_round() -> None:
    """A triangle's rectangle is as large as the triangle; a rectangle is its own."""
    triangle = Polygon([(0.0, 0.0), (800.0, 0.0), (0.0, 600.0)])
    (row,) = polygon_rows((triangle,))
    assert 4.0 * row[6] * row[7] == pytest.approx(triangle.area)
    (row,) = polygon_rows((box(-300.0, -50.0, 300.0, 50.0),))
    assert sorted(row[6:]) == pytest.approx([50.0, 300.0])
    assert row[:3] == pytest.approx([0.0, 0.0, math.hypot(300.0, 50.0)])


def test_priced_discs_are_crossed_where_that_is_cheaper() -> None:
    """The least of going round and of the price of the chord; without a price, round."""
    hard, soft = np.empty((0, 3)), np.array([[0.0, 0.0, 500.0]])
    none = np.empty((0, COLUMNS))
    line = (-2000.0, 10.0, 2000.0, 10.0)
    round_m = detour_m(*line, rows_of(hard, soft, np.array([np.inf]), none))
    assert round_m == pytest.approx(detour_m(*line, soft))
    chord_m = 2.0 * math.sqrt(500.0**2 - 10.0**2)
    assert detour_m(*line, rows_of(hard, soft, np.array([0.05]), none)) == pytest.approx(0.05 * chord_m)
    assert detour_m(*line, rows_of(hard, soft, np.array([5.0]), none)) == pytest.approx(round_m)
    wall = polygon_rows((box(-10.0, -3000.0, 10.0, 3000.0),))
    both = detour_m(*line, rows_of(hard, soft, np.array([np.inf]), wall))
    assert both == pytest.approx(round_m + detour_m(*line, wall))


def test_the_order_knows_of_walls(monkeypatch: pytest.MonkeyPatch) -> None:
    """Regions on both sides of a long wall: the tour passes it twice, no longer than one blind to it."""
    rois = [feature(f"R{k}", "roi", "Polygon", square(x, y, 0.003)) for k, (x, y) in enumerate(
        [(-0.02, 0.03), (-0.01, 0.05), (0.022, 0.035), (0.03, 0.052), (-0.03, 0.055), (0.035, -0.03)]
    )]  # fmt: skip
    ring = [[[0.008, -0.03], [0.011, -0.03], [0.011, 0.064], [0.008, 0.064], [0.008, -0.03]]]
    document = small(*rois, feature("W", "no_fly", "Polygon", ring))
    document["features"][0]["geometry"]["coordinates"] = square(-0.01, 0.0, 0.003)
    document["features"][2]["geometry"]["coordinates"] = square(-0.07, -0.07, 0.16)
    scenario = read_scenario(document)
    knowing = make_plan(scenario)
    monkeypatch.setattr(module, "polygon_rows", lambda polygons: np.empty((0, COLUMNS)))
    blind = make_plan(scenario)
    assert knowing.hard_violations == ()
    assert knowing.metrics.length_m <= blind.metrics.length_m + 1.0
    (wall,) = keep_out(scenario.airspace, scenario.level, 0.0).polygons
    axis = LineString([(wall.polygon.centroid.x, -1e5), (wall.polygon.centroid.x, 1e5)])
    line = LineString(scenario.frame.to_local([place[:2] for place in knowing.paths[0].line]))
    assert len(getattr(line.intersection(axis), "geoms", [0])) == 2


def test_passes_keep_off_polygons_by_more_than_transits_do() -> None:
    """A pass beside a wall leaves room for the transits' margin: the plan is made, and violates nothing."""
    ring = [[[-0.02, 0.0098], [0.03, 0.0098], [0.03, 0.0105], [-0.02, 0.0105], [-0.02, 0.0098]]]
    plan = make_plan(read_scenario(small(feature("W", "no_fly", "Polygon", ring))))
    assert plan.hard_violations == ()
