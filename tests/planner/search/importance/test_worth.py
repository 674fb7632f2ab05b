"""The worth of ground from polygons, points and samples."""

from __future__ import annotations

import numpy as np
import pytest
from shapely.geometry import Point, box

from planner.search.importance.grid import (
    ImportanceGrid,
    over,
    seen,
    with_points,
    with_polygons,
    with_samples,
)
from planner.search.values import Worth

EMPTY = Worth(np.zeros((30, 40)), -100.0, 50.0, 10.0)


def test_polygons_are_worth_their_area() -> None:
    """What all cells come to is score times area, wherever edges lie, and adds up where polygons overlap."""
    scored = [(box(-83.0, 71.0, 51.0, 133.0), 2.0), (Point(100.0, 200.0).buffer(47.0), 0.5)]
    worth = with_polygons(EMPTY, scored)
    assert worth.total == pytest.approx(sum(shape.area * score for shape, score in scored))
    assert worth.scores[2, 1] == pytest.approx(2.0 * 0.3 * 0.9)


def test_points_spread_as_normal_distributions() -> None:
    """All of it lies on the map where that is wide enough, most of it at the point."""
    worth = with_points(EMPTY, [(100.0, 200.0, 25.0, 3.0)])
    assert worth.total == pytest.approx(3.0, rel=1e-3)
    north, east = np.unravel_index(worth.scores.argmax(), worth.scores.shape)
    assert np.hypot(*(worth.centres_m[north, east] - (100.0, 200.0))) < 10.0


def test_samples_that_tell_nothing_add_nothing() -> None:
    """NaN of a raster is no worth."""
    samples = np.ones(EMPTY.scores.shape)
    samples[3, 4] = np.nan
    worth = with_samples(EMPTY, samples)
    assert worth.scores[3, 4] == 0.0
    assert worth.total == pytest.approx(100.0 * (30 * 40 - 1))


def test_what_was_seen_is_worth_less() -> None:
    """A look takes its probability of detection off, of as much of a cell as was seen."""
    worth = with_samples(EMPTY, np.ones(EMPTY.scores.shape))
    fraction = np.zeros(EMPTY.scores.shape)
    fraction[0, :2] = 1.0, 0.5
    left = seen(worth, fraction, 0.8)
    assert left.scores[0, :3].tolist() == pytest.approx([0.2, 0.6, 1.0])


def test_cells_that_are_not_free_are_blocked() -> None:
    """Cells whose middle lies outside the free space are nobody's neighbours."""
    grid = over(EMPTY, box(-100.0, 50.0, 300.0, 94.0))
    assert grid.blocked.sum() == (30 - 4) * 40
    assert (grid.neighbours()[4 * 40 :] == -1).all()
    assert grid.neighbours()[41].tolist() == [42, 81, 40, 1]


@pytest.mark.parametrize("worth", [[[-1.0]], [[np.nan]], [[np.inf]], [[]]])
def test_worth_that_makes_no_sense_is_refused(worth: list[list[float]]) -> None:
    """Negative, not a number, without end, none."""
    values = np.array(worth)
    with pytest.raises(ValueError, match="worth"):
        ImportanceGrid(values, np.zeros(values.shape, dtype=np.bool_))
