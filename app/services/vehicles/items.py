"""Mission items, differences and states as plain JSON values."""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import Any

from mavlink.dialects.compare import Difference
from mavlink.state.telemetry import VehicleState
from mavlink.wire.items import Command, Frame, MissionItem

_PLACELESS = frozenset({int(Frame.MISSION)})
_NAMES = {int(command): command.name for command in Command}


def _number(value: float | None) -> float | None:
    """JSON has no NaN: what is unchanged or unset becomes null."""
    return None if value is None or not math.isfinite(value) else value


def item_json(item: MissionItem) -> dict[str, Any]:
    """A mission item; null stands for the protocol's NaN, "unchanged"."""
    body: dict[str, Any] = {
        "seq": item.seq,
        "command": int(item.command),
        "command_name": _NAMES.get(int(item.command)),
        "frame": int(item.frame),
        "params": [_number(value) for value in (item.param1, item.param2, item.param3, item.param4)],
        "x": item.x,
        "y": item.y,
        "altitude_m": _number(item.z),
        "current": item.current,
    }
    if int(item.frame) not in _PLACELESS and (item.x or item.y):
        body |= {"lat_deg": item.x / 1e7, "lon_deg": item.y / 1e7}
    return body


def difference_json(difference: Difference) -> dict[str, Any]:
    """One thing held otherwise than meant."""
    return {
        "seq": difference.seq,
        "field": difference.field,
        "meant": _number(difference.meant),
        "held": _number(difference.held),
        "message": str(difference),
    }


def state_json(state: VehicleState) -> dict[str, Any]:
    """A vehicle's state; null where it has not said."""
    body = asdict(state)
    # Told beside the state, or in a clock that is nobody else's.
    for name in ("heard_s", "position_heard_s", "sensor_since_s", "address", "strangers", "doubt", "signing"):
        del body[name]
    body["texts"] = [{"severity": text.severity, "text": text.text} for text in state.texts]
    return {name: _number(value) if isinstance(value, float) else value for name, value in body.items()}
