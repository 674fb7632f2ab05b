"""A camera survey on the page: its photos, how often places are seen, its heights."""

from __future__ import annotations

import json
import math
import os
import random
import re
from pathlib import Path
from typing import Any

import pyproj
import pytest
from playwright.sync_api import Page, expect

from tests.app.browser.conftest import Service
from tests.app.browser.helpers import ask, await_hook, on_screen, open_scenario

pytestmark = pytest.mark.browser

GEOD = pyproj.Geod(ellps="WGS84")
HEIGHT_M, AIRSPEED_M_S, WIND_M_S, FROM_DEG = 120.0, 16.0, 5.0, 300.0
FIELD = [[8.500, 47.400], [8.506, 47.4005], [8.5055, 47.4035], [8.500, 47.400]]
#: Cells of the page's grid are smaller; places nearer to a photo's edge are left out.
EDGE_M = 3.0


def survey() -> dict[str, Any]:
    """A field, in wind, under a camera with a lens of 16 mm."""
    return {
        "type": "FeatureCollection",
        "name": "field",
        "features": [
            {
                "type": "Feature",
                "id": "R1",
                "properties": {"role": "roi", "name": "R1"},
                "geometry": {"type": "Polygon", "coordinates": [FIELD]},
            },
            {
                "type": "Feature",
                "id": "start",
                "properties": {"role": "start", "name": "start"},
                "geometry": {"type": "Point", "coordinates": [8.499, 47.399]},
            },
        ],
        "vehicles": [
            {"name": "wing", "type": "fixed_wing", "airspeed_m_s": AIRSPEED_M_S, "min_turn_radius_m": 40.0}
        ],
        "sensors": [
            {
                "name": "cam",
                "type": "camera",
                "focal_length_m": 0.016,
                "pixel_pitch_m": 4e-6,
                "image_px": [6000, 4000],
                "min_interval_s": 1.0,
            }
        ],
        "altitude_m": HEIGHT_M,
        "altitude_reference": "terrain",
        "wind": {"speed_m_s": WIND_M_S, "from_deg": FROM_DEG},
    }


@pytest.fixture(scope="module")
def plan(page: Page, service: Service, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """The survey's plan as the service tells it, shown on the page with all that is counted of it."""
    path = tmp_path_factory.mktemp("survey") / "field.geojson"
    path.write_text(json.dumps(survey()), encoding="utf-8")
    open_scenario(page, path)
    page.get_by_role("tab", name="Plan").click()
    page.click("#plan-start")
    await_hook(page, "plan() !== null")
    await_hook(page, "seenBy(8.503, 47.401) !== null")
    if target := os.environ.get("SWATHPLAN_SCREENSHOT"):
        page.set_viewport_size({"width": 1400, "height": 980})
        page.locator("#legend summary").click()
        page.locator("#profile").scroll_into_view_if_needed()
        page.evaluate("window.swathplan.look(8.5045, 47.4015, 15.9)")
        page.screenshot(path=target)
    made: dict[str, Any] = service.get(f"/api/v1/plans/{ask(page, 'plan()')['id']}/plan.geojson").json()
    return made


def margins_m(plan: dict[str, Any], lon: float, lat: float) -> list[float]:
    """How far inside each photo's ground a place lies, negative outside, by a wind triangle."""
    courses = {
        f["properties"]["seq"]: f["properties"]["heading_deg"]
        for f in plan["features"]
        if f["properties"]["role"] == "collect"
    }
    found = []
    for feature in plan["features"]:
        if feature["properties"]["role"] != "photos":
            continue
        course = courses[feature["properties"]["seq"]]
        crab_deg = math.degrees(
            math.asin(WIND_M_S / AIRSPEED_M_S * math.sin(math.radians(FROM_DEG - course)))
        )
        for at_lon, at_lat, _ in feature["geometry"]["coordinates"]:
            azimuth, _, away_m = GEOD.inv(at_lon, at_lat, lon, lat)
            off_rad = math.radians(azimuth - course - crab_deg)
            ahead_m, right_m = away_m * math.cos(off_rad), away_m * math.sin(off_rad)
            found.append(min(60.0 - abs(ahead_m), 90.0 - abs(right_m)))
    return found


def test_places_are_counted_by_the_photos_that_see_them(page: Page, plan: dict[str, Any]) -> None:
    """At random places in and round the field the page counts as many photos as lie over them."""
    assert ask(page, "photos()") == plan["metrics"]["photos"]
    picked = random.Random(5)
    counts = []
    while len(counts) < 25:
        lon, lat = picked.uniform(8.4985, 8.5075), picked.uniform(47.3990, 47.4045)
        margins = margins_m(plan, lon, lat)
        if min(abs(margin) for margin in margins) < EDGE_M:
            continue
        counts.append(sum(margin > 0.0 for margin in margins))
        assert ask(page, f"seenBy({lon}, {lat})") == counts[-1], (lon, lat)
    assert max(counts) >= 5
    assert 0 in counts


def test_figures_of_photos_are_the_plans(page: Page, plan: dict[str, Any]) -> None:
    """Count, pixel on the ground and how much of the field is seen stand in the panel."""
    expect(page.locator("#photos")).to_contain_text(f"{plan['metrics']['photos']} of 24.0 MP")
    # Nothing threatens.
    expect(page.locator("#metrics")).not_to_contain_text("Risk")
    gsd_cm = 100.0 * HEIGHT_M * 4e-6 / 0.016
    expect(page.locator("#quality")).to_contain_text(f"{gsd_cm:.2f} cm")
    expect(page.locator("#overlap-shares tr").first).to_contain_text("100.00 %")
    expect(page.locator("#legend .classes")).to_have_count(1)


def test_a_photo_tells_its_figures(page: Page, plan: dict[str, Any]) -> None:
    """Pointed at from near it says which one it is and from how high, and its ground is outlined."""
    photos = [f for f in plan["features"] if f["properties"]["role"] == "photos"]
    lon, lat, _ = photos[1]["geometry"]["coordinates"][2]
    number = len(photos[0]["geometry"]["coordinates"]) + 3
    page.evaluate(f"window.swathplan.look({lon}, {lat}, 17)")
    await_hook(page, "rendered()['photo-place'] > 0 && window.swathplan.rendered()['photo-print'] > 0")
    x, y = on_screen(page, lon, lat)
    page.mouse.move(x - 2, y - 2)
    page.mouse.move(x, y)
    expect(page.locator("#readout")).to_contain_text(f"Photo {number} of {plan['metrics']['photos']}")
    expect(page.locator("#readout")).to_contain_text("120 m over the ground")
    await_hook(page, "rendered()['photo-print-one'] > 0")


def test_heights_are_shown_along_the_flight(page: Page, plan: dict[str, Any]) -> None:
    """The profile is there; what is pointed at in it is told and marked on the map."""
    path = next(f for f in plan["features"] if f["properties"]["role"] == "path")
    lowest_m = min(alt_m for _, _, alt_m in path["geometry"]["coordinates"] if alt_m > 100.0)
    about = page.locator("#profile-about")
    expect(about).to_have_text(re.compile(r"^Least height over the ground in the mission: \d+ m, at "))
    told_m = float(re.findall(r"(\d+) m,", about.inner_text())[0])
    assert lowest_m - 1.0 <= told_m <= HEIGHT_M
    over = page.locator("#profile .u-over")
    over.scroll_into_view_if_needed()
    box = over.bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + box["width"] / 2.0, box["y"] + 40.0)
    page.mouse.move(box["x"] + box["width"] / 2.0 + 1.0, box["y"] + 40.0)
    expect(page.locator("#profile-at")).to_contain_text("120 m over the ground")
    page.evaluate("window.swathplan.look(8.503, 47.4015, 14)")
    await_hook(page, "rendered()['cursor'] > 0")


def test_a_plan_without_photos_has_none_of_it(page: Page, plan: dict[str, Any], tmp_path: Path) -> None:
    """Where a radar's scenario takes its place nothing of photos is left on the page."""
    open_scenario(page)
    await_hook(page, "photos() === 0 && window.swathplan.seenBy(8.503, 47.401) === null")
    expect(page.locator("#legend .classes")).to_have_count(0)
    expect(page.locator("#photos")).to_be_hidden()
