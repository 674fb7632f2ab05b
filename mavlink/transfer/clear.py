"""Single questions with a single answer: clear a list, make an item the current one."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Sequence
from typing import Final

from mavlink.transfer.machine import DEFAULT_SETTINGS, Machine, Progress, TransferSettings
from mavlink.transfer.outcome import Accepted, Outcome, Refused, Unknown
from mavlink.wire.items import Command, MissionItem, MissionResult, MissionType
from mavlink.wire.messages import Message

_NAV_LAST: Final = 95  # MAV_CMD_NAV_LAST


class _QuestionMachine(Machine[Outcome]):
    """Ask, ask again, take the answer. Its one state beside the ends is waiting, so it needs no table."""

    def __init__(
        self,
        mission_type: MissionType,
        target_system: int,
        target_component: int,
        settings: TransferSettings = DEFAULT_SETTINGS,
    ) -> None:
        super().__init__(mission_type, target_system, target_component, settings)
        self._retries_left = settings.retries

    @abstractmethod
    def _question(self) -> Message: ...

    @abstractmethod
    def _verdict(self, message: Message) -> Outcome | None: ...

    @property
    def progress(self) -> Progress:
        """One question, answered or not."""
        return Progress(int(self.outcome is not None and self.outcome.kind == "accepted"), 1)

    def start(self, now_s: float) -> list[Message]:
        """Ask."""
        self.deadline_s = now_s + self.settings.timeout_s
        return [self._question()]

    def receive(self, message: Message, now_s: float) -> list[Message]:
        """Take the answer."""
        if self.deadline_s < math.inf and self._from_target(message):
            verdict = self._verdict(message)
            if verdict is not None:
                self._end(verdict)
        return []

    def tick(self, now_s: float) -> list[Message]:
        """Ask again, or give up."""
        if now_s < self.deadline_s:
            return []
        if self._retries_left == 0:
            self._end(Unknown("timeout"))
            return []
        self._retries_left -= 1
        return self.start(now_s)

    def cancel(self, now_s: float) -> list[Message]:
        """Stop waiting; the vehicle may have done it already."""
        if self.outcome is None:
            self._end(Unknown("cancelled"))
        return []


class ClearMachine(_QuestionMachine):
    """Empty one of the vehicle's lists (MISSION_CLEAR_ALL)."""

    def _question(self) -> Message:
        return self._typed("MISSION_CLEAR_ALL")

    def _verdict(self, message: Message) -> Outcome | None:
        if message.name != "MISSION_ACK" or not self._concerns(message):
            return None
        result = message.integer("type")
        return Accepted() if result == MissionResult.ACCEPTED else Refused(result)


def flown_for(items: Sequence[MissionItem], seq: int) -> frozenset[int]:
    """Numbers that a vehicle may report once it has been sent to an item.

    Only navigation items (MAV_CMD up to NAV_LAST, 95) are flown: sent to a DO item, a vehicle carries it out,
    goes on, and reports what it passes on the way to the next one to be flown. Jumps are followed both ways.

    Parameters
    ----------
    items
        The mission held, home row included.
    """
    passed: set[int] = set()
    ahead = [seq]
    while ahead:
        number = ahead.pop()
        if number in passed or not 0 <= number < len(items):
            continue
        passed.add(number)
        item = items[number]
        if item.command > _NAV_LAST:
            ahead.append(number + 1)
        if item.command == Command.DO_JUMP and math.isfinite(item.param1):
            ahead.append(int(item.param1))
    return frozenset(passed)


class SetCurrentMachine(_QuestionMachine):
    """Make an item the one flown next (MISSION_SET_CURRENT).

    The vehicle answers with MISSION_CURRENT. ArduPilot says nothing to an item past the end, so that ends
    as unknown; a MISSION_CURRENT of another number is its periodic report and no answer.

    Parameters
    ----------
    answers
        Numbers that mean yes beside that of the item itself, as ``flown_for`` tells of a known mission.

    Attributes
    ----------
    reported
        Numbers of the items the vehicle said it was flying to, since it was asked.
    """

    def __init__(
        self,
        seq: int,
        target_system: int,
        target_component: int,
        settings: TransferSettings = DEFAULT_SETTINGS,
        answers: frozenset[int] = frozenset(),
    ) -> None:
        super().__init__(MissionType.MISSION, target_system, target_component, settings)
        self.seq = seq
        self.reported: set[int] = set()
        self._answers = answers | {seq}

    def _question(self) -> Message:
        return self._addressed("MISSION_SET_CURRENT", seq=self.seq)

    def _verdict(self, message: Message) -> Outcome | None:
        if message.name == "MISSION_CURRENT":
            self.reported.add(message.integer("seq"))
            return Accepted() if self.reported & self._answers else None
        if message.name == "MISSION_ACK" and self._concerns(message):
            result = message.integer("type")
            return None if result == MissionResult.ACCEPTED else Refused(result, self.seq)
        return None
