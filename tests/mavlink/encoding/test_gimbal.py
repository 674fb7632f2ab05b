"""The gimbal's pointing: specifications, signs, what each autopilot keeps, bytes as pymavlink reads them."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymavlink.dialects.v20 import common

from mavlink.dialects import Autopilot, dialect_for
from mavlink.encoding.gimbal import (
    Flags,
    Gimbal,
    GimbalError,
    Pointing,
    control_items,
    neutral_item,
    parse_gimbal,
    pointing_at,
    pointing_item,
    turning_notes,
)
from mavlink.transfer.items_wire import item_message
from mavlink.wire.codec import Codec
from mavlink.wire.items import Command, MissionItem, MissionResult
from planner.plan import Collect
from tests.mavlink.plans import make_plan

AUTOPILOTS: tuple[Autopilot, ...] = ("ardupilot", "px4")
COLLECT = make_plan().collects_of("uav-1")[0]

gimbals = st.one_of(
    st.builds(
        Gimbal,
        st.just("manager"),
        st.floats(0.0, 90.0),
        st.sampled_from(["vehicle", "course"]),
        st.integers(0, 2),
    ),
    st.builds(Gimbal, st.just("mount"), st.floats(0.0, 90.0)),
)
collects = st.builds(
    lambda look, heading_deg: replace(COLLECT, look=look, heading_deg=heading_deg),
    st.sampled_from(["left", "right"]),
    st.floats(0.0, 360.0, exclude_max=True),
)


def boresight(pointing: Pointing) -> tuple[float, float, float]:
    """Ahead, right and down of an axis along the nose, turned up by the pitch and right by the yaw."""
    pitch, yaw = math.radians(pointing.pitch_deg), math.radians(pointing.yaw_deg)
    return math.cos(pitch) * math.cos(yaw), math.cos(pitch) * math.sin(yaw), -math.sin(pitch)


def on_the_wire(item: MissionItem) -> common.MAVLink_mission_item_int_message:
    """What pymavlink makes of the bytes sent."""
    reader = common.MAVLink(None)
    sent = Codec(255, 190).pack(item_message(item, 1, 1))
    read = reader.parse_buffer(sent)
    assert read is not None
    assert len(read) == 1
    assert isinstance(read[0], common.MAVLink_mission_item_int_message)
    return read[0]


def test_flags_are_those_of_the_message_definitions() -> None:
    """Every flag has the number that pymavlink's common.xml gives it, and so have the commands."""
    for flag in Flags:
        assert getattr(common, f"GIMBAL_MANAGER_FLAGS_{flag.name}") == flag
    for name in ("DO_GIMBAL_MANAGER_PITCHYAW", "DO_GIMBAL_MANAGER_CONFIGURE", "DO_MOUNT_CONTROL"):
        assert getattr(common, f"MAV_CMD_{name}") == Command[name]


@pytest.mark.parametrize(
    ("text", "gimbal"),
    [
        ("none", None),
        ("manager:tilt=45", Gimbal("manager", 45.0)),
        (" manager:device=2,yaw=course,tilt=37.5 ", Gimbal("manager", 37.5, "course", 2)),
        ("mount:tilt=0,yaw=vehicle", Gimbal("mount", 0.0)),
    ],
)
def test_specifications_are_read(text: str, gimbal: Gimbal | None) -> None:
    """Kind, tilt, yaw and device; none for a sensor that is bolted on."""
    assert parse_gimbal(text) == gimbal


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "none of none, manager, mount"),
        ("none:tilt=45", "none of none, manager, mount"),
        ("servo:tilt=45", "none of none, manager, mount"),
        ("manager", "write e.g. manager:tilt=45"),
        ("manager:45", "'45' is none of"),
        ("manager:tilt=45,tilt=45", "each once"),
        ("manager:tilt=steep", "steep"),
        ("manager:tilt=nan", "tilt nan"),
        ("manager:tilt=91", "straight down"),
        ("manager:tilt=-1", "straight down"),
        ("manager:tilt=45,yaw=north", "vehicle or course"),
        ("manager:tilt=45,device=1.5", "1.5"),
        ("manager:tilt=45,device=256", "0 to 255"),
        ("mount:tilt=45,yaw=course", "needs manager"),
        ("mount:tilt=45,device=1", "goes with manager"),
    ],
)
def test_what_is_not_understood_is_named(text: str, said: str) -> None:
    """Each refusal says what is wrong and what is meant."""
    with pytest.raises(GimbalError, match=said):
        parse_gimbal(text)


@given(gimbal=gimbals, collect=collects, autopilot=st.sampled_from(AUTOPILOTS))
def test_the_sensor_looks_as_far_from_straight_down_as_told_to_the_passs_side(
    gimbal: Gimbal, collect: Collect, autopilot: Autopilot
) -> None:
    """The angle to the vertical is the tilt, the axis lies abeam on the look's side."""
    pointing = pointing_at(gimbal, collect, autopilot)
    if gimbal.hold == "course":
        # From north to the nose, which points along the pass in still air.
        pointing = Pointing(pointing.pitch_deg, pointing.yaw_deg - collect.heading_deg)
    ahead, right, down = boresight(pointing)
    rounded_deg = 0.51 if autopilot == "ardupilot" and gimbal.protocol == "manager" else 1e-6
    assert math.degrees(math.acos(min(1.0, down))) == pytest.approx(gimbal.tilt_deg, abs=rounded_deg)
    if gimbal.tilt_deg > 1.0:
        away = right if collect.look == "right" else -right
        assert math.degrees(math.atan2(abs(ahead), away)) < rounded_deg + 1e-6


@given(gimbal=gimbals, collect=collects, autopilot=st.sampled_from(AUTOPILOTS))
def test_every_item_is_taken_and_its_angles_kept(
    gimbal: Gimbal, collect: Collect, autopilot: Autopilot
) -> None:
    """The dialect's table accepts it, and gives back the angles that were sent, cut off nowhere."""
    dialect = dialect_for(autopilot, "fixed_wing")
    pointing = pointing_at(gimbal, collect, autopilot)
    assert abs(pointing.yaw_deg) <= 180.0
    item = replace(pointing_item(gimbal, pointing, autopilot), seq=1)
    rest = replace(neutral_item(gimbal, autopilot), seq=2)
    for each in (item, rest, *(replace(i, seq=3) for i in control_items(gimbal, autopilot))):
        assert dialect.answer(each) == MissionResult.ACCEPTED
    held = dialect.expected_readback((item,))[0]
    angles = (held.param1, held.param3) if gimbal.protocol == "mount" else (held.param1, held.param2)
    assert angles == (pointing.pitch_deg, pointing.yaw_deg)
    assert held.x == item.x


@pytest.mark.parametrize("autopilot", AUTOPILOTS)
def test_manager_bytes(autopilot: Autopilot) -> None:
    """45° to the right: pitch -45, yaw +90 from the nose, level; no rates; the device in param 7."""
    gimbal = Gimbal("manager", 45.0, device=2)
    read = on_the_wire(pointing_item(gimbal, pointing_at(gimbal, COLLECT, autopilot), autopilot))
    assert (read.command, read.frame) == (common.MAV_CMD_DO_GIMBAL_MANAGER_PITCHYAW, common.MAV_FRAME_MISSION)
    assert (read.param1, read.param2, read.y, read.z) == (-45.0, 90.0, 0, 2.0)
    assert read.x == (
        common.GIMBAL_MANAGER_FLAGS_ROLL_LOCK
        | common.GIMBAL_MANAGER_FLAGS_PITCH_LOCK
        | common.GIMBAL_MANAGER_FLAGS_YAW_IN_VEHICLE_FRAME
    )
    assert [math.isnan(rate) for rate in (read.param3, read.param4)] == [autopilot == "px4"] * 2
    assert read.param3 == 0.0 or autopilot == "px4", "ArduPilot refuses NaN"


def test_a_yaw_held_abeam_of_the_course_counts_from_north() -> None:
    """Heading 300° and looking left: 210°, said as -150°, with the yaw locked in the earth's frame."""
    gimbal = Gimbal("manager", 45.0, "course")
    collect = replace(COLLECT, look="left", heading_deg=300.0)
    read = on_the_wire(pointing_item(gimbal, pointing_at(gimbal, collect, "px4"), "px4"))
    assert (read.param1, read.param2) == (-45.0, -150.0)
    assert read.x & common.GIMBAL_MANAGER_FLAGS_YAW_LOCK
    assert read.x & common.GIMBAL_MANAGER_FLAGS_YAW_IN_EARTH_FRAME
    assert not read.x & common.GIMBAL_MANAGER_FLAGS_YAW_IN_VEHICLE_FRAME


def test_mount_bytes_and_the_neutral_position() -> None:
    """Pitch, roll, yaw in params 1 to 3, the mode in param 7: targeting for a pass, neutral at the end."""
    gimbal = Gimbal("mount", 30.5)
    read = on_the_wire(pointing_item(gimbal, pointing_at(gimbal, COLLECT, "ardupilot"), "ardupilot"))
    assert read.command == common.MAV_CMD_DO_MOUNT_CONTROL
    assert (read.param1, read.param2, read.param3) == (-59.5, 0.0, 90.0)
    assert read.z == common.MAV_MOUNT_MODE_MAVLINK_TARGETING
    assert on_the_wire(neutral_item(gimbal, "px4")).z == common.MAV_MOUNT_MODE_NEUTRAL
    managed = on_the_wire(neutral_item(Gimbal("manager", 30.5), "ardupilot"))
    assert (managed.param1, managed.param2, managed.x) == (0.0, 0.0, common.GIMBAL_MANAGER_FLAGS_NEUTRAL)


def test_px4_takes_control_of_the_gimbal_first() -> None:
    """Only for the manager, and only on PX4: it denies the pointing of a mission otherwise."""
    (item,) = control_items(Gimbal("manager", 45.0), "px4")
    read = on_the_wire(item)
    assert read.command == common.MAV_CMD_DO_GIMBAL_MANAGER_CONFIGURE
    assert (read.param1, read.param2, read.param3, read.param4) == (-2.0, -2.0, -1.0, -1.0)
    assert control_items(Gimbal("mount", 45.0), "px4") == ()
    assert control_items(Gimbal("manager", 45.0), "ardupilot") == ()


def test_little_time_to_turn_is_said_and_overlap_refused() -> None:
    """Half a turn in 3 s is noted; a pass that begins inside one looking elsewhere cannot be pointed at."""
    one = replace(COLLECT, seq=0, start_m=0.0, end_m=400.0, start_s=0.0, end_s=20.0)
    two = replace(COLLECT, seq=1, look="left", start_m=460.0, end_m=900.0, start_s=23.0, end_s=45.0)
    (note,) = turning_notes(Gimbal("manager", 45.0), (one, two))
    assert "3.0 s" in note
    assert turning_notes(Gimbal("manager", 0.0), (one, two)) == (), "straight down has no side"
    late = replace(two, start_s=30.0)
    assert turning_notes(Gimbal("manager", 45.0), (one, late)) == ()
    with pytest.raises(GimbalError, match="before collect 0 has ended"):
        turning_notes(Gimbal("manager", 45.0), (one, replace(two, start_m=300.0)))
