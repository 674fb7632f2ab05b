"""What of other ground stations' frames goes on to the vehicle. No socket, no clock.

A station on a read-only forward is heard by nobody. One on a read-write forward speaks to the vehicle as over
a radio of its own, with four exceptions:

- While a list is exchanged from here, its frames of the mission protocol are held back: the vehicle knows one
  partner at a time, and ArduPilot keeps half a list when two get in each other's way. They are not kept for
  later, as an announcement its sender has given up would begin an upload that nobody serves; the protocol's
  own repeats bring them through afterwards. While a list is changed, so are its orders to fly the mission.
- No key passes: it would shut this station out.
- While two aircraft may hear it under one system id, nothing passes that makes them fly or changes what they
  hold. Stops do: one must not wait for a doubt.
- While a station exchanges a list, no transfer is begun from here: ``reserve`` raises BusyError.
"""

from __future__ import annotations

import math
from enum import StrEnum
from typing import Final

from mavlink.errors import BusyError
from mavlink.state.modes import mode_name
from mavlink.state.telemetry import TWO_AIRCRAFT, VehicleState
from mavlink.wire.items import Command
from mavlink.wire.messages import Message

#: ArduPilot gives up a transfer after this much silence, PX4 after 5 s.
EXCHANGE_OVER_S: Final = 8.0

_LISTS: Final = frozenset(
    {
        "MISSION_ACK",
        "MISSION_CLEAR_ALL",
        "MISSION_COUNT",
        "MISSION_ITEM",
        "MISSION_ITEM_INT",
        "MISSION_REQUEST",
        "MISSION_REQUEST_INT",
        "MISSION_REQUEST_LIST",
        "MISSION_REQUEST_PARTIAL_LIST",
        "MISSION_SET_CURRENT",
        "MISSION_WRITE_PARTIAL_LIST",
        # ArduPilot's older protocol of fences and rally points
        "FENCE_FETCH_POINT",
        "FENCE_POINT",
        "RALLY_FETCH_POINT",
        "RALLY_POINT",
    }
)
_BEGINNINGS: Final = frozenset(
    {
        "MISSION_COUNT",
        "MISSION_REQUEST_LIST",
        "MISSION_REQUEST_PARTIAL_LIST",
        "MISSION_WRITE_PARTIAL_LIST",
    }
)
#: Frames that change what the vehicle holds.
CHANGES: Final = frozenset(
    {"MISSION_CLEAR_ALL", "MISSION_COUNT", "MISSION_WRITE_PARTIAL_LIST", "FENCE_POINT", "RALLY_POINT"}
)
#: Frames that lead an aircraft, or set it up otherwise. Sticks are none: whoever holds them looks at it.
_LEADS: Final = frozenset(
    {
        "PARAM_EXT_SET",
        "PARAM_SET",
        "SET_ATTITUDE_TARGET",
        "SET_POSITION_TARGET_GLOBAL_INT",
        "SET_POSITION_TARGET_LOCAL_NED",
    }
)
_LEADING: Final = frozenset({Command.NAV_TAKEOFF, Command.NAV_VTOL_TAKEOFF, Command.DO_REPOSITION})
_INVALID_SEQUENCE: Final = 13
_MISSION_MODES: Final = frozenset({"AUTO", "AUTO.MISSION"})

Sender = tuple[int, int]


class Verdict(StrEnum):
    """What becomes of a station's frame."""

    PASSED = "passed"
    REFUSED = "refused"
    HELD_BACK = "held_back"


class Guard:
    """Judges the frames of all stations beside this one, and keeps count of who is at work on the lists."""

    def __init__(self) -> None:
        self._exchanges: dict[Sender, float] = {}
        self._changers: set[Sender] = set()
        self._reading = 0
        self._changing = 0
        #: Whether the stations here may speak to another aircraft of the vehicle's system id as well.
        self.shared = False

    def judge(self, message: Message, state: VehicleState, write: bool, now_s: float) -> Verdict:
        """What becomes of a frame; ``write`` says whether its station may command the vehicle."""
        if not write or not _for_vehicle(message, state):
            return Verdict.REFUSED
        if message.name == "SETUP_SIGNING":
            return Verdict.REFUSED  # keys come from here alone, and are in no recording
        if (self.shared or _is_doubled(state)) and _is_for_one(message, state):
            return Verdict.REFUSED
        if message.name in _LISTS:
            if self._reading or self._changing:
                return Verdict.HELD_BACK
            self._note(message, now_s)
        elif self._changing and flies_mission(message, state):
            return Verdict.HELD_BACK
        return Verdict.PASSED

    def heard(self, message: Message, now_s: float) -> None:
        """Take what the vehicle says: its last word ends a station's exchange."""
        if not self._exchanges or message.name not in _LISTS:
            return
        partner = _number(message, "target_system"), _number(message, "target_component")
        for sender in [sender for sender in self._exchanges if _meant(partner, sender)]:
            if _is_last_word(message):
                del self._exchanges[sender]
            else:
                self._exchanges[sender] = now_s

    def exchanging(self, now_s: float, *, changes: bool = False) -> int | None:
        """The system id of a station that is exchanging a list with the vehicle; None when none is.

        Parameters
        ----------
        changes
            Whether to ask for those alone that change what the vehicle holds.
        """
        for sender, heard_s in self._exchanges.items():
            if now_s - heard_s < EXCHANGE_OVER_S and (sender in self._changers or not changes):
                return sender[0]
        return None

    def reserve(self, now_s: float, *, changes: bool) -> None:
        """Keep the lists to this station until ``release``; more than once is more than one release.

        Raises
        ------
        BusyError
            Another station is at work on them.
        """
        station = self.exchanging(now_s)
        if station is not None and not (self._reading or self._changing):
            raise BusyError(
                f"another ground station (system {station}) is exchanging a mission with this vehicle"
            )
        if changes:
            self._changing += 1
        else:
            self._reading += 1

    def release(self, *, changes: bool) -> None:
        """Let the others at the lists again."""
        if changes:
            self._changing -= 1
        else:
            self._reading -= 1

    def _note(self, message: Message, now_s: float) -> None:
        sender = message.system_id, message.component_id
        if message.name in _BEGINNINGS:
            over = [other for other, at_s in self._exchanges.items() if now_s - at_s >= EXCHANGE_OVER_S]
            for ended in over:
                del self._exchanges[ended]
            self._exchanges[sender] = now_s
            if message.name in CHANGES:
                self._changers.add(sender)
            else:
                self._changers.discard(sender)
        elif message.name == "MISSION_ACK":
            self._exchanges.pop(sender, None)
        elif sender in self._exchanges:
            self._exchanges[sender] = now_s


def flies_mission(message: Message, state: VehicleState) -> bool:
    """Whether a frame orders the vehicle to fly its mission, or to arm; ending a flight is none of it."""
    if message.name == "SET_MODE":
        return _is_mission_mode(message.integer("custom_mode"), state)
    if message.name not in ("COMMAND_LONG", "COMMAND_INT"):
        return False
    first = message.number("param1")
    match message.integer("command"):
        case Command.MISSION_START | Command.DO_SET_MISSION_CURRENT:
            return True
        case Command.COMPONENT_ARM_DISARM | Command.DO_PAUSE_CONTINUE:
            return first == 1.0
        case Command.DO_SET_MODE:
            main, sub = (message.number(name) for name in ("param2", "param3"))
            if not (0.0 <= main <= 255.0 and (state.autopilot != "px4" or 0.0 <= sub <= 255.0)):
                return False
            packed = int(main) << 16 | int(sub) << 24 if state.autopilot == "px4" else int(main)
            return _is_mission_mode(packed, state)
    return False


def _is_doubled(state: VehicleState) -> bool:
    """Whether two aircraft speak under the vehicle's system id on its own link."""
    return state.doubt is not None and state.doubt.rule == TWO_AIRCRAFT


def _is_for_one(message: Message, state: VehicleState) -> bool:
    """Whether a frame is one that a single aircraft has to be meant by."""
    if message.name in _LISTS or message.name in _LEADS or flies_mission(message, state):
        return True
    return message.name in ("COMMAND_LONG", "COMMAND_INT") and message.integer("command") in _LEADING


def _is_mission_mode(custom_mode: int, state: VehicleState) -> bool:
    return mode_name(state.autopilot, state.type, custom_mode) in _MISSION_MODES


def _for_vehicle(message: Message, state: VehicleState) -> bool:
    """Whether a frame is meant for the vehicle or for all, and does not claim to be the vehicle's own."""
    if (message.system_id, message.component_id) == (state.system_id, state.component_id):
        return False
    return _number(message, "target_system") in (0, state.system_id)


def _is_last_word(message: Message) -> bool:
    """Whether nothing follows from the vehicle; of an empty list not every station says that it has it."""
    if message.name == "MISSION_ACK":
        return _number(message, "type") != _INVALID_SEQUENCE
    return message.name == "MISSION_COUNT" and _number(message, "count") == 0


def _meant(partner: Sender, sender: Sender) -> bool:
    return partner[0] in (0, sender[0]) and partner[1] in (0, sender[1])


def _number(message: Message, name: str) -> int:
    """A field as an int; 0 where the message has none of the name."""
    value = message.fields.get(name, 0)
    return int(value) if isinstance(value, (int, float)) and math.isfinite(value) else 0
