"""What is said of areas too small, and overlaps of less than half: held against the plans themselves."""

from __future__ import annotations

import math
import re
from typing import Any

import pytest
from shapely import union_all
from shapely.affinity import rotate, translate
from shapely.geometry import Polygon
from shapely.geometry import box as shapely_box

from planner.errors import InfeasibleError, ScenarioError
from planner.frames import LocalFrame
from planner.geojson import read_scenario
from planner.pipeline import make_plan

FRAME = LocalFrame(9.7, 47.05)
EYE = {"name": "c", "type": "camera", "focal_length_m": 0.02, "pixel_pitch_m": 4e-6, "image_px": [6000, 4000]}


def box(west: float, south: float, east: float, north: float) -> dict[str, Any]:
    corners = [(west, south), (east, south), (east, north), (west, north), (west, south)]
    return {"type": "Polygon", "coordinates": [[list(FRAME.to_wgs84(corner)) for corner in corners]]}


def field(room_m: float | None, eye: dict[str, Any] | None = None, **vehicle: Any) -> dict[str, Any]:
    """300 by 200 m, with so much room round it, where given."""
    features = [
        {
            "type": "Feature",
            "id": "a",
            "geometry": box(0.0, 0.0, 300.0, 200.0),
            "properties": {"role": "roi"},
        },
        {
            "type": "Feature",
            "id": "start",
            "geometry": {"type": "Point", "coordinates": list(FRAME.to_wgs84((20.0, 20.0)))},
            "properties": {"role": "start"},
        },
    ]
    if room_m is not None:
        area = box(-room_m, -room_m, 300.0 + room_m, 200.0 + room_m)
        features.append({"type": "Feature", "id": "area", "geometry": area, "properties": {"role": "area"}})
    return {
        "type": "FeatureCollection",
        "features": features,
        "vehicles": [{"name": "v", "airspeed_m_s": 16.0, "max_bank_deg": 35.0, **vehicle}],
        "sensors": [EYE | (eye or {})],
        "altitude_m": 100.0,
    }


def test_an_area_too_small_is_told_how_much_is_lacking() -> None:
    """With what is lacking and room for turns it is flyable, with ten metres less it is not."""
    with pytest.raises(InfeasibleError) as caught:
        make_plan(read_scenario(field(60.0, settle_m=150.0, min_turn_radius_m=40.0)))
    assert "settle_m" in caught.value.message
    (lacking_m,) = (float(each) for each in re.findall(r"by (\d+) m and room", caught.value.relaxation))
    assert lacking_m > 10.0
    with pytest.raises(InfeasibleError):
        make_plan(read_scenario(field(50.0 + lacking_m, settle_m=150.0, min_turn_radius_m=40.0)))
    plan = make_plan(read_scenario(field(60.0 + lacking_m + 80.0, settle_m=150.0, min_turn_radius_m=40.0)))
    assert plan.hard_violations == ()


@pytest.mark.parametrize("overlap", [0.0, 0.2, 0.3, 0.45])
def test_little_overlap_is_reached_at_the_edges_too(overlap: float) -> None:
    """The judge finds the overlaps asked for, and all of the field in some photo."""
    eye = {"forward_overlap": overlap, "side_overlap": overlap}
    plan = make_plan(read_scenario(field(None, eye, type="multirotor", autopilot="px4", airspeed_m_s=8.0)))
    assert plan.violations == ()
    survey = plan.metrics.surveys["a"]
    assert survey.side_overlap >= overlap - 0.01
    assert survey.photos_least >= 1


def test_what_says_how_high_is_told_where_nothing_does() -> None:
    """Without altitude_m: it, or a wish that decides the height."""
    document = field(None)
    del document["altitude_m"]
    with pytest.raises(ScenarioError) as caught:
        read_scenario(document)
    (finding,) = (f for f in caught.value.findings if f.severity == "error")
    assert {"altitude_m", "gsd_m", "max_height_m"} <= set(re.findall(r"\w+", finding.fix))


def test_a_round_obstacle_is_told_what_it_can_be() -> None:
    """A Point of role obstacle: no_fly, with a radius."""
    document = field(None)
    document["features"].append(
        document["features"][1] | {"id": "mast", "properties": {"role": "obstacle", "height_m": 30.0}}
    )
    with pytest.raises(ScenarioError) as caught:
        read_scenario(document)
    (finding,) = (f for f in caught.value.findings if f.feature == "mast")
    assert "no_fly" in finding.fix
    assert "radius_m" in finding.fix


@pytest.mark.parametrize(
    "corners",
    [
        [(0, 0), (400, 30), (430, 290), (20, 240)],
        [(0, 0), (380, 120), (60, 330)],
        [(0, 0), (400, 0), (400, 140), (170, 150), (150, 330), (0, 320)],
    ],
)
def test_edges_may_be_left_to_one_lane(corners: list[tuple[float, float]]) -> None:
    """Not longer then, nothing refused, and each photo's own ground put together is still all of it."""
    flown = {}
    for kept in (True, False):
        made = field(None, {"edge_overlap": kept}, type="multirotor")
        del made["vehicles"][0]["max_bank_deg"]
        ring = [list(FRAME.to_wgs84(corner)) for corner in (*corners, corners[0])]
        made["features"][0]["geometry"] = {"type": "Polygon", "coordinates": [ring]}
        scenario = read_scenario(made)
        plan = make_plan(scenario)
        assert not plan.violations
        flown[kept] = plan.metrics.length_m
        prints = []
        for collect, photos in zip(plan.collects, plan.photos, strict=True):
            places_m = FRAME.to_local([place[:2] for place in photos.places])
            course_rad = math.radians(90.0 - collect.heading_deg)
            ahead = 100.0 * EYE["pixel_pitch_m"] / EYE["focal_length_m"] * EYE["image_px"][1] / 2.0
            beside = ahead * EYE["image_px"][0] / EYE["image_px"][1]
            frame = rotate(shapely_box(-ahead, -beside, ahead, beside), course_rad, (0, 0), use_radians=True)
            prints += [translate(frame, *place_m) for place_m in places_m]
        assert Polygon(corners).difference(union_all(prints)).area < 1.0
    assert flown[False] < flown[True]
