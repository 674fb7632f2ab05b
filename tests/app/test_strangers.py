"""Who else speaks on a vehicle's port, over HTTP: told, refused what flies, and acknowledged by address."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from typing import Any

import httpx

from app.main import create_app
from app.settings import Settings
from mavlink.links.udp import open_udp
from tests.app.conftest import impatient_house, serving
from tests.app.test_forwards import station
from tests.app.test_problems import check_problem
from tests.app.test_restart import free_port
from tests.mavlink.station.aircraft import Aircraft
from tests.mavlink.transfer.vehicle import StubVehicle
from tests.patience import PATIENCE_S

VEHICLES = "/api/v1/vehicles"


@asynccontextmanager
async def aircraft(port: int, system_id: int = 1) -> AsyncIterator[Aircraft]:
    """An aircraft that calls a port and notes what it is ordered."""
    link = await open_udp("127.0.0.1", port, listen=False)
    async with Aircraft(link, StubVehicle(), system_id=system_id) as flying:
        yield flying


async def until(client: httpx.AsyncClient, place: str, ready: Callable[[Any], bool]) -> Any:
    """The vehicle, once it is ready."""
    async with asyncio.timeout(PATIENCE_S):
        while not ready(body := (await client.get(place)).json()):
            await asyncio.sleep(0.05)
    return body


def armings(flying: Aircraft) -> int:
    """How often it was told to arm."""
    return sum(number == 400 for number, _ in flying.commands)


def frames(body: Any, kind: str) -> int:
    """How many frames of a kind went over the first forward."""
    return int(body["forward"][0]["frames"][kind])


async def test_of_two_aircraft_with_one_system_id_none_is_armed(settings: Settings) -> None:
    """The second is told at once; what flies is refused until an address is acknowledged, stops are not."""
    port = free_port()
    async with serving(create_app(settings, impatient_house)) as client, aircraft(port) as first:
        answer = await client.post(VEHICLES, json={"name": "uav", "url": f"udpin:127.0.0.1:{port}"})
        place = answer.headers["location"]
        assert answer.json()["doubt"] is None
        assert answer.json()["address"].startswith("127.0.0.1:")
        async with aircraft(port) as second, aircraft(port, 77) as another:
            doubted = await until(client, place, lambda body: body["doubt"] and len(body["strangers"]) == 2)
            assert doubted["doubt"]["rule"] == "two-aircraft"
            assert doubted["address"] == answer.json()["address"]
            for wish in ({"command": "arm", "hold_first": True}, {"command": "start", "arm_first": True}):
                refused = await client.post(place + "/commands", json=wish)
                check_problem(refused, 409)
                assert refused.json()["errors"][0]["rule"] == "two-aircraft"
                assert "another system id" in refused.json()["errors"][0]["fix"]
            refused = await client.delete(place + "/mission")
            check_problem(refused, 409)
            assert refused.json()["errors"][0]["rule"] == "two-aircraft"
            await client.post(place + "/commands", json={"command": "rtl", "wait_s": 0.5})
            assert (20, (0.0,) * 7) in first.commands
            assert armings(first) == armings(second) == 0

            check_problem(await client.post(place + "/address", json={"address": "127.0.0.1:1"}), 409)
            taken = await client.post(place + "/address", json={"address": doubted["address"]})
            assert (taken.status_code, taken.json()["doubt"]) == (200, None)
            await client.post(place + "/commands", json={"command": "resume", "wait_s": 0.5})
            assert 176 in [number for number, _ in first.commands]
            assert second.heard == another.heard == []


async def test_one_system_id_on_two_links_is_told(settings: Settings) -> None:
    """Each vehicle names the other, and gets its own orders; let go, the other one's name is forgotten."""
    ports = [free_port(), free_port()]
    async with (
        serving(create_app(settings, impatient_house)) as client,
        aircraft(ports[0]) as first,
        aircraft(ports[1]) as second,
    ):
        places = []
        for name, port in zip(("one", "two"), ports, strict=True):
            answer = await client.post(VEHICLES, json={"name": name, "url": f"udpin:127.0.0.1:{port}"})
            places.append(answer.headers["location"])
        for place, other in zip(places, ("two", "one"), strict=True):
            body = await until(client, place, lambda body, other=other: body["namesakes"] == [other])
            assert body["doubt"] is None
        await client.post(places[0] + "/commands", json={"command": "resume", "wait_s": 0.5})
        assert 176 in [number for number, _ in first.commands]
        assert 176 not in [number for number, _ in second.commands]
        await client.delete(places[1])
        await until(client, places[0], lambda body: body["namesakes"] == [])


async def test_a_station_that_two_of_one_system_id_are_forwarded_to_flies_neither(settings: Settings) -> None:
    """Its arming reaches none of them, its return both; once one may only be watched, the other is armed."""
    ports = [free_port(), free_port()]
    async with (
        serving(create_app(settings, impatient_house)) as client,
        aircraft(ports[0]) as first,
        aircraft(ports[1]) as second,
        station() as (peer, url),
    ):
        places = []
        for name, port in zip(("one", "two"), ports, strict=True):
            asked = {"name": name, "url": f"udpin:127.0.0.1:{port}", "forward": [{"url": url, "write": True}]}
            places.append((await client.post(VEHICLES, json=asked)).headers["location"])
        for place in places:
            await until(client, place + "/forward", lambda body: body["shared"])
        async with asyncio.timeout(PATIENCE_S):
            while peer.link.peers < 2:
                await peer.link.receive()
        peer.say("COMMAND_LONG", command=400, param1=1.0)
        peer.say("COMMAND_LONG", command=20)
        for place in places:
            await until(client, place + "/forward", lambda body: frames(body, "passed") == 1)
            assert frames((await client.get(place + "/forward")).json(), "refused") == 1
        assert armings(first) == armings(second) == 0

        answer = await client.put(places[1] + "/forward", json={"forward": [{"url": url, "write": False}]})
        assert not answer.json()["shared"]
        peer.say("COMMAND_LONG", command=400, param1=1.0)
        await until(client, places[0] + "/forward", lambda body: frames(body, "passed") == 2)
        assert (armings(first), armings(second)) == (1, 0)
