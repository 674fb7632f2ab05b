"""QGroundControl's ``.plan`` file: JSON with mission, fence and rally points.

The home position stands in ``plannedHomePosition`` and is no item. Items are numbered by ``doJumpId`` from 1,
and jumps name that number. A parameter that is null is NaN.
"""

from __future__ import annotations

import json
import math
from typing import Any

from mavlink.dialects.base import CIRCLE_COMMANDS, GLOBAL_FRAMES, fence_shapes, is_polygon
from mavlink.dialects.mission import Declared, Mission
from mavlink.formats.columns import for_file, in_file
from mavlink.formats.errors import FormatError
from mavlink.formats.qgc_plan_read import read_plan
from mavlink.wire.items import Command, Frame, MissionItem

__all__ = ["FormatError", "read_plan", "write_plan"]

_AMSL = (Frame.GLOBAL, Frame.GLOBAL_INT)
#: QGroundControl's altitude modes by frame.
_ALTITUDE_MODES = {
    Frame.GLOBAL_RELATIVE_ALT: 1,
    Frame.GLOBAL_RELATIVE_ALT_INT: 1,
    Frame.GLOBAL: 2,
    Frame.GLOBAL_INT: 2,
    Frame.GLOBAL_TERRAIN_ALT: 4,
    Frame.GLOBAL_TERRAIN_ALT_INT: 4,
}


def write_plan(mission: Mission) -> str:
    """The mission, its fence and its rally points as a ``.plan`` file.

    Raises
    ------
    FormatError
        Where an item cannot be said in it.
    """
    dialect = mission.dialect
    items = mission.mission[1:] if dialect.home_row else mission.mission
    home = [mission.home[1], mission.home[0], mission.home_altitude_m]
    if dialect.home_row and mission.mission:
        row = mission.mission[0]
        home = [*in_file(row), row.z if row.frame in _AMSL else mission.home_altitude_m]
    first_jump_id = 1 - (items[0].seq if items else 0)
    document: dict[str, Any] = {
        "fileType": "Plan",
        "groundStation": "Swathplan",
        "version": 1,
        "geoFence": _fence(mission.fence),
        "mission": {
            "version": 2,
            **_vehicle(mission),
            "plannedHomePosition": home,
            "items": [_simple_item(item, first_jump_id) for item in items],
        },
        "rallyPoints": {
            "version": 2,
            "points": [[*in_file(item), item.z] for item in mission.rally],
        },
    }
    try:
        return json.dumps(document, indent=4, allow_nan=False) + "\n"
    except ValueError as error:
        raise FormatError(f"a .plan has no infinite numbers, and none that are open here: {error}") from error


def _vehicle(mission: Mission) -> dict[str, Any]:
    """What the file says of its vehicle: of a mission from a file what that said, and nothing else."""
    dialect = mission.dialect
    told = mission.declared
    if told is None:
        told = Declared(None, dialect.mav_type, mission.speed_m_s, mission.speed_m_s)
    firmware = dialect.firmware_type if told.firmware_type is None else told.firmware_type
    members = {
        "firmwareType": firmware,
        "vehicleType": told.mav_type,
        "cruiseSpeed": told.cruise_speed_m_s,
        "hoverSpeed": told.hover_speed_m_s,
        "globalPlanAltitudeMode": 1 if told.altitude_mode is None else told.altitude_mode,
    }
    return {name: value for name, value in members.items() if value is not None}


def _simple_item(told: MissionItem, first_jump_id: int) -> dict[str, Any]:
    item = for_file(told)
    param1 = item.param1
    if item.command == Command.DO_JUMP and math.isfinite(param1):
        param1 += first_jump_id
    x, y = in_file(item)
    entry: dict[str, Any] = {
        "autoContinue": item.autocontinue,
        "command": int(item.command),
        "doJumpId": item.seq + first_jump_id,
        "frame": int(item.frame),
        "params": [
            *(_null(value) for value in (param1, item.param2, item.param3, item.param4)),
            _null(x),
            _null(y),
            _null(item.z),
        ],
        "type": "SimpleItem",
    }
    mode = _ALTITUDE_MODES.get(Frame(item.frame)) if item.frame in GLOBAL_FRAMES else None
    if mode is not None:
        entry |= {"AMSLAltAboveTerrain": None, "Altitude": _null(item.z), "AltitudeMode": mode}
    return entry


def _null(value: float) -> float | None:
    return None if math.isnan(value) else value


def _fence(items: tuple[MissionItem, ...]) -> dict[str, Any]:
    polygons: list[dict[str, Any]] = []
    circles: list[dict[str, Any]] = []
    fence: dict[str, Any] = {"version": 2, "polygons": polygons, "circles": circles}
    for command, shape in fence_shapes(items):
        first = shape[0]
        place = list(in_file(first))
        if is_polygon(command):
            polygons.append(
                {
                    "version": 1,
                    "inclusion": command == Command.NAV_FENCE_POLYGON_VERTEX_INCLUSION,
                    "polygon": [list(in_file(item)) for item in shape],
                }
            )
        elif command in CIRCLE_COMMANDS:
            circles.append(
                {
                    "version": 1,
                    "inclusion": command == Command.NAV_FENCE_CIRCLE_INCLUSION,
                    "circle": {"center": place, "radius": first.param1},
                }
            )
        elif command == Command.NAV_FENCE_RETURN_POINT:
            fence["breachReturn"] = [*place, first.z]
        else:
            raise FormatError(f"command {command} is no part of a fence")
    return fence
