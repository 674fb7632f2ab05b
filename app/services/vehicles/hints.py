"""What to look at when a vehicle is not reached, by the form of its address."""

from __future__ import annotations

from typing import Final

_SILENT: Final = {
    "udpin": "does it send to this port, is it switched on, and does no firewall stand between?",
    "udpout": "is that its address and port, and does it listen there?",
    "tcp": "is that an autopilot's or simulator's port, and has it started?",
    "tcpin": "has it been told to connect to this port?",
    "serial": "is the baud rate right (57600 for most radios), and the other radio switched on?",
    "sim": "the simulated aircraft did not start in time: wait longer with a larger timeout",
}
_SHUT: Final = {
    "udpin": "another program may hold the port, or the address is none of this machine's (0.0.0.0 is all of "
    "them)",
    "tcp": "nothing takes connections there: start the simulator or bridge first, and look at the port "
    "(ArduPilot's simulator: 5760)",
    "tcpin": "another program may hold the port, or the address is none of this machine's",
    "serial": "look at the cable, the device's name (/dev/ttyUSB0, /dev/ttyACM0) and the right to use it "
    "(group dialout)",
    "replay": "name a .tlog on the machine the service runs on",
}


def silent(url: str) -> str:
    """A question to ask when nothing is heard; it begins with a separator, or is empty."""
    return _after(_SILENT.get(url.partition(":")[0]))


def shut(url: str) -> str:
    """What to do when a link cannot be opened; it begins with a separator, or is empty."""
    return _after(_SHUT.get(url.partition(":")[0]))


def _after(words: str | None) -> str:
    return "" if words is None else f"; {words}"
