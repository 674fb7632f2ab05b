"""Modes, commands and telemetry of the simulated aircraft; nothing moves without an explicit command."""

from __future__ import annotations

import math
from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mavlink.sim.autopilot import SimulatedAircraft
from mavlink.sim.modes import Flavour, Mode, custom_mode
from mavlink.sim.settings import SimSettings
from mavlink.sim.telemetry import STREAMS
from mavlink.wire.items import Command, MissionItem
from mavlink.wire.messages import Message
from tests.mavlink.sim.helpers import (
    GEOD,
    HOME,
    Station,
    east_north_m,
    from_ground,
    item,
    landing_mission,
    place_at,
    waypoint,
)

FLAVOURS = list(Flavour)
LONG_WAY = [waypoint(0.0, 1000.0), waypoint(0.0, 6000.0)]


def station(flavour: Flavour = Flavour.ARDUPILOT, **options: float | bool | str) -> Station:
    return Station(SimulatedAircraft(SimSettings(home=HOME, autopilot=flavour, **options)))


def loaded(flavour: Flavour, body: list[MissionItem] | None = None, **options: float) -> Station:
    s = station(flavour, **options)
    assert s.upload(landing_mission(body or LONG_WAY, home_row=flavour is Flavour.ARDUPILOT)) == 0
    return s


def away_m(s: Station) -> float:
    return math.hypot(*east_north_m(s.aircraft.state.lat_deg, s.aircraft.state.lon_deg))


def told(s: Station, name: str) -> Message:
    message = s.aircraft.message(name)
    assert message is not None
    return message


def stands(s: Station) -> bool:
    return away_m(s) < 1e-6 and s.aircraft.state.altitude_m == HOME.altitude_m


@pytest.mark.parametrize("flavour", FLAVOURS)
def test_nothing_moves_without_a_command(flavour: Flavour) -> None:
    """With a mission on board and nothing ordered it stands, whatever the wind."""
    s = loaded(flavour, wind_m_s=9.0, gust_m_s=3.0)
    s.wait(300.0)
    assert stands(s)
    assert not s.aircraft.armed


@pytest.mark.parametrize("flavour", FLAVOURS)
def test_arming_alone_moves_nothing(flavour: Flavour) -> None:
    """Armed and not started it stands."""
    s = loaded(flavour)
    assert s.command(Command.COMPONENT_ARM_DISARM, 1.0) == 0
    s.wait(120.0)
    assert s.aircraft.armed
    assert stands(s)


def test_starting_alone_moves_no_ardupilot() -> None:
    """AUTO without arming stands; arming then starts the take-off."""
    s = loaded(Flavour.ARDUPILOT)
    assert s.command(Command.MISSION_START) == 0
    s.wait(120.0)
    assert stands(s)
    assert s.command(Command.COMPONENT_ARM_DISARM, 1.0) == 0
    s.wait(30.0)
    assert away_m(s) > 100.0


def test_px4_arms_on_mission_start() -> None:
    """On PX4 the order to start is an order to arm, as on the real one."""
    s = loaded(Flavour.PX4)
    assert s.command(Command.MISSION_START) == 0
    assert s.aircraft.armed
    s.wait(30.0)
    assert away_m(s) > 100.0


@settings(max_examples=60, deadline=None)
@given(
    st.sampled_from(FLAVOURS),
    st.lists(
        st.tuples(
            st.sampled_from([c for c in Command if c not in (400, 300)]),
            st.lists(st.floats(-5.0, 5.0) | st.just(math.nan) | st.just(math.inf), max_size=7),
        ),
        max_size=8,
    ),
)
def test_no_other_command_moves_it(flavour: Flavour, orders: list[tuple[Command, list[float]]]) -> None:
    """Whatever else is ordered on the ground, an aircraft that is not armed stands."""
    s = loaded(flavour)
    for command, params in orders:
        s.command(command, *params)
        s.wait(2.0)
    assert not s.aircraft.armed
    assert stands(s)


@pytest.mark.parametrize("mode", [Mode.RTL, Mode.LOITER, Mode.GUIDED])
def test_other_modes_do_not_leave_the_ground(mode: Mode) -> None:
    """Armed on the ground, no mode but AUTO moves it."""
    s = loaded(Flavour.ARDUPILOT)
    assert s.command(Command.COMPONENT_ARM_DISARM, 1.0) == 0
    assert s.command(Command.DO_SET_MODE, 1.0, float(custom_mode(Flavour.ARDUPILOT, mode))) == 0
    s.wait(60.0)
    assert stands(s)


@pytest.mark.parametrize("flavour", FLAVOURS)
def test_a_start_without_a_mission_is_denied(flavour: Flavour) -> None:
    """DENIED, and a STATUSTEXT says why; the mode stays."""
    s = station(flavour)
    before = s.aircraft.mode
    assert s.command(Command.MISSION_START) == 2
    assert any("no mission" in text for text in s.texts())
    assert s.aircraft.mode is before


def test_a_mission_without_takeoff_is_not_started_on_the_ground() -> None:
    """Waypoints alone are denied on the ground."""
    s = station()
    assert s.upload([item(Command.NAV_WAYPOINT, HOME), *LONG_WAY]) == 0
    assert s.command(Command.MISSION_START) == 2
    assert any("takeoff" in text for text in s.texts())


def test_pause_circles_and_resume_flies_on() -> None:
    """A pause circles on the spot at the same height; resuming goes on with the same item."""
    for flavour in FLAVOURS:
        s = loaded(flavour)
        s.start()
        s.fly(120.0)
        current = s.aircraft.pilot.current
        assert s.command(Command.DO_PAUSE_CONTINUE, 0.0) == 0
        here, height_m = east_north_m(s.aircraft.state.lat_deg, s.aircraft.state.lon_deg), 588.0
        s.track.clear()
        s.fly(120.0)
        for state in s.track:
            assert math.dist(here, east_north_m(state.lat_deg, state.lon_deg)) < 260.0
            assert state.altitude_m == pytest.approx(height_m, abs=5.0)
        assert s.aircraft.pilot.current == current
        assert s.command(Command.DO_PAUSE_CONTINUE, 1.0) == 0
        assert s.aircraft.mode is Mode.AUTO
        assert s.aircraft.pilot.current == current
        s.fly_until_disarmed(1500.0)


def test_ardupilot_returns_and_circles_px4_returns_and_lands() -> None:
    """RTL ends in a circle over home at the return altitude, or on the ground at home."""
    for flavour in FLAVOURS:
        s = loaded(flavour)
        s.start()
        s.fly(100.0)
        assert s.command(Command.NAV_RETURN_TO_LAUNCH) == 0
        s.fly(250.0)
        state = s.aircraft.state
        if flavour is Flavour.ARDUPILOT:
            assert not state.on_ground
            assert away_m(s) == pytest.approx(100.0, abs=5.0)
            assert state.altitude_m == pytest.approx(HOME.altitude_m + 100.0, abs=2.0)
        else:
            assert state.on_ground
            assert away_m(s) < 120.0
            assert not s.aircraft.armed


def test_goto_flies_there_and_circles() -> None:
    """DO_REPOSITION (COMMAND_INT) and ArduPilot's guided item both end in a circle round the place."""
    place = place_at(800.0, 400.0, HOME.altitude_m + 150.0)
    x, y = round(place.lat_deg * 1e7), round(place.lon_deg * 1e7)
    common = {"frame": 6, "x": x, "y": y, "z": 150.0, "autocontinue": 1, "param1": 0.0, "param2": 0.0}
    more = {"param3": 0.0, "param4": 0.0}
    reposition = from_ground("COMMAND_INT", command=192, current=0, **common, **more)
    guided = from_ground("MISSION_ITEM_INT", command=16, current=2, seq=0, **common, **more)
    for message in (reposition, guided):
        s = loaded(Flavour.ARDUPILOT)
        assert all(m.name != "COMMAND_ACK" or m.integer("result") == 2 for m in s.say(message))
        s.start()
        s.fly(60.0)
        s.say(message)
        assert s.aircraft.mode is Mode.GUIDED
        s.fly(120.0)
        state = s.aircraft.state
        _, _, off_m = GEOD.inv(state.lon_deg, state.lat_deg, place.lon_deg, place.lat_deg)
        assert off_m == pytest.approx(100.0, abs=5.0)
        assert state.altitude_m == pytest.approx(place.altitude_m, abs=2.0)


def test_speed_is_changed_on_order_and_by_the_mission() -> None:
    """DO_CHANGE_SPEED sets air speed, or ground speed whatever the wind."""
    body = [waypoint(0.0, 800.0), item(Command.DO_CHANGE_SPEED, None, (0.0, 24.0)), waypoint(0.0, 6000.0)]
    s = loaded(Flavour.ARDUPILOT, body, wind_m_s=5.0)
    s.start()
    s.fly(100.0)
    assert s.aircraft.state.airspeed_m_s == pytest.approx(24.0, abs=0.1)
    assert s.command(Command.DO_CHANGE_SPEED, 1.0, 18.0) == 0
    s.fly(30.0)
    assert s.aircraft.state.ground_speed_m_s == pytest.approx(18.0, abs=0.3)


def test_the_current_item_can_be_chosen() -> None:
    """Command 224 and MISSION_SET_CURRENT skip ahead; past the end they are denied, or unanswered."""
    s = loaded(Flavour.ARDUPILOT)
    s.start()
    s.fly(60.0)
    assert s.command(Command.DO_SET_MISSION_CURRENT, 3.0) == 0
    assert s.aircraft.pilot.current == 3
    assert s.command(Command.DO_SET_MISSION_CURRENT, 99.0) == 2
    assert s.say(from_ground("MISSION_SET_CURRENT", seq=99)) == []
    (answer,) = s.say(from_ground("MISSION_SET_CURRENT", seq=2))
    assert (answer.name, answer.integer("seq")) == ("MISSION_CURRENT", 2)
    assert loaded(Flavour.PX4).command(Command.DO_SET_MISSION_CURRENT, 2.0) == 3


def test_disarming_is_denied_in_flight() -> None:
    """In the air DENIED, on the ground accepted."""
    s = loaded(Flavour.ARDUPILOT)
    s.start()
    s.fly(60.0)
    assert s.command(Command.COMPONENT_ARM_DISARM, 0.0) == 2
    assert s.aircraft.armed
    on_ground = loaded(Flavour.ARDUPILOT)
    assert on_ground.command(Command.COMPONENT_ARM_DISARM, 1.0) == 0
    assert on_ground.command(Command.COMPONENT_ARM_DISARM, 0.0) == 0
    assert not on_ground.aircraft.armed


def test_ardupilot_keeps_its_mission_while_flying_it() -> None:
    """A clear in AUTO fails; a shorter upload is taken and leads home."""
    s = loaded(Flavour.ARDUPILOT, [*LONG_WAY, waypoint(0.0, 7000.0)])
    s.start()
    s.fly(120.0)
    assert s.aircraft.pilot.current == 3
    answers = s.say(from_ground("MISSION_CLEAR_ALL", mission_type=0))
    assert [m.integer("type") for m in answers if m.name == "MISSION_ACK"] == [1]
    takeoff = item(Command.NAV_TAKEOFF, place_at(0.0, 600.0), (10.0,))
    assert s.upload([item(Command.NAV_WAYPOINT, HOME), takeoff]) == 0
    s.wait(1.0)
    assert s.aircraft.mode is Mode.RTL


def test_an_infeasible_upload_drops_px4_to_hold() -> None:
    """A PX4 mission without a landing, uploaded in flight, ends in a circle."""
    s = loaded(Flavour.PX4)
    s.start()
    s.fly(60.0)
    assert s.upload(landing_mission(LONG_WAY, home_row=False)[:-1]) == 0
    s.wait(1.0)
    assert s.aircraft.mode is Mode.LOITER


def test_switching_the_fence_on_says_what_it_is_worth() -> None:
    """ArduPilot takes the order and says that nothing enforces it; PX4 has no such command."""
    s = station(Flavour.ARDUPILOT)
    assert s.command(Command.DO_FENCE_ENABLE, 1.0) == 0
    assert any("not enforced" in text for text in s.texts())
    assert station(Flavour.PX4).command(Command.DO_FENCE_ENABLE, 1.0) == 3


def test_set_mode_is_understood() -> None:
    """SET_MODE changes the mode by its number; a number not simulated changes nothing and says so."""
    s = loaded(Flavour.PX4)
    s.start()
    s.fly(60.0)
    s.say(from_ground("SET_MODE", base_mode=1, custom_mode=custom_mode(Flavour.PX4, Mode.RTL)))
    assert s.aircraft.mode is Mode.RTL
    s.say(from_ground("SET_MODE", base_mode=1, custom_mode=7 << 16))
    assert s.aircraft.mode is Mode.RTL
    assert any("not simulated" in text for text in s.texts())


@pytest.mark.parametrize("flavour", FLAVOURS)
def test_a_second_flight_follows_the_first(flavour: Flavour) -> None:
    """After landing and disarming the same mission can be armed and started again."""
    s = loaded(flavour, [waypoint(0.0, 800.0)])
    s.start()
    s.fly_until_disarmed(600.0)
    assert s.aircraft.mission_complete
    first = len(s.reached())
    s.wait(30.0)
    assert s.aircraft.state.on_ground
    s.start()
    s.fly_until_disarmed(600.0)
    assert len(s.reached()) == 2 * first


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
