"""Where a vehicle's link is forwarded to: ``udpout:host:port`` to watch, or to command too."""

from __future__ import annotations

import ipaddress
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Final

from mavlink.errors import AddressError
from mavlink.links.link import parse_address

LOOPBACK: Final = "127.0.0.1"
FORMS: Final = (
    "udpout:host:port, udpin:host:port, tcpin:host:port or tcp:host:port; without a host it is 127.0.0.1"
)

_CALLING: Final = {"udpout": "udp", "tcp": "tcp"}
_LISTENING: Final = {"udpin": "udp", "tcpin": "tcp"}
_EVERYWHERE: Final = frozenset({"0.0.0.0", "::"})


@dataclass(frozen=True, slots=True)
class ForwardAddress:
    """One address to forward to.

    Parameters
    ----------
    url
        As ``parse_forward`` gives it, with a host.
    write
        Whether stations there may command the vehicle; else they only watch.
    """

    url: str
    write: bool = False

    @property
    def listens(self) -> bool:
        """Whether stations call this address, or it calls them."""
        return self.url.partition(":")[0] in _LISTENING

    @property
    def parts(self) -> tuple[str, str, int]:
        """Form, host and port."""
        form, host, port = parse_address(self.url)
        return form, host.removeprefix("[").removesuffix("]"), port


def parse_forward(url: str, *, write: bool = False) -> ForwardAddress:
    """An address to forward to; without a host it is on this machine alone.

    Raises
    ------
    AddressError
        It is none, or of a form that is not forwarded to.
    """
    form, _, rest = url.partition(":")
    if form not in _CALLING and form not in _LISTENING:
        raise AddressError(f"{url[:80]!r} is no address to forward to; the forms are {FORMS}")
    if ":" not in rest:
        rest = f"{LOOPBACK}:{rest}"
    elif rest.startswith(":"):
        rest = LOOPBACK + rest
    normal = f"{form}:{rest}"
    parse_address(normal)
    return ForwardAddress(normal, write)


def looped(vehicles: Iterable[str], forwards: Iterable[ForwardAddress]) -> tuple[str, str] | None:
    """Two addresses of one service that would talk to each other, at least one of them a forward's.

    Frames would go round between them for ever.

    Parameters
    ----------
    vehicles
        Addresses of the vehicles' links; those that are no sockets do no harm.
    """
    outlets = [forward.url for forward in forwards]
    every = [*_sockets(vehicles), *_sockets(outlets)]
    own = set(outlets)
    for url, kind, host, port, calls in every:
        for other, other_kind, other_host, other_port, other_calls in every:
            met = calls and not other_calls and (kind, port) == (other_kind, other_port)
            here = _is_local(host) or host == other_host
            if met and here and (url in own or other in own):
                return url, other
    return None


def _sockets(urls: Iterable[str]) -> Iterator[tuple[str, str, str, int, bool]]:
    for url in urls:
        form = url.partition(":")[0]
        kind = _CALLING.get(form) or _LISTENING.get(form)
        if kind is not None:
            try:
                _, host, port = parse_address(url)
            except AddressError:
                continue  # it will not be opened
            yield url, kind, host.removeprefix("[").removesuffix("]"), port, form in _CALLING


def _is_local(host: str) -> bool:
    """Whether a host name or address means this machine."""
    if host in _EVERYWHERE or host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False
