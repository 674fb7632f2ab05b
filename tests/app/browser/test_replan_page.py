"""Planning anew in flight on the page: what was drawn, moved and deleted goes into a plan of the rest."""

from __future__ import annotations

import json
import re
from pathlib import Path

import httpx
import pytest
from playwright.sync_api import Page, expect

from tests.app.browser.conftest import EXAMPLES, Service
from tests.app.browser.helpers import ask, connected, open_scenario
from tests.patience import PATIENCE_S

pytestmark = pytest.mark.browser

#: Where the plan has seen some of its regions, and not all.
MINUTES = 9


def _planned(page: Page, before: str | None = None) -> str:
    page.wait_for_function(
        "before => window.swathplan.plan() && window.swathplan.plan().id !== before",
        arg=before,
        timeout=180_000,
    )
    found: str = ask(page, "plan()")["id"]
    return found


def test_what_was_changed_on_the_page_is_planned_from_the_air(
    page: Page, service: Service, tmp_path: Path
) -> None:
    """A region deleted and a zone moved while it flies: the new plan begins in the air and knows of both."""
    document = json.loads((EXAMPLES / "sar-case-1.geojson").read_text())
    path = tmp_path / "scenario.geojson"
    path.write_text(json.dumps(document))
    open_scenario(page, path)
    page.get_by_role("tab", name="Plan").click()
    page.click("#plan-start")
    first = _planned(page)
    plan = service.get(f"/api/v1/plans/{first}/plan.geojson").json()
    collects = [f["properties"] for f in plan["features"] if f["properties"]["role"] == "collect"]
    last = max(collects, key=lambda collect: collect["end_s"])
    assert last["start_s"] > MINUTES * 60

    # What is seen last is wanted no more.
    page.get_by_role("tab", name="Scenario").click()
    page.get_by_role("button", name=last["roi"], exact=True).focus()
    page.keyboard.press("Enter")
    page.keyboard.press("Delete")
    page.wait_for_function(
        "name => !window.swathplan.scenario().features.some(f => f.id === name)", arg=last["roi"]
    )
    page.get_by_role("tab", name="Plan").click()
    page.locator("#replan-box > summary").click()
    expect(page.locator("#replan-changes")).to_contain_text(f"gone: {last['roi']}")
    page.fill("#replan-min", "")
    expect(page.locator("#replan")).to_be_disabled()
    page.fill("#replan-min", str(MINUTES))
    page.click("#replan")
    second = _planned(page, first)

    scenario = service.get(f"/api/v1/plans/{second}/scenario").json()
    assert ask(page, "scenario()") == scenario
    assert "in_flight" in scenario["vehicles"][0]
    asked = {f["id"] for f in scenario["features"] if f["properties"]["role"] == "roi"}
    seen = {collect["roi"] for collect in collects if collect["end_s"] < MINUTES * 60}
    assert last["roi"] not in asked
    assert asked < {f["id"] for f in document["features"] if f["properties"]["role"] == "roi"}
    assert seen
    expect(page.locator("#stale")).to_be_hidden()
    assert service.get(f"/api/v1/plans/{second}").json()["state"] == "done"


def test_what_a_flight_cannot_take_over_is_named(page: Page) -> None:
    """Other heights are none of a flight's changes: the button is off and the reason is there."""
    page.get_by_role("tab", name="Scenario").click()
    page.locator("#s-altitude_m").fill("620")
    page.locator("#s-altitude_m").press("Tab")
    page.get_by_role("tab", name="Plan").click()
    expect(page.locator("#replan")).to_be_disabled()
    expect(page.locator("#replan-why")).to_contain_text("altitude_m")


def test_an_aircraft_in_flight_takes_the_new_mission_and_begins_it(page: Page, service: Service) -> None:
    """From where it is now; it goes on amid the new mission, is told so, and begins it once ordered."""
    open_scenario(page)
    page.get_by_role("tab", name="Plan").click()
    before = ask(page, "plan()")
    page.click("#plan-start")
    first = _planned(page, before and before["id"])
    with connected(service, "solo", speedup=6) as (vehicle,):
        at = f"{service.address}/api/v1/vehicles/{vehicle}"
        httpx.post(f"{at}/mission", json={"plan_id": first}, timeout=PATIENCE_S).raise_for_status()
        start = {"command": "start", "arm_first": True}
        httpx.post(f"{at}/commands", json=start, timeout=PATIENCE_S).raise_for_status()
        page.get_by_role("tab", name="Fly").click()
        page.get_by_role("radio", name="solo").check()
        page.wait_for_function("window.swathplan.vehicle().flight !== null")
        page.wait_for_function("window.swathplan.vehicle().item > 3")
        page.get_by_role("tab", name="Plan").click()
        expect(page.locator("#replan-from")).to_have_value("flights")
        page.click("#replan")
        second = _planned(page, first)
        assert "in_flight" in service.get(f"/api/v1/plans/{second}/scenario").json()["vehicles"][0]
        page.get_by_role("tab", name="Fly").click()
        page.click("#upload")
        page.click("[data-begin]")
        page.click("#dialog-go")
        # Where it flies to next is past soon; what was ordered of it stays.
        page.get_by_text(re.compile("Go to item 1: solo (confirmed|took) it")).wait_for()
        assert httpx.get(at, timeout=PATIENCE_S).json()["plan_id"] == second
