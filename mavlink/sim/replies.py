"""Messages the vehicle side builds and reads in more than one place."""

from __future__ import annotations

import struct
import zlib

from mavlink.wire.items import MissionItem, MissionResult, MissionType
from mavlink.wire.messages import Message

_TEXT_BYTES = 50


def status_text(severity: int, text: str) -> Message:
    """STATUSTEXT, cut at 50 characters; ``severity`` is MAV_SEVERITY (4 warning, 6 information)."""
    return Message("STATUSTEXT", {"severity": severity, "text": text[:_TEXT_BYTES], "id": 0, "chunk_seq": 0})


def received_item(message: Message, kind: MissionType) -> MissionItem:
    """The item in a MISSION_ITEM_INT, or in a MISSION_ITEM with its degrees in floating point."""
    x, y = message.number("x"), message.number("y")
    if message.name == "MISSION_ITEM":
        x, y = x * 1e7, y * 1e7
    return MissionItem(
        seq=message.integer("seq"),
        frame=message.integer("frame"),
        command=message.integer("command"),
        param1=message.number("param1"),
        param2=message.number("param2"),
        param3=message.number("param3"),
        param4=message.number("param4"),
        x=round(x),
        y=round(y),
        z=message.number("z"),
        current=message.integer("current") == 1,
        autocontinue=message.integer("autocontinue") != 0,
        mission_type=kind,
    )


def item_message(item: MissionItem, target: tuple[int, int], *, integer: bool) -> Message:
    """A stored item as MISSION_ITEM_INT, or as MISSION_ITEM where the ground station asked for that."""
    fields: dict[str, int | float] = {
        "target_system": target[0],
        "target_component": target[1],
        "seq": item.seq,
        "frame": item.frame,
        "command": item.command,
        "current": int(item.current),
        "autocontinue": int(item.autocontinue),
        "param1": item.param1,
        "param2": item.param2,
        "param3": item.param3,
        "param4": item.param4,
        "x": item.x if integer else item.x / 1e7,
        "y": item.y if integer else item.y / 1e7,
        "z": item.z,
        "mission_type": int(item.mission_type),
    }
    return Message("MISSION_ITEM_INT" if integer else "MISSION_ITEM", dict(fields))


def sender(message: Message) -> tuple[int, int]:
    """System and component to answer."""
    return message.system_id, message.component_id


def checksum(message: Message, before: int) -> int:
    """PX4's of the items so far: of frame, command, autocontinue, parameters and place, as sent."""
    whole = struct.pack("<BHB", *(message.integer(name) for name in ("frame", "command", "autocontinue")))
    numbers = (message.number(name) for name in ("param1", "param2", "param3", "param4", "x", "y", "z"))
    return zlib.crc32(whole + struct.pack("<7d", *numbers), before)


def acknowledgement(
    partner: tuple[int, int], kind: MissionType, result: MissionResult, opaque_id: int = 0
) -> Message:
    """MISSION_ACK to a ground station."""
    fields = {
        "target_system": partner[0],
        "target_component": partner[1],
        "type": int(result),
        "mission_type": int(kind),
        "opaque_id": opaque_id,
    }
    return Message("MISSION_ACK", fields)
