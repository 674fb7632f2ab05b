"""Several aircraft on the page: told apart, moved by one clock, sent their missions in one go."""

from __future__ import annotations

import json
import math
import re
from pathlib import Path
from typing import Any

import pyproj
import pytest
from playwright.sync_api import Page, expect

from tests.app.browser.conftest import Service
from tests.app.browser.helpers import ask, connected, on_screen, open_scenario
from tests.patience import PATIENCE_S

pytestmark = pytest.mark.browser

GEOD = pyproj.Geod(ellps="WGS84")
#: The slider knows whole seconds, the fastest aircraft flies this far in one.
SECOND_M = 25.0
MOVE = """at => {
    const slider = document.querySelector('#clock');
    slider.value = at;
    slider.dispatchEvent(new Event('input'));
}"""


def _point(name: str, role: str, lon_deg: float, lat_deg: float, **more: object) -> dict[str, Any]:
    return {
        "type": "Feature",
        "id": name,
        "properties": {"role": role, "name": name} | more,
        "geometry": {"type": "Point", "coordinates": [lon_deg, lat_deg]},
    }


def _fleet() -> dict[str, Any]:
    """Two targets on either side of two aircraft, one of them open for a while only."""
    wing = {"type": "fixed_wing", "airspeed_m_s": 20.0, "min_turn_radius_m": 80.0}
    return {
        "type": "FeatureCollection",
        "name": "two wings",
        "features": [
            _point("east", "roi", 8.53, 47.40, radius_m=40.0, time_window_s=[0, 1200]),
            _point("west", "roi", 8.47, 47.40, radius_m=40.0),
            _point("start", "start", 8.50, 47.39),
        ],
        "vehicles": [wing | {"name": "red"}, wing | {"name": "blue", "airspeed_m_s": 22.0}],
        "sensors": [
            {
                "name": "cam",
                "type": "camera",
                "focal_length_m": 0.016,
                "pixel_pitch_m": 4e-6,
                "image_px": [6000, 4000],
            }
        ],
        "altitude_m": 120.0,
        "altitude_reference": "home",
        "objective": {"length": 0.0},
        "separation": {"horizontal_m": 100.0, "vertical_m": 20.0},
    }


def test_all_aircraft_are_where_the_plan_has_them(page: Page, service: Service, tmp_path: Path) -> None:
    """At the time a pass begins, its aircraft is at its first end; one upload is sent to all."""
    path = tmp_path / "fleet.geojson"
    path.write_text(json.dumps(_fleet()))
    open_scenario(page, path)
    page.get_by_role("tab", name="Plan").click()
    page.click("#plan-start")
    page.wait_for_selector("#vehicles", timeout=PATIENCE_S * 1000)
    plan_id = ask(page, "plan()")["id"]
    plan = service.get(f"/api/v1/plans/{plan_id}/plan.geojson").json()
    collects = [f for f in plan["features"] if f["properties"]["role"] == "collect"]
    assert {c["properties"]["vehicle"] for c in collects} == {"red", "blue"}
    for collect in collects[:: max(1, len(collects) // 4)]:
        own = collect["properties"]
        page.evaluate(MOVE, own["start_s"])
        crew = {one["vehicle"]: one["at"] for one in ask(page, "crew()")}
        lon_deg, lat_deg = collect["geometry"]["coordinates"][0][:2]
        off_m = GEOD.inv(lon_deg, lat_deg, *crew[own["vehicle"]])[2]
        assert off_m < SECOND_M
    expect(page.locator("#crew .bars svg rect").first).to_be_attached()
    expect(page.locator("#doing li")).to_have_count(2)
    names = page.locator("#vehicles th.crew").all_inner_texts()
    assert sorted(names) == ["blue", "red"]

    # A vehicle for each of them, by their names: chosen without being asked. Others share the service.
    with connected(service, "red", "blue"):
        page.get_by_role("tab", name="Fly").click()
        expect(page.locator("#upload-all")).to_be_enabled(timeout=PATIENCE_S * 1000)
        page.click("#upload-all")
        page.wait_for_selector("#fleet-result", timeout=PATIENCE_S * 1000)
        assert page.get_attribute("#fleet-result", "data-outcome") == "accepted"
        assert page.get_attribute("#fleet-result", "data-verified") == "true"


def test_segments_round_the_targets_are_drawn_once_asked_for(page: Page, service: Service) -> None:
    """The legend's tick reads them; the pointer on one is told of it; unticked they are gone."""
    plan_id = ask(page, "plan()")["id"]
    assert ask(page, "segments()") == {}
    tick = page.get_by_label("Segments round targets")
    if not tick.is_visible():
        page.locator("#legend summary").click()
    tick.check()
    page.wait_for_function("window.swathplan.segments().chosen > 0", timeout=60_000)
    found = service.get(f"/api/v1/plans/{plan_id}/network.geojson").json()["features"]
    own = [f for f in found if f["properties"]["role"] == "segment"]
    drawn = ask(page, "segments()")
    assert sum(drawn.values()) == len(own)

    def middle(segment: dict[str, Any]) -> tuple[float, float]:
        lines = segment["geometry"]["coordinates"]
        (lon0, lat0, _), (lon1, lat1, _) = lines if segment["geometry"]["type"] == "LineString" else lines[0]
        return (lon0 + lon1) / 2.0, (lat0 + lat1) / 2.0

    one = next(f for f in own if f["properties"]["state"] == "open")
    lon_deg, lat_deg = middle(one)
    page.evaluate(f"window.swathplan.look({lon_deg}, {lat_deg}, 16)")
    x, y = on_screen(page, lon_deg, lat_deg)
    page.mouse.move(x - 3, y)
    page.mouse.move(x, y)
    expect(page.locator("#readout")).to_contain_text(f"{one['properties']['target']} by cam")
    # Others lie as near to it as pixels: what is told is of one of those.
    here = [f for f in own if math.dist(middle(f), (lon_deg, lat_deg)) < 1e-3]
    told = "|".join({f["properties"]["state"] for f in here})
    expect(page.locator("#readout")).to_contain_text(re.compile(told))
    tick.uncheck()
    page.wait_for_function("Object.keys(window.swathplan.segments()).length === 0")
