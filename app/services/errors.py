"""What the services refuse, in one tree; ``app.problems`` maps each class to an HTTP status once.

::

    ServiceError
    ├── NotFoundError          no such plan, vehicle, flight, region
    ├── ConflictError          not possible in the present state
    │   ├── BusyError          another operation is at work on the same vehicle
    │   └── ChangedError       somebody else has changed it meanwhile
    ├── RefusedError           the input is wrong; carries findings
    ├── UnsafeError            the plan breaks a hard constraint, or the autopilot cannot hold it
    ├── OverloadedError        no room for more work now
    ├── StorageError           the database cannot be written or read
    ├── ClientGoneError        nobody waits for the answer any more
    ├── LinkError              the vehicle cannot be reached
    └── UndoneError            what a vehicle was told did not come about; tells more than a text
        ├── NotHeldError           it does not hold the mission that was meant
        └── CommandError           a flight command was not carried out as far as anybody can tell
            ├── CommandRefusedError    the vehicle said no, or it was not sent for a reason
            ├── CommandOvertakenError  a newer one was given before it was settled
            └── CommandUnknownError    no answer, or nothing to show for it
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from planner.errors import Finding


class ServiceError(Exception):
    """Base of all errors raised by the services; the text is meant for the client.

    They cross from worker processes whole: a class with more than a text says how it is made anew.
    """


class NotFoundError(ServiceError):
    """There is no such thing."""

    def __init__(self, kind: str, name: str) -> None:
        self.kind = kind
        self.name = name
        super().__init__(f"there is no {kind} {name}")

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.kind, self.name)


class ConflictError(ServiceError):
    """Not possible in the present state."""


class BusyError(ConflictError):
    """Another operation is at work on the same vehicle."""


class ChangedError(ConflictError):
    """Somebody else has changed it since it was read."""


class RefusedError(ServiceError):
    """The input is wrong: every finding, each naming feature, rule and fix."""

    def __init__(self, detail: str, findings: tuple[Finding, ...]) -> None:
        self.findings = findings
        super().__init__(detail)

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (str(self), self.findings)


class UnsafeError(RefusedError):
    """Sound, but not to be flown without an explicit override."""


class OverloadedError(ServiceError):
    """No room for more work now."""

    def __init__(self, detail: str, retry_after_s: int) -> None:
        self.retry_after_s = retry_after_s
        super().__init__(detail)

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (str(self), self.retry_after_s)


class StorageError(ServiceError):
    """The database, or the disk below it, cannot be written or read: nothing of the request was kept."""


class ClientGoneError(ServiceError):
    """Nobody waits for the answer any more: what was computed for it has been ended."""


class LinkError(ServiceError):
    """The vehicle cannot be reached."""


class UndoneError(ServiceError):
    """What a vehicle was told did not come about.

    Parameters
    ----------
    findings
        What stood against it, with the way out.
    members
        What else the answer tells of it, as JSON has it.
    """

    def __init__(
        self, detail: str, findings: tuple[Finding, ...] = (), members: Mapping[str, Any] | None = None
    ) -> None:
        self.findings = findings
        self.members = members or {}
        super().__init__(detail)

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (str(self), self.findings, self.members)


class NotHeldError(UndoneError):
    """A vehicle does not hold what was meant: it refused it, or what was read back is something else."""


class CommandError(UndoneError):
    """A flight command that was not carried out as far as anybody can tell."""


class CommandRefusedError(CommandError):
    """The vehicle said no, or it was not sent for a reason."""


class CommandOvertakenError(CommandError):
    """A newer one was given before it was settled."""


class CommandUnknownError(CommandError):
    """No answer, or nothing to show for it: it may have been carried out."""
