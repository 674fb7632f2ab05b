"""What a simulated autopilot tells: rates, positions, parameters, energy, refusals."""

from __future__ import annotations

import math
from itertools import pairwise

import pytest

from mavlink.sim.modes import Flavour
from mavlink.sim.settings import SimSettings
from mavlink.sim.streams import STREAMS
from mavlink.wire.items import Command
from tests.mavlink.sim.helpers import (
    HOME,
    from_ground,
)
from tests.mavlink.sim.stations import loaded, station, told


def test_telemetry_keeps_its_rates_in_simulated_time() -> None:
    """At ten times real time every message keeps its rate per simulated second, timestamps included."""
    s = loaded(Flavour.ARDUPILOT, speedup=10.0)
    s.start()
    s.heard.clear()
    begin_s = s.aircraft.sim_time_s
    s.fly(10.0)
    assert s.aircraft.sim_time_s - begin_s == pytest.approx(100.0, abs=1.0)
    for name, (_, rate) in STREAMS.items():
        if rate >= 0.5:
            assert len(s.named(name)) == pytest.approx(100.0 * rate, rel=0.15, abs=2), name
    stamps = [m.integer("time_boot_ms") for m in s.named("GLOBAL_POSITION_INT")]
    assert {b - a for a, b in pairwise(stamps)} <= {200, 225, 175}


def test_time_runs_at_its_own_pace_while_disarmed() -> None:
    """Speed-up is for flight: on the ground a simulated second is a second."""
    s = station(speedup=50.0)
    s.wait(10.0)
    assert s.aircraft.sim_time_s == pytest.approx(10.0, abs=0.1)


def test_positions_told_are_positions_flown() -> None:
    """GLOBAL_POSITION_INT, GPS_RAW_INT, VFR_HUD and ATTITUDE all tell the state, in their units."""
    s = loaded(Flavour.ARDUPILOT, wind_m_s=4.0)
    s.start()
    s.fly(90.0)
    state = s.aircraft.state
    position, gps, hud, attitude = (
        told(s, name) for name in ("GLOBAL_POSITION_INT", "GPS_RAW_INT", "VFR_HUD", "ATTITUDE")
    )
    height_m = state.altitude_m - HOME.altitude_m
    assert position.integer("lat") / 1e7 == pytest.approx(state.lat_deg, abs=1e-7)
    assert position.integer("lon") / 1e7 == pytest.approx(state.lon_deg, abs=1e-7)
    assert position.integer("relative_alt") / 1e3 == pytest.approx(height_m, abs=1e-3)
    assert math.hypot(position.number("vx"), position.number("vy")) / 100.0 == pytest.approx(
        hud.number("groundspeed"), abs=0.02
    )
    assert gps.integer("alt") == position.integer("alt")
    assert attitude.number("roll") == state.bank_rad
    assert abs(hud.number("airspeed") - 20.0) < 1.0


def test_intervals_and_requests_are_obeyed() -> None:
    """SET_MESSAGE_INTERVAL speeds up, stops and restores a message; REQUEST_MESSAGE sends one."""
    s = station()
    number = float(STREAMS["ATTITUDE"][0])
    for interval_us, expected in ((100_000.0, 100), (-1.0, 0), (0.0, 40)):
        assert s.command(Command.SET_MESSAGE_INTERVAL, number, interval_us) == 0
        s.heard.clear()
        s.wait(10.0)
        assert len(s.named("ATTITUDE")) == pytest.approx(expected, abs=2)
    assert s.command(Command.REQUEST_MESSAGE, float(STREAMS["AUTOPILOT_VERSION"][0])) == 0
    assert len(s.named("AUTOPILOT_VERSION")) == 1
    assert s.command(Command.REQUEST_MESSAGE, 9999.0) == 3
    assert s.command(31999) == 3


def test_parameters_can_be_read() -> None:
    """A list, one by name, one by index; unknown names draw nothing and setting changes nothing."""
    s = station()
    values = s.say(from_ground("PARAM_REQUEST_LIST"))
    assert [m.integer("param_index") for m in values] == list(range(values[0].integer("param_count")))
    (by_name,) = s.say(from_ground("PARAM_REQUEST_READ", param_id="WP_LOITER_RAD", param_index=-1))
    assert by_name.number("param_value") == 100.0
    index = by_name.integer("param_index")
    assert s.say(from_ground("PARAM_REQUEST_READ", param_id="", param_index=index)) == [by_name]
    assert s.say(from_ground("PARAM_REQUEST_READ", param_id="NOPE", param_index=-1)) == []
    answers = s.say(from_ground("PARAM_SET", param_id="WP_LOITER_RAD", param_value=5.0, param_type=9))
    assert answers == [by_name]


def test_energy_is_used_in_flight() -> None:
    """The battery runs down in flight, by roughly the cruise power, and not on the ground."""
    s = loaded(Flavour.ARDUPILOT)
    s.wait(60.0)
    assert told(s, "BATTERY_STATUS").integer("energy_consumed") == 0
    s.start()
    s.fly(100.0)
    before = told(s, "BATTERY_STATUS").integer("energy_consumed")
    s.fly(100.0)
    # hectojoules: 250 W for 100 s
    assert told(s, "BATTERY_STATUS").integer("energy_consumed") - before == pytest.approx(250, rel=0.1)


def test_refused_settings_say_why() -> None:
    """Other vehicles, impossible turns, wind too strong and models out of their speeds are refused."""
    with pytest.raises(ValueError, match="transitions"):
        SimSettings(vehicle_type="vtol")
    with pytest.raises(ValueError, match="fixed_wing"):
        SimSettings(vehicle_type="balloon")
    with pytest.raises(ValueError, match="multirotor"):
        SimSettings(vehicle_type="multirotor", dynamics="jsbsim")
    with pytest.raises(ValueError, match="degrees of bank"):
        SimSettings(airspeed_m_s=50.0, turn_radius_m=100.0)
    with pytest.raises(ValueError, match="wind"):
        SimSettings(wind_m_s=19.0)
    with pytest.raises(ValueError, match="c172p"):
        SimSettings(dynamics="jsbsim")
    assert SimSettings(dynamics="auto").flight_model == "kinematic"
