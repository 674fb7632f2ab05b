"""Regions at altitudes of their own: passes level there, flyable climbs between, zones by height."""

from __future__ import annotations

import copy
import itertools
import json
import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.geometry import LineString, Polygon

from mavlink.encoding.encode import encode
from mavlink.wire.items import Command
from planner.check import judge
from planner.geojson import read_plan, read_scenario, write_plan
from planner.pipeline import make_plan, with_bound
from planner.plan import Plan
from tests.planner.scenarios import feature, small, square
from tests.planner.terrains import raster

Document = dict[str, Any]
TYPES = ("fixed_wing", "vtol", "multirotor")
CLIMB_DEG = 8.0


def three(altitudes_m: tuple[float | None, ...], kind: str = "fixed_wing", **members: Any) -> Document:
    """Three regions along a line, each at an altitude, seen by an aircraft of a kind."""
    document = small(**members)
    document["features"] = [f for f in document["features"] if f["properties"]["role"] != "roi"]
    for k, altitude_m in enumerate(altitudes_m):
        own = {} if altitude_m is None else {"altitude_m": altitude_m}
        place = square(0.01 + 0.02 * k, 0.004, 0.004)
        document["features"].append(feature(f"R{k}", "roi", "Polygon", place, **own))
    document["vehicles"][0]["type"] = kind
    return document


def plan_of(document: Document, **rasters: Any) -> Plan:
    return make_plan(read_scenario(document, rasters))


def line_of(plan: Plan, document: Document) -> tuple[np.ndarray, np.ndarray]:
    """Places in metres, and altitudes, of the whole line."""
    line = np.array(plan.paths[0].line)
    return np.array(read_scenario(document).frame.to_local(line[:, :2])), line[:, 2]


altitudes = st.one_of(st.none(), st.sampled_from([150.0, 300.0, 420.0, 700.0, 1200.0]))


@given(st.tuples(altitudes, altitudes, altitudes), st.sampled_from(TYPES))
@settings(max_examples=12)
def test_passes_are_level_at_their_altitudes(wished: tuple[float | None, ...], kind: str) -> None:
    """Whatever the heights: all seen, nothing violated, each pass at its own, slopes within the limit."""
    document = three(wished, kind)
    plan = plan_of(document)
    assert plan.violations == ()
    assert set(plan.metrics.coverage.values()) == {1.0}
    asked = {f"R{k}": document["altitude_m"] if own is None else own for k, own in enumerate(wished)}
    for collect in plan.collects:
        assert {place[2] for place in collect.line} == {asked[collect.roi]}
    places, heights_m = line_of(plan, document)
    over_m, rises_m = np.hypot(*np.diff(places, axis=0).T), np.abs(np.diff(heights_m))
    moving = over_m > 0.01
    assert np.all(rises_m[moving] <= math.tan(math.radians(CLIMB_DEG + 0.05)) * over_m[moving] + 1e-3)
    if kind == "fixed_wing":
        assert rises_m[~moving].sum() < 0.05
    for collect in plan.collects:
        here = LineString(read_scenario(document).frame.to_local([p[:2] for p in collect.line])).buffer(0.5)
        inside = [h for p, h in zip(places, heights_m, strict=True) if here.covers(LineString([p, p + 1e-6]))]
        assert any(abs(h - asked[collect.roi]) < 1e-6 for h in inside) or not inside


@pytest.mark.parametrize("kind", TYPES)
def test_the_mission_has_every_height(kind: str) -> None:
    """Where the sensor is switched on the waypoint before it is at the altitude of the pass."""
    document = three((300.0, 700.0, None), kind, altitude_reference="terrain")
    plan = read_plan(json.loads(json.dumps(write_plan(plan_of(document)))))
    items = encode(plan, vehicle=plan.vehicles[0].name, autopilot=None).mission
    on_at = [
        round(before.z, 2)
        for before, item in itertools.pairwise(items)
        if item.command == Command.DO_SET_RELAY and item.param2 > 0.0
    ]
    assert on_at == [collect.line[0][2] for collect in plan.collects]


def test_zones_count_where_they_are() -> None:
    """A zone under one pass's height is flown over there, though another region is seen from below it."""
    over = feature("N", "no_fly", "Polygon", square(0.038, -0.014, 0.036), ceiling_m=400.0)
    document = three((200.0, 200.0, 800.0), altitude_reference="amsl")
    document["features"].append(over)
    start = next(f for f in document["features"] if f["properties"]["role"] == "start")
    start["geometry"]["coordinates"] = [*start["geometry"]["coordinates"][:2], 0.0]
    plan = plan_of(document)
    assert plan.violations == ()
    assert set(plan.metrics.coverage.values()) == {1.0}
    places, heights_m = line_of(plan, document)
    frame = read_scenario(document).frame
    zone = Polygon(frame.to_local(over["geometry"]["coordinates"][0]))
    crossed = [
        min(pair_m)
        for pair, pair_m in zip(itertools.pairwise(places), itertools.pairwise(heights_m), strict=True)
        if zone.intersection(LineString(pair)).length > 0.1
    ]
    assert min(crossed) > 400.0


WALL = square(0.018, -0.012, 0.002)
WALL[0][2:4] = [[0.020, 0.020], [0.018, 0.020]]
SHELF = square(0.022, -0.014, 0.034)
BARS = {"wall": (WALL, {"ceiling_m": 350.0}), "shelf": (SHELF, {"floor_m": 350.0, "ceiling_m": 3000.0})}


@pytest.mark.parametrize("kind", TYPES)
@pytest.mark.parametrize("bar", BARS)
@pytest.mark.parametrize("back", [False, True])
def test_heights_are_changed_where_zones_leave_room(kind: str, bar: str, back: bool) -> None:
    """From high to low beside a wall, and to low under an airspace, either way round: nothing is entered."""
    document = three((600.0, 150.0), kind, altitude_reference="amsl")
    ring, band = BARS[bar]
    document["features"].append(feature("N", "no_fly", "Polygon", ring, **band))
    start = next(f for f in document["features"] if f["properties"]["role"] == "start")
    if back:
        document["features"].append(feature("E", "end", "Point", start["geometry"]["coordinates"][:2]))
        start["geometry"]["coordinates"] = [0.055, 0.006]
    start["geometry"]["coordinates"] = [*start["geometry"]["coordinates"][:2], 0.0]
    plan = plan_of(document)
    assert plan.violations == ()
    assert set(plan.metrics.coverage.values()) == {1.0}


@pytest.mark.parametrize("kind", TYPES)
def test_heights_are_changed_clear_of_the_ground(kind: str) -> None:
    """A ridge between a high and a low region is flown over before it goes down, without false zones."""
    document = three((600.0, 150.0), kind, terrain="ridge", altitude_reference="amsl")
    document["features"].append(feature("E", "end", "Point", [0.055, 0.006]))
    frame = read_scenario(three((None, None))).frame
    at_m = float(frame.to_local([(0.021, 0.006)])[0][0])
    ridge = raster(lambda e, n: 5.0 + 300.0 * np.exp(-(((e - at_m) / 250.0) ** 2)), frame)
    plan = plan_of(document, ridge=ridge)
    assert plan.violations == ()


def test_each_region_has_its_height_over_its_own_ground() -> None:
    """On terrain an altitude of a region's own counts over its own highest ground."""
    document = three((150.0, None, 150.0), terrain="hill", altitude_reference="terrain", altitude_m=400.0)
    frame = read_scenario(three((None, None, None))).frame
    ground = raster(lambda e, n: 100.0 + 250.0 / (1.0 + np.exp(-(e - 5500.0) / 250.0)), frame)
    scenario = read_scenario(document, {"hill": ground})
    tops_m = {r.name: scenario.terrain.range_over(r.area)[1] for r in scenario.regions}
    asked = {r.name: r.altitude_m for r in scenario.regions}
    assert asked["R0"] == pytest.approx(150.0 + tops_m["R0"])
    assert asked["R2"] == pytest.approx(150.0 + tops_m["R2"])
    assert asked["R1"] == pytest.approx(400.0 + max(tops_m.values()))
    plan = make_plan(scenario)
    assert plan.violations == ()
    assert min(plan.metrics.coverage.values()) > 0.98


def test_a_pass_at_another_height_is_no_answer() -> None:
    """The judge counts no pass that is flown at another altitude than the region asks for."""
    document = three((300.0, 300.0, None))
    plan = plan_of(three((None, 300.0, None)))
    verdict = judge(read_scenario(document), plan)
    assert "collect-altitude" in {violation.constraint for violation in verdict.violations}
    assert verdict.coverage["R0"] < 1e-6


def test_one_altitude_for_all_is_the_scenarios() -> None:
    """Regions that name the collection's altitude plan the same as regions that name none."""
    asked, none = copy.deepcopy(three((500.0,) * 3)), three((None,) * 3)
    asked["altitude_m"] = none["altitude_m"] = 500.0
    one, other = plan_of(asked), plan_of(none)
    assert one.paths == other.paths
    assert one.collects == other.collects


def test_the_bound_holds_at_several_heights() -> None:
    """No plan over regions at heights of their own is shorter than its bound says."""
    document = three((200.0, 800.0, None))
    scenario = read_scenario(document)
    plan = with_bound(scenario, make_plan(scenario))
    assert plan.metrics.lower_bound_m is not None
    assert 0.0 < plan.metrics.lower_bound_m <= (plan.metrics.route_length_m or 0.0)
