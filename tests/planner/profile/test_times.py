"""Times of stretches, held against quadrature and against the standard atmosphere."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

from planner.airspace.values import Wind
from planner.dubins.path import Segment
from planner.profile.flight import Stretch
from planner.profile.times import chord_speed_m_s, rest_to_rest_s, rotor_times, wing_times
from planner.route import Pose
from planner.vehicle.aircraft import Aircraft
from planner.vehicle.manners import Manners
from planner.vehicle.wind import ground_speed_m_s

ROTOR = Manners(2.5, 1.5, 2.5, 1.0, 1.0, 0.5, 10.0)
ORIGIN = Pose(0.0, 0.0, 0.0)


def straight(length_m: float, rise_m: float = 0.0, low_m: float = 0.0) -> Stretch:
    return Stretch("mission", ORIGIN, Segment("straight", ORIGIN, length_m), 0.0, low_m, low_m + rise_m)


def lift(from_m: float, to_m: float) -> Stretch:
    return Stretch("climb" if to_m > from_m else "landing", ORIGIN, None, 0.0, from_m, to_m)


def test_a_descent_between_passes_does_not_land() -> None:
    """On the spot from one pass's height to the next one's it sinks as fast all the way."""
    down = replace(lift(80.0, 10.0), phase="mission")
    assert rotor_times([down], 12.0, ROTOR)[0] == pytest.approx(70.0 / 1.5 + 1.5 / 1.0)


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


def test_a_longer_straight_takes_longer_by_what_is_flown_at_full_speed() -> None:
    """Speeding up from an arc and braking for the next one take the same, however long the straight."""
    arc = Segment("left", ORIGIN, 40.0, 10.0)
    on_arc = Stretch("mission", ORIGIN, arc, 0.0, 0.0, 0.0)
    short, long = (rotor_times([on_arc, straight(m), on_arc], 12.0, ROTOR) for m in (400.0, 1_000.0))
    assert long[1] - short[1] == pytest.approx(600.0 / 12.0)
    assert short[0] == pytest.approx(long[0])
    assert short[1] > 400.0 / 12.0
    assert short[0] > 40.0 / 12.0


@pytest.mark.parametrize(("chord_m", "flown_m_s"), [(4.0, 1.5), (14.0, 3.7), (17.0, 3.8), (26.0, 5.5)])
def test_chords_are_flown_as_fast_as_arducopter_flew_them(chord_m: float, flown_m_s: float) -> None:
    """Speeds along chords of arcs, from a flight in ArduCopter 4.6-dev with its own parameters."""
    # An arc so flat that its sagitta leaves it one chord.
    turn_rad = math.radians(10.0)
    radius_m = chord_m / (2.0 * math.sin(0.5 * turn_rad))
    assert chord_speed_m_s(turn_rad, radius_m, ROTOR) == pytest.approx(flown_m_s, rel=0.12)


@pytest.mark.parametrize(
    ("leg_m", "turns_deg", "flown_s"), [(26.98, (27.4, 152.6), 54.8), (19.64, (39.2, 140.8), 59.0)]
)
def test_lanes_are_flown_as_fast_as_arducopter_flew_them(
    leg_m: float, turns_deg: tuple[float, float], flown_s: float
) -> None:
    """A lane at 8 m/s and the way to the next, from flights in ArduCopter 4.6-dev with its own parameters.

    A slight corner at a lane's end is no place of its own in a mission, and is passed without a stop; where
    the 24 m before a lane begin is one, and they are flown no faster than from rest to rest.
    """
    radius_m = 2.002
    first, last = (Segment("right", ORIGIN, math.radians(turn) * radius_m, radius_m) for turn in turns_deg)
    lane = replace(straight(308.78), collects=True)
    around = [Stretch("mission", ORIGIN, arc, 0.0, 0.0, 0.0) for arc in (first, last)]
    rows = [straight(24.0), lane, around[0], straight(leg_m), around[1], straight(24.0), lane]
    assert math.fsum(rotor_times(rows, 8.0, ROTOR)[1:6]) == pytest.approx(flown_s, rel=0.03)


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
