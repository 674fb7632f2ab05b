"""Fence and rally points of a ``.plan``: what is odd in them is left out and told, and stops no mission."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from mavlink.dialects.mission import numbered
from mavlink.formats.columns import placed_exactly
from mavlink.formats.errors import FormatError
from mavlink.formats.members import list_of, number_of, numbers_of, object_of
from mavlink.formats.notes import Notes
from mavlink.wire.items import Command, Frame, MissionItem, MissionType

_VERSION = 2


def read_fence(value: Any, notes: Notes) -> tuple[tuple[MissionItem, ...], bool]:
    """The items of ``geoFence``, and whether it was read whole."""
    if value is None:
        return (), True
    try:
        shapes = list(_shapes(object_of(value, "geoFence"), notes))
    except FormatError as error:
        notes.add(f"{error.message}: the fence is left out")
        return (), False
    items: list[MissionItem] = []
    whole = True
    for read, shape, name in shapes:
        try:
            items += read(shape, name, notes)
        except FormatError as error:
            notes.add(f"{error.message}: this part of the fence is left out")
            whole = False
    return numbered(items, MissionType.FENCE), whole


def read_rally(value: Any, notes: Notes) -> tuple[tuple[MissionItem, ...], bool]:
    """The items of ``rallyPoints``, and whether they were read whole."""
    if value is None:
        return (), True
    try:
        rally = object_of(value, "rallyPoints")
        points = list_of(rally.get("points", []), "rallyPoints.points")
        if points:
            _tell_version(rally, "rallyPoints", notes)
    except FormatError as error:
        notes.add(f"{error.message}: the rally points are left out")
        return (), False
    items: list[MissionItem] = []
    whole = True
    for index, point in enumerate(points):
        name = f"rallyPoints.points[{index}]"
        try:
            lat_deg, lon_deg, altitude_m = numbers_of(point, 3, name)
            if not math.isfinite(altitude_m):
                raise FormatError(f"{name} has no altitude")
            frame = Frame.GLOBAL_RELATIVE_ALT
            items.append(placed_exactly(Command.NAV_RALLY_POINT, lat_deg, lon_deg, altitude_m, frame, name))
        except FormatError as error:
            notes.add(f"{error.message}: this rally point is left out")
            whole = False
    return numbered(items, MissionType.RALLY), whole


def _tell_version(block: dict[str, Any], name: str, notes: Notes) -> None:
    version = block.get("version")
    if version != _VERSION:
        notes.add(f"{name}.version is {version!r}, {_VERSION} is written: it is read as that")


def _shapes(fence: dict[str, Any], notes: Notes) -> Iterator[tuple[Any, Any, str]]:
    """Each shape with what reads it, and its name."""
    polygons = list_of(fence.get("polygons") or [], "geoFence.polygons")
    circles = list_of(fence.get("circles") or [], "geoFence.circles")
    oldest = list_of(fence.get("polygon") or [], "geoFence.polygon")
    back_to = fence.get("breachReturn")
    if polygons or circles or oldest or back_to is not None:
        _tell_version(fence, "geoFence", notes)
    for index, polygon in enumerate(polygons):
        yield _polygon, polygon, f"geoFence.polygons[{index}]"
    if oldest:
        # Version 1 has one polygon, which must not be left.
        yield _polygon, {"polygon": oldest, "inclusion": True}, "geoFence"
    for index, circle in enumerate(circles):
        yield _circle, circle, f"geoFence.circles[{index}]"
    if back_to is not None:
        yield _return_point, back_to, "geoFence.breachReturn"


def _inclusion(holder: dict[str, Any], name: str, *, otherwise: bool, notes: Notes) -> bool:
    value = holder.get("inclusion")
    if isinstance(value, bool):
        return value
    if value is not None:
        raise FormatError(f"{name}.inclusion is {value!r}, true or false is meant")
    word = "must not be left" if otherwise else "must not be entered"
    notes.add(f"{name} does not say its inclusion: it is taken for one that {word}, as MAVSDK takes it")
    return otherwise


def _polygon(value: Any, name: str, notes: Notes) -> list[MissionItem]:
    polygon = object_of(value, name)
    corners = list_of(polygon.get("polygon"), f"{name}.polygon")
    if not corners:
        notes.add(f"{name}.polygon is empty: it fences nothing")
        return []
    if len(corners) < 3:
        raise FormatError(f"{name}.polygon has {len(corners)} corners")
    inclusion = _inclusion(polygon, name, otherwise=True, notes=notes)
    command = (
        Command.NAV_FENCE_POLYGON_VERTEX_INCLUSION
        if inclusion
        else Command.NAV_FENCE_POLYGON_VERTEX_EXCLUSION
    )
    items = []
    for index, corner in enumerate(corners):
        here = f"{name}.polygon[{index}]"
        lat_deg, lon_deg = numbers_of(corner, 2, here)
        item = placed_exactly(command, lat_deg, lon_deg, 0.0, Frame.GLOBAL, here)
        items.append(replace(item, param1=float(len(corners))))
    return items


def _circle(value: Any, name: str, notes: Notes) -> list[MissionItem]:
    holder = object_of(value, name)
    circle = object_of(holder.get("circle"), f"{name}.circle")
    lat_deg, lon_deg = numbers_of(circle.get("center"), 2, f"{name}.circle.center")
    radius_m = number_of(circle.get("radius"), f"{name}.circle.radius")
    if not 0.0 < radius_m < math.inf:
        raise FormatError(f"{name}.circle.radius is {radius_m}")
    inclusion = _inclusion(holder, name, otherwise=False, notes=notes)
    command = Command.NAV_FENCE_CIRCLE_INCLUSION if inclusion else Command.NAV_FENCE_CIRCLE_EXCLUSION
    item = placed_exactly(command, lat_deg, lon_deg, 0.0, Frame.GLOBAL, f"{name}.circle.center")
    return [replace(item, param1=radius_m)]


def _return_point(value: Any, name: str, notes: Notes) -> list[MissionItem]:
    place = list_of(value, name)
    if len(place) == 2:
        notes.add(f"{name} has no altitude: 0 is taken")
        place = [*place, 0.0]
    lat_deg, lon_deg, altitude_m = numbers_of(place, 3, name)
    return [placed_exactly(Command.NAV_FENCE_RETURN_POINT, lat_deg, lon_deg, altitude_m, Frame.GLOBAL, name)]
