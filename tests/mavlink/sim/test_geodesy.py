"""The simulated aircraft's geodesy against pyproj's geodesics."""

from __future__ import annotations

import math

from hypothesis import given
from hypothesis import strategies as st

from mavlink.sim.geodesy import moved, offset_m, wrap_rad
from tests.mavlink.sim.helpers import GEOD

LAT = st.floats(-89.9, 89.9)
LON = st.floats(-180.0, 180.0)
AZIMUTH = st.floats(0.0, 360.0)


@given(LAT, LON, AZIMUTH, st.floats(0.1, 5000.0))
def test_offset_is_the_geodesic(lat: float, lon: float, azimuth_deg: float, distance_m: float) -> None:
    """Direction and distance up to 5 km are those of the geodesic to within 0.1 %."""
    to_lon, to_lat, _ = GEOD.fwd(lon, lat, azimuth_deg, distance_m)
    north_m, east_m = offset_m(lat, lon, to_lat, to_lon)
    expected = (
        distance_m * math.cos(math.radians(azimuth_deg)),
        distance_m * math.sin(math.radians(azimuth_deg)),
    )
    assert math.dist((north_m, east_m), expected) < 1e-3 * distance_m


@given(LAT, LON, AZIMUTH)
def test_a_straight_line_is_a_geodesic(lat: float, lon: float, azimuth_deg: float) -> None:
    """Seen from its middle, both ends of a 20 km geodesic lie on one straight line to within 0.2 m."""
    sides = []
    for turn_deg in (0.0, 180.0):
        end_lon, end_lat, _ = GEOD.fwd(lon, lat, azimuth_deg + turn_deg, 10_000.0)
        sides.append(offset_m(lat, lon, end_lat, end_lon))
    (an, ae), (bn, be) = sides
    assert abs(an * be - ae * bn) / math.dist(sides[0], sides[1]) < 0.2


@given(LAT, LON, AZIMUTH, st.floats(0.01, 5.0))
def test_small_steps_land_where_the_geodesic_does(
    lat: float, lon: float, azimuth_deg: float, step_m: float
) -> None:
    """A step of metres ends within a hundred thousandth of its length of the geodesic's end."""
    azimuth_rad = math.radians(azimuth_deg)
    new_lat, new_lon = moved(lat, lon, step_m * math.cos(azimuth_rad), step_m * math.sin(azimuth_rad))
    to_lon, to_lat, _ = GEOD.fwd(lon, lat, azimuth_deg, step_m)
    _, _, miss_m = GEOD.inv(new_lon, new_lat, to_lon, to_lat)
    assert miss_m < 1e-5 * step_m + 1e-8


@given(st.floats(-100.0, 100.0))
def test_wrapped_angles_are_the_same_angle(angle_rad: float) -> None:
    """Wrapping changes neither sine nor cosine and ends in (-pi, pi]."""
    wrapped = wrap_rad(angle_rad)
    assert -math.pi < wrapped <= math.pi
    assert math.isclose(math.cos(wrapped), math.cos(angle_rad), abs_tol=1e-9)
    assert math.isclose(math.sin(wrapped), math.sin(angle_rad), abs_tol=1e-9)
