"""Strangers on a listening port: told, never heard, never sent to; the vehicle's address alone counts."""

from __future__ import annotations

import asyncio
import socket
import sys
from collections.abc import AsyncIterator
from contextlib import ExitStack, asynccontextmanager
from typing import Self

import pytest
from pymavlink.dialects.v20 import common

from mavlink.errors import DoubtError, NotConnectedError
from mavlink.links.link import open_link
from mavlink.links.udp import UdpLink, open_udp
from mavlink.station.client import VehicleClient
from mavlink.transfer.command import CommandResult
from mavlink.wire.items import Command, MissionType
from tests.mavlink.station.aircraft import HASTY, Aircraft
from tests.mavlink.transfer.vehicle import StubVehicle, waypoints
from tests.patience import PATIENCE_S
from tests.virtual_time import loop_time_s

pytestmark = pytest.mark.virtual_time

LOST_AFTER_S = 0.6


class Stranger:
    """A socket of the test's own, whose frames pymavlink packs."""

    def __init__(self, port: int, system_id: int = 1, host: str = "127.0.0.1") -> None:
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind((host, 0))
        self.socket.setblocking(False)
        self.address = f"{host}:{self.socket.getsockname()[1]}"
        self._to = ("127.0.0.1", port)
        self._mav = common.MAVLink(None, srcSystem=system_id, srcComponent=1)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.socket.close()

    def say(self, message: common.MAVLink_message) -> None:
        """Send one message."""
        self.socket.sendto(message.pack(self._mav), self._to)

    def beat(self) -> None:
        """Say that it is an ArduPlane."""
        self.say(common.MAVLink_heartbeat_message(1, 3, 0x80, 10, 4, 3))

    def acknowledge(self, command: int) -> None:
        """Say that a command was accepted."""
        self.say(common.MAVLink_command_ack_message(command, 0))

    def overheard(self) -> bytes:
        """What came to it."""
        heard = b""
        while True:
            try:
                heard += self.socket.recv(65536)
            except BlockingIOError:
                return heard


@asynccontextmanager
async def listening() -> AsyncIterator[tuple[VehicleClient, Aircraft, int]]:
    """A client on a port that anybody may send to, and its aircraft."""
    ground = await open_udp("127.0.0.1", 0, listen=True)
    air = await open_udp("127.0.0.1", ground.local_port, listen=False)
    client = VehicleClient(ground, settings=HASTY, lost_after_s=LOST_AFTER_S, clock=loop_time_s)
    async with Aircraft(air, StubVehicle()) as aircraft, client:
        await client.connect(5)
        yield client, aircraft, ground.local_port


async def test_a_strangers_acknowledgement_counts_for_nothing() -> None:
    """The vehicle denies an order to arm; forged yeses from another port change nothing, and are told."""
    async with listening() as (client, aircraft, port):
        aircraft.results = {Command.COMPONENT_ARM_DISARM: None}
        with Stranger(port) as stranger:
            arming = asyncio.create_task(client.arm())
            for _ in range(5):
                stranger.acknowledge(Command.COMPONENT_ARM_DISARM)
                await asyncio.sleep(0.01)
            await client.wait_for(lambda state: state.strangers == (stranger.address,), PATIENCE_S)
            await aircraft.say("COMMAND_ACK", command=400, result=CommandResult.DENIED, target_system=255)
            assert (await arming).result == CommandResult.DENIED
            assert stranger.overheard() == b""


async def test_strangers_overhear_nothing_and_displace_nobody() -> None:
    """Forty ports talk all through an upload: it arrives, and none of them was sent a byte."""
    async with listening() as (client, aircraft, port):
        with ExitStack() as stack:
            strangers = [stack.enter_context(Stranger(port, 200 + n % 40)) for n in range(40)]
            transfer = asyncio.create_task(client.upload(waypoints(60), MissionType.MISSION))
            while not transfer.done():
                for stranger in strangers:
                    stranger.beat()
                await asyncio.sleep(0.005)
            assert (await transfer).kind == "accepted"
            assert aircraft.vehicle.held[0] == waypoints(60)
            assert [stranger.overheard() for stranger in strangers] == [b""] * 40
            assert client.state.connected
            assert client.state.doubt is None
            assert 0 < len(client.state.strangers) <= 16


async def test_two_aircraft_with_one_system_id_are_told_and_not_armed() -> None:
    """A second autopilot of the system is a doubt at once; stops go out, others wait for a word."""
    async with listening() as (client, aircraft, port):
        with Stranger(port) as other:
            other.beat()
            state = await client.wait_for(lambda state: state.doubt is not None, PATIENCE_S)
            assert state.doubt is not None
            assert state.doubt.rule == "two-aircraft"
            assert other.address in state.doubt.message
            before = len(aircraft.commands)
            for order in (client.arm, client.start_mission, client.resume):
                with pytest.raises(DoubtError, match="another system id"):
                    await order()
            with pytest.raises(DoubtError):
                await client.upload(waypoints(3), MissionType.MISSION)
            with pytest.raises(DoubtError):
                await client.clear(MissionType.MISSION)
            assert len(aircraft.commands) == before
            assert (await client.return_to_launch()).accepted
            assert state.address is not None
            client.acknowledge(state.address)
            assert client.state.doubt is None
            other.beat()
            assert (await client.arm()).accepted
            assert other.overheard() == b""
            with pytest.raises(NotConnectedError, match="nobody is heard"):
                client.acknowledge("127.0.0.1:9")


async def test_the_other_address_is_acknowledged() -> None:
    """Whoever was heard second is the one that is meant: it is heard from then on, the first no more."""
    async with listening() as (client, aircraft, port):
        with Stranger(port) as other:
            other.beat()
            await client.wait_for(lambda state: state.doubt is not None, PATIENCE_S)
            client.acknowledge(other.address)
            other.say(common.MAVLink_mission_current_message(7, 9))
            await client.wait_for(lambda state: state.mission_current == 7, PATIENCE_S)
            before = len(aircraft.heard)
            arming = asyncio.create_task(client.arm())
            while not other.overheard():
                await asyncio.sleep(0.01)
            other.acknowledge(Command.COMPONENT_ARM_DISARM)
            assert (await arming).accepted
            assert len(aircraft.heard) == before


async def test_a_vehicle_that_restarts_comes_back_from_another_port() -> None:
    """Once its old address is silent the same machine's other port is taken for it, not before."""
    async with listening() as (client, aircraft, port):
        with Stranger(port) as again:
            again.beat()
            await client.wait_for(lambda state: state.doubt is not None, PATIENCE_S)
            assert client.state.address != again.address
            aircraft._tasks[1].cancel()
            while client.state.address != again.address:
                again.beat()
                await asyncio.sleep(0.05)
            await client.wait_for(lambda state: state.connected and state.doubt is None, PATIENCE_S)


@pytest.mark.skipif(sys.platform != "linux", reason="one address of loopback has to do elsewhere")
async def test_from_another_machine_it_comes_back_by_word_alone() -> None:
    """It has fallen silent, and speaks from another host: told, refused, and taken once acknowledged."""
    async with listening() as (client, aircraft, port):
        aircraft._tasks[1].cancel()
        with Stranger(port, host="127.0.0.2") as elsewhere:
            async with asyncio.timeout(PATIENCE_S):
                while client.state.connected or client.state.doubt is None:
                    elsewhere.beat()
                    await asyncio.sleep(0.05)
            assert client.state.doubt.rule == "another-address"
            with pytest.raises(NotConnectedError, match="acknowledge its address"):
                await client.arm()
            assert elsewhere.overheard() == b""
            client.acknowledge(elsewhere.address)
            elsewhere.beat()
            state = await client.wait_for(lambda state: state.connected, PATIENCE_S)
            assert (state.address, state.doubt) == (elsewhere.address, None)


async def test_a_called_peer_is_heard_alone() -> None:
    """On ``udpout`` what others send to its port is nothing, from the first datagram on."""
    with Stranger(9) as called, Stranger(9) as stranger:
        link = await open_link(f"udpout:{called.address}")
        assert isinstance(link, UdpLink)
        own = ("127.0.0.1", link.local_port)
        async with VehicleClient(link, lost_after_s=LOST_AFTER_S, clock=loop_time_s) as client:
            connecting = asyncio.create_task(client.connect(5))
            stranger._to = called._to = own
            stranger.beat()
            while not called.overheard():
                await asyncio.sleep(0.01)
            assert not connecting.done()
            called.beat()
            await connecting
            assert stranger.overheard() == b""
