"""QGroundControl's complex items as the mission items they stand for.

Surveys and corridor scans carry their items in ``TransectStyleComplexItem.Items``: these are read as they
stand, and the camera settings beside them are not needed. Landing patterns and structure scans carry their
settings alone; their items are made anew, as QGroundControl's plan file format and user guide describe them:

- ``fwLandingPattern`` and ``vtolLandingPattern``: DO_LAND_START, the approach's airspeed where it has one,
  the wish to stop photos or video, the final approach (LOITER_TO_ALT with exit along the tangent, or a
  WAYPOINT), then LAND or VTOL_LAND.
- ``StructureScan``: entrance, camera to the structure, one closed round a layer with the camera triggered by
  distance, camera back, exit.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import Any

from mavlink.dialects import Autopilot
from mavlink.dialects.mission import placed, unplaced
from mavlink.formats.errors import FormatError
from mavlink.formats.members import (
    boolean_of,
    integer_of,
    list_of,
    number_of,
    numbers_of,
    object_of,
    place_of,
)
from mavlink.formats.notes import Notes
from mavlink.formats.qgc_structure import structure_scan
from mavlink.wire.items import Command, Frame, MissionItem
from planner.plan import LonLat

#: A part of a complex item: its name in the file, and a simple item still to be read or an item made anew.
Part = tuple[str, "dict[str, Any] | MissionItem"]


def expand(entry: dict[str, Any], name: str, autopilot: Autopilot, notes: Notes) -> Iterator[Part]:
    """The items that one complex item stands for.

    Parameters
    ----------
    entry, name
        The complex item and its place in the file.
    notes
        Gets a line for what was made anew.

    Raises
    ------
    FormatError
        Where it is of an unknown kind or version, or lacks a member.
    """
    kind = entry.get("complexItemType", entry.get("type"))
    transects = entry.get("TransectStyleComplexItem")
    if entry.get("type") != "ComplexItem":
        raise FormatError(f"{name} is of type {kind!r}, which holds no items")
    if isinstance(transects, dict):
        yield from _transects(transects, f"{name}.TransectStyleComplexItem")
        return
    maker = _MAKERS.get(kind) if isinstance(kind, str) else None
    if maker is None:
        raise FormatError(f"{name} is of type {kind!r}, which holds no items")
    made = maker(entry, name, autopilot)
    notes.add(f"{name}: the {len(made)} items of the {kind} are made from its settings")
    for item in made:
        yield name, item


def _transects(transects: dict[str, Any], name: str) -> Iterator[Part]:
    if "Items" not in transects:
        raise FormatError(f"{name} has no Items: open the plan in QGroundControl and save it again")
    for index, value in enumerate(list_of(transects["Items"], f"{name}.Items")):
        here = f"{name}.Items[{index}]"
        entry = object_of(value, here)
        if entry.get("type", "SimpleItem") != "SimpleItem":
            raise FormatError(f"{here} is of type {entry.get('type')!r}, a SimpleItem is meant")
        yield here, entry


def _fixed_wing_landing(entry: dict[str, Any], name: str, autopilot: Autopilot) -> list[MissionItem]:
    version = integer_of(entry.get("version"), f"{name}.version")
    if version not in (1, 2):
        raise FormatError(f"{name}.version is {version}, 1 or 2 is meant")
    # version 1 says it twice; where the two differ, relative is the reading that stays near the ground
    relative = (
        boolean_of(entry.get("loiterAltitudeRelative"), f"{name}.loiterAltitudeRelative")
        or boolean_of(entry.get("landAltitudeRelative"), f"{name}.landAltitudeRelative")
        if version == 1
        else boolean_of(entry.get("altitudesAreRelative"), f"{name}.altitudesAreRelative")
    )
    return _landing(entry, name, autopilot, Command.NAV_LAND, relative=relative)


def _vtol_landing(entry: dict[str, Any], name: str, autopilot: Autopilot) -> list[MissionItem]:
    version = integer_of(entry.get("version"), f"{name}.version")
    if version != 1:
        raise FormatError(f"{name}.version is {version}, 1 is meant")
    relative = boolean_of(entry.get("altitudesAreRelative"), f"{name}.altitudesAreRelative")
    return _landing(entry, name, autopilot, Command.NAV_VTOL_LAND, relative=relative)


def _landing(
    entry: dict[str, Any], name: str, autopilot: Autopilot, land: Command, *, relative: bool
) -> list[MissionItem]:
    frame = Frame.GLOBAL_RELATIVE_ALT if relative else Frame.GLOBAL
    key = "landingApproachCoordinate" if "landingApproachCoordinate" in entry else "loiterCoordinate"
    approach, approach_m = _coordinate(entry, name, key)
    touchdown, land_m = _coordinate(entry, name, "landCoordinate")
    items = [unplaced(Command.DO_LAND_START)]
    if _flag(entry, name, "useDoChangeSpeed", default=False):
        speed_m_s = number_of(entry.get("finalApproachSpeed"), f"{name}.finalApproachSpeed")
        if not 0.0 < speed_m_s < math.inf:
            raise FormatError(f"{name}.finalApproachSpeed is {speed_m_s}")
        # airspeed, throttle unchanged
        items.append(unplaced(Command.DO_CHANGE_SPEED, (0.0, speed_m_s, -1.0, 0.0)))
    if _flag(entry, name, "stopTakingPhotos", default=False):
        # ArduPilot refuses NaN in the camera's reserved fields
        open_value = 0.0 if autopilot == "ardupilot" else math.nan
        items.append(unplaced(Command.DO_SET_CAM_TRIGG_DIST))
        items.append(unplaced(Command.IMAGE_STOP_CAPTURE, (0.0, open_value, open_value, open_value)))
    if _flag(entry, name, "stopVideoPhotos", default=False):
        items.append(unplaced(Command.VIDEO_STOP_CAPTURE))
    if _flag(entry, name, "useLoiterToAlt", default=True):
        radius_m = number_of(entry.get("loiterRadius"), f"{name}.loiterRadius")
        if not 0.0 < radius_m < math.inf:
            raise FormatError(f"{name}.loiterRadius is {radius_m}")
        clockwise = boolean_of(entry.get("loiterClockwise"), f"{name}.loiterClockwise")
        # heading required, exit on the tangent
        parameters = (1.0, radius_m if clockwise else -radius_m, 0.0, 1.0)
        items.append(placed(Command.NAV_LOITER_TO_ALT, approach, approach_m, frame, parameters))
    else:
        parameters = (0.0, 0.0, 0.0, math.nan)
        items.append(placed(Command.NAV_WAYPOINT, approach, approach_m, frame, parameters))
    yaw = math.nan if land == Command.NAV_VTOL_LAND else 0.0
    items.append(placed(land, touchdown, land_m, frame, (0.0, 0.0, 0.0, yaw)))
    return items


def _coordinate(entry: dict[str, Any], name: str, key: str) -> tuple[LonLat, float]:
    lat_deg, lon_deg, altitude_m = numbers_of(entry.get(key), 3, f"{name}.{key}")
    if not math.isfinite(altitude_m):
        raise FormatError(f"{name}.{key} has no altitude")
    return place_of(lat_deg, lon_deg, f"{name}.{key}"), altitude_m


def _flag(entry: dict[str, Any], name: str, key: str, *, default: bool) -> bool:
    return boolean_of(entry.get(key, default), f"{name}.{key}")


_MAKERS: dict[str, Callable[[dict[str, Any], str, Autopilot], list[MissionItem]]] = {
    "fwLandingPattern": _fixed_wing_landing,
    "vtolLandingPattern": _vtol_landing,
    "StructureScan": structure_scan,
}
