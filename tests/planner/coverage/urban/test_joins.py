"""Joins between ends of sweeps among obstacles, and the order of sweeps."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import shapely

from planner.coverage.urban.free import free_space
from planner.coverage.urban.joins import Joins
from planner.coverage.urban.reach_kernels import join_lengths
from planner.coverage.urban.visibility import Ways
from planner.coverage.urban.waypoints import Joiner
from tests.planner.coverage.urban.test_auto import TOWN


@pytest.mark.parametrize("highest_m", [30.0, 150.0])
def test_joins_are_as_long_as_the_lines_that_are_flown(highest_m: float) -> None:
    """Straight, round or over, as each is joined by itself: never shorter, and hardly longer."""
    town = replace(TOWN, max_height_m=highest_m)
    free = free_space(town)
    joiner = Joiner.among(town, free)
    joins = Joins.among(town, free, joiner.ways)
    rng = np.random.default_rng(1)
    west, south, east, north = free.ground.bounds
    places = rng.uniform((west, south), (east, north), (60, 2))
    places = places[shapely.contains_xy(free.ground, *places.T)][:16]
    ways = joiner.ways
    still = np.zeros((len(places), 2))
    found = join_lengths(
        ways.walls, ways.corners, ways.between, joins.outlines, joins.rises, np.inf, places, still, 0.0, 16
    )
    for p in range(len(places)):
        for q in range(p):
            flown = joiner.join(tuple(places[p]), tuple(places[q]))
            assert flown.length_m - 0.05 < found[p, q] < 1.02 * flown.length_m + 0.05
            assert found[q, p] == found[p, q]


def test_lines_are_flown_from_the_start_to_the_end() -> None:
    """Two lanes between start and end: each from the side that the flight comes from."""
    town = replace(TOWN, buildings=(), start=(5.0, 5.0), end=(5.0, 290.0))
    free = free_space(town)
    joins = Joins.among(town, free, Ways.through(free.ground))
    lanes = np.array([[[300.0, 200.0], [20.0, 200.0]], [[20.0, 100.0], [300.0, 100.0]]])
    length_m, flown = joins.tour(lanes, 0)
    assert flown.tolist() == [[[20.0, 100.0], [300.0, 100.0]], [[300.0, 200.0], [20.0, 200.0]]]
    straight_m = np.hypot(15.0, 95.0) + 280.0 + 100.0 + 280.0 + np.hypot(15.0, 90.0)
    assert length_m == pytest.approx(straight_m)


def test_turns_count_as_much_as_bends() -> None:
    """Two lanes in line have none between them, two side by side have two."""
    town = replace(TOWN, buildings=())
    free = free_space(town)
    joins = Joins.among(town, free, Ways.through(free.ground, 40.0))
    lanes = np.array(
        [[[20.0, 100.0], [150.0, 100.0]], [[200.0, 100.0], [300.0, 100.0]], [[20.0, 150.0], [300.0, 150.0]]]
    )
    length_m, _ = joins.tour(lanes, 0)
    lines_m = 130.0 + 50.0 + 100.0 + 50.0 + 280.0
    ends_m = np.hypot(15.0, 95.0) + np.hypot(15.0, 145.0)
    assert length_m == pytest.approx(lines_m + ends_m + 4 * 40.0)
