"""Drawing, opening, changing and keeping a scenario on the page."""

from __future__ import annotations

import json
import math
import re
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect
from pyproj import Geod

from planner.geojson.equipment import METHODS
from tests.app.browser.conftest import EXAMPLES
from tests.app.browser.helpers import ask, await_hook, click_place, feature, on_screen, open_scenario

pytestmark = pytest.mark.browser

WGS84 = Geod(ellps="WGS84")
CASE_1 = json.loads((EXAMPLES / "sar-case-1.geojson").read_text(encoding="utf-8"))


def test_an_opened_file_is_drawn_and_accepted(page: Page) -> None:
    """A sample scenario opened by the file input is on the map, and the service finds nothing wrong."""
    open_scenario(page)
    expect(page.locator("#findings")).to_have_attribute("data-state", "sound")
    await_hook(page, "rendered()['roi-fill'] >= 6")
    drawn = ask(page, "rendered()")
    assert {"roi-fill", "missile-fill", "radar-fill", "area-line", "terminal", "scenario-label"} <= set(drawn)


def test_a_region_is_drawn_by_hand(page: Page) -> None:
    """Three clicks and Enter make a region with the corners that were clicked."""
    open_scenario(page)
    corners = [(-117.70, 33.515), (-117.695, 33.515), (-117.695, 33.511)]
    page.click("[data-tool=roi]")
    for corner in corners:
        click_place(page, *corner)
    # What is being drawn tells its size: the side from the second corner to the pointer.
    side = re.fullmatch(r"this side ([0-9]+) m; .* around", page.locator("#drawn-size").inner_text())
    assert side is not None
    assert float(side[1]) == pytest.approx(WGS84.inv(*corners[1], *corners[2])[2], abs=15.0)
    page.keyboard.press("Enter")
    await_hook(page, "selected() === 'R7'")
    expect(page.locator("#drawn-size")).to_be_empty()
    drawn = feature(page, "R7")
    assert drawn is not None
    ring = drawn["geometry"]["coordinates"][0]
    assert ring[0] == ring[-1]
    assert len(ring) == 4
    for lon, lat in corners:
        assert min(WGS84.inv(lon, lat, x, y)[2] for x, y in ring) < 30.0
    # Its size stands in its form, as geodesics have it.
    area_m2, around_m = WGS84.polygon_area_perimeter(*zip(*ring, strict=True))
    told = page.locator("#f-size").inner_text()
    found = re.fullmatch(r"([0-9.]+) ha, ([0-9.]+) km around", told)
    assert found is not None, told
    assert float(found[1]) == pytest.approx(abs(area_m2) / 1e4, abs=0.006)
    assert float(found[2]) == pytest.approx(around_m / 1e3, abs=0.006)


def test_a_threat_circle_has_the_radius_drawn(page: Page) -> None:
    """A radar circle drawn with two clicks has its centre and its radius where they were clicked."""
    open_scenario(page)
    centre, edge = (-117.72, 33.50), (-117.7115, 33.50)
    page.click("[data-tool=radar]")
    click_place(page, *centre)
    page.mouse.move(*on_screen(page, -117.715, 33.50))
    click_place(page, *edge)
    await_hook(page, "selected() === 'D4'")
    drawn = feature(page, "D4")
    assert drawn is not None
    assert drawn["properties"]["model"] == "radar"
    lon, lat = drawn["geometry"]["coordinates"]
    assert WGS84.inv(lon, lat, *centre)[2] < 30.0
    assert drawn["properties"]["radius_m"] == pytest.approx(WGS84.inv(*centre, *edge)[2], rel=0.05)


def test_a_feature_is_moved_and_brought_back(page: Page) -> None:
    """A selected region follows the pointer that drags it; undo puts it back."""
    open_scenario(page)
    before = feature(page, "R4")
    assert before is not None
    page.get_by_role("button", name="R4", exact=True).click()
    ring = before["geometry"]["coordinates"][0]
    middle = sum(p[0] for p in ring[:-1]) / (len(ring) - 1), sum(p[1] for p in ring[:-1]) / (len(ring) - 1)
    x, y = on_screen(page, *middle)
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 20, y - 20, steps=5)
    page.mouse.move(x + 60, y - 40, steps=5)
    page.mouse.up()
    await_hook(
        page, f"scenario().features.find(f => f.id === 'R4').geometry.coordinates[0][0][0] !== {ring[0][0]}"
    )
    moved = feature(page, "R4")
    assert moved is not None
    shifts = [WGS84.inv(*p, *q)[2] for p, q in zip(ring, moved["geometry"]["coordinates"][0], strict=True)]
    assert min(shifts) == pytest.approx(max(shifts), rel=0.01)
    page.keyboard.press("Control+z")
    after = feature(page, "R4")
    assert after is not None
    assert after["geometry"] == before["geometry"]


def test_deleting_needs_no_mouse(page: Page) -> None:
    """The Delete key takes the selected feature away."""
    open_scenario(page)
    page.get_by_role("button", name="M2", exact=True).focus()
    page.keyboard.press("Enter")
    page.keyboard.press("Delete")
    assert feature(page, "M2") is None


def test_a_shape_can_be_placed_without_a_pointer(page: Page) -> None:
    """Keys alone choose a tool, place a region in the middle of the view, and give it coordinates."""
    open_scenario(page)
    page.locator("[data-tool=no_fly]").focus()
    page.keyboard.press("Enter")
    page.get_by_role("button", name="Place in the middle").focus()
    page.keyboard.press("Enter")
    page.locator("#f-coordinates").fill("-117.70, 33.53\n-117.69, 33.53\n-117.69, 33.535")
    page.keyboard.press("Tab")
    drawn = feature(page, "N1")
    assert drawn is not None
    assert drawn["geometry"]["coordinates"] == [
        [[-117.70, 33.53], [-117.69, 33.53], [-117.69, 33.535], [-117.70, 33.53]]
    ]


def test_a_refused_scenario_says_why_and_where(page: Page, tmp_path: Path) -> None:
    """A ring that crosses itself is named with its rule; a click on the finding goes to the feature."""
    broken = json.loads(json.dumps(CASE_1))
    ring = next(f for f in broken["features"] if f["id"] == "R5")["geometry"]["coordinates"][0]
    ring[1], ring[4] = ring[4], ring[1]
    path = tmp_path / "broken.geojson"
    path.write_text(json.dumps(broken), encoding="utf-8")
    open_scenario(page, path)
    expect(page.locator("#findings")).to_have_attribute("data-state", "refused")
    finding = page.locator("#findings li", has_text="R5")
    zoom = ask(page, "zoom()")
    finding.get_by_role("button").first.click()
    await_hook(page, f"zoom() > {zoom}")
    assert ask(page, "selected()") == "R5"
    lon, lat = ask(page, "centre()")
    assert WGS84.inv(lon, lat, -117.6710, 33.4941)[2] < 500.0
    page.get_by_role("tab", name="Plan").click()
    expect(page.locator("#plan-start")).to_be_disabled()


def test_a_file_that_is_no_scenario_is_refused_in_words(page: Page, tmp_path: Path) -> None:
    """A file of another kind leaves the scenario as it is, and the page says what is wrong with it."""
    open_scenario(page)
    path = tmp_path / "other.json"
    path.write_text('{"type": "Topology"}', encoding="utf-8")
    page.set_input_files("#file", path)
    expect(page.locator("#notices")).to_contain_text("not a GeoJSON FeatureCollection")
    assert len(ask(page, "scenario()")["features"]) == len(CASE_1["features"])


def test_edits_outlive_a_reload_and_the_download_holds_them(page: Page) -> None:
    """What was changed is there after a reload, and the downloaded file is the scenario shown."""
    open_scenario(page)
    page.locator("#s-altitude_m").fill("620")
    page.keyboard.press("Tab")
    page.reload()
    page.wait_for_function("window.swathplan !== undefined")
    assert ask(page, "scenario()")["altitude_m"] == 620
    with page.expect_download() as waiting:
        page.get_by_role("button", name="Download").click()
    saved = json.loads(Path(waiting.value.path()).read_text(encoding="utf-8"))
    assert saved == CASE_1 | {"altitude_m": 620}


def test_the_methods_offered_are_those_the_planner_knows(page: Page) -> None:
    """Each stage's list on the page names the planner's methods, all of them and no others."""
    open_scenario(page)
    page.get_by_text("Methods", exact=True).click()
    for stage, names in METHODS.items():
        if stage != "search":
            assert page.locator(f"#m-{stage} option").evaluate_all("o => o.map(e => e.value)") == list(names)


def test_a_corridor_is_drawn_as_its_strip(page: Page) -> None:
    """A line drawn by three clicks is a corridor; the map shows the ground within half its width."""
    open_scenario(page)
    page.click("[data-tool=corridor]")
    for corner in ((-117.70, 33.535), (-117.69, 33.535), (-117.685, 33.531)):
        click_place(page, *corner)
    page.keyboard.press("Enter")
    await_hook(page, "selected() === 'R7'")
    page.get_by_label("Width (m)").fill("300")
    page.keyboard.press("Tab")
    drawn = feature(page, "R7")
    assert drawn is not None
    assert drawn["geometry"]["type"] == "LineString"
    assert len(drawn["geometry"]["coordinates"]) == 3
    assert drawn["properties"]["width_m"] == 300
    page.get_by_role("button", name="Done").click()
    lon, lat = drawn["geometry"]["coordinates"][0]
    inside = WGS84.fwd(lon, lat, 45.0, 150.0)[:2]
    page.wait_for_timeout(400)
    click_place(page, *inside)
    await_hook(page, "selected() === 'R7'")


def test_a_point_target_can_be_seen_and_chosen(page: Page) -> None:
    """A target of no extent is a sign on the map, and a click on it selects it."""
    open_scenario(page)
    page.click("[data-tool=target]")
    click_place(page, -117.70, 33.535)
    await_hook(page, "selected() === 'R7'")
    page.get_by_role("button", name="Done").click()
    await_hook(page, "rendered()['target'] === 1")
    click_place(page, -117.70, 33.535)
    await_hook(page, "selected() === 'R7'")


def test_margins_and_wind_reach_the_document(page: Page) -> None:
    """What the forms take stands in the scenario under the contract's names, and goes when it is emptied."""
    open_scenario(page)
    for heading in ("Aircraft", "Sensor"):
        page.locator("summary", has_text=heading).click()
    entries = {
        "#sensors-0-pointing_margin_deg": "1.5",
        "#sensors-0-position_margin_m": "5",
        "#sensors-0-squint_deg": "-10",
        "#vehicles-0-settle_m": "150",
        "#vehicles-0-max_load_factor": "1.2",
        "#s-clearance_m": "50",
        "#wind-speed_m_s": "6",
        "#wind-from_deg": "270",
    }
    for field, text in entries.items():
        page.locator(field).fill(text)
        page.keyboard.press("Tab")
    page.select_option("#vehicles-0-type", "vtol")
    page.check("#sensors-0-stabilised")
    made = ask(page, "scenario()")
    sensor, vehicle = made["sensors"][0], made["vehicles"][0]
    assert (sensor["pointing_margin_deg"], sensor["position_margin_m"], sensor["squint_deg"]) == (1.5, 5, -10)
    assert sensor["stabilised"] is True
    assert (vehicle["settle_m"], vehicle["max_load_factor"], vehicle["type"]) == (150, 1.2, "vtol")
    assert (made["clearance_m"], made["wind"]) == (50, {"speed_m_s": 6, "from_deg": 270})
    page.uncheck("#sensors-0-stabilised")
    assert "stabilised" not in ask(page, "scenario()")["sensors"][0]
    # A known airframe's figures take the place of the usual ones.
    model = {"#vehicles-0-max_items": "300", "#vehicles-0-model": "dji mavic 2 pro"}
    for field, text in ({"#wind-speed_m_s": ""} | model).items():
        page.locator(field).fill(text)
        page.keyboard.press("Tab")
    vehicle = ask(page, "scenario()")["vehicles"][0]
    assert (vehicle["model"], vehicle["max_items"]) == ("DJI Mavic 2 Pro", 300)
    assert not {"type", "airspeed_m_s", "max_range_m", "min_turn_radius_m"} & set(vehicle)
    expect(page.locator("#vehicles-0-type")).to_have_value("multirotor")
    assert "wind" not in ask(page, "scenario()")


def test_a_finding_is_shown_where_the_feature_is(page: Page) -> None:
    """A refused feature is marked in the list and on the tab, and its form says what is wrong with it."""
    open_scenario(page)
    page.get_by_role("button", name="R5", exact=True).click()
    page.locator("#f-coordinates").fill("-117.60, 33.40\n-117.59, 33.40\n-117.59, 33.41")
    page.keyboard.press("Tab")
    expect(page.locator("fieldset.selected .findings")).to_contain_text("outside")
    expect(page.locator(".chip.wrong")).to_have_text("R5")
    expect(page.get_by_role("tab", name="Scenario")).to_contain_text("1 refused")
    page.keyboard.press("Control+z")
    expect(page.locator(".chip.wrong")).to_have_count(0)


def test_every_control_has_a_name(page: Page) -> None:
    """No field, list or button of the page is without an accessible name."""
    open_scenario(page)
    page.evaluate("document.querySelectorAll('details').forEach(d => d.open = true)")
    nameless = page.evaluate(
        """() => [...document.querySelectorAll('input, select, textarea, button')].filter(
            (e) => !(e.labels?.length || e.getAttribute('aria-label') || e.title || e.textContent.trim())
        ).map((e) => e.outerHTML)"""
    )
    assert nameless == []


def test_what_is_looked_for_at_sea_is_drawn_where_it_has_drifted_to(page: Page) -> None:
    """Discs round where it is by take-off, none beyond; what is edited is in the document."""
    open_scenario(page, EXAMPLES / "missing-at-sea.geojson")
    seen = json.loads((EXAMPLES / "missing-at-sea.geojson").read_text())
    (point,) = (f for f in seen["features"] if f["properties"]["role"] == "importance")
    drift, spread_m = seen["search"]["drift"], point["properties"]["spread_m"]
    spread_m = math.hypot(spread_m, drift["spread_m_s"] * drift["elapsed_s"])
    lon_deg, lat_deg = point["geometry"]["coordinates"]
    moved_m = drift["speed_m_s"] * drift["elapsed_s"]
    now = WGS84.fwd(lon_deg, lat_deg, drift["toward_deg"], moved_m)[:2]
    page.evaluate("([lon, lat]) => window.swathplan.look(lon, lat, 12)", list(now))
    for off, drawn in ((0.0, True), (2.3, True), (2.8, False)):
        place = WGS84.fwd(*now, drift["toward_deg"], off * spread_m)[:2]
        assert ("importance-fill" in ask(page, f"at({place[0]}, {place[1]})")) is drawn
    assert page.input_value("#search-detection") == "0.7"
    page.fill("#drift-speed_m_s", "0.9")
    page.locator("#drift-speed_m_s").blur()
    await_hook(page, "scenario().search.drift.speed_m_s === 0.9")
    page.fill("#drift-speed_m_s", "")
    page.locator("#drift-speed_m_s").blur()
    await_hook(page, "scenario().search.drift === undefined")
    assert ask(page, "scenario()")["search"] == {"detection": 0.7}
    page.get_by_text("Methods", exact=True).click()
    offered = page.locator("#m-search option").evaluate_all("o => o.map(e => e.value)")
    assert offered == list(METHODS["search"])
    assert page.locator("#m-coverage").count() == 0
    page.click("[data-tool=last_seen]")
    click_place(page, *now)
    await_hook(page, "selected() === 'I1'")
    drawn = feature(page, "I1")
    assert drawn is not None
    assert drawn["geometry"]["type"] == "Point"
    # Somebody is there: the density's integral over the plane is 1.
    own = drawn["properties"]
    assert own["score"] * math.tau * own["spread_m"] ** 2 == pytest.approx(1.0, rel=1e-3)
    page.get_by_label("Spread (one standard deviation)").fill("500")
    page.keyboard.press("Tab")
    await_hook(page, "scenario().features.some(f => f.properties.spread_m === 500)")


def _square(west_m: float, east_m: float) -> dict[str, object]:
    """Ground of a kilometre from south to north, between two distances east of a place."""
    places = [(west_m, -500.0), (east_m, -500.0), (east_m, 500.0), (west_m, 500.0)]
    ring = [list(WGS84.fwd(*WGS84.fwd(8.5, 47.4, 90.0, east)[:2], 0.0, north)[:2]) for east, north in places]
    return {"type": "Polygon", "coordinates": [[*ring, ring[0]]]}


@pytest.mark.parametrize(("west_score", "raster"), [(1.0, False), (3.0, True)])
def test_what_is_left_to_be_found_changes_with_the_clock(page: Page, west_score: float, raster: bool) -> None:
    """Of a square, its east seen before the search and its west in the plan's pass, each look finding 60 %:
    half-way along the pass half of the west has been looked at, of what the look before has left. Also where
    a raster says what ground is worth."""
    west, east = _square(-500.0, 0.0), _square(0.0, 500.0)
    line = [WGS84.fwd(8.5, 47.4, heading, 500.0)[:2] for heading in (180.0, 0.0)]
    own = {"vehicle": "uav", "seq": 1, "roi": "all", "sensor": "eye"}
    times = {"start_s": 100.0, "end_s": 200.0, "start_m": 0.0, "end_m": 1000.0}

    def feature_of(geometry: object, **properties: object) -> dict[str, object]:
        return {"type": "Feature", "geometry": geometry, "properties": properties}

    track = {"type": "LineString", "coordinates": line}
    mission = {"kind": "mission", **times, "start_s": 0.0}
    metrics = {"length_m": 1000, "collection_length_m": 1000, "duty_cycle": 1, "path_length_ratio": None}
    metrics |= {"risk_missile": 0, "risk_radar": 0, "turns": 0, "duration_s": 200, "area_seen_m2": 5e5}
    metrics |= {"coverage": {}, "planning_time_s": {}, "lower_bound_m": 0.0}
    features = [
        feature_of(track, role="path", vehicle="uav", sortie=1, length_m=1000.0, phases=[mission]),
        feature_of(track, role="collect", **own, **times),
        feature_of(west, role="footprint", **own),
    ]
    role, made = ("roi", "of-raster") if raster else ("importance", "of-features")
    square = feature_of(_square(-500.0, 500.0), role=role, name="all", **({} if raster else {"score": 1.0}))
    scenario = {"type": "FeatureCollection", "name": "square", "features": [square], "task": "search"}
    scenario |= {"importance_raster": "worth"} if raster else {}
    ring = [*west["coordinates"][0], *east["coordinates"][0]]
    bounds = [f(place[i] for place in ring) for f, i in ((min, 0), (min, 1), (max, 0), (max, 1))]
    grid = {"bounds_deg": bounds, "columns": 64, "rows": 64, "values": ([west_score] * 32 + [1.0] * 32) * 64}
    page.route(re.compile(r"/api/v1/terrain/worth/grid"), lambda route: route.fulfill(json=grid))
    answers = {
        "": {"id": made, "name": "square", "state": "done"},
        "/scenario": scenario | {"search": {"detection": 0.6, "seen": [east]}},
        "/plan.geojson": {
            "type": "FeatureCollection", "features": features, "metrics": metrics, "violations": [],
        },
        "/mission.plan": {},
    }  # fmt: skip
    page.route(
        re.compile(r"/api/v1/plans(\?.*)?$"), lambda route: route.fulfill(json={"plans": [answers[""]]})
    )
    page.route(
        re.compile(rf"/api/v1/plans/{made}"),
        lambda route: route.fulfill(json=answers[route.request.url.partition(made)[2].partition("?")[0]]),
    )
    page.get_by_role("tab", name="Plan").click()
    page.get_by_role("button", name="Refresh").last.click()
    page.locator("#recent").get_by_role("button", name="square · done").click()
    if page.locator("#dialog-go").count():
        page.click("#dialog-go")
    await_hook(page, f"plan()?.id === '{made}'")
    await_hook(page, "found(0) === 0")
    # What was opened is looked at, wherever the map was before.
    lon, lat = ask(page, "centre()")
    assert WGS84.inv(lon, lat, 8.5, 47.4)[2] < 1000.0
    share = 0.6 * west_score / (west_score + 0.4)
    assert ask(page, "found(200)") == pytest.approx(share, abs=0.01)
    assert ask(page, "found(150)") == pytest.approx(share / 2.0, abs=0.01)
    page.locator("#crew input[type=range]").fill("150")
    expect(page.locator("#clock-found")).to_contain_text(" %")
    said = re.search(r"(\d+) %", page.locator("#clock-found").inner_text())
    assert said is not None
    assert float(said[1]) == pytest.approx(50.0 * share, abs=1.0)
    await_hook(page, "rendered()['seen_before-fill'] > 0")
    page.unroute_all()
