"""Links: addresses, bytes there and back, peers that come and go."""

from __future__ import annotations

import asyncio
import contextlib
import os
import pty
import socket

import pytest

from mavlink.errors import LinkError
from mavlink.links.inbox import Inbox
from mavlink.links.link import DirectLink, Link, LinkFaults, memory_pair, open_link
from mavlink.links.tcp import TcpClientLink, TcpServerLink, open_tcp_server
from mavlink.links.udp import open_udp
from tests.patience import PATIENCE_S


async def exchange(first: Link, second: Link) -> None:
    """Bytes go both ways; ``first`` speaks first."""
    await first.send(b"ping")
    assert await asyncio.wait_for(second.receive(), PATIENCE_S) == b"ping"
    await second.send(b"pong")
    assert await asyncio.wait_for(first.receive(), PATIENCE_S) == b"pong"


@pytest.mark.parametrize(
    ("url", "words"),
    [
        ("", "forms are"),
        ("udp:127.0.0.1:14550", "forms are"),
        ("udpin:14550", "forms are"),
        ("udpin:127.0.0.1:", "forms are"),
        ("udpin:127.0.0.1:http", "'http' is not a number"),
        ("udpin:127.0.0.1:-1", "not a number"),
        ("udpin:127.0.0.1:70000", "0 to 65535"),
        ("udpout:127.0.0.1:0", "1 to 65535"),
        ("tcp:127.0.0.1:0", "1 to 65535"),
        ("udpout:no..host:14550", "name of a host"),
        ("serial:/dev/ttyUSB0", "forms are"),
        ("serial:/dev/ttyUSB0:fast", "baud rate 'fast'"),
        ("serial:/dev/ttyUSB0:0", "baud rate above 0"),
        ("serial:/dev/no-such-device:57600", "no-such-device"),
    ],
)
async def test_bad_addresses_are_explained(url: str, words: str) -> None:
    """The error is a ValueError that quotes the address and says what is wrong with it."""
    with pytest.raises(LinkError, match=words) as caught:
        await open_link(url)
    assert url in str(caught.value)
    assert isinstance(caught.value, ValueError)


async def test_udp_both_ways() -> None:
    """A listener on a free port answers whoever called it."""
    listener = await open_udp("127.0.0.1", 0, listen=True)
    caller = await open_link(f"udpout:127.0.0.1:{listener.local_port}")
    assert listener.url == f"udpin:127.0.0.1:{listener.local_port}"
    assert caller.url == f"udpout:127.0.0.1:{listener.local_port}"
    await exchange(caller, listener)
    await caller.close()
    await listener.close()


async def test_udp_answers_every_peer() -> None:
    """Two vehicles, or a vehicle and its relay, on one port both hear us."""
    listener = await open_udp("127.0.0.1", 0, listen=True)
    callers = [await open_udp("127.0.0.1", listener.local_port, listen=False) for _ in range(2)]
    for caller in callers:
        await caller.send(b"here")
        assert await asyncio.wait_for(listener.receive(), PATIENCE_S) == b"here"
    await listener.send(b"all")
    assert [await asyncio.wait_for(caller.receive(), PATIENCE_S) for caller in callers] == [b"all", b"all"]
    for link in (*callers, listener):
        await link.close()


async def test_a_udp_peer_that_talks_is_not_displaced() -> None:
    """Forty strangers come after it: it is answered all the same, and not all of them are."""
    listener = await open_udp("127.0.0.1", 0, listen=True)
    callers = [await open_udp("127.0.0.1", listener.local_port, listen=False) for _ in range(41)]
    for caller in callers:
        await caller.send(b"here")
        assert await asyncio.wait_for(listener.receive(), PATIENCE_S) == b"here"
    assert listener.peers < len(callers)
    await listener.send(b"all")
    assert await asyncio.wait_for(callers[0].receive(), PATIENCE_S) == b"all"
    for link in (*callers, listener):
        await link.close()


async def test_a_port_in_use_is_said_and_a_closed_one_is_free() -> None:
    """Opening twice names the address and the reason; after closing it opens."""
    listener = await open_udp("127.0.0.1", 0, listen=True)
    with pytest.raises(LinkError, match=f"{listener.local_port}.*in use"):
        await open_link(listener.url)
    await listener.close()
    again = await open_link(listener.url)
    await again.close()


async def test_nobody_listening_is_no_error() -> None:
    """Datagrams to a closed port are lost, as on a radio, and the link stays usable."""
    port_holder = await open_udp("127.0.0.1", 0, listen=True)
    url = port_holder.url
    caller = await open_link(url.replace("udpin", "udpout"))
    await port_holder.close()
    await caller.send(b"lost")
    await caller.send(b"lost")
    listener = await open_link(url)
    await exchange(caller, listener)
    await caller.close()
    await listener.close()


async def test_tcp_both_ways_and_back_again() -> None:
    """A client connects anew when its server comes back; a second client takes the first one's place."""
    server = await open_tcp_server("127.0.0.1", 0)
    url = f"tcp:127.0.0.1:{server.local_port}"
    client = await open_link(url)
    await exchange(client, server)
    with pytest.raises(LinkError, match="in use"):
        await open_link(server.url)
    reading = asyncio.create_task(client.receive())
    port = server.local_port
    await server.close()
    server = await open_tcp_server("127.0.0.1", port)
    while not reading.done():
        await server.send(b"back")
        await asyncio.sleep(0.01)
    assert reading.result().startswith(b"back")
    second = await open_link(url)
    await exchange(second, server)
    for link in (second, client, server):
        await link.close()


async def test_nobody_takes_the_place_of_a_tcp_peer_that_talks() -> None:
    """A stranger's connection is closed, its bytes are not read; once the peer is gone the next may come."""
    server = await open_tcp_server("127.0.0.1", 0)
    peer = await open_link(f"tcp:127.0.0.1:{server.local_port}")
    await exchange(peer, server)
    reader, writer = await asyncio.open_connection("127.0.0.1", server.local_port)
    writer.write(b"forged")
    with contextlib.suppress(ConnectionResetError):  # its bytes were thrown away unread
        assert await asyncio.wait_for(reader.read(), PATIENCE_S) == b""
    writer.close()
    await exchange(peer, server)
    await peer.close()
    while server.peers:
        await asyncio.sleep(0.01)
    again = await open_link(f"tcp:127.0.0.1:{server.local_port}")
    await exchange(again, server)
    await again.close()
    await server.close()


async def test_a_tcp_link_closes_while_it_connects_anew() -> None:
    """Closing ends a receive that waits for the server's return."""
    server = await open_tcp_server("127.0.0.1", 0)
    client = await open_link(f"tcp:127.0.0.1:{server.local_port}")
    assert isinstance(client, TcpClientLink)
    reading = asyncio.create_task(client.receive())
    await asyncio.sleep(0)
    await server.close()
    await asyncio.sleep(0.05)
    await client.close()
    with pytest.raises(LinkError, match="closed"):
        await asyncio.wait_for(reading, PATIENCE_S)


async def test_nobody_to_connect_to_is_said() -> None:
    """The error quotes the address."""
    listener = await open_tcp_server("127.0.0.1", 0)
    url = f"tcp:127.0.0.1:{listener.local_port}"
    await listener.close()
    with pytest.raises(LinkError, match=url):
        await open_link(url)


async def test_serial_both_ways() -> None:
    """Bytes cross a pseudo-terminal; when its other side goes, receiving fails and names the device."""
    master, slave = pty.openpty()
    device = os.ttyname(slave)
    link = await open_link(f"serial:{device}:57600")
    os.close(slave)
    os.write(master, b"\xfdping")
    received = b""
    while len(received) < 5:
        received += await asyncio.wait_for(link.receive(), PATIENCE_S)
    assert received == b"\xfdping"
    await link.send(b"\xfepong")
    assert await asyncio.to_thread(os.read, master, 100) == b"\xfepong"
    os.close(master)
    with pytest.raises(LinkError, match=device):
        await asyncio.wait_for(link.receive(), PATIENCE_S)
    await link.close()


URLS = ["udpin:127.0.0.1:0", "tcpin:127.0.0.1:0", "memory"]


@pytest.mark.parametrize("url", URLS)
async def test_closing_ends_a_waiting_receive(url: str) -> None:
    """The reader gets LinkError, sending afterwards too, and closing twice is harmless."""
    link: Link = memory_pair()[0] if url == "memory" else await open_link(url)
    reading = asyncio.create_task(link.receive())
    await asyncio.sleep(0)
    await link.close()
    with pytest.raises(LinkError, match="closed"):
        await asyncio.wait_for(reading, PATIENCE_S)
    with pytest.raises(LinkError, match="closed"):
        await link.send(b"x")
    await link.close()


@pytest.mark.parametrize("url", URLS)
async def test_only_links_that_hand_over_at_once_are_direct(url: str) -> None:
    """A method of the same name for something else does not make a link direct."""
    link: Link = memory_pair()[0] if url == "memory" else await open_link(url)
    assert isinstance(link, DirectLink) == url.startswith("udp")
    await link.close()


async def test_a_direct_link_hands_over_at_once() -> None:
    """A listener gets the bytes instead of the reader, until it is taken off."""
    link = await open_udp("127.0.0.1", 0, listen=True)
    assert isinstance(link, DirectLink)
    heard: asyncio.Queue[bytes] = asyncio.Queue()
    link.listen(heard.put_nowait)
    caller = await open_udp("127.0.0.1", link.local_port, listen=False)
    caller.send_now(b"direct")
    assert await asyncio.wait_for(heard.get(), PATIENCE_S) == b"direct"
    link.listen(None)
    caller.send_now(b"queued")
    assert await asyncio.wait_for(link.receive(), PATIENCE_S) == b"queued"
    await caller.close()
    await link.close()


async def test_memory_links_misbehave_as_ordered() -> None:
    """Loss, duplication and reordering come in about the ordered share, and the seed repeats them exactly."""

    async def heard(faults: LinkFaults, seed: int) -> list[int]:
        ground, air = memory_pair(faults, seed)
        for number in range(250):
            await ground.send(bytes([number]))
        await asyncio.sleep(0.05)
        await ground.send(b"\xff")
        numbers = list(await air.receive())
        while 255 not in numbers:
            numbers += await air.receive()
        return numbers[:-1]

    assert await heard(LinkFaults(), 1) == list(range(250))
    lossy = await heard(LinkFaults(loss=0.3, duplication=0.2), 4)
    assert lossy == await heard(LinkFaults(loss=0.3, duplication=0.2), 4)
    assert 130 < len(set(lossy)) < 220
    assert len(lossy) > len(set(lossy))
    shuffled = await heard(LinkFaults(reordering=0.2), 5)
    assert sorted(shuffled) == list(range(250)) != shuffled
    assert await heard(LinkFaults(delay_s=0.01), 6) == list(range(250))


async def test_a_cut_memory_link_is_deaf_one_way() -> None:
    """What is sent while disconnected is lost."""
    ground, air = memory_pair()
    air.connected = False
    await air.send(b"lost")
    air.connected = True
    await air.send(b"heard")
    assert await ground.receive() == b"heard"


@pytest.mark.parametrize("chance", [-0.1, 1.1, float("nan")])
def test_chances_lie_between_0_and_1(chance: float) -> None:
    """Anything else is a mistake."""
    with pytest.raises(ValueError, match="chances"):
        LinkFaults(loss=chance)


async def test_a_reader_that_never_comes_does_not_fill_the_memory() -> None:
    """Beyond four megabytes the oldest bytes go, and are counted."""
    inbox = Inbox()
    for _ in range(50):
        inbox.put(bytes(100_000))
    assert inbox.dropped_bytes > 0
    assert len(await inbox.get()) + inbox.dropped_bytes == 5_000_000


async def test_a_stuck_tcp_peer_does_not_fill_the_memory() -> None:
    """What a peer that never reads cannot take is lost; no more than a bound waits for it."""
    server = await open_tcp_server("127.0.0.1", 0)
    client = await open_link(f"tcp:127.0.0.1:{server.local_port}")
    assert isinstance(client, TcpClientLink)
    async with asyncio.timeout(PATIENCE_S):
        while not server.peers:
            await asyncio.sleep(0.01)
    for _ in range(400):
        await server.send(b"\0" * 65536)
    assert 0 < server.waiting_bytes < (1 << 20) + 65536
    await client.close()
    await server.close()


@pytest.mark.parametrize("steps", range(8))
async def test_a_listener_given_up_while_it_opens_leaves_its_port(steps: int) -> None:
    """However far it had come: the port is free for the next."""
    with socket.create_server(("127.0.0.1", 0)) as probe:
        port = probe.getsockname()[1]
    opening = asyncio.create_task(open_tcp_server("127.0.0.1", port))
    for _ in range(steps):
        await asyncio.sleep(0)
    opening.cancel()
    (opened,) = await asyncio.gather(opening, return_exceptions=True)
    if isinstance(opened, TcpServerLink):
        await opened.close()
    with socket.create_server(("127.0.0.1", port)) as again:
        assert again.getsockname()[1] == port
