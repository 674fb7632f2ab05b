"""The mission's own metres, against the planner's frame and pyproj's geodesics."""

from __future__ import annotations

import math
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pyproj import Geod

from mavlink.wire.geometry import LocalMap, arc_points, chord_step_rad, distance_m, offset
from planner.frames import LocalFrame

places = st.tuples(st.floats(-179.0, 179.0), st.floats(-75.0, 75.0))
metres = st.floats(-20_000.0, 20_000.0)


@given(places, metres, metres)
def test_the_map_agrees_with_the_planners_frame(
    origin: tuple[float, float], east: float, north: float
) -> None:
    """Both projections give the same places to a millimetre, and there is a way back."""
    local, frame = LocalMap(origin), LocalFrame(*origin)
    place = local.lonlat((east, north))
    assert place == pytest.approx(tuple(frame.to_wgs84([east, north])), abs=1e-9)
    assert local.xy(place) == pytest.approx((east, north), abs=1e-3)


@given(places, st.floats(0.0, 360.0), st.floats(1.0, 20_000.0))
def test_lengths_are_those_of_geodesics(origin: tuple[float, float], heading: float, length_m: float) -> None:
    """At 20 km the map is off by less than 5 parts in a million."""
    lon, lat, _ = Geod(ellps="WGS84").fwd(*origin, heading, length_m)
    assert distance_m(origin, (lon, lat)) == pytest.approx(length_m, rel=1e-9, abs=1e-6)
    assert math.hypot(*LocalMap(origin).xy((lon, lat))) == pytest.approx(length_m, rel=5e-6, abs=1e-3)


@given(st.floats(10.0, 2000.0), st.floats(-6.2, 6.2).filter(lambda a: abs(a) > 0.01), st.floats(0.05, 0.8))
def test_arc_points_lie_on_the_arc_in_even_steps(radius_m: float, turn_rad: float, step_rad: float) -> None:
    """All are a radius from the centre, and no two neighbours are farther apart than the step."""
    start = (radius_m, 0.0)
    end = offset((0.0, 0.0), turn_rad, radius_m)
    points = [start, *arc_points(start, end, (0.0, 0.0), turn_rad, step_rad), end]
    chord_m = 2.0 * radius_m * math.sin(step_rad / 2.0)
    for before, after in pairwise(points):
        assert math.hypot(*after) == pytest.approx(radius_m)
        assert math.dist(before, after) <= chord_m * (1.0 + 1e-6)
    second_rad = math.atan2(points[1][1], points[1][0])
    assert math.copysign(1.0, second_rad) == math.copysign(1.0, turn_rad)


@given(st.floats(1.0, 5000.0), st.floats(0.01, 100.0))
def test_the_chord_step_keeps_its_sagitta(radius_m: float, sagitta_m: float) -> None:
    """r (1 − cos(θ/2)) is never more than asked for, nor the step than the largest."""
    step_rad = chord_step_rad(radius_m, sagitta_m, 0.8)
    assert step_rad <= 0.8
    assert radius_m * (1.0 - math.cos(step_rad / 2.0)) <= sagitta_m * (1.0 + 1e-6)
