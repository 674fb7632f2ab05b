"""The report of a camera's plan: photos, what they take to keep, what they are worth, where they are."""

from __future__ import annotations

import json
import re
from datetime import UTC, datetime
from typing import Any

import pytest

from app.services.records import PlanRecord
from app.services.reports.report import write_report
from planner.geojson import read_scenario, write_plan
from planner.pipeline import make_plan
from tests.planner.scenarios import feature, small, square

CAMERA = {
    "name": "cam", "type": "camera", "focal_length_m": 0.016, "pixel_pitch_m": 4e-6, "image_px": [6000, 4000],
    "min_interval_s": 0.5, "rer": 0.92, "snr": 50.0,
}  # fmt: skip
FIELD = [
    feature("A", "roi", "Polygon", square(0.0, 0.0, 0.002)),
    feature("start", "start", "Point", [-0.002, -0.002]),
]
MADE = datetime(2026, 1, 1, tzinfo=UTC)
RECORD = PlanRecord("p", "small", "done", "done", 1.0, MADE, MADE, MADE, (), None, None)
AIRCRAFT = [{"name": "uav", "airspeed_m_s": 15.0, "min_turn_radius_m": 40.0}]


@pytest.fixture(scope="module")
def surveyed() -> tuple[dict[str, Any], dict[str, Any]]:
    """A scenario of one small field, and its plan."""
    scenario = small(features=FIELD, vehicles=AIRCRAFT, sensors=[CAMERA], altitude_m=120.0)
    return scenario, write_plan(make_plan(read_scenario(scenario)))


def report_of(scenario: dict[str, Any], plan: dict[str, Any]) -> str:
    """Its page, on one line."""
    page = write_report(RECORD, json.dumps(plan), json.dumps(scenario))
    return re.sub(r"\s+", " ", re.sub(r"<[^>]+>", " ", page.split("</svg>")[1]))


def test_photos_and_what_they_take_are_told(surveyed: tuple[dict[str, Any], dict[str, Any]]) -> None:
    """Count, gigabytes at 4 and 14 bits a pixel, and the least distance between two stand in the report."""
    scenario, plan = surveyed
    told = report_of(scenario, plan)
    photos = [f["properties"] for f in plan["features"] if f["properties"]["role"] == "photos"]
    count = sum(p["count"] for p in photos)
    assert count == plan["metrics"]["photos"] > 10
    assert f"{count} of 24.0 MP" in told
    assert f"{count * 24e6 / 2.0 / 1e9:.1f} GB" in told
    assert f"{count * 24e6 * 14.0 / 8.0 / 1e9:.1f} GB" in told
    assert f"{min(p['interval_m'] for p in photos):.1f} m" in told
    assert "75 %, 65 %" in told


def test_what_images_are_worth_is_told(surveyed: tuple[dict[str, Any], dict[str, Any]]) -> None:
    """The pixel on the ground is that of the height; NIIRS is that of the footprints."""
    scenario, plan = surveyed
    told = report_of(scenario, plan)
    assert "3.00 cm" in told  # 4 µm / 16 mm · 120 m
    niirs = min(f["properties"]["niirs"] for f in plan["features"] if f["properties"]["role"] == "footprint")
    assert f" {niirs:.1f} " in told


def test_every_photo_is_in_the_picture(surveyed: tuple[dict[str, Any], dict[str, Any]]) -> None:
    """A dot for each, and none in the report of a radar's plan, which has no cameras at all."""
    scenario, plan = surveyed
    page = write_report(RECORD, json.dumps(plan), json.dumps(scenario))
    dots = re.findall(r'<path class="photos" d="([^"]+)"', page)
    assert sum(line.count("h0") for line in dots) == plan["metrics"]["photos"]
    bare = plan | {
        "cameras": [],
        "features": [f for f in plan["features"] if f["properties"]["role"] != "photos"],
    }
    assert "<h2>Cameras</h2>" not in write_report(RECORD, json.dumps(bare), json.dumps(scenario))


def test_photos_too_soon_for_the_camera_stand_out(surveyed: tuple[dict[str, Any], dict[str, Any]]) -> None:
    """A camera that takes longer than its photos are apart is marked."""
    scenario, plan = surveyed
    slow = plan | {"cameras": [plan["cameras"][0] | {"min_interval_s": 60.0}]}
    marked = '<td class="n bad">'
    assert marked in write_report(RECORD, json.dumps(slow), json.dumps(scenario))
    assert marked not in write_report(RECORD, json.dumps(plan), json.dumps(scenario))
