"""PX4's multirotors: its laws of speed integrated step by step, and what it flew."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

from planner.dubins.path import Segment
from planner.profile.flight import Stretch
from planner.profile.smoothed import Braking, climb_s, descent_s, smoothed_times
from planner.route import Pose
from planner.vehicle.aircraft import Aircraft
from planner.vehicle.manners import manners_of

PX4 = manners_of(Aircraft("a", "multirotor", "px4", 10.0, 20.0))
ACCEL_M_S2, JERK_M_S3, EARLY_M = 3.0, 4.0, 2.0
BRAKING = Braking(ACCEL_M_S2, JERK_M_S3, EARLY_M)
ORIGIN = Pose(0.0, 0.0, 0.0)


def allowed_m_s(distance_m: float, end_m_s: float) -> float:
    """``computeMaxSpeedFromDistance`` of PX4's TrajMath.hpp, written out."""
    b = 4.0 * ACCEL_M_S2**2 / JERK_M_S3
    c = -2.0 * ACCEL_M_S2 * distance_m - end_m_s**2
    return max(0.5 * (-b + math.sqrt(b**2 - 4.0 * c)), end_m_s)


def stretches(*pieces: tuple[float, float]) -> list[Stretch]:
    """Straights (length, 0) and arcs (length, radius; < 0 to the right) one behind the other."""
    found: list[Stretch] = []
    pose = ORIGIN
    for length_m, radius_m in pieces:
        kind = "straight" if radius_m == 0.0 else "left" if radius_m > 0.0 else "right"
        segment = Segment(kind, pose, length_m, abs(radius_m))
        found.append(Stretch("mission", pose, segment, 0.0, 80.0, 80.0))
        pose = segment.end
    return found


@settings(max_examples=60, deadline=None)
@given(st.floats(1.0, 15.0), st.floats(0.0, 8.0))
def test_braking_is_the_integral_of_its_law(speed_m_s: float, end_m_s: float) -> None:
    """From where a speed is the fastest allowed, to where the place counts as reached: ∫ ds / v."""
    distance_m = BRAKING.distance_m(speed_m_s, end_m_s)
    if speed_m_s <= end_m_s:
        assert (distance_m, BRAKING.time_s(speed_m_s, end_m_s)) == (0.0, 0.0)
        return
    if distance_m > 0.0:
        assert allowed_m_s(distance_m + EARLY_M, end_m_s) == pytest.approx(speed_m_s)
        expected_s = quad(lambda s: 1.0 / allowed_m_s(s + EARLY_M, end_m_s), 0.0, distance_m, limit=200)[0]
        assert BRAKING.time_s(speed_m_s, end_m_s) == pytest.approx(expected_s, rel=1e-4)


def stepped_s(length_m: float, speed_m_s: float) -> float:
    """A straight from rest to a stop: jerk and acceleration limited up, PX4's law down, in small steps."""
    step_s, time_s, at_m, v, a = 0.001, 0.0, 0.0, 0.0, 0.0
    while at_m < length_m - EARLY_M:
        # The acceleration falls again in time to reach the speed with none left.
        rising = v + a**2 / (2.0 * JERK_M_S3) < speed_m_s
        a = min(a + JERK_M_S3 * step_s, ACCEL_M_S2) if rising else max(a - JERK_M_S3 * step_s, 0.0)
        v = min(v + a * step_s, speed_m_s, allowed_m_s(length_m - at_m, 0.0))
        at_m += v * step_s
        time_s += step_s
    return time_s


@pytest.mark.parametrize(("length_m", "speed_m_s"), [(30.0, 5.0), (120.0, 5.0), (200.0, 10.0), (600.0, 12.0)])
def test_a_straight_takes_what_its_laws_say(length_m: float, speed_m_s: float) -> None:
    """From rest to a stop, as stepped through."""
    (time_s,) = smoothed_times(stretches((length_m, 0.0)), speed_m_s, PX4)
    assert time_s == pytest.approx(stepped_s(length_m, speed_m_s), rel=0.02)


def test_collinear_places_cost_time_where_the_next_one_is_near() -> None:
    """It would stop at the next but one: the nearer, the longer; none is named too near."""
    (whole_s,) = smoothed_times(stretches((400.0, 0.0)), 10.0, PX4)
    times_s = [
        sum(smoothed_times(stretches((200.0, 0.0), (near_m, 0.0), (200.0 - near_m, 0.0)), 10.0, PX4))
        for near_m in (100.0, 20.0, 5.0, 1.0)
    ]
    assert times_s[0] == pytest.approx(whole_s, rel=0.01)
    assert whole_s < times_s[1] < times_s[2]
    assert times_s[3] == pytest.approx(whole_s, rel=0.01)


@pytest.mark.parametrize(
    ("pieces", "flown_s"),
    [
        # Straights between arcs, and arcs in chords of 14 and 16 m with 37 and 42° between them: a flight of
        # SIH's multirotor at 10 m/s in PX4 v1.16, with its own drag and with 0.3 of it.
        (((207.0, 0.0), (60.0, -21.9)), (24.7, 26.5)),
        (((60.0, 0.0), (71.2, -21.9), (60.0, 0.0)), (18.5, 21.5)),
        (((60.0, 0.0), (65.1, 21.9), (60.0, 0.0)), (17.5, 17.5)),
    ],
)
def test_pieces_take_what_px4_took(
    pieces: tuple[tuple[float, float], ...], flown_s: tuple[float, float]
) -> None:
    """The piece under test between the others: within a tenth of both flights."""
    times_s = smoothed_times(stretches(*pieces), 10.0, PX4)
    number = 0 if len(pieces) == 2 else 1
    assert 0.9 * flown_s[0] < times_s[number] < 1.1 * flown_s[1]


def test_up_slowly_first_and_slower_before_the_top() -> None:
    """To 10 m at 1.5 m/s with 0.5 m/s² (MPC_TKO_SPEED, MPC_TKO_RAMP_T); 3 m/s on; the top is braked for."""
    assert climb_s(1.0, 80.0, PX4) == pytest.approx(2.0)
    assert climb_s(10.0, 80.0, PX4) == pytest.approx(3.0 + 7.75 / 1.5)
    assert climb_s(180.0, 180.0, PX4) - climb_s(80.0, 80.0, PX4) == pytest.approx(100.0 / 3.0)
    # Flown: 36.7 s from 1 m to 79.5 m.
    assert climb_s(80.0, 80.0, PX4) - climb_s(1.0, 80.0, PX4) == pytest.approx(33.5, rel=0.1)


def test_down_at_one_speed_then_slowing_to_touch_down() -> None:
    """1.5 m/s to 10 m, falling evenly with height to 0.7 m/s at 5 m, and so to the ground."""
    slowing_s = quad(lambda h: 1.0 / (0.7 + 0.8 * (h - 5.0) / 5.0), 5.0, 10.0)[0]
    expected_s = 70.0 / 1.5 + slowing_s + 5.0 / 0.7
    assert descent_s(80.0, PX4) == pytest.approx(expected_s, abs=1.0)
    assert descent_s(4.0, PX4) == pytest.approx(4.0 / 0.7, abs=1.0)


def test_heights_change_on_the_spot_in_flight_from_rest_to_rest() -> None:
    """Between two ways neither a take-off's slow beginning nor a landing's slow end; both ways stop there."""
    first, second = stretches((150.0, 0.0)), stretches((200.0, 0.0))
    for low_m, high_m, rate_m_s in ((80.0, 120.0, 3.0), (120.0, 60.0, 1.5)):
        spot = [Stretch("mission", ORIGIN, None, 150.0, low_m, high_m)]
        times_s = smoothed_times([*first, *spot, *second], 10.0, PX4)
        assert times_s[0] == pytest.approx(smoothed_times(first, 10.0, PX4)[0])
        assert times_s[2] == pytest.approx(smoothed_times(second, 10.0, PX4)[0])
        rise_m = abs(high_m - low_m)
        assert rise_m / rate_m_s < times_s[1] < rise_m / rate_m_s + 5.0
        twice = [Stretch("mission", ORIGIN, None, 150.0, low_m, 2.0 * high_m - low_m)]
        longer_s = smoothed_times([*first, *twice, *second], 10.0, PX4)[1] - times_s[1]
        assert longer_s == pytest.approx(rise_m / rate_m_s)


def test_times_of_climbs_and_of_the_way_add_up() -> None:
    """On the spot, over the ground and on the spot: each stretch has its own share."""
    up = [Stretch("take_off", ORIGIN, None, 0.0, 0.0, 10.0), Stretch("climb", ORIGIN, None, 0.0, 10.0, 80.0)]
    way = stretches((100.0, 0.0), (40.0, 22.0))
    down = [Stretch("landing", ORIGIN, None, 140.0, 80.0, 0.0)]
    times_s = smoothed_times([*up, *way, *down], 10.0, PX4)
    assert sum(times_s[:2]) == pytest.approx(climb_s(80.0, 80.0, PX4))
    assert times_s[2:4] == pytest.approx(smoothed_times(way, 10.0, PX4))
    assert times_s[4] == pytest.approx(descent_s(80.0, PX4))
