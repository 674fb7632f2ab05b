"""Vehicles forwarded to other ground stations over HTTP: who watches, who commands, what is remembered."""

from __future__ import annotations

import asyncio
import contextlib
import socket
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

import httpx
import pytest

from app.main import create_app
from app.server import Welcome
from app.services.vehicles.greeting import greet
from app.settings import Settings
from mavlink.links.recording import STAMP
from mavlink.links.udp import open_udp
from mavlink.sim.settings import SimSettings
from mavlink.wire.codec import Codec
from mavlink.wire.messages import Message
from tests.app.conftest import fake_house, serving
from tests.app.deaf import deaf_vehicle
from tests.app.test_problems import check_problem
from tests.app.test_restart import autopilot, free_port, service
from tests.app.test_two_operators import uploading
from tests.app.test_vehicles import VEHICLES, faulty_vehicle, until
from tests.mavlink.station.forward.test_hub import Station
from tests.patience import PATIENCE_S

ARM = 400


@contextlib.asynccontextmanager
async def station() -> AsyncIterator[tuple[Station, str]]:
    """Another ground station, and the address to forward to."""
    link = await open_udp("127.0.0.1", 0, listen=True)
    try:
        yield Station(link), f"udpout:127.0.0.1:{link.local_port}"
    finally:
        await link.close()


async def forward(client: httpx.AsyncClient, vehicle: str, *addresses: dict[str, Any]) -> dict[str, Any]:
    """Forward a vehicle; the first address as it is then."""
    answer = await client.put(vehicle + "/forward", json={"forward": addresses})
    assert answer.status_code == 200, answer.text
    told: list[dict[str, Any]] = answer.json()["forward"]
    assert [(each["url"], each["write"]) for each in told] == [(a["url"], a["write"]) for a in addresses]
    return told[0] if told else {}


async def test_watching_commanding_and_the_record(client: httpx.AsyncClient) -> None:
    """A watcher hears and is not heard; once it may write its order arms the vehicle, and is in the .tlog."""
    async with station() as (peer, url), faulty_vehicle(client, SimSettings()) as vehicle:
        told = await forward(client, vehicle, {"url": url, "write": False})
        assert (told["failure"], told["peers"]) == (None, 1)
        await peer.until("GLOBAL_POSITION_INT")
        refused = peer.say("COMMAND_LONG", command=ARM, param1=1.0)
        body = await until(client, vehicle, lambda body: body["forward"][0]["frames"]["refused"] == 1)
        assert not body["state"]["armed"]
        again = await forward(client, vehicle, {"url": url, "write": True})
        assert again["frames"]["sent"] >= told["frames"]["sent"]
        order = peer.say("COMMAND_LONG", command=ARM, param1=1.0)
        body = await until(client, vehicle, lambda body: body["state"]["armed"])
        assert body["forward"][0]["stations"] == [245]
        (log,) = (await client.get(vehicle + "/logs")).json()["logs"]
        recorded = (await client.get(log["url"])).content
        assert (order in recorded, refused in recorded) == (True, False)
        assert (await client.get(vehicle + "/forward")).json()["forward"][0]["frames"]["passed"] == 1
        await forward(client, vehicle)
        assert (await client.get(vehicle)).json()["forward"] == []


async def test_forwarded_from_the_start(client: httpx.AsyncClient, tmp_path: Path) -> None:
    """A vehicle added with its forwards has them; without a host they are on this machine alone."""
    async with station() as (peer, url):
        port = url.rpartition(":")[2]
        added = {"name": "uav", "url": "sim:", "forward": [{"url": f"udpout:{port}"}, {"url": "tcpin:0"}]}
        answer = await client.post(VEHICLES, json=added)
        assert answer.status_code == 201, answer.text
        first, second = answer.json()["forward"]
        assert (first["url"], first["write"], first["failure"]) == (url, False, None)
        assert second["url"] == "tcpin:127.0.0.1:0"
        assert await peer.until("HEARTBEAT")
        # A station on TCP reads the same, by another route.
        reader, writer = await asyncio.open_connection("127.0.0.1", int(second["address"].rpartition(":")[2]))
        codec, heard = Codec(), set[str]()
        async with asyncio.timeout(PATIENCE_S):
            while "HEARTBEAT" not in heard:
                heard |= {message.name for message in codec.feed(await reader.read(4096))}
        writer.close()
        await writer.wait_closed()
        assert (await client.delete(answer.headers["location"])).status_code == 204


@pytest.mark.parametrize(
    ("forwards", "rule"),
    [
        ([{"url": "serial:/dev/ttyS0:57600"}], "forward-address"),
        ([{"url": "udpout:127.0.0.1:0"}], "forward-address"),
        ([{"url": "udpout:14550"}, {"url": "udpout:127.0.0.1:14550", "write": True}], "forward-twice"),
        ([{"url": "udpout:PORT"}], "forward-loop"),
        ([{"url": "udpout:14550"}, {"url": "udpin:14550"}], "forward-loop"),
        ([{"url": "udpout:14550", "writable": True}], "extra_forbidden"),
    ],
)
async def test_bad_forwards_are_refused_whole(
    client: httpx.AsyncClient, forwards: list[dict[str, Any]], rule: str
) -> None:
    """What is malformed or would loop is refused with its rule, and the vehicle is not added."""
    port = free_port()
    forwards = [each | {"url": each["url"].replace("PORT", str(port))} for each in forwards]
    body = {"name": "uav", "url": f"udpin:127.0.0.1:{port}", "timeout_s": 0.1, "forward": forwards}
    check_problem(await client.post(VEHICLES, json=body), 422, rule)
    assert (await client.get(VEHICLES)).json() == {"vehicles": []}
    added = await client.post(VEHICLES, json=body | {"forward": []})
    check_problem(
        await client.put(added.headers["location"] + "/forward", json={"forward": forwards}), 422, rule
    )


async def test_a_port_in_use_changes_nothing(client: httpx.AsyncClient) -> None:
    """An address that cannot be listened on is a conflict: no vehicle, and no half of a list."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("127.0.0.1", 0))
        url = f"udpin:127.0.0.1:{taken.getsockname()[1]}"
        body = {"name": "uav", "url": f"udpin:127.0.0.1:{free_port()}", "timeout_s": 0.1}
        refused = await client.post(VEHICLES, json=body | {"forward": [{"url": url}]})
        check_problem(refused, 409)
        assert url in refused.json()["detail"]
        assert (await client.get(VEHICLES)).json() == {"vehicles": []}
        added = await client.post(VEHICLES, json=body | {"forward": [{"url": "tcpin:0"}]})
        forwards = [{"url": "udpin:0"}, {"url": url}]
        place = added.headers["location"] + "/forward"
        check_problem(await client.put(place, json={"forward": forwards}), 409)
        assert [each["url"] for each in (await client.get(place)).json()["forward"]] == ["tcpin:127.0.0.1:0"]


async def test_forwards_are_remembered(settings: Settings) -> None:
    """After a restart the same addresses are forwarded to, with the same rights; also as changed since."""
    async with station() as (peer, url):
        async with service(settings) as client:
            body = {"name": "uav", "url": "sim:", "forward": [{"url": "tcpin:0"}]}
            vehicle = (await client.post(VEHICLES, json=body)).headers["location"]
        async with service(settings) as client:
            (told,) = (await client.get(vehicle)).json()["forward"]
            assert (told["url"], told["write"]) == ("tcpin:127.0.0.1:0", False)
            await forward(client, vehicle, {"url": url, "write": True})
        async with service(settings) as client:
            await until(client, vehicle, lambda body: body["connected"])
            await until(client, vehicle, lambda body: body["forward"][0]["frames"]["sent"] > 0)
            await peer.until("HEARTBEAT")
            peer.say("COMMAND_LONG", command=ARM, param1=1.0)
            await until(client, vehicle, lambda body: body["state"]["armed"])


async def test_a_station_does_not_disturb_an_upload(client: httpx.AsyncClient, plan_id: str) -> None:
    """In mid-upload it neither clears nor arms; the upload is accepted and reads back as meant."""
    async with station() as (peer, url), deaf_vehicle(client) as (vehicle, link):
        await forward(client, vehicle, {"url": url, "write": True})
        await peer.until("HEARTBEAT")
        upload = await uploading(client, vehicle, plan_id)
        peer.say("MISSION_CLEAR_ALL")
        peer.say("COMMAND_LONG", command=ARM, param1=1.0)
        await until(client, vehicle, lambda body: body["forward"][0]["frames"]["held_back"] == 2)
        link.hears = True
        assert (await upload).json()["verified"]
        body = (await client.get(vehicle)).json()
        assert (body["plan_id"], body["state"]["armed"]) == (plan_id, False)


async def test_what_a_station_changes_is_noticed(client: httpx.AsyncClient, plan_id: str) -> None:
    """While it changes the mission nothing is uploaded or armed here; afterwards the change is told."""
    async with station() as (peer, url), faulty_vehicle(client, SimSettings()) as vehicle:
        await forward(client, vehicle, {"url": url, "write": True})
        await peer.until("HEARTBEAT")
        report = await client.post(vehicle + "/mission", json={"plan_id": plan_id})
        assert report.json()["verified"], report.text
        assert (await client.get(vehicle)).json()["sent"]["standing"] == "held"
        peer.say("MISSION_COUNT", count=2)
        await peer.until("MISSION_REQUEST")
        refused = await client.post(vehicle + "/mission", json={"plan_id": plan_id})
        check_problem(refused, 409)
        assert "system 245" in refused.json()["detail"]
        refused = await client.post(vehicle + "/commands", json={"command": "arm"})
        check_problem(refused, 409)
        assert "system 245" in refused.json()["detail"]
        body = (await client.get(vehicle)).json()
        assert (body["plan_id"], body["sent"]["standing"]) == (None, "unknown")
        for seq in range(2):
            peer.say("MISSION_ITEM_INT", seq=seq, frame=3, command=16, x=473977000, y=85456000, z=50.0)
        body = await until(client, vehicle, lambda body: body["sent"]["standing"] != "unknown")
        assert (body["plan_id"], body["sent"]["standing"], body["sent"]["shown_by"]) == (
            None,
            "differs",
            "read_back",
        )
        assert (await client.post(vehicle + "/mission", json={"plan_id": plan_id})).json()["verified"]


async def test_a_recording_is_watched_and_not_commanded(client: httpx.AsyncClient, tmp_path: Path) -> None:
    """A replayed flight can be shown to another station, which may not be allowed to write."""
    async with station() as (peer, url):
        vehicle = Codec(1, 1)
        heartbeat = vehicle.pack(Message("HEARTBEAT", {"type": 1, "autopilot": 3}))
        position = vehicle.pack(Message("GLOBAL_POSITION_INT", {"lat": 473977000, "lon": 85456000}))
        file = tmp_path / "flight.tlog"
        records = [STAMP.pack(1_700_000_000_000_000 + 500_000 * n) for n in range(200)]
        file.write_bytes(b"".join(stamp + heartbeat + stamp + position for stamp in records))
        body = {"name": "replay", "url": f"replay:{file}"}
        writing = body | {"forward": [{"url": url, "write": True}]}
        check_problem(await client.post(VEHICLES, json=writing), 422, "forward-write")
        watching = await client.post(VEHICLES, json=body | {"forward": [{"url": url}]})
        assert watching.status_code == 201, watching.text
        await peer.until("GLOBAL_POSITION_INT")


async def test_serve_connects_and_forwards_at_every_start(settings: Settings) -> None:
    """The vehicle of the command line is connected once, however often the service starts, and forwarded."""
    url = f"udpin:127.0.0.1:{free_port()}"
    async with autopilot(f"udpout:{url.removeprefix('udpin:')}"), station() as (peer, to):
        ids = set()
        for write in (False, True):
            app = create_app(settings, fake_house)
            async with serving(app) as client:
                await greet(app.state.house.fleet, Welcome(vehicle=url, forward=((to, write),)))
                (vehicle,) = (await client.get(VEHICLES)).json()["vehicles"]
                ids.add(vehicle["id"])
                assert (vehicle["name"], vehicle["url"]) == ("uav-1", url)
                assert [(each["url"], each["write"]) for each in vehicle["forward"]] == [(to, write)]
                await until(client, f"{VEHICLES}/{vehicle['id']}", lambda body: body["connected"])
                await peer.until("HEARTBEAT")
        assert len(ids) == 1


async def test_serve_forwards_its_simulated_aircraft(settings: Settings) -> None:
    """Without a vehicle of its own it is the simulated aircraft that is forwarded."""
    async with station() as (peer, to):
        app = create_app(settings, fake_house)
        async with serving(app) as client:
            await greet(app.state.house.fleet, Welcome(simulated=1, forward=((to, False),)))
            (vehicle,) = (await client.get(VEHICLES)).json()["vehicles"]
            assert (vehicle["name"], len(vehicle["forward"])) == ("sim-1", 1)
            await peer.until("HEARTBEAT")
