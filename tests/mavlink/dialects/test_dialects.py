"""The tables against what was measured on simulators."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavlink.dialects import Dialect, DialectFinding, dialect_for
from mavlink.dialects.base import fence_shapes
from mavlink.dialects.mission import home_item, numbered, placed, unplaced
from mavlink.wire.items import Command, Frame, MissionItem, MissionResult, MissionType
from tests.mavlink.strategies import numbers, placed_items, placeless_items, same

PLANE = dialect_for("ardupilot", "fixed_wing")
COPTER = dialect_for("ardupilot", "multirotor")
PX4_WING = dialect_for("px4", "fixed_wing")
PX4_ROTOR = dialect_for("px4", "multirotor")
ALL = (PLANE, COPTER, PX4_WING, PX4_ROTOR)
HERE = (8.5, 47.4)
NAN = math.nan


def item(
    command: int, *params: float, frame: int = Frame.GLOBAL_RELATIVE_ALT, z: float = 100.0
) -> MissionItem:
    p1, p2, p3, p4 = (*params, 0.0, 0.0, 0.0, 0.0)[:4]
    return replace(placed(command, HERE, z, frame, (p1, p2, p3, p4)), seq=1, z=z)


def order(command: int, *params: float, frame: int = Frame.MISSION) -> MissionItem:
    p1, p2, p3, p4 = (*params, 0.0, 0.0, 0.0, 0.0)[:4]
    return replace(unplaced(command, (p1, p2, p3, p4)), seq=1, frame=frame)


def back(dialect: Dialect, one: MissionItem) -> MissionItem:
    (held,) = dialect.expected_readback((one,))
    return held


def rules(dialect: Dialect, *items: MissionItem, kind: MissionType = MissionType.MISSION) -> set[str]:
    return {finding.rule for finding in dialect.check(numbered(list(items), kind))}


@pytest.mark.parametrize(
    ("command", "sent", "held"),
    [
        (Command.NAV_WAYPOINT, (5.0, 30.7, 300.0, 90.0), (0.0, 30.0, 255.0, 0.0)),
        (Command.NAV_TAKEOFF, (15.9, 0.0, 0.0, 90.0), (15.0, 0.0, 0.0, 0.0)),
        (Command.NAV_LOITER_TURNS, (0.5, 0.0, -100.5, 1.0), (0.5, 0.0, -100.0, 1.0)),
        (Command.NAV_LOITER_TURNS, (2.7, 0.0, 1234.0, 0.0), (2.0, 0.0, 1230.0, 0.0)),
        (Command.NAV_LOITER_TURNS, (400.0, 0.0, 9999.0, 0.0), (255.0, 0.0, 2550.0, 0.0)),
        (Command.NAV_LOITER_TIME, (12.9, 0.0, -80.0, 0.0), (12.0, 0.0, -1.0, 0.0)),
        (Command.NAV_LOITER_TIME, (12.0, 0.0, 0.0, 0.0), (12.0, 0.0, 1.0, 0.0)),
        (Command.NAV_LOITER_TO_ALT, (0.0, -105.9, 0.0, 1.0), (0.0, -105.0, 0.0, 1.0)),
        (Command.NAV_LOITER_UNLIM, (0.0, 0.0, 99.9, 0.0), (0.0, 0.0, 99.0, 0.0)),
        (Command.NAV_LAND, (30.4, 0.0, 0.0, NAN), (30.0, 0.0, 0.0, 1.0)),
        (Command.NAV_LAND, (0.0, 0.0, 0.0, -90.0), (0.0, 0.0, 0.0, -1.0)),
    ],
)
def test_plane_alters_parameters_as_measured(
    command: int, sent: tuple[float, ...], held: tuple[float, ...]
) -> None:
    """Plane keeps whole and limited numbers of the commands that name a place."""
    got = back(PLANE, item(command, *sent))
    assert (got.param1, got.param2, got.param3, got.param4) == held


@pytest.mark.parametrize(
    ("command", "sent", "held"),
    [
        (Command.DO_CHANGE_SPEED, (0.0, 22.5, -1.0, 7.0), (0.0, 22.5, -1.0, 0.0)),
        (Command.DO_SET_SERVO, (9.0, 1900.5), (9.0, 1900.0, 0.0, 0.0)),
        (Command.DO_SET_RELAY, (1.0, 1.0), (1.0, 1.0, 0.0, 0.0)),
        (Command.DO_SET_CAM_TRIGG_DIST, (25.5, 3.0, 1.0), (25.5, 0.0, 1.0, 0.0)),
    ],
)
def test_ardupilot_keeps_orders_without_a_place(
    command: int, sent: tuple[float, ...], held: tuple[float, ...]
) -> None:
    """Orders come back in frame 0, at no place, with the parameters that are stored."""
    got = back(PLANE, order(command, *sent))
    assert (got.param1, got.param2, got.param3, got.param4) == held
    assert (got.frame, got.x, got.y, got.z) == (Frame.GLOBAL, 0, 0, 0.0)


@pytest.mark.parametrize(("sent", "held"), [(0, 0), (2, 0), (5, 0), (3, 3), (6, 3), (10, 10), (11, 10)])
def test_ardupilot_maps_frames(sent: int, held: int) -> None:
    """Integer frames come back as their old names, MISSION as GLOBAL."""
    assert back(PLANE, item(Command.NAV_WAYPOINT, frame=sent)).frame == held


@pytest.mark.parametrize("frame", [1, 4, 8])
def test_ardupilot_refuses_local_frames(frame: int) -> None:
    """Waypoints in local frames are refused."""
    assert PLANE.answer(item(Command.NAV_WAYPOINT, frame=frame)) == MissionResult.UNSUPPORTED_FRAME


@pytest.mark.parametrize("command", [195, 197, 214, 2003, 187])
def test_ardupilot_refuses_commands(command: int) -> None:
    """ROI by location, ROI none, trigger by interval and trigger control are unknown."""
    assert PLANE.answer(order(command)) == MissionResult.UNSUPPORTED
    assert "unsupported-command" in rules(PLANE, home_item(HERE, 0.0), order(command))


def test_copter_alone_flies_splines() -> None:
    """Spline waypoints are refused by Plane and taken by Copter."""
    assert PLANE.answer(item(Command.NAV_SPLINE_WAYPOINT)) == MissionResult.UNSUPPORTED
    assert COPTER.answer(item(Command.NAV_SPLINE_WAYPOINT)) == MissionResult.ACCEPTED


@pytest.mark.parametrize(
    ("one", "result"),
    [
        (item(Command.NAV_WAYPOINT, 0.0, 0.0, 0.0, NAN), MissionResult.ACCEPTED),
        (item(Command.NAV_WAYPOINT, NAN), MissionResult.INVALID_PARAM1),
        (item(Command.NAV_VTOL_LAND, 0.0, 0.0, NAN, NAN), MissionResult.ACCEPTED),
        (item(Command.NAV_LOITER_TO_ALT, 0.0, 0.0, 0.0, NAN), MissionResult.INVALID_PARAM4),
        (order(Command.IMAGE_START_CAPTURE, 0.0, NAN), MissionResult.INVALID_PARAM2),
        (order(Command.DO_GIMBAL_MANAGER_PITCHYAW, 0.0, 0.0, NAN), MissionResult.INVALID_PARAM3),
    ],
)
def test_ardupilot_takes_nan_in_few_places(one: MissionItem, result: MissionResult) -> None:
    """NaN is taken in the yaw of a few commands and refused elsewhere, by the parameter's number."""
    assert PLANE.answer(one) == result


def test_ardupilot_truncates_altitudes_to_centimetres() -> None:
    """Centimetres that binary numbers miss by a hair are not lost."""
    assert back(PLANE, item(Command.NAV_WAYPOINT, z=0.29)).z == pytest.approx(0.29)
    assert back(PLANE, item(Command.NAV_WAYPOINT, z=123.459)).z == pytest.approx(123.45)
    assert back(PLANE, item(Command.NAV_WAYPOINT, z=-1.239)).z == pytest.approx(-1.23)


def test_ardupilot_leaves_the_home_row_out() -> None:
    """Item 0 is home: it is not among what comes back."""
    items = numbered([home_item(HERE, 0.0), item(Command.NAV_WAYPOINT)])
    assert [held.seq for held in PLANE.expected_readback(items)] == [1]


def test_ardupilot_wants_a_home_row() -> None:
    """A take-off at item 0 would be dropped."""
    assert rules(PLANE, item(Command.NAV_TAKEOFF), item(Command.NAV_WAYPOINT)) == {"home-row-missing"}


@pytest.mark.parametrize(
    ("dialect", "limit"), [(PLANE, 655), (COPTER, 650), (PX4_WING, 500), (PX4_ROTOR, 500)]
)
def test_missions_have_a_largest_size(dialect: Dialect, limit: int) -> None:
    """One item more than the vehicle holds is found, the limit itself is not."""
    waypoints = [item(Command.NAV_WAYPOINT)] * limit
    first = [home_item(HERE, 0.0)] if dialect.home_row else []
    assert "too-many-items" not in rules(dialect, *[*first, *waypoints][:limit])
    assert "too-many-items" in rules(dialect, *first, *waypoints, *waypoints[:1])


def test_what_is_too_much_is_told_with_number_limit_and_fix() -> None:
    """Two missions and a bit are told as three sorties; fences and rally lists by the surplus."""

    def told(
        dialect: Dialect, *items: MissionItem, kind: MissionType = MissionType.MISSION
    ) -> DialectFinding:
        found = dialect.check(numbered(items, kind))
        return next(finding for finding in found if finding.rule == "too-many-items")

    finding = told(PLANE, home_item(HERE, 0.0), *[item(Command.NAV_WAYPOINT)] * 1399)
    assert finding.message == "1400 items, the vehicle holds 655"
    assert finding.fix is not None
    assert "at least 3 sorties" in finding.fix
    corners = [replace(placed(5001, HERE, 0.0, Frame.GLOBAL), param1=70.0)] * 70
    assert "6 corners less" in str(told(PX4_WING, *corners, kind=MissionType.FENCE).fix)
    points = [placed(5100, HERE, 80.0, Frame.GLOBAL_RELATIVE_ALT)] * 35
    assert "leave out 3 rally points" in str(told(PX4_WING, *points, kind=MissionType.RALLY).fix)


@pytest.mark.parametrize(("dialect", "bad"), [(PLANE, 0.0), (PLANE, 2.0), (PX4_ROTOR, 2.0), (PX4_ROTOR, NAN)])
def test_jumps_must_lead_somewhere(dialect: Dialect, bad: float) -> None:
    """Jumps to 0 on ArduPilot, past the end or nowhere are found."""
    first = home_item(HERE, 0.0) if dialect.home_row else item(Command.NAV_TAKEOFF)
    assert "jump-target" in rules(dialect, first, order(Command.DO_JUMP, bad))
    assert "jump-target" not in rules(dialect, first, order(Command.DO_JUMP, 1.0))


@pytest.mark.parametrize("dialect", ALL)
def test_places_that_nobody_complains_about_are_found(dialect: Dialect) -> None:
    """Latitudes beyond the pole, and 0/0, are found for every autopilot."""
    first = home_item(HERE, 0.0) if dialect.home_row else item(Command.NAV_TAKEOFF)
    beyond = replace(item(Command.NAV_WAYPOINT), x=910_000_000)
    nowhere = replace(item(Command.NAV_WAYPOINT), x=0, y=0)
    assert "place-out-of-range" in rules(dialect, first, beyond)
    assert "place-zero" in rules(dialect, first, nowhere)


@pytest.mark.parametrize(("sent", "held"), [(0, 5), (3, 6), (5, 5), (6, 6)])
def test_px4_answers_in_integer_frames(sent: int, held: int) -> None:
    """Frames come back under their integer names."""
    assert back(PX4_WING, item(Command.NAV_WAYPOINT, frame=sent)).frame == held


@pytest.mark.parametrize("frame", [1, 10, 11])
def test_px4_refuses_terrain_and_local_frames(frame: int) -> None:
    """Heights over terrain and local places draw UNSUPPORTED_FRAME."""
    assert PX4_WING.answer(item(Command.NAV_WAYPOINT, frame=frame)) == MissionResult.UNSUPPORTED_FRAME


@pytest.mark.parametrize("command", [18, 183, 181, 82, 115, 207, 600, 208, 531])
def test_px4_refuses_commands(command: int) -> None:
    """Turns, servo, relay, spline and others are unknown, whatever the frame."""
    assert PX4_WING.answer(order(command)) == MissionResult.UNSUPPORTED
    assert PX4_WING.answer(item(command)) == MissionResult.UNSUPPORTED


@pytest.mark.parametrize("command", [93, 20, 178, 189, 206, 214, 2003, 2000, 2001, 187, 197, 205, 1000])
def test_px4_takes_orders_in_the_mission_frame_only(command: int) -> None:
    """Items without a place are taken in frame 2 and refused in a global frame."""
    assert PX4_WING.answer(order(command)) == MissionResult.ACCEPTED
    assert PX4_WING.answer(item(command)) == MissionResult.UNSUPPORTED


@pytest.mark.parametrize("command", [112, 114])
def test_px4_accepts_conditions_and_then_has_no_valid_mission(command: int) -> None:
    """CONDITION_DELAY and CONDITION_DISTANCE are accepted, and the mission is invalid."""
    assert PX4_ROTOR.answer(order(command)) == MissionResult.ACCEPTED
    assert "invalidates-mission" in rules(PX4_ROTOR, item(Command.NAV_TAKEOFF), order(command))


@pytest.mark.parametrize("dialect", ALL)
def test_commands_in_no_table_are_let_through_with_a_warning(dialect: Dialect) -> None:
    """A command of somebody's own firmware is for the vehicle to refuse."""
    own = order(31010, 1.0)
    first = home_item(HERE, 0.0) if dialect.home_row else item(Command.NAV_TAKEOFF)
    assert dialect.answer(own) == MissionResult.ACCEPTED
    found = [finding for finding in dialect.check(numbered([first, own])) if finding.seq == 1]
    assert [(finding.rule, finding.severity) for finding in found] == [("unlisted-command", "warning")]


def test_px4_alters_parameters_as_measured() -> None:
    """Yaw is brought to 0..360, NaN is kept, unused parameters become 0, ROI gets its new number."""
    waypoint = back(PX4_WING, item(Command.NAV_WAYPOINT, 1.0, 2.0, 3.0, -90.0))
    assert (waypoint.param1, waypoint.param2, waypoint.param3, waypoint.param4) == (1.0, 2.0, 0.0, 270.0)
    assert math.isnan(back(PX4_WING, item(Command.NAV_TAKEOFF, 15.0, 0.0, 0.0, NAN)).param4)
    assert back(PX4_WING, item(Command.NAV_TAKEOFF, 15.0)).param1 == 0.0
    assert back(PX4_WING, item(Command.NAV_LAND, 15.0)).param1 == 0.0
    assert back(PX4_WING, item(Command.NAV_ROI, 3.0)).command == Command.DO_SET_ROI
    assert back(PX4_WING, order(Command.DO_JUMP, 0.0, -1.0)).param2 == 65535.0


def good_px4_mission() -> list[MissionItem]:
    land = placed(Command.NAV_LAND, HERE, 0.0, Frame.GLOBAL_RELATIVE_ALT)
    approach = replace(land, command=Command.NAV_WAYPOINT, x=land.x + 50_000, z=40.0)
    return [
        item(Command.NAV_TAKEOFF),
        order(Command.DO_CHANGE_SPEED, 0.0, 20.0, -1.0),
        item(Command.NAV_WAYPOINT),
        order(Command.DO_LAND_START),
        approach,
        land,
    ]


def test_px4_fixed_wing_takes_a_whole_mission() -> None:
    """Take-off, speed, waypoint, land start, a gentle approach and a landing are fine."""
    assert rules(PX4_WING, *good_px4_mission()) == set()


def test_px4_fixed_wing_must_land() -> None:
    """Without a landing the mission is infeasible, and RTL is none; a multirotor may."""
    mission = [*good_px4_mission()[:3], order(Command.NAV_RETURN_TO_LAUNCH)]
    assert rules(PX4_WING, *mission) == {"landing-missing"}
    assert rules(PX4_ROTOR, *mission) == set()


@pytest.mark.parametrize(
    ("first", "found"),
    [
        (order(Command.DO_CHANGE_SPEED, 0.0, 20.0), False),
        (order(Command.DO_SET_CAM_TRIGG_DIST, 25.0), False),
        (order(Command.DO_SET_ACTUATOR, 1.0), True),
        (home_item(HERE, 0.0), True),
    ],
)
def test_px4_takes_off_first(first: MissionItem, found: bool) -> None:
    """Speed and trigger may stand before the take-off; an actuator or a home row may not."""
    assert ("takeoff-not-first" in rules(PX4_WING, first, *good_px4_mission())) == found


@pytest.mark.parametrize(
    ("change", "rule"),
    [
        ({"z": 60.0}, "approach-too-steep"),
        ({"z": -1.0}, "approach-below-land"),
        ({"command": int(Command.NAV_LOITER_TO_ALT), "param2": -600.0}, "approach-inside-orbit"),
        ({"command": int(Command.NAV_LOITER_TO_ALT), "param2": 500.0}, "approach-too-steep"),
        ({"command": int(Command.NAV_LOITER_TIME)}, "approach-kind"),
        ({"frame": int(Frame.GLOBAL)}, "approach-datum"),
    ],
)
def test_px4_looks_at_the_approach(change: dict[str, float], rule: str) -> None:
    """The approach is above the landing point, outside the orbit before it and no steeper than 5°."""
    mission = good_px4_mission()
    mission[4] = replace(mission[4], **change)
    assert rules(PX4_WING, *mission) == {rule}


def test_px4_takes_one_land_start_followed_by_a_landing() -> None:
    """Two land starts, one without a landing, and RTL behind one are found."""
    mission = good_px4_mission()
    start = order(Command.DO_LAND_START)
    assert "land-start-repeated" in rules(PX4_WING, start, *mission)
    assert "land-start-alone" in rules(PX4_WING, *mission[:3], *mission[4:], start)
    assert "rtl-after-land-start" in rules(PX4_WING, *mission, order(Command.NAV_RETURN_TO_LAUNCH))


def test_px4_wants_the_first_item_current() -> None:
    """Item 0 must carry the current flag."""
    items = numbered(good_px4_mission())
    assert PX4_WING.check(items) == ()
    unmarked = (replace(items[0], current=False), *items[1:])
    assert [finding.rule for finding in PX4_WING.check(unmarked)] == ["current-not-first"]
    twice = (*items[:2], replace(items[2], current=True), *items[3:])
    (finding,) = PX4_WING.check(twice)
    assert (finding.rule, finding.seq) == ("current-repeated", 2)


def test_ardupilot_warns_of_land_start() -> None:
    """DO_LAND_START is uploaded and may then forbid arming: a warning, no error."""
    items = numbered([home_item(HERE, 0.0), item(Command.NAV_WAYPOINT), order(Command.DO_LAND_START)])
    items = (items[0], items[1], replace(items[2], x=items[1].x, y=items[1].y))
    assert [(f.rule, f.severity) for f in PLANE.check(items)] == [("land-start-arming", "warning")]


@pytest.mark.parametrize("dialect", ALL)
def test_fences_are_looked_at(dialect: Dialect) -> None:
    """NaN radii, polygons of two and wrong vertex counts are found."""
    vertex = replace(placed(5001, HERE, 0.0, Frame.GLOBAL), param1=3.0)
    circle = replace(placed(5004, HERE, 0.0, Frame.GLOBAL), param1=100.0)
    fence = MissionType.FENCE
    assert rules(dialect, vertex, vertex, vertex, circle, kind=fence) == set()
    assert rules(dialect, vertex, vertex, circle, kind=fence) == {"fence-vertices"}
    two = replace(vertex, param1=2.0)
    assert rules(dialect, two, two, kind=fence) == {"fence-vertices"}
    assert rules(dialect, replace(circle, param1=NAN), kind=fence) == {"fence-radius"}
    assert rules(dialect, replace(circle, param1=0.0), kind=fence) == {"fence-radius"}


def test_fences_and_rally_points_come_back_in_their_frames() -> None:
    """PX4 gives fences back in frame 5, ArduPilot in frame 0; ArduPilot's rally heights are whole."""
    circle = numbered([replace(placed(5004, HERE, 0.0, Frame.GLOBAL), param1=100.5)], MissionType.FENCE)
    assert [(i.frame, i.param1) for i in PX4_WING.expected_readback(circle)] == [(5, 100.5)]
    assert [(i.frame, i.param1) for i in PLANE.expected_readback(circle)] == [(0, 100.5)]
    rally = numbered([placed(5100, HERE, 80.7, Frame.GLOBAL_RELATIVE_ALT)], MissionType.RALLY)
    assert [i.z for i in PLANE.expected_readback(rally)] == [80.0]
    assert [i.z for i in PX4_WING.expected_readback(rally)] == [80.7]


@pytest.mark.parametrize(("frame", "good"), [(0, True), (3, True), (5, False), (6, False)])
def test_px4_rally_points_work_in_two_frames(frame: int, good: bool) -> None:
    """Frames 5 and 6 are accepted and then unusable."""
    point = placed(5100, HERE, 80.0, frame)
    assert (rules(PX4_WING, point, kind=MissionType.RALLY) == set()) == good


@pytest.mark.parametrize("limit", [64])
def test_px4_fences_have_a_largest_size(limit: int) -> None:
    """64 vertices are held, 65 are not."""
    corners = [replace(placed(5001, HERE, 0.0, Frame.GLOBAL), param1=float(limit))] * limit
    assert rules(PX4_WING, *corners, kind=MissionType.FENCE) == set()
    more = [replace(corner, param1=limit + 1.0) for corner in (*corners, corners[0])]
    assert rules(PX4_WING, *more, kind=MissionType.FENCE) == {"too-many-items"}


@given(st.lists(st.one_of(placed_items(numbers), placeless_items(numbers)), min_size=1, max_size=5))
def test_reading_back_twice_changes_nothing_more(items: list[MissionItem]) -> None:
    """What a vehicle gives back is what it would give back of that."""
    for dialect in ALL:
        once = dialect.expected_readback(numbered(items))
        assert same(dialect.expected_readback(once), once)


@given(st.lists(st.integers(3, 7), max_size=4))
def test_shapes_of_a_fence_are_told_apart(sizes: list[int]) -> None:
    """Neighbouring polygons of equal kind and size stay separate."""
    items = [
        replace(placed(5002, HERE, 0.0, Frame.GLOBAL), param1=float(size))
        for size in sizes
        for _ in range(size)
    ]
    shapes = list(fence_shapes(numbered(items, MissionType.FENCE)))
    assert [len(shape) for _, shape in shapes] == sizes


def test_no_items_mean_clear() -> None:
    """An empty list is fine for every dialect."""
    for dialect in ALL:
        assert dialect.check(()) == ()
        assert dialect.expected_readback(()) == ()
