"""Everything the MAVLink side refuses, in one tree.

::

    MavlinkError
    ├── CodecError           a message cannot be put on the wire: unknown name or field, value out of range
    ├── LinkError            a port or device cannot be opened or has failed
    │   └── AddressError     an address is malformed: no other try will open it
    ├── VehicleNotFoundError no autopilot's heartbeat arrived in time
    ├── NotConnectedError    asked of a vehicle that is not connected, or whose client is closed
    │   └── ReadOnlyError    a transfer or command asked of a recording that is being replayed
    ├── UnsupportedError     asked of an autopilot that does not do it; nothing was sent
    ├── DoubtError           it is doubted who would hear: the vehicle meant, and it alone; nothing was sent
    ├── SigningError         the vehicle has not taken a key, or goes on signing
    ├── BusyError            another transfer with this vehicle is under way
    └── TransferFailedError  a download ended without all items; carries the outcome

Outcomes of uploads and commands are values, not exceptions: refused and unknown are answers.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mavlink.transfer.outcome import Outcome


class MavlinkError(Exception):
    """Base of all errors raised by the MAVLink side."""


class CodecError(MavlinkError, ValueError):
    """A message cannot be put on the wire."""


class LinkError(MavlinkError, ValueError):
    """A port or device cannot be opened or has failed."""


class AddressError(LinkError):
    """An address is malformed: no other try will open it."""


class VehicleNotFoundError(MavlinkError):
    """No autopilot's heartbeat arrived in time."""


class NotConnectedError(MavlinkError):
    """The vehicle is not connected, or the client is closed."""


class ReadOnlyError(NotConnectedError):
    """The vehicle is a recording that is being replayed: nobody is there to answer."""


class UnsupportedError(MavlinkError):
    """The vehicle's autopilot does not do what was asked; nothing was sent."""


class DoubtError(MavlinkError):
    """It is not certain that the vehicle meant would hear, and it alone."""

    def __init__(self, rule: str, message: str, fix: str) -> None:
        self.rule, self.message, self.fix = rule, message, fix
        super().__init__(f"{message}: {fix}")


class SigningError(MavlinkError):
    """The vehicle has not taken a key, or goes on signing; all is as before."""


class BusyError(MavlinkError):
    """Another transfer with this vehicle is under way; one at a time is all the protocol allows."""


class TransferFailedError(MavlinkError):
    """A transfer that has no partial answer (a download) ended without one."""

    def __init__(self, what: str, outcome: Outcome) -> None:
        self.outcome = outcome
        super().__init__(f"{what}: {outcome}")
