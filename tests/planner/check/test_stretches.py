"""Stretches of a line: as shapely cuts it and measures it."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.geometry import LineString, Point
from shapely.ops import substring

from planner.check.stretches import Measured

#: A tenth of a millimetre is the least: of two vertices closer than that GEOS finds no place between.
tenths_mm = st.integers(-(10**8), 10**8).map(lambda tenths: tenths / 1e4)
places = st.tuples(tenths_mm, tenths_mm)


@given(
    line=st.lists(places, min_size=2, max_size=12, unique=True),
    parts=st.tuples(st.floats(-0.2, 1.2), st.floats(-0.2, 1.2)),
    place=places,
)
@settings(max_examples=200, deadline=None)
def test_a_stretch_is_shapelys(
    line: list[tuple[float, float]], parts: tuple[float, float], place: tuple[float, float]
) -> None:
    """Anywhere on the line and beyond its ends: the same vertices, and the place nearest to another."""
    whole, measured = LineString(line), Measured(np.array(line))
    assert measured.length_m == pytest.approx(whole.length)
    from_m, to_m = sorted(part * whole.length for part in parts)
    expected = substring(whole, min(max(from_m, 0.0), whole.length), min(max(to_m, 0.0), whole.length))
    found = measured.between(from_m, to_m)
    assert Point(found[0]).distance(Point(expected.coords[0])) < 1e-6
    assert Point(found[-1]).distance(Point(expected.coords[-1])) < 1e-6
    if len(found) > 1:
        assert LineString(found).length == pytest.approx(expected.length, abs=1e-6)
        assert LineString(found).hausdorff_distance(expected) < 1e-6
        nearest = whole.interpolate(measured.nearest_m(place, from_m, to_m))
        assert nearest.distance(Point(place)) == pytest.approx(expected.distance(Point(place)), abs=1e-6)


def test_a_stretch_of_no_length_is_a_place() -> None:
    """Where a stretch would begin after its end there is the one place."""
    measured = Measured(np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0]]))
    assert measured.between(12.0, 11.0).tolist() == [[10.0, 2.0]]
    assert measured.nearest_m((3.0, 3.0), 12.0, 12.0) == 12.0


def test_vertices_on_each_other_are_one_place() -> None:
    """A stretch whose vertices differ by less than anything flown is measured without an error."""
    measured = Measured(np.array([[0.0, 0.0], [5e-324, 0.0], [10.0, 0.0], [10.0, 1e-12]]))
    assert measured.nearest_m((4.0, 3.0), 0.0, 11.0) == pytest.approx(4.0)
    assert measured.nearest_m((4.0, 3.0), 10.0, 10.0 + 1e-12) == pytest.approx(10.0)
