"""Lateral guidance flown on the kinematic model."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mavlink.sim.dynamics import FlightCommand, Limits, Wind
from mavlink.sim.geodesy import offset_m
from mavlink.sim.guidance import CircleFollower, PolylineFollower, Tuning, climb_towards_m_s
from mavlink.sim.kinematic import KinematicModel
from tests.mavlink.sim.helpers import HOME, east_north_m, place_at

TUNING = Tuning(l1_period_s=7.0, max_bank_rad=math.radians(45.0))
LIMITS = Limits(20.0, math.radians(45.0), math.radians(75.0), 5.0, 4.0)


def airborne(east_m: float, north_m: float, heading_deg: float, wind_m_s: float = 0.0) -> KinematicModel:
    return KinematicModel(
        LIMITS,
        place_at(east_m, north_m),
        heading_deg,
        wind=Wind(wind_m_s, 270.0, 0.0, 0),
        ground_m=HOME.altitude_m,
        airborne=True,
    )


@settings(max_examples=25, deadline=None)
@given(st.floats(-150.0, 150.0), st.floats(0.0, 360.0), st.sampled_from([0.0, 8.0]))
def test_it_settles_on_a_line(offset_east_m: float, heading_deg: float, wind_m_s: float) -> None:
    """From any side and heading, in still air and 8 m/s across, it is within 2 m after a minute."""
    follower = PolylineFollower(TUNING, [place_at(0.0, 0.0), place_at(0.0, 6000.0)])
    m = airborne(offset_east_m, 0.0, heading_deg, wind_m_s)
    for number in range(round(120.0 / m.step_s)):
        m.step(m.step_s, FlightCommand(follower.bank_rad(m.state), 20.0, 0.0))
        east_m, north_m = east_north_m(m.state.lat_deg, m.state.lon_deg)
        if number * m.step_s > 60.0:
            assert abs(east_m) < 2.0
            assert follower.cross_track_m == pytest.approx(east_m, abs=0.5)
    assert north_m > 500.0


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize(("wind_m_s", "allowed_m"), [(0.0, 1.0), (8.0, 6.0)])
def test_it_settles_on_a_circle(side: float, wind_m_s: float, allowed_m: float) -> None:
    """From 800 m outside it joins a circle of 100 m, in the ordered sense, and stays on it."""
    centre = place_at(0.0, 0.0)
    follower = CircleFollower(TUNING, centre, side * 100.0)
    m = airborne(-800.0, 200.0, 90.0, wind_m_s)
    for number in range(round(150.0 / m.step_s)):
        m.step(m.step_s, FlightCommand(follower.bank_rad(m.state), 20.0, 0.0))
        if number * m.step_s > 80.0:
            off_m = math.hypot(*offset_m(m.state.lat_deg, m.state.lon_deg, centre.lat_deg, centre.lon_deg))
            assert off_m == pytest.approx(100.0, abs=allowed_m)
            assert m.state.turn_rate_rad_s * side > 0.0
    assert follower.turned_rad > 4.0 * math.pi


def test_a_corner_counts_as_passed_on_its_bisector() -> None:
    """Waypoints of a square are passed in turn, none skipped, each within 40 m."""
    corners = [place_at(*c) for c in [(0.0, 0.0), (0.0, 600.0), (600.0, 600.0), (600.0, 0.0), (0.0, 0.0)]]
    follower = PolylineFollower(TUNING, corners)
    m = airborne(0.0, 0.0, 0.0)
    misses_m = []
    for _ in range(round(140.0 / m.step_s)):
        m.step(m.step_s, FlightCommand(follower.bank_rad(m.state), 20.0, 0.0))
        distance_m = follower.distance_to_target_m(m.state)
        if follower.passed(m.state):
            misses_m.append(distance_m)
        if follower.finished:
            break
    assert len(misses_m) == 4
    assert max(misses_m) < 40.0


def test_waypoints_on_one_spot_do_not_hold_it_up() -> None:
    """Duplicate waypoints are passed with the first of them."""
    spots = [place_at(0.0, 0.0), place_at(0.0, 200.0), place_at(0.0, 200.0), place_at(0.0, 400.0)]
    follower = PolylineFollower(TUNING, spots)
    m = airborne(0.0, 0.0, 0.0)
    for _ in range(round(25.0 / m.step_s)):
        m.step(m.step_s, FlightCommand(follower.bank_rad(m.state), 20.0, 0.0))
        while not follower.finished and follower.passed(m.state):
            pass
        if follower.finished:
            break
    assert follower.finished


@given(st.floats(-500.0, 500.0), st.floats(-5.0, 5.0))
def test_climb_points_towards_the_wanted_altitude(error_m: float, slope_m_s: float) -> None:
    """Without slope the climb has the error's sign; the slope is added to it."""
    level = climb_towards_m_s(TUNING, 0.0, error_m)
    assert level * error_m >= 0.0
    assert climb_towards_m_s(TUNING, 0.0, error_m, slope_m_s) == pytest.approx(level + slope_m_s)
