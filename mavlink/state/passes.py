"""Where in a mission its sensor may be on, and where its landing begins: read from the items alone."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final, Literal

from mavlink.encoding.payload import OutputPayload, Payload, TriggerPayload, parts_of, switch_items
from mavlink.state.modes import Autopilot
from mavlink.state.outputs import switched_by
from mavlink.wire.geometry import distance_m
from mavlink.wire.items import Command, MissionItem

#: MAV_CMD_NAV_LAST: what is flown.
_NAV_LAST: Final = 95
#: So long a wing takes from any direction into a line: a circle, and what its guidance needs to settle.
_LEAD_IN_S: Final = 40.0
_SPEED_M_S: Final = 15.0
#: An approach is no longer than this: a circle down, the line in, and orders between.
_APPROACH_ITEMS: Final = 8
#: Before an approach lies the last pass: its orders to the sensor are no part of it.
_SWITCHES: Final = frozenset(
    {
        Command.DO_SET_RELAY,
        Command.DO_SET_SERVO,
        Command.DO_SET_ACTUATOR,
        Command.DO_SET_CAM_TRIGG_DIST,
        Command.IMAGE_STOP_CAPTURE,
        Command.VIDEO_STOP_CAPTURE,
    }
)


def passes_of(items: Sequence[MissionItem], payload: Payload, autopilot: Autopilot) -> tuple[range, ...]:
    """The numbers of the items between each order to switch on and the next to switch off, both included.

    An aircraft that reports one of them as its current item is within that pass. One that is never switched
    off ends with the mission.
    """
    found = [run for part in parts_of(switched_by(payload, autopilot)) for run in _runs(items, part)]
    return tuple(sorted(found, key=lambda run: run.start))


def _runs(items: Sequence[MissionItem], part: OutputPayload | TriggerPayload) -> Iterator[range]:
    begun: int | None = None
    for item in items:
        switched = _switched(item, part)
        if begun is None and switched == "on":
            begun = item.seq
        elif begun is not None and switched == "off":
            yield range(begun, item.seq + 1)
            begun = None
        elif begun is None and switched == "once":
            yield range(item.seq, item.seq + 1)
    if begun is not None:
        yield range(begun, items[-1].seq + 1)


def _switched(item: MissionItem, part: OutputPayload | TriggerPayload) -> Literal["on", "off", "once"] | None:
    """What an item does to a payload: a pass begins or ends, or is one photo alone."""
    if not isinstance(part, TriggerPayload):
        on, off = switch_items(part)
        return "on" if _same(item, on) else "off" if _same(item, off) else None
    match part.by, item.command:
        case "distance", Command.DO_SET_CAM_TRIGG_DIST:
            return "on" if item.param1 > 0.0 else "off"
        case "distance", Command.DO_DIGICAM_CONTROL:
            return "once"
        case "time", Command.IMAGE_START_CAPTURE:
            return "on" if item.param2 > 0.0 else "once"
        case ("time", Command.IMAGE_STOP_CAPTURE) | ("video", Command.VIDEO_STOP_CAPTURE):
            return "off"
        case "video", Command.VIDEO_START_CAPTURE:
            return "on"
    return None


def _same(item: MissionItem, order: MissionItem) -> bool:
    if item.command != order.command:
        return False
    pairs = ((getattr(item, name), getattr(order, name)) for name in ("param1", "param2", "param3", "param4"))
    return all(held == meant or (math.isnan(held) and math.isnan(meant)) for held, meant in pairs)


@dataclass(frozen=True, slots=True)
class LeadIn:
    """The item to fly a pass again from.

    Parameters
    ----------
    whole
        Whether it lies so far before the pass that an aircraft from anywhere is on its line where it begins.
    """

    seq: int
    whole: bool

    def __str__(self) -> str:
        if self.whole:
            return f"goto_item {self.seq} flies it whole"
        return f"goto_item {self.seq} flies it again, but for its beginning unless the aircraft comes in line"


def lead_in(items: Sequence[MissionItem], run: range, passes: Sequence[range], *, hovers: bool) -> LeadIn:
    """Where to fly a pass from, wherever the aircraft is.

    On its line a wing has to be as planned from the pass's start on, and comes to any place in a turn: it
    is the last waypoint so far before the pass, or the first behind the pass before. What hovers stops for
    its corners.
    """
    straight_m = 0.0 if hovers else _LEAD_IN_S * max((_speed_m_s(item) for item in items), default=_SPEED_M_S)
    floor = max((other.stop for other in passes if other.stop <= run.start), default=0)
    ahead: tuple[float, float] | None = None
    found, way_m = max(run.start - 1, 0), 0.0
    for item in reversed(items[floor : run.start]):
        if item.command == Command.NAV_TAKEOFF or item.seq == 0:
            break  # before it stands home
        if item.command > _NAV_LAST or not (item.x or item.y):
            continue
        here = item.y / 1e7, item.x / 1e7
        way_m += 0.0 if ahead is None else distance_m(here, ahead)
        begun, ahead = ahead is not None, here
        if item.command != Command.NAV_WAYPOINT:
            continue
        found = item.seq
        if begun and way_m >= straight_m:
            return LeadIn(found, whole=True)
    return LeadIn(found, whole=False)


def _speed_m_s(item: MissionItem) -> float:
    """The airspeed that an item sets; else what small wings fly at."""
    set_ = item.command == Command.DO_CHANGE_SPEED and item.param1 == 0.0 and item.param2 > 0.0
    return item.param2 if set_ else _SPEED_M_S


def landing_of(items: Sequence[MissionItem]) -> int | None:
    """The number of the item that the mission's landing begins with; None where it has none.

    The circle down before the touch-down, or the mark that PX4 wants there; else the place before it.
    """
    lands = [index for index, item in enumerate(items) if item.command == Command.NAV_LAND]
    if not lands:
        return None
    place: int | None = None
    for item in reversed(items[max(lands[-1] - _APPROACH_ITEMS, 0) : lands[-1]]):
        if item.command in (Command.DO_LAND_START, Command.NAV_LOITER_TO_ALT):
            return item.seq
        if item.command == Command.NAV_WAYPOINT and place is None:
            place = item.seq
        if item.command in _SWITCHES:
            break
    return items[lands[-1]].seq if place is None else place
