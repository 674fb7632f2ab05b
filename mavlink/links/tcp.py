"""TCP: connecting (again and again, should the peer go away) and accepting one peer at a time."""

from __future__ import annotations

import asyncio
import contextlib
import math
import socket
from typing import Final, cast

from mavlink.errors import LinkError
from mavlink.links.inbox import Inbox

_READ_BYTES: Final = 1 << 16
_RECONNECT_EVERY_S: Final = 1.0
#: A peer this far behind is stuck; what is sent meanwhile is lost, as on any radio.
_MOST_WAITING_BYTES: Final = 1 << 20
#: An accepted peer heard within this time talks.
_TALKING_S: Final = 5.0
#: What waits in the system's buffers grows old there and nobody knows of it: they are kept small.
_SYSTEM_BYTES: Final = 1 << 14


class TcpClientLink:
    """A connection that is made again when the peer drops it. Opened by ``open_tcp_client``."""

    def __init__(
        self, host: str, port: int, reader: asyncio.StreamReader, writer: asyncio.StreamWriter
    ) -> None:
        self._host = host
        self._port = port
        self._reader = reader
        self._writer: asyncio.StreamWriter | None = writer
        self._closed = False
        self._attempt: asyncio.Task[tuple[asyncio.StreamReader, asyncio.StreamWriter]] | None = None

    @property
    def url(self) -> str:
        """The address."""
        return f"tcp:{self._host}:{self._port}"

    async def send(self, data: bytes) -> None:
        """Write; dropped while the peer is away, or stuck."""
        self.send_now(data)

    def send_now(self, data: bytes) -> None:
        """The same without waiting."""
        if self._closed:
            raise LinkError("link closed")
        if self.peers and self._writer is not None and self.waiting_bytes < _MOST_WAITING_BYTES:
            self._writer.write(data)

    @property
    def peers(self) -> int:
        """1 while connected, else 0."""
        return int(self._writer is not None and not self._writer.is_closing())

    @property
    def waiting_bytes(self) -> int:
        """Bytes the system has not taken yet."""
        return 0 if self._writer is None else self._writer.transport.get_write_buffer_size()

    async def receive(self) -> bytes:
        """Wait for bytes, connecting anew when the peer has gone."""
        while not self._closed:
            if self._writer is None:
                await self._reconnect()
                continue
            try:
                data = await self._reader.read(_READ_BYTES)
            except OSError:
                data = b""
            if data:
                return data
            self._writer.close()
            self._writer = None
        raise LinkError("link closed")

    async def _reconnect(self) -> None:
        """Try once, a while later; a caller that stops waiting does not stop the attempt."""
        attempt = self._attempt or asyncio.create_task(self._connect_later())
        self._attempt = attempt
        await asyncio.wait({attempt})
        self._attempt = None
        if attempt.cancelled():
            return
        error = attempt.exception()
        if error is None:
            self._reader, self._writer = attempt.result()
            if self._closed:
                self._writer.close()
        elif not isinstance(error, OSError):
            raise error

    async def _connect_later(self) -> tuple[asyncio.StreamReader, asyncio.StreamWriter]:
        await asyncio.sleep(_RECONNECT_EVERY_S)
        return await _connection(self._host, self._port)

    async def close(self) -> None:
        """Close the connection and stop making it anew."""
        self._closed = True
        if self._attempt is not None:
            self._attempt.cancel()
        if self._writer is not None:
            self._writer.close()
            with contextlib.suppress(OSError):  # the peer may have reset the connection
                await self._writer.wait_closed()


async def open_tcp_client(host: str, port: int) -> TcpClientLink:
    """Connect. Raises OSError."""
    return TcpClientLink(host, port, *await _connection(host, port))


async def _connection(host: str, port: int) -> tuple[asyncio.StreamReader, asyncio.StreamWriter]:
    reader, writer = await asyncio.open_connection(host, port)
    _keep_small(writer.get_extra_info("socket"))
    return reader, writer


def _keep_small(sock: socket.socket) -> None:
    sock.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, _SYSTEM_BYTES)


class TcpServerLink:
    """A listening socket with one peer at a time. Opened by ``open_tcp_server``.

    A peer that talks stays: nobody else may take its place. One that has fallen silent, as after a break that
    the system has not noticed, makes room for whoever connects next.
    """

    def __init__(self, host: str) -> None:
        self._host = host
        self._server: asyncio.Server | None = None
        self._peer: _Peer | None = None
        self._inbox = Inbox()
        self._closed = False

    @property
    def url(self) -> str:
        """The address, with the port really used."""
        return f"tcpin:{self._host}:{self.local_port}"

    @property
    def local_port(self) -> int:
        """The port bound on this machine."""
        if self._server is None or not self._server.sockets:
            raise LinkError(f"tcpin:{self._host} is not open")
        return int(self._server.sockets[0].getsockname()[1])

    async def bind(self, port: int) -> None:
        """Bind and accept. Raises OSError."""
        loop = asyncio.get_running_loop()
        # Started by itself: cancelled while it starts, the server would be unknown and its port stay taken.
        server = await loop.create_server(lambda: _Peer(self), self._host, port, start_serving=False)
        self._server = server
        for sock in server.sockets:
            # Handed on to the connections accepted.
            sock.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, _SYSTEM_BYTES)
        try:
            await server.start_serving()
        except BaseException:
            server.close()
            raise

    def joined(self, peer: _Peer) -> None:
        """A peer has connected: it takes the place of a silent one, and is sent away where one talks."""
        if self._peer is not None:
            if asyncio.get_running_loop().time() < self._peer.heard_s + _TALKING_S:
                peer.transport.close()
                return
            self._peer.transport.close()
        self._peer = peer
        if self._closed:
            peer.transport.close()

    def left(self, peer: _Peer) -> None:
        """A peer has gone."""
        if self._peer is peer:
            self._peer = None

    def talks_with(self, peer: _Peer) -> bool:
        """Whether this is the peer: what comes of one that was sent away counts for nothing."""
        return self._peer is peer

    def take(self, data: bytes) -> None:
        """Bytes of the peer."""
        self._inbox.put(data)

    async def send(self, data: bytes) -> None:
        """Write to the peer; dropped while there is none, or it is stuck."""
        self.send_now(data)

    def send_now(self, data: bytes) -> None:
        """The same without waiting."""
        if self._closed:
            raise LinkError("link closed")
        if self.peers and self._peer is not None and self.waiting_bytes < _MOST_WAITING_BYTES:
            self._peer.transport.write(data)

    @property
    def peers(self) -> int:
        """1 while a peer is connected, else 0."""
        return int(self._peer is not None and not self._peer.transport.is_closing())

    @property
    def waiting_bytes(self) -> int:
        """Bytes the system has not taken yet."""
        return 0 if self._peer is None else self._peer.transport.get_write_buffer_size()

    async def receive(self) -> bytes:
        """Wait for bytes."""
        return await self._inbox.get()

    async def close(self) -> None:
        """Stop accepting and drop the peer."""
        self._closed = True
        if self._peer is not None:
            self._peer.transport.close()
        if self._server is not None:
            self._server.close()
            await self._server.wait_closed()
        self._inbox.fail("link closed")


class _Peer(asyncio.Protocol):
    """One accepted connection."""

    transport: asyncio.Transport

    def __init__(self, link: TcpServerLink) -> None:
        self._link = link
        self.heard_s = -math.inf

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        self.transport = cast(asyncio.Transport, transport)
        _keep_small(transport.get_extra_info("socket"))
        self._link.joined(self)

    def data_received(self, data: bytes) -> None:
        if self._link.talks_with(self):
            self.heard_s = asyncio.get_running_loop().time()
            self._link.take(data)

    def connection_lost(self, exc: Exception | None) -> None:
        self._link.left(self)


async def open_tcp_server(host: str, port: int) -> TcpServerLink:
    """Listen. Raises OSError."""
    link = TcpServerLink(host)
    await link.bind(port)
    return link
