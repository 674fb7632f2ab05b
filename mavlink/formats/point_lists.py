"""Plain lists of places: the fences and rally points of ArduPilot's older tools, and of MAVProxy.

A fence is one ``latitude longitude`` a line: the place to return to, the corners of what must not be left,
and the first corner again. Rally points are lines of ``RALLY latitude longitude altitude break-altitude
heading flags``.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import replace

from mavlink.dialects import Autopilot, VehicleType
from mavlink.dialects.mission import Mission, declared_by, home_item, numbered
from mavlink.formats.columns import in_file, placed_exactly
from mavlink.formats.errors import FormatError
from mavlink.formats.notes import Notes
from mavlink.formats.wpl_rows import lines_of, plain_number
from mavlink.wire.items import Command, Frame, MissionItem, MissionType

_PAIR = re.compile(r"[-+0-9.]+\s+[-+0-9.]+\s*(#.*)?")
_RALLY = "rally"
#: Return point, three corners, and the first corner again.
_FEWEST_POINTS = 5


def is_point_list(text: str) -> bool:
    """Whether the first line that says something begins such a list."""
    first = next((content for _, content in _lines(text)), "")
    return first.lower().startswith(f"{_RALLY} ") or _PAIR.fullmatch(first) is not None


def read_point_list(
    text: str, autopilot: Autopilot = "ardupilot", vehicle_type: VehicleType | None = None
) -> Mission:
    """The fence or the rally points of a list, as a mission without items.

    Raises
    ------
    FormatError
        With the number of the line.
    """
    notes = Notes()
    lines = list(_lines(text))
    is_rally = bool(lines) and lines[0][1].lower().startswith(f"{_RALLY} ")
    items = _rally(lines, notes) if is_rally else _fence(lines, notes)
    lat_deg, lon_deg = in_file(items[0])
    notes.add("the list says no home: it is taken to be at its first place, its height is not known")
    return Mission(
        mission=numbered([home_item((lon_deg, lat_deg), 0.0)] if autopilot == "ardupilot" else []),
        fence=() if is_rally else numbered(items, MissionType.FENCE),
        rally=numbered(items, MissionType.RALLY) if is_rally else (),
        autopilot=autopilot,
        vehicle="",
        vehicle_type=vehicle_type or "fixed_wing",
        home=(lon_deg, lat_deg),
        notes=notes.lines(),
        declared=declared_by(autopilot, vehicle_type),
    )


def _lines(text: str) -> Iterator[tuple[int, str]]:
    for number, line in enumerate(lines_of(text), start=1):
        content = line.partition("#")[0].strip()
        if content:
            yield number, content


def _fence(lines: list[tuple[int, str]], notes: Notes) -> list[MissionItem]:
    places = [(number, _numbers(content.split(), 2, number)) for number, content in lines]
    if len(places) < _FEWEST_POINTS:
        raise FormatError(f"a fence of {len(places)} lines: {_FEWEST_POINTS} are the fewest", places[-1][0])
    corners = places[1:]
    if corners[0][1] == corners[-1][1]:
        corners = corners[:-1]
    else:
        notes.add("the fence is not closed: it is closed from its last corner to its first")
    back_to = _item(Command.NAV_FENCE_RETURN_POINT, places[0][1], 0.0, Frame.GLOBAL, places[0][0])
    return [
        back_to,
        *(
            replace(
                _item(Command.NAV_FENCE_POLYGON_VERTEX_INCLUSION, place, 0.0, Frame.GLOBAL, number),
                param1=float(len(corners)),
            )
            for number, place in corners
        ),
    ]


def _rally(lines: list[tuple[int, str]], notes: Notes) -> list[MissionItem]:
    items = []
    for number, content in lines:
        words = content.split()
        if words[0].lower() != _RALLY or len(words) != 7:
            raise FormatError(f"{content[:40]!r} is no rally point of seven words", number)
        lat_deg, lon_deg, altitude_m, break_m, heading_deg, flags = _numbers(words[1:], 6, number)
        if (break_m, heading_deg, flags) != (0.0, 0.0, 0.0):
            notes.add("break altitude, heading and flags of rally points are left out", "line", number)
        frame = Frame.GLOBAL_RELATIVE_ALT
        items.append(_item(Command.NAV_RALLY_POINT, (lat_deg, lon_deg), altitude_m, frame, number))
    return items


def _item(
    command: Command, place: tuple[float, ...], altitude_m: float, frame: Frame, number: int
) -> MissionItem:
    try:
        return placed_exactly(command, place[0], place[1], altitude_m, frame, "the place")
    except FormatError as error:
        raise FormatError(error.message, number) from error


def _numbers(words: list[str], count: int, number: int) -> tuple[float, ...]:
    if len(words) != count:
        raise FormatError(f"{count} numbers are meant, here are {len(words)}", number)
    try:
        values = tuple(plain_number(word) for word in words)
    except ValueError as error:
        raise FormatError(f"{' '.join(words)[:40]!r} are no numbers", number) from error
    if not all(math.isfinite(value) for value in values):
        raise FormatError(f"{' '.join(words)[:40]!r} are no places", number)
    return values
