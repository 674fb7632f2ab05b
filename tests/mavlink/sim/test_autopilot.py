"""Modes, commands and telemetry of the simulated aircraft; nothing moves without an explicit command."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mavlink.sim.modes import Flavour, Mode, custom_mode
from mavlink.wire.items import Command
from tests.mavlink.sim.helpers import (
    GEOD,
    HOME,
    Station,
    east_north_m,
    from_ground,
    item,
    landing_mission,
    place_at,
    true_over_equivalent,
    waypoint,
)
from tests.mavlink.sim.stations import LONG_WAY, loaded, station

FLAVOURS = list(Flavour)


def away_m(s: Station) -> float:
    return math.hypot(*east_north_m(s.aircraft.state.lat_deg, s.aircraft.state.lon_deg))


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
    state = s.aircraft.state
    assert state.airspeed_m_s == pytest.approx(24.0 * true_over_equivalent(state.altitude_m), abs=0.1)
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
