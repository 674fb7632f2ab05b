"""Missions made from plans, judged by the plan's exact line, by pymavlink and by the autopilots' rules."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pymavlink.dialects.v20 import common as wire
from shapely.geometry import LineString, MultiPoint, Point, Polygon

from mavlink.dialects import Autopilot, VehicleType
from mavlink.encode import EncodeError, EncodeOptions, Mission, encode
from mavlink.items import Command, Frame, MissionItem, degrees_e7
from mavlink.payload import (
    ActuatorPayload,
    CameraPayload,
    CommandPayload,
    ImagePayload,
    RelayPayload,
    ServoPayload,
)
from planner.plan import Fence, Plan, ZoneCircle, ZonePolygon
from planner.route import Pose
from tests.mavlink.plans import FRAME, LEGS, START, Leg, flown, lonlat, make_plan, square_fence

KINDS: list[tuple[Autopilot, VehicleType]] = [
    ("ardupilot", "fixed_wing"),
    ("ardupilot", "multirotor"),
    ("ardupilot", "vtol"),
    ("px4", "fixed_wing"),
    ("px4", "multirotor"),
    ("px4", "vtol"),
]
A, W, R, L = (
    Command.DO_SET_ACTUATOR,
    Command.NAV_WAYPOINT,
    Command.DO_SET_RELAY,
    Command.NAV_LOITER_TO_ALT,
)


def commands(mission: Mission) -> list[int]:
    return [int(item.command) for item in mission.mission]


def local(item: MissionItem) -> tuple[float, float]:
    east_m, north_m = FRAME.to_local((item.y / 1e7, item.x / 1e7))
    return float(east_m), float(north_m)


def flight(mission: Mission) -> list[MissionItem]:
    """The waypoints that follow the path: at the path's frame, between the speed and the way down."""
    items = list(mission.mission)
    first = commands(mission).index(Command.DO_CHANGE_SPEED) + 1
    ends = {Command.NAV_RETURN_TO_LAUNCH, Command.NAV_LAND, Command.DO_LAND_START, L, Command.NAV_VTOL_LAND}
    last = next(index for index in range(first, len(items)) if items[index].command in ends)
    return items[first:last]


def path_line(legs: tuple[Leg, ...], start: Pose = START) -> LineString:
    """The exact line, points a metre apart."""
    return LineString(flown(legs, start).sample(0.5, 5.0)[:, :2])


def test_the_order_of_flight_on_ardupilot() -> None:
    """Home row, take-off, climb, speed, path with triggers at the collects, return."""
    legs = (Leg(length_m=1500.0, collect_m=(500.0, 1200.0)), Leg(length_m=300.0))
    mission = encode(make_plan(legs, ends_at_home=True))
    assert commands(mission) == [
        W,
        Command.NAV_TAKEOFF,
        L,
        Command.DO_CHANGE_SPEED,
        W,
        W,
        R,
        W,
        R,
        W,
        W,
        Command.NAV_RETURN_TO_LAUNCH,
    ]
    assert [item.seq for item in mission.mission] == list(range(12))
    home, takeoff, climb, speed = mission.mission[:4]
    assert (home.frame, home.x, home.y) == (Frame.GLOBAL, degrees_e7(33.49), degrees_e7(-117.75))
    assert (takeoff.z, climb.z) == (50.0, 300.0)
    assert (speed.param1, speed.param2) == (0.0, 20.0)
    assert home.current
    assert not takeoff.current


def test_the_order_of_flight_on_px4() -> None:
    """No home row; the take-off is item 0 and current; the end is a landing behind DO_LAND_START."""
    mission = encode(make_plan((Leg(length_m=1500.0),), autopilot="px4"))
    assert commands(mission) == [
        Command.NAV_TAKEOFF,
        L,
        Command.DO_CHANGE_SPEED,
        W,
        W,
        Command.DO_LAND_START,
        L,
        W,
        Command.NAV_LAND,
    ]
    assert mission.mission[0].current


def test_a_multirotor_climbs_on_the_spot() -> None:
    """Take-off goes to the plan's altitude over home, and no circle is flown."""
    mission = encode(make_plan(vehicle_type="multirotor"))
    takeoff = mission.mission[1]
    assert (takeoff.command, takeoff.z) == (Command.NAV_TAKEOFF, 300.0)
    assert (takeoff.x, takeoff.y) == (mission.mission[0].x, mission.mission[0].y)
    assert L not in commands(mission)
    assert mission.mission[2].param1 == 1.0, "a multirotor is told its ground speed"


@pytest.mark.parametrize(("autopilot", "kind"), KINDS)
def test_triggers_bracket_each_collect(autopilot: Autopilot, kind: VehicleType) -> None:
    """On stands right behind the waypoint at the start of a collect, off right behind that at its end."""
    plan = make_plan(autopilot=autopilot, vehicle_type=kind)
    items = list(encode(plan, options=EncodeOptions(off_delay_m=0.0)).mission)
    switch = Command.DO_SET_RELAY if autopilot == "ardupilot" else Command.DO_SET_ACTUATOR
    switches = [index for index, item in enumerate(items) if item.command == switch]
    ends = [place for collect in plan.collects_of("uav-1") for place in collect.line]
    assert len(switches) == len(ends) == 4
    states = []
    for index, (lon_deg, lat_deg, altitude_m) in zip(switches, ends, strict=True):
        before = items[index - 1]
        assert before.command == W
        assert (before.x, before.y, before.z) == (degrees_e7(lat_deg), degrees_e7(lon_deg), altitude_m)
        states.append(items[index].param2 if switch == Command.DO_SET_RELAY else items[index].param1)
    assert states == ([1.0, 0.0, 1.0, 0.0] if autopilot == "ardupilot" else [1.0, -1.0, 1.0, -1.0])


def test_plane_flies_up_to_the_end_of_a_collect() -> None:
    """Waypoints where the sensor goes off count as reached at a metre, others where the vehicle says."""
    ends = [
        items[index - 1]
        for items in [flight(encode(make_plan()))]
        for index, item in enumerate(items)
        if item.command == R and item.param2 == 0.0
    ]
    assert [end.param2 for end in ends] == [1.0, 1.0]
    waypoints = [item for item in flight(encode(make_plan())) if item.command == W]
    assert sum(item.param2 for item in waypoints) == 2.0
    told = encode(make_plan(), options=EncodeOptions(acceptance_radius_m=30.0))
    assert {item.param2 for item in flight(told) if item.command == W} == {30.0}


def test_px4_passing_by_early_is_said() -> None:
    """PX4 ignores a waypoint's own radius: a note says what is lost, unless the sensor goes off late."""
    early = encode(make_plan(), autopilot="px4", options=EncodeOptions(off_delay_m=0.0))
    assert any("45 m early" in note for note in early.notes)
    for options in (EncodeOptions(), EncodeOptions(off_delay_m=60.0)):
        late = encode(make_plan(), autopilot="px4", options=options)
        assert not any("m early" in note for note in late.notes)


def test_on_px4_the_last_waypoint_of_a_collect_lies_where_the_turn_begins_early() -> None:
    """By default it lies as far past the collect's end as PX4 turns early, on the line."""
    early_m = 0.32 * 10.0 * 0.7 * 20.0
    legs = (
        Leg(length_m=1000.0, collect_m=(400.0, 1000.0)),
        Leg(turn_deg=90.0, radius_m=120.0),
        Leg(length_m=900.0, collect_m=(300.0, 600.0)),
    )
    plan = make_plan(legs)
    items = flight(encode(plan, autopilot="px4"))
    offs = [index for index, item in enumerate(items) if item.command == A and item.param1 == -1.0]
    assert len(offs) == 2
    for index, collect in zip(offs, plan.collects, strict=True):
        begin, end = (FRAME.to_local(place[:2]) for place in collect.line)
        last = local(items[index - 1])
        assert math.dist(last, end) == pytest.approx(early_m, abs=0.05)
        assert math.dist(last, begin) == pytest.approx(math.dist(end, begin) + early_m, abs=0.05)
        # Nothing that leads back stands behind it.
        assert math.dist(local(items[index + 1]), begin) > math.dist(last, begin)
    assert math.dist(local(items[offs[0] - 3]), FRAME.to_local(plan.collects[0].line[0][:2])) < 0.05


def test_no_waypoint_is_put_past_the_fence() -> None:
    """Where the overshoot would leave the area, the sensor goes off at the exact end."""
    legs = (
        Leg(length_m=1000.0, collect_m=(400.0, 1000.0)),
        Leg(turn_deg=90.0, radius_m=120.0),
        Leg(length_m=900.0),
    )
    plan = make_plan(legs)
    end = FRAME.to_local(plan.collects[0].line[1][:2])
    begin = FRAME.to_local(plan.collects[0].line[0][:2])
    angle_rad = math.atan2(end[1] - begin[1], end[0] - begin[0])
    tower = ZoneCircle(
        "tower", lonlat((end[0] + 60.0 * math.cos(angle_rad), end[1] + 60.0 * math.sin(angle_rad))), 30.0
    )
    fenced = replace(plan, fence=replace(square_fence(6000.0), exclusion_circles=(tower,)))
    items = flight(encode(fenced, autopilot="px4"))
    off = next(index for index, item in enumerate(items) if item.command == A and item.param1 == -1.0)
    assert math.dist(local(items[off - 1]), end) < 0.05


def test_collects_that_meet_share_a_waypoint() -> None:
    """Where one collect ends as the next begins, off stands before on."""
    legs = (Leg(length_m=1000.0, collect_m=(400.0, 1000.0)), Leg(length_m=1000.0, collect_m=(0.0, 500.0)))
    items = flight(encode(make_plan(legs)))
    assert [int(item.command) for item in items] == [W, W, R, W, R, R, W, R, W]
    assert [item.param2 for item in items if item.command == R] == [1.0, 0.0, 1.0, 0.0]


def test_overlapping_collects_keep_the_sensor_on() -> None:
    """The sensor goes off once, where the last of two overlapping collects ends."""
    plan = make_plan((Leg(length_m=1000.0, collect_m=(400.0, 800.0)),))
    first = plan.collects[0]
    middle = tuple((a + b) / 2.0 for a, b in zip(*first.line, strict=True))
    last = (*lonlat(flown((Leg(length_m=900.0),), START).end.position), 300.0)
    second = replace(first, seq=1, line=((middle[0], middle[1], 300.0), last), start_m=600.0, end_m=900.0)
    items = flight(encode(replace(plan, collects=(first, second))))
    assert [int(item.command) for item in items] == [W, W, R, W, W, W, R, W]


arcs = st.builds(
    Leg,
    turn_deg=st.floats(5.0, 350.0).flatmap(lambda a: st.sampled_from([a, -a])),
    radius_m=st.floats(60.0, 900.0),
)
straights = st.builds(Leg, length_m=st.floats(50.0, 3000.0))
leg_lists = st.lists(st.tuples(straights, arcs), min_size=1, max_size=4).map(
    lambda pairs: tuple(leg for pair in pairs for leg in pair)
)


@given(leg_lists, st.floats(0.3, 30.0))
@settings(max_examples=40, deadline=None)
def test_waypoints_keep_the_chord_error(legs: tuple[Leg, ...], chord_error_m: float) -> None:
    """The exact line is nowhere farther from the line between waypoints than stated, nor the other way."""
    options = EncodeOptions(chord_error_m=chord_error_m)
    mission = encode(make_plan(legs, vehicle_type="multirotor"), options=options)
    waypoints = LineString([local(item) for item in flight(mission)])
    exact = path_line(legs)
    # Hausdorff over vertices, both ways; waypoints are rounded to 1e-7 degrees, about a centimetre.
    away_m = max(waypoints.distance(Point(p)) for p in exact.coords)
    assert away_m <= chord_error_m + 0.02
    back_m = max(exact.distance(Point(p)) for p in waypoints.coords)
    assert back_m <= 0.03


@given(arcs)
@settings(max_examples=25, deadline=None)
def test_arcs_have_a_waypoint_every_45_degrees(leg: Leg) -> None:
    """However large the chord error, the waypoints of an arc are at most 45° apart."""
    options = EncodeOptions(chord_error_m=10_000.0)
    mission = encode(make_plan((Leg(length_m=500.0), leg), vehicle_type="multirotor"), options=options)
    points = MultiPoint([local(item) for item in flight(mission)])
    assert len(points.geoms) == 2 + math.ceil(abs(leg.turn_deg) / 45.0 - 1e-9)


def test_a_larger_chord_error_needs_fewer_waypoints() -> None:
    """Half a metre takes more items than five metres."""
    fine = encode(make_plan(), options=EncodeOptions(chord_error_m=0.5))
    coarse = encode(make_plan(), options=EncodeOptions(chord_error_m=5.0))
    assert len(fine.mission) > len(coarse.mission)


@pytest.mark.parametrize(("autopilot", "kind"), KINDS)
def test_items_survive_the_wire(autopilot: Autopilot, kind: VehicleType) -> None:
    """Packed and parsed by pymavlink, every field is what it was, in 32 bits."""
    link = wire.MAVLink(None, srcSystem=255, srcComponent=190)
    mission = encode(
        make_plan(autopilot=autopilot, vehicle_type=kind), options=EncodeOptions(rally_at_home=True)
    )
    for item in (*mission.mission, *mission.fence, *mission.rally):
        message = wire.MAVLink_mission_item_int_message(
            1,
            1,
            item.seq,
            item.frame,
            item.command,
            int(item.current),
            int(item.autocontinue),
            item.param1,
            item.param2,
            item.param3,
            item.param4,
            item.x,
            item.y,
            item.z,
            item.mission_type,
        )
        (parsed,) = wire.MAVLink(None).parse_buffer(message.pack(link))
        assert (parsed.seq, parsed.frame, parsed.command) == (item.seq, item.frame, item.command)
        assert (parsed.x, parsed.y, parsed.mission_type) == (item.x, item.y, item.mission_type)
        for name in ("param1", "param2", "param3", "param4", "z"):
            np.testing.assert_equal(getattr(parsed, name), float(np.float32(getattr(item, name))))


@pytest.mark.parametrize(("reference", "frame"), [("home", 3), ("terrain", 3), ("amsl", 0)])
def test_altitudes_count_from_what_the_plan_says(reference: str, frame: int) -> None:
    """Heights over home and over flat ground are relative to home, heights over the sea are global."""
    plan = replace(make_plan(), altitude_reference=reference)
    mission = encode(plan, options=EncodeOptions(home_altitude_m=120.0))
    assert {item.frame for item in flight(mission) if item.command == W} == {frame}
    assert {item.z for item in flight(mission) if item.command == W} == {300.0}
    assert mission.mission[1].frame == 3, "the take-off climbs over home"
    assert mission.mission[0].z == 120.0


def test_altitudes_may_change_along_the_path() -> None:
    """Waypoints take the altitude of the line where they stand."""
    plan = make_plan((Leg(length_m=1000.0), Leg(length_m=1000.0)))
    (path,) = plan.paths
    line = tuple((lon, lat, 300.0 + 50.0 * n) for n, (lon, lat, _) in enumerate(path.line))
    items = flight(encode(replace(plan, paths=(replace(path, line=line),))))
    assert [item.z for item in items] == pytest.approx([300.0, 350.0, 400.0], abs=0.02)


def room_of(plan: Plan) -> Polygon:
    return Polygon(FRAME.to_local(plan.fence.inclusion[0].ring))


@given(
    east_m=st.floats(-4000.0, 4000.0),
    north_m=st.floats(-4000.0, 4000.0),
    angle_rad=st.floats(-3.1, 3.1),
    autopilot=st.sampled_from(["ardupilot", "px4"]),
    kind=st.sampled_from(["fixed_wing", "multirotor", "vtol"]),
    altitude_m=st.floats(15.0, 2000.0),
    radius_m=st.floats(20.0, 250.0),
)
@settings(max_examples=60, deadline=None)
def test_any_plan_makes_a_mission_that_the_autopilot_takes(
    east_m: float,
    north_m: float,
    angle_rad: float,
    autopilot: Autopilot,
    kind: VehicleType,
    altitude_m: float,
    radius_m: float,
) -> None:
    """Nothing in mission, fence and rally breaks a rule of the dialect, and the circles keep to the area."""
    plan = make_plan(
        LEGS,
        autopilot=autopilot,
        vehicle_type=kind,
        start=Pose(east_m, north_m, angle_rad),
        altitude_m=altitude_m,
        min_turn_radius_m=radius_m,
    )
    mission = encode(plan, options=EncodeOptions(rally_at_home=True))
    for items in (mission.mission, mission.fence, mission.rally):
        assert mission.dialect.check(items) == ()
    assert not [note for note in mission.notes if "outside" in note]
    room = room_of(plan)
    for item in mission.mission:
        if item.command == L:
            turn = Point(local(item)).buffer(abs(item.param2))
            assert abs(item.param2) >= radius_m
            assert room.contains(turn)
        elif item.command == W and item.seq > 0 and item not in flight(mission):
            assert room.contains(Point(local(item)))


@given(angle_rad=st.floats(-3.1, 3.1), radius_m=st.floats(20.0, 300.0), altitude_m=st.floats(15.0, 900.0))
@settings(max_examples=40, deadline=None)
def test_px4_fixed_wings_get_what_the_feasibility_check_wants(
    angle_rad: float, radius_m: float, altitude_m: float
) -> None:
    """Written out from PX4's rules: take-off first and above home, approach above and outside, at most 5°."""
    plan = make_plan(
        autopilot="px4", start=Pose(0.0, 0.0, angle_rad), altitude_m=altitude_m, min_turn_radius_m=radius_m
    )
    items = encode(plan).mission
    with_place = [item for item in items if item.frame != Frame.MISSION]
    assert with_place[0] is items[0]
    assert items[0].command == Command.NAV_TAKEOFF
    assert items[0].z > 11.0
    assert [item.command for item in items].count(Command.DO_LAND_START) == 1
    assert commands_after(items, Command.DO_LAND_START) == [L, W, Command.NAV_LAND]
    assert Command.NAV_RETURN_TO_LAUNCH not in [item.command for item in items]
    orbit, approach, land = items[-3:]
    run_m = math.dist(local(approach), local(land))
    assert approach.z > land.z
    assert math.degrees(math.atan2(approach.z - land.z, run_m)) <= 5.0
    assert math.dist(local(orbit), local(land)) > abs(orbit.param2)
    assert all(item.frame in (0, 3) or item.frame == 2 for item in items)


def commands_after(items: tuple[MissionItem, ...], command: int) -> list[int]:
    numbers = [int(item.command) for item in items]
    return numbers[numbers.index(command) + 1 :]


def test_the_climb_circle_touches_the_first_line() -> None:
    """The circle is left a radius before the start, in the direction of the path."""
    mission = encode(make_plan(start=Pose(0.0, 0.0, 0.4)))
    climb = mission.mission[2]
    radius_m = abs(climb.param2)
    east_m, north_m = local(climb)
    ahead_m = east_m * math.cos(0.4) + north_m * math.sin(0.4)
    left_m = -east_m * math.sin(0.4) + north_m * math.cos(0.4)
    assert ahead_m == pytest.approx(-radius_m, abs=0.05)
    assert abs(left_m) == pytest.approx(radius_m, abs=0.05)
    # Positive is clockwise in MAVLink: the centre is to the right then.
    assert math.copysign(1.0, climb.param2) == -math.copysign(1.0, left_m)


def test_the_climb_moves_along_the_path_where_the_start_has_no_room() -> None:
    """From a corner of the area the circle lies further along the first straight, past its start."""
    plan = make_plan(start=Pose(-5990.0, -5990.0, math.pi / 4.0))
    mission = encode(plan)
    climb, first = mission.mission[2], flight(mission)[0]
    assert room_of(plan).contains(Point(local(climb)).buffer(abs(climb.param2)))
    assert math.dist(local(first), (-5990.0, -5990.0)) > 400.0
    assert any("joined" in note for note in mission.notes)
    assert mission.mission[5].command == R, "the first collect is untouched"


def test_no_room_at_all_is_said() -> None:
    """In an area smaller than its turns the circles leave the fence, and a note says so."""
    plan = make_plan((Leg(length_m=100.0),), fence=square_fence(120.0))
    notes = " ".join(encode(plan).notes)
    assert "climb circle leaves the fence" in notes


def test_an_end_near_home_is_left_to_the_return() -> None:
    """ArduPilot returns when the path ends near home and lands where it ends far away."""
    near = encode(make_plan(ends_at_home=True))
    far = encode(make_plan())
    assert commands(near)[-1] == Command.NAV_RETURN_TO_LAUNCH
    assert commands(far)[-3:] == [L, W, Command.NAV_LAND]
    assert Command.DO_LAND_START not in commands(far)
    assert commands(encode(make_plan(ends_at_home=True), options=EncodeOptions(finish="loiter")))[-1] == 17


@pytest.mark.parametrize("autopilot", ["ardupilot", "px4"])
@pytest.mark.parametrize("airspeed_m_s", [15.0, 25.0, 35.0])
def test_a_vtol_has_room_to_stop_before_it_lands(autopilot: Autopilot, airspeed_m_s: float) -> None:
    """It circles down and comes in low, from farther than ArduPlane arms with: 0.75 v² / (2 · 2 m/s²)."""
    plan = make_plan(autopilot=autopilot, vehicle_type="vtol")
    fast = replace(plan.vehicles[0], airspeed_m_s=airspeed_m_s)
    mission = encode(replace(plan, vehicles=(fast,)))
    down, approach, land = mission.mission[-3:]
    assert (mission.mission[-4].command == Command.DO_LAND_START) == (autopilot == "px4")
    assert [i.command for i in (down, approach, land)] == [L, W, Command.NAV_VTOL_LAND]
    assert down.z == approach.z == 40.0
    assert math.dist(local(approach), local(land)) > 0.75 * airspeed_m_s**2 / 4.0 + 1.0
    assert math.dist(local(land), FRAME.to_local(plan.end)) < 0.05


@pytest.mark.parametrize(("kind", "words"), [("fixed_wing", "circles over home"), ("vtol", "Q_RTL_MODE")])
def test_a_return_that_does_not_land_is_said(kind: VehicleType, words: str) -> None:
    """ArduPlane's return ends in circles over home: the notes say who lands, and what else there is."""
    (note,) = [
        n for n in encode(make_plan(ends_at_home=True, vehicle_type=kind)).notes if n.startswith("the return")
    ]
    assert words in note
    assert "left to the pilot" in note
    assert "finish 'land'" in note
    copter = encode(make_plan(ends_at_home=True, vehicle_type="multirotor"))
    assert not [n for n in copter.notes if n.startswith("the return")]


@pytest.mark.parametrize("finish", ["rtl", "loiter"])
def test_px4_fixed_wings_are_not_sent_without_a_landing(finish: str) -> None:
    """RTL and circling at the end are refused before PX4 declares the mission invalid."""
    options = EncodeOptions(finish=finish)
    with pytest.raises(EncodeError, match="MIS_TKO_LAND_REQ"):
        encode(make_plan(autopilot="px4"), options=options)
    assert encode(make_plan(autopilot="px4", vehicle_type="multirotor"), options=options).mission


@pytest.mark.parametrize(
    ("payload", "on", "off"),
    [
        (ServoPayload(9, 1900, 1100), (183, 9.0, 1900.0), (183, 9.0, 1100.0)),
        (CameraPayload(25.0), (206, 25.0, 0.0), (206, 0.0, 0.0)),
        (ImagePayload(2.0), (2000, 0.0, 2.0), (2001, 0.0, 0.0)),
        (
            CommandPayload(181, (3.0, 1.0, 0, 0, 0, 0, 0), 181, (3.0, 0.0, 0, 0, 0, 0, 0)),
            (181, 3.0, 1.0),
            (181, 3.0, 0.0),
        ),
    ],
)
def test_payloads_become_items(payload: object, on: tuple[float, ...], off: tuple[float, ...]) -> None:
    """Servo, shutter, camera protocol and a command of one's own are switched by their items."""
    mission = encode(make_plan(), options=EncodeOptions(payload=payload))
    switches = [(i.command, i.param1, i.param2) for i in flight(mission) if i.command != W]
    assert switches == [on, off, on, off]


def test_a_command_of_ones_own_firmware_is_sent_with_a_note() -> None:
    """Nothing is known of it, so the vehicle's answer decides."""
    own = CommandPayload(31010, (1, 0, 0, 0, 0, 0, 0), 31010, (0, 0, 0, 0, 0, 0, 0))
    for autopilot in ("ardupilot", "px4"):
        mission = encode(make_plan(), autopilot=autopilot, options=EncodeOptions(payload=own))
        assert any("31010" in note for note in mission.notes)
        assert {f.severity for f in mission.dialect.check(mission.mission)} == {"warning"}


def test_px4_is_given_an_actuator_for_a_relay_and_told_so() -> None:
    """PX4 refuses relays: relay 2 becomes actuator 3, the others unchanged, with a note."""
    mission = encode(make_plan(), autopilot="px4", options=EncodeOptions(payload=RelayPayload(2)))
    on = next(item for item in flight(mission) if item.command == Command.DO_SET_ACTUATOR)
    assert (on.frame, on.param3) == (Frame.MISSION, 1.0)
    assert math.isnan(on.param1)
    assert math.isnan(on.param4)
    assert any("actuator 3" in note for note in mission.notes)


@pytest.mark.parametrize(
    ("autopilot", "payload"), [("px4", ServoPayload(9)), ("ardupilot", ActuatorPayload(1))]
)
def test_payloads_that_the_autopilot_refuses_are_refused_here(autopilot: Autopilot, payload: object) -> None:
    """A servo on PX4 and a PX4 actuator on ArduPilot draw UNSUPPORTED before anything is sent."""
    with pytest.raises(EncodeError, match="UNSUPPORTED"):
        encode(make_plan(), autopilot=autopilot, options=EncodeOptions(payload=payload))


def test_the_sensor_may_go_off_late() -> None:
    """With a delay it stays on past the exact end, as far as the straight goes on."""
    late = encode(make_plan(), options=EncodeOptions(off_delay_m=80.0, payload=CameraPayload(25.0)))
    plan = make_plan()
    items = flight(late)
    off = [index for index, item in enumerate(items) if item.command == 206 and item.param1 == 0.0]
    end = local(items[off[0] - 1])
    exact = items[off[0] - 2]
    assert (exact.x, exact.y) == (
        degrees_e7(plan.collects[0].line[1][1]),
        degrees_e7(plan.collects[0].line[1][0]),
    )
    assert math.dist(end, local(exact)) == pytest.approx(80.0, abs=0.05)


def test_fence_says_area_and_zones() -> None:
    """Area, polygons and circles become items; a zone flown under is left out with a note."""
    zone = ZonePolygon("keep out", tuple(lonlat(p) for p in ((3000, -900), (3300, -900), (3300, -600))))
    under = ZoneCircle("airway", lonlat((700.0, 300.0)), 400.0, floor_m=900.0)
    tower = ZoneCircle("tower", lonlat((-3000.0, 3000.0)), 150.0)
    fence = Fence(square_fence(6000.0).inclusion, (zone,), (under, tower))
    mission = encode(make_plan(fence=fence))
    assert [(i.command, i.param1, i.frame) for i in mission.fence] == [
        *[(5001, 4.0, 0)] * 4,
        *[(5002, 3.0, 0)] * 3,
        (5004, 150.0, 0),
    ]
    assert [i.seq for i in mission.fence] == list(range(8))
    assert any("airway" in note for note in mission.notes)
    assert not any("tower" in note for note in mission.notes)


def test_a_closed_ring_is_one_corner_less() -> None:
    """A fence ring whose last corner repeats the first is not sent with it."""
    area = square_fence(6000.0).inclusion[0]
    closed = Fence(inclusion=(replace(area, ring=(*area.ring, area.ring[0])),))
    assert encode(make_plan(fence=closed)).fence == encode(make_plan()).fence
    with pytest.raises(EncodeError, match="2 corners"):
        encode(
            make_plan(fence=Fence(inclusion=(replace(area, ring=area.ring[:2]),)), vehicle_type="multirotor")
        )


def test_a_nan_radius_is_never_encoded() -> None:
    """It would crash an autopilot."""
    bad = Fence(exclusion_circles=(ZoneCircle("bad", lonlat((9000.0, 0.0)), math.nan),))
    with pytest.raises(EncodeError, match="bad"):
        encode(make_plan(fence=bad, vehicle_type="multirotor"))


def test_vehicles_are_told_apart() -> None:
    """With two vehicles one must be named, and an unknown name is refused with those there are."""
    plan = make_plan()
    second = replace(plan.vehicles[0], name="uav-2")
    both = replace(
        plan, vehicles=(*plan.vehicles, second), paths=(*plan.paths, replace(plan.paths[0], vehicle="uav-2"))
    )
    with pytest.raises(EncodeError, match="uav-1, uav-2"):
        encode(both)
    with pytest.raises(EncodeError, match="uav-3"):
        encode(both, "uav-3")
    alone = encode(both, "uav-2")
    assert alone.vehicle == "uav-2"
    assert R not in commands(alone), "the collects are the other vehicle's"


@pytest.mark.parametrize(
    "change",
    [
        {"chord_error_m": 0.0},
        {"chord_error_m": math.nan},
        {"acceptance_radius_m": 300.0},
        {"approach_slope_deg": -3.0},
        {"off_delay_m": math.inf},
    ],
)
def test_senseless_options_are_refused(change: dict[str, float]) -> None:
    """Options that no mission can be made from name themselves."""
    with pytest.raises(EncodeError, match=next(iter(change))):
        EncodeOptions(**change)


def test_a_plan_below_home_is_refused() -> None:
    """An altitude over the sea that lies under home cannot be flown."""
    plan = make_plan(altitude_m=100.0, altitude_reference="amsl")
    with pytest.raises(EncodeError, match="over home"):
        encode(plan, options=EncodeOptions(home_altitude_m=120.0))
