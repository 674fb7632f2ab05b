"""A simulated multirotor over HTTP: connected by its address, flown, paused, resumed, landed."""

from __future__ import annotations

import json
from typing import Any

import httpx
import pytest

from app.routers.bodies import EXAMPLE
from tests.app.test_problems import check_problem
from tests.app.test_vehicles import connected, until
from tests.patience import PATIENCE_S


def with_multirotor(autopilot: str) -> dict[str, Any]:
    """The example, its aircraft a multirotor."""
    scenario: dict[str, Any] = json.loads(json.dumps(EXAMPLE))
    scenario["vehicles"][0] |= {"type": "multirotor", "autopilot": autopilot, "min_turn_radius_m": 60}
    return scenario


@pytest.mark.parametrize(
    ("autopilot", "paused", "flown"),
    [("ardupilot", "AUTO", "AUTO"), ("px4", "AUTO.LOITER", "AUTO.MISSION")],
)
async def test_it_is_flown_paused_and_resumed(
    client: httpx.AsyncClient, autopilot: str, paused: str, flown: str
) -> None:
    """A multirotor takes a multirotor's plan: held as meant, paused in its mode, flown to its landing."""
    scenario = with_multirotor(autopilot)
    record = (await client.post("/api/v1/plans", json=scenario, params={"wait": PATIENCE_S})).json()
    vehicle = await connected(client, f"sim:?speedup=100&type=multirotor&airspeed=20&autopilot={autopilot}")
    assert (await client.get(vehicle)).json()["state"]["type"] == "multirotor"
    report = (await client.post(vehicle + "/mission", json={"plan_id": record["id"]})).json()
    assert report["verified"], report
    for command in ("arm", "start"):
        answer = await client.post(vehicle + "/commands", json={"command": command})
        assert answer.json().get("outcome") == "done", answer.text
    await until(client, vehicle, lambda body: (body["state"]["mission_current"] or 0) > 1)
    await client.post(vehicle + "/commands", json={"command": "pause"})
    held = await until(client, vehicle, lambda body: body["state"]["ground_speed_m_s"] < 0.2)
    assert held["state"]["mode"] == paused
    assert held["state"]["armed"]
    await client.post(vehicle + "/commands", json={"command": "resume"})
    moving = await until(client, vehicle, lambda body: body["state"]["ground_speed_m_s"] > 5.0)
    assert moving["state"]["mode"] == flown
    flights = await until(
        client, "/api/v1/flights", lambda body: [f["state"] for f in body["flights"]] == ["ended"]
    )
    (flight,) = flights["flights"]
    coverage = (await client.get(flight["links"]["coverage.geojson"])).json()
    assert all(region["seen"] for region in coverage["regions"]), coverage["coverage"]


async def test_a_fixed_wing_is_not_given_its_plan(client: httpx.AsyncClient) -> None:
    """The types differ: refused, and the address of a VTOL is refused with the reason."""
    scenario = with_multirotor("ardupilot")
    record = (await client.post("/api/v1/plans", json=scenario, params={"wait": PATIENCE_S})).json()
    vehicle = await connected(client, "sim:")
    answer = await client.post(vehicle + "/mission", json={"plan_id": record["id"]})
    assert 400 <= answer.status_code < 500
    assert "the plan is for a multirotor, the vehicle is a fixed_wing" in answer.text
    problem = await client.post("/api/v1/vehicles", json={"name": "v", "url": "sim:?type=vtol"})
    check_problem(problem, 422, "sim-address")
    assert "no vtol is simulated" in problem.text
