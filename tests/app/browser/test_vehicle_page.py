"""Vehicles on the page: connected by what is simulated, what they hold, what was sent; in this order."""

from __future__ import annotations

import json
import socket
import time
from collections.abc import Callable, Iterator
from typing import Any

import httpx
import pytest
from playwright.sync_api import Page, expect

from mavlink.wire.codec import Codec
from mavlink.wire.messages import Message
from tests.app.browser.air import free_port, vehicles_of
from tests.app.browser.conftest import EXAMPLES, Service
from tests.app.browser.helpers import await_hook, open_scenario
from tests.patience import PATIENCE_S

pytestmark = pytest.mark.browser

LIMIT_MS = PATIENCE_S * 1000.0


CASE_1 = json.loads((EXAMPLES / "sar-case-1.geojson").read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def flying(page: Page, service: Service) -> Iterator[Page]:
    """The page with a sample scenario on it and the tab of vehicles open; the service is left as it was."""
    httpx.delete(vehicles_of(service)["sim-1"] + "/mission", timeout=PATIENCE_S)
    open_scenario(page, EXAMPLES / "sar-case-1.geojson")
    page.get_by_role("tab", name="Fly").click()
    yield page
    for name, place in vehicles_of(service).items():
        if name != "sim-1":
            httpx.delete(place, params={"in_flight": "true"}, timeout=PATIENCE_S)


@pytest.fixture(scope="module")
def planned(flying: Page, service: Service) -> str:
    """The id of a plan of that scenario, shown on the page."""
    answer = httpx.post(
        f"{service.address}/api/v1/plans?wait={PATIENCE_S:.0f}",
        json=CASE_1 | {"name": "to be held"},
        timeout=PATIENCE_S,
    )
    record = answer.json()
    assert record["state"] == "done"
    flying.get_by_role("tab", name="Plan").click()
    flying.get_by_role("button", name="Refresh").first.click()
    flying.locator("#recent button", has_text="to be held").first.click()
    if flying.get_by_role("dialog").count():
        flying.click("#dialog-go")
    await_hook(flying, f"plan()?.id === '{record['id']}'")
    flying.get_by_role("tab", name="Fly").click()
    return str(record["id"])


def test_what_is_simulated_is_chosen(flying: Page, service: Service) -> None:
    """The form offers each kind of simulated aircraft, flown as the scenario says, under a free name."""
    flying.locator("summary", has_text="Connect a vehicle").click()
    address = flying.locator("#v-url")
    expect(address).to_have_value("udpin:127.0.0.1:14550")
    flying.select_option("#v-kind", "sim_fixed_wing")
    expect(address).to_have_value(
        "sim:?speedup=10&type=fixed_wing&airspeed=20&turn_radius=100&autopilot=ardupilot"
    )
    flying.select_option("#v-kind", "sim_multirotor")
    expect(address).to_have_value("sim:?speedup=10&type=multirotor&autopilot=ardupilot")
    expect(flying.locator("#v-name")).to_have_value("uav-1")
    assert set(vehicles_of(service)) == {"sim-1"}
    flying.click("#v-connect")
    row = flying.locator("#vehicles .vehicle", has_text="uav-1")
    expect(row).to_contain_text("simulated", timeout=LIMIT_MS)
    expect(flying.locator("#panel-fly h2")).to_contain_text("ArduPilot, multirotor", timeout=LIMIT_MS)
    expect(flying.locator("#v-name")).to_have_value("uav-2")
    assert (
        httpx.get(vehicles_of(service)["uav-1"], timeout=PATIENCE_S).json()["state"]["type"] == "multirotor"
    )


def test_a_vehicle_nobody_hears_is_said_to_be_so(flying: Page, service: Service) -> None:
    """A silent address is listed as not heard and keeps its controls shut; a wrong one is explained once."""
    flying.select_option("#v-kind", "udpin")
    flying.fill("#v-url", "udp:14550")
    flying.click("#v-connect")
    notice = flying.locator("#notices .error")
    expect(notice).to_contain_text("udp:14550 is no link address (link-address). write udpin:host:port")
    assert notice.inner_text().count("udp:14550 is no link address") == 1
    notice.get_by_role("button").click()
    silent = {"name": "silent", "url": "udpin:127.0.0.1:0", "timeout_s": 0.1}
    assert (
        httpx.post(f"{service.address}/api/v1/vehicles", json=silent, timeout=PATIENCE_S).status_code == 201
    )
    flying.get_by_role("button", name="Refresh the list").click()
    row = flying.locator("#vehicles .vehicle", has_text="silent")
    expect(row).to_contain_text("not heard")
    row.locator("input").check()
    expect(flying.locator("#words")).to_contain_text("not heard at udpin:127.0.0.1:0")
    for control in ("#upload", "#preflight", "#read-held", "[data-command=arm]", "[data-command=goto_item]"):
        expect(flying.locator(control)).to_be_disabled()
    row.get_by_role("button").click()
    flying.click("#dialog-go")
    expect(row).to_have_count(0)


def beat_until(service: Service, name: str, system_id: int, ready: Callable[[Any], bool]) -> None:
    """Send heartbeats of a system to a vehicle's address until its record is so."""
    place = vehicles_of(service)[name]
    port = int(httpx.get(place, timeout=PATIENCE_S).json()["url"].rpartition(":")[2])
    heartbeat = Codec(system_id, 1).pack(Message("HEARTBEAT", {"type": 1, "autopilot": 3}))
    deadline_s = time.monotonic() + LIMIT_MS / 1000.0
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as air:
        while not ready(httpx.get(place, timeout=PATIENCE_S).json()):
            assert time.monotonic() < deadline_s, "nothing came of the heartbeats"
            air.sendto(heartbeat, ("127.0.0.1", port))
            time.sleep(0.1)


def test_a_swapped_aircraft_is_acknowledged(flying: Page, service: Service) -> None:
    """Another system at a vehicle's address is named, and is the vehicle once the operator says so.

    It takes the five seconds after which a silent vehicle is lost.
    """
    there = {"name": "swapped", "url": f"udpin:127.0.0.1:{free_port()}", "timeout_s": 0.1}
    assert httpx.post(f"{service.address}/api/v1/vehicles", json=there, timeout=PATIENCE_S).status_code == 201
    beat_until(service, "swapped", 1, lambda vehicle: bool(vehicle["connected"]))
    beat_until(service, "swapped", 2, lambda vehicle: bool(vehicle["other_system"] == 2))
    flying.get_by_role("button", name="Refresh the list").click()
    row = flying.locator("#vehicles .vehicle", has_text="swapped")
    row.locator("input").check()
    words = flying.locator("#words")
    beat_until(service, "swapped", 2, lambda vehicle: "system 2, answers where" in words.inner_text())
    expect(flying.locator("[data-command=arm]")).to_be_disabled()
    words.get_by_role("button", name="Acknowledge").click()
    beat_until(service, "swapped", 2, lambda vehicle: flying.locator("#dialog-go").is_visible())
    flying.click("#dialog-go")
    beat_until(service, "swapped", 2, lambda vehicle: bool(vehicle["connected"]))
    beat_until(service, "swapped", 2, lambda vehicle: "another aircraft" not in words.inner_text().lower())
    row.get_by_role("button").click()
    flying.click("#dialog-go")
    expect(row).to_have_count(0)


def test_what_was_sent_is_told_and_what_is_held_is_read(flying: Page, planned: str) -> None:
    """Nothing sent; sent and read back equal; the list read and drawn; cleared again."""
    flying.locator("#vehicles .vehicle", has_text="sim-1").locator("input").check()
    sent = flying.locator("#sent")
    expect(sent).to_contain_text("Nothing was sent to it from here")
    flying.click("#upload")
    expect(sent).to_contain_text("It holds the plan on the map: read back equal", timeout=LIMIT_MS)
    flying.click("#read-held")
    expect(flying.locator("#held")).to_contain_text("mission: ", timeout=LIMIT_MS)
    expect(flying.locator("#held")).to_contain_text("rally: empty")
    await_hook(flying, "rendered()['held-line'] > 0")
    flying.click("#clear-held")
    flying.click("#dialog-go")
    expect(sent).to_contain_text("Nothing was sent to it from here, or it was cleared", timeout=LIMIT_MS)
    await_hook(flying, "rendered()['held-line'] === undefined")


def test_a_part_to_upload_has_to_be_ticked(flying: Page, planned: str) -> None:
    """Without a part there is nothing to upload; the fence alone can go up."""
    flying.uncheck("#part-mission")
    flying.uncheck("#part-fence")
    expect(flying.locator("#upload")).to_be_disabled()
    flying.check("#part-fence")
    flying.click("#upload")
    parts = flying.locator("#upload-result ul.findings").first
    expect(parts).to_contain_text("fence: ", timeout=LIMIT_MS)
    expect(parts).not_to_contain_text("mission: ")
    flying.check("#part-mission")


def test_going_to_an_item_asks_first(flying: Page) -> None:
    """The number is asked for, and the command names it before it is given."""
    flying.click("[data-command=goto_item]")
    expect(flying.get_by_role("dialog")).to_have_count(0)
    flying.fill("#goto-item", "5")
    flying.click("[data-command=goto_item]")
    expect(flying.get_by_role("dialog")).to_contain_text("from item 5")
    flying.keyboard.press("Escape")


def test_a_payload_that_cannot_be_is_refused_by_name(flying: Page, planned: str) -> None:
    """How the sensor is switched is sent with the upload, and judged."""
    flying.locator("summary", has_text="Payload: how it is switched").click()
    flying.fill("#payload", "laser:1")
    flying.click("#upload")
    expect(flying.locator("#notices .error").last).to_contain_text("laser:1")
    flying.fill("#payload", "")
    flying.fill("#gimbal", "crane:tilt=45")
    flying.click("#upload")
    expect(flying.locator("#notices .error").last).to_contain_text("crane:tilt=45")
    flying.fill("#gimbal", "")


def test_a_plan_is_deleted(flying: Page, planned: str, service: Service) -> None:
    """A plan is deleted from the list, after asking, and leaves the map."""
    flying.get_by_role("tab", name="Plan").click()
    flying.get_by_role("button", name="Delete plan to be held").first.click()
    flying.click("#dialog-go")
    await_hook(flying, "plan() === null")
    assert service.get(f"/api/v1/plans/{planned}").status_code == 404
