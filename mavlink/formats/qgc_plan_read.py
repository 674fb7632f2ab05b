"""Reading QGroundControl's ``.plan``: every value looked at before it is used."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from typing import Any

from mavlink.dialects import Autopilot, VehicleType
from mavlink.dialects.base import GLOBAL_FRAMES
from mavlink.dialects.mission import Mission, home_item, numbered, placed
from mavlink.formats.errors import FormatError
from mavlink.formats.members import (
    boolean_of,
    check_version,
    integer_of,
    list_of,
    number_of,
    numbers_of,
    object_of,
    place_of,
)
from mavlink.formats.places import check_place
from mavlink.formats.qgc_complex import expand
from mavlink.wire.items import Command, Frame, MissionItem, MissionType

_AUTOPILOTS: dict[int, Autopilot] = {3: "ardupilot", 12: "px4"}
_GENERIC = 0
_FIXED_WINGS = frozenset({1})
_MULTIROTORS = frozenset({2, 3, 4, 13, 14, 15, 29, 35})
_VTOLS = frozenset(range(19, 26))


def read_plan(text: str) -> Mission:
    """The mission, fence and rally points of a ``.plan`` file.

    For ArduPilot the planned home position becomes item 0. Complex items are read as the items they stand
    for (see :mod:`mavlink.formats.qgc_complex`).

    Raises
    ------
    FormatError
        Naming the member that is wrong; with the line where the text is no JSON.
    """
    try:
        document = json.loads(text.removeprefix("\ufeff"))
    except json.JSONDecodeError as error:
        raise FormatError(f"no JSON: {error.msg}", error.lineno) from error
    except RecursionError as error:
        raise FormatError("no plan: nested too deeply") from error
    root = object_of(document, "the file")
    if root.get("fileType") != "Plan":
        raise FormatError(f"fileType is {root.get('fileType')!r}, 'Plan' is meant")
    check_version(root, 1, "version")
    mission = object_of(root.get("mission"), "mission")
    check_version(mission, 2, "mission.version")
    notes: list[str] = []
    autopilot = _autopilot(mission, notes)
    home = numbers_of(mission.get("plannedHomePosition"), 3, "mission.plannedHomePosition")
    home_altitude_m = 0.0 if math.isnan(home[2]) else home[2]
    place = place_of(home[0], home[1], "mission.plannedHomePosition")
    items = _items(mission, autopilot, notes)
    if autopilot == "ardupilot":
        items = (home_item(place, home_altitude_m), *items)
    return Mission(
        mission=numbered(list(items)),
        fence=_fence(root.get("geoFence")),
        rally=_rally(root.get("rallyPoints")),
        autopilot=autopilot,
        vehicle="",
        vehicle_type=_vehicle_type(mission, notes),
        home=place,
        notes=tuple(notes),
        home_altitude_m=home_altitude_m,
        speed_m_s=_speed(mission),
    )


def _autopilot(mission: dict[str, Any], notes: list[str]) -> Autopilot:
    firmware = integer_of(mission.get("firmwareType", _GENERIC), "mission.firmwareType")
    if firmware == _GENERIC:
        notes.append("the file names no autopilot: read as PX4's, without a home row")
        return "px4"
    if firmware not in _AUTOPILOTS:
        raise FormatError(f"mission.firmwareType {firmware} is neither ArduPilot (3) nor PX4 (12)")
    return _AUTOPILOTS[firmware]


def _vehicle_type(mission: dict[str, Any], notes: list[str]) -> VehicleType:
    kind = integer_of(mission.get("vehicleType", _GENERIC), "mission.vehicleType")
    if kind in _MULTIROTORS:
        return "multirotor"
    if kind in _VTOLS:
        return "vtol"
    if kind not in _FIXED_WINGS:
        notes.append(f"the file's vehicle type {kind} is taken for a fixed wing")
    return "fixed_wing"


def _speed(mission: dict[str, Any]) -> float:
    speed_m_s = number_of(mission.get("cruiseSpeed", 0.0), "mission.cruiseSpeed")
    return speed_m_s if math.isfinite(speed_m_s) else 0.0


def _items(mission: dict[str, Any], autopilot: Autopilot, notes: list[str]) -> tuple[MissionItem, ...]:
    """The items in order, jumps naming the numbers that the vehicle will give them.

    The numbers inside complex items can be stale and stand twice: a simple item's number counts before them.
    """
    first_seq = 1 if autopilot == "ardupilot" else 0
    by_jump_id: dict[int, int] = {}
    inside: dict[int, int] = {}
    items: list[MissionItem] = []
    jumps: list[tuple[int, str]] = []
    for index, value in enumerate(list_of(mission.get("items"), "mission.items")):
        name = f"mission.items[{index}]"
        entry = object_of(value, name)
        if entry.get("type") != "SimpleItem":
            for inner_id, item in _expanded(entry, name, autopilot, notes):
                if inner_id is not None:
                    inside.setdefault(inner_id, len(items) + first_seq)
                items.append(item)
            continue
        if entry.get("doJumpId") is not None:
            jump_id = integer_of(entry["doJumpId"], f"{name}.doJumpId")
            if jump_id in by_jump_id:
                raise FormatError(f"{name}.doJumpId {jump_id} stands twice")
            by_jump_id[jump_id] = len(items) + first_seq
        item = _item(name, entry)
        if item.command == Command.DO_JUMP:
            jumps.append((len(items), name))
        items.append(item)
    targets = inside | by_jump_id
    for place, name in jumps:
        jump_to = items[place].param1
        target = targets.get(int(jump_to)) if math.isfinite(jump_to) else None
        if target is None:
            raise FormatError(f"{name} jumps to {jump_to:g}, and no item has that doJumpId")
        items[place] = replace(items[place], param1=float(target))
    return tuple(items)


def _expanded(
    entry: dict[str, Any], name: str, autopilot: Autopilot, notes: list[str]
) -> list[tuple[int | None, MissionItem]]:
    """The items that a complex item stands for, each with the number the file gives it."""
    found: list[tuple[int | None, MissionItem]] = []
    for inner, part in expand(entry, name, autopilot, notes):
        if isinstance(part, MissionItem):
            found.append((None, part))
            continue
        item = _item(inner, part)
        if item.command == Command.DO_JUMP:
            raise FormatError(f"{inner} jumps, which nothing inside a complex item can")
        number = part.get("doJumpId")
        found.append((None if number is None else integer_of(number, f"{inner}.doJumpId"), item))
    return found


def _item(name: str, entry: dict[str, Any]) -> MissionItem:
    command = integer_of(entry.get("command"), f"{name}.command")
    if not 0 <= command <= 65535:
        raise FormatError(f"{name}.command {command} is none")
    frame = integer_of(entry.get("frame"), f"{name}.frame")
    values = numbers_of(entry.get("params"), 7, f"{name}.params")
    # A place left open is written as null, the altitude of an item without one as 0.
    x, y = (0.0 if math.isnan(value) else value for value in values[4:6])
    scale = 1e7 if frame in GLOBAL_FRAMES else 1.0
    for value in (x, y):
        if abs(value * scale) > 2**31 - 1:
            raise FormatError(f"{name}.params: {value:g} is out of range for a place")
    problem = check_place(command, frame, x, y)
    if problem:
        raise FormatError(f"{name}.params: {problem}")
    autocontinue = boolean_of(entry.get("autoContinue", True), f"{name}.autoContinue")
    return MissionItem(
        0,
        frame,
        command,
        param1=values[0],
        param2=values[1],
        param3=values[2],
        param4=values[3],
        x=round(x * scale),
        y=round(y * scale),
        z=values[6],
        autocontinue=autocontinue,
    )


def _fence(value: Any) -> tuple[MissionItem, ...]:
    if value is None:
        return ()
    fence = object_of(value, "geoFence")
    check_version(fence, 2, "geoFence.version")
    items: list[MissionItem] = []
    for index, polygon in enumerate(list_of(fence.get("polygons", []), "geoFence.polygons")):
        items += _polygon(polygon, f"geoFence.polygons[{index}]")
    for index, circle in enumerate(list_of(fence.get("circles", []), "geoFence.circles")):
        items.append(_circle(circle, f"geoFence.circles[{index}]"))
    if fence.get("breachReturn") is not None:
        lat_deg, lon_deg, altitude_m = numbers_of(fence["breachReturn"], 3, "geoFence.breachReturn")
        place = place_of(lat_deg, lon_deg, "geoFence.breachReturn")
        items.append(placed(Command.NAV_FENCE_RETURN_POINT, place, altitude_m, Frame.GLOBAL))
    return numbered(items, MissionType.FENCE)


def _polygon(value: Any, name: str) -> list[MissionItem]:
    polygon = object_of(value, name)
    corners = list_of(polygon.get("polygon"), f"{name}.polygon")
    if len(corners) < 3:
        raise FormatError(f"{name}.polygon has {len(corners)} corners")
    inclusion = polygon.get("inclusion", True)
    command = (
        Command.NAV_FENCE_POLYGON_VERTEX_INCLUSION
        if inclusion
        else Command.NAV_FENCE_POLYGON_VERTEX_EXCLUSION
    )
    items = []
    for index, corner in enumerate(corners):
        lat_deg, lon_deg = numbers_of(corner, 2, f"{name}.polygon[{index}]")
        place = place_of(lat_deg, lon_deg, f"{name}.polygon[{index}]")
        item = placed(command, place, 0.0, Frame.GLOBAL)
        items.append(replace(item, param1=float(len(corners))))
    return items


def _circle(value: Any, name: str) -> MissionItem:
    holder = object_of(value, name)
    circle = object_of(holder.get("circle"), f"{name}.circle")
    lat_deg, lon_deg = numbers_of(circle.get("center"), 2, f"{name}.circle.center")
    radius_m = number_of(circle.get("radius"), f"{name}.circle.radius")
    if not 0.0 < radius_m < math.inf:
        raise FormatError(f"{name}.circle.radius is {radius_m}")
    command = (
        Command.NAV_FENCE_CIRCLE_INCLUSION
        if holder.get("inclusion", True)
        else Command.NAV_FENCE_CIRCLE_EXCLUSION
    )
    place = place_of(lat_deg, lon_deg, f"{name}.circle.center")
    return replace(placed(command, place, 0.0, Frame.GLOBAL), param1=radius_m)


def _rally(value: Any) -> tuple[MissionItem, ...]:
    if value is None:
        return ()
    rally = object_of(value, "rallyPoints")
    check_version(rally, 2, "rallyPoints.version")
    items = []
    for index, point in enumerate(list_of(rally.get("points", []), "rallyPoints.points")):
        name = f"rallyPoints.points[{index}]"
        lat_deg, lon_deg, altitude_m = numbers_of(point, 3, name)
        place = place_of(lat_deg, lon_deg, name)
        items.append(placed(Command.NAV_RALLY_POINT, place, altitude_m, Frame.GLOBAL_RELATIVE_ALT))
    return numbered(items, MissionType.RALLY)
