"""QGroundControl's complex items, laid out as the items that it would send."""

from __future__ import annotations

import json
import math
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pyproj import Geod
from shapely.geometry import Polygon

from mavlink.dialects.mission import Mission
from mavlink.formats import FormatError, read_plan, write_plan
from mavlink.wire.items import Command, Frame, MissionItem
from tests.mavlink.strategies import same

WGS84 = Geod(ellps="WGS84")
HOME = [47.3977, 8.5456, 488.0]


def simple(command: int, lat_deg: float, lon_deg: float, altitude_m: float, number: int) -> dict[str, Any]:
    return {
        "AMSLAltAboveTerrain": None,
        "Altitude": altitude_m,
        "AltitudeMode": 1,
        "autoContinue": True,
        "command": command,
        "doJumpId": number,
        "frame": 3,
        "params": [0, 0, 0, None, lat_deg, lon_deg, altitude_m],
        "type": "SimpleItem",
    }


def trigger(distance_m: float, number: int) -> dict[str, Any]:
    return {
        "autoContinue": True,
        "command": 206,
        "doJumpId": number,
        "frame": 2,
        "params": [distance_m, 0, 1, 0, 0, 0, 0],
        "type": "SimpleItem",
    }


CAMERA = {
    "AdjustedFootprintFrontal": 20.0,
    "AdjustedFootprintSide": 25.0,
    "CameraName": "Manual (no camera specs)",
    "DistanceMode": 1,
    "DistanceToSurface": 30.0,
    "version": 2,
}
TRANSECTS = [
    simple(16, 47.3980, 8.5460, 50, 2),
    trigger(25.0, 3),
    simple(16, 47.3990, 8.5460, 50, 4),
    trigger(0.0, 5),
    simple(16, 47.3990, 8.5465, 50, 6),
    trigger(25.0, 7),
    simple(16, 47.3980, 8.5465, 50, 8),
    trigger(0.0, 9),
]
SURVEY = {
    "TransectStyleComplexItem": {
        "CameraCalc": CAMERA,
        "CameraShots": 10,
        "FollowTerrain": False,
        "HoverAndCapture": False,
        "Items": TRANSECTS,
        "Refly90Degrees": False,
        "TurnAroundDistance": 10,
        "VisualTransectPoints": [[47.398, 8.546], [47.399, 8.546]],
        "version": 2,
    },
    "angle": 0,
    "complexItemType": "survey",
    "entryLocation": 0,
    "flyAlternateTransects": False,
    "polygon": [[47.398, 8.546], [47.399, 8.546], [47.399, 8.5465]],
    "splitConcavePolygons": False,
    "type": "ComplexItem",
    "version": 5,
}
CORRIDOR = {
    "CorridorWidth": 50,
    "EntryPoint": 0,
    "TransectStyleComplexItem": SURVEY["TransectStyleComplexItem"],
    "complexItemType": "CorridorScan",
    "polyline": [[47.398, 8.546], [47.399, 8.546]],
    "type": "ComplexItem",
    "version": 2,
}
STRUCTURE = {
    "CameraCalc": CAMERA,
    "EntranceAltitude": 60.0,
    "GimbalPitch": -10,
    "Layers": 2,
    "ScanBottomAlt": 5.0,
    "StartFromTop": False,
    "StructureHeight": 45.0,
    "complexItemType": "StructureScan",
    "polygon": [[47.3980, 8.5460], [47.3990, 8.5460], [47.3990, 8.5480], [47.3980, 8.5480]],
    "type": "ComplexItem",
    "version": 3,
}
LANDING = {
    "altitudesAreRelative": True,
    "complexItemType": "fwLandingPattern",
    "landCoordinate": [47.3977, 8.5456, 0.0],
    "landingApproachCoordinate": [47.3950, 8.5400, 40.0],
    "loiterClockwise": False,
    "loiterRadius": 75.0,
    "stopTakingPhotos": True,
    "stopVideoPhotos": True,
    "type": "ComplexItem",
    "useLoiterToAlt": True,
    "valueSetIsDistance": False,
    "version": 2,
}
VTOL_LANDING = {
    key: value for key, value in LANDING.items() if key not in ("valueSetIsDistance", "stopVideoPhotos")
} | {"complexItemType": "vtolLandingPattern", "version": 1, "stopTakingPhotos": False}


def plan_of(*items: dict[str, Any], firmware: int = 12) -> dict[str, Any]:
    return {
        "fileType": "Plan",
        "geoFence": {
            "circles": [{"circle": {"center": HOME[:2], "radius": 900.0}, "inclusion": True, "version": 1}],
            "polygons": [
                {
                    "inclusion": False,
                    "polygon": [[47.396, 8.54], [47.397, 8.54], [47.397, 8.541]],
                    "version": 1,
                }
            ],
            "version": 2,
        },
        "groundStation": "QGroundControl",
        "mission": {
            "cruiseSpeed": 15,
            "firmwareType": firmware,
            "globalPlanAltitudeMode": 1,
            "hoverSpeed": 5,
            "items": list(items),
            "plannedHomePosition": HOME,
            "vehicleType": 1,
            "version": 2,
        },
        "rallyPoints": {"points": [[47.3977, 8.5466, 50.0]], "version": 2},
        "version": 1,
    }


def read(*items: dict[str, Any], firmware: int = 12) -> Mission:
    return read_plan(json.dumps(plan_of(*items, firmware=firmware)))


def commands(items: tuple[MissionItem, ...]) -> list[int]:
    return [int(item.command) for item in items]


@pytest.mark.parametrize("complex_item", [SURVEY, CORRIDOR])
def test_scans_are_the_items_they_hold(complex_item: dict[str, Any]) -> None:
    """A survey and a corridor scan read like their simple items standing in the list themselves."""
    take_off = simple(22, 47.3977, 8.5456, 50, 1)
    assert same(read(take_off, complex_item).mission, read(take_off, *TRANSECTS).mission)


def test_stale_numbers_inside_a_scan_do_not_matter() -> None:
    """Two scans may hold the same numbers; a jump goes to the simple item that bears the number."""
    jump = {"type": "SimpleItem", "command": 177, "doJumpId": 30, "frame": 2, "params": [2, 1, 0, 0, 0, 0, 0]}
    mission = read(simple(22, 47.3977, 8.5456, 50, 1), SURVEY, SURVEY, simple(16, 47.4, 8.5, 50, 2), jump)
    assert mission.mission[-1].param1 == len(mission.mission) - 2


def test_a_jump_inside_a_scan_is_refused() -> None:
    """What a jump inside would lead to cannot be known."""
    jump = {"type": "SimpleItem", "command": 177, "doJumpId": 30, "frame": 2, "params": [2, 1, 0, 0, 0, 0, 0]}
    broken = SURVEY | {"TransectStyleComplexItem": {"Items": [jump]}}
    with pytest.raises(FormatError, match=r"items\[0\].TransectStyleComplexItem.Items\[0\] jumps"):
        read(broken)


def test_a_landing_pattern_is_start_stops_loiter_and_land() -> None:
    """A fixed-wing pattern becomes the items that QGroundControl's guide names, in its order."""
    items = read(LANDING).mission
    assert commands(items) == [
        Command.DO_LAND_START,
        Command.DO_SET_CAM_TRIGG_DIST,
        Command.IMAGE_STOP_CAPTURE,
        Command.VIDEO_STOP_CAPTURE,
        Command.NAV_LOITER_TO_ALT,
        Command.NAV_LAND,
    ]
    loiter, land = items[-2:]
    assert (loiter.param1, loiter.param2, loiter.param4, loiter.z) == (1.0, -75.0, 1.0, 40.0)
    assert (loiter.x, loiter.y, loiter.frame) == (473950000, 85400000, Frame.GLOBAL_RELATIVE_ALT)
    assert (land.x, land.y, land.z) == (473977000, 85456000, 0.0)


def test_a_landing_pattern_without_a_loiter_has_a_waypoint() -> None:
    """Without loiter the final approach is a waypoint, at altitudes over the sea where the file says so."""
    items = read(LANDING | {"useLoiterToAlt": False, "altitudesAreRelative": False}).mission
    assert (items[-2].command, items[-2].frame) == (Command.NAV_WAYPOINT, Frame.GLOBAL)
    assert math.isnan(items[-2].param4)


def test_old_landing_patterns_are_read() -> None:
    """Version 1 has another name for the approach, says twice what the altitudes count from, and loiters."""
    old = {key: LANDING[key] for key in ("type", "complexItemType", "landCoordinate", "loiterRadius")}
    old |= {"loiterClockwise": True, "loiterCoordinate": LANDING["landingApproachCoordinate"], "version": 1}
    old |= {"loiterAltitudeRelative": True, "landAltitudeRelative": True}
    items = read(old).mission
    assert commands(items) == [Command.DO_LAND_START, Command.NAV_LOITER_TO_ALT, Command.NAV_LAND]
    assert items[1].param2 == 75.0


def test_a_vtol_pattern_lands_upright() -> None:
    """The VTOL pattern ends with VTOL_LAND at any yaw."""
    items = read(VTOL_LANDING).mission
    assert commands(items) == [Command.DO_LAND_START, Command.NAV_LOITER_TO_ALT, Command.NAV_VTOL_LAND]
    assert math.isnan(items[-1].param4)


def test_ardupilot_gets_no_nan_that_it_refuses() -> None:
    """The dialect of ArduPilot finds nothing wrong with the camera items of a landing pattern."""
    mission = read(simple(22, 47.3977, 8.5456, 50, 1), LANDING, firmware=3)
    assert commands(mission.mission)[:2] == [Command.NAV_WAYPOINT, Command.NAV_TAKEOFF]
    stop = next(item for item in mission.mission if item.command == Command.IMAGE_STOP_CAPTURE)
    assert not any(math.isnan(value) for value in (stop.param2, stop.param3, stop.param4))


@pytest.mark.parametrize("from_top", [False, True])
@pytest.mark.parametrize("turned", [False, True])
def test_a_structure_is_flown_round_layer_by_layer(from_top: bool, turned: bool) -> None:
    """Every round stands off by the camera's distance, closes, and triggers; layers are a footprint apart."""
    outline = STRUCTURE["polygon"][::-1] if turned else STRUCTURE["polygon"]
    items = read(STRUCTURE | {"StartFromTop": from_top, "polygon": outline}).mission
    corners = 4
    # entrance and exit, look and look away, and in each layer a closed round with trigger on and off
    assert len(items) == 2 + 2 + 2 * (corners + 1 + 2)
    assert commands(items)[:2] == [Command.NAV_WAYPOINT, Command.DO_SET_ROI_WPNEXT_OFFSET]
    assert commands(items)[-2:] == [Command.DO_SET_ROI_NONE, Command.NAV_WAYPOINT]
    assert (items[0].z, items[-1].z) == (60.0, 60.0)
    assert (items[1].x, items[1].z) == (-10, 90.0)
    layers = [items[2:9], items[9:16]]
    heights = [{item.z for item in layer if item.command == Command.NAV_WAYPOINT} for layer in layers]
    assert heights == ([{35.0}, {15.0}] if from_top else [{15.0}, {35.0}])
    for layer in layers:
        assert [item.param1 for item in layer if item.command == 206] == [25.0, 0.0]
        round_ = [(item.y / 1e7, item.x / 1e7) for item in layer if item.command == Command.NAV_WAYPOINT]
        assert round_[0] == round_[-1]
        structure = Polygon([(lon, lat) for lat, lon in outline])
        assert Polygon(round_).contains(structure)
        for place, (lat, lon) in zip(round_, outline, strict=False):
            # at a right angle the mitre stands off by the distance on either side
            assert WGS84.inv(lon, lat, *place)[2] == pytest.approx(30.0 * math.sqrt(2.0), abs=0.05)


def test_what_was_made_is_said() -> None:
    """The notes tell which items are not the file's own."""
    notes = read(simple(22, 47.3977, 8.5456, 50, 1), SURVEY, STRUCTURE, LANDING).notes
    assert [note for note in notes if "StructureScan" in note]
    assert [note for note in notes if "fwLandingPattern" in note]
    assert not [note for note in notes if "survey" in note]


def test_a_mixed_plan_can_be_written_again() -> None:
    """Take-off, all kinds of complex items, fence and rally points survive a round through the file."""
    mission = read(simple(22, 47.3977, 8.5456, 50, 1), SURVEY, CORRIDOR, STRUCTURE, LANDING)
    again = read_plan(write_plan(mission))
    assert len(mission.mission) == 1 + 8 + 8 + 18 + 6
    assert same(again.mission, mission.mission)
    assert same(again.fence, mission.fence)
    assert (len(mission.fence), len(mission.rally)) == (4, 1)


@pytest.mark.parametrize(
    ("item", "says"),
    [
        (LANDING | {"version": 3}, "version is 3"),
        (LANDING | {"landCoordinate": [47.4, 8.5]}, "landCoordinate has 2 numbers"),
        (LANDING | {"landCoordinate": [47.4, 8.5, None]}, "has no altitude"),
        (LANDING | {"landCoordinate": [147.4, 8.5, 0]}, "swapped"),
        (LANDING | {"loiterRadius": 0}, "loiterRadius is 0"),
        (LANDING | {"loiterClockwise": 1}, "loiterClockwise is 1"),
        (VTOL_LANDING | {"version": 2}, "version is 2"),
        (STRUCTURE | {"version": 2}, "version is 2, 3 is meant"),
        (STRUCTURE | {"CameraCalc": None}, "CameraCalc is no object"),
        (STRUCTURE | {"Layers": 0}, "Layers is 0"),
        (STRUCTURE | {"polygon": [[47.0, 8.0], [47.1, 8.1]]}, "has 2 corners"),
        (
            STRUCTURE | {"polygon": [[47.0, 8.0], [47.01, 8.01], [47.0, 8.01], [47.01, 8.0]]},
            "no simple polygon",
        ),
        (STRUCTURE | {"polygon": [[0.0, 0.0], [80.0, 120.0], [-80.0, 170.0]]}, "larger than 10 km"),
        (STRUCTURE | {"EntranceAltitude": None}, "EntranceAltitude is nan"),
        (SURVEY | {"TransectStyleComplexItem": {}}, "save it again"),
        (SURVEY | {"TransectStyleComplexItem": {"Items": [SURVEY]}}, "a SimpleItem is meant"),
        ({"type": "ComplexItem", "complexItemType": "orbit"}, "'orbit', which holds no items"),
        ({"type": "ComplexItem", "complexItemType": []}, "holds no items"),
    ],
)
def test_faults_of_complex_items_are_named(item: dict[str, Any], says: str) -> None:
    """Each fault is told with the name of the member."""
    with pytest.raises(FormatError, match=says):
        read(item)


KINDS = (SURVEY, CORRIDOR, STRUCTURE, LANDING, VTOL_LANDING)
values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text(max_size=4),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=4), inner, max_size=2),
    max_leaves=6,
)


@given(
    st.sampled_from(KINDS).flatmap(lambda kind: st.tuples(st.just(kind), st.sampled_from(sorted(kind)))),
    values,
)
@settings(max_examples=200, deadline=None)
def test_any_member_may_be_anything(chosen: tuple[dict[str, Any], str], value: object) -> None:
    """Whatever stands in any member of a complex item, the answer is a mission or FormatError."""
    kind, member = chosen
    try:
        mission = read(kind | {member: value})
    except FormatError:
        return
    assert all(abs(item.x) <= 2**31 - 1 and abs(item.y) <= 2**31 - 1 for item in mission.mission)
