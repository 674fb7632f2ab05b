"""Sensors set up on the page: a camera out of the database, what it sees, what is refused."""

from __future__ import annotations

import pytest
from playwright.sync_api import Page, expect

from planner.sensors.radars import RADARS
from tests.app.browser.helpers import ask, await_hook, open_scenario

pytestmark = pytest.mark.browser

MODEL = "Sony a6000 20 mm"
FOCAL_M, PITCH_M, COLUMNS, ROWS = 0.020, 0.0235 / 6000, 6000, 4000


def put(page: Page, field: str, value: str) -> None:
    """Type a value and go on to the next field."""
    page.fill(field, value)
    page.keyboard.press("Tab")


@pytest.fixture(scope="module")
def camera(page: Page) -> Page:
    """The page, with the radar of the first sample scenario turned into a camera of the database."""
    open_scenario(page)
    page.locator("#panel-scenario summary", has_text="Sensor").click()
    page.select_option("#sensors-0-type", "camera")
    page.wait_for_selector("#sensors-0-model-list option", state="attached")
    put(page, "#sensors-0-model", MODEL.lower())
    await_hook(page, f"scenario().sensors[0].model === '{MODEL}'")
    return page


def test_the_camera_stands_in_the_scenario_by_its_name(camera: Page) -> None:
    """The database's figures are named, not copied; those of the radar are gone; the section stays open."""
    assert ask(camera, "scenario()")["sensors"] == [{"name": "camera", "type": "camera", "model": MODEL}]
    expect(camera.locator("#sensors-0-focal_length_m")).to_have_count(0)
    expect(camera.locator("#sensors-0-forward_overlap")).to_be_visible()


def test_what_it_sees_from_the_altitude_is_told(camera: Page) -> None:
    """Pixel, photo, lanes, photos and time follow altitude, overlaps and speed as they are changed."""
    put(camera, "#s-altitude_m", "150")
    put(camera, "#sensors-0-side_overlap", "60")
    assert ask(camera, "scenario()")["sensors"][0]["side_overlap"] == 0.6
    camera.check("#sensors-0-edge_overlap")
    assert ask(camera, "scenario()")["sensors"][0]["edge_overlap"] is False
    camera.uncheck("#sensors-0-edge_overlap")
    assert "edge_overlap" not in ask(camera, "scenario()")["sensors"][0]
    gsd_m = PITCH_M / FOCAL_M * 150.0
    speed_m_s = ask(camera, "scenario()")["vehicles"][0]["airspeed_m_s"]
    seen = camera.locator("#sensors-0-seen")
    expect(seen).to_contain_text(f"a pixel covers {100.0 * gsd_m:.2f} cm")
    expect(seen).to_contain_text(f"a photo {COLUMNS * gsd_m:.0f} × {ROWS * gsd_m:.0f} m")
    expect(seen).to_contain_text(f"lanes lie {0.4 * COLUMNS * gsd_m:.1f} m apart")
    between_m = 0.25 * ROWS * gsd_m
    expect(seen).to_contain_text(f"photos {between_m:.1f} m, {between_m / speed_m_s:.1f} s")


def test_a_pixel_asked_for_decides_the_height(camera: Page) -> None:
    """A region asks in metres; the height for it is told, and that a set altitude goes first."""
    camera.locator("#panel-scenario .chips button", has_text="R1").click()
    put(camera, "#f-gsd_m", "2.5")
    assert (
        next(f for f in ask(camera, "scenario()")["features"] if f["id"] == "R1")["properties"]["gsd_m"]
        == 0.025
    )
    height_m = 0.025 * FOCAL_M / PITCH_M
    seen = camera.locator("#sensors-0-seen")
    expect(seen).to_contain_text(f"Left empty, 2.50 cm a pixel asks for {height_m:.0f} m")
    expect(seen).to_contain_text("Flown at the altitude that is set, 150 m")


def test_what_is_refused_stands_beside_its_field(camera: Page) -> None:
    """A tilt beyond the horizon is told under the tilt, the finding leads to it; mended, both are gone."""
    put(camera, "#sensors-0-tilt_deg", "85")
    beside = camera.locator("#sensors-0-tilt_deg-finding")
    expect(beside).to_contain_text("horizon")
    # Properties are called as their fields are, of which the file's name says nothing to an operator.
    label = camera.locator("label[for=sensors-0-tilt_deg]").inner_text().split(" (")[0]
    expect(beside).to_contain_text(f"“{label}” (°)")
    expect(beside).not_to_contain_text("tilt_deg")
    field = camera.locator("#sensors-0-tilt_deg")
    expect(field).to_have_attribute("aria-invalid", "true")
    camera.locator("#findings button", has_text="horizon").click()
    expect(field).to_be_focused()
    put(camera, "#sensors-0-tilt_deg", "20")
    expect(beside).to_have_count(0)
    expect(field).not_to_have_attribute("aria-invalid", "true")


def test_without_a_name_its_figures_are_asked_for(camera: Page) -> None:
    """The name taken away leaves the figures of the camera there was, in millimetres and micrometres."""
    put(camera, "#sensors-0-model", "")
    expect(camera.locator("#sensors-0-focal_length_m")).to_have_value("20")
    sensor = ask(camera, "scenario()")["sensors"][0]
    assert "model" not in sensor
    assert (sensor["focal_length_m"], sensor["image_px"]) == (FOCAL_M, [COLUMNS, ROWS])
    put(camera, "#sensors-0-focal_length_m", "35")
    assert ask(camera, "scenario()")["sensors"][0]["focal_length_m"] == 0.035


def test_a_second_sensor_is_a_radar(camera: Page) -> None:
    """It begins with published figures; a region is asked which of both sees it; it can be taken off."""
    camera.get_by_role("button", name="Add a radar").click()
    assert [s["type"] for s in ask(camera, "scenario()")["sensors"]] == ["camera", "sar"]
    camera.select_option("#sensors-1-preset", "NASA UAVSAR")
    radar = ask(camera, "scenario()")["sensors"][1]
    assert radar["incidence_deg"] == RADARS["NASA UAVSAR"].incidence_deg
    assert radar["name"] == "sar"
    expect(camera.locator("#sensors-1-preset")).to_have_value("NASA UAVSAR")
    camera.select_option("#f-sensor", "sar")
    camera.get_by_role("button", name="Remove sensor 2").click()
    scenario = ask(camera, "scenario()")
    assert [s["type"] for s in scenario["sensors"]] == ["camera"]
    assert all("sensor" not in f["properties"] for f in scenario["features"])
