"""QGroundControl's .plan, read by ourselves and refused where it is wrong."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mavlink.dialects import Autopilot, VehicleType
from mavlink.dialects.mission import Mission
from mavlink.encoding.encode import EncodeOptions, encode
from mavlink.formats import FormatError, read_plan, write_plan
from mavlink.wire.items import Command
from tests.mavlink.plans import make_plan
from tests.mavlink.strategies import missions, same


def document(autopilot: Autopilot = "ardupilot", kind: VehicleType = "fixed_wing") -> dict[str, Any]:
    options = EncodeOptions(rally_at_home=True, home_altitude_m=120.0)
    plan = make_plan(autopilot=autopilot, vehicle_type=kind)
    loaded: dict[str, Any] = json.loads(write_plan(encode(plan, options=options)))
    return loaded


@given(missions())
@settings(max_examples=150, deadline=None)
def test_what_is_written_is_read(mission: Mission) -> None:
    """Any mission, fence and rally list comes back, NaN, jumps and raw integers included."""
    read = read_plan(write_plan(mission))
    assert same(read.mission, mission.mission)
    assert same(read.fence, mission.fence)
    assert [(i.x, i.y, i.z) for i in read.rally] == [(i.x, i.y, i.z) for i in mission.rally]
    assert (read.autopilot, read.vehicle_type) == (mission.autopilot, mission.vehicle_type)
    assert (read.home, read.home_altitude_m) == (mission.home, mission.home_altitude_m)
    assert read.speed_m_s == mission.speed_m_s


@pytest.mark.parametrize(
    ("autopilot", "kind", "firmware", "vehicle"),
    [
        ("ardupilot", "fixed_wing", 3, 1),
        ("ardupilot", "multirotor", 3, 2),
        ("px4", "fixed_wing", 12, 1),
        ("px4", "multirotor", 12, 2),
    ],
)
def test_the_file_has_the_members_that_ground_stations_want(
    autopilot: Autopilot, kind: VehicleType, firmware: int, vehicle: int
) -> None:
    """Versions, firmware, vehicle, speeds, home; items numbered from 1 without the home row."""
    plan = document(autopilot, kind)
    home_lon_deg, home_lat_deg = make_plan(vehicle_type=kind).home
    mission = plan["mission"]
    assert (plan["fileType"], plan["version"]) == ("Plan", 1)
    assert (plan["geoFence"]["version"], plan["rallyPoints"]["version"], mission["version"]) == (2, 2, 2)
    assert (mission["firmwareType"], mission["vehicleType"]) == (firmware, vehicle)
    assert (mission["cruiseSpeed"], mission["hoverSpeed"]) == (20.0, 20.0)
    assert mission["plannedHomePosition"] == pytest.approx([home_lat_deg, home_lon_deg, 120.0], abs=1e-7)
    items = mission["items"]
    assert items[0]["command"] == Command.NAV_TAKEOFF
    assert [item["doJumpId"] for item in items] == list(range(1, len(items) + 1))
    for item in items:
        assert item["type"] == "SimpleItem"
        assert len(item["params"]) == 7
        if item["frame"] == 3:
            assert (item["AltitudeMode"], item["Altitude"]) == (1, item["params"][6])
            assert item["AMSLAltAboveTerrain"] is None
        else:
            assert "AltitudeMode" not in item
    assert plan["geoFence"]["polygons"][0]["inclusion"] is True
    assert len(plan["geoFence"]["polygons"][0]["polygon"]) == 4
    assert len(plan["rallyPoints"]["points"]) == 1


def test_altitudes_over_the_sea_have_their_mode() -> None:
    """Items in a global frame carry altitude mode 2."""
    mission = encode(make_plan(altitude_reference="amsl"))
    items = json.loads(write_plan(mission))["mission"]["items"]
    assert {i["AltitudeMode"] for i in items if i["frame"] == 0} == {2}


def test_nan_is_written_as_null() -> None:
    """The file is JSON by the letter: PX4's open yaws are null."""
    text = write_plan(encode(make_plan(), autopilot="px4"))
    assert "NaN" not in text
    assert json.loads(text)["mission"]["items"][0]["params"][3] is None


def test_surveys_are_read_as_the_items_they_hold() -> None:
    """A complex item with items inside is laid out flat, and jumps find their targets."""
    plan = document()
    items = plan["mission"]["items"]
    inside = items[3:7]
    survey = {
        "type": "ComplexItem",
        "complexItemType": "survey",
        "TransectStyleComplexItem": {"Items": inside},
    }
    jump = {"type": "SimpleItem", "command": 177, "doJumpId": 99, "frame": 2, "params": [5, 2, 0, 0, 0, 0, 0]}
    plan["mission"]["items"] = [*items[:3], survey, *items[7:], jump]
    flat = read_plan(json.dumps(plan)).mission
    assert len(flat) == len(items) + 2
    assert flat[-1].param1 == 5.0
    assert same(flat[:-1], read_plan(json.dumps(document())).mission)


def test_a_file_without_an_autopilot_is_read_without_a_home_row() -> None:
    """Firmware 0 is any: the items are taken as they stand, with a note."""
    plan = document("px4")
    plan["mission"]["firmwareType"] = 0
    read = read_plan(json.dumps(plan))
    assert read.mission[0].command == Command.NAV_TAKEOFF
    assert any("autopilot" in note for note in read.notes)


def _set(plan: dict[str, Any], path: str, value: object) -> dict[str, Any]:
    target: Any = plan
    *keys, last = [int(key) if key.isdigit() else key for key in path.split(".")]
    for key in keys:
        target = target[key]
    target[last] = value
    return plan


@pytest.mark.parametrize(
    ("path", "value", "says"),
    [
        ("fileType", "Map", "fileType"),
        ("version", 2, "version"),
        ("mission", None, "mission is no object"),
        ("mission.version", 3, "mission.version"),
        ("mission.plannedHomePosition", [33.0, -117.0, 0, 0], "plannedHomePosition has 4 numbers"),
        ("mission.plannedHomePosition", [133.0, -117.0, 0], "nowhere on Earth"),
        ("mission.plannedHomePosition", [None, 8.0, 0], "nowhere on Earth"),
        ("mission.items", {}, "items is no list"),
        ("mission.items.2", 5, r"items\[2\] is no object"),
        ("mission.items.2.type", "Landing", r"items\[2\] is of type 'Landing'"),
        ("mission.items.2.params", [0] * 3, r"items\[2\].params has 3 numbers"),
        ("mission.items.2.params", [0] * 8, r"items\[2\].params has 8 numbers"),
        ("mission.items.2.params.4", "north", r"items\[2\].params is 'north'"),
        ("mission.items.3.params.4", 400.0, "out of range"),
        ("mission.items.2.params.0", True, "a number is meant"),
        ("mission.items.2.command", None, r"items\[2\].command"),
        ("mission.items.2.command", 16.5, "whole number"),
        ("mission.items.2.command", 70000, "70000"),
        ("mission.items.2.command", 177, "no item has that doJumpId"),
        ("mission.items.2.autoContinue", 1, "true or false"),
        ("mission.items.2.params.0", 10**400, "too large"),
    ],
)
def test_faults_are_named_by_their_member(path: str, value: object, says: str) -> None:
    """Each fault is told with the name of the member."""
    with pytest.raises(FormatError, match=says):
        read_plan(json.dumps(_set(document(), path, value)))


def test_what_json_cannot_say_is_refused() -> None:
    """An infinite number and a command that is no fence raise FormatError."""
    mission = encode(make_plan())
    infinite = replace(mission.mission[1], z=math.inf)
    with pytest.raises(FormatError, match="infinite"):
        write_plan(replace(mission, mission=(mission.mission[0], infinite)))
    with pytest.raises(FormatError, match="no part of a fence"):
        write_plan(replace(mission, fence=mission.mission[:1]))


def test_text_that_is_no_json_is_refused_with_the_line() -> None:
    """The JSON reader's line is passed on."""
    with pytest.raises(FormatError) as caught:
        read_plan('{\n"fileType": "Plan",\n oops')
    assert caught.value.line == 3


json_values = st.recursive(
    st.none() | st.booleans() | st.integers(-9, 9) | st.floats(allow_nan=False) | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=7) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=10,
)
PATHS = [
    "mission",
    "mission.items",
    "mission.items.2",
    "mission.items.2.params",
    "mission.items.2.params.4",
    "mission.items.2.command",
    "mission.items.2.frame",
    "mission.plannedHomePosition",
    "mission.firmwareType",
    "mission.vehicleType",
    "mission.cruiseSpeed",
    "geoFence",
    "geoFence.polygons",
    "geoFence.polygons.0",
    "geoFence.polygons.0.polygon",
    "geoFence.circles",
    "rallyPoints",
    "rallyPoints.points",
]


@given(st.sampled_from(PATHS), json_values)
@settings(max_examples=200, deadline=None)
def test_any_document_is_read_or_refused(path: str, value: object) -> None:
    """Whatever stands in any place, the answer is a mission or FormatError."""
    text = json.dumps(_set(document(), path, value))
    try:
        mission = read_plan(text)
    except FormatError:
        return
    assert all(not math.isnan(item.param1) or item.mission_type == 0 for item in mission.fence)


def test_what_was_read_can_be_written_for_another_autopilot() -> None:
    """A mission read for PX4 has no home row to lose."""
    mission = read_plan(json.dumps(document("px4")))
    again = read_plan(write_plan(replace(mission, notes=())))
    assert same(again.mission, mission.mission)
