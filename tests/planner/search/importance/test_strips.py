"""Walks over cells as strips of ground."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from shapely.geometry import LineString, box

from planner.search.importance.strips import WALKS, Cells, walked
from planner.search.values import Worth

WORTH = Worth(np.ones((40, 60)), 100.0, -50.0, 10.0)
ALL = box(-1e6, -1e6, 1e6, 1e6)


def _worth() -> Worth:
    generator = np.random.default_rng(4)
    hills = np.kron(generator.choice([0.0, 1.0, 10.0, 100.0], size=(10, 15)), np.ones((4, 4)))
    return Worth(hills, 100.0, -50.0, 10.0)


def test_cells_are_as_wide_as_the_swath_and_worth_what_they_hold() -> None:
    """No worth is lost or counted twice, whether widths divide the ground or not."""
    for width_m in (40.0, 70.0, 33.0):
        cells = Cells.of(WORTH, width_m, ALL)
        assert cells.grid.worth.sum() == pytest.approx(WORTH.total)
        assert cells.grid.shape == (math.ceil(400.0 / width_m), math.ceil(600.0 / width_m))


def test_strips_see_each_cell_of_a_walk_once() -> None:
    """Strips, as wide as cells, cover all cells walked over and no two of them the same ground."""
    cells = Cells.of(WORTH, 40.0, ALL)
    walk = np.array([0, 1, 2, 17, 32, 31, 30, 15, 0])
    strips = cells.strips(walk)
    bands = [LineString(strip).buffer(20.0, cap_style="flat") for strip in strips]
    seen = shapely.union_all(bands)
    assert seen.area == pytest.approx(sum(band.area for band in bands))
    for cell in set(walk.tolist()):
        east, north = cells.centre_m(cell)
        assert seen.buffer(1e-6).covers(box(east - 20.0, north - 20.0, east + 20.0, north + 20.0))


@pytest.mark.parametrize("name", sorted(WALKS))
def test_walks_stay_within_the_budget_and_what_is_free(name: str) -> None:
    """Strips together are no longer than the budget; none is over what is not free."""
    budget_m = 1500.0
    free = box(100.0, -50.0, 520.0, 350.0)
    ends = ((80.0, -20.0), (110.0, -70.0))
    found = list(walked(name, _worth(), 40.0, free, ends, budget_m))
    assert found
    for strips in found:
        places = [ends[0], *strips.reshape(-1, 2).tolist(), ends[1]]
        assert sum(math.dist(a, b) for a, b in zip(strips[:, 0], strips[:, 1], strict=True)) <= budget_m
        assert all(free.buffer(20.0 + 1e-6).covers(LineString(strip)) for strip in strips)
        assert math.dist(places[0], places[1]) < 100.0


def test_nothing_is_walked_where_nothing_is_free() -> None:
    """Blocked ground has no walk; a budget that only leads there and back has none, either."""
    ends = ((100.0, -50.0), (100.0, -50.0))
    assert not list(walked("importance", WORTH, 40.0, box(-500.0, -500.0, -400.0, -400.0), ends, 1e4))
    assert not list(walked("importance", WORTH, 40.0, ALL, ends, 60.0))
