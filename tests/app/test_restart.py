"""What a service remembers of its vehicles when it is started again, and that it commands none of them."""

from __future__ import annotations

import asyncio
import contextlib
import itertools
import os
import socket
import sqlite3
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager, closing
from pathlib import Path
from typing import Any

import httpx
import pytest
from pymavlink.dialects.v20 import ardupilotmega

from app.main import create_app
from app.services.house import House
from app.services.limits import Limits
from app.settings import Settings
from mavlink.links.link import Link
from mavlink.links.tcp import open_tcp_server
from mavlink.sim.modes import Flavour
from mavlink.sim.run import serve, serve_link
from mavlink.sim.settings import SimSettings
from tests.app.conftest import fake_house, impatient_house, serving, stored
from tests.patience import PATIENCE_S

VEHICLES = "/api/v1/vehicles"


_LEAST_PORT, _PORTS = 16_000, 16_000
_tries = itertools.count(os.getpid() * 61)


def free_port() -> int:
    """A port nobody listens on, below those the system hands out: nobody gets it while nobody listens."""
    for number in _tries:
        port = _LEAST_PORT + number % _PORTS
        with (
            contextlib.suppress(OSError),
            socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as udp,
            socket.socket(socket.AF_INET, socket.SOCK_STREAM) as tcp,
        ):
            for probe in (udp, tcp):
                probe.bind(("127.0.0.1", port))
            return port
    raise AssertionError("unreachable")


def held_plan(settings: Settings) -> str | None:
    """The plan that is noted for the only vehicle."""
    with closing(sqlite3.connect(settings.database)) as database:
        (plan_id,) = database.execute("SELECT held_plan_id FROM vehicles").fetchone()
    return None if plan_id is None else str(plan_id)


@asynccontextmanager
async def service(
    settings: Settings, house: Callable[[Limits], House] = fake_house
) -> AsyncIterator[httpx.AsyncClient]:
    """One life of the service."""
    async with serving(create_app(settings, house)) as client:
        yield client


@asynccontextmanager
async def autopilot(url: str) -> AsyncIterator[None]:
    """A simulated aircraft that does not belong to the service."""
    simulator = asyncio.create_task(serve(url, SimSettings()))
    try:
        yield
    finally:
        simulator.cancel()
        await asyncio.gather(simulator, return_exceptions=True)


@asynccontextmanager
async def flying(link: Link, settings: SimSettings) -> AsyncIterator[None]:
    """A simulated aircraft on a link, until it vanishes."""
    simulator = asyncio.create_task(serve_link(link, settings))
    try:
        yield
    finally:
        simulator.cancel()
        await asyncio.gather(simulator, return_exceptions=True)


async def until(client: httpx.AsyncClient, ready: Callable[[Any], bool]) -> Any:
    """The first vehicle, once it is ready."""
    async with asyncio.timeout(PATIENCE_S):
        while not ready(body := (await client.get(VEHICLES)).json()["vehicles"][0]):
            await asyncio.sleep(0.05)
    return body


async def add(client: httpx.AsyncClient, name: str, url: str, timeout_s: float = 10.0) -> dict[str, Any]:
    """A vehicle that was added."""
    answer = await client.post(VEHICLES, json={"name": name, "url": url, "timeout_s": timeout_s})
    assert answer.status_code == 201, answer.text
    body: dict[str, Any] = answer.json()
    return body


async def test_vehicles_come_back_under_their_ids(settings: Settings) -> None:
    """Added vehicles are there after a restart, simulated ones fly anew; one let go is not."""
    async with service(settings) as client:
        kept = await add(client, "sim", "sim:?speedup=10")
        silent = await add(client, "quiet", f"udpin:127.0.0.1:{free_port()}", 0.1)
        gone = await add(client, "gone", f"udpin:127.0.0.1:{free_port()}", 0.1)
        await client.delete(f"{VEHICLES}/{gone['id']}")
    async with service(settings) as client:
        known = (await client.get(VEHICLES)).json()["vehicles"]
        identity = ("id", "name", "url", "created_at")
        assert [[v[key] for key in identity] for v in known] == [
            [v[key] for key in identity] for v in (kept, silent)
        ]
        assert not (await until(client, lambda body: body["connected"]))["state"]["armed"]


async def test_held_plan_is_read_back_not_believed(settings: Settings, plan_file: Path) -> None:
    """The plan a vehicle held is its plan again when it still holds it, and no longer when it was cleared."""
    url = f"127.0.0.1:{free_port()}"
    async with autopilot(f"udpout:{url}"):
        async with service(settings) as client:
            vehicle = await add(client, "uav", f"udpin:{url}")
            plan_id = await stored(client, plan_file)
            report = await client.post(f"{VEHICLES}/{vehicle['id']}/mission", json={"plan_id": plan_id})
            assert report.json()["verified"], report.text
        async with service(settings) as client:
            assert (await until(client, lambda body: body["plan_id"] is not None))["plan_id"] == plan_id
    assert held_plan(settings) == plan_id
    async with autopilot(f"udpout:{url}"), service(settings) as client:
        # another aircraft at the same address, with an empty mission
        await until(client, lambda body: body["connected"])
        async with asyncio.timeout(PATIENCE_S):
            while held_plan(settings) is not None:
                await asyncio.sleep(0.1)
        assert (await until(client, lambda body: body["connected"]))["plan_id"] is None


async def test_reconnection_commands_nothing(settings: Settings) -> None:
    """What a restarted service sends to a vehicle it knows: heartbeats and requests for data, no more."""
    port = free_port()
    async with service(settings) as client:
        await add(client, "uav", f"udpin:127.0.0.1:{port}", 0.1)
    heard = ardupilotmega.MAVLink(None, srcSystem=1, srcComponent=1)
    heartbeat = heard.heartbeat_encode(
        ardupilotmega.MAV_TYPE_FIXED_WING, ardupilotmega.MAV_AUTOPILOT_ARDUPILOTMEGA, 0, 0, 3
    ).pack(heard)
    sent = []
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as vehicle:
        vehicle.bind(("127.0.0.1", 0))
        vehicle.setblocking(False)
        async with service(settings) as client:
            for _ in range(20):
                vehicle.sendto(heartbeat, ("127.0.0.1", port))
                await asyncio.sleep(0.1)
                while True:
                    try:
                        sent += heard.parse_buffer(vehicle.recv(4096)) or []
                    except BlockingIOError:
                        break
            assert (await until(client, lambda body: body["connected"]))["name"] == "uav"
    kinds = {message.get_type() for message in sent}
    assert {"HEARTBEAT", "COMMAND_LONG"} <= kinds
    assert kinds <= {"HEARTBEAT", "COMMAND_LONG", "TIMESYNC", "PING"}
    commands = {message.command for message in sent if message.get_type() == "COMMAND_LONG"}
    assert commands <= {
        ardupilotmega.MAV_CMD_SET_MESSAGE_INTERVAL,
        ardupilotmega.MAV_CMD_REQUEST_MESSAGE,
    }


async def test_link_that_cannot_be_opened_says_why_and_opens_later(settings: Settings) -> None:
    """A TCP vehicle that is not there at the start is listed with the reason, and connects when it comes."""
    port = free_port()
    link = await open_tcp_server("127.0.0.1", port)
    async with flying(link, SimSettings()), service(settings) as client:
        await add(client, "uav", f"tcp:127.0.0.1:{port}")
    await link.close()
    async with service(settings) as client:
        body = await until(client, lambda body: body["link_failure"])
        assert not body["connected"]
        assert str(port) in body["link_failure"]
        async with autopilot(f"tcpin:127.0.0.1:{port}"):
            assert (await until(client, lambda body: body["connected"]))["link_failure"] is None


@pytest.mark.parametrize("url", ["sim:?colour=red", "pigeon:post"])
async def test_address_no_longer_understood_is_forgotten(settings: Settings, url: str) -> None:
    """A kept address that this version cannot read does not keep the service from starting."""
    async with service(settings) as client:
        await add(client, "uav", f"udpin:127.0.0.1:{free_port()}", 0.1)
    with closing(sqlite3.connect(settings.database)) as database, database:
        database.execute("UPDATE vehicles SET url = ?", (url,))
    async with service(settings) as client:
        assert (await client.get(VEHICLES)).json() == {"vehicles": []}


@asynccontextmanager
async def holding(settings: SimSettings, url: str) -> AsyncIterator[None]:
    """A simulated aircraft of some kind that does not belong to the service."""
    simulator = asyncio.create_task(serve(url, settings))
    try:
        yield
    finally:
        simulator.cancel()
        await asyncio.gather(simulator, return_exceptions=True)


@pytest.mark.parametrize("kind", ["ardupilot", "px4"])
async def test_what_was_sent_last_stands_as_far_as_it_is_known(
    settings: Settings, plan_file: Path, kind: str
) -> None:
    """After a restart: unknown while silent, held once read back, differs once another aircraft is there."""
    url = f"127.0.0.1:{free_port()}"
    aircraft = SimSettings(autopilot=Flavour(kind))
    async with holding(aircraft, f"udpout:{url}"):
        async with service(settings) as client:
            vehicle = await add(client, "uav", f"udpin:{url}")
            assert vehicle["sent"] is None
            plan_id = await stored(client, plan_file)
            await client.post(f"{VEHICLES}/{vehicle['id']}/mission", json={"plan_id": plan_id})
            sent = (await until(client, lambda body: body["operation"] is None))["sent"]
            assert (sent["plan_id"], sent["standing"], sent["shown_by"]) == (plan_id, "held", "read_back")
            assert (sent["list_id"] is None) == (kind == "ardupilot")
        async with service(settings) as client:
            again = (await until(client, lambda body: body["plan_id"] is not None))["sent"]
            assert again["read_back_at"] > sent["read_back_at"]
            assert {key: again[key] for key in ("plan_id", "list_id", "standing", "shown_by")} == {
                key: sent[key] for key in ("plan_id", "list_id", "standing", "shown_by")
            }
    async with service(settings) as client:
        silent = (await until(client, lambda body: True))["sent"]
        assert (silent["plan_id"], silent["standing"], silent["shown_by"]) == (plan_id, "unknown", None)
        async with holding(aircraft, f"udpout:{url}"):
            await until(client, lambda body: body["sent"]["shown_by"] == "read_back")
            empty = (await client.get(VEHICLES)).json()["vehicles"][0]
            assert (empty["sent"]["standing"], empty["plan_id"]) == ("differs", None)
    async with holding(aircraft, f"udpout:{url}"), service(settings) as client:
        # Once found different it is not read again: no list, no id, nothing known, and that is said.
        known = await until(client, lambda body: body["connected"])
        assert (known["sent"]["plan_id"], known["sent"]["standing"]) == (plan_id, "unknown")
        await client.delete(f"{VEHICLES}/{known['id']}/mission")
        assert (await until(client, lambda body: body["operation"] is None))["sent"] is None


async def test_a_vehicle_that_fell_silent_is_not_taken_for_the_one_that_comes_back(
    settings: Settings, plan_file: Path
) -> None:
    """Held by read-back; then another aircraft answers at the same address: unknown, until it is read."""
    url = f"127.0.0.1:{free_port()}"
    async with service(settings, impatient_house) as client:
        async with holding(SimSettings(), f"udpout:{url}"):
            vehicle = await add(client, "uav", f"udpin:{url}")
            plan_id = await stored(client, plan_file)
            await client.post(f"{VEHICLES}/{vehicle['id']}/mission", json={"plan_id": plan_id})
            await until(client, lambda body: body["sent"]["standing"] == "held")
        await until(client, lambda body: not body["connected"])
        async with holding(SimSettings(), f"udpout:{url}"):
            back = await until(client, lambda body: body["connected"])
            assert (back["sent"]["standing"], back["sent"]["read_back_at"]) == ("unknown", None)
            await client.post(f"{VEHICLES}/{vehicle['id']}/preflight", json={"plan_id": plan_id})
            read = (await until(client, lambda body: body["operation"] is None))["sent"]
            assert (read["standing"], read["shown_by"]) == ("differs", "read_back")


async def test_a_deleted_plan_leaves_the_id_to_tell(settings: Settings, plan_file: Path) -> None:
    """What was sent cannot be compared any more; a PX4's id still shows that it is there, as a first sign."""
    url = f"127.0.0.1:{free_port()}"
    async with holding(SimSettings(autopilot=Flavour.PX4), f"udpout:{url}"):
        async with service(settings) as client:
            vehicle = await add(client, "uav", f"udpin:{url}")
            plan_id = await stored(client, plan_file)
            await client.post(f"{VEHICLES}/{vehicle['id']}/mission", json={"plan_id": plan_id})
            await client.delete(f"/api/v1/plans/{plan_id}")
        async with service(settings) as client:
            body = await until(client, lambda body: body["sent"]["standing"] != "unknown")
            assert (body["sent"]["standing"], body["sent"]["shown_by"]) == ("held", "id")
            assert body["plan_id"] is None
