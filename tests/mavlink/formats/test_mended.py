"""Mission files that are not of the strict form: read as other readers read them, and told."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import pytest
from pymavlink import mavwp
from pymavlink.dialects.v20 import ardupilotmega

from mavlink.formats import (
    FormatError,
    losses,
    lost_on_board,
    read_mission,
    write_plan,
    write_waypoints,
)
from mavlink.formats.columns import in_file
from mavlink.wire.items import Command, MissionItem, MissionType
from tests.mavlink.strategies import same

FAULTS = Path(__file__).parents[2] / "faults"
ROWS = [
    "0\t1\t0\t16\t0\t0\t0\t0\t47.1\t8.2\t450.123456\t1",
    "1\t0\t3\t22\t15\t0\t0\t0\t0\t0\t50\t1",
    "2\t0\t3\t16\t0\t0\t0\t0\t47.102\t8.203\t40\t1",
    "3\t0\t3\t177\t2\t3\t0\t0\t0\t0\t0\t1",
    "4\t0\t3\t16\t0\t0\t0\t0\t47.103\t8.204\t40\t1",
]
STRICT = "\n".join(["QGC WPL 110", *ROWS]) + "\n"
FENCE = [
    *(f"0\t0\t0\t5001\t3\t0\t0\t0\t{lat}\t8.2\t0\t1" for lat in (47.0, 47.2, 47.3)),
    "0\t0\t0\t5004\t80\t0\t0\t0\t47.101\t8.203\t0\t1",
]
RALLY = ["0\t0\t3\t5100\t0\t0\t0\t0\t47.1\t8.21\t30\t1"]


def fault(name: str) -> Any:
    return read_mission((FAULTS / name).read_bytes())


def values(item: Any) -> tuple[float, ...]:
    place = in_file(item) if isinstance(item, MissionItem) else (item.x, item.y)
    names = ("frame", "command", "param1", "param2", "param3", "param4", "z", "autocontinue")
    return (*(float(getattr(item, name)) for name in names), *place)


def pymavlink_items(text: str, tmp_path: Path) -> list[tuple[float, ...]]:
    """What pymavlink's loader makes of a file."""
    file = tmp_path / "file.waypoints"
    file.write_text(text)
    loader = mavwp.MAVWPLoader()
    loader.load(str(file))
    return [values(loader.wp(number)) for number in range(loader.count())]


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (STRICT.replace("\n2\t", "\n# survey\n2\t"), "line 4: the comments"),
        (STRICT.replace("\n2\t", "\n\n2\t"), "line 4: blank lines"),
        (STRICT.replace("\n2\t0\t3\t16\t", "\n 2\t0 3   16\t\t"), "line 4: tabs and blanks"),
        (STRICT.replace("\n4\t", "\n9\t"), "line 6: rows are numbered"),
        (STRICT.replace("\n0\t1\t0\t16", "\n0\t1\t0\t0"), "line 2: home has command 0"),
        (STRICT.replace("\n4\t0", "\n4\t1"), "line 6: the mark of the current item"),
    ],
)
def test_rows_are_read_as_pymavlink_reads_them(text: str, says: str, tmp_path: Path) -> None:
    """Comments, blank lines, mixed blanks, gaps in the numbers: the same items, and a note."""
    mission = read_mission(text)
    assert [values(item) for item in mission.mission] == pymavlink_items(text, tmp_path)
    assert any(note.startswith(says) for note in mission.notes)
    assert write_waypoints(mission) == write_waypoints(read_mission(STRICT))


def test_empty_columns_are_zero_as_for_qgroundcontrol() -> None:
    """Twelve columns by their tabs, some of them empty, are read with 0 in these."""
    mission = read_mission(STRICT.replace("\n2\t0\t3\t16\t0\t", "\n2\t0\t3\t16\t\t"))
    assert same(mission.mission, read_mission(STRICT).mission)
    assert any("empty columns" in note for note in mission.notes)


def test_what_is_no_utf8_is_read() -> None:
    """Comments of a Latin-1 editor, and a file of a UTF-16 one, are no reason to refuse the items."""
    latin = STRICT.replace("\n2\t", "\n# Höhe\n2\t").encode("latin-1")
    for content in (latin, STRICT.encode("utf-16")):
        assert same(read_mission(content).mission, read_mission(STRICT).mission)
    with pytest.raises(FormatError, match="no text"):
        read_mission(b"\x1f\x8b\x00\x01")


def test_no_home_row_loses_no_item() -> None:
    """A list that begins with its take-off keeps it; jumps lead to the same items for both autopilots."""
    for autopilot, ahead in (("px4", 0), ("ardupilot", 1)):
        mission = read_mission((FAULTS / "06-px4-no-home-row.waypoints").read_text(), autopilot)
        commands = [int(item.command) for item in mission.mission]
        assert commands == [16] * ahead + [22, 16, 177]
        assert mission.mission[-1].param1 == 1.0 + ahead
        assert mission.home == (8.2, 47.1)
        assert any("no home row" in note for note in mission.notes)


def test_version_120_has_no_home_row() -> None:
    """Its first row is the first item, a waypoint too."""
    text = "\n".join(["QGC WPL 120", *ROWS[2:3]])
    assert [item.x for item in read_mission(text, "px4").mission] == [471020000]
    assert [item.x for item in read_mission(text).mission] == [471020000, 471020000]


def test_version_100_is_read_as_pymavlink_reads_it(tmp_path: Path) -> None:
    """Other columns, longitude first, and commands of their own."""
    rows = ("0 3 25 1 2 3 4 1 8.2 47.1 50 0 1", "1 3 24 0 0 0 0 0 8.2 47.1 9 0 1")
    text = "\n".join(["QGC WPL 100", *rows])
    items = read_mission(text, "px4").mission
    assert [values(item) for item in items] == pymavlink_items(text, tmp_path)


def test_lists_of_a_mixed_file_are_told_apart() -> None:
    """Fence and rally rows between those of the mission become lists of their own; jumps follow."""
    text = "\n".join(["QGC WPL 110", ROWS[0], *FENCE[:3], *ROWS[1:3], FENCE[3], *RALLY])
    jump = "9\t0\t3\t177\t{}\t1\t0\t0\t0\t0\t0\t1"
    mission = read_mission(f"{text}\n{jump.format(5)}\n")
    assert [int(item.command) for item in mission.mission] == [16, 22, 16, 177]
    assert mission.mission[-1].param1 == 2.0
    assert [int(item.command) for item in mission.fence] == [5001, 5001, 5001, 5004]
    assert {item.mission_type for item in mission.fence} == {MissionType.FENCE}
    assert [int(item.command) for item in mission.rally] == [5100]
    with pytest.raises(FormatError, match="which is no item of the mission"):
        read_mission(f"{text}\n{jump.format(2)}\n")


def test_a_fence_file_is_a_fence_and_stays_one() -> None:
    """A file of fence rows under a home row, as Mission Planner keeps them, has no mission to fly."""
    mission = fault("04-fence-file.waypoints")
    assert (len(mission.mission), len(mission.fence)) == (1, 5)
    again = read_mission(write_waypoints(mission))
    assert same(again.fence, mission.fence)
    plan = json.loads(write_plan(mission))
    assert (len(plan["geoFence"]["polygons"]), len(plan["geoFence"]["circles"])) == (1, 1)
    assert plan["mission"]["items"] == []


def test_parts_of_a_fence_that_are_no_shapes_are_told_and_marked() -> None:
    """A circle without a radius and a polygon of two corners fence nothing: the fence is not read whole."""
    flat = FENCE[3].replace("\t80\t", "\t0\t")
    for rows in ([flat], FENCE[:2]):
        mission = read_mission("\n".join(["QGC WPL 110", ROWS[0], *rows]))
        assert mission.unread == {MissionType.FENCE}
        assert any("no shape" in note for note in mission.notes)
    assert not read_mission("\n".join(["QGC WPL 110", ROWS[0], *FENCE])).unread


def test_point_lists_are_read_as_pymavlink_reads_them(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A fence of latitudes and longitudes, and RALLY lines, give the items that pymavlink's loaders make."""
    pairs = [(47.1, 8.2), (47.0, 8.1), (47.2, 8.1), (47.2, 8.3), (47.0, 8.1)]
    text = "# return first\n" + "".join(f"{lat:.6f}\t{lon:.6f}\n" for lat, lon in pairs)
    mission = read_mission(text)
    assert [int(item.command) for item in mission.fence] == [5000, 5001, 5001, 5001]
    monkeypatch.setattr(mavwp.mavutil, "mavlink20", lambda: True)
    monkeypatch.setattr(mavwp.mavutil, "mavlink", ardupilotmega)
    for name, content, loader, items in (
        ("fence", text, mavwp.MissionItemProtocol_Fence(), mission.fence),
        (
            "rally",
            "RALLY 40.071553\t-105.229401\t25.0\t0.0\t0.0\t0\n",
            mavwp.MissionItemProtocol_Rally(),
            read_mission("RALLY 40.071553\t-105.229401\t25.0\t0.0\t0.0\t0\n").rally,
        ),
    ):
        file = tmp_path / f"{name}.txt"
        file.write_text(content)
        loader.load(str(file))
        assert loader.count() == len(items)
        for item, read in zip(items, loader.wpoints, strict=True):
            assert (item.command, item.param1) == (read.command, read.param1)
            # pymavlink cuts where we round
            assert abs(item.x - read.x) <= 1 >= abs(item.y - read.y)
    with pytest.raises(FormatError, match="line 2"):
        read_mission("47.1 8.2\n47.2 north\n")


def test_an_old_or_odd_fence_does_not_stop_the_mission() -> None:
    """What cannot be read is left out, told, and marked; the rest of the fence stays."""
    assert len(fault("03-geofence-version-1.plan").mission) == 3
    document = json.loads((FAULTS / "03-geofence-version-1.plan").read_text())
    circle = {"version": 1, "inclusion": False, "circle": {"center": [47.1, 8.2], "radius": 50}}
    corners = [[47.0, 8.1], [47.2, 8.1], [47.2, 8.3]]
    for block, count, whole in (
        ({"version": 1, "polygon": corners}, 3, True),
        ({"version": 2, "polygons": [], "circles": []}, 0, True),
        ({"polygons": None, "circles": [circle]}, 1, True),
        ({"version": 2, "polygons": [{"polygon": corners[:2]}], "circles": [circle]}, 1, False),
        ({"version": 2, "polygons": [{"polygon": corners, "inclusion": "no"}]}, 0, False),
        ({"version": 2, "circles": {"radius": 5}}, 0, False),
        ([], 0, False),
        (None, 0, True),
    ):
        mission = read_mission(json.dumps({**document, "geoFence": block, "rallyPoints": [1]}))
        assert len(mission.mission) == 3
        assert len(mission.fence) == count
        assert (MissionType.FENCE not in mission.unread) == whole
        assert MissionType.RALLY in mission.unread
        assert whole or any("left out" in note for note in mission.notes)


def test_repeated_numbers_stop_only_the_jumps_that_lead_to_them() -> None:
    """A doJumpId that stands thrice is told; a jump there is refused."""
    assert [item.seq for item in fault("07-same-jump-id-no-jump.plan").mission] == [0, 1, 2, 3]
    document = json.loads((FAULTS / "07-same-jump-id-no-jump.plan").read_text())
    jump = {"type": "SimpleItem", "command": 177, "frame": 2, "params": [1, 2, 0, 0, 0, 0, 0]}
    document["mission"]["items"].append(jump)
    with pytest.raises(FormatError, match="that doJumpId stands twice"):
        read_mission(json.dumps(document))


def old_item(number: int, place: list[float], command: int = 16) -> dict[str, Any]:
    params = {f"param{n}": float(n) for n in range(1, 5)}
    rest = {"autoContinue": True, "coordinate": place, "id": number, "type": "missionItem"}
    return {"command": command, "frame": 3, **params, **rest}


def test_missions_of_version_1_are_read() -> None:
    """The oldest JSON: home as an item, parameters one by one, jumps by the items' ids."""
    document = {
        "MAV_AUTOPILOT": 12,
        "complexItems": [],
        "groundStation": "QGroundControl",
        "items": [
            old_item(1, [47.1, 8.2, 30.0], 22),
            old_item(2, [47.2, 8.3, 40.0]),
            {**old_item(3, [0.0, 0.0, 0.0], 177), "frame": 2},
        ],
        "plannedHomePosition": {**old_item(0, [47.0, 8.1, 420.5]), "frame": 0},
        "version": "1.0",
    }
    mission = read_mission(json.dumps(document))
    assert (mission.autopilot, mission.home, mission.home_altitude_m) == ("px4", (8.1, 47.0), 420.5)
    assert [int(item.command) for item in mission.mission] == [22, 16, 177]
    assert values(mission.mission[1]) == (3, 16, 1, 2, 3, 4, 40.0, 1, 47.2, 8.3)
    assert mission.mission[2].param1 == 0.0
    document["complexItems"] = [{"type": "survey", "id": 2}]
    with pytest.raises(FormatError, match="complexItems"):
        read_mission(json.dumps(document))


def test_missions_of_version_2_are_read() -> None:
    """A .mission file is the member of a .plan by itself; items may have 4 params and a coordinate."""
    whole = json.loads((FAULTS / "07-same-jump-id-no-jump.plan").read_text())
    inner = whole["mission"]
    bare = {**inner, "fileType": "Mission", "groundStation": "QGroundControl"}
    expected = read_mission(json.dumps(whole)).mission
    assert same(read_mission(json.dumps(bare)).mission, expected)
    for item in inner["items"]:
        item["coordinate"] = item["params"][4:]
        item["params"] = item["params"][:4]
    mission = read_mission(json.dumps(whole))
    assert same(mission.mission, expected)
    assert any("the old way" in note for note in mission.notes)


def test_a_plan_without_home_or_autopilot_is_read() -> None:
    """Nobody's firmware is read as PX4's; home is at the first place; both are told."""
    document = json.loads((FAULTS / "07-same-jump-id-no-jump.plan").read_text())
    document["mission"]["firmwareType"] = 4
    for home in (None, [47.5, 8.5], [None, None, None]):
        document["mission"]["plannedHomePosition"] = home
        mission = read_mission(json.dumps(document))
        assert mission.home == ((8.5, 47.5) if home == [47.5, 8.5] else (8.202, 47.101))
        assert any("plannedHomePosition" in note for note in mission.notes)
        assert any("firmwareType 4" in note for note in mission.notes)


def test_a_place_in_a_frame_without_degrees_is_kept() -> None:
    """Of a .plan's DO_LAND_START in frame 2 files lose no digit, and what the vehicle loses is told."""
    mission = fault("08-land-start-mission-frame.plan")
    again = read_mission(write_waypoints(mission), "px4")
    assert in_file(again.mission[1]) == (47.39697211, 8.54505336)
    assert json.loads(write_plan(again))["mission"]["items"][1]["params"][4:6] == [47.39697211, 8.54505336]
    assert any(note.startswith("item 1: 47.3969721") and "47, 9" in note for note in losses(mission, "plan"))


def test_open_parameters_are_closed_for_ardupilot_and_told() -> None:
    """No nan in ArduPilot's .waypoints; the .plan keeps its null."""
    mission = fault("09-null-yaw-ardupilot.plan")
    assert "nan" not in write_waypoints(mission)
    assert any(note.startswith("items 1–3: param 4 is open") for note in losses(mission, "waypoints"))
    items = json.loads(write_plan(mission))["mission"]["items"]
    assert [item["params"][3] for item in items] == [None, None, None]


def test_a_landing_pattern_keeps_its_approach_speed() -> None:
    """DO_CHANGE_SPEED stands behind DO_LAND_START: airspeed, the throttle unchanged."""
    items = fault("landing-speed.plan").mission
    place = next(n for n, item in enumerate(items) if item.command == Command.DO_LAND_START)
    speed = items[place + 1]
    assert speed.command == Command.DO_CHANGE_SPEED
    assert (speed.param1, speed.param2, speed.param3) == (0.0, 9.0, -1.0)


def test_what_a_file_says_of_its_vehicle_is_kept_and_nothing_invented() -> None:
    """Both speeds, the exact type, home's digits stay; a .waypoints file gives no speed and no type."""
    document = json.loads((FAULTS / "03-geofence-version-1.plan").read_text())
    mission = document["mission"]
    mission |= {"hoverSpeed": 4.5, "cruiseSpeed": 17.25, "vehicleType": 13, "globalPlanAltitudeMode": 4}
    home = [47.123456789012, 8.2, 450.123456789]
    mission["plannedHomePosition"] = home
    written = json.loads(write_plan(read_mission(json.dumps(document))))["mission"]
    for name in ("hoverSpeed", "cruiseSpeed", "vehicleType", "firmwareType", "globalPlanAltitudeMode"):
        assert written[name] == mission[name]
    assert written["plannedHomePosition"] == home
    from_rows = json.loads(write_plan(read_mission(STRICT)))["mission"]
    assert from_rows["plannedHomePosition"] == [47.1, 8.2, 450.123456]
    assert not {"hoverSpeed", "cruiseSpeed", "vehicleType"} & from_rows.keys()
    told = json.loads(write_plan(read_mission(STRICT, vehicle_type="multirotor")))["mission"]
    assert told["vehicleType"] == 2
    assert any("--type" in note for note in read_mission(STRICT).notes)


def test_numbers_that_are_no_place_are_written_in_a_frame_without_degrees() -> None:
    """ArduPilot gives a gimbal's flags back in frame 0: neither file scales them, and both say so."""
    flags = "3\t0\t0\t1000\t-45\t0\t0\t0\t0.0000012\t0\t7\t1"
    for row in (flags, flags.replace("0.0000012", "12")):
        mission = read_mission("\n".join(["QGC WPL 110", *ROWS[:3], row]))
        assert mission.mission[3].x == 12
        assert write_waypoints(mission).splitlines()[-1].split("\t")[8] == "12"
        assert json.loads(write_plan(mission))["mission"]["items"][2]["params"][4:] == [12, 0, 7.0]
        assert any(note.startswith("item 3: the numbers of command 1000") for note in losses(mission, "plan"))


def test_what_the_vehicle_keeps_otherwise_is_told_by_item() -> None:
    """ArduPlane's waypoints keep no hold time, PX4's no pass-by radius; a centimetre is no loss."""
    text = STRICT.replace("\t0\t0\t0\t0\t47.102", "\t2.5\t0\t7\t0\t47.102").replace("\t40\t", "\t40.129\t")
    told = lost_on_board(read_mission(text, "ardupilot"))
    assert told == ("item 2: param 1 is 2.5, ArduPlane keeps 0",)
    assert "item 1: param 3 is 7, PX4 fixed wing keeps 0" in lost_on_board(read_mission(text, "px4"))
    assert lost_on_board(read_mission(STRICT)) == ()


def test_open_places_stay_open() -> None:
    """A take-off whose place is null is null again, and 0 on the wire."""
    document = json.loads((FAULTS / "03-geofence-version-1.plan").read_text())
    document["mission"]["items"][0]["params"][4:6] = [None, None]
    mission = read_mission(json.dumps(document))
    assert (mission.mission[1].x, mission.mission[1].y) == (0, 0)
    assert json.loads(write_plan(mission))["mission"]["items"][0]["params"][4:6] == [None, None]
    assert any(math.isnan(value) for value in in_file(mission.mission[1]))
