"""A vehicle's link forwarded over real sockets: what arrives, what does not, and what a bad peer costs."""

from __future__ import annotations

import asyncio
import contextlib
import socket
from collections.abc import AsyncIterator, Callable

import pytest

from mavlink.errors import BusyError, LinkError
from mavlink.links.link import memory_pair, open_link
from mavlink.links.tcp import open_tcp_server
from mavlink.links.udp import UdpLink, open_udp
from mavlink.station.client import VehicleClient
from mavlink.station.forward import outlet as outlet_module
from mavlink.station.forward.address import ForwardAddress, parse_forward
from mavlink.station.forward.hub import Forwards
from mavlink.station.forward.outlet import QUEUE_BYTES, Outlet
from mavlink.transfer.outcome import Accepted
from mavlink.wire.codec import Codec
from mavlink.wire.items import MissionType
from mavlink.wire.messages import Message, Value
from tests.mavlink.station.aircraft import Aircraft
from tests.mavlink.transfer.vehicle import StubVehicle, waypoints
from tests.patience import PATIENCE_S

ARM = 400
RETURN = 20


class Station:
    """Another ground station on a link: raw bytes in, frames out."""

    def __init__(self, link: UdpLink, system_id: int = 245) -> None:
        self.link = link
        self.codec = Codec(system_id, 190)

    def say(self, name: str, /, **fields: Value) -> bytes:
        """Send a message to the vehicle; the frame sent."""
        frame = self.codec.pack(Message(name, {"target_system": 1, "target_component": 1, **fields}))
        self.link.send_now(frame)
        return frame

    async def until(self, name: str) -> Message:
        """The next message of a name that is for this station, or for all."""
        async with asyncio.timeout(PATIENCE_S):
            while True:
                for message in self.codec.feed(await self.link.receive()):
                    target = message.fields.get("target_system", 0)
                    if message.name == name and target in (0, self.codec.system_id):
                        return message


async def until(condition: Callable[[], bool]) -> None:
    """Wait for something."""
    async with asyncio.timeout(PATIENCE_S):
        while not condition():
            await asyncio.sleep(0.002)


@contextlib.asynccontextmanager
async def forwarded(
    *addresses: ForwardAddress, passed: list[Message] | None = None, tapped: list[bytes] | None = None
) -> AsyncIterator[tuple[VehicleClient, Aircraft, Forwards]]:
    """A client of an aircraft in memory, forwarded."""
    ground, air = memory_pair()
    forwards = Forwards(lambda _, message: passed.append(message) if passed is not None else None)
    client = VehicleClient(ground, tap=tapped.append if tapped is not None else None, forwards=forwards)
    try:
        await forwards.set(addresses)
        async with Aircraft(air, StubVehicle("ardupilot")) as aircraft, client:
            await client.connect(20)
            yield client, aircraft, forwards
    finally:
        await forwards.close()


@contextlib.asynccontextmanager
async def station(write: bool) -> AsyncIterator[tuple[Station, ForwardAddress]]:
    """A station that listens, and the address of a forward to it."""
    link = await open_udp("127.0.0.1", 0, listen=True)
    try:
        yield Station(link), parse_forward(f"udpout:127.0.0.1:{link.local_port}", write=write)
    finally:
        await link.close()


def ports(forwards: Forwards) -> list[int]:
    """The ports really used."""
    return [int(outlet.url.rpartition(":")[2]) for outlet in forwards.outlets]


async def test_every_valid_frame_reaches_every_station() -> None:
    """By udpout, udpin and tcpin: each frame once, in order and as it was; damaged ones and noise not at all.

    A message this side's dialect lacks (397, COMPONENT_METADATA) goes on as it is.
    """
    air = Codec(1, 1)
    unknown = bytes([0xFD, 3, 0, 0, 9, 1, 1, 0x8D, 0x01, 0, 1, 2, 3, 0x12, 0x34])
    good = [air.pack(Message("STATUSTEXT", {"severity": 6, "text": f"number {n}"})) for n in range(40)]
    damaged = good[7][:-1] + bytes([good[7][-1] ^ 1])
    async with contextlib.AsyncExitStack() as stack:
        caller, address = await stack.enter_async_context(station(write=False))
        addresses = [address, parse_forward("udpin:0"), parse_forward("tcpin:0")]
        _, aircraft, forwards = await stack.enter_async_context(forwarded(*addresses))
        _, udp_port, tcp_port = ports(forwards)
        listener = await open_link(f"udpout:127.0.0.1:{udp_port}")
        stream = await open_link(f"tcp:127.0.0.1:{tcp_port}")
        stack.push_async_callback(listener.close)
        stack.push_async_callback(stream.close)
        await listener.send(Codec(245).pack(Message("HEARTBEAT", {"type": 6})))
        await until(lambda: all(outlet.peers == 1 for outlet in forwards.outlets))
        frames = [*good[:20], unknown, *good[20:]]
        for frame in [b"\xfd\x00noise", damaged, *frames, good[0]]:
            await aircraft.link.send(frame)
        for link in (caller.link, listener, stream):
            received = b""
            async with asyncio.timeout(PATIENCE_S):
                while good[0] not in received.partition(good[-1])[2]:
                    received += await link.receive()
            position = -1
            for frame in frames:
                position = received.index(frame, position + 1)
            assert damaged not in received
            assert b"noise" not in received
            assert received.count(unknown) == 1
        sent = [outlet.figures.sent for outlet in forwards.outlets]
        assert min(sent) >= len(frames)
        assert [outlet.figures.dropped for outlet in forwards.outlets] == [0, 0, 0]


async def test_a_watcher_cannot_command_until_it_may() -> None:
    """Read-only, an order to arm never arrives; the same forward opened for writing passes it, on record."""
    passed: list[Message] = []
    tapped: list[bytes] = []
    async with (
        station(write=False) as (peer, address),
        forwarded(address, passed=passed, tapped=tapped) as (_, aircraft, forwards),
    ):
        await peer.until("HEARTBEAT")
        (outlet,) = forwards.outlets
        refused = peer.say("COMMAND_LONG", command=ARM, param1=1.0)
        await until(lambda: outlet.figures.refused == 1)
        await forwards.set([ForwardAddress(address.url, write=True)])
        assert forwards.outlets == (outlet,)
        order = peer.say("COMMAND_LONG", command=RETURN)
        answered = await peer.until("COMMAND_ACK")
        assert (answered.integer("command"), answered.integer("target_system")) == (RETURN, 245)
        commanded = [number for number, _ in aircraft.commands if number not in (511, 512)]
        assert commanded == [RETURN]
        assert [message.integer("command") for message in passed] == [RETURN]
        assert (order in tapped, refused in tapped) == (True, False)
        assert outlet.stations == [245]
        await forwards.set([address])
        peer.say("COMMAND_LONG", command=ARM, param1=1.0)
        await until(lambda: outlet.figures.refused == 2)
        assert outlet.figures.passed == 1


async def test_our_upload_is_not_disturbed_by_a_station(monkeypatch: pytest.MonkeyPatch) -> None:
    """What a station sends of the mission protocol in mid-upload is held back, and afterwards passes."""
    items = waypoints(30)
    async with (
        station(write=True) as (peer, address),
        forwarded(address) as (client, aircraft, forwards),
    ):
        (outlet,) = forwards.outlets
        await peer.until("HEARTBEAT")
        answer = aircraft._answer

        async def disturbed(message: Message) -> None:
            if message.name == "MISSION_ITEM_INT" and message.integer("seq") == 10:
                for disturbance in ("MISSION_COUNT", "MISSION_CLEAR_ALL", "MISSION_REQUEST_LIST"):
                    peer.say(disturbance)
                peer.say("COMMAND_LONG", command=ARM, param1=1.0)
                await until(lambda: outlet.figures.held_back == 4)
            await answer(message)

        monkeypatch.setattr(aircraft, "_answer", disturbed)
        assert await client.upload(items, MissionType.MISSION) == Accepted()
        assert aircraft.vehicle.held[0] == items
        assert ARM not in [number for number, _ in aircraft.commands]
        peer.say("MISSION_CLEAR_ALL")
        await until(lambda: outlet.figures.passed == 1)
        await until(lambda: not aircraft.vehicle.held.get(0))


async def test_a_stations_transfer_is_not_disturbed_by_ours() -> None:
    """While a station downloads, ours are refused by name; its last word frees them."""
    async with (
        station(write=True) as (peer, address),
        forwarded(address) as (client, _, forwards),
    ):
        assert await client.upload(waypoints(3), MissionType.MISSION) == Accepted()
        await peer.until("HEARTBEAT")
        peer.say("MISSION_REQUEST_LIST")
        assert (await peer.until("MISSION_COUNT")).integer("count") == 3
        assert forwards.exchanging == 245
        with pytest.raises(BusyError, match="system 245"):
            await client.download(MissionType.MISSION)
        peer.say("MISSION_ACK")
        await until(lambda: forwards.exchanging is None)
        assert await client.download(MissionType.MISSION) == waypoints(3)


async def test_a_stuck_peer_costs_its_own_frames_alone() -> None:
    """A TCP peer that never reads: the queue stays bounded, the oldest are dropped and counted.

    The vehicle's link goes on, and another station gets everything.
    """
    frame = Codec(1, 1).pack(Message("STATUSTEXT", {"severity": 6, "text": "x" * 50}))
    async with (
        station(write=False) as (peer, address),
        forwarded(parse_forward("tcpin:0"), address) as (client, _, forwards),
    ):
        stuck, other = forwards.outlets
        with socket.create_connection(("127.0.0.1", ports(forwards)[0])) as reader:
            await until(lambda: stuck.peers == 1)
            before = other.figures.sent
            offered = 0
            async with asyncio.timeout(PATIENCE_S):
                while stuck.figures.dropped < 100:
                    for _ in range(500):
                        forwards.heard(frame, None)
                    offered += 500
                    await asyncio.sleep(0)
                    await asyncio.sleep(0)
            assert stuck._queued_bytes <= QUEUE_BYTES
            assert (await client.command(RETURN)).accepted
            assert other.figures.sent - before >= offered
            assert other.figures.dropped == 0
            # It wakes up: what it gets from then on are whole frames again.
            codec = Codec()
            reader.setblocking(False)
            heard: list[str] = []
            loop = asyncio.get_running_loop()
            async with asyncio.timeout(PATIENCE_S):
                while "HEARTBEAT" not in heard:
                    heard += [m.name for m in codec.feed(await loop.sock_recv(reader, 1 << 20))]
            assert codec.bad_frames == 0
        assert peer.link.local_port != ports(forwards)[0]


async def test_peers_that_come_and_go() -> None:
    """Nobody there, there, gone, another there: the link never notices, nothing old is kept for later."""
    async with forwarded(parse_forward("tcpin:0")) as (client, aircraft, forwards):
        (outlet,) = forwards.outlets
        await aircraft.say("STATUSTEXT", severity=6, text="nobody hears this")
        assert (await client.command(RETURN)).accepted
        for _ in range(2):
            link = await open_link(f"tcp:127.0.0.1:{ports(forwards)[0]}")
            codec = Codec()
            heard: list[Message] = []
            async with asyncio.timeout(PATIENCE_S):
                while not any(message.name == "HEARTBEAT" for message in heard):
                    heard += codec.feed(await link.receive())
            assert "nobody hears this" not in [str(message.fields.get("text")) for message in heard]
            await link.close()
            await until(lambda: outlet.peers == 0)
        assert outlet.figures.dropped == 0


async def test_closed_is_closed() -> None:
    """What is asked for while all are being closed opens nothing that nobody would close."""
    forwards = Forwards()
    await forwards.set([parse_forward("udpin:0")])
    closing = asyncio.create_task(forwards.close())
    await asyncio.sleep(0)
    with pytest.raises(LinkError, match="closed"):
        await forwards.set([parse_forward("udpin:0")])
    await closing
    assert forwards.outlets == ()


async def test_a_called_station_alone_is_answered_to() -> None:
    """What others send to the port a udpout forward calls from is not heard, and cannot come from outside."""
    async with (
        station(write=True) as (peer, address),
        forwarded(address) as (_, aircraft, forwards),
    ):
        (outlet,) = forwards.outlets
        await peer.until("HEARTBEAT")
        assert isinstance(outlet._link, UdpLink)
        assert outlet._link._socket.getsockname()[0] == "127.0.0.1"
        stranger = Station(await open_udp("127.0.0.1", outlet._link.local_port, listen=False), 99)
        stranger.say("COMMAND_LONG", command=ARM, param1=1.0)
        peer.say("COMMAND_LONG", command=RETURN)
        await until(lambda: RETURN in [number for number, _ in aircraft.commands])
        assert ARM not in [number for number, _ in aircraft.commands]
        assert outlet.stations == [245]
        await stranger.link.close()


async def test_what_is_unreadable_from_a_station_is_dropped() -> None:
    """Noise, damaged frames and messages not of the dialect are counted and do not pass."""
    async with (
        station(write=True) as (peer, address),
        forwarded(address) as (_, aircraft, forwards),
    ):
        (outlet,) = forwards.outlets
        await peer.until("HEARTBEAT")
        unknown = bytes([0xFD, 3, 0, 0, 9, 245, 190, 0x8D, 0x01, 0, 1, 2, 3, 0x12, 0x34])
        order = peer.codec.pack(Message("COMMAND_LONG", {"command": ARM, "target_system": 1}))
        for data in (b"\x01noise", unknown, order[:-1] + bytes([order[-1] ^ 1])):
            peer.link.send_now(data)
        peer.say("COMMAND_LONG", command=RETURN)
        await until(lambda: RETURN in [number for number, _ in aircraft.commands])
        assert (outlet.figures.passed, outlet.figures.lost >= 2) == (1, True)
        assert [number for number, _ in aircraft.commands if number not in (511, 512)] == [RETURN]


async def test_a_flood_from_a_station_is_bounded() -> None:
    """More than the link takes at once is lost and counted; what waits never grows past its bound."""
    async with (
        station(write=True) as (peer, address),
        forwarded(address) as (client, _, forwards),
    ):
        (outlet,) = forwards.outlets
        order = peer.codec.pack(Message("COMMAND_LONG", {"command": RETURN, "target_system": 1}))
        for message in peer.codec.feed(order * 2000):
            forwards._take(outlet, order, message)
        figures = outlet.figures
        assert figures.passed + figures.lost == 2000
        assert figures.passed <= 256
        assert len(client._driver._outgoing) <= 256


async def test_a_port_in_use_is_said_and_nothing_changes() -> None:
    """All or nothing: with one address that cannot be opened, those before stay as they were."""
    async with forwarded(parse_forward("udpin:0")) as (_, _, forwards):
        before = forwards.outlets
        taken = await open_tcp_server("127.0.0.1", 0)
        with pytest.raises(LinkError, match=f"tcpin:127.0.0.1:{taken.local_port}"):
            await forwards.set(
                [parse_forward("udpin::0"), parse_forward("udpin:127.0.0.1:0"), parse_forward(taken.url)]
            )
        assert forwards.outlets == before
        await taken.close()


async def test_a_port_in_use_is_tried_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """Begun in the background, as after a restart, it tells the reason and opens once the port is free."""
    monkeypatch.setattr(outlet_module, "REOPEN_S", 0.01)
    taken = await open_tcp_server("127.0.0.1", 0)
    forwards = Forwards()
    forwards.begin([parse_forward(taken.url)])
    (outlet,) = forwards.outlets
    await until(lambda: outlet.failure is not None)
    assert taken.url in str(outlet.failure)
    await taken.close()
    await until(lambda: outlet.failure is None and outlet._link is not None)
    await forwards.close()


async def test_a_tcp_station_may_come_later(monkeypatch: pytest.MonkeyPatch) -> None:
    """A station to be called that is not there yet is no error; it is called until it is."""
    monkeypatch.setattr(outlet_module, "REOPEN_S", 0.01)
    # Bound and not listened on, the port refuses callers and is nobody else's.
    with socket.socket() as late:
        late.bind(("127.0.0.1", 0))
        late.setblocking(False)
        async with forwarded(parse_forward(f"tcp:{late.getsockname()[1]}")) as (_, _, forwards):
            (outlet,) = forwards.outlets
            assert outlet.failure is not None
            late.listen()
            loop = asyncio.get_running_loop()
            async with asyncio.timeout(PATIENCE_S):
                accepted, _ = await loop.sock_accept(late)
                with accepted:
                    codec = Codec()
                    heard: list[str] = []
                    while "HEARTBEAT" not in heard:
                        heard += [m.name for m in codec.feed(await loop.sock_recv(accepted, 4096))]


async def test_a_new_link_is_forwarded_by_the_same_outlets() -> None:
    """A client that ends leaves the forwards open; the next one on another link takes them up."""
    async with station(write=True) as (peer, address), forwarded(address) as (client, _, forwards):
        await peer.until("HEARTBEAT")
        await client.close()
        (outlet,) = forwards.outlets
        peer.say("COMMAND_LONG", command=RETURN)
        await until(lambda: outlet.figures.refused == 1)
        ground, air = memory_pair()
        async with (
            Aircraft(air, StubVehicle("ardupilot")) as aircraft,
            VehicleClient(ground, forwards=forwards) as again,
        ):
            await again.connect(20)
            peer.say("COMMAND_LONG", command=RETURN)
            await until(lambda: RETURN in [number for number, _ in aircraft.commands])


def test_figures_by_name() -> None:
    """Every figure of an address is told."""
    figures = Outlet(parse_forward("udpin:0"), lambda *_: None).figures
    assert set(figures.as_dict()) == {"sent", "dropped", "passed", "refused", "held_back", "lost"}
