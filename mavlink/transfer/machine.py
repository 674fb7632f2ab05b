"""What all machines share: addressing, deadlines, and how to say what became of them.

A machine is driven from outside: ``start`` and ``cancel`` once, ``receive`` for every message, ``tick`` when
``deadline_s`` has come. Each returns the messages to send. No machine knows a socket or a clock.

Source: https://mavlink.io/en/services/mission.html (timeouts and retries).
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Generic, TypeVar

from mavlink.wire.items import MissionType
from mavlink.wire.messages import Message, Value

End = TypeVar("End")


@dataclass(frozen=True, slots=True)
class TransferSettings:
    """How patient a transfer is.

    Parameters
    ----------
    timeout_s, item_timeout_s, retries
        The protocol's recommendation: 1500 ms for opening messages, 250 ms for items, five retries.
        Waiting for an item doubles from ``item_timeout_s`` up to ``timeout_s``, so slow radios get through.
    silence_s
        In an upload the vehicle asks, and asks again (PX4 every 0.25 s, ArduPilot every 1 s; they give up
        after 5 and 8 s). Once it has been silent this long, it will not ask any more.
    acknowledgement_s
        The same, when every item has been asked for and only the last word is missing.
    most_repeats
        An item asked for this many times running is not getting through.
    """

    timeout_s: float = 1.5
    item_timeout_s: float = 0.25
    retries: int = 5
    silence_s: float = 8.0
    acknowledgement_s: float = 4.0
    most_repeats: int = 40

    def __post_init__(self) -> None:
        times = (self.timeout_s, self.item_timeout_s, self.silence_s, self.acknowledgement_s)
        if not all(0.0 < time_s < math.inf for time_s in times):
            raise ValueError(f"times must be positive and finite: {self}")
        if self.retries < 0 or self.most_repeats < 1:
            raise ValueError(f"retries must not be negative, repeats at least one: {self}")


DEFAULT_SETTINGS = TransferSettings()


@dataclass(frozen=True, slots=True)
class Progress:
    """Items the vehicle (upload) or this side (download) is known to have, of how many."""

    done: int
    total: int


class Machine(ABC, Generic[End]):
    """A transfer between this side and one vehicle.

    Attributes
    ----------
    deadline_s
        When the machine wants its next ``tick``, in the caller's clock; infinite once it has ended.
    outcome
        None while the transfer runs.
    """

    def __init__(
        self,
        mission_type: MissionType,
        target_system: int,
        target_component: int,
        settings: TransferSettings,
    ) -> None:
        self.mission_type = mission_type
        self.target_system = target_system
        self.target_component = target_component
        self.settings = settings
        self.deadline_s = math.inf
        self.outcome: End | None = None

    @property
    @abstractmethod
    def progress(self) -> Progress:
        """How far the transfer has come."""

    @property
    def likely(self) -> Message | None:
        """The message that will most likely be sent next, to be made ready meanwhile; None where none is."""
        return None

    @abstractmethod
    def start(self, now_s: float) -> list[Message]:
        """Begin; call once."""

    @abstractmethod
    def receive(self, message: Message, now_s: float) -> list[Message]:
        """Take any message; those of other senders, other types or of no concern change nothing."""

    @abstractmethod
    def tick(self, now_s: float) -> list[Message]:
        """Let time pass; nothing happens before ``deadline_s``."""

    @abstractmethod
    def cancel(self, now_s: float) -> list[Message]:
        """End as unknown, telling the vehicle where the protocol has a word for it."""

    def _end(self, outcome: End) -> None:
        self.outcome = outcome
        self.deadline_s = math.inf

    def _addressed(self, name: str, **fields: Value) -> Message:
        return Message(
            name, {"target_system": self.target_system, "target_component": self.target_component, **fields}
        )

    def _typed(self, name: str, **fields: Value) -> Message:
        return self._addressed(name, mission_type=int(self.mission_type), **fields)

    def _from_target(self, message: Message) -> bool:
        """True for the target's own messages; target component 0 stands for any of its components."""
        return message.system_id == self.target_system and self.target_component in (0, message.component_id)

    def _concerns(self, message: Message) -> bool:
        """True for the target's messages about this transfer's mission type (absent from MAVLink 1: 0)."""
        return message.fields.get("mission_type", 0) == self.mission_type and self._from_target(message)
