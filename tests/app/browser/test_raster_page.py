"""Rasters on the map: importance as heat, the ground as relief, both chosen and sent on the page."""

from __future__ import annotations

import io
import json
from pathlib import Path
from typing import Any

import matplotlib.image
import numpy as np
import pytest
from playwright.sync_api import FilePayload, Page, expect
from rasterio.transform import from_bounds

from tests.app.browser.conftest import EXAMPLES
from tests.app.browser.helpers import ask, await_hook, on_screen, open_scenario
from tests.app.rasters import written

pytestmark = pytest.mark.browser

#: What ground is worth is highest here.
HOT, COLD = (-25.50, 37.748), (-25.486, 37.756)


def worth() -> bytes:
    """Importance that falls off round one place."""
    west, south, east, north = -25.53, 37.73, -25.47, 37.77
    lon, lat = np.meshgrid(np.linspace(west, east, 240), np.linspace(north, south, 160))
    off = ((lon - HOT[0]) ** 2 * 0.62 + (lat - HOT[1]) ** 2) / 0.003**2
    values = np.exp(-off / 2.0).astype(np.float32)
    return written(values, crs="EPSG:4326", transform=from_bounds(west, south, east, north, 240, 160))


def pixel(page: Page, place: tuple[float, float]) -> Any:
    """The mean colour round a place on the screen, each part from 0 to 1."""
    x, y = on_screen(page, *place)
    shot = page.screenshot(clip={"x": x - 3, "y": y - 3, "width": 6, "height": 6})
    return matplotlib.image.imread(io.BytesIO(shot), format="png")[..., :3].mean(axis=(0, 1))


def tick(page: Page, label: str) -> Any:
    """A tick of the legend."""
    if page.locator("#legend details").get_attribute("open") is None:
        page.locator("#legend summary").click()
    return page.locator("#legend").get_by_label(label)


def test_importance_is_sent_chosen_and_drawn_as_heat(page: Page, tmp_path: Path) -> None:
    """Where the raster says more the map's colour is changed more; its tick hides it, as does leaving it."""
    scenario = json.loads((EXAMPLES / "island-volcano.geojson").read_text())
    scenario["features"] = [f for f in scenario["features"] if f["properties"]["role"] != "importance"]
    (tmp_path / "island.geojson").write_text(json.dumps(scenario | {"name": "heat"}))
    (tmp_path / "worth.tif").write_bytes(worth())
    open_scenario(page, tmp_path / "island.geojson")
    page.evaluate("([lon, lat]) => window.swathplan.look(lon, lat, 13)", list(HOT))
    plain = {place: pixel(page, place) for place in (HOT, COLD)}
    page.set_input_files("#importance_raster-file", tmp_path / "worth.tif")
    await_hook(page, f"rastered('importance_raster', {HOT[0]}, {HOT[1]}) > 0.9")
    assert ask(page, f"rastered('importance_raster', {COLD[0]}, {COLD[1]})") < 0.1
    expect(page.locator("#s-importance_raster option:checked")).to_contain_text("worth.tif (")
    assert page.locator("#s-terrain option", has_text="worth.tif").count() == 0
    page.evaluate("([lon, lat]) => window.swathplan.look(lon, lat, 13)", list(HOT))
    change = {place: float(np.abs(pixel(page, place) - plain[place]).max()) for place in (HOT, COLD)}
    assert change[HOT] > 0.1
    assert change[HOT] > 3.0 * change[COLD]
    tick(page, "Importance, the stronger the more").uncheck()
    page.evaluate("([lon, lat]) => window.swathplan.look(lon, lat, 13)", list(HOT))
    assert np.abs(pixel(page, HOT) - plain[HOT]).max() < 0.02
    tick(page, "Importance, the stronger the more").check()
    page.select_option("#s-importance_raster", "")
    await_hook(page, f"rastered('importance_raster', {HOT[0]}, {HOT[1]}) === null")


def test_the_ground_is_shaded(page: Page) -> None:
    """Of a ridge the slope towards the north-west is lighter than the one away from it."""
    open_scenario(page, EXAMPLES / "field-survey.geojson")
    middle = ask(page, "centre()")
    west, east = middle[0] - 0.02, middle[0] + 0.02
    south, north = middle[1] - 0.02, middle[1] + 0.02
    lon, _ = np.meshgrid(np.linspace(west, east, 200), np.linspace(north, south, 200))
    ridge = (600.0 - 20_000.0 * np.abs(lon - middle[0])).astype(np.float32)
    content = written(ridge, crs="EPSG:4326", transform=from_bounds(west, south, east, north, 200, 200))
    file: FilePayload = {"name": "ridge.tif", "mimeType": "image/tiff", "buffer": content}
    # Opened like any file: what it is cannot be told from a GeoTIFF, and is asked.
    page.set_input_files("#file", file)
    page.get_by_role("button", name="Heights of the ground").click()
    await_hook(page, f"rastered('terrain', {middle[0]}, {middle[1]}) > 500")
    sides = [(middle[0] + off, middle[1] + 0.004) for off in (-0.008, 0.008)]
    page.evaluate("([lon, lat]) => window.swathplan.look(lon, lat, 13)", middle)
    light, dark = (float(pixel(page, side).mean()) for side in sides)
    assert light > dark + 0.05
    tick(page, "The ground's relief").uncheck()
    page.evaluate("([lon, lat]) => window.swathplan.look(lon, lat, 13)", middle)
    light, dark = (float(pixel(page, side).mean()) for side in sides)
    assert light == pytest.approx(dark, abs=0.02)
    tick(page, "The ground's relief").check()
