"""The vehicle's side of the mission protocol: upload, download, clear; no socket, no clock.

Source: MAVLink mission protocol; the manners of each autopilot as measured on ArduPlane 4.6 and PX4 1.16
simulators. ArduPilot writes mission items as they come (a failed upload leaves new items in front, old ones
behind) and asks with MISSION_REQUEST; PX4 stores a list whole or not at all, asks with MISSION_REQUEST_INT,
gives every list an id and is deaf to MISSION_WRITE_PARTIAL_LIST. Both store fences and rally points whole.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from mavlink.sim.acceptance import PLACED, finished_list, refusal
from mavlink.sim.faults import Fault
from mavlink.sim.geodesy import Place
from mavlink.sim.meddling import Meddler
from mavlink.sim.modes import Flavour
from mavlink.sim.replies import (
    acknowledgement,
    checksum,
    item_message,
    received_item,
    sender,
    status_text,
)
from mavlink.sim.storage import as_stored, home_item
from mavlink.wire.items import MissionItem, MissionResult, MissionType
from mavlink.wire.messages import Message

_ASK_AGAIN_S = {Flavour.ARDUPILOT: 1.0, Flavour.PX4: 0.25}
_GIVE_UP_S = {Flavour.ARDUPILOT: 8.0, Flavour.PX4: 5.0}
_CAPACITY = {
    (Flavour.ARDUPILOT, MissionType.MISSION): 655,
    (Flavour.ARDUPILOT, MissionType.FENCE): 84,
    (Flavour.ARDUPILOT, MissionType.RALLY): 20,
    (Flavour.PX4, MissionType.MISSION): 1000,
    (Flavour.PX4, MissionType.FENCE): 64,
    (Flavour.PX4, MissionType.RALLY): 32,
}
#: MAV_MISSION_TYPE_ALL
_ALL_TYPES = 255
_HANDLED = frozenset(
    {
        "MISSION_COUNT",
        "MISSION_WRITE_PARTIAL_LIST",
        "MISSION_ITEM_INT",
        "MISSION_ITEM",
        "MISSION_REQUEST_LIST",
        "MISSION_REQUEST_INT",
        "MISSION_REQUEST",
        "MISSION_ACK",
        "MISSION_CLEAR_ALL",
    }
)


@dataclass(slots=True)
class _Upload:
    partner: tuple[int, int]
    kind: MissionType
    count: int
    heard_s: float
    asked_s: float
    items: list[MissionItem] = field(default_factory=list)
    misled: bool = False
    first: int = 0
    partial: bool = False
    checksum: int = 0

    @property
    def wanted(self) -> int:
        """The number of the item to ask for."""
        return self.first + len(self.items)


@dataclass(slots=True)
class _Download:
    partner: tuple[int, int]
    kind: MissionType
    heard_s: float


class MissionServer:
    """Stores of mission, fence and rally items, and the protocol that fills and reads them.

    Attributes
    ----------
    revision
        Grows whenever the stored mission changes.
    flying
        Set by the autopilot while it flies the mission: ArduPilot then refuses to clear it.
    """

    def __init__(
        self,
        flavour: Flavour,
        home: Place,
        *,
        faults: frozenset[Fault] = frozenset(),
        max_items: int | None = None,
        sensor_command: int = 0,
        hovers: bool = False,
        vanish_after_items: int = 3,
        vanish_for_s: float = 10.0,
    ) -> None:
        self._flavour = flavour
        self.home = home
        self._faults = faults
        self._max_items = max_items
        self._sensor_command = sensor_command
        self._hovers = hovers
        self._vanish_after_items = vanish_after_items
        self._vanish_for_s = vanish_for_s
        self._stores: dict[MissionType, list[MissionItem]] = {kind: [] for kind in MissionType}
        self._ids: dict[MissionType, int] = dict.fromkeys(MissionType, 0)
        self._upload: _Upload | None = None
        self._download: _Download | None = None
        self._last_stored: tuple[MissionType, int] | None = None
        self._last_checksum = 0
        self._silent_until_s: float | None = None
        self._vanished = False
        self._meddler = Meddler(faults)
        self.revision = 0
        self.flying = False

    def items(self, kind: MissionType = MissionType.MISSION) -> tuple[MissionItem, ...]:
        """The stored items; ArduPilot's mission begins with home."""
        stored = self._stores[kind]
        if kind is MissionType.MISSION and self._flavour is Flavour.ARDUPILOT and stored:
            return (home_item(self.home), *stored[1:])
        return tuple(stored)

    def opaque_id(self, kind: MissionType) -> int:
        """PX4's checksum of the items held, as they were sent; 0 for none, and from ArduPilot."""
        return self._ids[kind]

    @property
    def receiving(self) -> bool:
        """Whether an upload is going on."""
        return self._upload is not None

    def silent(self, now_s: float) -> bool:
        """Whether the vehicle has vanished from the link."""
        return self._silent_until_s is not None and now_s < self._silent_until_s

    def receive(self, message: Message, now_s: float) -> list[Message]:
        """Answers to one message of the protocol; none for other messages."""
        if message.name not in _HANDLED or self.silent(now_s):
            return []
        expired = self.advance(now_s)
        if not self._meddler.hears(message):
            return expired
        number = message.integer("mission_type") if "mission_type" in message.fields else 0
        if message.name == "MISSION_CLEAR_ALL" and number == _ALL_TYPES:
            return expired + self._clear(message, list(MissionType))
        if number not in list(MissionType):
            return [*expired, self._ack(message, MissionType.MISSION, MissionResult.UNSUPPORTED)]
        kind = MissionType(number)
        match message.name:
            case "MISSION_COUNT":
                answers = self._count(message, kind, now_s)
            case "MISSION_WRITE_PARTIAL_LIST":
                answers = self._partial(message, kind, now_s)
            case "MISSION_ITEM_INT" | "MISSION_ITEM":
                answers = self._item(message, kind, now_s)
            case "MISSION_REQUEST_LIST":
                answers = self._list(message, kind, now_s)
            case "MISSION_REQUEST_INT" | "MISSION_REQUEST":
                answers = self._request(message, kind, now_s)
            case "MISSION_CLEAR_ALL":
                answers = self._clear(message, [kind])
            case _:
                answers = []
                if self._download is not None and self._download.partner == sender(message):
                    self._download = None
                elif self._upload is not None and self._upload.partner == sender(message):
                    # A ground station ends an upload early with an acknowledgement of its own.
                    self._upload = None
        return expired + self._meddler.said(answers)

    def advance(self, now_s: float) -> list[Message]:
        """What is due by the clock: repeated requests, giving up."""
        if self._silent_until_s is not None:
            if now_s < self._silent_until_s:
                return []
            self._silent_until_s = None
        if self._download is not None and now_s - self._download.heard_s > _GIVE_UP_S[self._flavour]:
            self._download = None
        upload = self._upload
        if upload is None:
            return []
        if now_s - upload.heard_s >= _GIVE_UP_S[self._flavour]:
            self._upload = None
            text = status_text(4, "Mission upload timeout")
            if self._flavour is Flavour.PX4:
                return [text]
            return [text, acknowledgement(upload.partner, upload.kind, MissionResult.OPERATION_CANCELLED)]
        if now_s - upload.asked_s >= _ASK_AGAIN_S[self._flavour]:
            upload.asked_s = now_s
            return self._meddler.said(self._ask(upload))
        return []

    def _count(self, message: Message, kind: MissionType, now_s: float) -> list[Message]:
        partner, count = sender(message), message.integer("count")
        if self._occupied and (self._upload is None or self._upload.partner != partner):
            return [self._ack(message, kind, MissionResult.DENIED)]
        if self._flavour is Flavour.PX4 and self._download is not None:
            return [self._ack(message, kind, MissionResult.ERROR)]
        if Fault.ERROR_ACK_AT_0 in self._faults:
            return [self._ack(message, kind, MissionResult.ERROR)]
        if count > self._capacity(kind):
            return [self._ack(message, kind, MissionResult.NO_SPACE)]
        self._download = None
        self._last_stored = None
        if count == 0:
            self._upload = None
            self._store(kind, [])
            return [self._ack(message, kind, MissionResult.ACCEPTED)]
        if self._in_place(kind):
            self._store(kind, self._stores[kind][:count])
        self._upload = _Upload(partner, kind, count, now_s, now_s)
        return self._ask(self._upload)

    def _partial(self, message: Message, kind: MissionType, now_s: float) -> list[Message]:
        if self._flavour is Flavour.PX4:
            return []
        if self._occupied:
            return [self._ack(message, kind, MissionResult.DENIED)]
        if Fault.ERROR_ACK_AT_0 in self._faults:
            return [self._ack(message, kind, MissionResult.ERROR)]
        first, last, held = message.integer("start_index"), message.integer("end_index"), self._stores[kind]
        if not 0 <= first <= last <= len(held):
            text = status_text(4, "Flight plan update rejected")
            return [text, self._ack(message, kind, MissionResult.ERROR)]
        self._download = None
        self._upload = _Upload(
            sender(message), kind, last - first + 1, now_s, now_s, first=first, partial=True
        )
        return self._ask(self._upload)

    def _item(self, message: Message, kind: MissionType, now_s: float) -> list[Message]:
        upload, partner = self._upload, sender(message)
        item = received_item(message, kind)
        if upload is None or upload.partner != partner or upload.kind is not kind:
            again = self._flavour is Flavour.PX4 and self._last_stored == (kind, item.seq)
            if again:
                # PX4 takes it for a lost acknowledgement, also after an abort that stored nothing.
                return [self._ack(message, kind, MissionResult.ACCEPTED, self._last_checksum)]
            return [self._ack(message, kind, MissionResult.ERROR)]
        upload.heard_s = now_s
        if item.seq != upload.wanted:
            if self._flavour is Flavour.ARDUPILOT:
                return [self._ack(message, kind, MissionResult.INVALID_SEQUENCE)]
            upload.asked_s = now_s
            return self._ask(upload)
        if Fault.ERROR_ACK_AT_1 in self._faults and not upload.items:
            self._upload = None
            return [self._ack(message, kind, MissionResult.ERROR)]
        refused = refusal(
            self._flavour,
            item,
            max(upload.first + upload.count, len(self._stores[kind])),
            self._sensor_command,
            hovers=self._hovers,
        )
        if refused is not None:
            self._upload = None
            text = status_text(4, f"Mission item {item.seq}: {refused.name}")
            return [text, self._ack(message, kind, refused)]
        upload.items.append(as_stored(self._flavour, item, self.home, hovers=self._hovers))
        upload.checksum = checksum(message, upload.checksum)
        upload.asked_s = now_s
        if self._in_place(kind):
            self._store(kind, self._merged(upload))
        self._last_stored, self._last_checksum = (kind, upload.first + upload.count - 1), upload.checksum
        if Fault.EARLY_ACK in self._faults and upload.count > 1:
            self._upload = None
            self._store(kind, self._merged(upload) if upload.partial else upload.items, upload.checksum)
            return [self._ack(message, kind, MissionResult.ACCEPTED, upload.checksum)]
        if (
            Fault.VANISH_MID_UPLOAD in self._faults
            and not self._vanished
            and len(upload.items) == self._vanish_after_items
        ):
            self._vanished = True
            self._silent_until_s = now_s + self._vanish_for_s
            return []
        if len(upload.items) == upload.count:
            return self._complete(upload)
        return self._ask(upload)

    def _complete(self, upload: _Upload) -> list[Message]:
        self._upload = None
        items, reason = self._merged(upload) if upload.partial else upload.items, ""
        if upload.kind is not MissionType.MISSION:
            items, reason = finished_list(self._flavour, items, self._stores[upload.kind])
        if reason:
            return [status_text(4, reason), acknowledgement(upload.partner, upload.kind, MissionResult.ERROR)]
        if Fault.ALTERED_ITEM in self._faults:
            items = _altered(items)
        if Fault.ERROR_ACK_AT_END in self._faults:
            return [acknowledgement(upload.partner, upload.kind, MissionResult.ERROR)]
        self._store(upload.kind, items, upload.checksum)
        if Fault.NO_FINAL_ACK in self._faults:
            return []
        opaque_id = self._ids[upload.kind]
        if opaque_id and Fault.WRONG_OPAQUE_ID in self._faults:
            opaque_id ^= 1
        return [acknowledgement(upload.partner, upload.kind, MissionResult.ACCEPTED, opaque_id)]

    def _merged(self, upload: _Upload) -> list[MissionItem]:
        """The list held, with what has come so far in its place."""
        stored = self._stores[upload.kind]
        return [*stored[: upload.first], *upload.items, *stored[upload.wanted :]]

    def _ask(self, upload: _Upload) -> list[Message]:
        seq = upload.wanted
        if Fault.WRONG_SEQUENCE_REQUEST in self._faults and len(upload.items) == 1 and not upload.misled:
            upload.misled = True
            seq += 1
        name = "MISSION_REQUEST" if self._flavour is Flavour.ARDUPILOT else "MISSION_REQUEST_INT"
        system, component = upload.partner
        fields = {
            "target_system": system,
            "target_component": component,
            "seq": seq,
            "mission_type": int(upload.kind),
        }
        return [Message(name, fields)]

    def _list(self, message: Message, kind: MissionType, now_s: float) -> list[Message]:
        if self._occupied:
            return [self._ack(message, kind, MissionResult.DENIED)]
        self._download = _Download(sender(message), kind, now_s)
        fields = {
            "target_system": message.system_id,
            "target_component": message.component_id,
            "count": len(self.items(kind)),
            "mission_type": int(kind),
            "opaque_id": self._ids[kind],
        }
        return [Message("MISSION_COUNT", fields)]

    def _request(self, message: Message, kind: MissionType, now_s: float) -> list[Message]:
        if self._occupied:
            return [self._ack(message, kind, MissionResult.DENIED)]
        stored, seq = self.items(kind), message.integer("seq")
        if seq >= len(stored):
            return [self._ack(message, kind, MissionResult.INVALID_SEQUENCE)]
        if self._download is not None:
            self._download.heard_s = now_s
        item = replace(stored[seq], seq=seq, mission_type=kind)
        return [item_message(item, sender(message), integer=message.name == "MISSION_REQUEST_INT")]

    def _clear(self, message: Message, kinds: list[MissionType]) -> list[Message]:
        kind = kinds[0]
        if self._occupied:
            return [self._ack(message, kind, MissionResult.ERROR)]
        if self._flavour is Flavour.ARDUPILOT and self.flying and MissionType.MISSION in kinds:
            return [self._ack(message, kind, MissionResult.ERROR)]
        for each in kinds:
            self._store(each, [])
        return [self._ack(message, kind, MissionResult.ACCEPTED)]

    def _store(self, kind: MissionType, items: Sequence[MissionItem], opaque_id: int = 0) -> None:
        self._ids[kind] = opaque_id if self._flavour is Flavour.PX4 else 0
        self._stores[kind] = [replace(item, seq=seq) for seq, item in enumerate(items)]
        if kind is MissionType.MISSION:
            self.revision += 1

    @property
    def _occupied(self) -> bool:
        return self._upload is not None or Fault.COMPETING_STATION in self._faults

    def _in_place(self, kind: MissionType) -> bool:
        return self._flavour is Flavour.ARDUPILOT and kind is MissionType.MISSION

    def _capacity(self, kind: MissionType) -> int:
        if kind is MissionType.MISSION and self._max_items is not None:
            return self._max_items
        return _CAPACITY[self._flavour, kind]

    def _ack(self, message: Message, kind: MissionType, result: MissionResult, checksum: int = 0) -> Message:
        opaque_id = checksum if self._flavour is Flavour.PX4 else 0
        return acknowledgement(sender(message), kind, result, opaque_id)


def _altered(items: list[MissionItem]) -> list[MissionItem]:
    for index in range(len(items) - 1, -1, -1):
        if items[index].command in PLACED and index > 0:
            return [*items[:index], replace(items[index], z=items[index].z + 10.0), *items[index + 1 :]]
    return items
