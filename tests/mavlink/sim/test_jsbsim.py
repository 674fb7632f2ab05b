"""JSBSim's Cessna behind the same autopilot; skipped where its wheel does not exist."""

from __future__ import annotations

import math
from importlib.util import find_spec

import pytest

from mavlink.sim.autopilot import SimulatedAircraft
from mavlink.sim.dynamics import GRAVITY_M_S2
from mavlink.sim.settings import SimSettings
from mavlink.wire.items import Command
from tests.mavlink.sim.helpers import (
    HOME,
    Station,
    arc_waypoints,
    east_north_m,
    item,
    place_at,
    true_over_equivalent,
    waypoint,
)

pytestmark = pytest.mark.skipif(find_spec("jsbsim") is None, reason="jsbsim is not installed")
SETTINGS = SimSettings(home=HOME, airspeed_m_s=50.0, turn_radius_m=500.0, dynamics="jsbsim")


def test_auto_flies_jsbsim_at_its_speeds_only() -> None:
    """``auto`` is JSBSim at 50 m/s, the kinematic model at 20 m/s."""
    assert SimSettings(airspeed_m_s=50.0, turn_radius_m=500.0, dynamics="auto").flight_model == "jsbsim"
    assert SimSettings(airspeed_m_s=20.0, dynamics="auto").flight_model == "kinematic"


def test_a_mission_with_arcs_is_flown() -> None:
    """A pass of 2 km behind an arc of 500 m is flown within 10 m, at 50 m/s and its height; it lands."""
    body = [waypoint(*place, 300.0) for place in ((-1500.0, 1000.0), (-1500.0, 2000.0), (1000.0, 2000.0))]
    body += arc_waypoints(1000.0, 2500.0, 500.0, -90.0, 180.0, 15.0, 300.0)[1:]
    body += [waypoint(-1000.0, 3000.0, 300.0), waypoint(-2500.0, 3000.0, 300.0)]
    mission = [
        item(Command.NAV_WAYPOINT, HOME),
        item(Command.NAV_TAKEOFF, place_at(0.0, 600.0, HOME.altitude_m + 100.0), (10.0,)),
        *body,
        item(Command.NAV_LOITER_TO_ALT, place_at(0.0, -3000.0, HOME.altitude_m + 60.0), (1.0, 500.0)),
        waypoint(0.0, -1500.0, 60.0),
        item(Command.NAV_LAND, HOME),
    ]
    s = Station(SimulatedAircraft(SETTINGS))
    assert s.upload(mission) == 0
    s.start()
    s.fly_until_disarmed(900.0)
    assert s.reached() == list(range(1, len(mission)))
    second = [
        state
        for state in s.track
        if abs(state.lon_deg - HOME.lon_deg) < 0.013 and state.east_m_s < -40.0 and state.altitude_m > 780.0
    ]
    errors_m = [abs(east_north_m(state.lat_deg, state.lon_deg)[1] - 3000.0) for state in second]
    assert len(errors_m) > 500
    assert max(errors_m) < 10.0
    assert all(state.altitude_m == pytest.approx(HOME.altitude_m + 300.0, abs=10.0) for state in second)
    assert all(state.airspeed_m_s == pytest.approx(50.0, abs=3.0) for state in second)


def test_a_steady_turn_has_the_radius_of_its_bank() -> None:
    """Circling at 500 m, wider in thin air, turn rate, speed and bank agree with g tan(bank) / V."""
    s = Station(SimulatedAircraft(SETTINGS))
    takeoff = item(Command.NAV_TAKEOFF, place_at(0.0, 600.0, HOME.altitude_m + 100.0), (10.0,))
    loiter = item(Command.NAV_LOITER_UNLIM, place_at(0.0, 2500.0, HOME.altitude_m + 200.0), (0.0, 0.0, 500.0))
    assert s.upload([item(Command.NAV_WAYPOINT, HOME), takeoff, loiter]) == 0
    s.start()
    s.fly(150.0)
    state = s.aircraft.state
    expected = GRAVITY_M_S2 * math.tan(state.bank_rad) / state.airspeed_m_s
    assert state.turn_rate_rad_s == pytest.approx(expected, rel=0.1)
    east_m, north_m = east_north_m(state.lat_deg, state.lon_deg)
    assert math.hypot(east_m, north_m - 2500.0) == pytest.approx(
        500.0 * true_over_equivalent(state.altitude_m) ** 2, abs=10.0
    )


def test_it_says_nothing_on_standard_output(capfd: pytest.CaptureFixture[str]) -> None:
    """Standard output belongs to results: JSBSim's greeting is not printed."""
    s = Station(SimulatedAircraft(SETTINGS))
    assert s.upload([item(Command.NAV_WAYPOINT, HOME), item(Command.NAV_TAKEOFF, place_at(0.0, 600.0))]) == 0
    s.start()
    s.fly(15.0)
    assert not s.aircraft.state.on_ground
    assert capfd.readouterr().out == ""
