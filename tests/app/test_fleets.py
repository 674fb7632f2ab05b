"""A plan of two aircraft over HTTP: its files by vehicle, and both sent their missions in one call."""

from __future__ import annotations

from typing import Any

import httpx
import pytest

from tests.app.small_flight import planned
from tests.app.test_problems import check_problem
from tests.app.test_vehicles import connected
from tests.patience import PATIENCE_S
from tests.planner.scenarios import of_two

PLANS, VEHICLES = "/api/v1/plans", "/api/v1/vehicles"


@pytest.fixture
async def fleet_plan(client: httpx.AsyncClient) -> str:
    """A plan of two aircraft, a region each."""
    document = of_two()
    named = zip(document["vehicles"], ("north", "south"), strict=True)
    document["vehicles"] = [one | {"name": name} for one, name in named]
    return await planned(client, document)


async def aircraft(client: httpx.AsyncClient, name: str, kind: str = "fixed_wing") -> str:
    """The id of a connected simulated aircraft."""
    path = await connected(client, f"sim:?type={kind}&airspeed=20&turn_radius=100", name)
    return path.rsplit("/", 1)[1]


async def test_files_are_of_one_vehicle_each(client: httpx.AsyncClient, fleet_plan: str) -> None:
    """Two missions that differ, none of a vehicle or a sortie that is not there; one report for each."""
    base = f"{PLANS}/{fleet_plan}"
    plan: dict[str, Any] = (await client.get(base + "/plan.geojson")).json()
    assert set(plan["metrics"]["vehicles"]) == {"north", "south"}
    paths = [f["properties"] for f in plan["features"] if f["properties"]["role"] == "path"]
    assert {p["vehicle"] for p in paths} == {"north", "south"}
    assert min(p["start_s"] for p in paths) == 0.0 < max(p["start_s"] for p in paths)
    texts = {
        name: (await client.get(base + "/mission.waypoints", params={"vehicle": name})).text
        for name in ("north", "south")
    }
    assert texts["north"] != texts["south"]
    assert (await client.get(base + "/mission.plan", params={"vehicle": "south"})).status_code == 200
    check_problem(await client.get(base + "/mission.plan", params={"vehicle": "west"}), 404)
    check_problem(await client.get(base + "/mission.plan", params={"vehicle": "south", "sortie": 2}), 404)
    kml = (await client.get(base + "/mission.kml", params={"vehicle": "north"})).text
    assert "path of north" in kml
    assert "path of south" not in kml
    report = (await client.get(base + "/report.html")).text
    own = (await client.get(base + "/report.html", params={"vehicle": "south"})).text
    assert report.count("north") > own.count("north")
    assert "Who does what" in own
    check_problem(await client.get(base + "/report.html", params={"vehicle": "west"}), 404)


async def test_all_vehicles_are_sent_their_missions_in_one_call(
    client: httpx.AsyncClient, fleet_plan: str
) -> None:
    """One verdict, each vehicle holds its own; nothing is sent where one has no vehicle of its own."""
    ids = {name: await aircraft(client, name) for name in ("north", "south")}
    for wrong in ({"north": ids["north"]}, dict.fromkeys(ids, ids["north"]), ids | {"west": ids["north"]}):
        refused = await client.post(VEHICLES + "/missions", json={"plan_id": fleet_plan, "vehicles": wrong})
        check_problem(refused, 422)
    unknown = {"plan_id": fleet_plan, "vehicles": ids | {"south": "nobody"}}
    check_problem(await client.post(VEHICLES + "/missions", json=unknown), 404)
    for vehicle in ids.values():
        assert (await client.get(f"{VEHICLES}/{vehicle}")).json()["upload"] is None
    body = {"plan_id": fleet_plan, "vehicles": ids}
    answer = await client.post(VEHICLES + "/missions", json=body, timeout=PATIENCE_S)
    assert answer.status_code == 200, answer.text
    verdict = answer.json()
    assert (verdict["outcome"], verdict["verified"]) == ("accepted", True), verdict
    assert {name: told["vehicle_id"] for name, told in verdict["vehicles"].items()} == ids
    assert {told["upload"]["plan_vehicle"] for told in verdict["vehicles"].values()} == set(ids)
    held = [
        (await client.get(f"{VEHICLES}/{each}/mission")).json()["parts"]["mission"] for each in ids.values()
    ]
    assert held[0] != held[1]


async def test_one_vehicle_that_is_refused_holds_up_no_other(
    client: httpx.AsyncClient, fleet_plan: str
) -> None:
    """A multirotor where a wing is meant: it is refused with the reason, the other holds its mission."""
    ids = {"north": await aircraft(client, "north"), "south": await aircraft(client, "south", "multirotor")}
    body = {"plan_id": fleet_plan, "vehicles": ids}
    answer = await client.post(VEHICLES + "/missions", json=body, timeout=PATIENCE_S)
    check_problem(answer, 409, "vehicle-type")
    verdict = answer.json()
    assert (verdict["outcome"], verdict["verified"]) == ("refused", False), verdict
    assert verdict["vehicles"]["north"]["upload"]["verified"]
    assert verdict["vehicles"]["south"]["upload"] is None
    assert verdict["vehicles"]["south"]["reason"]
