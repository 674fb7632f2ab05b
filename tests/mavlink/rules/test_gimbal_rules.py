"""Parameters of the gimbal, judged by where a mission points it; read and reported, never changed."""

from __future__ import annotations

from dataclasses import replace

import pytest

from mavlink.dialects import Autopilot, VehicleType
from mavlink.encoding.encode import EncodeOptions, encode
from mavlink.encoding.gimbal import Gimbal
from mavlink.encoding.payload import RelayPayload
from mavlink.rules.firmware import still_to_ask
from mavlink.rules.table import (
    Needs,
    judge_parameters,
    names_to_read,
    needs_of,
    unanswered,
)
from tests.mavlink.encoding.missions import KINDS
from tests.mavlink.plans import make_plan

ARDUPILOT = {
    "MNT1_TYPE": 1.0,
    "MNT1_PITCH_MIN": -90.0,
    "MNT1_PITCH_MAX": 20.0,
    "MNT1_YAW_MIN": -180.0,
    "MNT1_YAW_MAX": 180.0,
}
PX4 = {"MNT_MODE_IN": 4.0, "MNT_MODE_OUT": 0.0, "MNT_RANGE_PITCH": 180.0, "MNT_RANGE_YAW": 360.0}


def needs(autopilot: Autopilot, gimbal: Gimbal | None, looks: str = "right left") -> Needs:
    """What the mission of a plan needs whose passes look to these sides in turn."""
    plan = make_plan(autopilot=autopilot)
    sides = looks.split()
    turned = [
        replace(collect, look="left" if sides[number % len(sides)] == "left" else "right")
        for number, collect in enumerate(plan.collects)
    ]
    plan = replace(plan, collects=tuple(turned))
    return needs_of(plan, encode(plan, options=EncodeOptions(gimbal=gimbal)), RelayPayload())


def found(autopilot: Autopilot, wanted: Needs, values: dict[str, float]) -> list[tuple[str, float | None]]:
    findings = judge_parameters(autopilot, "fixed_wing", wanted, values)
    assert all(finding.severity == "error" for finding in findings)
    return [(finding.name, finding.advised) for finding in findings]


@pytest.mark.parametrize(("autopilot", "kind"), KINDS)
def test_they_are_read_where_there_is_a_gimbal_and_not_otherwise(
    autopilot: Autopilot, kind: VehicleType
) -> None:
    """Every vehicle of either autopilot is asked for them, and for none of them without a gimbal."""
    bolted, turned = needs(autopilot, None), needs(autopilot, Gimbal("manager", 45.0))
    more = set(names_to_read(autopilot, kind, turned)) - set(names_to_read(autopilot, kind, bolted))
    assert more == set(ARDUPILOT if autopilot == "ardupilot" else PX4)


def test_all_well_is_silent() -> None:
    """A gimbal that is there, listens and reaches draws nothing, by either protocol."""
    for gimbal in (Gimbal("manager", 45.0), Gimbal("manager", 0.0, "course"), Gimbal("mount", 30.0)):
        assert found("ardupilot", needs("ardupilot", gimbal), ARDUPILOT) == []
        assert found("px4", needs("px4", gimbal), PX4) == []


@pytest.mark.parametrize(
    ("name", "value", "advised"),
    [
        ("MNT1_TYPE", 0.0, None),
        ("MNT1_PITCH_MIN", -40.0, -45.0),
        ("MNT1_PITCH_MAX", -60.0, -45.0),
        ("MNT1_YAW_MIN", -45.0, -90.0),
        ("MNT1_YAW_MAX", 45.0, 90.0),
    ],
)
def test_ardupilots_gimbal_is_there_and_reaches(name: str, value: float, advised: float | None) -> None:
    """45° to either side asks for a pitch of -45 and yaws of -90 and 90."""
    wanted = needs("ardupilot", Gimbal("manager", 45.0))
    assert found("ardupilot", wanted, ARDUPILOT | {name: value}) == [(name, advised)]


def test_only_the_sides_looked_to_count() -> None:
    """A gimbal that turns to the right alone will do for passes that look there, and for looking down."""
    values = ARDUPILOT | {"MNT1_YAW_MIN": -10.0}
    assert found("ardupilot", needs("ardupilot", Gimbal("manager", 45.0), "right"), values) == []
    assert found("ardupilot", needs("ardupilot", Gimbal("manager", 0.0)), values) == []
    left = needs("ardupilot", Gimbal("manager", 45.0), "left")
    assert found("ardupilot", left, values) == [("MNT1_YAW_MIN", -90.0)]


def test_the_second_gimbal_has_its_own_parameters_and_older_firmware_another_name() -> None:
    """MNT2_… for device 2; MNT_TYPE where MNT1_TYPE is not answered."""
    second = needs("ardupilot", Gimbal("manager", 45.0, device=2))
    assert "MNT2_TYPE" in names_to_read("ardupilot", "fixed_wing", second)
    assert found("ardupilot", second, {"MNT1_TYPE": 0.0, "MNT2_TYPE": 1.0}) == []
    first = needs("ardupilot", Gimbal("mount", 45.0))
    names = names_to_read("ardupilot", "fixed_wing", first)
    assert still_to_ask(names, names, ()).count("MNT_TYPE") == 1
    assert found("ardupilot", first, {"MNT_TYPE": 0.0}) == [("MNT_TYPE", None)]
    assert "MNT1_TYPE" not in unanswered(("MNT1_TYPE",), {"MNT_TYPE"})


@pytest.mark.parametrize(
    ("protocol", "name", "value", "advised"),
    [
        ("manager", "MNT_MODE_IN", -1.0, 4.0),
        ("manager", "MNT_MODE_IN", 1.0, 4.0),
        ("manager", "MNT_MODE_IN", 3.0, 4.0),
        ("mount", "MNT_MODE_IN", 2.0, 4.0),
        ("manager", "MNT_RANGE_PITCH", 80.0, 90.0),
        ("mount", "MNT_RANGE_YAW", 170.0, 180.0),
    ],
)
def test_px4s_gimbal_listens_and_reaches(protocol: str, name: str, value: float, advised: float) -> None:
    """The driver runs and takes what the mission sends; half of each range lies to either side."""
    gimbal = Gimbal("mount" if protocol == "mount" else "manager", 45.0)
    assert found("px4", needs("px4", gimbal), PX4 | {name: value}) == [(name, advised)]


def test_px4_takes_mounts_by_the_older_input_and_leaves_limits_to_gimbals_of_protocol_2() -> None:
    """MNT_MODE_IN 3 is for DO_MOUNT_CONTROL; MNT_MODE_OUT 2 hands the angles on as they are."""
    assert found("px4", needs("px4", Gimbal("mount", 45.0)), PX4 | {"MNT_MODE_IN": 3.0}) == []
    handed_on = PX4 | {"MNT_MODE_OUT": 2.0, "MNT_RANGE_PITCH": 10.0}
    assert found("px4", needs("px4", Gimbal("manager", 45.0)), handed_on) == []
