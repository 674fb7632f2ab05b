"""Planned, uploaded, flown and judged where longitudes jump, converge or are nought."""

from __future__ import annotations

import re
from itertools import pairwise

import httpx
import pytest
from shapely.geometry import shape

from tests.app.test_refly_flight import order
from tests.app.test_vehicles import connected, until
from tests.patience import PATIENCE_S
from tests.planner.moved import Place, box, put_at
from tests.planner.scenarios import feature, small


@pytest.mark.parametrize(
    ("origin", "autopilot"),
    [((180.0, -17.0), "ardupilot"), ((0.0, 0.0), "px4"), ((-150.0, 89.0), "px4")],
    ids=["antimeridian", "zero", "pole"],
)
async def test_whole_journey(client: httpx.AsyncClient, origin: Place, autopilot: str) -> None:
    """All of the regions is seen as flown, on the lines planned, and every answer has a place on the map."""
    put = put_at(origin)
    document = small(
        features=[
            feature("A", "roi", "Polygon", box(put, -500, 300, 400, 700)),
            feature("B", "roi", "Polygon", box(put, -700, -900, 300, -600)),
            feature("area", "area", "Polygon", box(put, -3000, -3000, 3000, 3000)),
            feature("N", "no_fly", "Point", put(0, 1700), radius_m=200.0),
            feature("start", "start", "Point", [*put(0, 0), 10.0]),
        ]
    )
    document["vehicles"][0] |= {"settle_m": 100.0, "autopilot": autopilot}
    record = (await client.post("/api/v1/plans", json=document, params={"wait": PATIENCE_S})).json()
    assert record["state"] == "done", record
    vehicle = await connected(client, f"sim:?speedup=200&autopilot={autopilot}")
    report = (await client.post(vehicle + "/mission", json={"plan_id": record["id"]})).json()
    assert report["verified"], report
    for item in report["parts"]["mission"]["held"]:
        assert abs(item.get("lon_deg", 0.0)) <= 180.0
    await order(client, vehicle, "arm")
    await order(client, vehicle, "start")
    back = await until(
        client, vehicle, lambda body: body["state"]["mode"] in ("RTL", "LAND") or not body["state"]["armed"]
    )
    (flight,) = (await client.get("/api/v1/flights")).json()["flights"]
    links = flight["links"]
    # The track is stored now and then: wait for the way back to be in it.
    track = await until(
        client,
        links["track.geojson"],
        lambda body: body["features"][0]["properties"]["times_s"][-1] >= back["state"]["time_s"] - 5.0,
    )
    for line in (f for f in track["features"] if f["geometry"]["type"] == "LineString"):
        assert all(abs(b[0] - a[0]) < 180.0 for a, b in pairwise(line["geometry"]["coordinates"]))
    coverage = (await client.get(links["coverage.geojson"])).json()
    assert min(coverage["coverage"].values()) > 0.99, coverage["coverage"]
    assert {trigger["state"] for trigger in coverage["triggers"]} == {"ok"}
    grounds = [shape(ground["geometry"]) for ground in coverage["features"]]
    for part in (part for ground in grounds for part in getattr(ground, "geoms", [ground])):
        west, _, east, _ = part.bounds
        assert -180.0 <= west < east <= 180.0
        assert east - west < 1.0
    for text in (links["report.html"], record["links"]["report.html"]):
        view = re.search(
            r'viewBox="([-0-9.]+) ([-0-9.]+) ([-0-9.]+) ([-0-9.]+)"', (await client.get(text)).text
        )
        assert view
        assert max(float(side) for side in view.groups()[2:]) < 8_000.0
    for name in ("mission.kml", "mission.plan", "mission.waypoints"):
        assert (await client.get(record["links"][name])).status_code == 200
