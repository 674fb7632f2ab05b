"""Measures of a flight, against figures worked by hand and a raster."""

import numpy as np
import pytest
import shapely
from shapely.geometry import box

from planner.coverage.urban.area import UrbanArea
from planner.coverage.urban.free import free_space
from planner.coverage.urban.measures import Flown, Sweep, corners, coverage, measure, overlap_m

URBAN = UrbanArea(box(0, 0, 200, 60), (), 20.0, 30.0, 25.0, 150.0, 10.0, (0, 0), (0, 0), span_m=0.0)


def test_measures_of_a_plain_flight() -> None:
    """Three lanes back and forth over a rectangle: 200 m each, 20 m between, nothing seen twice."""
    sweeps = (Sweep((0, 10), (200, 10)), Sweep((200, 30), (0, 30)), Sweep((0, 50), (200, 50)))
    places = [(0, 10), (200, 10), (200, 30), (0, 30), (0, 50), (200, 50)]
    line = np.array([(*place, 25.0) for place in places])
    found = measure(URBAN, free_space(URBAN), Flown(sweeps, line))
    assert found.length_m == pytest.approx(640.0)
    assert (found.sweeps, found.turns, found.coverage) == (3, 4, pytest.approx(1.0))
    assert found.overlap_m == pytest.approx(0.0, abs=1e-6)
    assert found.duration_s == pytest.approx(640.0 / 10.0 + 4 * 4.0)


def test_overlap_is_the_ground_seen_again_over_the_width() -> None:
    """Lanes half a width apart see half their ground twice."""
    sweeps = (Sweep((0, 20), (100, 20)), Sweep((100, 30), (0, 30)))
    assert overlap_m(sweeps, URBAN.area, 20.0) == pytest.approx(50.0)


def test_coverage_agrees_with_a_raster() -> None:
    """Random sweeps see the part of a metre grid that lies within half a width and half a frame of them."""
    rng = np.random.default_rng(3)
    sweeps = tuple(Sweep(tuple(a), tuple(b)) for a, b in rng.uniform(0, 200, (6, 2, 2)))
    ground = box(0, 0, 200, 200)
    east, north = np.meshgrid(np.arange(0.25, 200, 0.5), np.arange(0.25, 200, 0.5))
    seen = np.zeros(east.shape, dtype=bool)
    for sweep in sweeps:
        along = np.subtract(sweep.end, sweep.start) / sweep.length_m
        x, y = east - sweep.start[0], north - sweep.start[1]
        ahead, aside = x * along[0] + y * along[1], y * along[0] - x * along[1]
        seen |= (ahead >= -15.0) & (ahead <= sweep.length_m + 15.0) & (np.abs(aside) <= 10.0)
    assert coverage(sweeps, ground, 20.0, 15.0) == pytest.approx(seen.mean(), abs=2e-3)


def test_climbs_count_as_corners_and_straight_vertices_do_not() -> None:
    """A vertex on a straight is no turn; a change of slope is one."""
    assert corners(np.array([(0, 0, 25), (5, 0, 25), (10, 0, 25.0)])) == 0
    assert corners(np.array([(0, 0, 25), (10, 0, 25), (10, 0, 60), (30, 0, 60.0)])) == 2


def test_the_ground_below_a_sweep_lies_along_it() -> None:
    """A diagonal sweep sees a rectangle of its own direction."""
    seen = Sweep((0, 0), (30, 40)).seen(20.0, 15.0)
    assert seen.area == pytest.approx(20.0 * 80.0)
    assert shapely.hausdorff_distance(seen.centroid, shapely.Point(15, 20)) < 1e-9
