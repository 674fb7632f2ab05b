"""Sending a list of items: we announce a count, the vehicle asks item by item and acknowledges at the end.

The vehicle drives: it asks again for what it missed. Nothing but the count is therefore sent unasked; an
unasked item draws INVALID_SEQUENCE from ArduPilot, and after the vehicle's own time-out an ERROR from
ArduPilot but ACCEPTED from PX4, so its answer would mean nothing.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from enum import Enum, auto
from typing import ClassVar, Final

from mavlink.transfer.items_wire import ITEM_REQUESTS, item_message, opaque_id_of
from mavlink.transfer.machine import DEFAULT_SETTINGS, Machine, Progress, TransferSettings
from mavlink.transfer.outcome import Accepted, Outcome, Refused, Unknown, UnknownReason
from mavlink.wire.items import MissionItem, MissionResult, MissionType
from mavlink.wire.messages import Message


class _Quick(Enum):
    """An enumeration whose members are looked up by what they are: by name takes a call of Python's."""

    __hash__ = object.__hash__


class State(_Quick):
    """Where an upload stands."""

    IDLE = auto()
    ANNOUNCED = auto()  # count sent, nothing asked for yet
    SENDING = auto()  # the vehicle is asking
    ASKED_ALL = auto()  # every item was asked for; the last word is missing
    ACCEPTED = auto()
    REFUSED = auto()
    UNKNOWN = auto()


class Event(_Quick):
    """What can happen to an upload."""

    START = auto()
    ASKS = auto()  # asks for an item while others were never asked for
    ASKS_LAST = auto()  # asks for an item, and with it every item was asked for
    ACCEPTS = auto()  # ACCEPTED, and every item was asked for
    ACCEPTS_EARLY = auto()  # ACCEPTED, though some item was never asked for
    COMPLAINS = auto()  # ArduPilot's word on a duplicate (INVALID_SEQUENCE), while it goes on
    ERRS_AT_END = auto()  # ERROR when every item was asked for: also ArduPilot's word on a late duplicate
    REFUSES = auto()  # any other result
    TIMEOUT = auto()  # time to announce again
    GIVES_UP = auto()  # no retry left, silence too long, or the same item over and over
    CANCEL = auto()


TRANSITIONS: Final[dict[tuple[State, Event], State]] = {
    (State.IDLE, Event.START): State.ANNOUNCED,
    (State.ANNOUNCED, Event.ASKS): State.SENDING,
    (State.ANNOUNCED, Event.ASKS_LAST): State.ASKED_ALL,
    (State.ANNOUNCED, Event.ACCEPTS): State.ACCEPTED,  # an empty list: nothing to ask for
    (State.ANNOUNCED, Event.ACCEPTS_EARLY): State.ANNOUNCED,
    (State.ANNOUNCED, Event.COMPLAINS): State.ANNOUNCED,
    (State.ANNOUNCED, Event.REFUSES): State.REFUSED,
    (State.ANNOUNCED, Event.TIMEOUT): State.ANNOUNCED,
    (State.ANNOUNCED, Event.GIVES_UP): State.UNKNOWN,
    (State.ANNOUNCED, Event.CANCEL): State.UNKNOWN,
    (State.SENDING, Event.ASKS): State.SENDING,
    (State.SENDING, Event.ASKS_LAST): State.ASKED_ALL,
    (State.SENDING, Event.ACCEPTS_EARLY): State.SENDING,
    (State.SENDING, Event.COMPLAINS): State.SENDING,
    (State.SENDING, Event.REFUSES): State.REFUSED,
    (State.SENDING, Event.GIVES_UP): State.UNKNOWN,
    (State.SENDING, Event.CANCEL): State.UNKNOWN,
    (State.ASKED_ALL, Event.ASKS_LAST): State.ASKED_ALL,
    (State.ASKED_ALL, Event.ACCEPTS): State.ACCEPTED,
    (State.ASKED_ALL, Event.COMPLAINS): State.ASKED_ALL,
    (State.ASKED_ALL, Event.ERRS_AT_END): State.UNKNOWN,
    (State.ASKED_ALL, Event.REFUSES): State.REFUSED,
    (State.ASKED_ALL, Event.GIVES_UP): State.UNKNOWN,
    (State.ASKED_ALL, Event.CANCEL): State.UNKNOWN,
    # A repeated count still on its way makes the vehicle ask again after it has accepted.
    (State.ACCEPTED, Event.ASKS_LAST): State.ACCEPTED,
}


class UploadMachine(Machine[Outcome]):
    """One upload.

    Parameters
    ----------
    items
        Numbered 0, 1, 2 … and all of ``mission_type``.

    Attributes
    ----------
    opaque_id
        The vehicle's id of the new list (MISSION_ACK), once it has accepted; None where it gives none.

    Raises
    ------
    ValueError
        The items are not numbered so, are of another type, or are more than the wire can count.
    """

    #: The most that can be announced.
    most: ClassVar[int] = 0xFFFF
    #: Answers a vehicle may give to a duplicate while the upload goes on: final only when silence follows.
    _complaints: ClassVar[frozenset[int]] = frozenset({MissionResult.INVALID_SEQUENCE})

    def __init__(
        self,
        items: Sequence[MissionItem],
        mission_type: MissionType,
        target_system: int,
        target_component: int,
        settings: TransferSettings = DEFAULT_SETTINGS,
        first: int = 0,
    ) -> None:
        super().__init__(mission_type, target_system, target_component, settings)
        for seq, item in enumerate(items, first):
            if item.seq != seq or item.mission_type != mission_type:
                raise ValueError(f"item {seq} is numbered {item.seq} and of type {item.mission_type.name}")
            if mission_type is MissionType.FENCE and math.isnan(item.param1):
                raise ValueError(f"fence item {seq} has no number in param1, which crashes autopilots")
        if first + len(items) > self.most:
            raise ValueError(f"{first + len(items)} items; the protocol counts to {self.most}")
        self.items = tuple(items)
        self.state = State.IDLE
        self.opaque_id: int | None = None
        self._first = first
        self._never_asked = set(range(first, first + len(items)))
        self._reached = 0
        self._last_asked: int | None = None
        self._ahead: tuple[int, Message] | None = None
        self._repeats = 0
        self._retries_left = settings.retries
        self._accepted_early = False
        self._complained: int | None = None

    @property
    def progress(self) -> Progress:
        """Asking for item n, the vehicle shows that it has the n before it."""
        done = len(self.items) if self.state is State.ACCEPTED else self._reached
        return Progress(done, len(self.items))

    def start(self, now_s: float) -> list[Message]:
        """Announce the count."""
        self._move(Event.START)
        self.deadline_s = now_s + self.settings.timeout_s
        return [self._announcement()]

    def receive(self, message: Message, now_s: float) -> list[Message]:
        """Answer requests; take acknowledgements."""
        if not self._concerns(message):
            return []
        if message.name in ITEM_REQUESTS:
            return self._answer(message.integer("seq"), now_s)
        if message.name == "MISSION_ACK":
            self._acknowledge(message.integer("type"), opaque_id_of(message))
        return []

    def tick(self, now_s: float) -> list[Message]:
        """Announce again while nothing was asked for; else give up on a silent vehicle."""
        if now_s < self.deadline_s:
            return []
        if self.state is State.ANNOUNCED and self._retries_left > 0:
            self._retries_left -= 1
            self._move(Event.TIMEOUT)
            self.deadline_s = now_s + self.settings.timeout_s
            return [self._announcement()]
        self._give_up()
        return []

    def cancel(self, now_s: float) -> list[Message]:
        """End as unknown and tell the vehicle, which may keep part of the list."""
        if (self.state, Event.CANCEL) not in TRANSITIONS:
            return []
        self._move(Event.CANCEL)
        self._end_unknown("cancelled")
        return [self._typed("MISSION_ACK", type=int(MissionResult.OPERATION_CANCELLED))]

    def _answer(self, seq: int, now_s: float) -> list[Message]:
        if not 0 <= seq - self._first < len(self.items):
            return []
        left = len(self._never_asked) - (seq in self._never_asked)
        if not self._move(Event.ASKS if left else Event.ASKS_LAST):
            return []
        self._never_asked.discard(seq)
        if self.state is not State.ACCEPTED:
            self._reached = max(self._reached, seq - self._first)
            self._complained = None
            self._repeats = self._repeats + 1 if seq == self._last_asked else 0
            self._last_asked = seq
            if self._repeats >= self.settings.most_repeats:
                self._give_up()
                return []
            self._wait_for_vehicle(now_s)
        return [self._item(seq)]

    @property
    def likely(self) -> Message | None:
        """The item after the one asked for last: vehicles ask in order."""
        seq = self._first if self._last_asked is None else self._last_asked + 1
        if not 0 <= seq - self._first < len(self.items):
            return None
        self._ahead = seq, self._item(seq)
        return self._ahead[1]

    def _item(self, seq: int) -> Message:
        """The same message again, where it is the one made ahead."""
        if self._ahead is not None and self._ahead[0] == seq:
            return self._ahead[1]
        return item_message(self.items[seq - self._first], self.target_system, self.target_component)

    def _acknowledge(self, result: int, opaque_id: int | None) -> None:
        if result == MissionResult.ACCEPTED:
            early = bool(self._never_asked)
            if self._move(Event.ACCEPTS_EARLY if early else Event.ACCEPTS):
                if early:
                    self._accepted_early = True
                else:
                    self.opaque_id = opaque_id
                    self._end(Accepted())
        elif result in self._complaints:
            if self._move(Event.COMPLAINS):
                self._complained = result
        elif result == MissionResult.ERROR and self._move(Event.ERRS_AT_END):
            self._end_unknown("error-at-end")
        elif self._move(Event.REFUSES):
            self._end(Refused(result, self._last_asked))

    def _wait_for_vehicle(self, now_s: float) -> None:
        settings = self.settings
        asked_all = self.state is State.ASKED_ALL
        self.deadline_s = now_s + (settings.acknowledgement_s if asked_all else settings.silence_s)

    def _give_up(self) -> None:
        asked_all = self.state is State.ASKED_ALL
        if not self._move(Event.GIVES_UP):
            return
        if asked_all:
            self._end_unknown("lost-acknowledgement")
        elif self._accepted_early:
            self._end_unknown("early-acceptance")
        elif self._complained is not None:
            # It complained, never asked again and lacks items: that was its last word.
            self.state = State.REFUSED
            self._end(Refused(self._complained, self._last_asked))
        else:
            self._end_unknown("timeout")

    def _end_unknown(self, reason: UnknownReason) -> None:
        self._end(Unknown(reason, self._last_asked))

    def _move(self, event: Event) -> bool:
        """Follow the table; False, and nothing changed, where it has no entry."""
        following = TRANSITIONS.get((self.state, event))
        if following is None:
            return False
        self.state = following
        return True

    def _announcement(self) -> Message:
        return self._typed("MISSION_COUNT", count=len(self.items))
