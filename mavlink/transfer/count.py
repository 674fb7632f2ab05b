"""Asking how many items a list has, and under which id, without reading it."""

from __future__ import annotations

from mavlink.transfer.items_wire import opaque_id_of
from mavlink.transfer.machine import DEFAULT_SETTINGS, Machine, Progress, TransferSettings
from mavlink.transfer.outcome import Accepted, Outcome, Refused, Unknown
from mavlink.wire.items import MissionResult, MissionType
from mavlink.wire.messages import Message


class CountMachine(Machine[Outcome]):
    """One question for a count. The vehicle is told that its items are not asked for: PX4 would wait for it.

    Attributes
    ----------
    count, opaque_id
        Once accepted: the number of items, and the vehicle's id of the list; None where it gives none.
    """

    def __init__(
        self,
        mission_type: MissionType,
        target_system: int,
        target_component: int,
        settings: TransferSettings = DEFAULT_SETTINGS,
    ) -> None:
        super().__init__(mission_type, target_system, target_component, settings)
        self.count = 0
        self.opaque_id: int | None = None
        self._tries = 0

    @property
    def progress(self) -> Progress:
        """One question, answered or not."""
        return Progress(int(self.outcome is not None and self.outcome.kind == "accepted"), 1)

    def start(self, now_s: float) -> list[Message]:
        """Ask."""
        self._tries += 1
        self.deadline_s = now_s + self.settings.timeout_s
        return [self._typed("MISSION_REQUEST_LIST")]

    def receive(self, message: Message, now_s: float) -> list[Message]:
        """Take the count, or a refusal."""
        if self.outcome is not None or not self._tries or not self._concerns(message):
            return []
        if message.name == "MISSION_COUNT":
            self.count, self.opaque_id = message.integer("count"), opaque_id_of(message)
            self._end(Accepted())
            # An empty list is acknowledged as read; of another the reading is called off.
            result = MissionResult.OPERATION_CANCELLED if self.count else MissionResult.ACCEPTED
            return [self._typed("MISSION_ACK", type=int(result))]
        if message.name == "MISSION_ACK" and message.integer("type") != MissionResult.ACCEPTED:
            self._end(Refused(message.integer("type"), None))
        return []

    def tick(self, now_s: float) -> list[Message]:
        """Ask again, or give up."""
        if now_s < self.deadline_s:
            return []
        if self._tries <= self.settings.retries:
            return self.start(now_s)
        self._end(Unknown("timeout"))
        return []

    def cancel(self, now_s: float) -> list[Message]:
        """End as unknown; nothing is under way that the vehicle would wait for."""
        if self.outcome is None:
            self._end(Unknown("cancelled"))
        return []
