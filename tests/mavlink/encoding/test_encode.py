"""Missions made from plans, judged by the plan's exact line, by pymavlink and by the autopilots' rules."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.geometry import Point

from mavlink.dialects import Autopilot, VehicleType
from mavlink.encoding.encode import EncodeError, EncodeOptions, encode
from mavlink.wire.items import Command, Frame, degrees_e7
from planner.route import Pose
from tests.mavlink.encoding.missions import (
    L,
    R,
    W,
    commands,
    commands_after,
    flight,
    local,
    room_of,
)
from tests.mavlink.plans import LEGS, Leg, make_plan


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
        {"arcs": "circles"},
        {"chord_error_m": 0.0},
        {"chord_error_m": math.nan},
        {"acceptance_radius_m": 300.0},
        {"approach_slope_deg": -3.0},
        {"off_delay_m": math.inf},
    ],
)
def test_senseless_options_are_refused(change: dict[str, Any]) -> None:
    """Options that no mission can be made from name themselves."""
    with pytest.raises(EncodeError, match=next(iter(change))):
        EncodeOptions(**change)
