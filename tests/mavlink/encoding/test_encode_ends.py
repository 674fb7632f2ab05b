"""Climbing away and coming home: circles, approaches, landings and returns."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from shapely.geometry import Point

from mavlink.dialects import Autopilot, VehicleType
from mavlink.encoding.encode import EncodeError, EncodeOptions, encode
from mavlink.wire.items import Command
from planner.route import Pose
from tests.mavlink.encoding.missions import (
    L,
    R,
    W,
    commands,
    flight,
    local,
    room_of,
)
from tests.mavlink.plans import FRAME, Leg, make_plan, square_fence


def test_a_multirotor_climbs_on_the_spot() -> None:
    """Take-off goes to the plan's altitude over home, and no circle is flown."""
    mission = encode(make_plan(vehicle_type="multirotor"))
    takeoff = mission.mission[1]
    assert (takeoff.command, takeoff.z) == (Command.NAV_TAKEOFF, 300.0)
    assert (takeoff.x, takeoff.y) == (mission.mission[0].x, mission.mission[0].y)
    assert L not in commands(mission)
    assert mission.mission[2].param1 == 1.0, "a multirotor is told its ground speed"


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


def test_a_vtol_of_px4s_speeds_up_along_its_path_inside_the_fence() -> None:
    """PX4 turns to the take-off's place and flies there on wings; ArduPlane takes off where it stands."""
    ahead = encode(make_plan(autopilot="px4", vehicle_type="vtol", start=Pose(0.0, 0.0, 0.4))).mission[0]
    assert ahead.command == Command.NAV_VTOL_TAKEOFF
    east_m, north_m = local(ahead)
    assert math.hypot(east_m, north_m) == pytest.approx(7.5 * 20.0, abs=0.1)
    assert math.atan2(north_m, east_m) == pytest.approx(0.4, abs=0.001)
    edge = make_plan(autopilot="px4", vehicle_type="vtol", start=Pose(5950.0, 0.0, 0.0))
    aside = encode(edge).mission[0]
    assert room_of(edge).contains(Point(local(aside)))
    here = encode(make_plan(vehicle_type="vtol")).mission[1]
    assert here.command == Command.NAV_VTOL_TAKEOFF
    assert math.hypot(*local(here)) < 0.05


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
