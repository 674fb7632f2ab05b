"""The main journey on the page: plan, upload, fly, see what was seen; in this order on one page."""

from __future__ import annotations

import json
import math
import os
from pathlib import Path

import httpx
import pytest
from playwright.sync_api import Page, expect

from tests.app.browser.conftest import EXAMPLES, Service
from tests.app.browser.helpers import ask, await_hook, open_scenario
from tests.patience import PATIENCE_S

pytestmark = pytest.mark.browser

CASE_1 = json.loads((EXAMPLES / "sar-case-1.geojson").read_text(encoding="utf-8"))
QUEUED_BEFORE = 12
SHORT_RANGE_M = 20_000.0


def start_planning(page: Page, path: Path) -> None:
    """Open a scenario and ask for a plan by the button."""
    open_scenario(page, path)
    page.get_by_role("tab", name="Plan").click()
    page.click("#plan-start")


def give(page: Page, command: str) -> None:
    """Press a command's button and confirm it."""
    page.click(f"[data-command={command}]")
    page.click("#dialog-go")


@pytest.fixture(scope="module")
def planned(page: Page) -> str:
    """The id of a plan of the first sample scenario, shown on the page."""
    start_planning(page, EXAMPLES / "sar-case-1.geojson")
    await_hook(page, "plan() !== null", PATIENCE_S)
    return str(ask(page, "plan()")["id"])


def test_a_plan_is_shown_with_its_figures(page: Page, planned: str, service: Service) -> None:
    """After planning the map holds the plan's parts, and the table says what the service says."""
    record = service.get(f"/api/v1/plans/{planned}").json()
    metrics = page.locator("#metrics")
    expect(metrics).to_contain_text(f"{record['metrics']['length_m'] / 1000:.2f} km")
    expect(metrics).to_contain_text(f"{record['metrics']['duty_cycle'] * 100:.1f} %")
    expect(metrics).to_contain_text("Risk, missile")
    assert page.locator(".coverage tr").count() == len(record["metrics"]["coverage"])
    expect(page.locator("#result")).to_contain_text("no violation")
    await_hook(page, "rendered()['footprint-fill'] > 0")
    drawn = ask(page, "rendered()")
    assert {"path-line", "collect-line", "collect-label", "footprint-fill", "waypoint"} <= set(drawn)
    plan = service.get(f"/api/v1/plans/{planned}/plan.geojson").json()
    assert ask(page, "plan()")["features"] == len(plan["features"])


def test_every_file_offered_can_be_fetched(page: Page, planned: str) -> None:
    """The links beside the figures lead to the plan's files and its report."""
    links = [link.evaluate("a => a.href") for link in page.locator(".files a").all()]
    assert {link.rsplit("/", 1)[1] for link in links} == {
        "plan.geojson", "mission.plan", "mission.waypoints", "mission.kml", "report.html",
    }  # fmt: skip
    for link in links:
        assert httpx.get(link, timeout=PATIENCE_S).status_code == 200
        assert planned in link


def test_the_plan_is_uploaded_and_flown(page: Page, planned: str, service: Service) -> None:
    """Upload reads back equal; the aircraft moves once told to; after landing the ground seen is shown."""
    page.get_by_role("tab", name="Fly").click()
    page.click("#upload")
    page.wait_for_selector("#upload-result [data-outcome=accepted][data-verified=true]")
    assert ask(page, "vehicle()")["armed"] is False
    give(page, "arm")
    await_hook(page, "vehicle().armed")
    marker = page.locator(".aircraft")
    before = marker.bounding_box()
    give(page, "start")
    assert before is not None
    page.wait_for_function(
        """([x, y]) => {
            const now = document.querySelector('.aircraft').getBoundingClientRect();
            return Math.hypot(now.x - x, now.y - y) > 40;
        }""",
        arg=[before["x"], before["y"]],
        timeout=PATIENCE_S * 1000,
    )
    page.wait_for_function("window.swathplan.rendered()['track-on'] > 0", timeout=PATIENCE_S * 1000)
    if target := os.environ.get("SWATHPLAN_SCREENSHOT"):
        await_hook(page, "rendered()['track-on'] >= 6", PATIENCE_S)
        page.screenshot(path=target)
    await_hook(page, "flown() !== null", PATIENCE_S)
    flight = ask(page, "flown()")
    seen = service.get(f"/api/v1/flights/{flight}/coverage.geojson").json()
    assert seen["plan"] == planned
    for region, fraction in seen["coverage"].items():
        row = page.locator("#flown tr", has_text=region)
        # Rounded down: what was not seen whole never reads 100 %.
        expect(row).to_contain_text(f"{math.floor(fraction * 1e4 + 1e-6) / 100:.2f} %")
    whole = all(region["seen"] for region in seen["regions"])
    expect(page.locator("#flown")).to_contain_text(
        "At least 99.5 % of every region was seen" if whole else "Less than 99.5 % seen of"
    )
    await_hook(page, "rendered()['seen-fill'] > 0")
    report = page.locator("#flown a", has_text="Report").evaluate("a => a.href")
    assert flight in report
    assert httpx.get(report, timeout=PATIENCE_S).status_code == 200


def test_readiness_is_asked_of_the_vehicle(page: Page, planned: str) -> None:
    """The check before flight is shown with the upload, and again on its own button, check by check."""
    page.get_by_role("tab", name="Fly").click()
    expect(page.locator("#upload-result [data-ready]")).to_have_count(1)
    page.click("#preflight")
    asked = page.locator("#preflight-result [data-ready]")
    expect(asked).to_have_count(1, timeout=PATIENCE_S * 1000)
    expect(asked).to_contain_text("mission")


def test_what_was_sent_is_told_from_what_is_on_the_map(page: Page, planned: str, service: Service) -> None:
    """With another plan on the map the answer says so, the check is gone, and the start asks once more."""
    record = httpx.post(
        f"{service.address}/api/v1/plans?wait={PATIENCE_S:.0f}",
        json=CASE_1 | {"name": "elsewhere", "seed": 7},
        timeout=PATIENCE_S,
    ).json()
    assert record["state"] == "done"
    result, checked = page.locator("#upload-result"), page.locator("#preflight-result [data-ready]")
    expect(result).not_to_contain_text("Another plan")
    expect(checked).to_have_count(1)
    page.get_by_role("tab", name="Plan").click()
    page.get_by_role("button", name="Refresh").first.click()
    page.locator("#recent button", has_text="elsewhere").click()
    await_hook(page, f"plan()?.id === '{record['id']}'")
    page.get_by_role("tab", name="Fly").click()
    expect(result).to_contain_text("Another plan than the one on the map was sent")
    expect(checked).to_have_count(0)
    page.click("[data-command=start]")
    expect(page.get_by_role("dialog")).to_contain_text("not known to be the plan on the map")
    page.keyboard.press("Escape")
    page.get_by_role("tab", name="Plan").click()
    page.locator("#recent button", has_text="sar-case-1").first.click()
    await_hook(page, f"plan()?.id === '{planned}'")
    expect(result).not_to_contain_text("Another plan")


def test_two_plans_are_compared(page: Page, planned: str, service: Service) -> None:
    """Figures of another plan stand beside those of the one on the map, and its path is drawn."""
    other = CASE_1 | {"name": "other", "method": {"routing": "li2018"}}
    record = httpx.post(
        f"{service.address}/api/v1/plans?wait={PATIENCE_S:.0f}", json=other, timeout=PATIENCE_S
    ).json()
    assert record["state"] == "done"
    page.get_by_role("tab", name="Plan").click()
    page.get_by_role("button", name="Refresh").first.click()
    page.locator("summary", has_text="Compare").click()
    page.select_option("#compare", record["id"])
    table = page.locator("#comparison")
    expect(table).to_contain_text(f"{record['metrics']['length_m'] / 1000:.2f} km")
    await_hook(page, "rendered()['compared-line'] > 0")
    page.select_option("#compare", "")
    expect(table).to_have_count(0)


def test_the_gaps_of_a_flight_are_planned(page: Page, planned: str) -> None:
    """One button makes a plan of what a flight did not see, or the service's words why there is none."""
    page.get_by_role("tab", name="Fly").click()
    # Another scenario was on the page meanwhile: what was seen of this one is asked for again.
    page.locator("#flights button", has_text="ended").first.click(timeout=120_000)
    page.click("#refly")
    expect(page.get_by_role("dialog")).to_contain_text("stays as it is until the new plan is uploaded")
    page.click("#dialog-go")
    page.wait_for_function(
        "() => window.swathplan.scenario().name.endsWith('-refly')"
        " || document.querySelector('#notices').textContent.includes('gaps were not planned')"
    )


def test_an_unsafe_plan_needs_a_reason(page: Page, planned: str, tmp_path: Path) -> None:
    """The violation is shown; the upload is refused until the operator overrides it with a reason."""
    short = json.loads(json.dumps(CASE_1))
    short["vehicles"][0]["max_range_m"] = SHORT_RANGE_M
    path = tmp_path / "short.geojson"
    path.write_text(json.dumps(short), encoding="utf-8")
    start_planning(page, path)
    await_hook(page, f"plan() !== null && window.swathplan.plan().id !== '{planned}'", PATIENCE_S)
    expect(page.locator("#violations")).to_contain_text("range")
    page.get_by_role("tab", name="Fly").click()
    page.click("#upload")
    dialog = page.get_by_role("dialog")
    expect(dialog).to_contain_text("override")
    expect(page.locator("#dialog-go")).to_be_disabled()
    page.fill("#reason", "bench test, propeller off")
    page.click("#dialog-go")
    result = page.locator("#upload-result [data-outcome=accepted]")
    expect(result).to_contain_text("bench test, propeller off", timeout=PATIENCE_S * 1000)


def test_a_failed_plan_says_why(page: Page, planned: str, tmp_path: Path) -> None:
    """A start walled in by a no-fly zone has no way out: the page names the zone."""
    closed = json.loads(json.dumps(CASE_1))
    start = next(f for f in closed["features"] if f["properties"]["role"] == "start")
    lon, lat = start["geometry"]["coordinates"][:2]
    corners = ((-1, -1), (1, -1), (1, 1), (-1, 1), (-1, -1))
    outer, inner = ([[lon + h * x, lat + h * y] for x, y in corners] for h in (0.005, 0.003))
    wall = {"type": "Polygon", "coordinates": [outer, inner[::-1]]}
    closed["features"].append(
        {"type": "Feature", "id": "Z", "properties": {"role": "no_fly", "name": "Z"}, "geometry": wall}
    )
    path = tmp_path / "closed.geojson"
    path.write_text(json.dumps(closed), encoding="utf-8")
    start_planning(page, path)
    page.wait_for_selector("#failure", timeout=PATIENCE_S * 1000)
    expect(page.locator("#failure")).to_contain_text("Z")
    expect(page.locator("#notices")).to_contain_text("No plan can satisfy the scenario")


def test_planning_can_be_cancelled(page: Page, planned: str, service: Service) -> None:
    """A plan that waits behind others is cancelled by its button, and the page says so."""
    before = []
    for seed in range(1, QUEUED_BEFORE + 1):
        answer = httpx.post(
            f"{service.address}/api/v1/plans", json=CASE_1 | {"seed": seed}, timeout=PATIENCE_S
        )
        assert answer.status_code == 202
        before.append(answer.json()["id"])
    start_planning(page, EXAMPLES / "sar-case-1.geojson")
    page.click("#plan-cancel")
    await_hook(page, "planState() === 'cancelled'")
    expect(page.locator("#progress")).to_contain_text("Plan cancelled")
    newest = service.get("/api/v1/plans?limit=1").json()["plans"][0]
    assert newest["state"] == "cancelled"
    # Who plans next does not wait for them.
    for plan_id in before:
        httpx.delete(f"{service.address}/api/v1/plans/{plan_id}", timeout=PATIENCE_S)


def test_a_lost_service_is_said_and_found_again(page: Page, planned: str) -> None:
    """Without the service the header says so; when it is back, the page goes on by itself, and says until
    when it is not ready to plan."""
    status = page.locator("#service")
    expect(status).to_have_attribute("data-state", "up")
    page.context.set_offline(True)
    expect(status).to_have_attribute("data-state", "down", timeout=PATIENCE_S * 1000)
    begun = {"status": "starting", "version": "0", "checks": {"database": True, "workers": False}}
    page.route("**/health/ready", lambda route: route.fulfill(status=503, json=begun))
    page.context.set_offline(False)
    expect(status).to_have_attribute("data-state", "starting", timeout=PATIENCE_S * 1000)
    expect(status).to_contain_text("getting ready to plan")
    page.unroute("**/health/ready")
    expect(status).to_have_attribute("data-state", "up", timeout=PATIENCE_S * 1000)
