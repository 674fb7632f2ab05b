"""All addresses one vehicle's link is forwarded to, joined with the link there is at the moment."""

from __future__ import annotations

import asyncio
import contextlib
import time
from collections.abc import Callable, Iterator, Sequence
from typing import Protocol

from mavlink.errors import LinkError
from mavlink.state.telemetry import VehicleState
from mavlink.station.forward.address import ForwardAddress
from mavlink.station.forward.guard import Guard, Verdict
from mavlink.station.forward.outlet import Outlet
from mavlink.wire.messages import Message


class Carrier(Protocol):
    """The link to the vehicle, as far as forwarding needs it."""

    state: VehicleState

    @property
    def read_only(self) -> bool:
        """Whether nobody hears what is sent."""

    def pass_on(self, frame: bytes) -> bool:
        """Send a frame as it is; False when the link does not keep up."""


class Forwards:
    """Forwards of one vehicle; they outlive its link, which may be opened anew.

    Parameters
    ----------
    passed
        Called with every frame of a station that goes on to the vehicle.
    clock
        Seconds; only differences matter.

    Notes
    -----
    Hand it to ``VehicleClient``; the client joins and leaves by itself.
    """

    def __init__(
        self,
        passed: Callable[[Outlet, Message], None] | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._passed = passed
        self._clock = clock
        self._guard = Guard()
        self._outlets: dict[str, Outlet] = {}
        self._carrier: Carrier | None = None
        self._turn = asyncio.Lock()
        self._closed = False

    @property
    def outlets(self) -> tuple[Outlet, ...]:
        """One for each address, in the order given."""
        return tuple(self._outlets.values())

    @property
    def shared(self) -> bool:
        """Whether the stations here may speak to another aircraft of the vehicle's system id as well."""
        return self._guard.shared

    @shared.setter
    def shared(self, value: bool) -> None:
        self._guard.shared = value

    @property
    def exchanging(self) -> int | None:
        """The system id of a station that is exchanging a list with the vehicle; None when none is."""
        return self._guard.exchanging(self._clock())

    @property
    def changing(self) -> int | None:
        """The same of one that changes a list."""
        return self._guard.exchanging(self._clock(), changes=True)

    async def set(self, addresses: Sequence[ForwardAddress]) -> None:
        """Forward to these and no others; those there already stay open.

        Raises
        ------
        LinkError
            One cannot be opened, or all are closed: all is as before.
        """
        async with self._turn:
            await self._set(addresses)

    async def _set(self, addresses: Sequence[ForwardAddress]) -> None:
        if self._closed:
            raise LinkError("the forwards are closed")
        new = {a.url: Outlet(a, self._take) for a in addresses if a.url not in self._outlets}
        try:
            for outlet in new.values():
                await outlet.open()
        except BaseException:
            for outlet in new.values():
                await outlet.close()
            raise
        old, self._outlets = self._outlets, {}
        for address in addresses:
            outlet = new.get(address.url) or old.pop(address.url, None) or self._outlets[address.url]
            outlet.address = address
            self._outlets[address.url] = outlet
        for outlet in old.values():
            await outlet.close()

    def begin(self, addresses: Sequence[ForwardAddress]) -> None:
        """Forward to these as soon as they can be opened, tried again and again."""
        for address in addresses:
            if address.url not in self._outlets:
                self._outlets[address.url] = outlet = Outlet(address, self._take)
                outlet.start()

    async def close(self) -> None:
        """Close every address for good; closing twice is harmless."""
        self._closed = True
        async with self._turn:
            outlets, self._outlets = self._outlets, {}
            for outlet in outlets.values():
                await outlet.close()

    def join(self, carrier: Carrier) -> None:
        """Forward this link from now on."""
        self._carrier = carrier

    def leave(self, carrier: Carrier) -> None:
        """Forward it no more."""
        if self._carrier is carrier:
            self._carrier = None

    def heard(self, frame: bytes, message: Message | None) -> None:
        """Take a frame of the vehicle; one of a message not known here may be known to a station."""
        if message is not None:
            self._guard.heard(message, self._clock())
        for outlet in self._outlets.values():
            outlet.offer(frame)

    @contextlib.contextmanager
    def reserved(self, *, changes: bool) -> Iterator[None]:
        """Keep the vehicle's lists to this station; raises BusyError while another is at work on them."""
        self._guard.reserve(self._clock(), changes=changes)
        try:
            yield
        finally:
            self._guard.release(changes=changes)

    def _take(self, outlet: Outlet, frame: bytes, message: Message) -> None:
        carrier, figures = self._carrier, outlet.figures
        write = outlet.address.write and carrier is not None and not carrier.read_only
        state = VehicleState() if carrier is None else carrier.state
        match self._guard.judge(message, state, write, self._clock()):
            case Verdict.REFUSED:
                figures.refused += 1
            case Verdict.HELD_BACK:
                figures.held_back += 1
            case Verdict.PASSED:
                assert carrier is not None
                if not carrier.pass_on(frame):
                    figures.lost += 1
                    return
                figures.passed += 1
                if self._passed is not None:
                    self._passed(outlet, message)
