"""Times of stretches, held against quadrature and against the standard atmosphere."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

from planner.airspace.values import Wind
from planner.dubins.path import Segment
from planner.profile.flight import Stretch
from planner.profile.times import rest_to_rest_s, rotor_times, wing_times
from planner.route import Pose
from planner.vehicle.aircraft import Aircraft
from planner.vehicle.manners import Manners
from planner.vehicle.wind import ground_speed_m_s

ROTOR = Manners(2.5, 1.5, 2.5, 1.0, 1.0, 0.5, 10.0)
ORIGIN = Pose(0.0, 0.0, 0.0)


def straight(length_m: float, rise_m: float = 0.0, low_m: float = 0.0) -> Stretch:
    return Stretch("mission", ORIGIN, Segment("straight", ORIGIN, length_m), 0.0, low_m, low_m + rise_m)


def lift(from_m: float, to_m: float) -> Stretch:
    return Stretch("climb", ORIGIN, None, 0.0, from_m, to_m)


def integrated_s(distance_m: float, speed_m_s: float, accel_m_s2: float) -> float:
    """Half of the way from rest, by quadrature of ds / v over u = √s; the other half takes as long."""

    def slowness(u: float) -> float:
        return 2.0 * u / max(min(speed_m_s, math.sqrt(2.0 * accel_m_s2) * u), 1e-12)

    half = math.sqrt(distance_m / 2.0)
    kink = min(speed_m_s / math.sqrt(2.0 * accel_m_s2), half)
    return 2.0 * float(quad(slowness, 0.0, half, points=[kink])[0])


@settings(max_examples=15, deadline=None)
@given(st.floats(2.0, 120.0), st.floats(1.0, 9.0), st.floats(0.5, 4.0))
def test_from_rest_to_rest(distance_m: float, speed_m_s: float, accel_m_s2: float) -> None:
    """Speeding up, cruising and braking take what the integral of slowness says."""
    expected = integrated_s(distance_m, speed_m_s, accel_m_s2)
    assert rest_to_rest_s(distance_m, speed_m_s, accel_m_s2) == pytest.approx(expected, rel=1e-4)


def test_a_straight_between_two_arcs_is_entered_and_left_at_the_arcs_speed() -> None:
    """On arcs of radius r what hovers flies √(a r), between them faster as far as there is room."""
    arc = Segment("left", ORIGIN, 40.0, 10.0)
    on_arc = Stretch("mission", ORIGIN, arc, 0.0, 0.0, 0.0)
    times = rotor_times([on_arc, straight(400.0), on_arc], 12.0, ROTOR)
    slow = math.sqrt(2.5 * 10.0)
    speeding_m = (144.0 - slow**2) / 5.0
    expected = 2.0 * (12.0 - slow) / 2.5 + (400.0 - 2.0 * speeding_m) / 12.0
    assert times[1] == pytest.approx(expected)
    # From rest to the arc's speed, and the rest of it at that.
    assert times[0] == pytest.approx(slow / 2.5 + (40.0 - slow**2 / 5.0) / slow)


def test_climbs_on_the_spot_that_follow_each_other_are_one() -> None:
    """Taking off to 10 m and on to 80 m takes as long as to 80 m at once; the last 10 m down are slow."""
    together = sum(rotor_times([lift(0.0, 10.0), lift(10.0, 80.0)], 12.0, ROTOR))
    assert together == pytest.approx(rotor_times([lift(0.0, 80.0)], 12.0, ROTOR)[0])
    down = rotor_times([lift(80.0, 0.0)], 12.0, ROTOR)[0]
    assert down == pytest.approx(70.0 / 1.5 + 1.5 / 1.0 + 10.0 / 0.5)


@pytest.mark.parametrize(("height_m", "density"), [(0.0, 1.225), (1_000.0, 1.1117), (3_000.0, 0.90925)])
def test_wings_fly_faster_through_thinner_air(height_m: float, density: float) -> None:
    """By √(ρ0/ρ) with the densities that ICAO Doc 7488 tables for the standard atmosphere."""
    aircraft = Aircraft("a", "fixed_wing", "ardupilot", 20.0, 100.0)
    (time_s,) = wing_times([straight(2_000.0, low_m=height_m)], aircraft, ROTOR, Wind(), 0.0)
    assert 2_000.0 / 20.0 / time_s == pytest.approx(math.sqrt(1.225 / density), rel=2e-4)


def test_wings_in_wind_keep_the_wind_triangle() -> None:
    """Along and against the wind the ground speed is airspeed and wind together, or less it."""
    aircraft = Aircraft("a", "fixed_wing", "ardupilot", 20.0, 100.0)
    for toward_rad in (0.0, math.pi, 1.0):
        wind = Wind(8.0, toward_rad)
        (time_s,) = wing_times([straight(2_000.0)], aircraft, ROTOR, wind, 0.0)
        assert time_s == pytest.approx(2_000.0 / float(ground_speed_m_s(0.0, 20.0, wind)))
