"""No sensor is left on: a pass broken off has it switched off, and the flight's record says so."""

from __future__ import annotations

import asyncio
from typing import Any

import httpx
import pytest

from mavlink.links.udp import UdpLink
from mavlink.sim.geodesy import Place
from mavlink.sim.settings import SimSettings
from mavlink.wire.codec import Codec
from mavlink.wire.items import Command
from mavlink.wire.messages import Message
from tests.app.small_flight import CRAFT, in_flight, order, planned, ready, small_scenario
from tests.app.test_restart import flying
from tests.app.test_vehicles import connected, listening, until

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
    page = await client.get(flight["links"]["report.html"])
    assert "ordered off by the service" in page.text
    track = (await client.get(flight["links"]["track.geojson"])).json()
    assert track["actions"][0]["reason"] == action["reason"]
    return action


@pytest.mark.parametrize(("autopilot", "kind"), CRAFT)
async def test_a_return_in_a_pass(client: httpx.AsyncClient, autopilot: str, kind: str) -> None:
    """On every aircraft the return leaves the sensor as it is; the service switches it off."""
    vehicle = await in_pass(client, autopilot, kind)
    assert (await order(client, vehicle, "rtl")).json()["outcome"] == "done"
    assert "RTL" in (await switched_off(client, vehicle))["reason"]


async def test_a_return_while_a_camera_takes_photos(client: httpx.AsyncClient) -> None:
    """Nothing but its photos shows that it is on: ArduPilot's goes on with them, and is switched off."""
    plan_id = await planned(client, small_scenario("ardupilot", "fixed_wing"))
    url = "sim:?speedup=20&turn_radius=60&sensor_reports=no"
    vehicle = await connected(client, url)
    body = {"plan_id": plan_id, "payload": "camera:distance=20"}
    assert (await client.post(vehicle + "/mission", json=body)).json()["verified"]
    await in_flight(client, vehicle)
    await until(client, vehicle, lambda body: body["sensor"]["on"])
    assert (await order(client, vehicle, "rtl")).json()["outcome"] == "done"
    told = await until(client, vehicle, lambda body: body["sensor"]["last_action"])
    assert "RTL" in told["sensor"]["last_action"]["reason"]
    assert "accepted" in told["sensor"]["last_action"]["outcome"]
    await until(client, vehicle, lambda body: body["sensor"]["on"] is None)


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


class Radio:
    """An aircraft's link on which it is not heard for a while; others still reach it."""

    def __init__(self, link: UdpLink) -> None:
        self._link = link
        self._orders: asyncio.Queue[bytes] = asyncio.Queue()
        self.url = link.url
        self.heard = True

    async def send(self, data: bytes) -> None:
        """Lost while the aircraft is not heard."""
        if self.heard:
            await self._link.send(data)

    async def receive(self) -> bytes:
        """What the service sends, and what somebody else orders."""
        both = [asyncio.create_task(self._link.receive()), asyncio.create_task(self._orders.get())]
        try:
            done, _ = await asyncio.wait(both, return_when=asyncio.FIRST_COMPLETED)
            return b"".join([task.result() for task in done])
        finally:
            for task in both:
                task.cancel()

    async def close(self) -> None:
        """Close it for good."""
        await self._link.close()

    def order_home(self) -> None:
        """A pilot beside the field, or the failsafe of a lost link, has it return."""
        fields = {"target_system": 1, "target_component": 1, "command": int(Command.NAV_RETURN_TO_LAUNCH)}
        self._orders.put_nowait(Codec(250).pack(Message("COMMAND_LONG", fields)))


async def test_a_vehicle_back_after_a_lost_link_with_the_sensor_on(impatient: httpx.AsyncClient) -> None:
    """It was lost in a pass and turned home unheard: heard again, the sensor goes off and is told why."""
    client = impatient
    scenario = small_scenario("ardupilot", "fixed_wing")
    plan_id = await planned(client, scenario)
    lon_deg, lat_deg = scenario["features"][0]["geometry"]["coordinates"][:2]
    settings = SimSettings(home=Place(lat_deg, lon_deg, 0.0), speedup=25.0, turn_radius_m=60.0)
    async with listening() as (link, url):
        radio = Radio(link)
        connecting = asyncio.create_task(connected(client, url))
        while not link.peers:
            await asyncio.sleep(0.005)
        async with flying(radio, settings):
            vehicle = await connecting
            report = (await client.post(vehicle + "/mission", json={"plan_id": plan_id})).json()
            assert report["verified"], report
            await in_flight(client, vehicle)
            await until(client, vehicle, lambda body: body["sensor"]["on"])
            radio.heard = False
            radio.order_home()
            lost = await until(client, vehicle, lambda body: body["link"]["lost"])
            assert lost["sensor"]["on"] is None
            assert lost["link"]["lost_since"] is not None
            assert lost["position_age_s"] > 1.0
            radio.heard = True
            action = await switched_off(client, vehicle)
            assert "RTL" in action["reason"]
            assert "heard again" in action["reason"]
            back = (await client.get(vehicle)).json()
            assert (back["link"]["lost"], back["link"]["lost_since"]) == (False, None)
