"""Missions made from plans, judged by the plan's exact line, by pymavlink and by the autopilots' rules."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import pytest

from mavlink.dialects import VehicleType
from mavlink.encoding.encode import EncodeError, EncodeOptions, encode
from mavlink.wire.items import Command, Frame
from planner.plan import Finish
from tests.mavlink.encoding.missions import A, L, R, W, commands
from tests.mavlink.plans import Leg, make_plan

COLLECT = (Leg(length_m=1500.0, collect_m=(500.0, 1200.0)), Leg(length_m=300.0))
T, V, S = Command.NAV_TAKEOFF, Command.NAV_VTOL_TAKEOFF, Command.DO_CHANGE_SPEED
START, U = Command.DO_LAND_START, Command.NAV_LOITER_UNLIM
RTL = Command.NAV_RETURN_TO_LAUNCH
PASS = [W, R, W, R, W, W, R]
PX4_PASS = [W, A, W, W, A, W, W, A]
#: The exact end of a collect, 2 m before where the sensor goes off, would be a place to stop at.
PX4_HOVER_PASS = [W, A, W, A, W, W, A]


@pytest.mark.parametrize(
    ("kind", "finish", "order"),
    [
        ("fixed_wing", "land", [W, T, S, L, *PASS, L, Command.NAV_LAND]),
        ("fixed_wing", "return", [W, T, S, L, *PASS, L, RTL]),
        ("fixed_wing", "loiter", [W, T, S, L, *PASS, U]),
        ("vtol", "land", [W, V, S, L, *PASS, L, Command.NAV_VTOL_LAND]),
        ("vtol", "return", [W, V, S, L, *PASS, L, RTL]),
        ("vtol", "loiter", [W, V, S, L, *PASS, U]),
        ("multirotor", "land", [W, T, S, *PASS, Command.NAV_LAND]),
        ("multirotor", "return", [W, T, S, *PASS, RTL]),
        ("multirotor", "loiter", [W, T, S, *PASS, U]),
    ],
)
def test_the_order_of_flight_on_ardupilot(kind: VehicleType, finish: Finish, order: list[int]) -> None:
    """Home row, take-off, speed, climbing turns, the pass, off once more, down as the plan ends."""
    mission = encode(make_plan(COLLECT, vehicle_type=kind, finish=finish))
    assert commands(mission) == order
    assert [item.seq for item in mission.mission] == list(range(len(order)))
    home, takeoff, speed = mission.mission[:3]
    assert home.frame == Frame.GLOBAL
    assert home.current
    assert not takeoff.current
    assert (speed.param1, speed.param2) == (1.0 if kind == "multirotor" else 0.0, 20.0)


@pytest.mark.parametrize(
    ("kind", "finish", "order"),
    [
        ("fixed_wing", "land", [T, S, L, *PX4_PASS, START, L, Command.NAV_LAND]),
        ("vtol", "land", [V, S, L, *PX4_PASS, START, L, Command.NAV_VTOL_LAND]),
        ("multirotor", "land", [T, S, *PX4_HOVER_PASS, Command.NAV_LAND]),
        ("multirotor", "return", [T, S, *PX4_HOVER_PASS, RTL]),
        ("multirotor", "loiter", [T, S, *PX4_HOVER_PASS, U]),
    ],
)
def test_the_order_of_flight_on_px4(kind: VehicleType, finish: Finish, order: list[int]) -> None:
    """No home row; the take-off is item 0 and current; a wing's landing starts behind DO_LAND_START."""
    mission = encode(make_plan(COLLECT, autopilot="px4", vehicle_type=kind, finish=finish))
    assert commands(mission) == order
    assert mission.mission[0].current


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
        {"off_delay_m": math.inf},
    ],
)
def test_senseless_options_are_refused(change: dict[str, Any]) -> None:
    """Options that no mission can be made from name themselves."""
    with pytest.raises(EncodeError, match=next(iter(change))):
        EncodeOptions(**change)
