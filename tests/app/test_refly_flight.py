"""A pass missed in flight, found, planned anew from where the aircraft is, and flown: all is seen."""

from __future__ import annotations

from copy import deepcopy
from typing import Any

import httpx
import pytest
from shapely import transform, union_all
from shapely.geometry import shape
from shapely.geometry.base import BaseGeometry

from app.routers.bodies import EXAMPLE
from app.services.flights.as_flown import TRIGGER_M
from planner.geojson import read_scenario
from tests.app.test_problems import check_problem
from tests.app.test_vehicles import connected, until
from tests.patience import PATIENCE_S

#: The example, with straight flight before each pass: out of a turn its first metres are seen askew.
DOCUMENT = deepcopy(EXAMPLE)
DOCUMENT["vehicles"][0]["settle_m"] = 100.0
SCENARIO = read_scenario(DOCUMENT)


def seen_in(coverage: dict[str, Any]) -> BaseGeometry:
    """All ground that a flight saw, in the scenario's frame."""
    found = [shape(f["geometry"]) for f in coverage["features"] if f["properties"]["role"] == "seen"]
    return union_all([transform(ground, SCENARIO.frame.to_local) for ground in found])


async def order(client: httpx.AsyncClient, vehicle: str, command: str, **more: Any) -> None:
    """An explicit command; the vehicle must take it."""
    answer = await client.post(vehicle + "/commands", json={"command": command, **more})
    assert (answer.status_code, answer.json().get("outcome")) == (200, "done"), answer.text


@pytest.mark.parametrize(
    ("aircraft", "payload"),
    [("autopilot=ardupilot", None), ("autopilot=px4&sensor_reports=no", "camera:distance=4")],
    ids=["switch", "photos"],
)
async def test_what_a_flight_missed_is_flown_again_before_it_lands(
    client: httpx.AsyncClient, aircraft: str, payload: str | None
) -> None:
    """The second pass sees nothing; the gap is told, planned, uploaded in flight by override, flown, seen."""
    record = (await client.post("/api/v1/plans", json=DOCUMENT, params={"wait": PATIENCE_S})).json()
    plan = (await client.get(record["links"]["plan.geojson"])).json()
    collects = [f["properties"] for f in plan["features"] if f["properties"]["role"] == "collect"]
    vehicle = await connected(client, f"sim:?speedup=50&fault=sensor_skips&{aircraft}")
    first = {"plan_id": record["id"], "payload": payload}
    report = (await client.post(vehicle + "/mission", json=first)).json()
    assert report["verified"], report
    last = max(
        item["seq"] for item in report["parts"]["mission"]["held"] if item["command"] in (181, 187, 206)
    )
    await order(client, vehicle, "arm")
    await order(client, vehicle, "start")
    flying = await until(client, vehicle, lambda body: (body["state"]["mission_current"] or 0) > last)
    await order(client, vehicle, "pause")
    flight = f"/api/v1/flights/{flying['flight_id']}"
    # The track is stored now and then: wait for the last pass to be in it.
    await until(
        client,
        flight + "/track.geojson",
        lambda body: body["features"][0]["properties"]["times_s"][-1] >= flying["state"]["time_s"],
    )

    coverage = (await client.get(flight + "/coverage.geojson")).json()
    states = {trigger["seq"]: trigger["state"] for trigger in coverage["triggers"]}
    missed = collects[1]
    assert states.pop(missed["seq"]) == "missed"
    assert set(states.values()) == {"ok"}
    assert coverage["coverage"][missed["roi"]] < 0.5
    answer = await client.post(flight + "/refly", params={"wait": PATIENCE_S})
    again = answer.json()
    assert (answer.status_code, again["state"]) == (202, "done"), again
    in_air = {"plan_id": again["id"], "payload": payload}
    check_problem(await client.post(vehicle + "/mission", json=in_air), 409, "vehicle-flying")
    stated = in_air | {"override": True, "reason": "fly the gap before landing"}
    report = (await client.post(vehicle + "/mission", json=stated)).json()
    assert report["verified"], report
    await order(client, vehicle, "goto_item", seq=1)
    await order(client, vehicle, "resume")
    flights = await until(
        client, "/api/v1/flights", lambda body: [f["state"] for f in body["flights"]] == ["ended", "ended"]
    )
    second, before = flights["flights"]
    assert (before["plan_id"], second["plan_id"]) == (record["id"], again["id"])
    after = (await client.get(second["links"]["coverage.geojson"])).json()
    assert {trigger["state"] for trigger in after["triggers"]} == {"ok"}
    ground = union_all([seen_in(coverage), seen_in(after)])
    for region in SCENARIO.regions:
        missing = region.area.difference(ground)
        # How the pass lies depends on where the aircraft was, and its ends on how late a trigger in order is.
        assert missing.buffer(-TRIGGER_M / 2).is_empty
        assert missing.area < 0.03 * region.area.area
