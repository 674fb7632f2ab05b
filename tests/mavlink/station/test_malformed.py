"""Malformed MAVLink on the link of a connected client: no crash, no leak, and the link goes on."""

from __future__ import annotations

import asyncio
import gc
import math
import random
import struct

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from pymavlink.dialects.v20 import ardupilotmega as dialect

from mavlink.errors import TransferFailedError
from mavlink.sim.autopilot import SimulatedAircraft
from mavlink.sim.modes import Flavour
from mavlink.sim.settings import SimSettings
from mavlink.transfer.outcome import Accepted
from mavlink.wire.codec import Codec
from mavlink.wire.items import MissionType
from mavlink.wire.messages import Message
from tests.mavlink.station.aircraft import flying
from tests.mavlink.transfer.vehicle import waypoints

pytestmark = pytest.mark.virtual_time

NAMES = sorted(definition.msgname for definition in dialect.mavlink_map.values())
IDS = {definition.msgname: number for number, definition in dialect.mavlink_map.items()}
#: Those a vehicle's mission, command and parameter protocols look at.
TALK = [name for name in NAMES if name.startswith(("MISSION_", "COMMAND_", "PARAM_", "SET_MODE"))]


def frame(name: str, payload: bytes) -> bytes:
    """A whole frame of the vehicle with any payload, right checksum included."""
    number = IDS[name]
    head = struct.pack("<BBBBBBHB", len(payload), 0, 0, 0, 1, 1, number & 0xFFFF, number >> 16)
    crc = dialect.x25crc(head + payload + bytes([dialect.mavlink_map[number].crc_extra])).crc
    return b"\xfd" + head + payload + struct.pack("<H", crc)


def not_numbers(name: str) -> bytes:
    """A payload in which every float that can be is NaN."""
    size = dialect.mavlink_map[IDS[name]].unpacker.size
    return (struct.pack("<f", math.nan) * size)[:size]


@st.composite
def malformed(draw: st.DrawFn) -> bytes:
    """Wrong checksums, lengths that lie, truncation, all NaN, any bytes."""
    name = draw(st.sampled_from(NAMES))
    whole = bytearray(frame(name, draw(st.one_of(st.binary(max_size=255), st.just(not_numbers(name))))))
    match draw(st.sampled_from(["whole", "checksum", "length", "truncated", "noise"])):
        case "checksum":
            whole[-1] ^= draw(st.integers(1, 255))
        case "length":
            whole[1] = draw(st.integers(0, 255))
        case "truncated":
            del whole[draw(st.integers(1, len(whole))) :]
        case "noise":
            return draw(st.binary(max_size=280))
    return bytes(whole)


@settings(max_examples=200, deadline=None)
@given(st.lists(malformed(), max_size=12))
def test_the_decoder_keeps_no_more_than_a_frame(pieces: list[bytes]) -> None:
    """Whatever comes, less than one longest frame is kept, and good frames behind it are heard again."""
    codec = Codec()
    for piece in pieces:
        codec.feed(piece)
        assert len(codec._buffer) < 12 + 255 + 13
    good = frame("MISSION_COUNT", bytes([3, 0, 255, 190]))
    assert sum(len(codec.feed(good)) for _ in range(30)) >= 10


@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(st.lists(malformed(), min_size=1, max_size=30))
def test_the_link_goes_on(pieces: list[bytes]) -> None:
    """A client fed with it still transfers, holds no task more than before, and its state is whole."""

    async def live() -> None:
        async with flying("ardupilot") as (client, aircraft):
            tasks = len(asyncio.all_tasks())
            for piece in pieces:
                await aircraft.link.send(piece)
            # Ends whatever length a lying header claims.
            await aircraft.link.send(bytes(300))
            for _ in range(3):
                outcome = await client.upload(waypoints(3), MissionType.MISSION)
                if outcome == Accepted():
                    break
            assert outcome == Accepted()
            try:
                assert await client.download(MissionType.MISSION) == waypoints(3)
            except TransferFailedError as error:
                raise AssertionError(pieces) from error
            assert client.failure is None
            assert len(asyncio.all_tasks()) <= tasks

    asyncio.run(live())


@settings(max_examples=200, deadline=None)
@given(
    st.sampled_from(list(Flavour)),
    st.lists(st.tuples(st.sampled_from(TALK), st.binary(max_size=60)), min_size=1, max_size=12),
)
def test_the_simulated_aircraft_outlives_nonsense(flavour: Flavour, heard: list[tuple[str, bytes]]) -> None:
    """Any words of the protocols, well framed: answers can be packed, and it goes on answering."""
    aircraft = SimulatedAircraft(SimSettings(autopilot=flavour))
    ground, air = Codec(), Codec(1, 1)
    aircraft.advance(0.0)
    for second, (name, payload) in enumerate(heard, 1):
        padded = payload.ljust(dialect.mavlink_map[IDS[name]].unpacker.size, b"\0")
        for message in ground.feed(frame(name, padded[:255])):
            try:
                answers = aircraft.receive(message, float(second))
            except (KeyError, TypeError, ValueError, OverflowError):
                continue  # as on its link: said, and passed over
            for answer in answers:
                air.pack(answer)
    aircraft.advance(len(heard) + 20.0)
    listing = {"target_system": 1, "target_component": 1, "mission_type": 0}
    answers = aircraft.receive(Message("MISSION_REQUEST_LIST", listing, 255, 190), len(heard) + 20.0)
    assert [answer.name for answer in answers] == ["MISSION_COUNT"]


async def test_twenty_thousand_frames_leave_nothing_behind() -> None:
    """Frames whole and damaged, of every message: the link stays, and so does what memory it takes."""
    chance = random.Random(20)
    async with flying("px4") as (client, aircraft):
        tasks, sizes = len(asyncio.all_tasks()), []
        for round_ in range(20):
            for _ in range(1000):
                await aircraft.link.send(spoiled(chance))
            await asyncio.sleep(0.1)
            if round_ in (9, 19):
                aircraft.heard.clear()
                aircraft.commands.clear()
                gc.collect()
                sizes.append(len(gc.get_objects()))
        assert client.failure is None
        assert client.state.texts
        assert len(asyncio.all_tasks()) == tasks
        assert sizes[1] < sizes[0] + 2000
        assert await client.upload(waypoints(5), MissionType.MISSION) == Accepted()


def spoiled(chance: random.Random) -> bytes:
    """One frame, of the vehicle's ids, with any payload; two of three damaged."""
    name = chance.choice(NAMES)
    whole = bytearray(
        frame(name, chance.choice([chance.randbytes(chance.randrange(256)), not_numbers(name)]))
    )
    match chance.randrange(6):
        case 0:
            whole[chance.randrange(len(whole))] ^= chance.randrange(1, 256)
        case 1:
            whole[1] = chance.randrange(256)
        case 2:
            del whole[chance.randrange(1, len(whole)) :]
        case 3:
            return chance.randbytes(chance.randrange(1, 281))
    return bytes(whole)
