"""Reading back a list of items: we ask for the count, then item by item in order, and acknowledge at the end.

PX4 never repeats anything in a download and refuses the next upload when the last acknowledgement is
missing, so every repetition is ours, and late duplicates of the last item are acknowledged again.
"""

from __future__ import annotations

from enum import Enum, auto
from typing import Final

from mavlink.transfer.items_wire import ITEM_NAMES, message_item, opaque_id_of
from mavlink.transfer.machine import DEFAULT_SETTINGS, Machine, Progress, TransferSettings
from mavlink.transfer.outcome import Accepted, Outcome, Refused, Unknown
from mavlink.wire.items import MissionItem, MissionResult, MissionType
from mavlink.wire.messages import Message


class State(Enum):
    """Where a download stands."""

    IDLE = auto()
    LISTING = auto()  # asked for the count
    FETCHING = auto()  # asking for items
    COMPLETE = auto()
    REFUSED = auto()
    UNKNOWN = auto()


class Event(Enum):
    """What can happen to a download."""

    START = auto()
    COUNTED = auto()  # a count above 0
    EMPTY = auto()  # a count of 0
    ITEM = auto()  # the item asked for, others still missing
    LAST_ITEM = auto()  # the item asked for, and the last
    REPEATED = auto()  # something already received
    REFUSES = auto()  # an acknowledgement other than ACCEPTED
    TIMEOUT = auto()  # time to ask again
    GIVES_UP = auto()  # no retry left
    CANCEL = auto()


TRANSITIONS: Final[dict[tuple[State, Event], State]] = {
    (State.IDLE, Event.START): State.LISTING,
    (State.LISTING, Event.COUNTED): State.FETCHING,
    (State.LISTING, Event.EMPTY): State.COMPLETE,
    (State.LISTING, Event.REFUSES): State.REFUSED,
    (State.LISTING, Event.TIMEOUT): State.LISTING,
    (State.LISTING, Event.GIVES_UP): State.UNKNOWN,
    (State.LISTING, Event.CANCEL): State.UNKNOWN,
    (State.FETCHING, Event.COUNTED): State.FETCHING,  # another count or id: the list changed, begin again
    (State.FETCHING, Event.EMPTY): State.COMPLETE,
    (State.FETCHING, Event.ITEM): State.FETCHING,
    (State.FETCHING, Event.LAST_ITEM): State.COMPLETE,
    (State.FETCHING, Event.REPEATED): State.FETCHING,
    (State.FETCHING, Event.REFUSES): State.REFUSED,
    (State.FETCHING, Event.TIMEOUT): State.FETCHING,
    (State.FETCHING, Event.GIVES_UP): State.UNKNOWN,
    (State.FETCHING, Event.CANCEL): State.UNKNOWN,
    (State.COMPLETE, Event.REPEATED): State.COMPLETE,
}


class DownloadMachine(Machine[Outcome]):
    """One download; ``items`` is what the vehicle holds once the outcome is accepted.

    Attributes
    ----------
    opaque_id
        The vehicle's id of the list (MISSION_COUNT); None where it gives none.
    """

    def __init__(
        self,
        mission_type: MissionType,
        target_system: int,
        target_component: int,
        settings: TransferSettings = DEFAULT_SETTINGS,
    ) -> None:
        super().__init__(mission_type, target_system, target_component, settings)
        self.state = State.IDLE
        self.opaque_id: int | None = None
        self._items: list[MissionItem] = []
        self._total: int | None = None
        self._tries = 0

    @property
    def items(self) -> tuple[MissionItem, ...]:
        """Received so far, in order from 0."""
        return tuple(self._items)

    @property
    def progress(self) -> Progress:
        """Items received of items counted."""
        return Progress(len(self._items), self._total or 0)

    def start(self, now_s: float) -> list[Message]:
        """Ask for the count."""
        self._move(Event.START)
        return self._ask(now_s, first=True)

    def receive(self, message: Message, now_s: float) -> list[Message]:
        """Take the count and the items."""
        if not self._concerns(message):
            return []
        if message.name == "MISSION_COUNT":
            return self._take_count(message.integer("count"), opaque_id_of(message), now_s)
        if message.name in ITEM_NAMES:
            return self._take_item(message, now_s)
        if message.name == "MISSION_ACK":
            result = message.integer("type")
            if result != MissionResult.ACCEPTED and self._move(Event.REFUSES):
                self._end(Refused(result, self._wanted()))
        return []

    def tick(self, now_s: float) -> list[Message]:
        """Ask again, or give up and say so."""
        if now_s < self.deadline_s:
            return []
        if self._tries <= self.settings.retries:
            self._move(Event.TIMEOUT)
            return self._ask(now_s, first=False)
        if self._move(Event.GIVES_UP):
            self._end(Unknown("timeout", self._wanted()))
            # PX4 goes on with what nobody wants any more, and refuses another list meanwhile.
            return [self._acknowledgement(MissionResult.OPERATION_CANCELLED)]
        return []

    def cancel(self, now_s: float) -> list[Message]:
        """End as unknown and tell the vehicle."""
        if not self._move(Event.CANCEL):
            return []
        self._end(Unknown("cancelled", self._wanted()))
        return [self._acknowledgement(MissionResult.OPERATION_CANCELLED)]

    def _take_count(self, count: int, opaque_id: int | None, now_s: float) -> list[Message]:
        if (count, opaque_id) == (self._total, self.opaque_id):
            return self._take_repeated(last=count == 0)
        if not self._move(Event.COUNTED if count else Event.EMPTY):
            return []
        self._total, self.opaque_id = count, opaque_id
        self._items.clear()
        return self._ask(now_s, first=True) if count else self._complete()

    def _take_item(self, message: Message, now_s: float) -> list[Message]:
        seq = message.integer("seq")
        if seq < len(self._items):
            return self._take_repeated(last=seq + 1 == self._total)
        if seq != self._wanted():
            return []
        try:
            item = message_item(message)
        except ValueError:
            return []  # unreadable: asked for again like a lost one, and given up in the end
        last = seq + 1 == self._total
        if not self._move(Event.LAST_ITEM if last else Event.ITEM):
            return []
        self._items.append(item)
        return self._complete() if last else self._ask(now_s, first=True)

    def _take_repeated(self, last: bool) -> list[Message]:
        self._move(Event.REPEATED)
        acknowledge = last and self.state is State.COMPLETE
        return [self._acknowledgement(MissionResult.ACCEPTED)] if acknowledge else []

    def _wanted(self) -> int | None:
        return None if self._total is None else len(self._items)

    def _ask(self, now_s: float, *, first: bool) -> list[Message]:
        self._tries = 1 if first else self._tries + 1
        wanted = self._wanted()
        if wanted is None:
            self.deadline_s = now_s + self.settings.timeout_s
            return [self._typed("MISSION_REQUEST_LIST")]
        patience_s = self.settings.item_timeout_s * 2.0 ** (self._tries - 1)
        self.deadline_s = now_s + min(patience_s, self.settings.timeout_s)
        return [self._typed("MISSION_REQUEST_INT", seq=wanted)]

    def _complete(self) -> list[Message]:
        self._end(Accepted())
        return [self._acknowledgement(MissionResult.ACCEPTED)]

    def _acknowledgement(self, result: MissionResult) -> Message:
        return self._typed("MISSION_ACK", type=int(result))

    def _move(self, event: Event) -> bool:
        """Follow the table; False, and nothing changed, where it has no entry."""
        following = TRANSITIONS.get((self.state, event))
        if following is None:
            return False
        self.state = following
        return True
