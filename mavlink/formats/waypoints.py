"""The plain-text waypoint file, ``QGC WPL 110``.

A header line, then one line an item with twelve columns divided by tabs: index, current, frame, command,
four parameters, latitude, longitude, altitude, autocontinue. Line 0 is the home position for every
autopilot; for ArduPilot it is item 0 of the mission too. Fence and rally points have no place in it.
"""

from __future__ import annotations

import math
import re
from dataclasses import replace

from mavlink.dialects import Autopilot, VehicleType
from mavlink.formats.errors import FormatError
from mavlink.items import Command, Frame, MissionItem, MissionType
from mavlink.mission import Mission, home_item

HEADER = "QGC WPL 110"

_LINE_END = re.compile(r"\r\n|\n|\r")

_COLUMNS = (
    "index",
    "current",
    "frame",
    "command",
    "param 1",
    "param 2",
    "param 3",
    "param 4",
    "latitude",
    "longitude",
    "altitude",
    "autocontinue",
)


def write_waypoints(mission: Mission) -> str:
    """The mission as a waypoint file; fence and rally points are left out.

    Jump targets count from the home row in the file, as ArduPilot counts them.
    """
    if mission.dialect.home_row:
        rows = list(mission.mission)
        if not rows:
            rows = [home_item(mission.home, mission.home_altitude_m)]
    else:
        rows = [home_item(mission.home, mission.home_altitude_m)]
        rows += [_shifted(item, 1) for item in mission.mission]
    lines = [HEADER, *(_row(replace(item, current=item.seq == 0)) for item in rows)]
    return "\n".join(lines) + "\n"


def read_waypoints(
    text: str, autopilot: Autopilot = "ardupilot", vehicle_type: VehicleType = "fixed_wing"
) -> Mission:
    """The mission of a waypoint file.

    Parameters
    ----------
    text
        The file; lines may end in LF, CR LF or both mixed, blank lines at the end are left out.
    autopilot, vehicle_type
        For whom it is: the file does not say.

    Raises
    ------
    FormatError
        With the number of the line.
    """
    lines = _LINE_END.split(text.removeprefix("\ufeff"))
    while lines and not lines[-1].strip():
        lines.pop()
    if not lines or lines[0].split() != HEADER.split():
        found = lines[0].strip()[:40] if lines else ""
        raise FormatError(f"the file must begin with {HEADER!r}, it begins with {found!r}", 1)
    items = [_read_row(line, number, number - 2) for number, line in enumerate(lines[1:], start=2)]
    if not items:
        raise FormatError("the home row is missing", 2)
    home = items[0]
    if home.command != Command.NAV_WAYPOINT or home.frame == Frame.MISSION:
        raise FormatError(f"line 0 must be the home position, it holds command {home.command}", 2)
    if autopilot == "px4":
        items = [_shifted(item, -1) for item in items[1:]]
    return Mission(
        mission=tuple(replace(item, current=seq == 0) for seq, item in enumerate(items)),
        fence=(),
        rally=(),
        autopilot=autopilot,
        vehicle="",
        vehicle_type=vehicle_type,
        home=(home.y / 1e7, home.x / 1e7),
        home_altitude_m=home.z,
    )


def _shifted(item: MissionItem, by: int) -> MissionItem:
    """The item renumbered, its jump target moved along."""
    if item.command == Command.DO_JUMP:
        return replace(item, seq=item.seq + by, param1=item.param1 + by)
    return replace(item, seq=item.seq + by)


def _row(item: MissionItem) -> str:
    if item.frame == Frame.MISSION:
        x, y = str(item.x), str(item.y)
    else:
        x, y = _degrees(item.x), _degrees(item.y)
    numbers = (item.param1, item.param2, item.param3, item.param4)
    return "\t".join(
        (
            str(item.seq),
            str(int(item.current)),
            str(int(item.frame)),
            str(int(item.command)),
            *(_number(value) for value in numbers),
            x,
            y,
            _number(item.z),
            str(int(item.autocontinue)),
        )
    )


def _number(value: float) -> str:
    return "nan" if math.isnan(value) else repr(float(value))


def _degrees(value_e7: int) -> str:
    return f"{value_e7 / 1e7:.7f}"


def _read_row(line: str, number: int, seq: int) -> MissionItem:
    # Some programs write spaces for tabs.
    fields = line.split("\t") if "\t" in line else line.split()
    if len(fields) != len(_COLUMNS):
        raise FormatError(f"{len(_COLUMNS)} columns are meant, here are {len(fields)}", number)
    index = _integer(fields, 0, number)
    if index != seq:
        raise FormatError(f"item {index} stands where item {seq} belongs", number)
    frame = _integer(fields, 2, number)
    command = _integer(fields, 3, number)
    if not 0 <= command <= 65535:
        raise FormatError(f"command {command} is none", number)
    param1, param2, param3, param4 = (_float(fields, column, number) for column in range(4, 8))
    x, y = _place(fields, frame, number)
    altitude_m = _float(fields, 10, number)
    return MissionItem(
        seq,
        frame,
        command,
        param1=param1,
        param2=param2,
        param3=param3,
        param4=param4,
        x=x,
        y=y,
        z=altitude_m,
        current=_integer(fields, 1, number) != 0,
        autocontinue=_integer(fields, 11, number) != 0,
        mission_type=MissionType.MISSION,
    )


def _place(fields: list[str], frame: int, number: int) -> tuple[int, int]:
    values = [_float(fields, column, number) for column in (8, 9)]
    scale = 1.0 if frame == Frame.MISSION else 1e7
    for value, column in zip(values, (8, 9), strict=True):
        if not math.isfinite(value) or abs(value * scale) > 2**31 - 1:
            raise FormatError(f"{_COLUMNS[column]} {fields[column].strip()!r} is out of range", number)
    return round(values[0] * scale), round(values[1] * scale)


def _integer(fields: list[str], column: int, number: int) -> int:
    value = _float(fields, column, number)
    if not (math.isfinite(value) and value == round(value)):
        raise FormatError(f"{_COLUMNS[column]} {fields[column].strip()!r} is no whole number", number)
    return round(value)


def _float(fields: list[str], column: int, number: int) -> float:
    try:
        return float(fields[column])
    except ValueError:
        raise FormatError(f"{_COLUMNS[column]} {fields[column].strip()!r} is no number", number) from None
