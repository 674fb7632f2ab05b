"""Byte links to a vehicle. ``mavlink.links`` holds the only sockets of the package.

Addresses: ``udpin:host:port`` listens, ``udpout:host:port`` sends first, ``tcp:host:port`` connects,
``tcpin:host:port`` accepts one peer at a time, ``serial:device:baud`` opens a serial port,
``replay:path?speedup=10`` plays a recording, to listen to alone.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final, Protocol, runtime_checkable

from mavlink.errors import AddressError, LinkError
from mavlink.links.memory import LinkFaults, MemoryLink, memory_pair
from mavlink.links.replay import ReplayLink, open_replay
from mavlink.links.serial_port import open_serial
from mavlink.links.tcp import open_tcp_client, open_tcp_server
from mavlink.links.udp import Sieve, open_udp

__all__ = [
    "FORMS",
    "DirectLink",
    "Link",
    "LinkFaults",
    "MemoryLink",
    "OpenLink",
    "PacedLink",
    "ReplayLink",
    "memory_pair",
    "open_link",
]

FORMS: Final = (
    "udpin:host:port, udpout:host:port, tcp:host:port, tcpin:host:port, serial:device:baud or replay:path"
)


class Link(Protocol):
    """Bytes to and from one peer. Datagram boundaries carry no meaning."""

    @property
    def url(self) -> str:
        """The address as given, with the port really used."""

    async def send(self, data: bytes) -> None:
        """Send; bytes are dropped, as on any radio, while no peer is there to hear them."""

    async def receive(self) -> bytes:
        """Wait for some bytes. Raises LinkError once the link is closed or has failed."""

    async def close(self) -> None:
        """Close, and end a waiting receive with LinkError; closing twice is harmless."""


@runtime_checkable
class DirectLink(Link, Protocol):
    """A link that can do without the event loop's next turn in both directions."""

    def listen(self, listener: Callable[[bytes], None] | None) -> None:
        """Hand bytes to ``listener`` the moment they arrive, not to ``receive``; None ends that."""

    def send_now(self, data: bytes) -> None:
        """Send without waiting."""


@runtime_checkable
class OpenLink(Link, Protocol):
    """A link on which strangers may speak."""

    @property
    def listens(self) -> bool:
        """Whether anybody may send to it."""

    def believe(self, sieve: Sieve) -> None:
        """Let a sieve say from now on who is heard and answered."""


@runtime_checkable
class PacedLink(Link, Protocol):
    """A link that knows what has not gone out yet."""

    @property
    def waiting_bytes(self) -> int:
        """Bytes the system has not taken yet."""


def parse_address(url: str) -> tuple[str, str, int]:
    """Form, host or device, and port or baud rate of an address other than ``replay:``.

    Raises
    ------
    AddressError
        It has none of the known forms.
    """
    form, _, rest = url.partition(":")
    address, _, last = rest.rpartition(":")
    if form not in {"udpin", "udpout", "tcp", "tcpin", "serial"} or not address or not last:
        raise AddressError(f"{url!r} is no link address; the forms are {FORMS}")
    if not last.isascii() or not last.isdigit():
        what = "baud rate" if form == "serial" else "port"
        raise AddressError(f"{url!r}: the {what} {last!r} is not a number; the forms are {FORMS}")
    number = int(last)
    if form == "serial":
        if number == 0:
            raise AddressError(f"{url!r}: a serial port needs a baud rate above 0")
        return form, address, number
    try:
        address.encode("idna")
    except UnicodeError as error:
        raise AddressError(f"{url[:80]!r}: {address[:40]!r} cannot be the name of a host") from error
    lowest = 0 if form.endswith("in") else 1
    if not lowest <= number <= 65535:
        raise AddressError(f"{url!r}: port {number} is not in {lowest} to 65535")
    return form, address, number


async def open_link(url: str) -> Link:
    """Open the link an address names.

    Raises
    ------
    AddressError
        The address has none of the known forms.
    LinkError
        The port or device cannot be opened.
    """
    if url.partition(":")[0] == "replay":
        return open_replay(url)
    form, address, number = parse_address(url)
    if form == "serial":
        return await open_serial(address, number)
    host = address.removeprefix("[").removesuffix("]")
    try:
        if form in {"udpin", "udpout"}:
            return await open_udp(host, number, listen=form == "udpin")
        if form == "tcp":
            return await open_tcp_client(host, number)
        return await open_tcp_server(host, number)
    except OSError as error:
        reason = error.strerror or str(error)
        raise LinkError(f"{url!r} cannot be opened: {reason}") from error
