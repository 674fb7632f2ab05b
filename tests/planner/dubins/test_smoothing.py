"""Smoothed polylines are flyable and keep to the polyline where they can."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import dijkstra
from shapely.geometry import LineString, box

from planner.airspace.zones import Disc, KeepOut, PolygonZone
from planner.angles import wrap_pi
from planner.dubins.kernels import cheapest_steps
from planner.dubins.path import Path
from planner.dubins.smoothing import SmoothingMethod, smooth
from tests.planner.dubins.test_words import assert_flyable

RADIUS_M = 100.0
methods = st.sampled_from(["fillet", "shortcut"])


def anywhere(path: Path) -> bool:
    """Nothing is forbidden."""
    return True


@st.composite
def polylines(draw: st.DrawFn) -> np.ndarray:
    """What SSAS gives: legs of 100 m and more, turns of at most 30 degrees, the last up to 90."""
    count = draw(st.integers(1, 12))
    angle = draw(st.floats(-math.pi, math.pi))
    points = [np.array([draw(st.floats(-5000, 5000)), draw(st.floats(-5000, 5000))])]
    for leg in range(count):
        limit = math.radians(90.0 if leg in (1, count - 1) else 30.0)
        angle += draw(st.floats(-limit, limit)) if leg else 0.0
        length_m = draw(st.floats(100.0, 800.0))
        points.append(points[-1] + length_m * np.array([math.cos(angle), math.sin(angle)]))
    return np.array(points)


@settings(deadline=None)
@given(polylines(), st.none() | st.floats(-3.0, 3.0), st.none() | st.floats(-3.0, 3.0), methods)
def test_flyable_with_exact_ends(
    waypoints: np.ndarray, start_rad: float | None, end_rad: float | None, method: SmoothingMethod
) -> None:
    """Any polyline becomes continuous, no tighter than the radius, with the ends and directions asked."""
    path = smooth(waypoints, start_rad, end_rad, RADIUS_M, anywhere, method)
    assert_flyable(path, RADIUS_M)
    legs = np.diff(waypoints, axis=0)
    assert path.start.position == pytest.approx(tuple(waypoints[0]), abs=1e-9)
    assert path.end.position == pytest.approx(tuple(waypoints[-1]), abs=1e-5)
    start_rad = math.atan2(legs[0, 1], legs[0, 0]) if start_rad is None else start_rad
    end_rad = math.atan2(legs[-1, 1], legs[-1, 0]) if end_rad is None else end_rad
    assert abs(wrap_pi(path.start.angle_rad - start_rad)) < 1e-9
    assert abs(wrap_pi(path.end.angle_rad - end_rad)) < 1e-6


@settings(deadline=None)
@given(polylines())
def test_shortcut_is_never_longer_than_fillet(waypoints: np.ndarray) -> None:
    """The shortest way through all poses is at most as long as the one that keeps to the legs."""
    fillet = smooth(waypoints, None, None, RADIUS_M, anywhere, "fillet")
    shortcut = smooth(waypoints, None, None, RADIUS_M, anywhere, "shortcut")
    assert shortcut.length_m <= fillet.length_m + 1e-6
    assert shortcut.length_m >= math.dist(waypoints[0], waypoints[-1]) - 1e-6


def test_fillet_of_a_right_angle() -> None:
    """Two long legs at a right angle are joined by a quarter turn that cuts the corner by known amounts."""
    path = smooth([[0, 0], [500, 0], [500, 500]], None, None, RADIUS_M, anywhere)
    assert path.length_m == pytest.approx(1000.0 - 2.0 * RADIUS_M + math.pi / 2.0 * RADIUS_M)
    assert [segment.kind for segment in path.segments if segment.kind != "straight"] == ["left"]


def test_fillet_keeps_within_the_corner_cut() -> None:
    """Where every leg is long enough the line strays from the polyline no further than a fillet must."""
    turn = math.radians(30.0)
    angles = np.cumsum([0.0, turn, turn, -turn, -turn, turn])
    steps = 150.0 * np.column_stack([np.cos(angles), np.sin(angles)])
    waypoints = np.vstack([[0.0, 0.0], np.cumsum(steps, axis=0)])
    path = smooth(waypoints, None, None, RADIUS_M, anywhere)
    cut_m = RADIUS_M * (1.0 / math.cos(turn / 2.0) - 1.0)
    line = LineString(waypoints)
    flown = LineString(path.sample(1.0)[:, :2])
    assert flown.hausdorff_distance(line) <= cut_m + 0.01


def test_steep_ends_do_not_loop() -> None:
    """Directions 60 degrees off the first and the last leg are met without a full turn."""
    waypoints = np.column_stack([np.arange(0.0, 1300.0, 120.0), np.zeros(11)])
    path = smooth(waypoints, math.radians(60.0), math.radians(-60.0), RADIUS_M, anywhere)
    assert path.length_m < 1200.0 + 100.0


def test_zones_are_kept_clear() -> None:
    """A disc in the corner that the fillet would cut, and a wall on the short cut, are flown round."""
    waypoints = [[0, 0], [600, 0], [600, 600], [1200, 600]]
    zones = KeepOut(
        (Disc("d", 330.0, 270.0, 150.0, True),), (PolygonZone("wall", box(700, 100, 720, 450), True),)
    )
    methods: tuple[SmoothingMethod, ...] = ("fillet", "shortcut")
    for method in methods:
        path = smooth(waypoints, None, None, RADIUS_M, zones.clear, method)
        assert zones.clear(path)
        assert_flyable(path, RADIUS_M)


def test_blocked_ways_stay_flyable() -> None:
    """Where nothing is clear the line still keeps the radius and the ends."""
    path = smooth([[0, 0], [300, 0], [400, 200]], None, None, RADIUS_M, lambda _: False)
    assert_flyable(path, RADIUS_M)
    assert path.end.position == pytest.approx((400.0, 200.0), abs=1e-6)


def test_repeated_and_bad_waypoints() -> None:
    """Repeated waypoints count once; wrong shapes and NaN are refused."""
    path = smooth([[0, 0], [0, 0], [500, 0], [500, 0]], None, None, RADIUS_M, anywhere)
    assert path.length_m == pytest.approx(500.0)
    for bad in ([[0, 0]], [[0, 0, 0], [1, 1, 1]], [[0, 0], [math.nan, 1]]):
        with pytest.raises(ValueError, match="waypoints"):
            smooth(bad, None, None, RADIUS_M, anywhere)


@settings(deadline=None)
@given(st.integers(0, 10_000), st.integers(2, 30))
def test_cheapest_steps_are_those_of_dijkstra(seed: int, count: int) -> None:
    """Forerunners trace a way that costs what scipy's Dijkstra finds, past steps that cost inf."""
    rng = np.random.default_rng(seed)
    costs = rng.uniform(1.0, 100.0, (count, count))
    costs[rng.uniform(size=costs.shape) < 0.3] = np.inf
    # One way there always is.
    costs[np.arange(count - 1), np.arange(1, count)] = rng.uniform(1.0, 100.0, count - 1)
    before = cheapest_steps(costs)
    forward = np.triu(np.where(np.isfinite(costs), costs, 0.0), 1)
    expected = dijkstra(csr_matrix(forward), indices=0)
    for node in range(count):
        found, here = 0.0, node
        while here > 0:
            assert before[here] < here
            found, here = found + costs[before[here], here], int(before[here])
        assert found == pytest.approx(expected[node])
