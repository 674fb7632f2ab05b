"""A client with a key: what is not signed with it is nothing, and why is said; keys go out by order alone."""

from __future__ import annotations

import asyncio
import time
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import pytest
from pymavlink.dialects.v20 import ardupilotmega

from mavlink.errors import DoubtError, NotConnectedError, SigningError
from mavlink.links.memory import memory_pair
from mavlink.links.udp import open_udp
from mavlink.sim.modes import Flavour
from mavlink.sim.run import serve_link
from mavlink.sim.settings import SimSettings
from mavlink.station import signing_setup
from mavlink.station.client import VehicleClient
from mavlink.wire.items import Command, MissionType
from mavlink.wire.signing import Signing, SigningKey
from tests.mavlink.station.aircraft import HASTY
from tests.mavlink.station.test_strangers import Stranger
from tests.mavlink.transfer.vehicle import waypoints
from tests.patience import PATIENCE_S
from tests.virtual_time import loop_time_s

pytestmark = pytest.mark.virtual_time

SECRET, OTHER = bytes(range(32)), bytes(range(1, 33))
KEYS = {"ours": SECRET, "another": OTHER}


def signing(secret: bytes = SECRET) -> Signing:
    """Signatures by this machine's clock."""
    return Signing(SigningKey(secret), time.time)


@asynccontextmanager
async def simulated(
    with_key: bytes = b"",
    ours: bytes = b"",
    flavour: Flavour = Flavour.ARDUPILOT,
    tape: list[bytes] | None = None,
) -> AsyncIterator[VehicleClient]:
    """A client and a simulated aircraft in memory, each with a key or none; not waited for."""
    ground, air = memory_pair()
    settings = SimSettings(autopilot=flavour, signing_key=with_key)
    flying = asyncio.create_task(serve_link(air, settings))
    tap = None if tape is None else tape.append
    client = VehicleClient(
        ground,
        settings=HASTY,
        signing=signing(ours) if ours else None,
        tap=tap,
        lost_after_s=2.5,
        clock=loop_time_s,
    )
    client._driver.start()
    try:
        yield client
    finally:
        flying.cancel()
        await asyncio.gather(flying, return_exceptions=True)
        await client.close()


@pytest.mark.parametrize("flavour", list(Flavour))
async def test_with_one_key_all_is_as_ever(flavour: Flavour) -> None:
    """Connect, upload, read back and order; every frame on the link is one that pymavlink verifies."""
    tape: list[bytes] = []
    async with simulated(SECRET, SECRET, flavour, tape) as client:
        await client.connect(5)
        assert client.state.signing == "verified"
        assert (await client.upload(waypoints(20), MissionType.MISSION)).kind == "accepted"
        assert len(await client.download(MissionType.MISSION)) == 20
        assert (await client.command(Command.COMPONENT_ARM_DISARM, (1.0,))).accepted
    judge = ardupilotmega.MAVLink(None)
    judge.signing.secret_key = SECRET
    for frame in tape:
        for message in judge.parse_buffer(frame) or ():
            assert message.get_signed(), message
    assert judge.signing.goodsig_count > 50
    assert judge.signing.badsig_count == 0


@pytest.mark.parametrize(
    ("with_key", "words"), [(OTHER, "another key than the one known here"), (b"", "does not sign")]
)
async def test_without_the_key_nothing_counts_and_it_is_said(with_key: bytes, words: str) -> None:
    """Another key, or none: the vehicle is not there, and why is told instead of a silence."""
    async with simulated(with_key, SECRET) as client:
        state = await client.wait_for(lambda state: state.signing in ("wrong_key", "unsigned"), PATIENCE_S)
        assert not state.connected
        with pytest.raises(NotConnectedError, match=words):
            await client.arm()


async def test_a_vehicle_that_signs_is_told_where_no_key_is_known() -> None:
    """It is seen, stops are tried, and everything else is refused in words instead of ending in silence."""
    async with simulated(SECRET) as client:
        state = await client.connect(5)
        assert state.signing == "no_key"
        assert state.doubt is not None
        for order in (client.arm, client.start_mission):
            with pytest.raises(DoubtError, match="no key of it is known here"):
                await order()
        with pytest.raises(DoubtError, match="give its key"):
            await client.upload(waypoints(3), MissionType.MISSION)
        assert (await client.return_to_launch()).result is None


@pytest.mark.parametrize("flavour", list(Flavour))
async def test_a_key_is_handed_over_changed_and_taken_away(flavour: Flavour) -> None:
    """By order alone, never recorded; a vehicle that has another key keeps it, and so does this side."""
    tape: list[bytes] = []
    async with simulated(flavour=flavour, tape=tape) as client:
        await client.connect(5)
        assert client.state.doubt is None
        await client.set_up_signing(signing())
        await client.wait_for(lambda state: state.signing == "verified", PATIENCE_S)
        assert (await client.upload(waypoints(5), MissionType.MISSION)).kind == "accepted"
        await client.set_up_signing(signing(OTHER))
        assert client.state.signing == "verified"
        await client.stop_signing()
        assert (await client.upload(waypoints(4), MissionType.MISSION)).kind == "accepted"
    assert not any(secret in frame for frame in tape for secret in KEYS.values())


async def test_no_key_is_changed_in_flight_or_without_the_old_one(monkeypatch: pytest.MonkeyPatch) -> None:
    """Armed it is refused here; a vehicle with another key hears nothing of it, and all is as before."""
    async with simulated() as client:
        await client.connect(5)
        assert (await client.arm()).accepted
        await client.wait_for(lambda state: state.armed, PATIENCE_S)
        with pytest.raises(SigningError, match="armed"):
            await client.set_up_signing(signing())
        assert client.state.signing is None
    monkeypatch.setattr(signing_setup, "SHOWN_WITHIN_S", 1.5)
    async with simulated(OTHER) as client:
        await client.connect(5)
        with pytest.raises(SigningError, match="with another one"):
            await client.set_up_signing(signing())
        await client.wait_for(lambda state: state.connected and state.signing == "no_key", PATIENCE_S)


@pytest.mark.parametrize(
    ("has", "used", "words"),
    [
        (SECRET, OTHER, "signs with another key"),
        (OTHER, None, "signs with another key"),
        (b"", None, "does not sign"),
    ],
)
async def test_a_key_that_the_vehicle_has_not_is_not_used(
    monkeypatch: pytest.MonkeyPatch, has: bytes, used: bytes | None, words: str
) -> None:
    """In flight it would cut off all that is heard of the vehicle: all is as before, and the reason said."""
    monkeypatch.setattr(signing_setup, "SHOWN_WITHIN_S", 1.5)
    async with simulated(has, SECRET if used else b"") as client:
        before = (await client.connect(5)).signing
        with pytest.raises(SigningError, match=words):
            await client.use_key(signing(used or SECRET))
        await client.wait_for(lambda state: state.connected and state.signing == before, PATIENCE_S)
        if has:
            await client.use_key(signing(has))
            assert client.state.signing == "verified"


class Keyed(Stranger):
    """A socket of the test's own that signs as pymavlink does."""

    def __init__(self, port: int, secret: bytes, behind_s: float = 0.0) -> None:
        super().__init__(port)
        own = self._mav.signing
        own.secret_key, own.link_id, own.sign_outgoing = secret, 7, True
        own.timestamp = round((time.time() - behind_s - 1_420_070_400) * 100_000)

    def read(self) -> None:
        """Take what came in; its time goes with it, as every vehicle's does."""
        self._mav.robust_parsing = True
        self._mav.parse_buffer(self.overheard())


async def test_forgers_are_no_rivals_and_the_vehicle_may_move() -> None:
    """Unsigned and wrongly signed heartbeats of its system change nothing; with the key it is followed."""
    ground = await open_udp("127.0.0.1", 0, listen=True)
    async with VehicleClient(ground, signing=signing(), lost_after_s=0.6, clock=loop_time_s) as client:
        connecting = asyncio.create_task(client.connect(5))
        with (
            Keyed(ground.local_port, SECRET) as vehicle,
            Keyed(ground.local_port, OTHER) as forger,
            Stranger(ground.local_port) as stranger,
        ):
            for _ in range(3):
                forger.beat()
                stranger.beat()
            await asyncio.sleep(0)
            vehicle.beat()
            await connecting
            assert client.state.address == vehicle.address
            for _ in range(3):
                forger.beat()
                stranger.beat()
            forger.acknowledge(400)
            vehicle.beat()
            await client.wait_for(lambda state: len(state.strangers) == 2, PATIENCE_S)
            assert client.state.doubt is None
            assert client.state.signing == "verified"
            assert forger.overheard() == stranger.overheard() == b""
            with Keyed(ground.local_port, SECRET, behind_s=-1.0) as moved:
                while client.state.address != moved.address:
                    moved.beat()
                    await asyncio.sleep(0.05)


async def test_a_vehicle_whose_clock_is_behind_is_told_the_time() -> None:
    """Its frames are too old to count; it hears one of this side's, and counts from its next one on."""
    ground = await open_udp("127.0.0.1", 0, listen=True)
    async with VehicleClient(ground, signing=signing(), lost_after_s=0.6, clock=loop_time_s) as client:
        connecting = asyncio.create_task(client.connect(10))
        with Keyed(ground.local_port, SECRET, behind_s=7200.0) as vehicle:
            vehicle.beat()
            state = await client.wait_for(lambda state: state.signing == "replayed", PATIENCE_S)
            assert not state.connected
            while not connecting.done():
                vehicle.read()
                vehicle.beat()
                await asyncio.sleep(0.05)
            assert (await connecting).signing == "verified"
        # It starts again, on another port, and does not remember what time it was.
        await client.wait_for(lambda state: not state.connected, PATIENCE_S)
        with Keyed(ground.local_port, SECRET, behind_s=7200.0) as vehicle:
            while not client.state.connected:
                vehicle.read()
                vehicle.beat()
                await asyncio.sleep(0.05)
            assert (client.state.signing, client.state.address) == ("verified", vehicle.address)
