"""Algorithm 1 of Snyder et al. (2021), on grids where it can be followed by hand."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.importance_maps import maps
from planner.search.importance.grid import ImportanceGrid
from planner.search.importance.snyder2021 import snyder2021
from planner.search.importance.walk import Walk, measured


def _row(*worth: float) -> ImportanceGrid:
    return ImportanceGrid(np.array([worth]), np.zeros((1, len(worth)), dtype=np.bool_), cell_m=10.0)


def test_goes_to_the_most_reward_less_its_distance() -> None:
    """100 three cells away beats 10 beside it; the way back is over cells seen."""
    walk = snyder2021(_row(10.0, 0.0, 1.0, 1.0, 100.0), base=1, battery=6)
    assert walk.cells.tolist() == [1, 2, 3, 4, 3, 2, 1]


def test_the_printed_form_goes_to_the_least() -> None:
    """The argmin as printed goes the other way, for one cell of little worth."""
    walk = snyder2021(_row(0.0, 0.0, 1.0, 100.0), base=1, battery=4, target="printed")
    assert walk.cells.tolist()[:2] == [1, 0]


def test_a_target_beyond_the_battery_ends_the_exploration() -> None:
    """The paper's algorithm goes home; asked to, it tries the next targets instead."""
    grid = _row(10.0, 0.0, 1.0, 1.0, 100.0)
    assert snyder2021(grid, base=1, battery=4).cells.tolist() == [1]
    assert snyder2021(grid, base=1, battery=4, refused="next").cells.tolist() == [1, 0, 1, 2, 1]


def test_the_way_home_avoids_what_was_seen_where_it_is_as_short() -> None:
    """Of two ways home of the same length the one over new cells is flown."""
    worth = np.array([[1.0, 1.0, 1.0], [1.0, 0.0, 1.0], [1.0, 1.0, 100.0]])
    grid = ImportanceGrid(worth, np.zeros((3, 3), dtype=np.bool_))
    walk = snyder2021(grid, base=0, battery=8)
    assert walk.cells[4] == 8
    assert measured(grid, walk).revisits == 0
    assert len(set(walk.cells.tolist())) == walk.moves == 8


@pytest.mark.parametrize("index", range(0, 20, 3))
def test_walks_are_closed_and_within_the_battery(index: int) -> None:
    """Neighbouring cells from the base back to it, at most as many as the battery has moves."""
    one = list(maps())[index]
    for refused in ("return", "next"):
        walk = snyder2021(one.grid, one.base, one.battery, refused=refused)  # type: ignore[arg-type]
        assert walk.cells[0] == walk.cells[-1] == one.base
        assert walk.moves <= one.battery
        row, column = np.divmod(walk.cells, one.grid.shape[1])
        assert (np.abs(np.diff(row)) + np.abs(np.diff(column)) == 1).all()


def test_measures_are_those_of_the_paper() -> None:
    """J1 is area, J2 what is left, J3 the worth of cells seen once, and their weighted sum."""
    walk = Walk(np.array([1, 2, 3, 2, 1]), battery=6)
    found = measured(_row(10.0, 0.0, 1.0, 7.0, 100.0), walk)
    assert (found.covered_m2, found.unspent, found.importance, found.revisits) == (300.0, 2, 8.0, 1)
    assert found.cost((1.0, 10.0, 2.0)) == -300.0 + 20.0 - 16.0
    assert found.total_reward() == 8.0 - 100.0 - 2.0
