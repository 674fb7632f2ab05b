"""Mission items to messages and back.

Source: MAVLink ``common.xml``: MISSION_ITEM_INT (73) and MISSION_ITEM (39), whose x and y are degrees.
"""

from __future__ import annotations

import math
from typing import Final

from mavlink.wire.items import MissionItem, MissionType, degrees_e7
from mavlink.wire.messages import Message, Value

ITEM_NAMES: Final = frozenset({"MISSION_ITEM_INT", "MISSION_ITEM"})
ITEM_REQUESTS: Final = frozenset({"MISSION_REQUEST_INT", "MISSION_REQUEST"})

# In these frames x and y are metres × 1e4 on the integer wire (MAV_FRAME_LOCAL_*).
_LOCAL_FRAMES: Final = frozenset({1, 4, 7, 8, 9, 12, 13, 14, 15, 16, 17, 18, 19, 20, 21})
_MISSION_FRAME: Final = 2


def item_message(item: MissionItem, target_system: int, target_component: int) -> Message:
    """The MISSION_ITEM_INT that carries an item to a vehicle."""
    fields: dict[str, Value] = {
        "target_system": target_system,
        "target_component": target_component,
        "seq": item.seq,
        "frame": item.frame,
        "command": item.command,
        "current": int(item.current),
        "autocontinue": int(item.autocontinue),
        "param1": item.param1,
        "param2": item.param2,
        "param3": item.param3,
        "param4": item.param4,
        "x": item.x,
        "y": item.y,
        "z": item.z,
        "mission_type": int(item.mission_type),
    }
    return Message("MISSION_ITEM_INT", fields)


def message_item(message: Message) -> MissionItem:
    """The item in a MISSION_ITEM_INT, or in the older MISSION_ITEM, whose place is in degrees as float32.

    Raises
    ------
    ValueError
        The message carries no item, or its mission type is none of ours, or a float place is not finite.
    """
    if message.name not in ITEM_NAMES:
        raise ValueError(f"{message.name} carries no mission item")
    frame = message.integer("frame")
    if message.name == "MISSION_ITEM_INT":
        x, y = message.integer("x"), message.integer("y")
    else:
        x, y = (_float_place(message.number(axis), frame) for axis in ("x", "y"))
    return MissionItem(
        seq=message.integer("seq"),
        frame=frame,
        command=message.integer("command"),
        param1=message.number("param1"),
        param2=message.number("param2"),
        param3=message.number("param3"),
        param4=message.number("param4"),
        x=x,
        y=y,
        z=message.number("z"),
        current=bool(message.integer("current")),
        autocontinue=bool(message.integer("autocontinue")),
        mission_type=MissionType(message.integer("mission_type")),
    )


def opaque_id_of(message: Message) -> int | None:
    """The vehicle's id of a list, in its MISSION_ACK or MISSION_COUNT; None where it gives none (0)."""
    return message.integer("opaque_id") or None if "opaque_id" in message.fields else None


def _float_place(value: float, frame: int) -> int:
    if not math.isfinite(value):
        raise ValueError(f"a MISSION_ITEM is placed at {value}")
    if frame == _MISSION_FRAME:
        return round(value)
    return round(value * 1e4) if frame in _LOCAL_FRAMES else degrees_e7(value)
