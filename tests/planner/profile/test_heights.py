"""Heights along a line: interpolated as numpy does, the same both ways, joined without a seam."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner.profile.heights import Heights, level, tidy

steps = st.lists(st.tuples(st.floats(0.5, 5_000.0), st.floats(-200.0, 900.0)), min_size=2, max_size=8)


def heights_of(rows: list[tuple[float, float]]) -> Heights:
    along_m = np.cumsum([0.0, *(step_m for step_m, _ in rows[1:])]).tolist()
    return Heights(tuple(zip(along_m, (altitude_m for _, altitude_m in rows), strict=True)))


@given(steps, st.floats(0.0, 1.0))
def test_between_knots_the_slope_is_even(rows: list[tuple[float, float]], part: float) -> None:
    """Heights are those of numpy's linear interpolation."""
    heights = heights_of(rows)
    at_m = part * heights.length_m
    expected = np.interp(at_m, *(np.array(column) for column in zip(*heights.knots, strict=True)))
    assert float(heights.at(at_m)) == pytest.approx(expected, abs=1e-2)


@given(steps, st.floats(0.0, 1.0))
def test_flown_the_other_way_heights_are_the_same(rows: list[tuple[float, float]], part: float) -> None:
    """A place has one height, from whichever side it is come to."""
    heights = heights_of(rows)
    at_m = part * heights.length_m
    there = float(heights.reverse().at(heights.length_m - at_m))
    assert there == pytest.approx(float(heights.at(at_m)), abs=1e-2)


@given(steps)
def test_knots_that_say_nothing_change_nothing(rows: list[tuple[float, float]]) -> None:
    """Repeated knots and knots on the line between others can be left out."""
    heights = heights_of(rows)
    middles = tuple(
        knot
        for (a_m, a), (b_m, b) in pairwise(heights.knots)
        for knot in ((a_m, a), (a_m, a), (0.5 * (a_m + b_m), 0.5 * (a + b)))
    )
    fewer = Heights(tidy((*middles, heights.knots[-1])))
    places = np.linspace(0.0, heights.length_m, 40)
    assert len(fewer.knots) <= len(heights.knots)
    np.testing.assert_allclose(fewer.at(places), heights.at(places), atol=1e-2)


def test_a_climb_on_the_spot_is_two_heights_at_one_place() -> None:
    """At the place itself the later height counts; before it, on another line, the earlier."""
    lifted = Heights(((0.0, 0.0), (0.0, 80.0))).then(level(100.0, 80.0))
    assert lifted.knots == ((0.0, 0.0), (0.0, 80.0), (100.0, 80.0))
    assert float(lifted.at(0.0)) == 80.0
    assert lifted.reverse().knots == ((0.0, 80.0), (100.0, 80.0), (100.0, 0.0))


def test_knots_out_of_order_are_refused() -> None:
    """Heights that go back along the line are an error of the caller."""
    with pytest.raises(ValueError, match="follow each other"):
        Heights(((10.0, 0.0), (5.0, 1.0)))
