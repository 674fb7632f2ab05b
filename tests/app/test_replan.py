"""Planning anew in flight: what is left, from where the aircraft are, uploaded in flight and read back."""

from __future__ import annotations

from copy import deepcopy
from typing import Any

import httpx
import pyproj

from tests.app.test_problems import check_problem
from tests.app.test_refly_flight import DOCUMENT, order
from tests.app.test_vehicles import connected, until
from tests.patience import PATIENCE_S

GEOD = pyproj.Geod(ellps="WGS84")
#: The plan is asked for a second behind the pass.
NEAR_M = 50.0


async def planned(client: httpx.AsyncClient) -> tuple[dict[str, Any], dict[str, Any]]:
    """The record of the example's plan, and the plan."""
    record = (await client.post("/api/v1/plans", json=deepcopy(DOCUMENT), params={"wait": PATIENCE_S})).json()
    return record, (await client.get(record["links"]["plan.geojson"])).json()


def features(plan: dict[str, Any], role: str) -> list[dict[str, Any]]:
    """Of one role."""
    return [feature for feature in plan["features"] if feature["properties"]["role"] == role]


async def test_what_the_plan_has_seen_is_left_out_and_the_flight_goes_on_from_there(
    client: httpx.AsyncClient,
) -> None:
    """At a time of the plan's own, a removed region, a new one: no take-off, no violation, home as it was."""
    record, plan = await planned(client)
    first, *others = features(plan, "collect")
    at_s = first["properties"]["end_s"] + 1.0
    new = deepcopy(next(f for f in DOCUMENT["features"] if f["properties"]["role"] == "roi"))
    gone = others[-1]["properties"]["roi"]
    new["id"] = "new"
    new["properties"].pop("name", None)
    body = {"at_s": at_s, "remove": [gone], "add": [new], "begins_in_s": 0.0}
    answer = await client.post(f"/api/v1/plans/{record['id']}/replan", json=body, params={"wait": PATIENCE_S})
    assert (answer.status_code, answer.json().get("state")) == (202, "done"), answer.text
    again = (await client.get(answer.json()["links"]["plan.geojson"])).json()
    assert [v for v in again["violations"] if v["hard"]] == []
    seen = {f["properties"]["roi"] for f in features(again, "collect")}
    assert "new" in seen
    assert gone not in seen
    (path,) = features(again, "path")
    assert path["properties"]["phases"][0]["kind"] == "mission"
    # Right behind the first pass, on its line: where the old plan had the aircraft then.
    assert (
        GEOD.inv(*first["geometry"]["coordinates"][1][:2], *path["geometry"]["coordinates"][0][:2])[2]
        < NEAR_M
    )
    kept = deepcopy(DOCUMENT)["features"]
    start = next(f for f in kept if f["properties"]["role"] == "start")["geometry"]["coordinates"]
    mission = (await client.get(answer.json()["links"]["mission.plan"])).json()
    assert GEOD.inv(*start[:2], *mission["mission"]["plannedHomePosition"][1::-1])[2] < 0.1
    commands = {item.get("command") for item in mission["mission"]["items"]}
    assert not commands & {22, 84}


async def test_names_that_are_not_there_are_told(client: httpx.AsyncClient) -> None:
    """A feature, an aircraft, a shape that is none, and nobody who says where the aircraft is."""
    record, _ = await planned(client)
    path = f"/api/v1/plans/{record['id']}/replan"
    check_problem(await client.post(path, json={}), 409)
    for body, rule in (
        ({"at_s": 60.0, "remove": ["nobody"]}, "unknown-feature"),
        ({"at_s": 60.0, "lost": ["nobody"]}, "unknown-vehicle"),
        ({"at_s": 60.0, "seen": [{"type": "Point", "coordinates": [0, 0]}]}, "bad-geometry"),
        ({"vehicles": {DOCUMENT["vehicles"][0]["name"]: {"lon_deg": 0.0}}}, "missing-property"),
    ):
        check_problem(await client.post(path, json=body), 422, rule)


async def test_a_flying_aircraft_takes_up_its_new_plan(client: httpx.AsyncClient) -> None:
    """Its place and what it saw come from its record; the mission is replaced in flight, read back, flown."""
    record, plan = await planned(client)
    vehicle = await connected(client, "sim:?speedup=60")
    report = (await client.post(vehicle + "/mission", json={"plan_id": record["id"]})).json()
    assert report["verified"], report
    await order(client, vehicle, "arm")
    await order(client, vehicle, "start")
    behind = report["parts"]["mission"]["held"]
    first_off = next(item["seq"] for item in behind if item["command"] == 181 and item["params"][1] == 0)
    flying = await until(client, vehicle, lambda b: (b["state"]["mission_current"] or 0) > first_off)
    await order(client, vehicle, "pause")
    track = f"/api/v1/flights/{flying['flight_id']}/track.geojson"
    await until(
        client,
        track,
        lambda b: b["features"][0]["properties"]["times_s"][-1] >= flying["state"]["time_s"],
    )
    answer = await client.post(f"/api/v1/plans/{record['id']}/replan", json={}, params={"wait": PATIENCE_S})
    assert (answer.status_code, answer.json().get("state")) == (202, "done"), answer.text
    again = (await client.get(answer.json()["links"]["plan.geojson"])).json()
    assert [v for v in again["violations"] if v["hard"]] == []
    first, *others = features(plan, "collect")
    left = {f["properties"]["roi"] for f in features(again, "collect")}
    assert left == {f["properties"]["roi"] for f in others} - {first["properties"]["roi"]}
    report = (await client.post(vehicle + "/mission", json={"plan_id": answer.json()["id"]})).json()
    assert (report["outcome"], report["verified"]) == ("accepted", True), report
    await order(client, vehicle, "goto_item", seq=1)
    await order(client, vehicle, "resume")
    done = await until(
        client, "/api/v1/flights", lambda b: all(flight["state"] == "ended" for flight in b["flights"])
    )
    last = done["flights"][0]
    assert last["plan_id"] == answer.json()["id"]
    flown = (await client.get(last["links"]["coverage.geojson"])).json()
    assert {trigger["state"] for trigger in flown["triggers"]} == {"ok"}
