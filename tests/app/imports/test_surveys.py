"""Surveys of QGroundControl become regions that ask for what their own items do."""

from __future__ import annotations

import copy
import json
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.imports import import_regions
from planner.geojson import read_scenario
from tests.mavlink.formats.test_qgc_complex import CORRIDOR, STRUCTURE, SURVEY, plan_of

#: As QGroundControl wrote it for a double camera: what it made of chip, lens and overlaps stands beside.
SENTERA = {
    "AdjustedFootprintFrontal": 41.99466666666667,
    "AdjustedFootprintSide": 83.98933333333333,
    "CameraName": "Sentera Double 4K",
    "DistanceToSurface": 121.92,
    "DistanceToSurfaceRelative": True,
    "FixedOrientation": True,
    "FocalLength": 5.4,
    "FrontalOverlap": 60,
    "ImageDensity": 3.4995555555555553,
    "ImageHeight": 3000,
    "ImageWidth": 4000,
    "Landscape": True,
    "MinTriggerInterval": 0.8,
    "SensorHeight": 4.65,
    "SensorWidth": 6.2,
    "SideOverlap": 40,
    "ValueSetIsDistance": True,
    "version": 1,
}
VEHICLE = {"name": "uav", "type": "multirotor", "airspeed_m_s": 10.0}


def with_camera(entry: dict[str, Any], camera: dict[str, Any], **more: Any) -> dict[str, Any]:
    """A complex item with another camera and other members."""
    made = copy.deepcopy(entry) | more
    (made if "CameraCalc" in made else made["TransectStyleComplexItem"])["CameraCalc"] = camera
    return made


def imported(*entries: dict[str, Any]) -> tuple[dict[str, Any], dict[str, Any], tuple[str, ...]]:
    """The collection, its features by name, and the notes."""
    found = import_regions(json.dumps(plan_of(*entries)).encode())
    return found.collection, {each["id"]: each for each in found.collection["features"]}, found.notes


def test_camera_and_overlaps_give_the_footprints_that_qgroundcontrol_reckons() -> None:
    """Pixel and spacings by the imported sensor are those in the file; the planner takes the scenario."""
    collection, regions, notes = imported(with_camera(SURVEY, SENTERA, angle=30))
    (sensor,) = collection["sensors"]
    properties = regions["survey 1"]["properties"]
    gsd_m = properties["altitude_m"] * sensor["pixel_pitch_m"] / sensor["focal_length_m"]
    assert 100.0 * gsd_m == pytest.approx(SENTERA["ImageDensity"])
    across, along = sensor["image_px"]
    assert (1.0 - sensor["side_overlap"]) * across * gsd_m == pytest.approx(SENTERA["AdjustedFootprintSide"])
    assert (1.0 - sensor["forward_overlap"]) * along * gsd_m == pytest.approx(
        SENTERA["AdjustedFootprintFrontal"]
    )
    assert (sensor["edge_overlap"], sensor["min_interval_s"]) == (False, 0.8)
    assert properties["approach_deg"] == [30.0, 210.0]
    assert properties["sensor"] == sensor["name"] == "Sentera Double 4K"
    assert collection["altitude_reference"] == "home"
    assert regions["home"]["properties"]["role"] == "start"
    assert any("headings 30° and 210°" in note and "not order" in note for note in notes)
    scenario = read_scenario(collection | {"vehicles": [VEHICLE]})
    assert [region.name for region in scenario.regions] == ["survey 1"]


def test_of_a_portrait_camera_the_short_side_lies_across() -> None:
    """Turned by 90 degrees the image's height is what lies across the lanes, as the footprint tells."""
    collection, _, _ = imported(with_camera(SURVEY, SENTERA | {"Landscape": False}))
    assert collection["sensors"][0]["image_px"] == [3000, 4000]


def test_where_the_pixel_was_set_the_region_asks_for_it() -> None:
    """A height that followed from the pixel is not taken over, the pixel is."""
    _, regions, _ = imported(with_camera(SURVEY, SENTERA | {"ValueSetIsDistance": False}))
    properties = regions["survey 1"]["properties"]
    assert properties["gsd_m"] == pytest.approx(0.034995556)
    assert "altitude_m" not in properties


@pytest.mark.parametrize(
    ("camera", "reference"),
    [
        ({"DistanceToSurfaceRelative": False}, "amsl"),
        ({"DistanceMode": 1}, "home"),
        ({"DistanceMode": 2}, "amsl"),
        ({"DistanceMode": 3}, "terrain"),
        ({"DistanceMode": 4}, "terrain"),
    ],
)
def test_heights_keep_what_they_count_over(camera: dict[str, Any], reference: str) -> None:
    """Each of QGroundControl's modes of height is said as the contract says it."""
    collection, _, _ = imported(with_camera(SURVEY, SENTERA | camera))
    assert collection["altitude_reference"] == reference


def test_a_height_over_something_else_is_left_out_and_told() -> None:
    """A collection has one reference: the second survey's height is not taken for one over the first's."""
    collection, regions, notes = imported(
        with_camera(SURVEY, SENTERA), with_camera(SURVEY, SENTERA | {"DistanceMode": 2})
    )
    assert collection["altitude_reference"] == "home"
    assert "altitude_m" not in regions["survey 2"]["properties"]
    assert any("survey 2" in note and "above the sea" in note for note in notes)
    assert len(collection["sensors"]) == 1


def test_corridors_and_structures_are_regions_of_their_kinds() -> None:
    """A corridor keeps its line and width; a structure is gone round with the tilt of its gimbal."""
    collection, regions, _ = imported(
        with_camera(CORRIDOR, SENTERA), with_camera(STRUCTURE, SENTERA, GimbalPitch=-40)
    )
    corridor, structure = regions["corridor scan 1"], regions["structure scan 1"]
    assert corridor["geometry"]["type"] == "LineString"
    assert corridor["properties"]["width_m"] == CORRIDOR["CorridorWidth"]
    assert structure["properties"]["pattern"] == "orbit"
    cameras = {sensor["name"]: sensor for sensor in collection["sensors"]}
    assert cameras[structure["properties"]["sensor"]]["tilt_deg"] == 50.0
    assert "tilt_deg" not in cameras[corridor["properties"]["sensor"]]


def test_without_a_lens_no_camera_is_made_up() -> None:
    """Of a survey by footprints alone the outline is taken, and the note says that a camera is wanted."""
    collection, regions, notes = imported(SURVEY)
    assert "sensors" not in collection
    assert "sensor" not in regions["survey 1"]["properties"]
    assert any("No camera is known" in note for note in notes)


CALC = {
    key: st.one_of(st.just(value), st.sampled_from([None, "x", -1.0, 0, 1e308, [], {}, True]))
    for key, value in SENTERA.items()
}


@settings(max_examples=60, deadline=None)
@given(st.fixed_dictionaries(CALC))
def test_whatever_a_survey_holds_the_others_are_read(camera: dict[str, Any]) -> None:
    """A survey that cannot be read is found by its name, and refuses no other."""
    found = import_regions(json.dumps(plan_of(with_camera(SURVEY, camera), CORRIDOR)).encode())
    names = [each["id"] for each in found.collection["features"]]
    assert "corridor scan 1" in names
    assert ("survey 1" in names) != any(finding.feature == "survey 1" for finding in found.left_out)
