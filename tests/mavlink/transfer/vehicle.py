"""The vehicle's side of the mission protocol, as far as tests of our side need it; no I/O, no clock.

Two manners, as measured on simulators. ArduPilot stores item by item, asks every second, gives up after 8 s,
says INVALID_SEQUENCE to duplicates and ERROR to items nobody asked for. PX4 stores at the end, asks every
0.25 s, gives up after 5 s, acknowledges the last item whenever it comes again, gives every list an id, and is
deaf to partial updates.
"""

from __future__ import annotations

import math
import zlib
from collections.abc import Sequence
from dataclasses import dataclass, field

from mavlink.wire.items import MissionItem, MissionResult, MissionType
from mavlink.wire.messages import Message, Value

GROUND = (255, 190)
VEHICLE = (1, 1)


def waypoints(count: int, mission_type: MissionType = MissionType.MISSION) -> tuple[MissionItem, ...]:
    """Items that all differ."""
    return tuple(
        MissionItem(
            seq,
            3,
            16,
            1.5,
            2.0,
            -1.0,
            0.25,
            10_000_000 + seq,
            -20_000_000 - seq,
            100.0 + seq,
            mission_type=mission_type,
        )
        for seq in range(count)
    )


def from_vehicle(name: str, /, **fields: Value) -> Message:
    """A message of the vehicle to our ground station."""
    addressed: dict[str, Value] = {
        "target_system": GROUND[0],
        "target_component": GROUND[1],
        "mission_type": 0,
    }
    return Message(name, {**addressed, **fields}, *VEHICLE)


def item_of(message: Message) -> MissionItem:
    """The item in a MISSION_ITEM_INT, read without the code under test."""
    whole = {name: message.integer(name) for name in ("seq", "frame", "command", "x", "y")}
    real = {name: message.number(name) for name in ("param1", "param2", "param3", "param4", "z")}
    return MissionItem(
        **whole,
        **real,
        current=message.integer("current") == 1,
        autocontinue=message.integer("autocontinue") == 1,
        mission_type=MissionType(message.integer("mission_type")),
    )


@dataclass
class _Upload:
    count: int
    asked_s: float
    heard_s: float
    items: list[MissionItem] = field(default_factory=list)
    first: int = 0
    partial: bool = False

    @property
    def wanted(self) -> int:
        return self.first + len(self.items)


class StubVehicle:
    """One vehicle.

    Attributes
    ----------
    held
        What it holds now, by type.
    stored
        Every list it ever acknowledged, oldest first.
    said
        Every result it ever sent.
    refuse_item
        The result an item draws instead of being taken, by number.
    ids
        What it says of its lists in MISSION_COUNT and MISSION_ACK, by type; 0 where it has no ids.
    """

    def __init__(
        self, manner: str = "ardupilot", refuse_item: dict[int, MissionResult] | None = None
    ) -> None:
        self.manner = manner
        self.refuse_item = refuse_item or {}
        self.held: dict[int, tuple[MissionItem, ...]] = {0: (), 1: (), 2: ()}
        self.stored: list[tuple[MissionItem, ...]] = []
        self.said: list[int] = []
        self.lose_final = False
        self.ids: dict[int, int] = {0: 0, 1: 0, 2: 0}
        self._ask_every_s, self._give_up_s = (1.0, 8.0) if manner == "ardupilot" else (0.25, 5.0)
        self._uploads: dict[int, _Upload] = {}

    @property
    def deadline_s(self) -> float:
        """When it wants its next tick."""
        due = (
            min(up.asked_s + self._ask_every_s, up.heard_s + self._give_up_s) for up in self._uploads.values()
        )
        return min(due, default=math.inf)

    def receive(self, message: Message, now_s: float) -> list[Message]:
        """Take a message, give the answers."""
        kind = message.fields.get("mission_type", 0)
        assert isinstance(kind, int)
        match message.name:
            case "MISSION_COUNT":
                return self._count(message.integer("count"), kind, now_s)
            case "MISSION_WRITE_PARTIAL_LIST" if self.manner == "ardupilot":
                return self._partial(message, kind, now_s)
            case "MISSION_ITEM_INT":
                return self._item(item_of(message), kind, now_s)
            case "MISSION_REQUEST_LIST":
                count, opaque_id = len(self.held[kind]), self.ids[kind]
                return [from_vehicle("MISSION_COUNT", count=count, mission_type=kind, opaque_id=opaque_id)]
            case "MISSION_REQUEST_INT":
                return self._give(message.integer("seq"), kind)
            case "MISSION_CLEAR_ALL":
                self.held[kind] = ()
                self.ids[kind] = 0
                return [self._ack(MissionResult.ACCEPTED, kind)]
            case "MISSION_ACK" if message.integer("type") != 0:
                self._uploads.pop(kind, None)
        return []

    def tick(self, now_s: float) -> list[Message]:
        """Ask again, or give up."""
        answers = []
        for kind, upload in list(self._uploads.items()):
            if now_s >= upload.heard_s + self._give_up_s:
                del self._uploads[kind]
                answers.append(self._ack(MissionResult.OPERATION_CANCELLED, kind))
            elif now_s >= upload.asked_s + self._ask_every_s:
                answers.append(self._ask(kind, now_s))
        return answers

    def _count(self, count: int, kind: int, now_s: float) -> list[Message]:
        if count == 0:
            self._uploads.pop(kind, None)
            return self._commit((), kind)
        self._uploads[kind] = _Upload(count, now_s, now_s)
        if self.manner == "ardupilot":
            self.held[kind] = self.held[kind][:count]
        return [self._ask(kind, now_s)]

    def _partial(self, message: Message, kind: int, now_s: float) -> list[Message]:
        first, last = message.integer("start_index"), message.integer("end_index")
        if kind in self._uploads:
            return [self._ack(MissionResult.DENIED, kind)]
        if not 0 <= first <= last <= len(self.held[kind]):
            return [self._ack(MissionResult.ERROR, kind)]
        self._uploads[kind] = _Upload(last - first + 1, now_s, now_s, first=first, partial=True)
        return [self._ask(kind, now_s)]

    def _item(self, item: MissionItem, kind: int, now_s: float) -> list[Message]:
        upload = self._uploads.get(kind)
        if upload is None:
            if self.manner == "ardupilot":
                return [self._ack(MissionResult.ERROR, kind)]
            return [self._ack(MissionResult.ACCEPTED, kind)] if item.seq + 1 == len(self.held[kind]) else []
        upload.heard_s = now_s
        if item.seq != upload.wanted:
            return [self._ack(MissionResult.INVALID_SEQUENCE, kind)] if self.manner == "ardupilot" else []
        if item.seq in self.refuse_item:
            del self._uploads[kind]
            return [self._ack(self.refuse_item[item.seq], kind)]
        upload.items.append(item)
        if self.manner == "ardupilot":
            held = self.held[kind]
            self.held[kind] = (*held[: upload.first], *upload.items, *held[upload.wanted :])
        if len(upload.items) == upload.count:
            del self._uploads[kind]
            return self._commit(self.held[kind] if upload.partial else tuple(upload.items), kind)
        return [self._ask(kind, now_s)]

    def _commit(self, items: Sequence[MissionItem], kind: int) -> list[Message]:
        self.held[kind] = tuple(items)
        self.ids[kind] = zlib.crc32(repr(items).encode()) if self.manner == "px4" and items else 0
        self.stored.append(tuple(items))
        acknowledgement = self._ack(MissionResult.ACCEPTED, kind)
        return [] if self.lose_final else [acknowledgement]

    def _ask(self, kind: int, now_s: float) -> Message:
        upload = self._uploads[kind]
        upload.asked_s = now_s
        name = "MISSION_REQUEST" if self.manner == "ardupilot" else "MISSION_REQUEST_INT"
        return from_vehicle(name, seq=upload.wanted, mission_type=kind)

    def _give(self, seq: int, kind: int) -> list[Message]:
        if seq >= len(self.held[kind]):
            return [self._ack(MissionResult.INVALID_SEQUENCE, kind)]
        item = self.held[kind][seq]
        names = ("seq", "frame", "command", "param1", "param2", "param3", "param4", "x", "y", "z")
        fields = {name: getattr(item, name) for name in names}
        flags = {"current": int(item.current), "autocontinue": int(item.autocontinue), "mission_type": kind}
        return [from_vehicle("MISSION_ITEM_INT", **fields, **flags)]

    def _ack(self, result: MissionResult, kind: int) -> Message:
        self.said.append(int(result))
        opaque_id = self.ids[kind] if result == MissionResult.ACCEPTED else 0
        return from_vehicle("MISSION_ACK", type=int(result), mission_type=kind, opaque_id=opaque_id)
