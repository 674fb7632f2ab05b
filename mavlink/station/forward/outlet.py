"""One address a vehicle's link is forwarded to: its socket, its queue, its figures."""

from __future__ import annotations

import asyncio
import contextlib
from collections import deque
from collections.abc import Callable
from contextvars import Context
from dataclasses import dataclass, fields
from typing import Final, Protocol

from mavlink.errors import LinkError
from mavlink.links.link import Link
from mavlink.links.tcp import open_tcp_client, open_tcp_server
from mavlink.links.udp import open_udp
from mavlink.station.forward.address import ForwardAddress
from mavlink.wire.codec import Codec
from mavlink.wire.messages import Message

REOPEN_S: Final = 2.0
#: What waits for a station that does not keep up; the oldest frames go first.
QUEUE_BYTES: Final = 1 << 18
#: What the system may hold of a stream's bytes before ours begin to wait.
_UNDERWAY_BYTES: Final = 1 << 16
_LOOK_AGAIN_S: Final = 0.05
_DATAGRAM_BYTES: Final = 1200
#: A flood from a station is taken in so much at a time, for others to have their turn.
_READ_BYTES: Final = 1 << 14
_MOST_STATIONS: Final = 16


class OutletLink(Link, Protocol):
    """A link that is written to without waiting."""

    @property
    def peers(self) -> int:
        """How many hear what is sent; one that is called counts, there or not."""

    @property
    def waiting_bytes(self) -> int:
        """Bytes sent that the system has not taken yet."""

    def send_now(self, data: bytes) -> None:
        """Send without waiting."""


@dataclass(slots=True)
class Figures:
    """Frames counted since the address was first forwarded to.

    Parameters
    ----------
    sent
        From the vehicle to stations.
    dropped
        Meant to be, but the station did not keep up.
    passed, refused, held_back
        From stations: on to the vehicle; not, as the forward is read-only, another vehicle is meant or two
        may hear it under one system id; not, as the lists were being exchanged from here.
    lost
        From stations: unreadable, or too many for the link to the vehicle.
    """

    sent: int = 0
    dropped: int = 0
    passed: int = 0
    refused: int = 0
    held_back: int = 0
    lost: int = 0

    def as_dict(self) -> dict[str, int]:
        """By name."""
        return {field.name: getattr(self, field.name) for field in fields(self)}


async def open_outlet(address: ForwardAddress) -> OutletLink:
    """Open the socket. Raises LinkError."""
    form, host, port = address.parts
    try:
        match form:
            case "udpin" | "udpout":
                return await open_udp(host, port, listen=form == "udpin")
            case "tcpin":
                return await open_tcp_server(host, port)
            case _:
                return await open_tcp_client(host, port)
    except OSError as error:
        raise LinkError(f"{address.url!r} cannot be opened: {error.strerror or error}") from error


class Outlet:
    """One address at work; opened anew, again and again, when it fails.

    Parameters
    ----------
    take
        Called with every readable frame that comes from a station, and its message.

    Attributes
    ----------
    failure
        Why it is not open; None while it is.
    stations
        System ids heard from.
    """

    def __init__(self, address: ForwardAddress, take: Callable[[Outlet, bytes, Message], None]) -> None:
        self.address = address
        self.figures = Figures()
        self.failure: str | None = None
        self.stations: list[int] = []
        self._take = take
        self._codec = Codec()
        self._codec.heard = self._heard
        self._link: OutletLink | None = None
        self._task: asyncio.Task[None] | None = None
        self._queue: deque[bytes] = deque()
        self._queued_bytes = 0
        self._flushing: asyncio.Handle | None = None

    @property
    def url(self) -> str:
        """The address, with the port really used."""
        return self.address.url if self._link is None else self._link.url

    @property
    def peers(self) -> int:
        """How many stations frames are sent to."""
        return 0 if self._link is None else self._link.peers

    async def open(self) -> None:
        """Open the socket now, and go on in the background; a TCP peer that is not there yet may come.

        Raises
        ------
        LinkError
            The port cannot be listened on, or the host is unknown.
        """
        try:
            self._link = await open_outlet(self.address)
        except LinkError as error:
            if self.address.listens or self.address.url.startswith("udp"):
                raise
            self.failure = str(error)
        self.start()

    def start(self) -> None:
        """Open in the background, and stay open."""
        if self._task is None:
            # What a station sends is no part of the request that asked for the forward: a context of its own.
            name = f"forward {self.address.url}"
            self._task = asyncio.create_task(self._serve(), name=name, context=Context())

    async def close(self) -> None:
        """Close the socket; what waits is dropped."""
        if self._task is not None:
            self._task.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await self._task
            self._task = None
        if self._flushing is not None:
            self._flushing.cancel()
            self._flushing = None
        self._queue.clear()
        await self._shut()

    def offer(self, frame: bytes) -> None:
        """Queue a frame of the vehicle; never waits, whatever the stations do."""
        self._queue.append(frame)
        self._queued_bytes += len(frame)
        while self._queued_bytes > QUEUE_BYTES:
            self._queued_bytes -= len(self._queue.popleft())
            self.figures.dropped += 1
        if self._flushing is None:
            # Once a turn of the loop: frames that came together go on together.
            self._flushing = asyncio.get_running_loop().call_soon(self._flush)

    def _flush(self) -> None:
        self._flushing = None
        link = self._link
        if link is None or not link.peers:
            # Nobody is there; who comes later wants to know of then, not of now.
            self._queue.clear()
            self._queued_bytes = 0
            return
        while self._queue and link.waiting_bytes < _UNDERWAY_BYTES:
            batch = bytearray(self._queue.popleft())
            count = 1
            while self._queue and len(batch) + len(self._queue[0]) <= _DATAGRAM_BYTES:
                batch += self._queue.popleft()
                count += 1
            self._queued_bytes -= len(batch)
            with contextlib.suppress(LinkError):  # the task, which reads, sees the reason
                link.send_now(bytes(batch))
                self.figures.sent += count
        if self._queue:
            loop = asyncio.get_running_loop()
            self._flushing = loop.call_later(_LOOK_AGAIN_S, self._flush)

    async def _serve(self) -> None:
        while True:
            try:
                if self._link is None:
                    if self.failure is not None:
                        await asyncio.sleep(REOPEN_S)
                    self._link = await open_outlet(self.address)
                self.failure = None
                await self._read(self._link)
            except LinkError as error:
                self.failure = str(error)
                await self._shut()

    async def _read(self, link: OutletLink) -> None:
        while True:
            data = await link.receive()
            for start in range(0, len(data), _READ_BYTES):
                bad, unknown = self._codec.bad_frames, self._codec.unknown_frames
                self._codec.feed(data[start : start + _READ_BYTES])
                self.figures.lost += self._codec.bad_frames - bad + self._codec.unknown_frames - unknown
                await asyncio.sleep(0)

    def _heard(self, frame: bytes, message: Message | None) -> None:
        if message is None:
            return  # not of the dialect: nobody here can tell what it would do
        if message.system_id not in self.stations and len(self.stations) < _MOST_STATIONS:
            self.stations.append(message.system_id)
        self._take(self, frame, message)

    async def _shut(self) -> None:
        link, self._link = self._link, None
        if link is not None:
            await link.close()
