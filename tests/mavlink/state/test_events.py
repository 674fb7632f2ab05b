"""PX4's events: recognised, in words, none lost and none told twice."""

from __future__ import annotations

import asyncio
import struct
from collections.abc import Sequence

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymavlink.dialects.v20 import ardupilotmega as dialect

from mavlink.dialects.compare import Difference
from mavlink.links.link import memory_pair
from mavlink.state.events import EventOrder, event_id, read_event
from mavlink.state.telemetry import VehicleState, updated
from mavlink.station.client import VehicleClient
from mavlink.wire.codec import Codec
from mavlink.wire.items import MissionItem, MissionType
from mavlink.wire.messages import Message
from tests.mavlink.station.aircraft import flying
from tests.mavlink.transfer.vehicle import waypoints
from tests.patience import PATIENCE_S
from tests.virtual_time import loop_time_s

pytestmark = pytest.mark.virtual_time

LAND_MISSING = "navigator_mis_land_missing"


def event(name: str, sequence: int = 0, arguments: bytes = b"", levels: int = 0x63) -> Message:
    """An EVENT as it comes off the wire."""
    fields = {
        "id": event_id(name),
        "sequence": sequence,
        "log_levels": levels,
        "arguments": tuple(arguments.ljust(40, b"\0")),
    }
    (message,) = Codec().feed(Codec(1, 1).pack(Message("EVENT", fields)))
    return message


def current(sequence: int, flags: int = 0) -> Message:
    """The vehicle's count."""
    return Message("CURRENT_EVENT_SEQUENCE", {"sequence": sequence, "flags": flags}, 1, 1)


@pytest.mark.parametrize(
    ("name", "message_id", "crc_extra", "size"),
    [
        ("EVENT", 410, 160, 53),
        ("CURRENT_EVENT_SEQUENCE", 411, 106, 3),
        ("REQUEST_EVENT", 412, 33, 6),
        ("RESPONSE_EVENT_ERROR", 413, 77, 7),
    ],
)
def test_the_definitions_are_those_of_the_standard(
    name: str, message_id: int, crc_extra: int, size: int
) -> None:
    """Number, checksum seed and length as in the published headers of MAVLink's C library."""
    fields = {"arguments": (7,) * 40} if name == "EVENT" else {}
    last = {"EVENT": {}, "CURRENT_EVENT_SEQUENCE": {"flags": 1}, "RESPONSE_EVENT_ERROR": {"reason": 1}}
    frame = Codec(1, 1).pack(Message(name, {**fields, **last.get(name, {"target_component": 1})}))
    assert int.from_bytes(frame[7:10], "little") == message_id
    assert len(frame) == 10 + size + 2
    assert frame[-2:] == int(dialect.x25crc(frame[1:-2] + bytes([crc_extra])).crc).to_bytes(2, "little")


@pytest.mark.parametrize(
    ("name", "number"),
    # From the event metadata that PX4 v1.16.0 carries.
    [
        ("mission_not_valid_refuse", 0x014A122B),
        ("navigator_mis_land_missing", 0x01811691),
        ("navigator_mis_takeoff_not_first", 0x01FE4222),
    ],
)
def test_numbers_are_hashes_of_names(name: str, number: int) -> None:
    """The number of an event as PX4's own metadata has it."""
    assert event_id(name) == number


@pytest.mark.parametrize(
    ("message", "severity", "text"),
    [
        (event(LAND_MISSING), 3, "mission rejected: a landing is required"),
        (
            event("navigator_mis_glide_slope_too_steep", arguments=struct.pack("<BB", 5, 3)),
            3,
            "mission rejected: the landing is steeper than the 5.3° the vehicle is set to",
        ),
        (
            event("navigator_mis_unsup_cmd", arguments=struct.pack("<HH", 4, 112)),
            3,
            "mission rejected: item 4 has the unsupported command 112",
        ),
        (
            event("navigator_mis_geofence_violation", arguments=struct.pack("<h", 12), levels=0x64),
            4,
            "mission rejected: item 12 lies outside the fence",
        ),
    ],
)
def test_in_words(message: Message, severity: int, text: str) -> None:
    """Arguments are filled in, and the text joins what the vehicle said."""
    state = updated(VehicleState(), message, 3.0)
    (said,) = state.texts
    assert (said.severity, said.text, said.against_mission, said.heard_s) == (severity, text, True, 3.0)


def test_others_are_left_alone() -> None:
    """Unknown events, and those for programs, say nothing to people."""
    assert read_event(event("commander_takeoff_detected")) is None
    assert read_event(event(LAND_MISSING, levels=0x38)) is None
    assert updated(VehicleState(), event("something_else"), 1.0).texts == ()


def test_a_text_said_again_by_an_event_loses_its_tab() -> None:
    """PX4 marks such texts with a tab at the end."""
    text = Message("STATUSTEXT", {"severity": 6, "text": "Executing Mission\t", "id": 0, "chunk_seq": 0})
    assert updated(VehicleState(), text, 1.0).texts[0].text == "Executing Mission"


def test_the_vehicles_first_count_is_where_it_begins() -> None:
    """What was before the acquaintance is not asked for."""
    order = EventOrder()
    assert not order.heard
    order.take(current(500))
    assert order.heard
    assert order.requests(1, 1) == []
    assert order.take(event("a", 501))


def test_a_reset_forgets_what_is_missing() -> None:
    """After a reboot the numbers begin anew."""
    order = EventOrder()
    order.take(current(9))
    order.take(current(12))
    assert [message.fields["first_sequence"] for message in order.requests(1, 1)] == [10, 11, 12]
    order.take(current(3, flags=1))
    assert order.requests(1, 1) == []
    assert order.take(event("a", 4))


def test_what_the_vehicle_no_longer_has_is_given_up() -> None:
    """RESPONSE_EVENT_ERROR ends the asking."""
    order = EventOrder()
    order.take(current(0))
    order.take(current(1))
    order.take(Message("RESPONSE_EVENT_ERROR", {"sequence": 1}))
    assert order.requests(1, 1) == []


@given(st.integers(0, 65535), st.lists(st.booleans(), min_size=1, max_size=15), st.randoms())
def test_each_event_is_taken_once(first: int, lost: list[bool], random: object) -> None:
    """Whatever is lost or comes twice, across the wrap of the numbers: every event is read exactly once."""
    order = EventOrder()
    order.take(current((first - 1) % 65536))
    sequences = [(first + n) % 65536 for n in range(len(lost))]
    taken = []
    for sequence, gone in zip(sequences, lost, strict=True):
        for _ in range(0 if gone else 2):
            if order.take(event("a", sequence)):
                taken.append(sequence)
    order.take(current(sequences[-1]))
    for request in order.requests(1, 1):
        sequence = request.integer("first_sequence")
        taken += [sequence] * order.take(event("a", sequence))
    assert sorted(taken) == sorted(sequences)
    assert order.requests(1, 1) == []


async def test_a_client_asks_for_a_lost_event() -> None:
    """The event never came; its count did; the client asks, and tells what the answer says."""
    ground, air = memory_pair()
    vehicle = Codec(1, 1)
    heartbeat = Message("HEARTBEAT", {"type": 1, "autopilot": 12})
    await air.send(vehicle.pack(heartbeat) + vehicle.pack(current(6)) + vehicle.pack(current(7)))
    async with VehicleClient(ground, clock=loop_time_s) as client:
        await client.connect(5.0)
        request = None
        async with asyncio.timeout(PATIENCE_S):
            while request is None:
                heard = vehicle.feed(await air.receive())
                request = next((message for message in heard if message.name == "REQUEST_EVENT"), None)
        assert (request.fields["first_sequence"], request.fields["target_system"]) == (7, 1)
        await air.send(vehicle.pack(event(LAND_MISSING, 7)))
        state = await client.wait_for(lambda state: bool(state.texts), PATIENCE_S)
        assert state.texts[-1].text == "mission rejected: a landing is required"
    await air.close()


async def test_an_upload_tells_why_the_vehicle_will_not_fly_it() -> None:
    """Acknowledged and held, yet rejected, with each reason once; the same list again: the same reasons."""

    def compare(meant: tuple[MissionItem, ...], held: tuple[MissionItem, ...]) -> Sequence[Difference]:
        return [] if meant == held else [Difference(None, "items", None, None)]

    bad, good = waypoints(3), waypoints(4)
    async with flying("px4") as (client, aircraft):
        await aircraft.say("CURRENT_EVENT_SEQUENCE", sequence=4)

        async def judge() -> None:
            while not any(message.name == "MISSION_ACK" for message in aircraft.heard):
                await asyncio.sleep(0.01)
            reasons = (LAND_MISSING, LAND_MISSING, "navigator_mis_takeoff_missing")
            for sequence, name in enumerate(reasons, start=5):
                await aircraft.say("EVENT", **event(name, sequence).fields)

        judged = asyncio.create_task(judge())
        first = await client.upload_verified(bad, MissionType.MISSION, compare)
        await judged
        again = await client.upload_verified(bad, MissionType.MISSION, compare)
        after = await client.upload_verified(good, MissionType.MISSION, compare)
    for result in (first, again):
        assert (result.status, result.outcome.kind, result.differences) == ("rejected", "accepted", ())
        assert result.objections == (
            "mission rejected: a landing is required",
            "mission rejected: a take-off is required",
        )
    assert (after.status, after.objections) == ("stored", ())
