"""Two aircraft under one system id on one stream are told, whatever their numbers; one alone never is."""

from __future__ import annotations

from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pymavlink.dialects.v20 import common

from mavlink.errors import DoubtError
from mavlink.links.memory import MemoryLink, memory_pair
from mavlink.station.client import VehicleClient
from mavlink.station.twins import Twins
from mavlink.wire.codec import Codec
from mavlink.wire.messages import Message
from tests.mavlink.station.aircraft import HASTY, Aircraft
from tests.mavlink.transfer.vehicle import StubVehicle
from tests.patience import PATIENCE_S
from tests.virtual_time import loop_time_s

pytestmark = pytest.mark.virtual_time

#: Seconds between two frames of an aircraft, and how many are sent.
_EVERY_S, _FRAMES = 0.1, 200


class Sender:
    """One aircraft's telemetry, packed by pymavlink."""

    def __init__(self, sequence: int, booted_s: float, lat_deg: float) -> None:
        self._mav = common.MAVLink(None, srcSystem=1, srcComponent=1)
        self._mav.seq = sequence
        self._booted_s, self._lat_deg = booted_s, lat_deg

    def frame(self, number: int, now_s: float) -> bytes:
        """The frame sent at a time."""
        self._mav.seq = (self._mav.seq + 1) % 256
        boot_ms = round((now_s + self._booted_s) * 1000.0)
        if number % 3 == 0:
            beat: bytes = common.MAVLink_heartbeat_message(1, 3, 0, 10, 4, 3).pack(self._mav)
            return beat
        if number % 3 == 1:
            attitude = common.MAVLink_attitude_message(boot_ms, 0.0, 0.0, now_s % 3.0, 0.0, 0.0, 0.0)
            turned: bytes = attitude.pack(self._mav)
            return turned
        north = round((self._lat_deg + 15.0 * now_s / 111_195.0) * 1e7)
        place = common.MAVLink_global_position_int_message(boot_ms, north, 0, 0, 0, 1500, 0, 0, 0)
        placed: bytes = place.pack(self._mav)
        return placed


def told(frames: list[tuple[float, bytes]]) -> bool:
    """Whether two aircraft are ever told of frames that arrive at these times."""
    codec, twins = Codec(), Twins()
    ever = False
    for at_s, frame in frames:
        for message in codec.feed(frame):
            twins.heard(message, at_s)
        ever = ever or twins.told(at_s)
    return ever


SEQUENCE = st.integers(0, 255)


@settings(deadline=None, max_examples=60)
@given(SEQUENCE, SEQUENCE, st.floats(0.3, 3.0), st.floats(0.0, 0.3), st.booleans(), st.integers(0, 999))
def test_two_aircraft_are_told(
    first: int, second: int, pace: float, loss: float, elsewhere: bool, seed: int
) -> None:
    """Apart in time since boot or in place; numbers, rates and losses are any."""
    random = Random(seed)
    one, two = (
        Sender(first, 100.0, 47.0),
        Sender(second, 100.0 if elsewhere else 160.0, 47.0 + 0.01 * elsewhere),
    )
    frames = [(n * _EVERY_S, one.frame(n, n * _EVERY_S)) for n in range(_FRAMES)]
    frames += [(t, two.frame(n, t)) for n in range(_FRAMES) if (t := (n + 0.37) * _EVERY_S * pace) < 20.0]
    assert told([frame for frame in sorted(frames) if random.random() >= loss])


@settings(deadline=None, max_examples=60)
@given(SEQUENCE, st.floats(0.0, 0.6), st.floats(0.0, 0.3), st.floats(0.0, 0.3), st.integers(0, 999))
def test_one_aircraft_is_not(first: int, loss: float, doubled: float, overtaken: float, seed: int) -> None:
    """However many frames are lost, one by one or forty at once, doubled, or overtaken by twenty others."""
    random = Random(seed)
    one = Sender(first, 100.0, 47.0)
    frames = []
    for n in range(3 * _FRAMES):
        at_s, frame = n * _EVERY_S / 3.0, one.frame(n, n * _EVERY_S / 3.0)
        if random.random() < loss or n // 40 % 4 == seed % 4:
            continue
        late_s = random.uniform(0.0, 0.7) if random.random() < overtaken else 0.0
        frames.append((at_s + late_s, frame))
        if random.random() < doubled:
            frames.append((at_s + late_s + random.uniform(0.0, 1.0), frame))
    assert not told(sorted(frames))


@settings(deadline=None, max_examples=30)
@given(SEQUENCE, SEQUENCE, st.floats(0.0, 1.0))
def test_one_aircraft_on_two_channels_is_not(first: int, second: int, late_s: float) -> None:
    """Each channel counts for itself, and one radio is slower: place and time tell that it is one."""
    radio, other = Sender(first, 100.0, 47.0), Sender(second, 100.0, 47.0)
    frames = [(n * _EVERY_S, radio.frame(n, n * _EVERY_S)) for n in range(_FRAMES)]
    frames += [(n * _EVERY_S + late_s, other.frame(n, n * _EVERY_S)) for n in range(_FRAMES)]
    assert not told(sorted(frames))


def test_a_restart_is_no_second_aircraft() -> None:
    """Numbers and time since boot begin anew, once."""
    one, again = Sender(77, 900.0, 47.0), Sender(0, -9.0, 47.0)
    before = [(n * _EVERY_S, one.frame(n, n * _EVERY_S)) for n in range(100)]
    after = [(n * _EVERY_S, again.frame(n, n * _EVERY_S)) for n in range(100, 200)]
    assert not told(before + after)


async def test_the_client_orders_neither() -> None:
    """On a stream of two what flies is refused, and a stop is sent; once one is gone all is well again."""
    ground, air = memory_pair()
    clock = {"ahead_s": 0.0}
    client = VehicleClient(ground, settings=HASTY, clock=lambda: loop_time_s() + clock["ahead_s"])
    second = Codec(1, 1)
    async with Aircraft(air, StubVehicle()) as aircraft, client:
        await client.connect(5)
        assert isinstance(air, MemoryLink)
        for number in range(60):
            await aircraft.say("ATTITUDE", time_boot_ms=1000 + number)
            for _ in range(3):
                air_says = Message("ATTITUDE", {"time_boot_ms": 90_000 + number})
                await air.send(second.pack(air_says))
        state = await client.wait_for(lambda state: state.doubt is not None, PATIENCE_S)
        assert state.doubt is not None
        assert "in turns" in state.doubt.message
        with pytest.raises(DoubtError):
            await client.arm()
        assert (await client.return_to_launch()).accepted
        clock["ahead_s"] = 20.0
        await client.wait_for(lambda state: state.connected and state.doubt is None, PATIENCE_S)
        assert (await client.arm()).accepted
