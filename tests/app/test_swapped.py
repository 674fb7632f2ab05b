"""Somebody swaps the aircraft at a vehicle's address: the other gets no order before somebody says so."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import httpx

from app.main import create_app
from app.settings import Settings
from mavlink.sim.run import serve
from mavlink.sim.settings import SimSettings
from tests.app.conftest import impatient_house, serving, stored
from tests.app.test_problems import check_problem
from tests.app.test_restart import free_port
from tests.patience import PATIENCE_S

VEHICLES = "/api/v1/vehicles"


@asynccontextmanager
async def aircraft(url: str, system_id: int) -> AsyncIterator[None]:
    """An aircraft that calls an address."""
    flying = asyncio.create_task(serve(url, SimSettings(system_id=system_id)))
    try:
        yield
    finally:
        flying.cancel()
        await asyncio.gather(flying, return_exceptions=True)


async def until(client: httpx.AsyncClient, place: str, ready: Callable[[Any], bool]) -> Any:
    """The vehicle, once it is ready."""
    async with asyncio.timeout(PATIENCE_S):
        while not ready(body := (await client.get(place)).json()):
            await asyncio.sleep(0.05)
    return body


async def test_a_swapped_aircraft_is_named_refused_and_acknowledged(
    settings: Settings, plan_file: Path
) -> None:
    """Its system is told, orders and uploads are refused, the plan is not its; then it is the vehicle."""
    port = free_port()
    async with serving(create_app(settings, impatient_house)) as client:
        async with aircraft(f"udpout:127.0.0.1:{port}", 1):
            answer = await client.post(VEHICLES, json={"name": "uav", "url": f"udpin:127.0.0.1:{port}"})
            place = answer.headers["location"]
            assert (answer.json()["system_id"], answer.json()["other_system"]) == (1, None)
            plan_id = await stored(client, plan_file)
            report = await client.post(place + "/mission", json={"plan_id": plan_id})
            assert report.json()["verified"], report.text
            assert (await client.get(place)).json()["plan_id"] == plan_id
            # The one that is there is not another.
            check_problem(await client.post(place + "/identity", json={"system_id": 1}), 409)
        async with aircraft(f"udpout:127.0.0.1:{port}", 2):
            swapped = await until(client, place, lambda body: body["other_system"] == 2)
            assert (swapped["connected"], swapped["system_id"]) == (False, 1)
            assert swapped["sent"]["standing"] == "unknown"
            for path, body in [
                ("/commands", {"command": "arm"}),
                ("/commands", {"command": "start"}),
                ("/mission", {"plan_id": plan_id}),
            ]:
                refused = await client.post(place + path, json=body)
                assert refused.status_code == 409, refused.text
                assert "system 2 answers where system 1 did" in refused.json()["detail"]
            check_problem(await client.post(place + "/identity", json={"system_id": 3}), 409)
            check_problem(await client.post(place + "/identity", json={"system_id": 0}), 422)
            assert (await client.post(place + "/identity", json={"system_id": 2})).status_code == 200
            taken = await until(client, place, lambda body: body["connected"])
            known = ("system_id", "other_system", "plan_id", "sent", "upload", "pending")
            assert [taken[name] for name in known] == [2, None, None, None, None, False]
            held = (await client.get(place + "/mission")).json()
            assert held["parts"]["mission"] == []
            report = await client.post(place + "/mission", json={"plan_id": plan_id})
            assert report.json()["verified"], report.text
            assert (await client.get(place)).json()["plan_id"] == plan_id


async def test_a_swap_while_the_service_was_down_is_noticed(settings: Settings) -> None:
    """The system is remembered: after a restart another one is not taken for the vehicle, the same one is."""
    port = free_port()
    async with (
        aircraft(f"udpout:127.0.0.1:{port}", 7),
        serving(create_app(settings, impatient_house)) as client,
    ):
        answer = await client.post(VEHICLES, json={"name": "uav", "url": f"udpin:127.0.0.1:{port}"})
        place = answer.headers["location"]
        assert answer.json()["connected"]
    async with (
        aircraft(f"udpout:127.0.0.1:{port}", 8),
        serving(create_app(settings, impatient_house)) as client,
    ):
        swapped = await until(client, place, lambda body: body["other_system"] == 8)
        assert (swapped["connected"], swapped["system_id"]) == (False, 7)
        assert (await client.post(place + "/identity", json={"system_id": 8})).status_code == 200
        await until(client, place, lambda body: body["connected"])
    async with (
        aircraft(f"udpout:127.0.0.1:{port}", 8),
        serving(create_app(settings, impatient_house)) as client,
    ):
        same = await until(client, place, lambda body: body["connected"])
        assert (same["system_id"], same["other_system"]) == (8, None)
