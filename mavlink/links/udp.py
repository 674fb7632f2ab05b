"""UDP: listening, and calling one peer whose answers alone are heard."""

from __future__ import annotations

import asyncio
import ipaddress
import socket
from collections.abc import Callable
from typing import Any, Final, Protocol

from mavlink.errors import LinkError
from mavlink.links.inbox import Inbox

# A thousand mission items fit into this buffer while the event loop is busy elsewhere.
_RECEIVE_BUFFER_BYTES: Final = 1 << 20
# A silent peer is forgotten, unless it is the only one: it may have restarted on another port.
_FORGET_AFTER_S: Final = 30.0
_MOST_PEERS: Final = 16
# Where there are that many, one heard within this time keeps its place.
_TALKING_S: Final = 5.0
# Datagrams of strangers thrown away in a turn of the event loop.
_MOST_AT_ONCE: Final = 64
# A MAVLink frame has at most 280 bytes, and some bridges put several into a datagram.
_MOST_BYTES: Final = 1 << 16

Address = tuple[Any, ...]


class Sieve(Protocol):
    """Says which senders on a listening port are believed."""

    @property
    def answered(self) -> tuple[Address, ...]:
        """Where alone to send to."""

    def sift(self, sender: Address, data: bytes) -> bytes:
        """What of a datagram is to be read."""


class UdpLink:
    """A datagram socket. Opened by ``open_udp``.

    A calling link sends to its fixed peer from the start, and hears that one alone. A listening one answers
    whoever it has heard, as an aircraft's does, until a sieve says who is believed.
    It reads its socket itself: asyncio's transport reserves 256 KiB for every datagram.
    """

    def __init__(self, form: str, host: str, sock: socket.socket, peer: Address | None) -> None:
        self._form = form
        self._host = host
        self._socket = sock
        self._fixed_peer = peer
        self._sieve: Sieve | None = None
        self._peers: dict[Address, float] = {}
        self._inbox = Inbox()
        self._listener: Callable[[bytes], None] | None = None
        self._loop = asyncio.get_running_loop()
        self._closed = False
        self._port = int(sock.getsockname()[1])
        self._loop.add_reader(sock, self._readable)

    @property
    def url(self) -> str:
        """The address, with the port really used."""
        port = self._port if self._fixed_peer is None else self._fixed_peer[1]
        return f"{self._form}:{self._host}:{port}"

    @property
    def local_port(self) -> int:
        """The port bound on this machine."""
        return self._port

    @property
    def peers(self) -> int:
        """How many are sent to."""
        return len(self._targets)

    @property
    def listens(self) -> bool:
        """Whether anybody may send to it."""
        return self._fixed_peer is None

    @property
    def _targets(self) -> tuple[Address, ...]:
        if self._fixed_peer is not None:
            return (self._fixed_peer,)
        if self._sieve is None:
            return tuple(self._peers)
        return self._sieve.answered

    def believe(self, sieve: Sieve) -> None:
        """Let a sieve say from now on who is heard and answered on a listening port."""
        self._sieve = sieve

    @property
    def waiting_bytes(self) -> int:
        """None: datagrams that cannot be sent at once are lost."""
        return 0

    def _readable(self) -> None:
        for _ in range(_MOST_AT_ONCE):
            if self._closed or self._take():
                return

    def _take(self) -> bool:
        """Take one datagram; False when it was a stranger's, behind whom others wait."""
        try:
            data, peer = self._socket.recvfrom(_MOST_BYTES)
        except OSError:
            return True  # a peer that is not listening (yet): like a radio out of range, it may come back
        if self._fixed_peer is not None:
            if peer[:2] != self._fixed_peer[:2]:
                return False
        elif self._sieve is not None:
            data = self._sieve.sift(peer, data)
            if not data:
                return False
        else:
            self._hear(peer)
        if self._listener is None:
            self._inbox.put(data)
        else:
            self._listener(data)
        return True

    def _hear(self, peer: Address) -> None:
        now_s = self._loop.time()
        if peer not in self._peers:
            self._peers = {
                other: heard_s for other, heard_s in self._peers.items() if now_s - heard_s < _FORGET_AFTER_S
            }
            if len(self._peers) >= _MOST_PEERS:
                oldest = min(self._peers, key=self._peers.__getitem__)
                if now_s - self._peers[oldest] < _TALKING_S:
                    return  # heard, but not answered: those that talk are not displaced
                del self._peers[oldest]
        self._peers[peer] = now_s

    def listen(self, listener: Callable[[bytes], None] | None) -> None:
        """Hand datagrams to ``listener`` the moment they arrive, not to ``receive``; None ends that.

        Saves a turn of the event loop for each, which is half the time of a transfer on a fast link.
        """
        self._listener = listener

    async def send(self, data: bytes) -> None:
        """Send to the fixed peer, to the one that is believed, or to every peer heard."""
        self.send_now(data)

    def send_now(self, data: bytes) -> None:
        """The same without waiting, which datagrams never do."""
        if self._closed:
            raise LinkError("link closed")
        for peer in self._targets:
            try:
                self._socket.sendto(data, peer)
            except OSError:
                continue  # a full buffer, or nobody listening there: lost, as on any radio

    async def receive(self) -> bytes:
        """Wait for datagrams."""
        return await self._inbox.get()

    async def close(self) -> None:
        """Close the socket; the port is free again on return."""
        if not self._closed:
            self._closed = True
            self._loop.remove_reader(self._socket)
            self._socket.close()
            self._inbox.fail("link closed")


async def open_udp(host: str, port: int, *, listen: bool) -> UdpLink:
    """Bind (``listen``) or aim at a host and port. Raises OSError."""
    loop = asyncio.get_running_loop()
    found = await loop.getaddrinfo(host, port, type=socket.SOCK_DGRAM, proto=socket.IPPROTO_UDP)
    family, _, _, _, address = found[0]
    source: tuple[str, int] = ("::", 0) if family == socket.AF_INET6 else ("0.0.0.0", 0)
    if ipaddress.ip_address(address[0]).is_loopback:
        source = (str(address[0]), 0)
    sock = socket.socket(family, socket.SOCK_DGRAM)
    try:
        sock.setblocking(False)
        sock.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, _RECEIVE_BUFFER_BYTES)
        sock.setsockopt(socket.SOL_SOCKET, socket.SO_BROADCAST, 1)
        sock.bind(address if listen else source)
    except OSError:
        sock.close()
        raise
    return UdpLink("udpin" if listen else "udpout", host, sock, None if listen else address)
