"""Another aircraft answers where the vehicle was: it is named, and not talked to until acknowledged."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator

import pytest

from mavlink.errors import NotConnectedError
from mavlink.links.link import MemoryLink, memory_pair
from mavlink.station.client import VehicleClient
from mavlink.wire.codec import Codec
from mavlink.wire.items import Command, MissionType
from mavlink.wire.messages import Message
from tests.mavlink.station.aircraft import HASTY, LOST_AFTER_S, Aircraft
from tests.mavlink.transfer.vehicle import StubVehicle, waypoints
from tests.patience import PATIENCE_S
from tests.virtual_time import loop_time_s

pytestmark = pytest.mark.virtual_time

MISSION = MissionType.MISSION


class Seat:
    """Where an aircraft stands on a link: one sits down when the one before has left."""

    def __init__(self, link: MemoryLink) -> None:
        self.link = link
        self.sitting: Aircraft | None = None
        self._leave = contextlib.AsyncExitStack()

    async def sit(self, system_id: int) -> Aircraft:
        """Another aircraft in the place of the one that stood there; the link stays open."""
        await self.leave()
        self.sitting = Aircraft(_Kept(self.link), StubVehicle(), system_id=system_id)
        await self._leave.enter_async_context(self.sitting)
        return self.sitting

    async def leave(self) -> None:
        """Nobody answers any more."""
        await self._leave.aclose()


class _Kept:
    """A link that outlives its user."""

    def __init__(self, link: MemoryLink) -> None:
        self.url = link.url
        self.send = link.send
        self.receive = link.receive

    async def close(self) -> None:
        """Leave it open."""


@pytest.fixture
async def seated() -> AsyncIterator[tuple[VehicleClient, Seat]]:
    """A client of system 1, which holds three waypoints."""
    ground, air = memory_pair()
    seat = Seat(air)
    async with VehicleClient(ground, settings=HASTY, lost_after_s=LOST_AFTER_S, clock=loop_time_s) as client:
        await seat.sit(1)
        await client.connect(5)
        assert (await client.upload(waypoints(3), MISSION)).kind == "accepted"
        yield client, seat
        await seat.leave()
    await air.close()


async def test_another_system_is_named_and_gets_no_word(seated: tuple[VehicleClient, Seat]) -> None:
    """Not connected, orders and transfers refused with both ids, and nothing at all is sent to it."""
    client, seat = seated
    other = await seat.sit(2)
    state = await client.wait_for(lambda state: state.other_system == 2, PATIENCE_S)
    assert (state.connected, state.system_id) == (False, 1)
    for asked in (client.arm(), client.start_mission(), client.download(MISSION), client.clear(MISSION)):
        with pytest.raises(NotConnectedError, match="system 2 answers where system 1 did"):
            await asked
    with pytest.raises(NotConnectedError, match="acknowledged"):
        await client.upload(waypoints(3), MISSION)
    # What was still on its way to the first is not addressed to it.
    assert [message for message in other.heard if message.fields.get("target_system") == 2] == []


async def test_once_acknowledged_it_is_a_vehicle_of_its_own(seated: tuple[VehicleClient, Seat]) -> None:
    """Nothing of the one before is taken for its own; then it is talked to as any other."""
    client, seat = seated
    assert seat.sitting is not None
    await seat.sitting.say("GLOBAL_POSITION_INT", lat=10, lon=20, time_boot_ms=1000)
    await seat.sitting.say("STATUSTEXT", severity=6, text="of the first")
    await client.wait_for(lambda state: len(state.texts) == 1 and state.lat_deg is not None, PATIENCE_S)
    other = await seat.sit(2)
    await client.wait_for(lambda state: state.other_system == 2, PATIENCE_S)
    for wrong in (0, 1, 3):
        with pytest.raises(NotConnectedError, match=f"system {wrong} is heard"):
            client.adopt(wrong)
    client.adopt(2)
    state = await client.wait_for(lambda state: state.connected, PATIENCE_S)
    assert (state.system_id, state.other_system, state.lat_deg, state.texts) == (2, None, None, ())
    assert (await client.arm()).accepted
    assert Command.COMPONENT_ARM_DISARM in [number for number, _ in other.commands]
    assert await client.download(MISSION) == ()
    with pytest.raises(NotConnectedError, match="system 2 is heard"):
        client.adopt(2)


async def test_the_vehicle_itself_comes_back_without_a_word(seated: tuple[VehicleClient, Seat]) -> None:
    """The other one goes, the first returns: connected as before, and the other is forgotten."""
    client, seat = seated
    await seat.sit(2)
    await client.wait_for(lambda state: state.other_system == 2, PATIENCE_S)
    await seat.leave()
    await client.wait_for(lambda state: state.other_system is None, PATIENCE_S)
    assert not client.state.connected
    await seat.sit(1)
    state = await client.wait_for(lambda state: state.connected, PATIENCE_S)
    assert (state.system_id, state.other_system) == (1, None)
    assert (await client.arm()).accepted


async def test_others_beside_a_vehicle_that_is_there_mean_nothing() -> None:
    """A second autopilot, a camera and a ground station on the link change nothing."""
    ground, air = memory_pair()
    async with (
        Aircraft(air, StubVehicle()) as aircraft,
        VehicleClient(ground, settings=HASTY, clock=loop_time_s) as client,
    ):
        await client.connect(5)
        for sender, fields in [
            (Codec(2, 1), {"type": 1, "autopilot": 3}),
            (Codec(254, 190), {"type": 6, "autopilot": 8}),
        ]:
            await air.send(sender.pack(Message("HEARTBEAT", fields)))
        await aircraft.say("MISSION_CURRENT", seq=7)
        state = await client.wait_for(lambda state: state.mission_current == 7, PATIENCE_S)
        assert (state.system_id, state.connected, state.other_system) == (1, True, None)


async def test_a_client_that_knows_its_vehicle_takes_no_other() -> None:
    """A link opened anew for system 1, as after a failure, does not take the first that answers."""
    ground, air = memory_pair()
    client = VehicleClient(ground, settings=HASTY, vehicle_system=1, clock=loop_time_s)
    async with Aircraft(air, StubVehicle(), system_id=2), client:
        connecting = asyncio.create_task(client.connect(20))
        await client.wait_for(lambda state: state.other_system == 2, PATIENCE_S)
        with pytest.raises(NotConnectedError, match="system 2 answers where system 1 did"):
            await client.arm()
        client.adopt(2)
        assert (await connecting).system_id == 2
