"""One command and its acknowledgement.

Source: https://mavlink.io/en/services/command.html (COMMAND_LONG, COMMAND_ACK, MAV_RESULT).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import Final

from mavlink.transfer.machine import DEFAULT_SETTINGS, Machine, Progress, TransferSettings
from mavlink.wire.items import Command, MissionType
from mavlink.wire.messages import Message


class CommandResult(IntEnum):
    """MAV_RESULT."""

    ACCEPTED = 0
    TEMPORARILY_REJECTED = 1
    DENIED = 2
    UNSUPPORTED = 3
    FAILED = 4
    IN_PROGRESS = 5
    CANCELLED = 6
    COMMAND_LONG_ONLY = 7
    COMMAND_INT_ONLY = 8
    UNSUPPORTED_MAV_FRAME = 9
    NOT_IN_CONTROL = 10


_MEANING: Final[dict[int, str]] = {
    CommandResult.ACCEPTED: "accepted",
    CommandResult.TEMPORARILY_REJECTED: "not now: the vehicle's state does not allow it",
    CommandResult.DENIED: "denied: its parameters or the vehicle's state do not allow it",
    CommandResult.UNSUPPORTED: "the vehicle does not know this command",
    CommandResult.FAILED: "the vehicle tried and failed",
    CommandResult.IN_PROGRESS: "still in progress",
    CommandResult.CANCELLED: "cancelled",
    CommandResult.COMMAND_LONG_ONLY: "taken as COMMAND_LONG only",
    CommandResult.COMMAND_INT_ONLY: "taken as COMMAND_INT only",
    CommandResult.UNSUPPORTED_MAV_FRAME: "the frame is not supported",
    CommandResult.NOT_IN_CONTROL: "this ground station is not in control",
}


@dataclass(frozen=True, slots=True)
class CommandOutcome:
    """What became of a command.

    Parameters
    ----------
    command
        MAV_CMD.
    result
        MAV_RESULT; None when no answer came, so nobody here knows whether it was carried out.
    detail
        COMMAND_ACK.result_param2: the command's own additional code.
    """

    command: int
    result: int | None
    detail: int = 0

    @property
    def accepted(self) -> bool:
        """True when the vehicle said yes."""
        return self.result == CommandResult.ACCEPTED

    @property
    def meaning(self) -> str:
        """The result in words."""
        if self.result is None:
            return "no answer; whether it was carried out is unknown"
        return _MEANING.get(self.result, f"MAV_RESULT {self.result}")

    def __str__(self) -> str:
        known = {int(command): command.name for command in Command}
        return f"{known.get(self.command, f'command {self.command}')}: {self.meaning}"


class CommandMachine(Machine[CommandOutcome]):
    """One COMMAND_LONG with retries.

    Parameters
    ----------
    parameters
        Up to seven; the rest are 0.

    Attributes
    ----------
    percent
        Progress the vehicle reported with IN_PROGRESS, 255 when it does not say.
    """

    def __init__(
        self,
        command: int,
        parameters: Sequence[float],
        target_system: int,
        target_component: int,
        settings: TransferSettings = DEFAULT_SETTINGS,
    ) -> None:
        super().__init__(MissionType.MISSION, target_system, target_component, settings)
        if len(parameters) > 7:
            raise ValueError(f"a command has 7 parameters, got {len(parameters)}")
        self.command = command
        self.percent = 255
        self._parameters = {f"param{number}": float(value) for number, value in enumerate(parameters, 1)}
        self._confirmation = 0

    @property
    def progress(self) -> Progress:
        """One command, accepted or not."""
        return Progress(int(self.outcome is not None and self.outcome.accepted), 1)

    def start(self, now_s: float) -> list[Message]:
        """Send the command."""
        self.deadline_s = now_s + self.settings.timeout_s
        return [
            self._addressed(
                "COMMAND_LONG", command=self.command, confirmation=self._confirmation, **self._parameters
            )
        ]

    def receive(self, message: Message, now_s: float) -> list[Message]:
        """Take the acknowledgement; IN_PROGRESS only prolongs the wait."""
        if self.deadline_s == math.inf or message.name != "COMMAND_ACK" or not self._from_target(message):
            return []
        if message.integer("command") != self.command:
            return []
        result = message.integer("result")
        if result == CommandResult.IN_PROGRESS:
            self.percent = message.integer("progress")
            self._confirmation = self.settings.retries  # it is at work; sending again might start it anew
            self.deadline_s = now_s + self.settings.silence_s
        else:
            self._end(CommandOutcome(self.command, result, message.integer("result_param2")))
        return []

    def tick(self, now_s: float) -> list[Message]:
        """Send again with a higher confirmation number, or give up."""
        if now_s < self.deadline_s:
            return []
        if self._confirmation == self.settings.retries:
            self._end(CommandOutcome(self.command, None))
            return []
        self._confirmation += 1
        return self.start(now_s)

    def cancel(self, now_s: float) -> list[Message]:
        """Stop waiting; the vehicle may have carried it out already."""
        if self.outcome is None:
            self._end(CommandOutcome(self.command, None))
        return []
