"""A small flight for every kind of simulated aircraft: one pass near the start, seen in a second."""

from __future__ import annotations

import json
from typing import Any

import httpx

from app.routers.bodies import EXAMPLE
from tests.app.test_vehicles import connected, until
from tests.patience import PATIENCE_S

CRAFT = [
    ("ardupilot", "fixed_wing"),
    ("ardupilot", "multirotor"),
    ("px4", "fixed_wing"),
    ("px4", "multirotor"),
]
#: Metres to a degree of latitude, near enough to draw with.
_DEGREE_M = 111_200.0


def small_scenario(autopilot: str, kind: str, *, returns: bool = False) -> dict[str, Any]:
    """One strip beside the start; the flight ends 900 m off with a landing, or with a return."""
    scenario: dict[str, Any] = json.loads(json.dumps(EXAMPLE))
    vehicle = scenario["vehicles"][0]
    scenario["vehicles"] = [vehicle | {"autopilot": autopilot, "type": kind, "min_turn_radius_m": 60}]
    scenario["features"] = [f for f in scenario["features"] if f["properties"]["role"] == "start"]
    lon_deg, lat_deg = scenario["features"][0]["geometry"]["coordinates"][:2]
    scenario |= {"altitude_m": 100.0, "altitude_reference": "terrain", "name": "small"}
    corners = [(400.0, 300.0), (460.0, 300.0), (460.0, 2100.0), (400.0, 2100.0), (400.0, 300.0)]
    ring = [[lon_deg + east / _DEGREE_M, lat_deg + north / _DEGREE_M] for east, north in corners]
    strip = {"type": "Polygon", "coordinates": [ring]}
    scenario["features"].append(
        {"type": "Feature", "id": "field", "geometry": strip, "properties": {"role": "roi"}}
    )
    if not returns:
        end = {"type": "Point", "coordinates": [lon_deg, lat_deg + 900.0 / _DEGREE_M]}
        scenario["features"].append(
            {"type": "Feature", "id": "end", "geometry": end, "properties": {"role": "end"}}
        )
    return scenario


async def planned(client: httpx.AsyncClient, scenario: dict[str, Any]) -> str:
    """The id of a plan made of a scenario."""
    record = (await client.post("/api/v1/plans", json=scenario, params={"wait": PATIENCE_S})).json()
    assert record["state"] == "done", record
    return str(record["id"])


async def ready(
    client: httpx.AsyncClient, autopilot: str, kind: str, speedup: float, **options: Any
) -> tuple[str, dict[str, Any]]:
    """A connected aircraft that holds the small flight, and the report of the upload."""
    plan_id = await planned(client, small_scenario(autopilot, kind, **options))
    url = f"sim:?speedup={speedup:g}&type={kind}&airspeed=20&turn_radius=60&autopilot={autopilot}"
    vehicle = await connected(client, url)
    report = (await client.post(vehicle + "/mission", json={"plan_id": plan_id})).json()
    assert report["verified"], report
    return vehicle, report


async def order(client: httpx.AsyncClient, vehicle: str, command: str, **more: Any) -> httpx.Response:
    """The answer to a command."""
    return await client.post(vehicle + "/commands", json={"command": command, **more}, timeout=PATIENCE_S)


async def in_flight(client: httpx.AsyncClient, vehicle: str) -> dict[str, Any]:
    """Started, and off the ground."""
    answer = await order(client, vehicle, "start", arm_first=True)
    assert (answer.status_code, answer.json()["outcome"]) == (200, "done"), answer.text
    body: dict[str, Any] = await until(client, vehicle, lambda body: body["state"]["landed"] is False)
    return body
