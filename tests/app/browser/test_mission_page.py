"""Mission files of other programs, dropped on the page: items, fence and rally points, judged as they lie."""

from __future__ import annotations

import json

import pytest
from playwright.sync_api import Page, expect

from tests.app.browser.helpers import ask, await_hook, open_scenario
from tests.app.browser.test_import_page import drop
from tests.app.imports.test_surveys import SENTERA, with_camera
from tests.mavlink.formats.test_qgc_complex import SURVEY, plan_of

pytestmark = pytest.mark.browser

ROW = "{}\t0\t{}\t{}\t{}\t0\t0\t0\t{}\t{}\t{}\t1"


def rows(lat: float, lon: float) -> bytes:
    """Two waypoints north of a place, a fence round all, a circle on the way, a rally point."""
    lines = ["QGC WPL 110", f"0\t1\t0\t16\t0\t0\t0\t0\t{lat}\t{lon}\t0\t1"]
    lines += [ROW.format(n, 3, 16, 0, lat + 0.01 * n, lon, 60) for n in (1, 2)]
    corners = [(-0.05, -0.05), (0.05, -0.05), (0.05, 0.05), (-0.05, 0.05)]
    lines += [ROW.format(3, 0, 5001, 4, lat + north, lon + east, 0) for north, east in corners]
    lines += [
        ROW.format(7, 0, 5004, 100, lat + 0.015, lon, 0),
        ROW.format(8, 3, 5100, 0, lat, lon + 0.01, 30),
    ]
    return "\n".join(lines).encode()


def opened(page: Page, before: str | None) -> str:
    """The id of the plan that came onto the map in place of another."""
    await_hook(page, f"plan() !== null && window.swathplan.plan().id !== '{before}'")
    return str(ask(page, "plan()")["id"])


def test_a_dropped_mission_is_shown_and_judged(page: Page) -> None:
    """Beside a sound scenario it is judged in that; items and fence are drawn, its breach told."""
    open_scenario(page)
    expect(page.locator("#findings")).to_have_attribute("data-state", "sound")
    scenario = ask(page, "scenario()")
    start = next(f for f in scenario["features"] if f["properties"]["role"] == "start")
    lon, lat = start["geometry"]["coordinates"][:2]
    drop(page, "morning.waypoints", rows(lat, lon))
    opened(page, None)
    # path, two fences, one rally point
    assert ask(page, "plan()") | {"id": ""} == {"id": "", "features": 4, "waypoints": 2}
    assert ask(page, "scenario()") == scenario
    expect(page.get_by_role("tab", name="Plan")).to_have_attribute("aria-selected", "true")
    expect(page.locator("#violations")).to_contain_text("fence 2")
    expect(page.locator("#notices")).to_contain_text("judged in the scenario on the page")
    ask(page, f"look({lon}, {lat + 0.01}, 12)")
    layers = {"fence_in-line", "fence_out-fill", "rally", "waypoint", "path-line"}
    await_hook(page, f"rendered() && {sorted(layers)}.every(id => window.swathplan.rendered()[id] > 0)")


def test_a_mission_of_elsewhere_brings_its_own_place(page: Page) -> None:
    """Far from the page's scenario it is judged by its own fence, and takes the scenario's place."""
    before = ask(page, "plan()")["id"]
    drop(page, "away.waypoints", rows(-35.0, 149.0))
    page.wait_for_function(
        "before => document.querySelector('#dialog-go') || window.swathplan.plan()?.id !== before", arg=before
    )
    if page.locator("#dialog-go").count():
        page.click("#dialog-go")
    opened(page, before)
    roles = sorted(f["properties"]["role"] for f in ask(page, "scenario()")["features"])
    assert roles == ["area", "no_fly", "start"]
    expect(page.locator("#notices")).to_contain_text("by its own fence alone")


def test_a_mission_that_cannot_be_read_is_refused_in_words(page: Page) -> None:
    """Line and fault stand on the page; the plan stays."""
    before = ask(page, "plan()")
    drop(page, "bad.waypoints", b"QGC WPL 110\n0\t1\t2\n")
    expect(page.locator("#notices")).to_contain_text("line 2")
    assert ask(page, "plan()") == before


def test_surveys_of_a_plan_can_be_taken_over(page: Page) -> None:
    """Asked which is wanted, the surveys join the scenario with their camera beside its sensors."""
    before = ask(page, "scenario()")
    drop(page, "field.plan", json.dumps(plan_of(with_camera(SURVEY, SENTERA))).encode())
    page.click("#dialog-regions")
    await_hook(page, "scenario().sensors.some(s => s.name === 'Sentera Double 4K')")
    after = ask(page, "scenario()")
    assert after["sensors"][:-1] == before["sensors"]
    survey = next(f for f in after["features"] if f["id"] == "survey 1")
    assert survey["properties"]["sensor"] == after["sensors"][-1]["name"]
    expect(page.locator("#notices")).to_contain_text("headings 0° and 180°")
