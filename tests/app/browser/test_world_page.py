"""The built-in world and what lies across ±180°."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Page

from tests.app.browser.conftest import EXAMPLES
from tests.app.browser.helpers import ask, await_hook, click_place, feature, on_screen, open_scenario

pytestmark = pytest.mark.browser

#: Places tens of kilometres from any coast, and whether they are land.
PLACES = {
    "Kansas": (-98.0, 38.5, True),
    "Sahara": (10.0, 22.0, True),
    "Chukotka, east longitude": (174.0, 67.5, True),
    "Chukotka, west longitude": (-176.0, 67.3, True),
    "Antarctica, ice cap": (60.0, -80.0, True),
    "Antarctica, ice cap west": (-100.0, -82.0, True),
    "Gulf of Guinea": (2.0, -3.0, False),
    "North Atlantic": (-30.0, 58.0, False),
    "Pacific at 180°": (180.0, 5.0, False),
    "Pacific west": (-150.0, -17.0, False),
    "Bering Sea at 180°": (180.0, 60.0, False),
    "Indian Ocean at Fiji's latitude": (70.0, -17.0, False),
    "Arctic Ocean at 180°": (180.0, 74.0, False),
}
#: Below this zoom all of the world is in one view.
WHOLE_BELOW = 2
CUT = (180.0, 68.0)


@pytest.fixture(scope="module")
def world(page: Page) -> Page:
    """The page once its world is drawn."""
    page.evaluate("window.swathplan.look(0, 0, 1)")
    await_hook(page, "rendered()['land'] > 0")
    return page


@pytest.mark.parametrize("zoom", [0, 1, 6, 12])
def test_land_is_land_and_sea_is_sea(world: Page, zoom: int) -> None:
    """Far off and near, the ground under known places is drawn as what it is."""
    whole = zoom < WHOLE_BELOW
    if whole:
        world.evaluate(f"window.swathplan.look(0, 0, {zoom})")
    for name, (lon, lat, is_land) in PLACES.items():
        if not whole:
            world.evaluate(f"window.swathplan.look({lon}, {lat}, {zoom})")
        assert ("land" in ask(world, f"at({lon}, {lat})")) == is_land, name


def test_no_coast_is_drawn_through_land(world: Page) -> None:
    """Along the meridian where the data was once cut there is land on both sides, and no line."""
    lon, lat = CUT
    world.evaluate(f"window.swathplan.look({lon}, {lat}, 9)")
    for west_deg in (-0.01, 0.0, 0.01):
        drawn = ask(world, f"at({lon + west_deg}, {lat})")
        assert "land" in drawn
        assert "coast" not in drawn


def test_a_scenario_across_the_meridian_is_one_place(page: Page, tmp_path: Path) -> None:
    """A region in two halves and an area that steps over ±180° are shown close by, and drawn there alone."""
    source = json.loads((EXAMPLES / "sar-case-1.geojson").read_text(encoding="utf-8"))

    def ring(west: float, east: float) -> list[list[float]]:
        return [[west, 9.99], [east, 9.99], [east, 10.01], [west, 10.01], [west, 9.99]]

    def made(name: str, role: str, geometry: Any) -> dict[str, Any]:
        properties = {"role": role, "name": name}
        return {"type": "Feature", "id": name, "properties": properties, "geometry": geometry}

    halves = {"type": "MultiPolygon", "coordinates": [[ring(179.99, 180.0)], [ring(-180.0, -179.99)]]}
    stepping = {"type": "Polygon", "coordinates": [ring(179.95, -179.95)]}
    start = {"type": "Point", "coordinates": [179.97, 10.0]}
    features = [made("R", "roi", halves), made("area", "area", stepping), made("start", "start", start)]
    path = tmp_path / "date_line.geojson"
    path.write_text(json.dumps(source | {"name": "date line", "features": features}), encoding="utf-8")
    open_scenario(page, path)
    await_hook(page, "rendered()['roi-fill'] > 0")
    assert ask(page, "zoom()") > 10.0
    assert abs(abs(ask(page, "centre()")[0]) - 180.0) < 0.05
    page.evaluate("window.swathplan.look(0, 10, 9)")
    assert {"area-line", "roi-fill"}.isdisjoint(ask(page, "rendered()"))


def test_shapes_across_the_meridian_are_drawn_and_reshaped(page: Page, tmp_path: Path) -> None:
    """A region's corner is dragged from one side to the other, and a new region drawn over both."""
    source = json.loads((EXAMPLES / "sar-case-1.geojson").read_text(encoding="utf-8"))
    ring = [[179.98, 9.99], [-179.99, 9.99], [-179.99, 10.01], [179.98, 10.01], [179.98, 9.99]]
    region = {
        "type": "Feature",
        "id": "R",
        "properties": {"role": "roi", "name": "R"},
        "geometry": {"type": "Polygon", "coordinates": [ring]},
    }
    path = tmp_path / "across.geojson"
    path.write_text(json.dumps(source | {"name": "across", "features": [region]}), encoding="utf-8")
    open_scenario(page, path)
    page.locator("#panel-scenario .chips button", has_text="R").click()
    page.evaluate("window.swathplan.look(180, 10, 12)")
    await_hook(page, "rendered()['td-point'] >= 4")
    x, y = on_screen(page, 180.01, 10.01)
    to_x, to_y = on_screen(page, 179.995, 10.02)
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move((x + to_x) / 2, (y + to_y) / 2)
    page.mouse.move(to_x, to_y)
    page.mouse.up()
    await_hook(page, "scenario().features[0].geometry.coordinates[0][2][0] > 0")
    moved = feature(page, "R")
    assert moved is not None
    corners = moved["geometry"]["coordinates"][0]
    assert corners[2] == pytest.approx([179.995, 10.02], abs=3e-4)
    assert corners[:2] + corners[3:] == ring[:2] + ring[3:]
    page.keyboard.press("Escape")
    page.get_by_role("toolbar").get_by_role("button", name="No-fly").click()
    places = [(179.99, 9.96), (180.02, 9.96), (180.02, 9.98)]
    for place in [*places, places[-1]]:
        click_place(page, *place)
    await_hook(page, "scenario().features.length === 2")
    drawn = feature(page, "N1")
    assert drawn is not None
    assert [lon for lon, _ in drawn["geometry"]["coordinates"][0][:3]] == pytest.approx(
        [179.99, -179.98, -179.98], abs=3e-4
    )
