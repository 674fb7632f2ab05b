"""Where aircraft will be when they take up a new plan: told by the mission that they fly."""

from __future__ import annotations

import json
import random
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pyproj import Geod

from app.services.plans.along import Course, ahead, allowance_s, where_planned
from app.services.plans.replanned import Changes, seen_by_plan
from app.services.plans.replanning import Asked, Told, left_of
from planner.check.clearance import begun_violations
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.plan import Plan
from planner.scenario import Scenario

EXAMPLES = Path(__file__).parents[4] / "examples"
GEOD = Geod(ellps="WGS84")


@pytest.fixture(scope="module")
def document() -> dict[str, Any]:
    """The scenario of three aircraft."""
    found: dict[str, Any] = json.loads((EXAMPLES / "three-aircraft.geojson").read_text())
    return found


@pytest.fixture(scope="module")
def flown(document: dict[str, Any]) -> tuple[Scenario, Plan]:
    """It, read, and its plan."""
    scenario = read_scenario(document)
    return scenario, make_plan(scenario)


def test_an_aircraft_beside_its_line_is_later_where_the_line_goes(flown: tuple[Scenario, Plan]) -> None:
    """At random times, metres off, a few seconds early or late: the line's own place, whatever it crosses."""
    scenario, plan = flown
    rng = random.Random(11)
    for path in plan.paths:
        course = Course(scenario, plan, path.vehicle, path.sortie)
        for _ in range(40):
            since_s = rng.uniform(25.0, course.leaves_s - 30.0)
            by_s = rng.uniform(0.5, 20.0)
            place, meant = course.place(since_s), course.place(since_s + by_s)
            lon_deg, lat_deg, _ = GEOD.fwd(place.lon_deg, place.lat_deg, rng.uniform(0.0, 360.0), 8.0)
            off = replace(place, lon_deg=lon_deg, lat_deg=lat_deg, flown_s=since_s + rng.uniform(-4.0, 4.0))
            found = ahead(scenario, plan, path.vehicle, off, by_s)
            assert found is not None
            there = found.then
            line_m = scenario.frame.to_local([at[:2] for at in found.line])
            along_m = float(np.hypot(*np.diff(line_m, axis=0).T).sum())
            assert along_m == pytest.approx(there.flown_m - off.flown_m, rel=0.02, abs=1.0)
            assert found.line[-1][:2] == pytest.approx((there.lon_deg, there.lat_deg))
            assert GEOD.inv(there.lon_deg, there.lat_deg, meant.lon_deg, meant.lat_deg)[2] < 12.0
            assert there.flown_s - off.flown_s == pytest.approx(by_s)
            over = {s.collect.seq for s in found.soon if s.whole}
            own = plan.of(path.vehicle, path.sortie).collects
            assert over == {c.seq for c in own if since_s < c.end_s <= since_s + by_s}


def test_one_on_no_line_of_its_plan_stays_where_it_is(flown: tuple[Scenario, Plan]) -> None:
    """Far beside it, on the opposite course, or above it: nobody knows where it flies."""
    scenario, plan = flown
    place = where_planned(scenario, plan, 200.0)["north"]
    far = replace(place, lat_deg=place.lat_deg + 0.05)
    assert place.heading_deg is not None
    back = replace(place, heading_deg=(place.heading_deg + 180.0) % 360.0)
    for each in (far, back, replace(place, height_m=place.height_m + 200.0)):
        assert ahead(scenario, plan, "north", each, 10.0) is None


def test_a_plan_made_in_flight_begins_where_aircraft_are_by_then(
    document: dict[str, Any], flown: tuple[Scenario, Plan]
) -> None:
    """As if asked for later by the allowance; one that is told of is where it was told."""
    scenario, plan = flown
    at_s = 300.0
    by_s = allowance_s(plan, [path.vehicle for path in plan.paths])
    soon = left_of(document, scenario, plan, Asked(at_s, {}, None, Changes()))
    assert soon["replan"]["begins_in_s"] == by_s > 2.0
    later = left_of(document, scenario, plan, Asked(at_s + by_s, {}, None, Changes(), 0.0))
    assert later["replan"]["begins_in_s"] == 0.0
    for one, other in zip(soon["vehicles"], later["vehicles"], strict=True):
        assert one["in_flight"] == pytest.approx(other["in_flight"], abs=1e-4)
        assert one["max_flight_time_s"] == pytest.approx(other["max_flight_time_s"], abs=0.1)
    assert [f["id"] for f in soon["features"]] == [f["id"] for f in later["features"]]
    far_deg = document["features"][0]["geometry"]["coordinates"][1] + 0.05
    told = Asked(at_s, {"north": Told(lat_deg=far_deg)}, None, Changes())
    (north,) = (v for v in left_of(document, scenario, plan, told)["vehicles"] if v["name"] == "north")
    assert north["in_flight"]["lat_deg"] == told.vehicles["north"].lat_deg


def test_a_zone_drawn_across_what_is_flown_until_then_is_told(
    document: dict[str, Any], flown: tuple[Scenario, Plan]
) -> None:
    """Ahead of one aircraft, and behind it by then: in it is the old line alone, and that is named."""
    scenario, plan = flown
    at_s, by_s = 300.0, 12.0
    since_s = at_s - plan.path_of("north").start_s
    line = Course(scenario, plan, "north", 1).line(since_s, since_s + by_s)
    lon_deg, lat_deg, _ = line[len(line) // 2] if len(line) > 2 else np.mean(line, axis=0).tolist()
    zone = {
        "type": "Feature", "id": "new zone",
        "geometry": {"type": "Point", "coordinates": [lon_deg, lat_deg]},
        "properties": {"role": "no_fly", "radius_m": 20.0},
    }  # fmt: skip

    def told(in_s: float) -> list[str]:
        asked = Asked(at_s, {}, None, Changes(features=(zone,)), in_s)
        left = left_of({**document, "clearance_m": 5.0}, scenario, plan, asked)
        read = read_scenario(left)
        return [found.message for found in begun_violations(read) if found.feature == "new zone"]

    (said,) = told(by_s)
    assert said.startswith("north flies")
    assert "by the old plan, before this one begins 12 s after" in said
    assert told(0.0) == []
    assert list(begun_violations(scenario)) == []


def test_of_a_pass_that_is_over_by_then_nothing_is_left(
    document: dict[str, Any], flown: tuple[Scenario, Plan]
) -> None:
    """Asked for while it is flown: its region is gone; with no time for it, the region stays."""
    scenario, plan = flown
    first = min(plan.collects, key=lambda collect: collect.end_s)
    (name,) = first.regions
    assert name not in seen_by_plan(scenario, plan, first.end_s - 1.0)

    def left(by_s: float) -> set[str]:
        asked = Asked(first.end_s - 1.0, {}, None, Changes(), by_s)
        return {f["id"] for f in left_of(document, scenario, plan, asked)["features"]}

    assert name not in left(2.0)
    assert name in left(0.0)
