"""Taking off and coming down: as the plan has it, and as each autopilot wants it said."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import pytest

from mavlink.dialects import VehicleType
from mavlink.encoding.encode import EncodeError, EncodeOptions, encode
from mavlink.wire.items import Command
from planner.plan import Finish
from tests.mavlink.encoding.missions import L, W, commands, local
from tests.mavlink.plans import CIRCLE_M, FRAME, RUN_M, START, Leg, make_plan


def test_a_multirotor_climbs_on_the_spot() -> None:
    """Take-off goes to the plan's altitude over home, and no waypoint stands there again."""
    mission = encode(make_plan(vehicle_type="multirotor"))
    home, takeoff, speed, first = mission.mission[:4]
    assert (takeoff.command, takeoff.z) == (Command.NAV_TAKEOFF, 300.0)
    assert (takeoff.x, takeoff.y) == (home.x, home.y)
    assert speed.param1 == 1.0, "a multirotor is told its ground speed"
    assert math.dist(local(first), local(takeoff)) > 100.0
    assert L not in commands(mission)


@pytest.mark.parametrize("autopilot", ["ardupilot", "px4"])
def test_a_wing_takes_off_to_where_the_plan_does(autopilot: str) -> None:
    """The item lies at the end of the run, as high as the plan is there."""
    plan = make_plan(autopilot=autopilot)
    takeoff = next(i for i in encode(plan).mission if i.command == Command.NAV_TAKEOFF)
    assert math.dist(local(takeoff), START.position) < 0.05
    assert takeoff.z == 50.0


def test_vtols_hover_up_where_they_stand_or_speed_up_ahead() -> None:
    """ArduPlane takes off on the spot; PX4 turns to the take-off's place and flies there on wings."""
    here = next(i for i in encode(make_plan(vehicle_type="vtol")).mission if i.seq == 1)
    ahead = encode(make_plan(autopilot="px4", vehicle_type="vtol")).mission[0]
    assert here.command == ahead.command == Command.NAV_VTOL_TAKEOFF
    assert (here.z, ahead.z) == (50.0, 50.0)
    assert math.dist(local(here), FRAME.to_local(make_plan(vehicle_type="vtol").home)) < 0.05
    assert math.dist(local(ahead), local(here)) == pytest.approx(RUN_M, abs=0.1)


@pytest.mark.parametrize(("kind", "words"), [("fixed_wing", "circles over home"), ("vtol", "Q_RTL_MODE")])
def test_a_return_that_does_not_land_is_said(kind: VehicleType, words: str) -> None:
    """ArduPlane's return ends in circles over home: the notes say who lands, and what else there is."""
    (note,) = [
        n for n in encode(make_plan(finish="return", vehicle_type=kind)).notes if n.startswith("the return")
    ]
    assert words in note
    assert "left to the pilot" in note
    assert "finish 'land'" in note
    copter = encode(make_plan(finish="return", vehicle_type="multirotor"))
    assert not [n for n in copter.notes if n.startswith("the return")]


@pytest.mark.parametrize("kind", ["fixed_wing", "vtol"])
@pytest.mark.parametrize("finish", ["return", "loiter"])
def test_px4_wings_are_not_sent_without_a_landing(kind: VehicleType, finish: Finish) -> None:
    """Refused before PX4 declares the mission invalid, with the property to change; multirotors may."""
    with pytest.raises(EncodeError, match=r"MIS_TKO_LAND_REQ.*finish 'land' of vehicle uav-1"):
        encode(make_plan(autopilot="px4", vehicle_type=kind, finish=finish))
    # Also where the plan is another autopilot's.
    with pytest.raises(EncodeError, match="finish 'land'"):
        encode(make_plan(vehicle_type=kind, finish=finish), autopilot="px4")
    assert encode(make_plan(autopilot="px4", vehicle_type="multirotor", finish=finish)).mission


@pytest.mark.parametrize("autopilot", ["ardupilot", "px4"])
@pytest.mark.parametrize("kind", ["fixed_wing", "vtol", "multirotor"])
def test_a_collect_up_to_the_missions_end_is_seen_whole(autopilot: str, kind: VehicleType) -> None:
    """The last off, the gimbal's rest and the landing's start stand behind the waypoint that ends it."""
    plan = make_plan(
        (Leg(length_m=1500.0, collect_m=(500.0, 1500.0)),), autopilot=autopilot, vehicle_type=kind
    )
    items = encode(plan).mission
    switch = Command.DO_SET_RELAY if autopilot == "ardupilot" else Command.DO_SET_ACTUATOR
    at = [index for index, item in enumerate(items) if item.command == switch]
    assert len(at) == 3
    assert at[2] == at[1] + 1
    assert items[at[1] - 1].command == W
    (collect,) = plan.collects
    begin, end = (FRAME.to_local(place[:2]) for place in collect.line)
    seen_m = math.dist(local(items[at[1] - 1]), begin)
    assert seen_m >= math.dist(begin, end) - 0.05


def test_a_collect_may_begin_where_the_take_off_ends() -> None:
    """Its waypoint stands right behind the take-off, the sensor on behind it."""
    plan = make_plan((Leg(length_m=1500.0, collect_m=(0.0, 500.0)),), vehicle_type="multirotor")
    assert commands(encode(plan))[1:5] == [
        Command.NAV_TAKEOFF,
        Command.DO_CHANGE_SPEED,
        W,
        Command.DO_SET_RELAY,
    ]


def test_a_landing_elsewhere_is_said() -> None:
    """The height of the ground far from home is taken from home, which people must know."""
    words = "the ground at the end is taken to be as high as home"
    assert words in encode(make_plan()).notes
    plan = make_plan()
    assert words not in encode(replace(plan, end=plan.home)).notes


@pytest.mark.parametrize("autopilot", ["ardupilot", "px4"])
@pytest.mark.parametrize("turn_deg", [200.0, -200.0, 80.0, -80.0])
@pytest.mark.parametrize("radius_m", [CIRCLE_M, 130.0, 300.0])
def test_climbing_turns_are_left_towards_a_place_outside_their_circle(
    autopilot: str, turn_deg: float, radius_m: float
) -> None:
    """An arc right behind them is no turn of its own, and no waypoint of it lies on the circle.

    PX4 leaves a circle anywhere where the next place is nearer to its centre than 1.05 radii, and ArduPlane
    would leave it towards the centre of the next turn.
    """
    plan = make_plan((Leg(turn_deg=turn_deg, radius_m=radius_m), Leg(length_m=900.0)), autopilot=autopilot)
    items = encode(plan).mission
    at = next(index for index, item in enumerate(items) if item.command == L)
    circle = items[at]
    behind = next(item for item in items[at + 1 :] if item.x or item.y)
    assert behind.command == W
    assert math.dist(local(behind), local(circle)) > 1.05 * CIRCLE_M


@pytest.mark.parametrize("autopilot", ["ardupilot", "px4"])
@pytest.mark.parametrize("kind", ["fixed_wing", "vtol"])
@pytest.mark.parametrize("altitude_m", [40.0, 300.0])
def test_a_landing_straight_in_begins_at_a_place_of_its_own(
    autopilot: str, kind: VehicleType, altitude_m: float
) -> None:
    """Without circles: the last off and PX4's mark before the place that it comes down from."""
    leg = Leg(length_m=1500.0, collect_m=(500.0, 1500.0))
    plan = make_plan((leg,), autopilot=autopilot, vehicle_type=kind, altitude_m=altitude_m, circles=False)
    items = encode(plan, options=EncodeOptions(off_delay_m=0.0)).mission
    assert not {L, Command.NAV_LOITER_UNLIM, Command.NAV_LOITER_TURNS} & {item.command for item in items}
    *before, last, land = items
    assert land.command == (Command.NAV_VTOL_LAND if kind == "vtol" else Command.NAV_LAND)
    landing = plan.paths[0].phase("landing")
    assert landing is not None
    # ArduPilot comes in from where the last collect ended; PX4's landing has a waypoint behind its mark.
    begins = next(s for s in plan.paths[0].segments if s.start_m >= landing.start_m - 0.01).start
    places = [item for item in items if item.command == W]
    assert math.dist(local(places[-1]), FRAME.to_local(begins)) < 0.05
    assert places[-1].z == pytest.approx(40.0)
    if autopilot == "px4":
        assert last.command == W
        assert before[-1].command == Command.DO_LAND_START
    switch = Command.DO_SET_RELAY if autopilot == "ardupilot" else Command.DO_SET_ACTUATOR
    offs = [index for index, item in enumerate(items) if item.command == switch]
    assert len(offs) == 3
    ends = items[: offs[1]][-1]
    (collect,) = plan.collects
    assert math.dist(local(ends), FRAME.to_local(collect.line[1][:2])) < 0.05
    assert offs[2] > offs[1]


@pytest.mark.parametrize("autopilot", ["ardupilot", "px4"])
@pytest.mark.parametrize("climb_m", [40.0, -40.0])
def test_a_height_changed_on_the_spot_is_two_places_over_each_other(autopilot: str, climb_m: float) -> None:
    """Both are named, though PX4's multirotors are else named no places so near to each other."""
    legs = (Leg(length_m=600.0, climb_m=climb_m), Leg(length_m=500.0))
    items = [
        i for i in encode(make_plan(legs, autopilot=autopilot, vehicle_type="multirotor")).mission if i.x
    ]
    (at,) = [
        k
        for k, (before, item) in enumerate(pairwise(items))
        if before.command == item.command == W and math.dist(local(before), local(item)) < 0.1
    ]
    assert (items[at].z, items[at + 1].z) == (300.0, 300.0 + climb_m)
    assert items[at + 2].z == pytest.approx(300.0 + climb_m)
