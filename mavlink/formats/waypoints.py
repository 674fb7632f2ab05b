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
from mavlink.dialects.mission import Mission, home_item
from mavlink.formats.errors import FormatError
from mavlink.formats.places import check_place
from mavlink.wire.items import Command, Frame, MissionItem, MissionType

HEADER = "QGC WPL 110"

_DECIMAL_COMMA = re.compile(r"[+-]?\d+,\d+")
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
        With the number of the line, and the name of the column where one is wrong.
    """
    lines = _LINE_END.split(text.removeprefix("\ufeff"))
    while lines and not lines[-1].strip():
        lines.pop()
    _check_header(lines[0] if lines else "")
    items = [_read_row(line, number, number - 2) for number, line in enumerate(lines[1:], start=2)]
    if not items:
        raise FormatError("the home row is missing", 2)
    home = items[0]
    if home.command != Command.NAV_WAYPOINT or home.frame == Frame.MISSION:
        raise FormatError(f"row 0 must be the home position, it holds command {home.command}", 2, "command")
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


def _check_header(line: str) -> None:
    words = line.split()
    if words == HEADER.split():
        return
    if words[:2] == HEADER.split()[:2]:
        found = " ".join(words[2:])[:20]
        raise FormatError(f"the version is {found!r}, {HEADER!r} is meant", 1, "version")
    raise FormatError(f"the file must begin with {HEADER!r}, it begins with {line.strip()[:40]!r}", 1)


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
    _check_count(fields, number)
    index = _integer(fields, 0, number)
    if index != seq:
        raise FormatError(f"item {index} stands where item {seq} belongs", number, "index")
    frame = _integer(fields, 2, number)
    command = _integer(fields, 3, number)
    if not 0 <= command <= 65535:
        raise FormatError(f"command {command} is none", number, "command")
    param1, param2, param3, param4 = (_float(fields, column, number) for column in range(4, 8))
    x, y = _place(fields, command, frame, number)
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


def _check_count(fields: list[str], number: int) -> None:
    meant, found = len(_COLUMNS), len(fields)
    if found < meant:
        missing = _COLUMNS[found] if found else _COLUMNS[0]
        raise FormatError(
            f"{meant} columns are meant, here are {found}: {missing} is missing", number, missing
        )
    if found > meant:
        junk = " ".join(fields[meant:])[:40]
        raise FormatError(f"{meant} columns are meant, here are {found}: {junk!r} is too much", number)


def _place(fields: list[str], command: int, frame: int, number: int) -> tuple[int, int]:
    values = [_float(fields, column, number) for column in (8, 9)]
    scale = 1.0 if frame == Frame.MISSION else 1e7
    problem = check_place(command, frame, *values)
    if problem and all(math.isfinite(value) for value in values):
        raise FormatError(problem, number, "longitude" if problem.startswith("longitude") else "latitude")
    for value, column in zip(values, (8, 9), strict=True):
        if not math.isfinite(value) or abs(value * scale) > 2**31 - 1:
            raise FormatError(
                f"{_COLUMNS[column]} {fields[column].strip()!r} is out of range", number, _COLUMNS[column]
            )
    return round(values[0] * scale), round(values[1] * scale)


def _integer(fields: list[str], column: int, number: int) -> int:
    value = _float(fields, column, number)
    if not (math.isfinite(value) and value == round(value)):
        found = fields[column].strip()
        raise FormatError(f"{_COLUMNS[column]} {found!r} is no whole number", number, _COLUMNS[column])
    return round(value)


def _float(fields: list[str], column: int, number: int) -> float:
    found = fields[column].strip()
    try:
        return float(found)
    except ValueError:
        comma = ": write a point for the comma" if _DECIMAL_COMMA.fullmatch(found) else ""
        message = f"{_COLUMNS[column]} {found[:40]!r} is no number{comma}"
        raise FormatError(message, number, _COLUMNS[column]) from None
