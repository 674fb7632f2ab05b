"""Reading QGroundControl's ``.plan`` and what was before it: every value looked at before it is used."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from typing import Any

from mavlink.dialects import Autopilot, VehicleType
from mavlink.dialects.mission import Declared, Mission, declared_by, home_item, numbered
from mavlink.formats.columns import first_place, from_file, in_file
from mavlink.formats.errors import FormatError
from mavlink.formats.members import integer_of, list_of, number_of, numbers_of, object_of, place_of
from mavlink.formats.notes import Notes
from mavlink.formats.qgc_fence import read_fence, read_rally
from mavlink.formats.qgc_items import read_items
from mavlink.formats.qgc_old import as_plan
from mavlink.formats.qgc_unread import members_of, tell_unknown
from mavlink.wire.items import MissionItem, MissionType

_AUTOPILOTS: dict[int, Autopilot] = {3: "ardupilot", 12: "px4"}
_GENERIC = 0
_TYPES: dict[int, VehicleType] = {
    1: "fixed_wing",
    **dict.fromkeys((2, 3, 4, 13, 14, 15, 29, 35), "multirotor"),
    **dict.fromkeys(range(19, 26), "vtol"),
}


def read_plan(
    text: str, autopilot: Autopilot | None = None, vehicle_type: VehicleType | None = None
) -> Mission:
    """The mission, fence and rally points of a ``.plan`` or ``.mission`` file.

    For ArduPilot the planned home position becomes item 0. Complex items are read as the items they stand
    for (see :mod:`mavlink.formats.qgc_complex`). What is odd in the fence or in the rally points is left out,
    told, and marked in ``unread``.

    Parameters
    ----------
    autopilot, vehicle_type
        Instead of those that the file names.

    Raises
    ------
    FormatError
        Naming the member that is wrong; with the line where the text is no JSON.
    """
    notes = Notes()
    root = as_plan(object_of(_document(text), "the file"), notes)
    tell_unknown(root, notes)
    mission = object_of(root.get("mission"), "mission")
    declared = _declared(mission)
    named = _AUTOPILOTS.get(declared.firmware_type or _GENERIC)
    if autopilot is not None and autopilot != named:
        declared = replace(declared, firmware_type=None)
    autopilot = autopilot or _autopilot(declared, notes)
    items = read_items(mission, autopilot, notes)
    home = _home(mission, items, notes)
    if autopilot == "ardupilot":
        items = (home, *items)
    fence, fence_whole = read_fence(root.get("geoFence"), notes)
    rally, rally_whole = read_rally(root.get("rallyPoints"), notes)
    partly = ((MissionType.FENCE, fence_whole), (MissionType.RALLY, rally_whole))
    kind = vehicle_type or _vehicle_type(declared, notes)
    if vehicle_type is not None and _TYPES.get(declared.mav_type or _GENERIC) != vehicle_type:
        declared = replace(declared, mav_type=declared_by(autopilot, vehicle_type).mav_type)
    lat_deg, lon_deg = in_file(home)
    return Mission(
        mission=numbered(list(items)),
        fence=fence,
        rally=rally,
        autopilot=autopilot,
        vehicle="",
        vehicle_type=kind,
        home=(lon_deg, lat_deg),
        notes=notes.lines(),
        home_altitude_m=home.z,
        speed_m_s=_speed(declared, kind),
        declared=declared,
        unread=frozenset(name for name, whole in partly if not whole),
    )


def _document(text: str) -> Any:
    try:
        return json.loads(text.removeprefix("\ufeff"), object_pairs_hook=members_of)
    except json.JSONDecodeError as error:
        raise FormatError(f"no JSON: {error.msg}", error.lineno) from error
    except RecursionError as error:
        raise FormatError("no plan: nested too deeply") from error
    except FormatError:
        raise
    except ValueError as error:
        raise FormatError("no plan: a number has too many digits") from error


def _declared(mission: dict[str, Any]) -> Declared:
    def whole(key: str) -> int | None:
        return None if mission.get(key) is None else integer_of(mission[key], f"mission.{key}")

    def speed_m_s(key: str) -> float | None:
        value = number_of(mission.get(key), f"mission.{key}")
        return value if math.isfinite(value) else None

    return Declared(
        whole("firmwareType"),
        whole("vehicleType"),
        speed_m_s("cruiseSpeed"),
        speed_m_s("hoverSpeed"),
        whole("globalPlanAltitudeMode"),
    )


def _autopilot(declared: Declared, notes: Notes) -> Autopilot:
    firmware = declared.firmware_type
    if firmware is not None and firmware in _AUTOPILOTS:
        return _AUTOPILOTS[firmware]
    named = (
        "the file names no autopilot"
        if firmware in (None, _GENERIC)
        else f"mission.firmwareType {firmware} is neither ArduPilot (3) nor PX4 (12)"
    )
    notes.add(f"{named}: read as PX4's, without a home row")
    return "px4"


def _vehicle_type(declared: Declared, notes: Notes) -> VehicleType:
    kind = declared.mav_type or _GENERIC
    if kind == _GENERIC:
        notes.add("the file does not say its vehicle: a fixed wing is assumed; say which (--type)")
    elif kind not in _TYPES:
        notes.add(f"the file's vehicle type {kind} is taken for a fixed wing")
    return _TYPES.get(kind, "fixed_wing")


def _speed(declared: Declared, kind: VehicleType) -> float:
    speed_m_s = declared.hover_speed_m_s if kind == "multirotor" else declared.cruise_speed_m_s
    return speed_m_s or 0.0


def _home(mission: dict[str, Any], items: tuple[MissionItem, ...], notes: Notes) -> MissionItem:
    """Home as an item; at the first place of the mission where the file does not say."""
    name = "mission.plannedHomePosition"
    told = mission.get("plannedHomePosition")
    if told is not None and len(list_of(told, name)) == 2:
        told = [*told, None]
    lat_deg, lon_deg, altitude_m = (math.nan,) * 3 if told is None else numbers_of(told, 3, name)
    if math.isnan(lat_deg) and math.isnan(lon_deg):
        place = first_place(items)
        where = "not known" if place is None else "at the first place of the mission"
        notes.add(f"{name} is not told: home is {where}, its height is not known")
        lat_deg, lon_deg = place or (0.0, 0.0)
        altitude_m = 0.0
    elif math.isnan(altitude_m):
        notes.add(f"{name} has no altitude: 0 is taken")
        altitude_m = 0.0
    return replace(
        from_file(home_item(place_of(lat_deg, lon_deg, name), altitude_m), lat_deg, lon_deg), z=altitude_m
    )
