"""Orders in flight, given on the page and carried out: hold, sensor off, resume, land; in this order."""

from __future__ import annotations

from collections.abc import Iterator

import httpx
import pytest
from playwright.sync_api import Page, Route, expect

from tests.app.browser.air import vehicles_of
from tests.app.browser.conftest import EXAMPLES, Service, serving
from tests.app.browser.helpers import ask, await_hook, open_scenario
from tests.app.browser.test_truth_page import cell, go_to
from tests.patience import PATIENCE_S

pytestmark = pytest.mark.browser

LIMIT_MS = PATIENCE_S * 1000.0


#: What is flown in half a minute here is over in three seconds at the speed of the other files: sooner than a
#: busy machine's page has been asked twice.
SPEEDUP = 20


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """A service whose aircraft is still in flight when the page is asked again."""
    with serving(tmp_path_factory.mktemp("orders"), SPEEDUP) as started:
        yield started


def give(page: Page, command: str) -> None:
    """Press a command's button and confirm it."""
    page.click(f"[data-command={command}]")
    page.click("#dialog-go")


@pytest.fixture(scope="module")
def collecting(page: Page, service: Service) -> None:
    """The aircraft in its first pass, with the sensor on."""
    httpx.delete(vehicles_of(service)["sim-1"] + "/mission", timeout=PATIENCE_S)
    open_scenario(page, EXAMPLES / "sar-case-1.geojson")
    go_to(page, "Plan")
    page.click("#plan-start")
    await_hook(page, "plan() !== null")
    go_to(page, "Fly")
    page.click("#upload")
    page.wait_for_selector("#upload-result [data-outcome=accepted][data-verified=true]")
    give(page, "arm")
    await_hook(page, "vehicle().armed")
    give(page, "start")
    await_hook(page, "vehicle().sensor_on", PATIENCE_S)


def test_hold_stops_the_mission_and_the_sensor(page: Page, collecting: None) -> None:
    """The aircraft circles where it is; out of the pass its sensor is switched off, and the page shows it."""
    give(page, "hold")
    expect(cell(page, "mode")).to_have_text("LOITER", timeout=LIMIT_MS)
    expect(cell(page, "sensor")).to_have_text("off", timeout=LIMIT_MS)
    assert ask(page, "vehicle()")["armed"] is True


def test_a_reload_in_flight_keeps_the_track(page: Page, service: Service, collecting: None) -> None:
    """What was flown before a reload is drawn from the service's record, from the place of take-off on."""
    page.reload()
    page.wait_for_function("window.swathplan !== undefined")
    await_hook(page, "vehicle()?.track > 1", PATIENCE_S)
    flight = ask(page, "vehicle()")["flight"]
    track = httpx.get(f"{service.address}/api/v1/flights/{flight}/track.geojson", timeout=PATIENCE_S).json()
    line = next(f["geometry"] for f in track["features"] if f["properties"]["role"] == "track")
    await_hook(page, f"vehicle().began[0] === {line['coordinates'][0][0]!r}", PATIENCE_S)
    assert ask(page, "vehicle()")["began"] == line["coordinates"][0][:2]


def test_a_sensor_is_switched_off_by_its_button(page: Page, collecting: None) -> None:
    """Back in the mission the sensor comes on again; the button switches it off and the flight goes on."""
    give(page, "resume")
    expect(cell(page, "mode")).to_have_text("AUTO", timeout=LIMIT_MS)
    await_hook(page, "vehicle().sensor_on", PATIENCE_S)
    give(page, "sensor_off")
    expect(cell(page, "sensor")).to_have_text("off", timeout=LIMIT_MS)
    expect(cell(page, "mode")).to_have_text("AUTO")


def test_land_brings_it_down(page: Page, collecting: None) -> None:
    """A fixed wing goes over to its mission's landing, and stands disarmed at its end."""
    give(page, "land")
    await_hook(page, "vehicle().armed === false", PATIENCE_S)
    expect(cell(page, "flying")).to_have_text("on the ground", timeout=LIMIT_MS)


def test_what_was_ordered_is_found_again(page: Page, collecting: None) -> None:
    """The list tells of each order what became of it, of those before the reload of the page as well."""
    go_to(page, "Fly")
    page.get_by_text("What was ordered", exact=True).click()
    for command in ("arm", "start", "hold", "resume", "sensor_off", "land"):
        # The sensor may have been switched off by the service, too, where it came on out of a pass.
        order = page.locator(f"#ordered [data-order={command}]").last
        expect(order).to_have_attribute("data-outcome", "done")
    expect(page.locator("#ordered [data-order=upload]").first).to_contain_text("mission, fence")
    expect(page.locator("#under-way")).to_be_hidden()


def test_an_order_is_under_way_until_its_end_is_told(page: Page, collecting: None) -> None:
    """While the audit has no end of an order the page says so by itself, and stops once it has one."""

    def not_ended(route: Route) -> None:
        answer = route.fetch()
        body = answer.json()
        land = next(each for each in body["entries"] if each["what"].get("command") == "land")
        land |= {"outcome": "pending", "ended_at": None}
        route.fulfill(response=answer, json=body)

    page.route("**/api/v1/audit?*", not_ended)
    expect(page.locator("#under-way")).to_have_text("Under way: Land.", timeout=LIMIT_MS)
    page.unroute("**/api/v1/audit?*")
    expect(page.locator("#under-way")).to_be_hidden(timeout=LIMIT_MS)
