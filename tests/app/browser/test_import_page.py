"""Regions of other programs, dropped on the page or opened."""

from __future__ import annotations

import base64
import json
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from tests.app.browser.helpers import ask, await_hook, feature, open_scenario
from tests.app.imports.samples import folder, kml, line, packed, placemark, polygon

pytestmark = pytest.mark.browser

RING = [(-117.70, 33.511), (-117.695, 33.511), (-117.695, 33.515), (-117.70, 33.515), (-117.70, 33.511)]


def drop(page: Page, name: str, content: bytes) -> None:
    """Drop a file on the page, as a hand with a pointer does."""
    page.evaluate(
        """([name, text]) => {
            const bytes = Uint8Array.from(atob(text), (character) => character.charCodeAt(0));
            const dataTransfer = new DataTransfer();
            dataTransfer.items.add(new File([bytes], name));
            const how = { bubbles: true, cancelable: true, dataTransfer };
            for (const kind of ["dragenter", "dragover", "drop"])
                document.body.dispatchEvent(new DragEvent(kind, how));
        }""",
        [name, base64.b64encode(content).decode()],
    )


def test_a_dropped_kmz_joins_the_scenario(page: Page) -> None:
    """Its shapes are added with names and roles, the service accepts them, undo takes them back."""
    open_scenario(page)
    before = len(ask(page, "scenario()")["features"])
    away = [(lon + 0.01, lat) for lon, lat in RING]
    data = packed(
        {"doc.kml": kml(placemark("R1", polygon(RING)), folder("No fly", placemark("mast", polygon(away))))}
    )
    drop(page, "fields.kmz", data)
    await_hook(page, f"scenario().features.length === {before + 2}")
    added = feature(page, "R1 2")
    assert added is not None
    assert added["geometry"]["coordinates"] == [[list(place) for place in RING]]
    zone = feature(page, "mast")
    assert zone is not None
    assert zone["properties"]["role"] == "no_fly"
    expect(page.locator("#findings")).to_have_attribute("data-state", "sound")
    page.keyboard.press("Control+z")
    await_hook(page, f"scenario().features.length === {before}")


def test_a_width_is_asked_for(page: Page, tmp_path: Path) -> None:
    """A line opened by the file input becomes a corridor of the width answered; Cancel adds nothing."""
    open_scenario(page)
    path = tmp_path / "road.kml"
    path.write_bytes(kml(placemark("road", line(RING[:2]))))
    page.set_input_files("#file", path)
    page.get_by_role("button", name="Cancel").click()
    assert feature(page, "road") is None
    page.set_input_files("#file", path)
    page.locator("#import-width_m").fill("120")
    page.locator("#import-go").click()
    await_hook(page, "scenario().features.some(f => f.id === 'road')")
    road = feature(page, "road")
    assert road is not None
    assert road["properties"] == {"role": "roi", "name": "road", "width_m": 120.0}


def test_a_bad_file_is_refused_in_words(page: Page) -> None:
    """What the service says of a file stands on the page; the scenario stays as it is."""
    open_scenario(page)
    before = ask(page, "scenario()")
    drop(page, "bad.kml", b"<!DOCTYPE kml [<!ENTITY a 'b'>]><kml/>")
    expect(page.locator("#notices")).to_contain_text("document type or entities")
    assert ask(page, "scenario()") == before


def test_roles_in_doubt_are_asked_for(page: Page) -> None:
    """A role that nobody knows is asked for; decided later it refuses the scenario until then."""
    open_scenario(page)
    away = [(lon + 0.01, lat) for lon, lat in RING]
    far = [(lon + 0.02, lat) for lon, lat in RING]
    data = kml(
        placemark("A", polygon(RING), role="cloud"),
        placemark("Geofence", polygon(away)),
        placemark("NFZ", polygon(far)),
    )
    drop(page, "zones.kml", data)
    page.get_by_label("A (polygon)").select_option("no_fly")
    expect(page.get_by_text("What the other shapes became")).to_be_visible()
    page.locator("#import-go").click()
    await_hook(page, "scenario().features.some(f => f.id === 'Geofence')")
    settled, doubtful = feature(page, "A"), feature(page, "Geofence")
    assert settled is not None
    assert settled["properties"] == {"role": "no_fly", "name": "A"}
    assert doubtful is not None
    assert doubtful["properties"]["role"] == "no_fly"
    expect(page.locator("#findings")).to_have_attribute("data-state", "refused")
    expect(page.locator("#findings")).to_contain_text("in doubt")
    page.locator(".chips button", has_text="Geofence").click()
    page.locator("#f-role").select_option("no_fly")
    page.locator("#f-settle").click()
    expect(page.locator("#findings")).to_have_attribute("data-state", "sound")
    after = feature(page, "Geofence")
    assert after is not None
    assert after["properties"] == {"role": "no_fly", "name": "Geofence"}


def test_geojson_without_roles_is_imported(page: Page) -> None:
    """A file of shapes that are no scenario's joins the scenario; points are what the operator says."""
    open_scenario(page)
    before = len(ask(page, "scenario()")["features"])
    point = {
        "type": "Feature",
        "properties": {"name": "P"},
        "geometry": {"type": "Point", "coordinates": RING[0]},
    }
    drop(page, "points.geojson", json.dumps({"type": "FeatureCollection", "features": [point]}).encode())
    page.get_by_label("P (point)").select_option("roi")
    page.locator("#import-go").click()
    await_hook(page, f"scenario().features.length === {before + 1}")
    added = feature(page, "P")
    assert added is not None
    assert added["properties"]["role"] == "roi"
