"""Cost figures of a route."""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner.coverage.intervals import (
    collection_length_m,
    duty_cycle,
    operating_function,
    operating_intervals,
)
from planner.routing.greedy.costs import path_length_ratio, weighted_cost
from planner.wishes import Objective

INTERVALS = st.lists(
    st.tuples(st.floats(0.0, 900.0), st.floats(1.0, 100.0)).map(lambda pair: (pair[0], pair[0] + pair[1])),
    min_size=1,
    max_size=8,
)


def test_path_length_ratio() -> None:
    """Eq 10: length over the straight distance; a round trip has none."""
    assert path_length_ratio(150.0, (0.0, 0.0), (30.0, 40.0)) == pytest.approx(3.0)
    assert path_length_ratio(150.0, (1.0, 1.0), (1.0, 1.0)) is None


def test_weighted_cost() -> None:
    """Eq 25 with three different weights."""
    assert weighted_cost(Objective(2.0, 3.0, 5.0), 1.5, 0.1, 0.01) == pytest.approx(3.35)


@given(INTERVALS)
def test_intervals_are_joined(intervals: list[tuple[float, float]]) -> None:
    """Joined intervals are apart and in order, and their length is measured as by counting points."""
    joined = operating_intervals(intervals)
    assert all(one[1] < other[0] for one, other in itertools.pairwise(joined))
    along_m = np.linspace(0.0, 1000.0, 20001)
    working = operating_function(intervals, along_m)
    assert set(np.unique(working)) <= {0, 1}
    np.testing.assert_array_equal(working, operating_function(joined, along_m))
    # A step of 50 mm misses at most one step at either end of an interval.
    assert working.mean() * 1000.0 == pytest.approx(collection_length_m(intervals), abs=0.1 * len(joined))
    assert duty_cycle(intervals, 1000.0) == pytest.approx(collection_length_m(intervals) / 1000.0)


def test_duty_cycle_of_nothing() -> None:
    """A path of no length has duty cycle 0."""
    assert duty_cycle([], 0.0) == 0.0
