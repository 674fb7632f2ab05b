"""A camera's flight on the page: uploaded, flown, photo by photo; a log that is not its own is refused."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest
from playwright.sync_api import Page, expect

from tests.app.browser.conftest import Service, serving
from tests.app.browser.helpers import ask, await_hook, open_scenario
from tests.app.browser.test_survey_page import survey
from tests.patience import PATIENCE_S

pytestmark = pytest.mark.browser

SPEEDUP = 20
FIELD = [[8.4985, 47.3990], [8.5004, 47.3990], [8.5004, 47.4001], [8.4985, 47.4001], [8.4985, 47.3990]]


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """A service with a simulated multirotor."""
    with serving(tmp_path_factory.mktemp("photos"), SPEEDUP) as started:
        there = {"name": "copter", "url": f"sim:?speedup={SPEEDUP}&type=multirotor&airspeed=12"}
        made = httpx.post(f"{started.address}/api/v1/vehicles", json=there, timeout=PATIENCE_S)
        assert made.status_code == 201
        yield started


@pytest.fixture(scope="module")
def flight(page: Page, service: Service, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """What the service says of a small survey that was planned, uploaded and flown on the page."""
    scenario = survey()
    scenario["features"][0]["geometry"]["coordinates"] = [FIELD]
    scenario["features"][1]["geometry"]["coordinates"] = [8.4980, 47.3987]
    scenario["vehicles"] = [{"name": "copter", "type": "multirotor", "airspeed_m_s": 12.0}]
    path = tmp_path_factory.mktemp("small") / "small.geojson"
    path.write_text(json.dumps(scenario | {"altitude_m": 60.0}), encoding="utf-8")
    open_scenario(page, path)
    page.get_by_role("tab", name="Plan").click()
    page.click("#plan-start")
    await_hook(page, "plan() !== null")
    page.get_by_role("tab", name="Fly").click()
    page.locator("#vehicles label", has_text="copter").click()
    page.click("#upload")
    page.wait_for_selector(
        "#upload-result [data-outcome=accepted][data-verified=true]", timeout=PATIENCE_S * 1000
    )
    page.click("[data-command=start]")
    page.click("#dialog-go")
    await_hook(page, "flown() !== null", PATIENCE_S)
    seen: dict[str, Any] = service.get(f"/api/v1/flights/{ask(page, 'flown()')}/coverage.geojson").json()
    return seen


def test_photos_taken_are_told_and_drawn(page: Page, flight: dict[str, Any]) -> None:
    """As many as the service counts stand in the panel and on the map, with what they saw of the field."""
    photos = flight["photos"]
    planned = sum(one["planned"] for one in photos["passes"])
    assert photos["taken"] > 0
    told = page.locator("#photos-taken")
    expect(told).to_contain_text(f"{photos['taken']} photos reported of {planned} planned")
    expect(told).to_contain_text(f"{photos['counted']} counted")
    expect(page.locator("#flown-overlap tbody tr")).to_have_count(1)
    await_hook(page, f"taken() === {photos['taken']}")
    page.evaluate("window.swathplan.look(8.4995, 47.39955, 16.5)")
    await_hook(page, "rendered()['taken-place'] > 0 && window.swathplan.rendered()['taken-print'] > 0")


def test_its_rasters_can_be_fetched(page: Page, service: Service, flight: dict[str, Any]) -> None:
    """The files of overlap and pixel size are offered, and there."""
    for label in ("Overlap (GeoTIFF)", "Pixel sizes (GeoTIFF)"):
        address = page.locator("#flown a", has_text=label).evaluate("a => a.href")
        assert httpx.get(address, timeout=PATIENCE_S).content[:2] in (b"II", b"MM")


def test_a_log_of_something_else_is_refused(page: Page, flight: dict[str, Any], tmp_path: Path) -> None:
    """What is no log is refused in the service's words, and the flight stays as it was."""
    log = tmp_path / "00000042.bin"
    log.write_bytes(b"no log at all")
    page.set_input_files("#log-file", log)
    expect(page.locator("#notices")).to_contain_text("00000042.bin was not added")
    assert ask(page, "flown()") is not None
