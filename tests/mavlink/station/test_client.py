"""The client against a stub aircraft: connection, readers of its state, loss and the end."""

from __future__ import annotations

import asyncio

import pytest

from mavlink.errors import (
    NotConnectedError,
    VehicleNotFoundError,
)
from mavlink.links.link import memory_pair
from mavlink.links.udp import open_udp
from mavlink.state.telemetry import VehicleState
from mavlink.station.client import VehicleClient
from mavlink.transfer.outcome import Accepted, Unknown
from mavlink.wire.codec import Codec
from mavlink.wire.items import Command, MissionType
from mavlink.wire.messages import Message
from tests.mavlink.station.aircraft import HASTY, Aircraft, flying
from tests.mavlink.transfer.vehicle import StubVehicle, waypoints
from tests.patience import PATIENCE_S
from tests.virtual_time import loop_time_s

pytestmark = pytest.mark.virtual_time

MISSION = MissionType.MISSION


async def test_connecting_takes_the_autopilots_heartbeat() -> None:
    """Ground stations and cameras beat too; the state is the autopilot's."""
    ground, air = memory_pair()
    for sender, fields in [
        (Codec(254, 190), {"type": 6, "autopilot": 8}),
        (Codec(1, 100), {"type": 30, "autopilot": 8}),
        (Codec(5, 1), {"type": 1, "autopilot": 12, "custom_mode": 4 << 16 | 4 << 24}),
    ]:
        await air.send(sender.pack(Message("HEARTBEAT", fields)))
    async with VehicleClient(ground, clock=loop_time_s) as client:
        state = await client.connect(5)
        assert (state.system_id, state.autopilot, state.type, state.mode) == (
            5,
            "px4",
            "fixed_wing",
            "AUTO.MISSION",
        )
    await air.close()


async def test_no_vehicle_is_said() -> None:
    """Without a heartbeat in time VehicleNotFoundError; a later one still connects."""
    ground, air = memory_pair()
    async with VehicleClient(ground, settings=HASTY, clock=loop_time_s) as client:
        with pytest.raises(VehicleNotFoundError, match=r"0\.05 s"):
            await client.connect(0.05)
        with pytest.raises(NotConnectedError):
            await client.download(MISSION)
        async with Aircraft(air, StubVehicle()):
            assert (await client.connect(5)).connected


async def test_our_heartbeats_and_wishes_go_out() -> None:
    """The vehicle hears a heartbeat, and is asked for positions and relays four times a second."""
    async with flying() as (client, aircraft):
        await client.command(Command.SET_MESSAGE_INTERVAL, (33.0, -1.0))
        beats = [message for message in aircraft.heard if message.name == "HEARTBEAT"]
        assert {(beat.system_id, beat.integer("type"), beat.integer("autopilot")) for beat in beats} == {
            (255, 6, 8)
        }
        wishes = {params[0]: params[1] for number, params in aircraft.commands[:-1] if number == 511}
        assert wishes[33.0] == wishes[30.0] == wishes[376.0] == 250_000.0


async def test_over_udp() -> None:
    """The same over sockets on loopback."""
    ground = await open_udp("127.0.0.1", 0, listen=True)
    air = await open_udp("127.0.0.1", ground.local_port, listen=False)
    async with (
        Aircraft(air, StubVehicle()) as aircraft,
        VehicleClient(ground, clock=loop_time_s) as client,
    ):
        await client.connect(5)
        assert await client.upload(waypoints(100), MISSION) == Accepted()
        assert aircraft.vehicle.held[0] == waypoints(100)
        assert await client.download(MISSION) == waypoints(100)


async def test_states_reach_every_reader_until_the_end() -> None:
    """Two readers see the change; both end when the client closes."""
    async with flying() as (client, aircraft):
        seen: list[list[VehicleState]] = [[], []]

        async def read(states: list[VehicleState]) -> None:
            async for state in client.states():
                states.append(state)

        readers = [asyncio.create_task(read(states)) for states in seen]
        await aircraft.say("MISSION_CURRENT", seq=3)
        await client.wait_for(lambda state: state.mission_current == 3, PATIENCE_S)
        await client.close()
        await asyncio.wait_for(asyncio.gather(*readers), PATIENCE_S)
        for states in seen:
            assert any(state.mission_current == 3 for state in states)
            assert not states[-1].connected


async def test_a_recording_holds_what_was_sent_meanwhile() -> None:
    """Positions before and after the recording are not in it."""
    async with flying() as (client, aircraft):
        await aircraft.say("GLOBAL_POSITION_INT", time_boot_ms=1000, lat=10)
        await client.wait_for(lambda state: state.time_s == 1.0, PATIENCE_S)
        recorder = client.start_recording()
        await aircraft.say("GLOBAL_POSITION_INT", time_boot_ms=2000, lat=20)
        await client.wait_for(lambda state: state.time_s == 2.0, PATIENCE_S)
        client.stop_recording(recorder)
        await aircraft.say("GLOBAL_POSITION_INT", time_boot_ms=3000, lat=30)
        await client.wait_for(lambda state: state.time_s == 3.0, PATIENCE_S)
        assert [point.time_s for point in recorder.track().points] == [2.0]


async def test_words_to_another_ground_station_are_not_ours() -> None:
    """An acknowledgement addressed to system 254 ends nothing here."""
    async with flying() as (client, aircraft):
        aircraft.results = {Command.COMPONENT_ARM_DISARM: None}
        arming = asyncio.create_task(client.arm())
        await asyncio.sleep(0.02)
        await aircraft.say("COMMAND_ACK", command=400, result=4, target_system=254)
        await aircraft.say("COMMAND_ACK", command=400, result=0, target_system=255)
        assert (await arming).accepted


async def test_closing_leaves_no_task_and_no_waiter() -> None:
    """A transfer under way ends as link-lost, everything later is refused, closing twice is harmless."""
    async with flying() as (client, aircraft):
        aircraft.vanish()
        transfer = asyncio.create_task(client.upload(waypoints(3), MISSION))
        await asyncio.sleep(0.01)
        await client.close()
        assert await asyncio.wait_for(transfer, PATIENCE_S) == Unknown("link-lost")
        assert not [task for task in asyncio.all_tasks() if task.get_name().startswith("mavlink ")]
        with pytest.raises(NotConnectedError, match="closed"):
            await client.arm()
        with pytest.raises(NotConnectedError, match="closed"):
            await client.connect(1)
        await client.close()


async def test_a_link_that_fails_ends_the_client() -> None:
    """When the link itself ends, the state says so and calls name the reason."""
    ground, air = memory_pair()
    async with (
        Aircraft(air, StubVehicle()),
        VehicleClient(ground, clock=loop_time_s) as client,
    ):
        await client.connect(5)
        await ground.close()
        await client.wait_for(lambda state: not state.connected, PATIENCE_S)
        with pytest.raises(NotConnectedError, match="link closed"):
            await client.arm()


async def test_a_process_that_stood_still_has_not_lost_its_vehicle() -> None:
    """A clock that jumps while the event loop was held up does not count as the vehicle's silence."""
    jump_s = 0.0
    ground, air = memory_pair()
    loop = asyncio.get_running_loop()
    aircraft = Aircraft(air, StubVehicle())

    def beats() -> int:
        return sum(message.name == "HEARTBEAT" for message in aircraft.heard)

    async with aircraft, VehicleClient(ground, clock=lambda: loop.time() + jump_s) as client:
        await client.connect(5)
        # Answered after everything the client asked for on its own: nothing is on its way any more.
        await client.command(Command.SET_MESSAGE_INTERVAL, (33.0, -1.0))
        aircraft.vanish()
        jump_s = 60.0
        # Our second heartbeat shows that the client has looked at its clock.
        while beats() == 1:
            await asyncio.sleep(0.01)
        assert client.state.connected
