"""Footprint sweeps see all free ground, judged by a raster; lanes against shapely."""

import math

import numpy as np
import pytest
import shapely
from shapely.geometry import LineString, box

from planner.coverage.urban.fitting import Fitting, directions
from planner.coverage.urban.free import free_space
from planner.coverage.urban.lanes_kernels import level_pieces
from planner.coverage.urban.visibility import edges_of
from tests.planner.coverage.urban.shapes import SHAPES, random_area, unseen


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("direction_rad", [0.0, 1.1])
def test_sweeps_see_all_free_ground_from_within_it(shape: str, direction_rad: float) -> None:
    """No place of a grid is left, and no sweep leaves the ground, whatever its direction."""
    urban = random_area(shape, 5)
    ground = free_space(urban).ground
    sweeps = Fitting.of(urban).sweeps(ground, direction_rad)
    assert unseen(sweeps, ground, 20.0, 15.0, 1.0) == 0
    grown = ground.buffer(1e-3)
    assert all(grown.covers(LineString([sweep.start, sweep.end])) for sweep in sweeps)


def test_a_plain_rectangle_takes_the_fewest_lanes_along_its_longer_side() -> None:
    """200 by 420 m: ten lanes of 20 m along the longer span, none twice."""
    ground = shapely.MultiPolygon([SHAPES["rectangle"]])
    fitting = Fitting(20.0, 15.0)
    first, second = directions(SHAPES["rectangle"], ground, fitting)
    assert math.isclose(math.sin(first), 0.0, abs_tol=1e-9)
    assert math.isclose(math.cos(second), 0.0, abs_tol=1e-9)
    sweeps = fitting.sweeps(ground, first)
    assert len(sweeps) == 10
    assert sum(sweep.length_m for sweep in sweeps) == pytest.approx(4200.0, rel=1e-4)


def test_of_equal_spans_the_free_space_decides() -> None:
    """A square with walls from south to north is swept from south to north, and the other way round."""
    walls = [box(x, 20, x + 10, 280) for x in (60, 140, 220)]
    upright = shapely.MultiPolygon([SHAPES["square"].difference(shapely.union_all(walls))])
    level = shapely.transform(upright, lambda places: places[:, ::-1])
    fitting = Fitting(20.0, 15.0)
    assert abs(math.sin(directions(SHAPES["square"], upright, fitting)[0])) == pytest.approx(1.0)
    assert abs(math.cos(directions(SHAPES["square"], level, fitting)[0])) == pytest.approx(1.0)


def test_level_pieces_are_those_of_the_overlay() -> None:
    """The compiled pieces of level lines are what shapely cuts."""
    ground = free_space(random_area("irregular", 8)).ground
    heights = np.random.default_rng(2).uniform(0, 330, 25)
    ends, owners = level_pieces(edges_of(ground), heights, 0.0)
    for k, height in enumerate(heights):
        parts = shapely.get_parts(LineString([(-10, height), (500, height)]).intersection(ground))
        expected = sorted((part.bounds[0], part.bounds[2]) for part in parts if not part.is_empty)
        assert ends[owners == k] == pytest.approx(np.array(expected).reshape(-1, 2), abs=1e-9)
