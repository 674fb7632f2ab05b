"""What a flight's photos saw, over HTTP: figures, lost photos, rasters, the report, the plan of the gaps."""

from __future__ import annotations

import io
from collections.abc import AsyncIterator
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any

import httpx
import numpy as np
import pytest
import rasterio
from shapely import union_all
from shapely.geometry import shape

from app.main import create_app
from app.services.house import House
from app.services.plans.missions import plan_of
from app.services.records import FlightEvent, FlightRecord, TrackSample
from app.services.store.flights import FlightStore
from app.settings import Settings
from planner.plan import Plan
from tests.app.conftest import fake_house, serving
from tests.app.test_problems import check_problem
from tests.patience import PATIENCE_S
from tests.planner.as_flown.test_photos import asked, record

LOST = 5


def recorded(
    plan: Plan, lost: bool = False, photos: bool = True
) -> tuple[list[TrackSample], list[FlightEvent]]:
    """A flight along the plan's lanes as the service keeps it; of each five photos may be lost."""
    gone = frozenset((p.seq, k) for p in plan.photos for k in range(3, 3 + LOST)) if lost else frozenset()
    one = record(lost=gone, photos=photos)
    samples = [
        TrackSample(
            s.time_s, s.lon_deg, s.lat_deg, s.height_m, s.height_m, s.heading_deg, s.roll_deg, 20.0, None,
            False, s.pitch_deg,
        )
        for s in one.samples
    ]  # fmt: skip
    events = [
        FlightEvent(
            p.time_s, "photo", "camera", p.index, p.lon_deg, p.lat_deg, p.height_m, p.height_m, p.yaw_deg,
            p.roll_deg, p.pitch_deg, "autopilot",
        )
        for p in one.photos
    ]  # fmt: skip
    return samples, events


def flight_record(plan: Plan) -> FlightRecord:
    """A flight that has ended."""
    now = datetime(2026, 5, 1, tzinfo=UTC)
    return FlightRecord("f", "v", "uav", "plan", plan.vehicles[0].name, "ended", now, now, 1)


@dataclass
class Flown:
    """A service that knows a plan with a camera, and can be given flights of it."""

    client: httpx.AsyncClient
    house: House
    plan_id: str
    plan: Plan

    async def flight(self, lost: bool = False, photos: bool = True, plan_id: str | None = None) -> str:
        """The place of a flight along the plan's lanes; of each five photos may be lost.

        ``plan_id`` is another plan that it is said to have followed.
        """
        store = FlightStore(self.house.database)
        flight_id = await store.begin("vehicle", "uav", plan_id or self.plan_id, self.plan.vehicles[0].name)
        samples, events = recorded(self.plan, lost, photos)
        await store.add(flight_id, samples)
        await store.add_events(flight_id, events)
        await store.end(flight_id, "ended")
        return f"/api/v1/flights/{flight_id}"


@pytest.fixture
async def flown(settings: Settings) -> AsyncIterator[Flown]:
    """A service with the plan."""
    app = create_app(settings, fake_house)
    async with serving(app) as client:
        made = (await client.post("/api/v1/plans", json=asked(), params={"wait": PATIENCE_S})).json()
        text = (await client.get(f"/api/v1/plans/{made['id']}/plan.geojson")).text
        yield Flown(client, app.state.house, made["id"], plan_of(text))


async def raster(client: httpx.AsyncClient, url: str) -> tuple[Any, Any]:
    """Values and the dataset's profile, read by GDAL."""
    answer = await client.get(url)
    assert answer.status_code == 200, answer.text
    assert answer.headers["content-type"].startswith("image/tiff")
    with rasterio.open(io.BytesIO(answer.content)) as found:
        return found.read(1), found.profile | {"bounds": found.bounds}


async def test_what_photos_saw_is_told_and_drawn(flown: Flown) -> None:
    """Counts, overlaps and distances sampled, in the answer, the report and the rasters alike."""
    at = await flown.flight()
    told = (await flown.client.get(f"{at}/coverage.geojson")).json()
    photos, (region,) = told["photos"], told["photos"]["regions"]
    assert told["coverage"]["A"] > 0.9999
    assert photos["taken"] == photos["counted"] == sum(len(p.places) for p in flown.plan.photos)
    assert {t["state"] for t in told["triggers"]} == {"ok"}
    assert region["forward_overlap"]["least"] >= 0.749
    assert region["side_overlap"]["least"] >= 0.649
    assert region["assumed_fraction"] == 0.0
    counts, profile = await raster(flown.client, f"{at}/overlap.tif")
    gsd_m, _ = await raster(flown.client, f"{at}/gsd.tif?roi=A")
    assert profile["crs"].is_projected
    assert counts.shape == gsd_m.shape
    assert (counts > 0).mean() > 0.99
    assert np.nanmax(gsd_m) == pytest.approx(region["gsd_worst_m"], rel=1e-6)
    assert np.isnan(gsd_m).sum() == (counts == 0).sum()
    page = (await flown.client.get(f"{at}/report.html")).text
    assert "<h2>Photos</h2>" in page
    assert f"{photos['taken']} reported of {photos['taken']} planned" in page


async def test_lost_photos_are_told_and_flown_again_for(flown: Flown) -> None:
    """Where they are missing along each collect, the hole they leave, and a plan of it."""
    at = await flown.flight(lost=True)
    told = (await flown.client.get(f"{at}/coverage.geojson")).json()
    assert all(each["missing"] == LOST for each in told["photos"]["passes"])
    assert {t["state"] for t in told["triggers"]} == {"interrupted"}
    assert all(t["photos_expected"] - t["photos_taken"] == LOST for t in told["triggers"])
    (hole,) = [shape(f["geometry"]) for f in told["features"] if f["properties"]["role"] == "unseen"]
    again = (await flown.client.post(f"{at}/refly")).json()
    scenario = (await flown.client.get(f"/api/v1/plans/{again['id']}/scenario")).json()
    regions = [shape(f["geometry"]) for f in scenario["features"] if f["properties"]["role"] == "roi"]
    assert hole.area > 0.0
    # Slivers at its edge, narrower than ten metres, are left out.
    assert hole.difference(union_all(regions)).buffer(-4e-5).is_empty
    assert hole.intersection(union_all(regions)).area > 0.5 * hole.area
    counts, _ = await raster(flown.client, f"/api/v1/plans/{flown.plan_id}/overlap.tif")
    assert (counts == 0).any()


async def test_photos_nobody_reported_are_assumed(flown: Flown) -> None:
    """The region is unknown, and told apart as assumed; nobody knows how the camera was released."""
    at = await flown.flight(photos=False)
    told = (await flown.client.get(f"{at}/coverage.geojson")).json()
    assert told["coverage"]["A"] == 0.0
    assert told["unknown_coverage"]["A"] > 0.99
    assert told["photos"]["regions"][0]["assumed_fraction"] > 0.99
    assert {t["state"] for t in told["triggers"]} == {"unknown"}
    assert any(f["properties"]["role"] == "assumed" for f in told["features"])
    assert "They prove nothing" in (await flown.client.get(f"{at}/report.html")).text
    values, _ = await raster(flown.client, f"{at}/gsd.tif")
    assert np.isnan(values).all()


async def test_regions_without_photos_have_no_raster(flown: Flown) -> None:
    """A name that is no region of a camera's: 409 with the reason."""
    at = await flown.flight()
    answer = await flown.client.get(f"{at}/overlap.tif", params={"roi": "nowhere"})
    check_problem(answer, 409)
    assert "nowhere" in answer.text


async def test_photos_of_a_mission_file_are_judged_where_a_scenario_names_regions(flown: Flown) -> None:
    """Of a camera of the scenario, on a mission that another program made: all is seen, nothing planned."""
    kept = (await flown.client.post("/api/v1/scenarios", json=asked())).json()
    content = (await flown.client.get(f"/api/v1/plans/{flown.plan_id}/mission.waypoints")).content
    query = {"scenario_id": kept["id"]}
    filed = (await flown.client.post("/api/v1/plans/import", content=content, params=query)).json()
    told = (await flown.client.get(f"{await flown.flight(plan_id=filed['id'])}/coverage.geojson")).json()
    assert told["coverage"]["A"] > 0.999
    assert told["photos"]["taken"] == told["photos"]["counted"] > 0
    assert told["photos"]["passes"] == []


async def test_a_flight_of_a_mission_file_alone_has_its_record(flown: Flown) -> None:
    """Gaps, phases and energy, and a report that says that nothing was to be seen; nothing to fly again."""
    content = (await flown.client.get(f"/api/v1/plans/{flown.plan_id}/mission.waypoints")).content
    filed = (await flown.client.post("/api/v1/plans/import", content=content)).json()
    at = await flown.flight(plan_id=filed["id"])
    told = (await flown.client.get(f"{at}/coverage.geojson")).json()
    assert told["regions"] == told["features"] == []
    assert len(told["gaps"]) == len(flown.plan.collects) - 1
    assert "nothing was to be seen" in (await flown.client.get(f"{at}/report.html")).text
    check_problem(await flown.client.post(f"{at}/refly"), 409)
