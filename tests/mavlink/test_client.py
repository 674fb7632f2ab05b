"""The client against a stub aircraft: connection, transfers, verification, commands, loss and return."""

from __future__ import annotations

import asyncio
from collections.abc import Sequence
from dataclasses import replace

import pytest

from mavlink.client import VehicleClient
from mavlink.codec import Codec
from mavlink.compare import Difference
from mavlink.errors import (
    BusyError,
    CodecError,
    NotConnectedError,
    TransferFailedError,
    VehicleNotFoundError,
)
from mavlink.items import Command, MissionItem, MissionResult, MissionType
from mavlink.link import LinkFaults, memory_pair
from mavlink.links.udp import open_udp
from mavlink.messages import Message
from mavlink.telemetry import VehicleState
from mavlink.transfer.machine import Progress
from mavlink.transfer.outcome import Accepted, Refused, Unknown
from tests.mavlink.aircraft import HASTY, LOST_AFTER_S, Aircraft, flying
from tests.mavlink.transfer.vehicle import StubVehicle, waypoints

MISSION, FENCE = MissionType.MISSION, MissionType.FENCE


def compare(meant: tuple[MissionItem, ...], held: tuple[MissionItem, ...]) -> Sequence[Difference]:
    """Item by item, nothing forgiven."""
    if len(meant) != len(held):
        return [Difference(None, "count", len(meant), len(held))]
    pairs = zip(meant, held, strict=True)
    return [Difference(want.seq, "item", None, None) for want, got in pairs if want != got]


async def test_connecting_takes_the_autopilots_heartbeat() -> None:
    """Ground stations and cameras beat too; the state is the autopilot's."""
    ground, air = memory_pair()
    for sender, fields in [
        (Codec(254, 190), {"type": 6, "autopilot": 8}),
        (Codec(1, 100), {"type": 30, "autopilot": 8}),
        (Codec(5, 1), {"type": 1, "autopilot": 12, "custom_mode": 4 << 16 | 4 << 24}),
    ]:
        await air.send(sender.pack(Message("HEARTBEAT", fields)))
    async with VehicleClient(ground) as client:
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
    async with VehicleClient(ground, settings=HASTY) as client:
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


@pytest.mark.parametrize("manner", ["ardupilot", "px4"])
@pytest.mark.parametrize("mission_type", MissionType)
async def test_up_down_and_clear(manner: str, mission_type: MissionType) -> None:
    """What is uploaded comes back; cleared it is empty; progress rises to the end."""
    items = waypoints(30, mission_type)
    seen: list[Progress] = []
    async with flying(manner) as (client, aircraft):
        assert await client.upload(items, mission_type, seen.append) == Accepted()
        assert aircraft.vehicle.held[mission_type] == items
        assert await client.download(mission_type) == items
        assert await client.clear(mission_type) == Accepted()
        assert await client.download(mission_type) == ()
    assert [progress.done for progress in seen] == list(range(31))


async def test_over_udp() -> None:
    """The same over sockets on loopback."""
    ground = await open_udp("127.0.0.1", 0, listen=True)
    air = await open_udp("127.0.0.1", ground.local_port, listen=False)
    async with Aircraft(air, StubVehicle()) as aircraft, VehicleClient(ground) as client:
        await client.connect(5)
        assert await client.upload(waypoints(100), MISSION) == Accepted()
        assert aircraft.vehicle.held[0] == waypoints(100)
        assert await client.download(MISSION) == waypoints(100)


async def test_over_a_bad_link() -> None:
    """A tenth lost, some doubled, some overtaken: it is stored in the end, and not said to be before."""
    faults = LinkFaults(loss=0.1, duplication=0.05, reordering=0.05, delay_s=0.002)
    patient = replace(HASTY, silence_s=5.0, acknowledgement_s=1.0)
    async with flying("px4", faults=faults, seed=3, settings=patient) as (client, aircraft):
        for _ in range(5):
            result = await client.upload_verified(waypoints(20), MISSION, compare)
            stored = aircraft.vehicle.held[0] == waypoints(20)
            assert stored or result.status != "stored"
            if result.status == "stored":
                break
        assert result.held == waypoints(20) == aircraft.vehicle.held[0]


async def test_one_transfer_at_a_time() -> None:
    """A second one is refused by name, and the first goes on."""
    async with flying() as (client, aircraft):
        first = asyncio.create_task(client.upload(waypoints(5), MISSION))
        await asyncio.sleep(0)
        with pytest.raises(BusyError):
            await client.download(MISSION)
        assert await first == Accepted()
        assert aircraft.vehicle.held[0] == waypoints(5)


async def test_a_cancelled_upload_tells_the_vehicle() -> None:
    """Cancelling the caller's task sends OPERATION_CANCELLED and frees the way for the next transfer."""
    async with flying() as (client, aircraft):
        task = asyncio.create_task(client.upload(waypoints(500), MISSION, lambda _: task.cancel()))
        with pytest.raises(asyncio.CancelledError):
            await task
        assert await client.upload(waypoints(3), MISSION) == Accepted()
        words = [message.fields["type"] for message in aircraft.heard if message.name == "MISSION_ACK"]
        assert words == [MissionResult.OPERATION_CANCELLED]


async def test_a_download_that_fails_says_how(monkeypatch: pytest.MonkeyPatch) -> None:
    """There is no partial answer: TransferFailedError carries the outcome."""
    async with flying() as (client, aircraft):
        await client.upload(waypoints(3), MISSION)
        real = aircraft.vehicle.receive

        def deaf(message: Message, now_s: float) -> list[Message]:
            return [] if message.name == "MISSION_REQUEST_INT" else real(message, now_s)

        monkeypatch.setattr(aircraft.vehicle, "receive", deaf)
        with pytest.raises(TransferFailedError, match="timeout") as caught:
            await client.download(MISSION)
        assert caught.value.outcome == Unknown("timeout", 0)


async def test_unsendable_items_are_refused_and_the_client_lives() -> None:
    """A number that does not fit its field is named, and the next upload works."""
    async with flying() as (client, _):
        with pytest.raises(CodecError, match="MISSION_ITEM_INT"):
            await client.upload((MissionItem(0, 3, 16, x=2**40),), MISSION)
        assert await client.upload(waypoints(2), MISSION) == Accepted()


async def test_a_lost_final_word_is_resolved_by_reading_back() -> None:
    """Unknown becomes accepted, because the vehicle holds what was meant; how it was found out is told."""
    async with flying() as (client, aircraft):
        aircraft.vehicle.lose_final = True
        result = await client.upload_verified(waypoints(4), MISSION, compare)
        assert (result.status, result.outcome, result.held) == ("stored", Accepted(), waypoints(4))
        assert result.resolved_from == Unknown("lost-acknowledgement", 3)
        assert not client.pending


@pytest.mark.parametrize("result", [r for r in MissionResult if r not in (0, 1, 13)])
async def test_a_refused_upload_says_what_the_vehicle_now_holds(result: MissionResult) -> None:
    """ArduPilot keeps the items before the refused one: the read-back shows the mixture."""
    async with flying() as (client, aircraft):
        await client.upload(waypoints(4), MISSION)
        aircraft.vehicle.refuse_item = {2: result}
        moved = tuple(replace(item, z=7.0) for item in waypoints(4))
        upload = await client.upload_verified(moved, MISSION, compare)
        assert (upload.status, upload.outcome) == ("refused", Refused(result, 2))
        assert upload.held == (*moved[:2], *waypoints(4)[2:])
        assert [difference.seq for difference in upload.differences] == [2, 3]


async def test_an_error_at_the_end_is_a_refusal_once_the_read_back_differs() -> None:
    """ERROR after the last item is ambiguous until it is seen that the list is not there."""
    async with flying("px4") as (client, aircraft):
        aircraft.vehicle.refuse_item = {3: MissionResult.ERROR}
        upload = await client.upload_verified(waypoints(4), MISSION, compare)
        assert (upload.status, upload.outcome, upload.held) == ("refused", Refused(MissionResult.ERROR), ())


async def test_a_fence_is_cleared_before_it_is_uploaded() -> None:
    """Circles over a stored polygon leave ArduPilot without any fence, though it accepts them."""
    async with flying() as (client, aircraft):
        result = await client.upload_verified(waypoints(3, FENCE), FENCE, compare)
        assert result.status == "stored"
        words = [
            message.name
            for message in aircraft.heard
            if message.name in ("MISSION_CLEAR_ALL", "MISSION_COUNT")
        ]
        assert words == ["MISSION_CLEAR_ALL", "MISSION_COUNT"]


async def test_a_vehicle_that_alters_is_found_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """Accepted, yet different: the differences are listed."""
    async with flying() as (client, aircraft):
        real = aircraft.vehicle._commit

        def flatten(items: Sequence[MissionItem], kind: int) -> list[Message]:
            return real([replace(item, z=0.0) for item in items], kind)

        monkeypatch.setattr(aircraft.vehicle, "_commit", flatten)
        result = await client.upload_verified(waypoints(2), MISSION, compare)
        assert (result.outcome, result.status) == (Accepted(), "different")
        assert [difference.seq for difference in result.differences] == [0, 1]


@pytest.mark.parametrize(("vanish_at", "status"), [(9, "stored"), (4, "different")])
async def test_a_vehicle_that_vanishes_is_resolved_when_it_returns(vanish_at: int, status: str) -> None:
    """Lost in mid-upload the outcome is unknown with its reason; after the return the read-back decides."""
    async with flying(lost_after_s=LOST_AFTER_S) as (client, aircraft):
        aircraft.vanish_at_item = vanish_at
        result = await client.upload_verified(waypoints(10), MISSION, compare)
        assert (result.status, result.held) == ("unknown", None)
        assert isinstance(result.outcome, Unknown)
        await client.wait_for(lambda state: not state.connected, 5)
        assert client.pending
        with pytest.raises(NotConnectedError):
            await client.resolve_pending()
        aircraft.come_back()
        await client.wait_for(lambda state: state.connected, 5)
        resolved = await client.resolve_pending()
        assert resolved is not None
        assert resolved.status == status
        assert resolved.held == aircraft.vehicle.held[0] == waypoints(10)[: vanish_at + 1]
        assert not client.pending
        assert await client.resolve_pending() is None


async def test_losing_the_vehicle_ends_what_is_under_way() -> None:
    """A transfer ends as link-lost, a command without an answer, and both are refused until it returns."""
    async with flying(lost_after_s=LOST_AFTER_S) as (client, aircraft):
        aircraft.vanish()
        transfer = asyncio.create_task(client.upload(waypoints(3), MISSION))
        command = asyncio.create_task(client.command(Command.MISSION_START))
        assert await asyncio.wait_for(transfer, 5) == Unknown("link-lost")
        assert (await asyncio.wait_for(command, 5)).result is None
        with pytest.raises(NotConnectedError, match="no vehicle"):
            await client.clear(MISSION)


async def test_commands_are_answered_and_take_turns() -> None:
    """Accepted, refused and unanswered commands; two of one number do not take each other's answer."""
    async with flying() as (client, aircraft):
        aircraft.results = {Command.MISSION_START: 2, Command.DO_SET_RELAY: None}
        outcomes = await asyncio.gather(
            client.arm(), client.disarm(), client.command(300), client.command(181)
        )
        assert [outcome.result for outcome in outcomes] == [0, 0, 2, None]
        assert [params[0] for number, params in aircraft.commands if number == 400] == [1.0, 0.0]
        assert "MISSION_START: denied" in str(outcomes[2])


async def test_a_cancelled_command_makes_room_for_the_next() -> None:
    """Giving up on an unanswered command does not block others of its number."""
    async with flying() as (client, aircraft):
        aircraft.results = {Command.COMPONENT_ARM_DISARM: None}
        first = asyncio.create_task(client.arm())
        await asyncio.sleep(0.02)
        first.cancel()
        with pytest.raises(asyncio.CancelledError):
            await first
        aircraft.results = {}
        assert (await client.disarm()).accepted


COPTER, PLANE = 2, 1
FLIGHT = [
    ("ardupilot", PLANE, "start_mission", [(176, (1.0, 10.0, 0.0)), (300, (0.0, 0.0, 0.0))]),
    ("ardupilot", PLANE, "pause", [(176, (1.0, 12.0, 0.0))]),
    ("ardupilot", PLANE, "resume", [(176, (1.0, 10.0, 0.0))]),
    ("ardupilot", COPTER, "pause", [(193, (0.0, 0.0, 0.0))]),
    ("ardupilot", COPTER, "resume", [(193, (1.0, 0.0, 0.0))]),
    ("ardupilot", COPTER, "start_mission", [(176, (1.0, 3.0, 0.0)), (300, (0.0, 0.0, 0.0))]),
    ("px4", PLANE, "start_mission", [(300, (0.0, 0.0, 0.0))]),
    ("px4", PLANE, "pause", [(176, (1.0, 4.0, 3.0))]),
    ("px4", PLANE, "resume", [(176, (1.0, 4.0, 4.0))]),
    ("generic", PLANE, "pause", [(193, (0.0, 0.0, 0.0))]),
    ("px4", PLANE, "return_to_launch", [(20, (0.0, 0.0, 0.0))]),
]


@pytest.mark.parametrize(("manner", "kind", "helper", "expected"), FLIGHT)
async def test_flight_commands_speak_each_autopilots_language(
    manner: str, kind: int, helper: str, expected: list[tuple[int, tuple[float, ...]]]
) -> None:
    """Each helper sends what that autopilot understands, and nothing else."""
    async with flying(manner, kind) as (client, aircraft):
        assert (await getattr(client, helper)()).accepted
        sent = [(number, params[:3]) for number, params in aircraft.commands if number != 511]
        assert sent == expected


async def test_a_refused_mode_stops_the_start() -> None:
    """An ArduPilot that does not go to AUTO is not told to start."""
    async with flying() as (client, aircraft):
        aircraft.results = {Command.DO_SET_MODE: 4}
        assert (await client.start_mission()).result == 4
        assert 300 not in [number for number, _ in aircraft.commands]


async def test_an_item_becomes_the_current_one() -> None:
    """goto_item waits for the vehicle's MISSION_CURRENT, and the state shows it."""
    async with flying() as (client, _):
        assert await client.goto_item(7) == Accepted()
        assert client.state.mission_current == 7


async def test_states_reach_every_reader_until_the_end() -> None:
    """Two readers see the change; both end when the client closes."""
    async with flying() as (client, aircraft):
        seen: list[list[VehicleState]] = [[], []]

        async def read(states: list[VehicleState]) -> None:
            async for state in client.states():
                states.append(state)

        readers = [asyncio.create_task(read(states)) for states in seen]
        await aircraft.say("MISSION_CURRENT", seq=3)
        await client.wait_for(lambda state: state.mission_current == 3, 5)
        await client.close()
        await asyncio.wait_for(asyncio.gather(*readers), 5)
        for states in seen:
            assert any(state.mission_current == 3 for state in states)
            assert not states[-1].connected


async def test_a_recording_holds_what_was_sent_meanwhile() -> None:
    """Positions before and after the recording are not in it."""
    async with flying() as (client, aircraft):
        await aircraft.say("GLOBAL_POSITION_INT", time_boot_ms=1000, lat=10)
        await client.wait_for(lambda state: state.time_s == 1.0, 5)
        recorder = client.start_recording()
        await aircraft.say("GLOBAL_POSITION_INT", time_boot_ms=2000, lat=20)
        await client.wait_for(lambda state: state.time_s == 2.0, 5)
        client.stop_recording(recorder)
        await aircraft.say("GLOBAL_POSITION_INT", time_boot_ms=3000, lat=30)
        await client.wait_for(lambda state: state.time_s == 3.0, 5)
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
        assert await asyncio.wait_for(transfer, 5) == Unknown("link-lost")
        assert not [task for task in asyncio.all_tasks() if task.get_name().startswith("mavlink ")]
        with pytest.raises(NotConnectedError, match="closed"):
            await client.arm()
        with pytest.raises(NotConnectedError, match="closed"):
            await client.connect(1)
        await client.close()


async def test_a_link_that_fails_ends_the_client() -> None:
    """When the link itself ends, the state says so and calls name the reason."""
    ground, air = memory_pair()
    async with Aircraft(air, StubVehicle()), VehicleClient(ground) as client:
        await client.connect(5)
        await ground.close()
        await client.wait_for(lambda state: not state.connected, 5)
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
