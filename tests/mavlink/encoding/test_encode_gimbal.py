"""The gimbal in whole missions: where its items stand, what the vehicles hold of them, what files hold."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mavlink.dialects import Autopilot, VehicleType
from mavlink.dialects.compare import differences
from mavlink.encoding.encode import EncodeError, EncodeOptions, Mission, encode
from mavlink.encoding.gimbal import Gimbal, Protocol
from mavlink.encoding.trigger import payload_of
from mavlink.formats.qgc_plan import read_plan, write_plan
from mavlink.formats.waypoints import read_waypoints, write_waypoints
from mavlink.rules.table import needs_of
from mavlink.sim.autopilot import SimulatedAircraft
from mavlink.sim.geodesy import Place
from mavlink.sim.modes import Flavour
from mavlink.sim.settings import SimSettings
from mavlink.wire.items import Command, MissionItem, MissionType
from planner.plan import Plan
from tests.mavlink.cameras import with_photos
from tests.mavlink.encoding.missions import KINDS, A, L, R, W, commands
from tests.mavlink.plans import Leg, make_plan
from tests.mavlink.sim.helpers import Station

P, M, C = (
    Command.DO_GIMBAL_MANAGER_PITCHYAW,
    Command.DO_MOUNT_CONTROL,
    Command.DO_GIMBAL_MANAGER_CONFIGURE,
)
LEGS = (
    Leg(length_m=1500.0, collect_m=(500.0, 1200.0)),
    Leg(turn_deg=30.0, radius_m=150.0),
    Leg(length_m=1500.0, collect_m=(500.0, 1000.0)),
    Leg(turn_deg=-90.0, radius_m=150.0),
    Leg(length_m=1500.0, collect_m=(500.0, 1000.0)),
)


def two_sided(plan: Plan) -> Plan:
    """The plan with its last collect to the left, the others to the right."""
    *first, last = plan.collects
    return replace(plan, collects=(*first, replace(last, look="left")))


def pointings(mission: Mission) -> list[MissionItem]:
    return [item for item in mission.mission if item.command in (P, M)]


def fields(item: MissionItem) -> str:
    """All numbers of an item as text, in which NaN equals NaN."""
    params = (item.param1, item.param2, item.param3, item.param4)
    return f"{item.seq} {int(item.frame)} {int(item.command)} {params} {item.x} {item.y} {item.z}"


def switched(mission: Mission) -> list[int]:
    """Commands in order, without those that fly along the path."""
    return [command for command in commands(mission) if command not in (W, Command.NAV_LOITER_TURNS)]


def test_the_gimbal_points_before_the_first_pass_anew_for_the_other_side_and_rests_at_the_end() -> None:
    """Two passes share one pointing; the third gets its own right behind the second."""
    mission = encode(two_sided(make_plan(LEGS)), options=EncodeOptions(gimbal=Gimbal("manager", 45.0)))
    speed = Command.DO_CHANGE_SPEED
    assert switched(mission) == [
        *(Command.NAV_TAKEOFF, speed, P, L),
        *(R, R, R, R, P, R, R),
        *(R, P, L, Command.NAV_LAND),
    ]
    angles = [(item.param1, item.param2) for item in pointings(mission)]
    assert angles == [(-45.0, 90.0), (-45.0, -90.0), (0.0, 0.0)]
    numbers = commands(mission)
    again = [index for index, number in enumerate(numbers) if number == P][1]
    assert numbers[again - 2 : again] == [W, R], (
        "behind the waypoint that ends the pass, the sensor off first"
    )


def test_px4_takes_control_once_and_the_mission_stays_feasible() -> None:
    """The take-off is still the first item, control comes before the first pointing and nowhere else."""
    options = EncodeOptions(gimbal=Gimbal("manager", 45.0))
    mission = encode(two_sided(make_plan(LEGS, autopilot="px4")), options=options)
    speed, start, land = Command.DO_CHANGE_SPEED, Command.DO_LAND_START, Command.NAV_LAND
    assert switched(mission) == [
        *(Command.NAV_TAKEOFF, speed, C, P, L),
        *(A, A, A, A, P, A, A),
        *(A, P, start, L, land),
    ]
    assert mission.dialect.check(mission.mission) == ()


def test_a_yaw_held_abeam_is_told_anew_for_every_course() -> None:
    """Three passes on three courses get three yaws."""
    options = EncodeOptions(gimbal=Gimbal("manager", 45.0, "course"))
    plan = make_plan(LEGS, autopilot="px4")
    yaws = [item.param2 for item in pointings(encode(plan, options=options))[:-1]]
    headings = [collect.heading_deg for collect in plan.collects]
    assert [yaw % 360.0 for yaw in yaws] == pytest.approx([(h + 90.0) % 360.0 for h in headings])


@pytest.mark.parametrize("protocol", ["manager", "mount"])
@pytest.mark.parametrize(("autopilot", "kind"), [kind for kind in KINDS if kind[1] != "vtol"])
@settings(max_examples=8)
@given(tilt_deg=st.floats(0.0, 90.0))
def test_the_vehicle_holds_what_was_meant(
    protocol: Protocol, autopilot: Autopilot, kind: VehicleType, tilt_deg: float
) -> None:
    """Uploaded to the simulated vehicle, whose table is its own, and read back: no difference."""
    plan = two_sided(make_plan(LEGS, vehicle_type=kind, autopilot=autopilot))
    mission = encode(plan, options=EncodeOptions(gimbal=Gimbal(protocol, tilt_deg)))
    assert mission.dialect.check(mission.mission) == ()
    home = Place(plan.home[1], plan.home[0], 488.0)
    station = Station(
        SimulatedAircraft(SimSettings(home=home, autopilot=Flavour(autopilot), vehicle_type=kind))
    )
    assert station.upload(mission.mission) == 0
    held = tuple(station.download(MissionType.MISSION))
    assert differences(mission.mission, held, mission.dialect) == ()


@pytest.mark.parametrize("protocol", ["manager", "mount"])
@pytest.mark.parametrize("autopilot", ["ardupilot", "px4"])
def test_files_hold_the_pointing(autopilot: Autopilot, protocol: Protocol) -> None:
    """Both file formats give back the items as they were: flags, device and mode too."""
    mission = encode(
        two_sided(make_plan(LEGS, autopilot=autopilot)), options=EncodeOptions(gimbal=Gimbal(protocol, 30.0))
    )
    assert len(pointings(mission)) == 3
    for back in (
        read_plan(write_plan(mission)),
        read_waypoints(write_waypoints(mission), autopilot, "fixed_wing"),
    ):
        assert [fields(item) for item in pointings(back)] == [fields(item) for item in pointings(mission)]


def test_without_a_gimbal_or_a_pass_nothing_is_added() -> None:
    """A sensor bolted on, or a path without collects, needs no pointing."""
    assert not pointings(encode(make_plan(LEGS)))
    empty = make_plan((Leg(length_m=1500.0),))
    assert not pointings(encode(empty, options=EncodeOptions(gimbal=Gimbal("manager", 45.0))))


@pytest.mark.parametrize(
    ("autopilot", "protocol", "noted"),
    [("ardupilot", "manager", True), ("ardupilot", "mount", False), ("px4", "manager", False)],
)
def test_angles_an_autopilot_rounds_are_said(autopilot: Autopilot, protocol: Protocol, noted: bool) -> None:
    """ArduPilot keeps whole degrees by the manager, all of them by the mount; PX4 keeps them by both."""
    options = EncodeOptions(gimbal=Gimbal(protocol, 44.6))
    notes = encode(make_plan(LEGS, autopilot=autopilot), options=options).notes
    assert any("-45° is sent for -45.4°" in note for note in notes) == noted


def test_copters_that_turn_their_nose_for_a_mount_are_told_of() -> None:
    """ArduCopter alone does, and by the older command alone."""
    for autopilot, kind in KINDS:
        for protocol in ("manager", "mount"):
            plan = make_plan(LEGS, vehicle_type=kind, autopilot=autopilot)
            gimbal = Gimbal("mount" if protocol == "mount" else "manager", 45.0)
            notes = encode(plan, options=EncodeOptions(gimbal=gimbal)).notes
            turns = (autopilot, kind, protocol) == ("ardupilot", "multirotor", "mount")
            assert any("turns its nose" in note for note in notes) == turns


def test_gimbals_an_autopilot_has_not_are_refused() -> None:
    """ArduPilot has two; PX4 turns its one whatever is named, which is said."""
    options = EncodeOptions(gimbal=Gimbal("manager", 45.0, device=3))
    with pytest.raises(EncodeError, match="numbered 1 to 2"):
        encode(make_plan(LEGS), options=options)
    notes = encode(make_plan(LEGS, autopilot="px4"), options=options).notes
    assert any("whichever device is named" in note for note in notes)


@pytest.mark.parametrize(("tilt_deg", "yaw_deg"), [(30.0, 0.0), (-30.0, 180.0)])
@pytest.mark.parametrize("autopilot", ["ardupilot", "px4"])
@pytest.mark.parametrize("protocol", ["manager", "mount"])
def test_cameras_are_tilted_along_their_passes(
    protocol: Protocol, autopilot: Autopilot, tilt_deg: float, yaw_deg: float
) -> None:
    """Forwards or backwards, as the plan has it, and never aside; the parameters are judged by that yaw."""
    plan = with_photos(make_plan(autopilot=autopilot))
    plan = replace(plan, cameras=(replace(plan.cameras[0], tilt_deg=tilt_deg),))
    mission = encode(plan, options=EncodeOptions(gimbal=Gimbal(protocol, abs(tilt_deg))))
    first = pointings(mission)[0]
    assert first.param1 == -60.0
    assert abs(first.param2 if first.command == P else first.param3) == yaw_deg
    assert len(pointings(mission)) == 2, "once, and at rest"
    assert any("along each pass" in note for note in mission.notes)
    gimbal = needs_of(plan, mission, payload_of(plan, "uav-1", None)).gimbal
    assert gimbal is not None
    assert (gimbal.pitch_deg, gimbal.yaws_deg) == (-60.0, (yaw_deg,))
