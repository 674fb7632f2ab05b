"""How arcs are said, from the request to the vehicle: exported, uploaded, compared, remembered."""

from __future__ import annotations

import asyncio
from pathlib import Path

import httpx
from typer.testing import CliRunner

from app.cli.root import cli
from app.settings import Settings
from tests.app.conftest import stored
from tests.app.test_gimbal import commands
from tests.app.test_problems import check_problem
from tests.app.test_restart import VEHICLES, add, autopilot, free_port, held_plan, service, until

#: NAV_LOITER_TURNS, which only arcs and returns are said by.
TURNS = "18"


async def test_files_say_arcs_as_asked_for(client: httpx.AsyncClient, plan_id: str, plan_file: Path) -> None:
    """Finer chords are more points, wider ones fewer; loiter turns are fewer items; nonsense is refused."""
    base = f"/api/v1/plans/{plan_id}/mission.waypoints"

    async def rows(**asked: str) -> list[str]:
        return commands((await client.get(base, params=asked)).text)

    fine, usual, coarse = [await rows(arcs="points", chord_error_m=error) for error in ("0.5", "2", "20")]
    assert len(fine) > len(usual) > len(coarse)
    assert await rows(arcs="points") == usual
    loiter = await rows(arcs="loiter")
    assert loiter.count(TURNS) > usual.count(TURNS)
    assert await rows() in (usual, await rows(arcs="auto"))
    for wrong in ({"arcs": "round"}, {"chord_error_m": "0"}, {"chord_error_m": "nan"}):
        check_problem(await client.get(base, params=wrong), 422)
    command = f"export {plan_file} --format waypoints --arcs points --chord-error-m 0.5"
    told = await asyncio.to_thread(CliRunner().invoke, cli, command.split())
    assert commands(told.stdout) == fine


async def test_arcs_are_compared_and_recognised_as_they_were_sent(
    settings: Settings, plan_file: Path
) -> None:
    """The check before flight asks for the same, before a restart and after; else it is another mission."""
    url = f"127.0.0.1:{free_port()}"
    body = {"arcs": "points", "chord_error_m": 10.0}

    async def mission(client: httpx.AsyncClient, vehicle: str, asked: dict[str, object]) -> str:
        answer = await client.post(f"{VEHICLES}/{vehicle}/preflight", json=asked)
        return str(next(c["status"] for c in answer.json()["checks"] if c["name"] == "mission"))

    async with autopilot(f"udpout:{url}"):
        async with service(settings) as client:
            vehicle = (await add(client, "uav", f"udpin:{url}"))["id"]
            body |= {"plan_id": await stored(client, plan_file)}
            report = await client.post(f"{VEHICLES}/{vehicle}/mission", json=body)
            assert report.json()["verified"], report.text
            assert await mission(client, vehicle, body) == "ok"
            assert await mission(client, vehicle, {"plan_id": body["plan_id"]}) == "failed"
        async with service(settings) as client:
            assert (await until(client, lambda body: body["plan_id"] is not None))["plan_id"] == body[
                "plan_id"
            ]
            assert await mission(client, vehicle, body) == "ok"
    assert held_plan(settings) == body["plan_id"]
