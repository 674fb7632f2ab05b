"""Flight commands do what they say on every kind of aircraft, or say that they did not."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from typing import Any

import httpx
import pytest

from app.main import create_app
from app.services.vehicles.vehicle import Vehicle
from app.settings import Settings
from mavlink.sim.settings import SimSettings
from mavlink.wire.items import Command
from tests.app.conftest import fake_house, serving
from tests.app.small_flight import CRAFT, in_flight, order, ready
from tests.app.test_problems import check_problem
from tests.app.test_vehicles import connected, faulty_vehicle, until

MISSION = {"ardupilot": "AUTO", "px4": "AUTO.MISSION"}


class Ground:
    """A service, and what stands behind it."""

    def __init__(self, client: httpx.AsyncClient, app: Any) -> None:
        self.client = client
        self._app = app

    @property
    def vehicle(self) -> Vehicle:
        """The only vehicle."""
        (vehicle,) = self._app.state.house.fleet.all()
        assert isinstance(vehicle, Vehicle)
        return vehicle


@pytest.fixture
async def ground(settings: Settings) -> AsyncIterator[Ground]:
    """A service with a stand-in for the planner's pool."""
    app = create_app(settings, fake_house)
    async with serving(app) as client:
        yield Ground(client, app)


@pytest.mark.parametrize(("autopilot", "kind"), CRAFT)
async def test_start_and_arm_say_what_they_do(ground: Ground, autopilot: str, kind: str) -> None:
    """Disarmed: start refused. In the mission's mode: arm refused, or held first. By start it takes off."""
    client = ground.client
    vehicle, _ = await ready(client, autopilot, kind, 20.0)
    refused = await order(client, vehicle, "start")
    check_problem(refused, 409, "not-armed")
    assert (refused.json()["outcome"], refused.json()["command"]) == ("refused", "start")
    assert "arm_first" in refused.json()["errors"][0]["fix"]
    check_problem(await order(client, vehicle, "resume"), 409, "not-armed")
    # Another station has put it into the mode in which it would fly.
    assert (await ground.vehicle.client.set_mode(MISSION[autopilot])).accepted
    check_problem(await order(client, vehicle, "arm"), 409, "mode-would-take-off")
    assert not ground.vehicle.state.armed
    armed = await order(client, vehicle, "arm", hold_first=True)
    assert (armed.status_code, armed.json()["outcome"]) == (200, "done"), armed.text
    told = (await client.get(vehicle)).json()
    assert told["state"]["armed"]
    assert told["state"]["mode"] not in MISSION.values()
    # Simulated time goes on, twenty times as fast; it stays where it is.
    began_s = told["state"]["time_s"]
    later = await until(client, vehicle, lambda body: body["state"]["time_s"] > began_s + 10.0)
    assert later["state"]["landed"]
    assert later["command"]["command_id"] == armed.json()["command_id"]
    started = await order(client, vehicle, "start")
    assert (started.status_code, started.json()["outcome"]) == (200, "done"), started.text
    flying = await until(client, vehicle, lambda body: body["state"]["landed"] is False)
    assert flying["state"]["mode"] == MISSION[autopilot]
    listed = (await client.get(vehicle + "/commands")).json()["commands"]
    assert [(each["command"], each["outcome"]) for each in listed] == [
        ("start", "done"),
        ("arm", "done"),
        ("arm", "refused"),
        ("resume", "refused"),
        ("start", "refused"),
    ]
    one = await client.get(f"{vehicle}/commands/{listed[0]['command_id']}")
    assert one.json() == listed[0]
    check_problem(await client.get(f"{vehicle}/commands/none"), 404)


@pytest.mark.parametrize(("autopilot", "kind"), CRAFT)
async def test_hold_and_land(ground: Ground, autopilot: str, kind: str) -> None:
    """In flight it waits where it is; then it comes down: on the spot, or by the landing of its mission."""
    client = ground.client
    vehicle, report = await ready(client, autopilot, kind, 30.0)
    check_problem(await order(client, vehicle, "land"), 409, "not-flying")
    await in_flight(client, vehicle)
    held = await order(client, vehicle, "hold")
    assert held.json()["outcome"] == "done", held.text
    waiting = {"ardupilot": "BRAKE" if kind == "multirotor" else "LOITER", "px4": "AUTO.LOITER"}[autopilot]
    assert (await client.get(vehicle)).json()["state"]["mode"] == waiting
    # In the air both go on with the mission at its item: none begins it anew.
    items = report["parts"]["mission"]["held"]
    seq = max(each["seq"] for each in items[:-4] if each["command"] == Command.NAV_WAYPOINT)
    for again, words in (("start", "goes on"), ("resume", "")):
        assert (await order(client, vehicle, "goto_item", seq=seq)).json()["outcome"] == "done"
        went_on = await order(client, vehicle, again)
        assert went_on.json()["outcome"] == "done", went_on.text
        assert words in went_on.json()["reason"]
        state = (await client.get(vehicle)).json()["state"]
        assert (state["mode"], state["mission_current"] >= seq) == (MISSION[autopilot], True), state
        assert (await order(client, vehicle, "hold")).json()["outcome"] == "done"
    assert (await client.get(vehicle)).json()["mission_lands"] is True
    landing = await order(client, vehicle, "land")
    assert landing.json()["outcome"] == "done", landing.text
    state = (await client.get(vehicle)).json()["state"]
    if kind == "multirotor":
        await until(client, vehicle, lambda body: not body["state"]["armed"])
        return
    assert state["mode"] == MISSION[autopilot]
    assert items[-1]["command"] == Command.NAV_LAND
    assert state["mission_current"] >= len(items) - 4
    last = max(each["seq"] for each in items if each["command"] in (181, 187) and each["seq"] < len(items))
    assert state["mission_current"] > last


async def test_a_fixed_wing_without_a_landing_is_told_so(ground: Ground) -> None:
    """Its mission ends in a return: land is refused with what can be done instead, and it flies on."""
    client = ground.client
    vehicle, _ = await ready(client, "ardupilot", "fixed_wing", 20.0, returns=True)
    await in_flight(client, vehicle)
    check_problem(await order(client, vehicle, "land"), 409, "no-landing")
    told = (await client.get(vehicle)).json()
    assert (told["state"]["mode"], told["mission_lands"]) == ("AUTO", False)


async def test_a_newer_command_overtakes_an_unsettled_one(impatient: httpx.AsyncClient) -> None:
    """Pending is told as pending; the one overtaken as overtaken, with what overtook it."""
    async with faulty_vehicle(impatient, SimSettings(faults=("no_command_ack",))) as vehicle:
        held = await order(impatient, vehicle, "pause", wait_s=0.0)
        assert (held.status_code, held.json()["outcome"]) == (200, "pending"), held.text
        waiting = asyncio.create_task(order(impatient, vehicle, "hold"))
        await until(impatient, vehicle, lambda body: body["command"]["command"] == "hold")
        back = asyncio.create_task(order(impatient, vehicle, "rtl"))
        overtaken = await waiting
        check_problem(overtaken, 409)
        assert overtaken.json()["type"].endswith(":command-overtaken")
        assert overtaken.json()["outcome"] == "overtaken"
        assert "rtl" in overtaken.json()["reason"]
        first = await impatient.get(f"{vehicle}/commands/{held.json()['command_id']}")
        assert first.json()["outcome"] == "overtaken"
        # Never answered, yet the mode shows it.
        assert (await back).json()["outcome"] == "done"


async def test_what_nobody_can_tell_is_a_504(impatient: httpx.AsyncClient) -> None:
    """Its mission cannot be read, and it says nothing to an item that is not there."""
    vehicle = await connected(impatient, "sim:?fault=no_response_to_list")
    answer = await order(impatient, vehicle, "goto_item", seq=60_000)
    check_problem(answer, 504)
    assert answer.json()["outcome"] == "unknown"


@pytest.mark.parametrize(
    "wish",
    [{"command": "arm", "arm_first": True}, {"command": "rtl", "hold_first": True}],
)
async def test_options_that_say_nothing_are_refused(client: httpx.AsyncClient, wish: dict[str, Any]) -> None:
    """An option that its command does not know is not passed over in silence."""
    vehicle = await connected(client)
    check_problem(await client.post(vehicle + "/commands", json=wish), 422, "option")
    bad = {"command": "sensor_off", "payload": "lamp:3"}
    check_problem(await client.post(vehicle + "/commands", json=bad), 422, "payload")
