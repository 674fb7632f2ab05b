"""The rows of a ``QGC WPL`` text file, in every way in which the ecosystem's readers take them.

Lines of comment and blank lines are passed over, columns may be divided by tabs, blanks or both, and the
number in front of a row may be any: like pymavlink and QGroundControl, rows count in the order in which they
stand.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from mavlink.formats.columns import from_file
from mavlink.formats.errors import FormatError
from mavlink.formats.members import LARGEST
from mavlink.formats.notes import Notes
from mavlink.formats.places import check_place
from mavlink.wire.items import Command, MissionItem, MissionType

HEADER = "QGC WPL 110"
#: Versions that can be read; 120 has no home row, 100 other columns and commands of its own.
OLDEST, STRICT, HOMELESS = "100", "110", "120"

COLUMNS = (
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
#: Where the columns of 110 stand in a row of 100: index, current, frame, command, parameters, place, rest.
_OLDEST_ORDER = (0, 7, 1, 2, 5, 6, 3, 4, 9, 8, 10, 12)
_OLDEST_COMMANDS: dict[int, Command] = {
    2: Command.NAV_TAKEOFF,
    3: Command.NAV_RETURN_TO_LAUNCH,
    4: Command.NAV_LAND,
    24: Command.NAV_TAKEOFF,
    25: Command.NAV_WAYPOINT,
    26: Command.NAV_LAND,
    27: Command.NAV_LOITER_UNLIM,
}
_DECIMAL_COMMA = re.compile(r"[+-]?\d+,\d+")
_LINE_END = re.compile(r"\r\n|\n|\r")


@dataclass(frozen=True, slots=True)
class Row:
    """One row: its line, the number in front of it, and its item, numbered by where it stands."""

    line: int
    index: int
    item: MissionItem


def lines_of(text: str) -> list[str]:
    """The lines of a text, whatever ends them, without a byte order mark."""
    return _LINE_END.split(text.removeprefix("\ufeff"))


def plain_number(word: str) -> float:
    """A number of ASCII digits: Python reads ``1_000`` and other alphabets' digits, other stations read 0.

    Raises
    ------
    ValueError
        It is none.
    """
    if "_" in word or not word.isascii():
        raise ValueError(word)
    return float(word)


def read_rows(text: str, notes: Notes) -> tuple[str, list[Row]]:
    """The version and the rows of a file.

    Raises
    ------
    FormatError
        With the number of the line, and the name of the column where one is wrong.
    """
    version: str | None = None
    rows: list[Row] = []
    lines = lines_of(text)
    last = max((number for number, line in enumerate(lines, start=1) if line.strip()), default=1)
    for number, line in enumerate(lines, start=1):
        content = line.partition("#")[0].strip()
        if not content:
            if line.strip():
                notes.add("the comments are left out", "line", number)
            elif number < last:
                notes.add("blank lines are passed over", "line", number)
        elif version is None:
            version = _version(content, number)
        else:
            rows.append(_row(line.partition("#")[0], number, len(rows), version, notes))
    if version is None:
        raise FormatError(f"the file must begin with {HEADER!r}, it begins with ''", 1)
    return version, rows


def _version(line: str, number: int) -> str:
    words = line.split()
    if words[:2] != HEADER.split()[:2]:
        raise FormatError(f"the file must begin with {HEADER!r}, it begins with {line[:40]!r}", number)
    version = " ".join(words[2:])[:20]
    if version not in (OLDEST, STRICT, HOMELESS):
        raise FormatError(f"the version is {version!r}, {HEADER!r} is meant", number, "version")
    return version


def _row(line: str, number: int, seq: int, version: str, notes: Notes) -> Row:
    fields = _fields(line, number, 13 if version == OLDEST else 12, notes)
    if version == OLDEST:
        fields = [fields[column] for column in _OLDEST_ORDER]
    index = _integer(fields, 0, number)
    frame = _integer(fields, 2, number)
    command = _integer(fields, 3, number)
    if version == OLDEST:
        if command not in _OLDEST_COMMANDS:
            raise FormatError(f"version {OLDEST} has no command {command}", number, "command")
        command = int(_OLDEST_COMMANDS[command])
    if not 0 <= command <= 65535:
        raise FormatError(f"command {command} is none", number, "command")
    if not 0 <= frame <= 255:
        raise FormatError(f"frame {frame} is none", number, "frame")
    if _integer(fields, 11, number) not in (0, 1):
        notes.add("autocontinue is neither 0 nor 1: it is taken for 1", "line", number)
    if index != seq and version != OLDEST:
        notes.add("rows are numbered in the order in which they stand", "line", number)
    param1, param2, param3, param4 = (_float(fields, column, number) for column in range(4, 8))
    bare = MissionItem(
        seq,
        frame,
        command,
        param1=param1,
        param2=param2,
        param3=param3,
        param4=param4,
        z=_float(fields, 10, number),
        current=_integer(fields, 1, number) != 0,
        autocontinue=_integer(fields, 11, number) != 0,
        mission_type=MissionType.MISSION,
    )
    return Row(number, index, _placed(bare, fields, number))


def _fields(line: str, number: int, meant: int, notes: Notes) -> list[str]:
    tabbed = [field.strip() for field in line.strip("\r\n").split("\t")]
    if len(tabbed) == meant and "" in tabbed:
        # QGroundControl reads an empty column as 0.
        notes.add("empty columns are read as 0", "line", number)
        return [field or "0" for field in tabbed]
    fields = line.split()
    if "\t" in line.strip() and len(tabbed) != len(fields):
        notes.add("tabs and blanks both divide the columns", "line", number)
    found = len(fields)
    if found < meant:
        missing = COLUMNS[min(found, len(COLUMNS) - 1)]
        raise FormatError(
            f"{meant} columns are meant, here are {found}: {missing} is missing", number, missing
        )
    if found > meant:
        junk = " ".join(fields[meant:])[:40]
        raise FormatError(f"{meant} columns are meant, here are {found}: {junk!r} is too much", number)
    return fields


def _placed(bare: MissionItem, fields: list[str], number: int) -> MissionItem:
    first, second = (_float(fields, column, number) for column in (8, 9))
    if not (math.isnan(first) or math.isnan(second)):
        problem = check_place(bare.command, bare.frame, first, second)
        if problem and math.isfinite(first) and math.isfinite(second):
            raise FormatError(problem, number, problem.split()[0])
    for value, column in ((first, 8), (second, 9)):
        try:
            from_file(bare, value, 0.0)
        except FormatError as error:
            found = fields[column]
            message = f"{COLUMNS[column]} {found!r} is out of range"
            raise FormatError(message, number, COLUMNS[column]) from error
    return from_file(bare, first, second)


def _integer(fields: list[str], column: int, number: int) -> int:
    value = _float(fields, column, number)
    if not (math.isfinite(value) and value == round(value)):
        raise FormatError(f"{COLUMNS[column]} {fields[column]!r} is no whole number", number, COLUMNS[column])
    return round(value)


def _float(fields: list[str], column: int, number: int) -> float:
    found = fields[column]
    try:
        value = plain_number(found)
        if abs(value) > LARGEST:
            message = (
                f"{COLUMNS[column]} {found[:40]!r} is too large: vehicles hold numbers up to {LARGEST:.2g}"
            )
            raise FormatError(message, number, COLUMNS[column])
    except FormatError:
        raise
    except ValueError:
        comma = ": write a point for the comma" if _DECIMAL_COMMA.fullmatch(found) else ""
        message = f"{COLUMNS[column]} {found[:40]!r} is no number{comma}"
        raise FormatError(message, number, COLUMNS[column]) from None
    return value
