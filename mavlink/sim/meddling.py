"""Faults of the mission protocol that lie in what is heard and said, not in what is stored."""

from __future__ import annotations

from dataclasses import replace

from mavlink.sim.faults import Fault
from mavlink.wire.items import MissionResult
from mavlink.wire.messages import Message

_OPENING = frozenset({"MISSION_COUNT", "MISSION_WRITE_PARTIAL_LIST"})
_ITEMS = frozenset({"MISSION_ITEM", "MISSION_ITEM_INT"})
_REQUESTS = frozenset({"MISSION_REQUEST", "MISSION_REQUEST_INT"})

#: Messages that are not heard at all.
_UNHEARD = {
    Fault.NO_RESPONSE_TO_COUNT: _OPENING,
    Fault.NO_RESPONSE_TO_LIST: frozenset({"MISSION_REQUEST_LIST"}),
}
#: Messages that are not heard the first time.
_FIRST_UNHEARD = {
    Fault.NO_RESPONSE_TO_FIRST_COUNT: _OPENING,
    Fault.NO_RESPONSE_TO_FIRST_LIST: frozenset({"MISSION_REQUEST_LIST"}),
}
#: Of these every third is lost on its way up or down.
_LOST_UP = {Fault.LOST_ITEMS: _ITEMS}
_LOST_DOWN = {Fault.LOST_REQUESTS: _REQUESTS, Fault.LOST_DOWNLOAD_ITEMS: _ITEMS}
#: What is never said of item 0 or 1.
_UNSAID = {
    Fault.NO_REQUEST_0: (_REQUESTS, 0),
    Fault.NO_REQUEST_1: (_REQUESTS, 1),
    Fault.NO_ITEM_0: (_ITEMS, 0),
    Fault.NO_ITEM_1: (_ITEMS, 1),
}
#: What is said with another number than 0 or 1.
_MISNUMBERED = {
    Fault.WRONG_REQUEST_AT_0: (_REQUESTS, 0),
    Fault.WRONG_REQUEST_AT_1: (_REQUESTS, 1),
    Fault.WRONG_ITEM_AT_0: (_ITEMS, 0),
    Fault.WRONG_ITEM_AT_1: (_ITEMS, 1),
}
#: In whose place MISSION_ACK ERROR is said.
_ERROR_INSTEAD = {Fault.ERROR_ACK_FOR_ITEM_0: (_ITEMS, 0), Fault.ERROR_ACK_FOR_ITEM_1: (_ITEMS, 1)}
#: Numbers no list here reaches.
_ASTRAY = 60_000
_FOREIGN_SYSTEM = 99


class Meddler:
    """Stands between a vehicle's mission protocol and its link."""

    def __init__(self, faults: frozenset[Fault]) -> None:
        self._faults = faults
        self._counts: dict[Fault, int] = {}

    def hears(self, message: Message) -> bool:
        """Whether a message gets through to the vehicle."""
        return not (
            any(message.name in names for fault, names in _UNHEARD.items() if fault in self._faults)
            or any(
                message.name in names and self._count(fault) == 1
                for fault, names in _FIRST_UNHEARD.items()
                if fault in self._faults
            )
            or self._third(message, _LOST_UP)
        )

    def said(self, messages: list[Message]) -> list[Message]:
        """What of the vehicle's messages goes out, and as what."""
        if not self._faults:
            return messages
        return [sent for message in messages for sent in self._sent(message)]

    def _sent(self, message: Message) -> list[Message]:
        if self._third(message, _LOST_DOWN) or self._strikes(message, _UNSAID):
            return []
        if self._strikes(message, _MISNUMBERED):
            return [_with(message, seq=message.integer("seq") + _ASTRAY)]
        if self._strikes(message, _ERROR_INSTEAD):
            kept = ("target_system", "target_component", "mission_type")
            fields = {name: message.fields[name] for name in kept}
            return [Message("MISSION_ACK", {**fields, "type": int(MissionResult.ERROR)})]
        stray = []
        if message.name in _REQUESTS and message.integer("seq") == 1:
            kind = message.integer("mission_type")
            fields = {name: message.fields[name] for name in ("target_system", "target_component")}
            refusal = Message(
                "MISSION_ACK", {**fields, "type": int(MissionResult.DENIED), "mission_type": kind}
            )
            if Fault.WRONG_TYPE_ACK in self._faults:
                stray.append(_with(refusal, mission_type=(kind + 1) % 3))
            if Fault.FOREIGN_ACK in self._faults:
                stray.append(replace(refusal, system_id=_FOREIGN_SYSTEM, component_id=1))
        return [*stray, message]

    def _strikes(self, message: Message, table: dict[Fault, tuple[frozenset[str], int]]) -> bool:
        return any(
            message.name in names and message.integer("seq") == seq
            for fault, (names, seq) in table.items()
            if fault in self._faults
        )

    def _third(self, message: Message, table: dict[Fault, frozenset[str]]) -> bool:
        return any(
            message.name in names and self._count(fault) % 3 == 0
            for fault, names in table.items()
            if fault in self._faults
        )

    def _count(self, fault: Fault) -> int:
        self._counts[fault] = self._counts.get(fault, 0) + 1
        return self._counts[fault]


def _with(message: Message, **fields: int) -> Message:
    return replace(message, fields={**message.fields, **fields})
