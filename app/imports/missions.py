"""Fences and rally points of ground stations: their plans, waypoint files, and the lists of MAVProxy."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

from app.imports.circles import inner_circle
from app.imports.errors import file_error
from app.imports.shapes import LonLat, Shape
from mavlink.formats import FormatError, read_mission
from mavlink.formats.columns import in_file
from mavlink.wire.items import Command, MissionItem, MissionType

_POLYGONS = {
    Command.NAV_FENCE_POLYGON_VERTEX_INCLUSION: "area",
    Command.NAV_FENCE_POLYGON_VERTEX_EXCLUSION: "no_fly",
}


def shapes_of_mission(data: bytes, notes: list[str], surveys: Sequence[Shape] = ()) -> list[Shape]:
    """The surveys, the fence and the rally points; other items are no regions, and are left out with a note.

    Raises
    ------
    RegionFileError
        Where it is no mission file, or holds neither.
    """
    try:
        mission = read_mission(data)
    except FormatError as error:
        raise file_error("mission-file", str(error), "mend the file where it says") from error
    if MissionType.FENCE in mission.unread:
        # what is left out of it could be what forbids
        raise file_error("fence-not-whole", "; ".join(mission.notes)[:500], "mend the fence where it says")
    # of a structure the settings count, not the items made of them
    notes += [note for note in mission.notes if not (surveys and note.endswith(" from its settings"))]
    shapes = [*surveys, *_fence(mission.fence, notes)]
    for index, item in enumerate(mission.rally, 1):
        shapes.append(Shape("point", (((_place(item),),),), f"rally {index}", ("rally",), {"role": "base"}))
    if not shapes:
        raise file_error(
            "no-regions",
            "the file holds a mission, and neither surveys nor fence nor rally points",
            "convert reads missions",
        )
    if surveys:
        notes.append("the aircraft is not taken over: name it in vehicles; items of surveys are planned anew")
    elif len(mission.mission) > 1:
        notes.append(f"{len(mission.mission)} items of a mission are no regions and are left out")
    return shapes


def _fence(items: Sequence[MissionItem], notes: list[str]) -> list[Shape]:
    shapes: list[Shape] = []
    for command, run in groupby(items, key=lambda item: item.command):
        some = list(run)
        if command in _POLYGONS:
            for corners in _by_count(some):
                ring = (*map(_place, corners), _place(corners[0]))
                shapes.append(_shape("polygon", ring, _POLYGONS[Command(command)], len(shapes), {}))
        elif command == Command.NAV_FENCE_CIRCLE_EXCLUSION:
            for item in some:
                radius = {"radius_m": repr(item.param1)}
                shapes.append(_shape("point", (_place(item),), "no_fly", len(shapes), radius))
        elif command == Command.NAV_FENCE_CIRCLE_INCLUSION:
            for item in some:
                ring = inner_circle(_place(item), item.param1)
                shapes.append(_shape("polygon", ring, "area", len(shapes), {}))
        else:
            notes.append("the return point of the fence is left out")
    return shapes


def _shape(kind: str, ring: tuple[LonLat, ...], role: str, number: int, more: dict[str, str]) -> Shape:
    name = f"fence {number + 1}"
    return Shape(
        "point" if kind == "point" else "polygon", ((ring,),), name, ("fence",), {"role": role} | more
    )


def _by_count(items: Sequence[MissionItem]) -> list[Sequence[MissionItem]]:
    """Corners by polygon: each says how many its polygon has."""
    found: list[Sequence[MissionItem]] = []
    at = 0
    while at < len(items):
        count = max(1, int(items[at].param1))
        found.append(items[at : at + count])
        at += count
    return found


def _place(item: MissionItem) -> LonLat:
    lat_deg, lon_deg = in_file(item)
    return lon_deg, lat_deg
