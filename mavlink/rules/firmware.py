"""Versions of the autopilots' firmware: which are known here, and what each calls its parameters.

Missions are encoded with what all known versions take, so that nothing hangs on the version there.

Sources: ArduPilot "Parameter Name Changes" (4.4 to 4.7); docs/ardupilot.md and docs/px4.md have the tables.
"""

from __future__ import annotations

from collections.abc import Collection
from typing import Final

from mavlink.rules.base import OTHER_NAMES
from mavlink.state.modes import Autopilot

Version = tuple[int, int]

#: The first and the last version looked at.
KNOWN: Final[dict[Autopilot, tuple[Version, Version]]] = {
    "ardupilot": ((4, 5), (4, 7)),
    "px4": ((1, 15), (1, 17)),
}
#: Parameters that ArduPilot called by their other name before, and calls by it from this version on.
_OTHER_BEFORE: Final[dict[str, Version]] = {
    "ROLL_LIMIT_DEG": (4, 5),
    "AIRSPEED_CRUISE": (4, 5),
    "RTL_ALTITUDE": (4, 5),
    "MNT1_TYPE": (4, 3),
}
_OTHER_FROM: Final[Version] = (4, 7)


def version_of(firmware: str | None) -> Version | None:
    """Major and minor number of ``state.firmware``; None where it is not known."""
    if firmware is None:
        return None
    major, minor, *_ = firmware.split(".")
    return int(major), int(minor)


def called(names: Collection[str], autopilot: Autopilot, firmware: str | None) -> tuple[str, ...]:
    """Parameters as this firmware calls them; as the table does where its version is not known."""
    version = version_of(firmware)
    if autopilot != "ardupilot" or version is None:
        return tuple(names)
    return tuple(OTHER_NAMES[name][0] if _is_otherwise(name, version) else name for name in names)


def _is_otherwise(name: str, version: Version) -> bool:
    if name not in OTHER_NAMES:
        return False
    before = _OTHER_BEFORE.get(name)
    return version >= _OTHER_FROM if before is None else version < before


def still_to_ask(names: Collection[str], asked: Collection[str], found: Collection[str]) -> tuple[str, ...]:
    """By which other names to ask for what was answered by none."""
    pairs = [(name, OTHER_NAMES[name][0]) for name in names if name in OTHER_NAMES]
    return tuple(
        name for pair in pairs if not any(n in found for n in pair) for name in pair if name not in asked
    )


def note_on(autopilot: Autopilot, firmware: str | None) -> str | None:
    """What is to be said of a version that was not looked at; None where it was, or is nobody's."""
    known = KNOWN.get(autopilot)
    if known is None:
        return None
    first, last = (".".join(map(str, version)) for version in known)
    version = version_of(firmware)
    if version is None:
        return f"its firmware's version is not known: what {first} to {last} have in common is taken"
    if not known[0] <= version <= known[1]:
        return f"firmware {firmware} was not looked at: what {first} to {last} have in common is taken"
    return None
