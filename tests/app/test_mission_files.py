"""Mission files over HTTP: taken in as plans, judged, shown, put onto vehicles and read back."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import httpx

from app.routers.bodies import EXAMPLE
from mavlink.formats import read_mission
from tests.app.test_problems import check_problem
from tests.app.test_vehicles import connected

FAULTS = Path(__file__).parents[1] / "faults"
IMPORT = "/api/v1/plans/import"
LAT, LON = 47.1, 8.2


def waypoints(*places: tuple[float, float], home: tuple[float, float] = (LAT, LON)) -> bytes:
    rows = [f"0\t1\t0\t16\t0\t0\t0\t0\t{home[0]}\t{home[1]}\t450\t1"]
    rows += [
        f"{n}\t0\t3\t16\t0\t0\t0\t0\t{lat}\t{lon}\t60\t1" for n, (lat, lon) in enumerate(places, start=1)
    ]
    return "\n".join(["QGC WPL 110", *rows]).encode()


async def taken(client: httpx.AsyncClient, content: bytes, **query: Any) -> dict[str, Any]:
    answer = await client.post(IMPORT, content=content, params=query)
    assert answer.status_code == 201, answer.text
    body: dict[str, Any] = answer.json()
    assert answer.headers["location"] == body["links"]["self"]
    return body


async def test_a_file_becomes_a_plan_and_its_items_go_up(client: httpx.AsyncClient) -> None:
    """Listed, told, exported with its own items, uploaded, read back, checked before flight."""
    content = waypoints((LAT + 0.005, LON), (LAT + 0.005, LON + 0.01)) + b"\n# end\n"
    plan = await taken(client, content, name="morning", type="multirotor")
    assert (plan["state"], plan["name"], plan["violations"]) == ("done", "morning", [])
    assert any("comments" in warning["message"] for warning in plan["warnings"])
    listed = (await client.get("/api/v1/plans")).json()["plans"]
    assert plan["id"] in [each["id"] for each in listed]
    exported = (await client.get(plan["links"]["mission.waypoints"])).text
    assert read_mission(exported).mission == read_mission(content).mission
    for name in ("mission.plan", "mission.kml", "report.html", "plan.geojson", "scenario"):
        assert (await client.get(plan["links"][name])).status_code == 200, name
    vehicle = await connected(client, f"sim:?type=multirotor&home={LAT},{LON},450")
    uploaded = (await client.post(vehicle + "/mission", json={"plan_id": plan["id"]})).json()
    assert (uploaded["outcome"], uploaded["verified"]) == ("accepted", True)
    assert [item["x"] for item in uploaded["parts"]["mission"]["held"][1:]] == [
        item.x for item in read_mission(content).mission[1:]
    ]
    checks = {check["name"]: check["status"] for check in uploaded["preflight"]["checks"]}
    assert (checks["plan"], checks["mission"], checks["place"]) == ("ok", "ok", "ok")
    assert "relay" not in json.dumps(uploaded["preflight"])


async def test_what_the_line_breaks_stops_the_upload(client: httpx.AsyncClient) -> None:
    """A mission through a kept scenario's zone is taken in with its violation, and goes up with a reason."""
    start = next(f for f in EXAMPLE["features"] if f["properties"]["role"] == "start")
    lon, lat = start["geometry"]["coordinates"][:2]
    zone = {
        "type": "Feature",
        "id": "mast",
        "geometry": {"type": "Point", "coordinates": [lon, lat + 0.004]},
        "properties": {"role": "no_fly", "radius_m": 40},
    }
    scenario = EXAMPLE | {"features": [*EXAMPLE["features"], zone]}
    kept = (await client.post("/api/v1/scenarios", json=scenario)).json()
    content = waypoints((lat + 0.01, lon), home=(lat, lon))
    plan = await taken(client, content, scenario_id=kept["id"])
    assert [(v["constraint"], v["feature"]) for v in plan["violations"] if v["hard"]] == [
        ("hard-zone", "mast")
    ]
    assert plan["stale"] is False
    assert (await taken(client, content))["violations"] == []
    vehicle = await connected(client, f"sim:?home={lat},{lon},0")
    body = {"plan_id": plan["id"]}
    refused = await client.post(vehicle + "/mission", json=body)
    check_problem(refused, 409, "hard-zone")
    again = await client.post(vehicle + "/mission", json=body | {"override": True, "reason": "mast is down"})
    assert again.json()["verified"]


async def test_a_fence_that_was_not_read_whole_stops_the_upload(client: httpx.AsyncClient) -> None:
    """The mission of a .plan goes up without its odd fence; the fence itself only with a reason."""
    document = json.loads((FAULTS / "03-geofence-version-1.plan").read_text())
    document["geoFence"] = {"version": 2, "polygons": [{"polygon": [[47.0, 8.0]]}], "circles": []}
    plan = await taken(client, json.dumps(document).encode())
    vehicle = await connected(client, f"sim:?type=multirotor&home={LAT},{LON},450")
    body = {"plan_id": plan["id"], "parts": ["mission", "fence"]}
    check_problem(await client.post(vehicle + "/mission", json=body), 409, "fence-unread")
    assert (await client.post(vehicle + "/mission", json={"plan_id": plan["id"]})).json()["verified"]


async def test_files_and_scenarios_that_are_not_there_are_refused(client: httpx.AsyncClient) -> None:
    """Rubbish with its line, an unknown scenario, an unknown raster; nothing is kept of them."""
    before = (await client.get("/api/v1/plans")).json()["total"]
    for content in (b"QGC WPL 110\n0 1 2\n", b"", b"\x00\x01", b"{}", b'{"fileType": "Plan"}'):
        check_problem(await client.post(IMPORT, content=content), 422, "mission-format")
    good = waypoints((LAT + 0.005, LON))
    check_problem(await client.post(IMPORT, content=good, params={"scenario_id": "none"}), 404)
    check_problem(await client.post(IMPORT, content=good, params={"terrain": "none"}), 422, "terrain-unknown")
    assert (await client.get("/api/v1/plans")).json()["total"] == before
