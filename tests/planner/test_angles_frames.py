"""Angle laws; local frames against pyproj's geodesics."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pyproj import Geod

from planner.angles import TWO_PI, angle_from_heading, heading_from_angle, wrap_pi, wrap_two_pi
from planner.frames import LocalFrame

GEOD = Geod(ellps="WGS84")

angles = st.floats(-1e4, 1e4)
headings = st.floats(-720.0, 1080.0)
frames = st.builds(LocalFrame, st.floats(-179.0, 179.0), st.floats(-75.0, 75.0))
near_m = st.floats(-20_000.0, 20_000.0)


@pytest.mark.parametrize(
    ("heading_deg", "angle_rad"),
    [(0.0, math.pi / 2), (90.0, 0.0), (180.0, -math.pi / 2), (270.0, math.pi), (45.0, math.pi / 4)],
)
def test_compass_points(heading_deg: float, angle_rad: float) -> None:
    """North, east, south, west and north-east stand where a map has them."""
    assert angle_from_heading(heading_deg) == pytest.approx(angle_rad)
    assert heading_from_angle(angle_rad) == pytest.approx(heading_deg)


@given(headings)
def test_heading_and_angle_point_the_same_way(heading_deg: float) -> None:
    """The unit vector of a heading, (sin, cos), is that of its angle, (cos, sin)."""
    angle_rad = angle_from_heading(heading_deg)
    assert -math.pi < angle_rad <= math.pi
    assert math.cos(angle_rad) == pytest.approx(math.sin(math.radians(heading_deg)), abs=1e-12)
    assert math.sin(angle_rad) == pytest.approx(math.cos(math.radians(heading_deg)), abs=1e-12)


@given(angles)
def test_heading_returns_to_its_angle(angle_rad: float) -> None:
    """Headings lie in [0, 360) and convert back to the same direction."""
    heading_deg = heading_from_angle(angle_rad)
    assert 0.0 <= heading_deg < 360.0
    assert abs(wrap_pi(angle_from_heading(heading_deg) - angle_rad)) < 1e-9


@given(angles)
def test_wraps_keep_the_direction(angle_rad: float) -> None:
    """Both wraps stay in their range, differ by whole turns from the angle, and change nothing twice."""
    half, full = wrap_pi(angle_rad), wrap_two_pi(angle_rad)
    assert -math.pi < half <= math.pi
    assert 0.0 <= full < TWO_PI
    for wrapped in (half, full):
        turns = (angle_rad - wrapped) / TWO_PI
        assert turns == pytest.approx(round(turns), abs=1e-9)
    assert wrap_pi(half) == half
    assert wrap_two_pi(full) == full


@pytest.mark.parametrize("edge_rad", [-math.pi, math.pi, 3.0 * math.pi, -1e-17, TWO_PI, -TWO_PI, 0.0])
def test_wraps_at_their_edges(edge_rad: float) -> None:
    """π is in, -π is out; 0 is in, 2π is out, also where rounding would put it there."""
    assert wrap_pi(edge_rad) != -math.pi
    assert 0.0 <= wrap_two_pi(edge_rad) < TWO_PI


@given(frames, near_m, near_m)
def test_local_metres_come_back(frame: LocalFrame, east_m: float, north_m: float) -> None:
    """Local to WGS 84 and back is the same place within a hundredth of a millimetre."""
    back = frame.to_local(frame.to_wgs84([east_m, north_m]))
    assert back == pytest.approx([east_m, north_m], abs=1e-5)


@given(frames, near_m, near_m, st.floats(-math.pi, math.pi), st.floats(10.0, 5000.0))
def test_distances_and_directions_are_geodesic(
    frame: LocalFrame, east_m: float, north_m: float, angle_rad: float, length_m: float
) -> None:
    """Within 25 km of the origin, lengths and true headings are those of pyproj's geodesics.

    At 20 + 5 km from the central meridian the projection's scale is off by x² / 2R² < 8 parts in a million.
    """
    there = [east_m + length_m * math.cos(angle_rad), north_m + length_m * math.sin(angle_rad)]
    (lon0, lat0), (lon1, lat1) = frame.to_wgs84([[east_m, north_m], there])
    azimuth_deg, _, geodesic_m = GEOD.inv(lon0, lat0, lon1, lat1)
    assert length_m == pytest.approx(geodesic_m, rel=8e-6, abs=1e-4)
    error_deg = math.remainder(frame.true_heading_deg(east_m, north_m, angle_rad) - azimuth_deg, 360.0)
    assert abs(error_deg) < 0.01


@given(frames, near_m, near_m, st.floats(0.0, 359.999))
def test_true_headings_come_back(
    frame: LocalFrame, east_m: float, north_m: float, heading_deg: float
) -> None:
    """The local angle of a true heading has that heading again."""
    angle_rad = frame.angle_rad(east_m, north_m, heading_deg)
    error_deg = math.remainder(frame.true_heading_deg(east_m, north_m, angle_rad) - heading_deg, 360.0)
    assert abs(error_deg) < 1e-4


def test_axes_at_the_origin() -> None:
    """East raises the longitude, north the latitude, and arrays keep their shape."""
    frame = LocalFrame(-117.74, 33.52)
    lonlat = frame.to_wgs84(np.array([[0.0, 0.0], [1000.0, 0.0], [0.0, 1000.0]]))
    assert lonlat[0] == pytest.approx([-117.74, 33.52])
    assert lonlat[1, 0] > lonlat[0, 0]
    assert lonlat[2, 1] > lonlat[0, 1]
    assert frame.to_local(lonlat.reshape(3, 1, 2)).shape == (3, 1, 2)
    assert frame.true_heading_deg(0.0, 0.0, 0.0) == pytest.approx(90.0, abs=1e-3)
    assert frame.true_heading_deg(0.0, 0.0, math.pi / 2) == pytest.approx(0.0, abs=1e-6)
