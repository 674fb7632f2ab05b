"""Which links requests may open: kinds, hosts, serial ports, recordings; whoever runs the service says."""

from __future__ import annotations

import contextlib
import fnmatch
import ipaddress
import os
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Final, NoReturn

from app.hosts import is_loopback
from app.services.errors import RefusedError
from mavlink.errors import AddressError
from mavlink.links.link import parse_address
from mavlink.links.recording import SUFFIX
from mavlink.links.replay import parse_replay
from mavlink.station.forward.address import parse_forward
from planner.errors import Finding

KINDS: Final = ("udpin", "udpout", "tcp", "tcpin", "serial", "sim", "replay")
_CALLING: Final = {"udpout", "tcp"}
_LISTENING: Final = {"udpin", "tcpin"}


@dataclass(frozen=True, slots=True)
class Permits:
    """What links may be opened for a request; this machine alone where nothing else is said.

    Parameters
    ----------
    kinds
        Forms of addresses.
    hosts
        Names, addresses and networks, beyond this machine, that may be called.
    serial_ports
        Paths of devices, with ``*`` for anything but a slash.
    replay_folders
        Where recordings to be watched lie; none: anywhere, if they are called .tlog.
    remote
        Whether links may listen beyond this machine.
    """

    kinds: tuple[str, ...] = KINDS
    hosts: tuple[str, ...] = ()
    serial_ports: tuple[str, ...] = ()
    replay_folders: tuple[Path, ...] = ()
    remote: bool = False

    def require(self, url: str, member: str = "url") -> None:
        """Raise RefusedError (rule ``link-not-allowed``) for an address that may not be opened.

        One that is no address is left to whoever opens it.
        """
        kind = url.partition(":")[0]
        if kind in KINDS and kind not in self.kinds:
            _refuse(member, f"links of the kind {kind} are not allowed", "SWATHPLAN_LINK_KINDS", kind)
        try:
            if kind == "replay":
                self._require_recording(parse_replay(url)[0], member)
            elif kind != "sim":
                self._require_place(*parse_address(url)[:2], member)
        except AddressError:
            return

    def require_forwards(self, urls: Iterable[str]) -> None:
        """The same for addresses to forward to, which without a host are on this machine."""
        for url in urls:
            with contextlib.suppress(AddressError):
                self.require(parse_forward(url).url, "forward")

    def _require_place(self, kind: str, place: str, member: str) -> None:
        if kind == "serial":
            port = os.path.normpath(place)
            if not any(_matches(port, pattern) for pattern in self.serial_ports):
                message = f"the serial port {place} is none of those that may be opened"
                _refuse(member, message, "SWATHPLAN_SERIAL_PORTS", port)
            return
        host = place.removeprefix("[").removesuffix("]").lower()
        if is_loopback(host):
            return
        if kind in _LISTENING and not self.remote:
            message = (
                f"{kind} on {host} can be reached from other machines, and whoever reaches it is taken for "
                "the vehicle; 127.0.0.1 is this machine alone"
            )
            _refuse(member, message, "SWATHPLAN_ALLOW_REMOTE", "true")
        if kind in _CALLING and not any(_within(host, allowed) for allowed in self.hosts):
            message = f"{host} is none of the hosts that may be called"
            _refuse(member, message, "SWATHPLAN_LINK_HOSTS", host)

    def _require_recording(self, path: str | Path, member: str) -> None:
        place = Path(path).resolve()
        if place.suffix.lower() != SUFFIX:
            message = f"{path} is no recording by its name"
            finding = Finding(member, "link-not-allowed", message, f"name a file that ends in {SUFFIX}")
            raise RefusedError(message, (finding,))
        if self.replay_folders and not any(
            place.is_relative_to(folder.resolve()) for folder in self.replay_folders
        ):
            message = f"{path} is in none of the folders whose recordings may be watched"
            _refuse(member, message, "SWATHPLAN_REPLAY_FOLDERS", str(place.parent))


def _within(host: str, allowed: str) -> bool:
    if host == allowed.lower():
        return True
    try:
        return ipaddress.ip_address(host) in ipaddress.ip_network(allowed)
    except ValueError:
        return False


def _matches(path: str, pattern: str) -> bool:
    """Whether a path is one of a pattern's; part by part, as ``*`` is to stay in its folder."""
    parts, patterns = path.split("/"), pattern.split("/")
    return len(parts) == len(patterns) and all(map(fnmatch.fnmatchcase, parts, patterns))


def _refuse(member: str, message: str, setting: str, value: str) -> NoReturn:
    fix = f"whoever runs the service allows it with {setting}={value}, and it may be given to serve --vehicle"
    raise RefusedError(message, (Finding(member, "link-not-allowed", message, fix),))
