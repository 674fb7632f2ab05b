"""QGroundControl's structure scan: rounds about a building, one above the other, as mission items."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

from shapely.geometry import LinearRing, Polygon

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
from mavlink.wire.geometry import LocalMap
from mavlink.wire.geometry import distance_m as between_m
from mavlink.wire.items import Command, Frame, MissionItem
from planner.plan import LonLat

_VERSION = 3
_MAX_LAYERS = 1000
_MAX_LENGTH_M = 10_000.0
_MIN_AREA_M2 = 0.01
#: A corner sharper than this many distances is cut off.
_MITRE_LIMIT = 10.0
_YAW_TO_STRUCTURE_DEG = 90.0


def structure_scan(entry: dict[str, Any], name: str, autopilot: Autopilot) -> list[MissionItem]:
    """The items of one scan.

    The round flown is the structure's outline moved outwards by the camera's distance to the surface; layers
    stand one footprint apart, the first half a footprint from where the scan starts.

    Raises
    ------
    FormatError
        Where the version is another, a member is missing, or the outline is no polygon.
    """
    version = integer_of(entry.get("version"), f"{name}.version")
    if version != _VERSION:
        raise FormatError(f"{name}.version is {version}, {_VERSION} is meant")
    camera = object_of(entry.get("CameraCalc"), f"{name}.CameraCalc")
    layer_m = _length(camera, f"{name}.CameraCalc", "AdjustedFootprintFrontal")
    trigger_m = _length(camera, f"{name}.CameraCalc", "AdjustedFootprintSide")
    distance_m = _length(camera, f"{name}.CameraCalc", "DistanceToSurface")
    layers = integer_of(entry.get("Layers"), f"{name}.Layers")
    if not 1 <= layers <= _MAX_LAYERS:
        raise FormatError(f"{name}.Layers is {layers}")
    from_top = boolean_of(entry.get("StartFromTop"), f"{name}.StartFromTop")
    start_m = _height(entry, name, "StructureHeight" if from_top else "ScanBottomAlt")
    step_m = -layer_m if from_top else layer_m
    entrance_m = _height(entry, name, "EntranceAltitude")
    pitch_deg = _height(entry, name, "GimbalPitch")
    if abs(pitch_deg) > 180.0:
        raise FormatError(f"{name}.GimbalPitch is {pitch_deg:g}")
    corners = _outwards(_outline(entry, name), distance_m, name)
    gate = _waypoint(corners[0], entrance_m)
    look = unplaced(Command.DO_SET_ROI_WPNEXT_OFFSET)
    items = [gate, replace(look, x=round(pitch_deg), z=_YAW_TO_STRUCTURE_DEG)]
    for layer in range(layers):
        altitude_m = start_m + step_m * (layer + 0.5)
        items.append(_waypoint(corners[0], altitude_m))
        items.append(unplaced(Command.DO_SET_CAM_TRIGG_DIST, (trigger_m, 0.0, 1.0, 0.0)))
        items += [_waypoint(corner, altitude_m) for corner in (*corners[1:], corners[0])]
        items.append(unplaced(Command.DO_SET_CAM_TRIGG_DIST))
    return [*items, unplaced(Command.DO_SET_ROI_NONE), gate]


def _waypoint(place: LonLat, altitude_m: float) -> MissionItem:
    return placed(
        Command.NAV_WAYPOINT, place, altitude_m, Frame.GLOBAL_RELATIVE_ALT, (0.0, 0.0, 0.0, math.nan)
    )


def _length(members: dict[str, Any], name: str, key: str) -> float:
    value = number_of(members.get(key), f"{name}.{key}")
    if not 0.0 < value <= _MAX_LENGTH_M:
        raise FormatError(f"{name}.{key} is {value}, a length of at most {_MAX_LENGTH_M:g} m is meant")
    return value


def _height(entry: dict[str, Any], name: str, key: str) -> float:
    value = number_of(entry.get(key), f"{name}.{key}")
    if not abs(value) <= _MAX_LENGTH_M:
        raise FormatError(f"{name}.{key} is {value}, at most {_MAX_LENGTH_M:g} is meant")
    return value


def _outline(entry: dict[str, Any], name: str) -> list[LonLat]:
    corners = list_of(entry.get("polygon"), f"{name}.polygon")
    if len(corners) < 3:
        raise FormatError(f"{name}.polygon has {len(corners)} corners")
    outline: list[LonLat] = []
    for index, corner in enumerate(corners):
        here = f"{name}.polygon[{index}]"
        lat_deg, lon_deg = numbers_of(corner, 2, here)
        outline.append(place_of(lat_deg, lon_deg, here))
    return outline


def _outwards(corners: list[LonLat], distance_m: float, name: str) -> list[LonLat]:
    """The outline moved outwards, in the file's order, beginning nearest to its first corner."""
    if any(between_m(corners[0], corner) > _MAX_LENGTH_M for corner in corners):
        raise FormatError(f"{name}.polygon is larger than {_MAX_LENGTH_M / 1000.0:g} km")
    local = LocalMap(corners[0])
    outline = Polygon([local.xy(corner) for corner in corners])
    if not outline.is_valid or outline.area < _MIN_AREA_M2:
        raise FormatError(f"{name}.polygon is no simple polygon")
    grown = outline.buffer(distance_m, join_style="mitre", mitre_limit=_MITRE_LIMIT)
    ring = list(grown.exterior.coords)[:-1]
    if LinearRing(ring).is_ccw != LinearRing(outline.exterior.coords).is_ccw:
        ring.reverse()
    first = outline.exterior.coords[0]
    start = min(range(len(ring)), key=lambda index: math.dist(ring[index], first))
    return [local.lonlat((xy[0], xy[1])) for xy in (*ring[start:], *ring[:start])]
