"""Laws of flight that the kinematic model must keep, judged by geodesics."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mavlink.sim.dynamics import GRAVITY_M_S2, FlightCommand, Limits, Wind
from mavlink.sim.kinematic import KinematicModel
from tests.mavlink.sim.helpers import GEOD, HOME, east_north_m, true_over_equivalent

LIMITS = Limits(20.0, math.radians(45.0), math.radians(75.0), 5.0, 4.0)
STILL = (0.0, 0.0, 0.0, 0)


#: True over equivalent airspeed where the model begins: autopilots hold the latter.
THIN = true_over_equivalent(HOME.altitude_m + 100.0)


def model(wind: tuple[float, float, float, int] = STILL, **kwargs: float | bool) -> KinematicModel:
    high = replace(HOME, altitude_m=HOME.altitude_m + 100.0)
    options = {"airborne": True, **kwargs}
    heading_deg = float(options.pop("heading_deg", 0.0))
    return KinematicModel(
        LIMITS,
        high if options["airborne"] else HOME,
        heading_deg,
        wind=Wind(*wind),
        ground_m=HOME.altitude_m,
        airborne=bool(options["airborne"]),
    )


def fly(m: KinematicModel, seconds: float, command: FlightCommand) -> None:
    for _ in range(round(seconds / m.step_s)):
        m.step(m.step_s, command)


@settings(max_examples=20, deadline=None)
@given(st.floats(8.0, 44.0), st.sampled_from([-1.0, 1.0]), st.floats(0.0, 360.0))
def test_turn_radius_is_that_of_a_coordinated_turn(bank_deg: float, side: float, heading_deg: float) -> None:
    """In still air, places half a turn apart are V^2 / (g tan bank) times two apart, to 0.2 %."""
    m = model(heading_deg=heading_deg)
    command = FlightCommand(side * math.radians(bank_deg), 20.0, 0.0)
    fly(m, 5.0, command)
    expected_m = (20.0 * THIN) ** 2 / (GRAVITY_M_S2 * math.tan(math.radians(bank_deg)))
    begin = m.state
    turned = 0.0
    while turned < math.pi:
        state = m.step(m.step_s, command)
        turned += abs(state.turn_rate_rad_s) * m.step_s
    _, _, across_m = GEOD.inv(begin.lon_deg, begin.lat_deg, m.state.lon_deg, m.state.lat_deg)
    # At altitude the ellipsoid below is that much smaller.
    scale = 1.0 + m.state.altitude_m / 6.38e6
    assert across_m * scale == pytest.approx(2.0 * expected_m, rel=2e-3)
    assert math.copysign(1.0, m.state.turn_rate_rad_s) == side


@settings(max_examples=20, deadline=None)
@given(st.floats(1.0, 12.0), st.floats(0.0, 359.0))
def test_wind_carries_it_by_wind_times_time(wind_m_s: float, from_deg: float) -> None:
    """Two aircraft flying alike, one in wind, end wind times time apart, downwind."""
    calm, blown = model(), model((wind_m_s, from_deg, 0.0, 0))
    command = FlightCommand(math.radians(20.0), 20.0, 0.0)
    fly(calm, 60.0, command)
    fly(blown, 60.0, command)
    azimuth_deg, _, apart_m = GEOD.inv(
        calm.state.lon_deg, calm.state.lat_deg, blown.state.lon_deg, blown.state.lat_deg
    )
    assert apart_m == pytest.approx(60.0 * wind_m_s, rel=1e-3)
    assert math.cos(math.radians(azimuth_deg - from_deg - 180.0)) > 0.9999


@pytest.mark.parametrize("heading_deg", [0.0, 45.0, 90.0, 200.0])
def test_wings_level_flight_follows_the_geodesic(heading_deg: float) -> None:
    """After 10 minutes wings level, 12 km on, it is within 0.5 m of the geodesic's end."""
    m = model(heading_deg=heading_deg)
    fly(m, 600.0, FlightCommand(0.0, 20.0, 0.0))
    scale = 1.0 + m.state.altitude_m / 6.38e6
    lon, lat, _ = GEOD.fwd(HOME.lon_deg, HOME.lat_deg, heading_deg, 12_000.0 * THIN / scale)
    _, _, miss_m = GEOD.inv(m.state.lon_deg, m.state.lat_deg, lon, lat)
    assert miss_m < 0.5


def test_roll_rate_and_bank_are_limited() -> None:
    """A demand for a knife edge rolls at the limit's rate and stops at its bank."""
    m = model()
    previous = 0.0
    for _ in range(200):
        state = m.step(m.step_s, FlightCommand(math.pi / 2.0, 20.0, 0.0))
        assert state.bank_rad - previous <= LIMITS.roll_rate_rad_s * m.step_s + 1e-12
        previous = state.bank_rad
    assert previous == pytest.approx(LIMITS.max_bank_rad, rel=1e-3)
    assert previous <= LIMITS.max_bank_rad


def test_climb_and_airspeed_are_limited() -> None:
    """Absurd demands end at the climb limit and the fastest airspeed, not beyond."""
    m = model()
    fly(m, 30.0, FlightCommand(0.0, 500.0, 50.0))
    assert m.state.climb_m_s == pytest.approx(LIMITS.climb_m_s, rel=1e-3)
    thin = true_over_equivalent(m.state.altitude_m)
    assert m.state.airspeed_m_s == pytest.approx(LIMITS.fastest_m_s * thin, rel=1e-3)
    fly(m, 30.0, FlightCommand(0.0, 0.0, -50.0))
    assert m.state.climb_m_s == pytest.approx(-LIMITS.sink_m_s, rel=1e-3)
    assert m.state.airspeed_m_s == pytest.approx(
        LIMITS.stall_m_s * true_over_equivalent(m.state.altitude_m), rel=1e-2
    )


def test_it_stands_until_launched() -> None:
    """On the ground no command but a launch moves it, whatever the wind; the launch lifts it off."""
    m = model((8.0, 90.0, 2.0, 1), airborne=False)
    fly(m, 20.0, FlightCommand(0.5, 20.0, 5.0))
    assert east_north_m(m.state.lat_deg, m.state.lon_deg) == pytest.approx((0.0, 0.0), abs=1e-6)
    assert m.state.on_ground
    fly(m, 20.0, FlightCommand(0.0, 20.0, 5.0, launch=True))
    assert not m.state.on_ground
    assert m.state.altitude_m > HOME.altitude_m + 50.0


def test_it_lands_when_it_meets_the_ground() -> None:
    """A descent ends on the ground, where it brakes to a stand."""
    m = model()
    fly(m, 60.0, FlightCommand(0.0, 20.0, -4.0))
    assert m.state.on_ground
    assert m.state.altitude_m == HOME.altitude_m
    assert m.state.ground_speed_m_s == 0.0


def test_gusts_are_seeded() -> None:
    """The same seed gives the same flight, another seed another."""
    ends = []
    for seed in (7, 7, 8):
        m = model((5.0, 270.0, 2.0, seed))
        fly(m, 30.0, FlightCommand(0.0, 20.0, 0.0))
        ends.append((m.state.lat_deg, m.state.lon_deg))
    assert ends[0] == ends[1]
    assert ends[0] != ends[2]
