"""What the page says of scenario, plan, mission and flight is what is so; in this order on one page."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import httpx
import pytest
from playwright.sync_api import Page, Route, expect

from tests.app.browser.air import Air, vehicles_of
from tests.app.browser.conftest import EXAMPLES, Service
from tests.app.browser.helpers import ask, await_hook, feature, on_screen, open_scenario
from tests.patience import PATIENCE_S

pytestmark = pytest.mark.browser

CASE_1: dict[str, Any] = json.loads((EXAMPLES / "sar-case-1.geojson").read_text(encoding="utf-8"))
TABS = ("Scenario", "Plan", "Fly")
LIMIT_MS = PATIENCE_S * 1000.0
ZONE = [[-117.70, 33.52], [-117.69, 33.52], [-117.69, 33.526], [-117.70, 33.526], [-117.70, 33.52]]


def go_to(page: Page, tab: str) -> None:
    """Choose a tab."""
    page.get_by_role("tab", name=tab).click()


def cell(page: Page, label: str, vehicle: str = "sim-1") -> Any:
    """A cell of a vehicle's line of status."""
    return page.locator(f"[data-vehicle='{vehicle}'] [data-cell={label}] .value")


@pytest.fixture(scope="module")
def scenario(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The first sample scenario with a no-fly zone apart from its path."""
    zone = {
        "type": "Feature",
        "id": "N1",
        "properties": {"role": "no_fly", "name": "N1"},
        "geometry": {"type": "Polygon", "coordinates": [ZONE]},
    }
    path = tmp_path_factory.mktemp("scenario") / "zoned.geojson"
    zoned = CASE_1 | {"name": "zoned", "features": [*CASE_1["features"], zone]}
    path.write_text(json.dumps(zoned), encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def planned(page: Page, service: Service, scenario: Path) -> str:
    """The id of a plan of that scenario, made and shown by the page."""
    httpx.delete(vehicles_of(service)["sim-1"] + "/mission", timeout=PATIENCE_S)
    open_scenario(page, scenario)
    go_to(page, "Plan")
    page.click("#plan-start")
    await_hook(page, "plan() !== null")
    return str(ask(page, "plan()")["id"])


def test_edited_planned_uploaded_and_flying_stand_in_one_place(page: Page, planned: str) -> None:
    """The line of a vehicle tells all four in every tab, and follows the upload."""
    for tab in TABS:
        go_to(page, tab)
        expect(cell(page, "edited")).to_have_text("zoned")
        expect(cell(page, "planned")).to_have_text("up to date")
        expect(cell(page, "uploaded")).to_have_text("nothing")
        expect(cell(page, "flying")).to_have_text("on the ground")
    page.click("#upload")
    expect(cell(page, "uploaded")).to_have_text("this plan", timeout=LIMIT_MS)
    for label in ("link", "position", "mode", "armed", "battery", "sensor"):
        expect(cell(page, label)).not_to_be_empty()


def test_geometry_is_locked_where_one_flies(page: Page, planned: str) -> None:
    """A drag over a zone, Delete and Undo change nothing outside the Scenario tab; a lock is shown."""
    before = ask(page, "scenario()")
    for tab in ("Fly", "Plan"):
        go_to(page, "Scenario")
        page.get_by_role("button", name="N1", exact=True).click()
        go_to(page, tab)
        assert ask(page, "selected()") is None
        expect(page.locator("#lock")).to_be_visible()
        expect(page.locator("#tools")).to_be_hidden()
        x, y = on_screen(page, -117.695, 33.523)
        page.mouse.click(x, y)
        page.mouse.move(x, y)
        page.mouse.down()
        page.mouse.move(x + 30, y + 20, steps=4)
        page.mouse.move(x + 80, y + 60, steps=4)
        page.mouse.up()
        page.keyboard.press("Delete")
        page.keyboard.press("Control+z")
        assert ask(page, "scenario()") == before
    expect(cell(page, "planned")).to_have_text("up to date")


def test_an_edit_puts_the_plan_out_of_date(page: Page, planned: str) -> None:
    """From the moment of an edit the plan is out of date everywhere and cannot go up; undo makes it good."""
    go_to(page, "Scenario")
    page.get_by_role("button", name="N1", exact=True).click()
    page.locator("#f-ceiling_m").fill("400")
    page.keyboard.press("Tab")
    for tab in TABS:
        go_to(page, tab)
        expect(cell(page, "planned")).to_have_text("OUT OF DATE")
        expect(cell(page, "uploaded")).to_have_text("this plan, OUT OF DATE")
    expect(page.locator("#upload")).to_be_disabled()
    expect(page.locator("#upload-why")).to_contain_text("edited after this plan was made")
    expect(page.locator("#upload-result")).not_to_contain_text("Ready to fly")
    page.click("[data-command=start]")
    expect(page.get_by_role("dialog")).to_contain_text("OUT OF DATE")
    page.keyboard.press("Escape")
    go_to(page, "Plan")
    expect(page.locator("#stale")).to_be_visible()
    go_to(page, "Scenario")
    page.keyboard.press("Control+z")
    expect(cell(page, "planned")).to_have_text("up to date")
    go_to(page, "Fly")
    expect(page.locator("#upload")).to_be_enabled()


def test_the_ends_of_the_flight_are_drawn_and_told(page: Page, planned: str, service: Service) -> None:
    """Take-off and landing are lines on the map; their times are listed, or said not to be counted."""
    go_to(page, "Scenario")
    page.get_by_role("button", name="Show all").click()
    await_hook(page, "rendered()['phase-line'] > 0")
    go_to(page, "Plan")
    plan = service.get(f"/api/v1/plans/{planned}/plan.geojson").json()
    (path,) = [f["properties"] for f in plan["features"] if f["properties"]["role"] == "path"]
    told = page.locator("#phases")
    if phases := path.get("phases"):
        expect(told.locator("tbody tr")).to_have_count(len(phases))
        expect(page.locator("#metrics")).to_contain_text("take-off to landing")
    else:
        expect(told).to_contain_text("not counted")
        expect(page.locator("#metrics")).to_contain_text("mission alone")


def test_the_items_have_numbers_heights_and_a_list(page: Page, planned: str, service: Service) -> None:
    """The list counts as the vehicle does; each place is on the map with its number."""
    go_to(page, "Plan")
    page.locator("#panel-plan summary", has_text="Mission items").click()
    rows = page.locator("#panel-plan .waypoints tbody tr")
    items = service.get(f"/api/v1/plans/{planned}/mission.plan").json()["mission"]["items"]
    assert rows.count() == len(items)
    for index in (0, len(items) // 2, len(items) - 1):
        expect(rows.nth(index).locator("td").first).to_have_text(str(items[index]["doJumpId"]))
    placed = next(i for i, item in enumerate(items) if item["command"] == 16)
    expect(rows.nth(placed)).to_contain_text(f"{items[placed]['params'][6]:.0f} m over home")
    rows.nth(placed).get_by_role("button").click()
    await_hook(page, "rendered()['waypoint-label'] > 0")
    page.get_by_role("tab", name="Scenario").click()
    page.get_by_role("button", name="Show all").click()


def test_an_order_says_what_will_move(page: Page, planned: str) -> None:
    """Arm, start, land, hold and sensor off name the aircraft and what it does before they are given."""
    go_to(page, "Fly")
    says = {
        "arm": "sim-1 (ArduPilot fixed wing) will arm now",
        "start": "sim-1 (ArduPilot fixed wing) will arm and take off now",
        "hold": "does not move",
        "land": "is not in flight",
        "sensor_off": "payload of sim-1 (ArduPilot fixed wing) is switched off",
    }
    for command, words in says.items():
        page.click(f"[data-command={command}]")
        dialog = page.get_by_role("dialog")
        expect(dialog).to_contain_text(words)
        if command == "start":
            expect(dialog).to_contain_text("It flies the plan on the map, “zoned”")
            expect(page.locator("#dialog-go")).to_have_text("Arm and take off")
        page.keyboard.press("Escape")
    expect(page.locator("#mission-end")).to_contain_text("The mission ends")
    go_to(page, "Scenario")
    page.locator("summary", has_text="Aircraft").click()
    choices = page.locator("#vehicles-0-finish option").evaluate_all("o => o.map(e => e.value)")
    assert choices == ["auto", "land", "return", "loiter"]


def test_a_lost_link_is_seen_in_every_tab(page: Page, planned: str, service: Service) -> None:
    """A vehicle that falls silent raises an alarm above all tabs, with the age of its place.

    It takes the five seconds after which a silent vehicle is lost.
    """
    with Air(service, "fading", system_id=7) as air:
        link = cell(page, "link", "fading")
        expect(link).to_contain_text("good", timeout=LIMIT_MS)
        expect(page.locator("#alarm")).to_be_hidden()
        air.fall_silent()
        for tab in TABS:
            go_to(page, tab)
            expect(page.locator("#alarm")).to_contain_text("LINK LOST: fading", timeout=LIMIT_MS)
            expect(link).to_contain_text("LOST")
            expect(cell(page, "armed", "fading")).to_contain_text("was")
        age = cell(page, "position", "fading")
        expect(age).not_to_have_text(age.inner_text())
        expect(page).to_have_title("⚠ Link lost – Swathplan")
        go_to(page, "Fly")
        page.locator("#vehicles label", has_text="fading").click()
        # It may hear what it does not answer: what makes safe is offered, nothing else.
        expect(page.locator("[data-command=rtl]")).to_be_enabled()
        expect(page.locator("[data-command=start]")).to_be_disabled()
    expect(page.locator("#alarm")).to_be_hidden(timeout=LIMIT_MS)


def test_a_cancelled_upload_says_what_is_held(page: Page, planned: str, service: Service) -> None:
    """Stepping back from an override leaves words of what the vehicle still holds."""
    short = CASE_1 | {"name": "short", "vehicles": [CASE_1["vehicles"][0] | {"max_range_m": 20_000.0}]}
    made = httpx.post(
        f"{service.address}/api/v1/plans?wait={PATIENCE_S:.0f}", json=short, timeout=PATIENCE_S
    ).json()
    go_to(page, "Plan")
    page.get_by_role("button", name="Refresh").first.click()
    page.locator("#recent button", has_text="short").first.click()
    await_hook(page, f"plan()?.id === '{made['id']}'")
    expect(cell(page, "planned")).to_contain_text("violation")
    expect(cell(page, "uploaded")).to_have_text("ANOTHER PLAN")
    go_to(page, "Fly")
    page.click("#upload")
    page.get_by_role("dialog").get_by_role("button", name="Cancel").click()
    result = page.locator("#upload-result")
    expect(result).to_contain_text("Cancelled. Nothing was sent to sim-1; it still holds plan “zoned”")
    expect(cell(page, "uploaded")).to_have_text("ANOTHER PLAN")


def test_plans_of_others_are_listed_unasked(page: Page, planned: str, service: Service) -> None:
    """A plan that another client posts, and one that it deletes, come and go in the list of the page."""
    go_to(page, "Plan")
    other = CASE_1 | {"name": "posted elsewhere"}
    made = httpx.post(
        f"{service.address}/api/v1/plans?wait={PATIENCE_S:.0f}", json=other, timeout=PATIENCE_S
    ).json()
    line = page.locator("#recent button", has_text="posted elsewhere")
    expect(line).to_have_count(1, timeout=LIMIT_MS)
    assert httpx.delete(f"{service.address}/api/v1/plans/{made['id']}", timeout=PATIENCE_S).status_code < 300
    expect(line).to_have_count(0, timeout=LIMIT_MS)


def test_new_leaves_nothing_behind(page: Page, planned: str) -> None:
    """New clears the plan, what is compared and seen, the history and the notices; a reload stays new."""
    go_to(page, "Scenario")
    page.get_by_role("button", name="New", exact=True).click()
    await_hook(page, "plan() === null")
    assert ask(page, "scenario()")["features"] == []
    assert ask(page, "flown()") is None
    page.keyboard.press("Control+z")
    assert ask(page, "scenario()")["features"] == []
    await_hook(page, "rendered()['path-line'] === undefined")
    assert "phase-line" not in ask(page, "rendered()")
    expect(cell(page, "planned")).to_have_text("no plan")
    page.reload()
    page.locator("#recent button").first.wait_for(state="attached")
    expect(cell(page, "planned")).to_have_text("no plan")
    assert ask(page, "plan()") is None
    assert ask(page, "scenario()")["features"] == []


def test_a_reload_brings_back_the_scenario_with_its_plan(page: Page, planned: str) -> None:
    """After a reload the plan is there again and still told to be of the scenario, or out of date."""
    go_to(page, "Plan")
    page.locator("#recent button", has_text="zoned").first.click()
    await_hook(page, f"plan()?.id === '{planned}'")
    # In flight nothing is to alarm while the plan is on its way, and geometry stays locked.
    go_to(page, "Fly")
    held: list[Route] = []
    page.route("**/plan.geojson", lambda route: held.append(route))
    page.reload()
    expect(cell(page, "planned")).to_have_text("being read …", timeout=LIMIT_MS)
    expect(cell(page, "uploaded")).to_have_text("this plan", timeout=LIMIT_MS)
    expect(page.get_by_role("tab", name="Fly")).to_have_attribute("aria-selected", "true")
    page.unroute("**/plan.geojson")
    for route in held:
        route.continue_()
    for height, words in ((None, "up to date"), ("620", "OUT OF DATE")):
        if height:
            go_to(page, "Scenario")
            page.locator("#s-altitude_m").fill(height)
            page.keyboard.press("Tab")
        page.reload()
        page.wait_for_function("window.swathplan !== undefined")
        await_hook(page, f"plan()?.id === '{planned}'")
        expect(cell(page, "planned")).to_have_text(words, timeout=LIMIT_MS)


def test_two_tabs_have_a_scenario_each(page: Page, service: Service, scenario: Path) -> None:
    """What one tab edits is not in the other, before and after both are reloaded."""
    other = page.context.new_page()
    other.goto(service.address)
    other.wait_for_function("window.swathplan !== undefined")
    open_scenario(page, scenario)
    open_scenario(other, EXAMPLES / "sar-case-2.geojson")
    for shown, height in ((page, 555), (other, 444)):
        shown.locator("#s-altitude_m").fill(str(height))
        shown.keyboard.press("Tab")
    for shown in (page, other):
        shown.reload()
        shown.wait_for_function("window.swathplan !== undefined")
    assert (ask(page, "scenario()")["name"], ask(page, "scenario()")["altitude_m"]) == ("zoned", 555)
    assert feature(page, "N1") is not None
    assert ask(other, "scenario()")["altitude_m"] == 444
    assert feature(other, "N1") is None
    other.close()


def test_two_tabs_do_not_overwrite_each_other(page: Page, service: Service, scenario: Path) -> None:
    """Of two tabs on one kept scenario the later one is told; nothing is lost before it has chosen."""
    open_scenario(page, scenario)
    await_hook(page, "kept().state === 'kept'")
    kept = ask(page, "kept()")["id"]
    text = f"{service.address}/api/v1/scenarios/{kept}"
    other = page.context.new_page()
    other.goto(service.address)
    other.wait_for_function(f"window.swathplan !== undefined && window.swathplan.kept().id === '{kept}'")
    for shown, height in ((page, "510"), (other, "490")):
        go_to(shown, "Scenario")
        shown.locator("#s-altitude_m").fill(height)
        shown.keyboard.press("Tab")
        await_hook(shown, "kept().state !== 'waiting'")
    assert ask(other, "kept()")["state"] == "changed"
    assert httpx.get(text, timeout=PATIENCE_S).json()["scenario"]["altitude_m"] == 510
    assert ask(other, "scenario()")["altitude_m"] == 490
    expect(other.locator("[data-vehicle='sim-1'] [data-cell=edited] .value")).to_contain_text("ANOTHER TAB")
    other.get_by_role("button", name="Keep this one beside it").click()
    await_hook(other, "kept().state === 'kept'")
    beside = ask(other, "kept()")["id"]
    assert beside != kept
    assert httpx.get(text, timeout=PATIENCE_S).json()["scenario"]["altitude_m"] == 510
    other.close()


def test_a_page_opened_too_early_takes_the_first_plan(page: Page, planned: str, service: Service) -> None:
    """A service that has nothing yet, and plans its first scenario, shows it without a reload."""
    lists = re.compile(r"/api/v1/(plans|scenarios)(\?.*)?$")
    early = page.context.new_page()
    early.route(lists, lambda route: route.fulfill(json={"plans": [], "scenarios": [], "total": 0}))
    early.goto(service.address)
    early.wait_for_function("window.swathplan !== undefined")
    expect(early.locator("#recent")).to_contain_text("None yet.", timeout=LIMIT_MS)
    assert ask(early, "scenario()")["features"] == []
    early.unroute(lists)
    await_hook(early, "scenario().features.length > 0")
    early.close()


def test_a_file_opened_early_stays(page: Page, service: Service) -> None:
    """What was edited last, and comes from the service late, does not take the place of what was opened."""
    asked_for: list[Route] = []
    newest = {"id": "last", "name": "last", "revision": 1, "changed_at": "2999-01-01T00:00:00Z"}

    def listed(route: Route) -> None:
        if route.request.method == "GET":
            route.fulfill(json={"scenarios": [newest], "total": 1})
        else:
            route.continue_()

    early = page.context.new_page()
    early.route(re.compile(r"/api/v1/scenarios(\?.*)?$"), listed)
    early.route(re.compile(r"/api/v1/scenarios/last$"), lambda route: asked_for.append(route))
    with early.expect_request(re.compile(r"/api/v1/scenarios/last$"), timeout=LIMIT_MS):
        early.goto(service.address)
    open_scenario(early, EXAMPLES / "sar-case-2.geojson")
    opened = ask(early, "scenario()")["name"]
    with early.expect_response(re.compile(r"/api/v1/scenarios/last$"), timeout=LIMIT_MS):
        asked_for[0].fulfill(json=newest | {"scenario": CASE_1 | {"name": "last"}})
    early.wait_for_timeout(500.0)
    assert ask(early, "scenario()")["name"] == opened
    early.close()


def test_what_failed_is_not_said_once_it_is_done(page: Page) -> None:
    """A notice of a failure goes when the same is done after all."""
    go_to(page, "Scenario")
    page.get_by_text("Kept scenarios", exact=True).click()
    again = page.locator("details", has=page.locator("#kept-scenarios")).get_by_role("button", name="Refresh")
    lists = re.compile(r"/api/v1/scenarios(\?.*)?$")
    page.route(lists, lambda route: route.abort())
    notice = page.locator("#notices .notice", has_text="The kept scenarios were not listed")
    for _ in range(2):
        again.click()
        expect(notice).to_have_count(1)
    page.unroute(lists)
    again.click()
    expect(notice).to_have_count(0)


def test_a_lost_service_is_said_above_every_tab(page: Page) -> None:
    """Without the service the alarm says that nothing is up to date."""
    page.context.set_offline(True)
    expect(page.locator("#alarm")).to_contain_text("service is not reachable", timeout=LIMIT_MS)
    page.context.set_offline(False)
    expect(page.locator("#alarm")).to_be_hidden(timeout=LIMIT_MS)
