"""The worth of ground by cells."""

import numpy as np
import pytest
from shapely.geometry import Point, box

from planner.search.values import Worth, worth_of_ground


def test_cells_hold_the_ground_s_area():
    """Cells of a disc are worth its area, but for those that its edge cuts."""
    disc = Point(30.0, -20.0).buffer(100.0, quad_segs=64)
    assert worth_of_ground(disc, 2.0).total == pytest.approx(disc.area, rel=2e-3)


def test_middles_begin_in_the_south_west():
    """The first cell's middle lies half a cell from the corner, rows go north and columns east."""
    middles = worth_of_ground(box(10.0, 20.0, 40.0, 40.0), 10.0).centres_m
    assert middles.shape == (2, 3, 2)
    assert middles[0, 0].tolist() == [15.0, 25.0]
    assert middles[1, 2].tolist() == [35.0, 35.0]


@pytest.mark.parametrize("wrong", [-1.0, np.nan, np.inf])
def test_scores_are_finite_and_not_negative(wrong):
    """A worth with anything else is refused."""
    with pytest.raises(ValueError, match="finite"):
        Worth(np.array([[1.0, wrong]]), 0.0, 0.0, 1.0)
