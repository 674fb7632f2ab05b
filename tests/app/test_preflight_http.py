"""The pre-flight check and parameters over HTTP, with simulated aircraft."""

from __future__ import annotations

from pathlib import Path

import httpx
import pytest

from app.routers.bodies import EXAMPLE
from tests.app.conftest import stored
from tests.app.test_problems import check_problem
from tests.app.test_vehicles import connected


@pytest.mark.parametrize("autopilot", ["ardupilot", "px4"])
async def test_ready_after_an_upload_and_not_before(
    client: httpx.AsyncClient, plan_file: Path, autopilot: str
) -> None:
    """An empty vehicle is not ready; behind the upload of mission and fence it is, and says so again."""
    plan_id = await stored(client, plan_file, EXAMPLE)
    vehicle = await connected(client, f"sim:?speedup=20&autopilot={autopilot}")
    body = {"plan_id": plan_id}
    before = (await client.post(vehicle + "/preflight", json=body)).json()
    assert not before["ready"]
    failed = {check["name"] for check in before["checks"] if check["status"] == "failed"}
    assert "mission" in failed
    parts = {"parts": ["mission", "fence"]}
    behind = (await client.post(vehicle + "/mission", json=body | parts)).json()["preflight"]
    assert behind["ready"], behind
    again = (await client.post(vehicle + "/preflight", json=body)).json()
    assert again["ready"], again
    assert [check["name"] for check in again["checks"]] == [check["name"] for check in behind["checks"]]


async def test_a_refused_upload_has_no_preflight(client: httpx.AsyncClient, plan_id: str) -> None:
    """An unknown plan is a 404, a wrong payload a 422; a mission alone leaves the fence to be missed."""
    vehicle = await connected(client)
    check_problem(await client.post(vehicle + "/preflight", json={"plan_id": "none"}), 404)
    wrong = {"plan_id": plan_id, "payload": "laser"}
    check_problem(await client.post(vehicle + "/preflight", json=wrong), 422, "payload")
    report = (await client.post(vehicle + "/mission", json={"plan_id": plan_id})).json()["preflight"]
    status = {check["name"]: check["status"] for check in report["checks"]}
    assert status["mission"] == "ok"


async def test_parameters_are_read_and_judged(client: httpx.AsyncClient, plan_file: Path) -> None:
    """Names asked for come back; unknown ones are named; a plan brings its own, with findings."""
    plan_id = await stored(client, plan_file, EXAMPLE)
    vehicle = await connected(client, "sim:?l1_period=40")
    path = vehicle + "/parameters"
    read = (await client.get(path, params={"name": ["NAVL1_PERIOD", "NO_SUCH"]})).json()
    assert [(p["name"], p["value"]) for p in read["parameters"]] == [("NAVL1_PERIOD", 40.0)]
    assert (read["missing"], read["findings"]) == (["NO_SUCH"], [])
    judged = (await client.get(path, params={"plan_id": plan_id})).json()
    findings = {finding["name"]: finding for finding in judged["findings"]}
    finding = findings.pop("NAVL1_PERIOD")
    assert finding["severity"] == "warning"
    # Its circles are climbed and descended in at its own 5 m/s, steeper than the plan's 8°.
    assert set(findings) <= {"TECS_CLMB_MAX", "TECS_SINK_MAX"}
    assert finding["advised"] < 40.0
    assert "WP_RADIUS" in {parameter["name"] for parameter in judged["parameters"]}
    check_problem(await client.get(path), 422, "name-missing")
    check_problem(await client.get(path, params={"name": "MORE_THAN_SIXTEEN_LETTERS"}), 422, "parameter-name")
