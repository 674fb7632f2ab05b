"""Where in a mission its sensor may be on, and where its landing begins: read from the items alone."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

from mavlink.encoding.payload import Payload, switch_items
from mavlink.state.modes import Autopilot
from mavlink.state.outputs import switched_by
from mavlink.wire.items import Command, MissionItem

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
    }
)


def passes_of(items: Sequence[MissionItem], payload: Payload, autopilot: Autopilot) -> tuple[range, ...]:
    """The numbers of the items between each order to switch on and the next to switch off, both included.

    An aircraft that reports one of them as its current item is within that pass. One that is never switched
    off ends with the mission.
    """
    on, off = switch_items(switched_by(payload, autopilot))
    found: list[range] = []
    begun: int | None = None
    for item in items:
        if begun is None and _same(item, on):
            begun = item.seq
        elif begun is not None and _same(item, off):
            found.append(range(begun, item.seq + 1))
            begun = None
    if begun is not None:
        found.append(range(begun, items[-1].seq + 1))
    return tuple(found)


def _same(item: MissionItem, order: MissionItem) -> bool:
    if item.command != order.command:
        return False
    pairs = ((getattr(item, name), getattr(order, name)) for name in ("param1", "param2", "param3", "param4"))
    return all(held == meant or (math.isnan(held) and math.isnan(meant)) for held, meant in pairs)


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
