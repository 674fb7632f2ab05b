"""UDP: listening (every peer heard is answered) and calling."""

from __future__ import annotations

import asyncio
import socket
from collections.abc import Callable
from typing import Any, Final, cast

from mavlink.errors import LinkError
from mavlink.links.inbox import Inbox

# A thousand mission items fit into this buffer while the event loop is busy elsewhere.
_RECEIVE_BUFFER_BYTES: Final = 1 << 20
# A silent peer is forgotten, unless it is the only one: it may have restarted on another port.
_FORGET_AFTER_S: Final = 30.0
_MOST_PEERS: Final = 16

Address = tuple[Any, ...]


class UdpLink(asyncio.DatagramProtocol):
    """A datagram socket. Opened by ``open_udp``.

    A listening link answers whoever it has heard; a calling one sends to its fixed peer from the start.
    """

    def __init__(self, form: str, host: str, peer: Address | None) -> None:
        self._form = form
        self._host = host
        self._fixed_peer = peer
        self._peers: dict[Address, float] = {}
        self._inbox = Inbox()
        self._transport: asyncio.DatagramTransport | None = None
        self._lost = asyncio.Event()
        self._listener: Callable[[bytes], None] | None = None

    @property
    def url(self) -> str:
        """The address, with the port really used."""
        port = self.local_port if self._fixed_peer is None else self._fixed_peer[1]
        return f"{self._form}:{self._host}:{port}"

    @property
    def local_port(self) -> int:
        """The port bound on this machine."""
        if self._transport is None:
            raise LinkError(f"{self._form}:{self._host} is not open")
        return int(self._transport.get_extra_info("sockname")[1])

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Keep the transport (asyncio)."""
        # asyncio's own datagram transport is no subclass of DatagramTransport before Python 3.12.
        self._transport = cast(asyncio.DatagramTransport, transport)

    def datagram_received(self, data: bytes, addr: Address) -> None:
        """Take a datagram (asyncio)."""
        if self._fixed_peer is None:
            self._hear(addr)
        if self._listener is None:
            self._inbox.put(data)
        else:
            self._listener(data)

    def error_received(self, exc: Exception) -> None:
        """A peer that is not listening (asyncio): like a radio out of range, it may come back."""

    def connection_lost(self, exc: Exception | None) -> None:
        """End the reader (asyncio)."""
        self._inbox.fail(f"link closed: {exc}" if exc else "link closed")
        self._lost.set()

    def _hear(self, peer: Address) -> None:
        now_s = asyncio.get_running_loop().time()
        new = peer not in self._peers
        self._peers[peer] = now_s
        if new:
            self._peers = {
                other: heard_s for other, heard_s in self._peers.items() if now_s - heard_s < _FORGET_AFTER_S
            }
            while len(self._peers) > _MOST_PEERS:
                del self._peers[min(self._peers, key=self._peers.__getitem__)]

    def listen(self, listener: Callable[[bytes], None] | None) -> None:
        """Hand datagrams to ``listener`` the moment they arrive, not to ``receive``; None ends that.

        Saves a turn of the event loop for each, which is half the time of a transfer on a fast link.
        """
        self._listener = listener

    async def send(self, data: bytes) -> None:
        """Send to the fixed peer, or to every peer heard."""
        self.send_now(data)

    def send_now(self, data: bytes) -> None:
        """The same without waiting, which datagrams never do."""
        transport = self._transport
        if transport is None or transport.is_closing():
            raise LinkError("link closed")
        if self._fixed_peer is not None:
            transport.sendto(data, self._fixed_peer)
            return
        for peer in self._peers:
            transport.sendto(data, peer)

    async def receive(self) -> bytes:
        """Wait for datagrams."""
        return await self._inbox.get()

    async def close(self) -> None:
        """Close the socket; the port is free again on return."""
        self._inbox.fail("link closed")
        if self._transport is not None:
            self._transport.close()
            await self._lost.wait()


async def open_udp(host: str, port: int, *, listen: bool) -> UdpLink:
    """Bind (``listen``) or aim at a host and port. Raises OSError."""
    loop = asyncio.get_running_loop()
    found = await loop.getaddrinfo(host, port, type=socket.SOCK_DGRAM, proto=socket.IPPROTO_UDP)
    family, _, _, _, address = found[0]
    link = UdpLink("udpin" if listen else "udpout", host, None if listen else address)
    any_address = ("::", 0) if family == socket.AF_INET6 else ("0.0.0.0", 0)
    sock = socket.socket(family, socket.SOCK_DGRAM)
    try:
        sock.setblocking(False)
        sock.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, _RECEIVE_BUFFER_BYTES)
        sock.setsockopt(socket.SOL_SOCKET, socket.SO_BROADCAST, 1)
        sock.bind(address if listen else any_address)
        await loop.create_datagram_endpoint(lambda: link, sock=sock)
    except BaseException:
        sock.close()
        raise
    return link
