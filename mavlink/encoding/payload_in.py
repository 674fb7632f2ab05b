"""What a mission of somebody else's switches: read from its items, as ours are encoded."""

from __future__ import annotations

from mavlink.dialects.mission import Mission
from mavlink.encoding.payload import (
    CameraPayload,
    ImagePayload,
    Payload,
    PayloadError,
    RelayPayload,
    ServoPayload,
)
from mavlink.wire.items import Command, MissionItem


def payload_in(mission: Mission) -> Payload | None:
    """The first payload that the items switch on; None where they switch none that is known."""
    for item in mission.mission:
        try:
            found = _switched_on(item)
        except (PayloadError, ValueError):
            # An output or an interval that none of ours has.
            continue
        if found is not None:
            return found
    return None


def _switched_on(item: MissionItem) -> Payload | None:
    match item.command:
        case Command.DO_SET_CAM_TRIGG_DIST if item.param1 > 0.0:
            return CameraPayload(item.param1)
        case Command.IMAGE_START_CAPTURE if item.param2 > 0.0:
            return ImagePayload(item.param2)
        case Command.DO_SET_RELAY if item.param2 == 1.0:
            return RelayPayload(int(item.param1))
        case Command.DO_SET_SERVO:
            return ServoPayload(int(item.param1), on_pwm_us=int(item.param2))
    return None
