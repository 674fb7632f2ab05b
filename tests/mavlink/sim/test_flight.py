"""Whole missions, flown as fast as they go: every waypoint, every pass, every trigger."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mavlink.sim.autopilot import SimulatedAircraft
from mavlink.sim.commands import CommandResult
from mavlink.sim.dynamics import AircraftState
from mavlink.sim.modes import Flavour, Mode
from mavlink.sim.settings import SimSettings
from mavlink.wire.items import Command, MissionItem
from mavlink.wire.messages import Message
from tests.mavlink.sim.helpers import (
    HOME,
    Station,
    arc_waypoints,
    east_north_m,
    from_ground,
    item,
    landing_mission,
    place_at,
    waypoint,
)

FLAVOURS = list(Flavour)
PASS_M = 500.0
RADIUS_M = 100.0
STEP_DEG = 22.5
NORTH_M = 1500.0


def switch(flavour: Flavour, on: bool) -> MissionItem:
    if flavour is Flavour.ARDUPILOT:
        return item(Command.DO_SET_RELAY, None, (0.0, float(on)))
    return item(Command.DO_SET_ACTUATOR, None, (1.0 if on else -1.0, math.nan, math.nan, math.nan))


def racetrack(flavour: Flavour, passes: int) -> list[MissionItem]:
    """Passes of 500 m to and fro; a pass begins where the arc of 100 m radius before it ends."""
    body = [waypoint(-900.0, NORTH_M - 400.0), waypoint(-800.0, NORTH_M)]
    for number in range(passes):
        north_m = NORTH_M + 2.0 * RADIUS_M * number
        sense = 1.0 if number % 2 == 0 else -1.0
        begin_m, end_m = -sense * PASS_M / 2.0, sense * PASS_M / 2.0
        body += [waypoint(begin_m, north_m), switch(flavour, True)]
        body += [waypoint(end_m, north_m), switch(flavour, False)]
        if number + 1 < passes:
            arc = arc_waypoints(end_m, north_m + RADIUS_M, RADIUS_M, -90.0, sense * 180.0, STEP_DEG)
            body += arc[1:-1]
    return body


def flown(flavour: Flavour, body: list[MissionItem], **options: float) -> Station:
    s = Station(SimulatedAircraft(SimSettings(home=HOME, autopilot=flavour, **options)))
    assert s.upload(landing_mission(body, home_row=flavour is Flavour.ARDUPILOT)) == 0
    s.start()
    s.fly_until_disarmed(1500.0)
    return s


def switchings(s: Station) -> list[tuple[int, int]]:
    """Simulated milliseconds and value of each change of SAR_ON."""
    changes: list[tuple[int, int]] = []
    last = 0
    for message in s.named("NAMED_VALUE_INT"):
        assert message.text("name") == "SAR_ON"
        if message.integer("value") != last:
            last = message.integer("value")
            changes.append((message.integer("time_boot_ms"), last))
    return changes


def at(s: Station, ms: int) -> AircraftState:
    return min(s.track, key=lambda state: abs(state.time_s * 1000.0 - ms))


@pytest.mark.parametrize("flavour", FLAVOURS)
@pytest.mark.parametrize("wind", [(0.0, 0.0), (8.0, 300.0)])
def test_passes_right_after_arcs_are_flown_within_metres(flavour: Flavour, wind: tuple[float, float]) -> None:
    """Every item is reached, passes keep within 5 m (10 are allowed), the sensor is on for just them."""
    passes = 4
    body = racetrack(flavour, passes)
    s = flown(flavour, body, wind_m_s=wind[0], wind_from_deg=wind[1])
    mission = landing_mission(body, home_row=flavour is Flavour.ARDUPILOT)
    first = 1 if flavour is Flavour.ARDUPILOT else 0
    assert s.reached() == [
        seq for seq, each in enumerate(mission) if seq >= first and each.command in (16, 21, 22, 31)
    ]
    changes = switchings(s)
    assert [value for _, value in changes] == [1, 0] * passes
    for number in range(passes):
        (on_ms, _), (off_ms, _) = changes[2 * number : 2 * number + 2]
        north_m = NORTH_M + 2.0 * RADIUS_M * number
        sense = 1.0 if number % 2 == 0 else -1.0
        for ms, east_m in ((on_ms, -sense * PASS_M / 2.0), (off_ms, sense * PASS_M / 2.0)):
            state = at(s, ms)
            assert east_north_m(state.lat_deg, state.lon_deg)[0] == pytest.approx(east_m, abs=2.5)
        during = [state for state in s.track if on_ms <= state.time_s * 1000.0 <= off_ms]
        for state in during:
            assert east_north_m(state.lat_deg, state.lon_deg)[1] == pytest.approx(north_m, abs=5.0)
            assert state.altitude_m == pytest.approx(HOME.altitude_m + 100.0, abs=2.0)
    touchdown = next(state for state in reversed(s.track) if not state.on_ground)
    assert math.hypot(*east_north_m(touchdown.lat_deg, touchdown.lon_deg)) < 80.0
    assert s.aircraft.mission_complete


def test_arcs_are_flown_at_their_radius() -> None:
    """A half circle of 100 m radius given as waypoints is flown within 5 m of it."""
    s = flown(Flavour.ARDUPILOT, racetrack(Flavour.ARDUPILOT, 2))
    centre = (PASS_M / 2.0, NORTH_M + RADIUS_M)
    places = [east_north_m(state.lat_deg, state.lon_deg) for state in s.track]
    errors_m = [
        math.dist(place, centre) - RADIUS_M
        for place in places
        if place[0] > centre[0] + 10.0 and abs(place[1] - centre[1]) < RADIUS_M + 10.0
    ]
    assert len(errors_m) > 100
    assert max(map(abs, errors_m)) < 5.0


def test_photos_are_taken_at_their_spacing() -> None:
    """Distance mode: the first photo at once, then every 25 m to within a look, and none after the end."""
    body = [
        waypoint(0.0, 1000.0),
        item(Command.DO_SET_CAM_TRIGG_DIST, None, (25.0, 0.0, 1.0)),
        waypoint(0.0, 1500.0),
        item(Command.DO_SET_CAM_TRIGG_DIST, None, (0.0,)),
        waypoint(0.0, 1800.0),
    ]
    for flavour, name in ((Flavour.ARDUPILOT, "CAMERA_FEEDBACK"), (Flavour.PX4, "CAMERA_IMAGE_CAPTURED")):
        s = flown(flavour, body)
        norths = [_north_m(message) for message in s.named(name)]
        assert norths[0] == pytest.approx(1000.0, abs=1.0)
        assert len(norths) in (20, 21)
        assert norths[-1] <= 1501.0
        spacings = [b - a for a, b in pairwise(norths)]
        looked_m = 0.6 if flavour is Flavour.ARDUPILOT else 2.1
        assert all(25.0 - 0.05 <= spacing <= 25.0 + looked_m for spacing in spacings)


def _north_m(message: Message) -> float:
    lon = message.integer("lng" if "lng" in message.fields else "lon") / 1e7
    return east_north_m(message.integer("lat") / 1e7, lon)[1]


@pytest.mark.parametrize(
    ("on", "off"),
    [
        (item(Command.DO_SET_SERVO, None, (9.0, 1900.0)), item(Command.DO_SET_SERVO, None, (9.0, 1100.0))),
        (item(Command.IMAGE_START_CAPTURE, None, (0.0, 2.0, 0.0)), item(Command.IMAGE_STOP_CAPTURE, None)),
        (item(31010, None, (1.0,)), item(31010, None, (0.0,))),
    ],
)
def test_every_way_to_switch_the_sensor_works(on: MissionItem, off: MissionItem) -> None:
    """Servo, capture and user command switch the sensor on behind one waypoint and off behind the next."""
    body = [waypoint(0.0, 900.0), on, waypoint(0.0, 1400.0), off, waypoint(0.0, 1700.0)]
    s = flown(Flavour.ARDUPILOT, body)
    (on_ms, _), (off_ms, _) = switchings(s)
    assert east_north_m(at(s, on_ms).lat_deg, at(s, on_ms).lon_deg)[1] == pytest.approx(900.0, abs=2.5)
    assert east_north_m(at(s, off_ms).lat_deg, at(s, off_ms).lon_deg)[1] == pytest.approx(1400.0, abs=2.5)
    if on.command == Command.IMAGE_START_CAPTURE:
        # 500 m at 20 m/s, one every 2 s
        assert len(s.named("CAMERA_FEEDBACK")) == pytest.approx(13, abs=1)


def test_conditions_delay_what_follows() -> None:
    """CONDITION_DISTANCE holds the switch until 200 m before the waypoint, CONDITION_DELAY for seconds."""
    body = [
        waypoint(0.0, 800.0),
        item(Command.CONDITION_DISTANCE, None, (200.0,)),
        item(Command.DO_SET_RELAY, None, (0.0, 1.0)),
        waypoint(0.0, 1600.0),
        item(Command.CONDITION_DELAY, None, (5.0,)),
        item(Command.DO_SET_RELAY, None, (0.0, 0.0)),
        waypoint(0.0, 2400.0),
    ]
    s = flown(Flavour.ARDUPILOT, body)
    (on_ms, _), (off_ms, _) = switchings(s)
    assert east_north_m(at(s, on_ms).lat_deg, at(s, on_ms).lon_deg)[1] == pytest.approx(1400.0, abs=3.0)
    assert east_north_m(at(s, off_ms).lat_deg, at(s, off_ms).lon_deg)[1] == pytest.approx(1700.0, abs=5.0)


def test_loiters_turn_as_often_and_as_long_as_ordered() -> None:
    """LOITER_TURNS 2 turns twice to the left, LOITER_TIME 30 s, then the mission goes on north."""
    body = [
        item(Command.NAV_LOITER_TURNS, place_at(0.0, 1000.0), (2.0, 0.0, -120.0)),
        waypoint(0.0, 1800.0),
        item(Command.NAV_LOITER_TIME, place_at(0.0, 2400.0), (30.0, 0.0, 1.0)),
        waypoint(0.0, 3000.0),
    ]
    s = flown(Flavour.ARDUPILOT, body)
    turned = {2: 0.0, 4: 0.0}
    seconds = {2: 0.0, 4: 0.0}
    places = {
        2: place_at(0.0, 1000.0),
        4: place_at(0.0, 2400.0),
    }
    for state in s.track:
        for seq, place in places.items():
            off_m = math.dist(
                east_north_m(state.lat_deg, state.lon_deg), east_north_m(place.lat_deg, place.lon_deg)
            )
            if off_m < 140.0:
                turned[seq] += state.turn_rate_rad_s * 0.05
                seconds[seq] += 0.05
    assert 2.0 * 2.0 * math.pi - 0.5 < -turned[2] < 3.6 * 2.0 * math.pi
    assert 30.0 <= seconds[4] <= 30.0 + 45.0
    assert turned[4] > 0.0


def test_jumps_are_counted() -> None:
    """DO_JUMP back twice flies its leg three times."""
    body = [
        waypoint(0.0, 1000.0),
        waypoint(600.0, 1000.0),
        waypoint(600.0, 1600.0),
        item(Command.DO_JUMP, None, (2.0, 2.0)),
    ]
    s = flown(Flavour.ARDUPILOT, body)
    assert s.reached().count(3) == 3
    assert s.reached().count(4) == 3


def test_a_mission_without_an_end_leads_home_or_holds() -> None:
    """After its last item ArduPilot returns; a mission's own RTL item does the same at once."""
    for tail in ([], [item(Command.NAV_RETURN_TO_LAUNCH)]):
        mission = landing_mission([waypoint(0.0, 900.0)], home_row=True)[:3] + tail
        s = Station(SimulatedAircraft(SimSettings(home=HOME)))
        assert s.upload(mission) == 0
        s.start()
        s.fly(200.0)
        assert s.aircraft.mode.value == "RTL"
        assert s.aircraft.mission_complete
        assert any("Mission complete" in text for text in s.texts())


@pytest.mark.parametrize("flavour", FLAVOURS)
def test_a_shorter_mission_taken_up_in_flight_is_flown_once_it_is_ordered(flavour: Flavour) -> None:
    """At an item that the new one has not, the mission is over; ordered from its first item, it is flown."""
    home_row = flavour is Flavour.ARDUPILOT
    first = int(home_row)
    long = landing_mission([waypoint(0.0, 500.0 * n) for n in range(1, 9)], home_row=home_row)
    s = Station(SimulatedAircraft(SimSettings(home=HOME, autopilot=flavour)))
    assert s.upload(long) == 0
    s.start()
    s.fly(150.0)
    short = landing_mission([waypoint(0.0, 2500.0)], home_row=home_row)
    del short[first]
    assert s.aircraft.pilot.current >= len(short)
    assert s.upload(short) == 0
    s.fly(1.0)
    assert s.aircraft.mode is (Mode.RTL if home_row else Mode.LOITER)
    s.say(from_ground("MISSION_SET_CURRENT", seq=first))
    assert s.command(Command.MISSION_START) == 0
    s.fly(1.0)
    assert (s.aircraft.mode, s.aircraft.pilot.current) == (Mode.AUTO, first)
    s.fly_until_disarmed(600.0)
    assert s.aircraft.mission_complete


def test_px4_does_not_start_from_the_ground_without_a_takeoff() -> None:
    """What may be taken up in flight is denied on the ground."""
    s = Station(SimulatedAircraft(SimSettings(home=HOME, autopilot=Flavour.PX4)))
    assert s.upload(landing_mission([waypoint(0.0, 1000.0)], home_row=False)[1:]) == 0
    assert s.command(Command.COMPONENT_ARM_DISARM, 1.0) == 0
    assert s.command(Command.MISSION_START) == CommandResult.DENIED
    assert any("mission has no takeoff" in text for text in s.texts())


ODD = st.sampled_from([math.nan, math.inf, -1.0, 0.0, 1.0, 3.0, 1e9])


@settings(max_examples=40, deadline=None)
@given(
    st.lists(
        st.tuples(
            st.sampled_from([16, 17, 19, 31, 112, 114, 177, 178, 187, 206, 214, 2000, 2001, 2003]),
            st.tuples(ODD, ODD, ODD, ODD),
            ODD,
        ),
        max_size=8,
    )
)
def test_odd_numbers_in_a_mission_do_not_down_the_aircraft(
    orders: list[tuple[int, tuple[float, float, float, float], float]],
) -> None:
    """PX4 takes almost any number in an item; whatever the mission says, the state stays finite."""
    body = []
    for number, (command, params, z) in enumerate(orders):
        place = place_at(100.0 * number, 800.0) if command in (16, 17, 19, 31) else None
        body.append(replace(item(command, place, params), z=z))
    s = Station(SimulatedAircraft(SimSettings(home=HOME, autopilot=Flavour.PX4)))
    if s.upload(landing_mission(body, home_row=False)) != 0:
        return
    if s.command(Command.MISSION_START) != 0:
        assert any("not started" in text for text in s.texts())
        return
    for _ in range(20):
        s.wait(10.0)
        state = s.aircraft.state
        assert all(map(math.isfinite, (state.lat_deg, state.lon_deg, state.altitude_m, state.bank_rad)))
