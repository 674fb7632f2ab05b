"""Reading QGroundControl's ``.plan``: every value looked at before it is used."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from mavlink.dialects import Autopilot, VehicleType
from mavlink.dialects.base import GLOBAL_FRAMES
from mavlink.formats.errors import FormatError
from mavlink.items import Command, Frame, MissionItem, MissionType, degrees_e7
from mavlink.mission import Mission, home_item, numbered, placed

_AUTOPILOTS: dict[int, Autopilot] = {3: "ardupilot", 12: "px4"}
_GENERIC = 0
_FIXED_WINGS = frozenset({1})
_MULTIROTORS = frozenset({2, 3, 4, 13, 14, 15, 29, 35})
_VTOLS = frozenset(range(19, 26))


def read_plan(text: str) -> Mission:
    """The mission, fence and rally points of a ``.plan`` file.

    For ArduPilot the planned home position becomes item 0. Surveys are read as the items they hold; other
    complex items hold none and are refused.

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
    root = _object(document, "the file")
    if root.get("fileType") != "Plan":
        raise FormatError(f"fileType is {root.get('fileType')!r}, 'Plan' is meant")
    _version(root, 1, "version")
    mission = _object(root.get("mission"), "mission")
    _version(mission, 2, "mission.version")
    notes: list[str] = []
    autopilot = _autopilot(mission, notes)
    home = _numbers(mission.get("plannedHomePosition"), 3, "mission.plannedHomePosition")
    home_altitude_m = 0.0 if math.isnan(home[2]) else home[2]
    place = _place(home[0], home[1], "mission.plannedHomePosition")
    items = _items(mission, autopilot)
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
    firmware = _integer(mission.get("firmwareType", _GENERIC), "mission.firmwareType")
    if firmware == _GENERIC:
        notes.append("the file names no autopilot: read as PX4's, without a home row")
        return "px4"
    if firmware not in _AUTOPILOTS:
        raise FormatError(f"mission.firmwareType {firmware} is neither ArduPilot (3) nor PX4 (12)")
    return _AUTOPILOTS[firmware]


def _vehicle_type(mission: dict[str, Any], notes: list[str]) -> VehicleType:
    kind = _integer(mission.get("vehicleType", _GENERIC), "mission.vehicleType")
    if kind in _MULTIROTORS:
        return "multirotor"
    if kind in _VTOLS:
        return "vtol"
    if kind not in _FIXED_WINGS:
        notes.append(f"the file's vehicle type {kind} is taken for a fixed wing")
    return "fixed_wing"


def _speed(mission: dict[str, Any]) -> float:
    speed_m_s = _number(mission.get("cruiseSpeed", 0.0), "mission.cruiseSpeed")
    return speed_m_s if math.isfinite(speed_m_s) else 0.0


def _items(mission: dict[str, Any], autopilot: Autopilot) -> tuple[MissionItem, ...]:
    """The items in order, jumps naming the numbers that the vehicle will give them."""
    entries = list(_entries(_list(mission.get("items"), "mission.items"), "mission.items"))
    first_seq = 1 if autopilot == "ardupilot" else 0
    by_jump_id: dict[int, int] = {}
    for seq, (name, entry) in enumerate(entries, start=first_seq):
        if entry.get("doJumpId") is not None:
            jump_id = _integer(entry["doJumpId"], f"{name}.doJumpId")
            if jump_id in by_jump_id:
                raise FormatError(f"{name}.doJumpId {jump_id} stands twice")
            by_jump_id[jump_id] = seq
    items: list[MissionItem] = []
    for name, entry in entries:
        item = _item(name, entry)
        if item.command == Command.DO_JUMP:
            target = by_jump_id.get(int(item.param1)) if math.isfinite(item.param1) else None
            if target is None:
                raise FormatError(f"{name} jumps to {item.param1:g}, and no item has that doJumpId")
            item = replace(item, param1=float(target))
        items.append(item)
    return tuple(items)


def _entries(entries: list[Any], name: str) -> Iterator[tuple[str, dict[str, Any]]]:
    """Simple items and those inside surveys, with their names."""
    for index, value in enumerate(entries):
        here = f"{name}[{index}]"
        entry = _object(value, here)
        if entry.get("type") == "SimpleItem":
            yield here, entry
            continue
        transects = entry.get("TransectStyleComplexItem")
        if entry.get("type") != "ComplexItem" or not isinstance(transects, dict):
            kind = entry.get("complexItemType", entry.get("type"))
            raise FormatError(f"{here} is of type {kind!r}, which holds no items")
        inner = f"{here}.TransectStyleComplexItem.Items"
        yield from _entries(_list(transects.get("Items"), inner), inner)


def _item(name: str, entry: dict[str, Any]) -> MissionItem:
    command = _integer(entry.get("command"), f"{name}.command")
    if not 0 <= command <= 65535:
        raise FormatError(f"{name}.command {command} is none")
    frame = _integer(entry.get("frame"), f"{name}.frame")
    values = _numbers(entry.get("params"), 7, f"{name}.params")
    # A place left open is written as null, the altitude of an item without one as 0.
    x, y = (0.0 if math.isnan(value) else value for value in values[4:6])
    scale = 1e7 if frame in GLOBAL_FRAMES else 1.0
    for value in (x, y):
        if abs(value * scale) > 2**31 - 1:
            raise FormatError(f"{name}.params: {value:g} is out of range for a place")
    autocontinue = entry.get("autoContinue", True)
    if not isinstance(autocontinue, bool):
        raise FormatError(f"{name}.autoContinue is {autocontinue!r}, true or false is meant")
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
    fence = _object(value, "geoFence")
    _version(fence, 2, "geoFence.version")
    items: list[MissionItem] = []
    for index, polygon in enumerate(_list(fence.get("polygons", []), "geoFence.polygons")):
        items += _polygon(polygon, f"geoFence.polygons[{index}]")
    for index, circle in enumerate(_list(fence.get("circles", []), "geoFence.circles")):
        items.append(_circle(circle, f"geoFence.circles[{index}]"))
    if fence.get("breachReturn") is not None:
        lat_deg, lon_deg, altitude_m = _numbers(fence["breachReturn"], 3, "geoFence.breachReturn")
        place = _place(lat_deg, lon_deg, "geoFence.breachReturn")
        items.append(placed(Command.NAV_FENCE_RETURN_POINT, place, altitude_m, Frame.GLOBAL))
    return numbered(items, MissionType.FENCE)


def _polygon(value: Any, name: str) -> list[MissionItem]:
    polygon = _object(value, name)
    corners = _list(polygon.get("polygon"), f"{name}.polygon")
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
        lat_deg, lon_deg = _numbers(corner, 2, f"{name}.polygon[{index}]")
        place = _place(lat_deg, lon_deg, f"{name}.polygon[{index}]")
        item = placed(command, place, 0.0, Frame.GLOBAL)
        items.append(replace(item, param1=float(len(corners))))
    return items


def _circle(value: Any, name: str) -> MissionItem:
    holder = _object(value, name)
    circle = _object(holder.get("circle"), f"{name}.circle")
    lat_deg, lon_deg = _numbers(circle.get("center"), 2, f"{name}.circle.center")
    radius_m = _number(circle.get("radius"), f"{name}.circle.radius")
    if not 0.0 < radius_m < math.inf:
        raise FormatError(f"{name}.circle.radius is {radius_m}")
    command = (
        Command.NAV_FENCE_CIRCLE_INCLUSION
        if holder.get("inclusion", True)
        else Command.NAV_FENCE_CIRCLE_EXCLUSION
    )
    place = _place(lat_deg, lon_deg, f"{name}.circle.center")
    return replace(placed(command, place, 0.0, Frame.GLOBAL), param1=radius_m)


def _rally(value: Any) -> tuple[MissionItem, ...]:
    if value is None:
        return ()
    rally = _object(value, "rallyPoints")
    _version(rally, 2, "rallyPoints.version")
    items = []
    for index, point in enumerate(_list(rally.get("points", []), "rallyPoints.points")):
        name = f"rallyPoints.points[{index}]"
        lat_deg, lon_deg, altitude_m = _numbers(point, 3, name)
        place = _place(lat_deg, lon_deg, name)
        items.append(placed(Command.NAV_RALLY_POINT, place, altitude_m, Frame.GLOBAL_RELATIVE_ALT))
    return numbered(items, MissionType.RALLY)


def _place(lat_deg: float, lon_deg: float, name: str) -> tuple[float, float]:
    """Longitude and latitude as the wire holds them."""
    if not (abs(lat_deg) <= 90.0 and abs(lon_deg) <= 180.0):
        raise FormatError(f"{name}: latitude {lat_deg}, longitude {lon_deg} is nowhere on Earth")
    return degrees_e7(lon_deg) / 1e7, degrees_e7(lat_deg) / 1e7


def _version(value: dict[str, Any], wanted: int, name: str) -> None:
    if value.get("version") != wanted:
        raise FormatError(f"{name} is {value.get('version')!r}, {wanted} is meant")


def _object(value: Any, name: str) -> dict[str, Any]:
    if not isinstance(value, dict):
        raise FormatError(f"{name} is no object")
    return value


def _list(value: Any, name: str) -> list[Any]:
    if not isinstance(value, list):
        raise FormatError(f"{name} is no list")
    return value


def _number(value: Any, name: str) -> float:
    """A number; null is NaN."""
    if value is None:
        return math.nan
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise FormatError(f"{name} is {value!r}, a number is meant")
    try:
        return float(value)
    except OverflowError:
        raise FormatError(f"{name} is too large") from None


def _integer(value: Any, name: str) -> int:
    number = _number(value, name)
    if not (math.isfinite(number) and number == round(number)):
        raise FormatError(f"{name} is {value!r}, a whole number is meant")
    return round(number)


def _numbers(value: Any, count: int, name: str) -> list[float]:
    numbers = [_number(entry, name) for entry in _list(value, name)]
    if len(numbers) != count:
        raise FormatError(f"{name} has {len(numbers)} numbers, {count} are meant")
    return numbers
