"""No sensor is left on: a pass broken off has it switched off, and the flight's record says so."""

from __future__ import annotations

from typing import Any

import httpx
import pytest

from tests.app.small_flight import CRAFT, in_flight, order, planned, ready, small_scenario
from tests.app.test_vehicles import until

#: The pass takes about two seconds.
SPEEDUP = 50.0


async def in_pass(client: httpx.AsyncClient, autopilot: str, kind: str) -> str:
    """An aircraft within its pass, the sensor on."""
    vehicle, _ = await ready(client, autopilot, kind, SPEEDUP)
    await in_flight(client, vehicle)
    await until(client, vehicle, lambda body: body["sensor"]["on"])
    return vehicle


async def switched_off(client: httpx.AsyncClient, vehicle: str) -> dict[str, Any]:
    """What the service did by itself, once the sensor is shown off; the flight's record has the same."""
    body = await until(
        client, vehicle, lambda body: body["sensor"]["on"] is False and body["sensor"]["last_action"]
    )
    action: dict[str, Any] = body["sensor"]["last_action"]
    assert action["action"] == "sensor_off"
    assert "accepted" in action["outcome"]
    # A mission replaced in flight ends one flight and begins another.
    flights = (await client.get("/api/v1/flights")).json()["flights"]
    (flight,) = [each for each in flights if each["actions"]]
    assert flight["actions"][0] == action
    track = (await client.get(flight["links"]["track.geojson"])).json()
    assert track["actions"][0]["reason"] == action["reason"]
    return action


@pytest.mark.parametrize(("autopilot", "kind"), CRAFT)
async def test_a_return_in_a_pass(client: httpx.AsyncClient, autopilot: str, kind: str) -> None:
    """On every aircraft the return leaves the sensor as it is; the service switches it off."""
    vehicle = await in_pass(client, autopilot, kind)
    assert (await order(client, vehicle, "rtl")).json()["outcome"] == "done"
    assert "RTL" in (await switched_off(client, vehicle))["reason"]


@pytest.mark.parametrize(("autopilot", "kind"), [("ardupilot", "multirotor"), ("px4", "fixed_wing")])
async def test_a_pause_in_a_pass(client: httpx.AsyncClient, autopilot: str, kind: str) -> None:
    """Also where it stays in the mission's mode; whoever resumes is told what is left unseen."""
    vehicle = await in_pass(client, autopilot, kind)
    assert (await order(client, vehicle, "pause")).json()["outcome"] == "done"
    await switched_off(client, vehicle)
    resumed = (await order(client, vehicle, "resume")).json()
    assert resumed["outcome"] == "done"
    assert "not seen; goto_item" in resumed["reason"]


async def test_a_mission_replaced_in_a_pass(client: httpx.AsyncClient) -> None:
    """As soon as another mission goes up; the pass of the mission before is no pass any more."""
    other = await planned(client, small_scenario("ardupilot", "fixed_wing", returns=True))
    vehicle = await in_pass(client, "ardupilot", "fixed_wing")
    body = {"plan_id": other, "override": True, "reason": "another one"}
    assert (await client.post(vehicle + "/mission", json=body)).json()["verified"]
    assert "replaced" in (await switched_off(client, vehicle))["reason"]


async def test_switched_off_by_order_within_a_pass(client: httpx.AsyncClient) -> None:
    """The order says when it is shown; nothing was done by the service itself."""
    vehicle = await in_pass(client, "px4", "multirotor")
    answer = (await order(client, vehicle, "sensor_off")).json()
    assert answer["outcome"] == "done", answer
    told = (await client.get(vehicle)).json()
    assert told["sensor"]["on"] is False
    assert told["sensor"]["last_action"] is None
