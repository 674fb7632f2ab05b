"""What a flight missed, its report, and the plan that makes up for it."""

from __future__ import annotations

import json
from collections.abc import AsyncIterator, Callable
from dataclasses import dataclass
from typing import Any

import httpx
import numpy as np
import pytest
from shapely import union_all
from shapely.geometry import LineString, shape

from app.main import create_app
from app.routers.bodies import EXAMPLE
from app.services.flights.as_flown import SLIVER_M, gaps
from app.services.flights.refly import refly_scenario
from app.services.house import House
from app.services.plans.missions import plan_of
from app.services.records import TrackSample
from app.services.store.flights import FlightStore
from app.settings import Settings
from planner.as_flown.coverage import FlownCoverage
from planner.geojson import read_scenario
from planner.plan import Plan
from tests.app.conftest import fake_house, serving
from tests.app.test_problems import check_problem
from tests.patience import PATIENCE_S

SCENARIO = read_scenario(EXAMPLE)


def track_of(plan: Plan, skipped: Callable[[int, float], bool]) -> list[TrackSample]:
    """The path flown exactly, the sensor on in the collects but where ``skipped(seq, metres into it)``."""
    frame = SCENARIO.frame
    path = plan.paths[0]
    line_m = np.column_stack([frame.to_local([place[:2] for place in path.line]), [p[2] for p in path.line]])
    reached_m = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line_m, axis=0), axis=1))])
    scale = reached_m[-1] / path.length_m
    samples = []
    for step in range(int(path.length_m // 5)):
        along_m = 5.0 * step
        east_m, north_m, altitude_m = (np.interp(along_m * scale, reached_m, axis) for axis in line_m.T)
        lon_deg, lat_deg = frame.to_wgs84((east_m, north_m))
        on = any(
            c.start_m <= along_m <= c.end_m and not skipped(c.seq, along_m - c.start_m) for c in plan.collects
        )
        place = (float(lon_deg), float(lat_deg), float(altitude_m), float(altitude_m))
        samples.append(TrackSample(along_m / 20.0, *place, None, 0.0, 20.0, None, on))
    return samples


@dataclass
class Flown:
    """A service that knows a plan and can be given flights of it."""

    client: httpx.AsyncClient
    house: House
    plan_id: str
    plan: Plan

    async def flight(self, skipped: Callable[[int, float], bool]) -> str:
        """The place of a flight along the plan, some of its triggers skipped."""
        store = FlightStore(self.house.database)
        flight_id = await store.begin("vehicle", "uav", self.plan_id, self.plan.vehicles[0].name)
        await store.add(flight_id, track_of(self.plan, skipped))
        await store.end(flight_id, "ended")
        return f"/api/v1/flights/{flight_id}"


@pytest.fixture
async def flown(settings: Settings) -> AsyncIterator[Flown]:
    """A service with the example's plan."""
    app = create_app(settings, fake_house)
    async with serving(app) as client:
        record = (await client.post("/api/v1/plans", json=EXAMPLE, params={"wait": PATIENCE_S})).json()
        text = (await client.get(f"/api/v1/plans/{record['id']}/plan.geojson")).text
        yield Flown(client, app.state.house, record["id"], plan_of(text))


async def test_a_whole_flight_leaves_nothing_to_fly_again_for(flown: Flown) -> None:
    """Every trigger is in order, every region seen, and a re-flight is refused with that reason."""
    place = await flown.flight(lambda seq, along_m: False)
    coverage = (await flown.client.get(place + "/coverage.geojson")).json()
    assert {trigger["state"] for trigger in coverage["triggers"]} == {"ok"}
    assert all(region["seen"] for region in coverage["regions"])
    refused = await flown.client.post(place + "/refly")
    check_problem(refused, 409)
    assert "slivers, each narrower than 10 m or smaller than 100 m²" in refused.json()["detail"]
    page = await flown.client.get(place + "/report.html")
    assert coverage["seen_fraction"] == 0.995
    assert "At least 99.5 % of every region was seen" in page.text
    assert "default-src 'none'" in page.headers["content-security-policy"]


async def test_a_missed_collect_is_named_and_flown_again(flown: Flown) -> None:
    """The trigger is told as missed, the region as unseen; the new plan sees what was missed, no more."""
    missed = flown.plan.collects[0]
    place = await flown.flight(lambda seq, along_m: seq == missed.seq)
    coverage = (await flown.client.get(place + "/coverage.geojson")).json()
    states = {trigger["seq"]: trigger["state"] for trigger in coverage["triggers"]}
    assert states.pop(missed.seq) == "missed"
    assert set(states.values()) <= {"ok"}
    unseen = {region["roi"] for region in coverage["regions"] if not region["seen"]}
    assert unseen == set(missed.regions)
    page = (await flown.client.get(place + "/report.html")).text
    assert f"{len(unseen)} regions seen to less than 99.5 %".replace("1 regions", "1 region") in page
    assert ">missed<" in page
    assert "<script" not in page
    answer = await flown.client.post(place + "/refly", params={"wait": PATIENCE_S})
    assert answer.status_code == 202
    record = answer.json()
    assert (record["state"], record["name"]) == ("done", f"{EXAMPLE['name']}-refly"), record
    assert min(record["metrics"]["coverage"].values()) > 0.99
    assert {name.rpartition(" gap ")[0] for name in record["metrics"]["coverage"]} == unseen
    new = (await flown.client.get(f"{answer.headers['location']}/scenario")).json()
    kept = [f for f in EXAMPLE["features"] if f["properties"]["role"] != "roi"]
    assert [f for f in new["features"] if f["properties"]["role"] != "roi"] == kept
    for member in ("vehicles", "sensors", "altitude_m"):
        assert new[member] == EXAMPLE[member]


async def test_triggers_late_early_and_interrupted(flown: Flown) -> None:
    """Each way to switch wrongly has its name and its metres."""
    first = flown.plan.collects[0]
    length_m = first.end_m - first.start_m
    for skipped, state, name in [
        (lambda seq, along_m: seq == first.seq and along_m < 100.0, "late", "late_m"),
        (lambda seq, along_m: seq == first.seq and along_m > length_m - 100.0, "early", "early_m"),
        (lambda seq, along_m: seq == first.seq and 100.0 < along_m < 200.0, "interrupted", None),
    ]:
        coverage = (await flown.client.get(await flown.flight(skipped) + "/coverage.geojson")).json()
        trigger = next(t for t in coverage["triggers"] if t["seq"] == first.seq)
        assert trigger["state"] == state
        if name is not None:
            assert trigger[name] == pytest.approx(100.0, abs=12.0)


async def test_unknown_flights(client: httpx.AsyncClient) -> None:
    """A 404 for all that is asked of them."""
    check_problem(await client.post("/api/v1/flights/none/refly"), 404)
    check_problem(await client.get("/api/v1/flights/none/report.html"), 404)


def coverage_with(unseen: dict[str, Any]) -> FlownCoverage:
    """A flight that left these parts unseen."""
    regions = {region.name: region.area for region in SCENARIO.regions}
    seen = {name: area.difference(unseen.get(name, area)) for name, area in regions.items()}
    left = {name: area.difference(seen[name]) for name, area in regions.items()}
    return FlownCoverage({name: seen[name].area / regions[name].area for name in regions}, seen, left, ())


def test_slivers_are_no_gaps_and_gaps_cover_what_was_unseen() -> None:
    """Strips narrower than the threshold are left out; each gap lies in its region and holds its part."""
    region = SCENARIO.regions[0]
    west, south, east, north = region.area.bounds
    sliver = shape(
        {"type": "Polygon", "coordinates": [[[west, south], [east, south], [east, south], [west, south]]]}
    )
    corner = region.area.centroid.buffer((east - west) / 8.0)
    thin = LineString([(west, south), (east, north)]).buffer(SLIVER_M * 0.9)
    nothing = {other.name: corner.__class__() for other in SCENARIO.regions}
    assert sliver.area == 0.0
    assert gaps(SCENARIO, coverage_with(nothing | {region.name: thin})) == ()
    (gap,) = gaps(SCENARIO, coverage_with(nothing | {region.name: corner}))
    assert gap.roi == region.name
    assert region.area.buffer(1e-6).covers(gap.area)
    assert gap.area.buffer(1e-6).covers(corner.intersection(region.area))
    both = gaps(SCENARIO, coverage_with(nothing | {region.name: union_all([corner, thin])}))
    assert both[0].area.area >= gap.area.area


def test_in_flight_it_starts_where_the_aircraft_is() -> None:
    """The start moves with the course as its heading; where it had to go it still has to."""
    region = SCENARIO.regions[0]
    nothing = {other.name: type(region.area)() for other in SCENARIO.regions}
    found = gaps(SCENARIO, coverage_with(nothing | {region.name: region.area}))
    before = json.dumps(EXAMPLE)
    made = refly_scenario(EXAMPLE, found, SCENARIO.frame, None, (-117.72, 33.52, 45.0))
    assert json.dumps(EXAMPLE) == before
    start = next(f for f in made["features"] if f["properties"]["role"] == "start")
    assert start["geometry"]["coordinates"][:2] == [-117.72, 33.52]
    assert start["properties"]["heading_deg"] == 45.0
    ends = [f for f in made["features"] if f["properties"]["role"] == "end"]
    asked = [f for f in EXAMPLE["features"] if f["properties"]["role"] in ("end", "start")]
    assert ends[0]["geometry"]["coordinates"] == asked[-1]["geometry"]["coordinates"]
    assert read_scenario(made).regions[0].area.area == pytest.approx(region.area.area, rel=1e-3)
