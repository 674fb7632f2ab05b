"""The plain-text waypoint file, ``QGC WPL 110``.

A header line, then one line an item with twelve columns divided by tabs: index, current, frame, command,
four parameters, latitude, longitude, altitude, autocontinue. Line 0 is the home position for every
autopilot; for ArduPilot it is item 0 of the mission too. A file holds a mission, a fence or rally points, as
Mission Planner keeps them; a file that mixes them is read and split.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

from mavlink.dialects import Autopilot, VehicleType
from mavlink.dialects.base import CIRCLE_COMMANDS, GLOBAL_FRAMES, fence_shapes, is_polygon
from mavlink.dialects.mission import Mission, declared_by, home_item, numbered
from mavlink.formats.columns import first_place, for_file, in_file
from mavlink.formats.errors import FormatError
from mavlink.formats.notes import Notes
from mavlink.formats.places import check_place
from mavlink.formats.wpl_rows import HEADER, HOMELESS, OLDEST, STRICT, Row, read_rows
from mavlink.wire.items import Command, Frame, MissionItem, MissionType

__all__ = ["HEADER", "held_by_waypoints", "read_waypoints", "write_waypoints"]

_FENCE = frozenset(range(Command.NAV_FENCE_RETURN_POINT, Command.NAV_FENCE_CIRCLE_EXCLUSION + 1))
#: Mission Planner once wrote its home row with this command.
_NO_COMMAND = 0


def held_by_waypoints(mission: Mission) -> MissionType:
    """The one list that a waypoint file of this mission holds."""
    if len(mission.mission) > (1 if mission.dialect.home_row else 0) or not (mission.fence or mission.rally):
        return MissionType.MISSION
    return MissionType.FENCE if mission.fence else MissionType.RALLY


def write_waypoints(mission: Mission) -> str:
    """The mission as a waypoint file; of fence and rally points the first, where there is no mission.

    Jump targets count from the home row in the file, as ArduPilot counts them. A parameter that is NaN is 0
    for ArduPilot, which has no open ones.
    """
    kind = held_by_waypoints(mission)
    home = _home_row(mission)
    if kind is not MissionType.MISSION:
        rows = [home, *(replace(item, seq=item.seq + 1) for item in mission.items_of(kind))]
    elif mission.dialect.home_row:
        rows = list(mission.mission) or [home]
    else:
        rows = [home, *(_shifted(item, 1) for item in mission.mission)]
    closed = mission.autopilot == "ardupilot"
    lines = [HEADER, *(_row(replace(for_file(item), current=item.seq == 0), closed) for item in rows)]
    return "\n".join(lines) + "\n"


def _home_row(mission: Mission) -> MissionItem:
    row = home_item(mission.home, mission.home_altitude_m)
    lon_deg, lat_deg = mission.home
    return row if in_file(row) == (lat_deg, lon_deg) else replace(row, written=(lat_deg, lon_deg))


def read_waypoints(
    text: str, autopilot: Autopilot = "ardupilot", vehicle_type: VehicleType | None = None
) -> Mission:
    """The mission, fence or rally points of a waypoint file, or all of them where they are mixed.

    Parameters
    ----------
    text
        The file; see :mod:`mavlink.formats.wpl_rows` for what is mended.
    autopilot, vehicle_type
        For whom it is: the file does not say. Without a type a fixed wing is assumed, with a note.

    Raises
    ------
    FormatError
        With the number of the line, and the name of the column where one is wrong.
    """
    notes = Notes()
    version, rows = read_rows(text, notes)
    if version != STRICT:
        notes.add(f"the file is of version {version}, {STRICT} is written")
    home, rows_ahead = _home(version, rows, notes)
    lists = _split(rows, rows_ahead)
    for row in rows[1:]:
        if row.item.current:
            notes.add(
                "the mark of the current item is left out: a mission begins with its first", "line", row.line
            )
    if home is None:
        home = _assumed_home(rows, "there is no home row", notes)
    elif not all(map(math.isfinite, in_file(home))):
        home = _assumed_home(rows[1:], "the home row has no place", notes)
    elif not math.isfinite(home.z):
        notes.add("home has no altitude: 0 is taken")
        home = replace(home, z=0.0)
    items = list(_mission(lists.mission, _Shift(rows, lists, autopilot, rows_ahead), notes))
    if autopilot == "ardupilot":
        items = [home, *items]
    if vehicle_type is None:
        notes.add("the file does not say its vehicle: a fixed wing is assumed; say which (--type)")
    first, second = in_file(home)
    fence = numbered([row.item for row in lists.fence], MissionType.FENCE)
    odd = [shape[0].seq for command, shape in fence_shapes(fence) if _is_odd(command, shape)]
    for seq in odd:
        notes.add("this part of the fence is no shape", "fence item", seq)
    return Mission(
        mission=numbered(items),
        fence=fence,
        rally=numbered([row.item for row in lists.rally], MissionType.RALLY),
        autopilot=autopilot,
        vehicle="",
        vehicle_type=vehicle_type or "fixed_wing",
        home=(second, first),
        notes=notes.lines(),
        home_altitude_m=home.z if home.frame in (Frame.GLOBAL, Frame.GLOBAL_INT) else 0.0,
        declared=declared_by(autopilot, vehicle_type),
        unread=frozenset({MissionType.FENCE} if odd else ()),
    )


def _is_odd(command: int, shape: tuple[MissionItem, ...]) -> bool:
    """Whether a part of a fence fences nothing: a circle without a radius, a polygon of two corners."""
    if command in CIRCLE_COMMANDS:
        return not 0.0 < shape[0].param1 < math.inf
    return is_polygon(command) and len(shape) < 3


def _home(version: str, rows: list[Row], notes: Notes) -> tuple[MissionItem | None, int]:
    """The home row, and how many rows it takes; None where there is none."""
    if not rows or version in (OLDEST, HOMELESS):
        return None, 0
    item, line = rows[0].item, rows[0].line
    if item.command == _NO_COMMAND and item.frame in GLOBAL_FRAMES:
        problem = check_place(Command.NAV_WAYPOINT, item.frame, *in_file(item))
        if problem and all(map(math.isfinite, in_file(item))):
            raise FormatError(problem, line, problem.split()[0])
        notes.add("home has command 0, 16 is meant", "line", line)
        return replace(item, command=int(Command.NAV_WAYPOINT)), 1
    if item.command != Command.NAV_WAYPOINT or item.frame not in GLOBAL_FRAMES:
        return None, 0
    if item.frame not in (Frame.GLOBAL, Frame.GLOBAL_INT):
        notes.add(
            f"the first row is home, and its frame {item.frame} does not say its height above the sea",
            "line",
            line,
        )
    return item, 1


def _assumed_home(rows: list[Row], why: str, notes: Notes) -> MissionItem:
    """Home at the first place of a file that does not say where it is."""
    found = first_place(row.item for row in rows)
    if found is None:
        notes.add(f"{why}, and no item has a place: home is not known")
        return home_item((0.0, 0.0), 0.0)
    notes.add(f"{why}: home is taken to be at the first place, its height is not known")
    lat_deg, lon_deg = found
    return home_item((lon_deg, lat_deg), 0.0)


@dataclass(frozen=True, slots=True)
class _Lists:
    mission: list[Row]
    fence: list[Row]
    rally: list[Row]


def _split(rows: list[Row], rows_ahead: int) -> _Lists:
    lists = _Lists([], [], [])
    for row in rows[rows_ahead:]:
        if row.item.command in _FENCE:
            lists.fence.append(_somewhere(row, "part of a fence"))
        elif row.item.command == Command.NAV_RALLY_POINT:
            lists.rally.append(_somewhere(row, "rally point"))
        else:
            lists.mission.append(row)
    return lists


def _somewhere(row: Row, what: str) -> Row:
    """The row, whose place is one: a corner left open would go to the vehicle as 0, 0."""
    item = row.item
    if item.frame not in GLOBAL_FRAMES:
        raise FormatError(f"a {what} in frame {item.frame} has no place: 0 or 3 is meant", row.line, "frame")
    for value, column in zip((*in_file(item), item.z), ("latitude", "longitude", "altitude"), strict=True):
        if not math.isfinite(value):
            raise FormatError(f"a {what} whose {column} is {value} has no place", row.line, column)
    return row


class _Shift:
    """Where a jump of the file leads, by the numbers that the vehicle gives its items."""

    def __init__(self, rows: list[Row], lists: _Lists, autopilot: Autopilot, rows_ahead: int) -> None:
        first = 1 if autopilot == "ardupilot" else 0
        self._by = first - rows_ahead
        self._mixed = bool(lists.fence or lists.rally)
        self._targets = {row.item.seq: number for number, row in enumerate(lists.mission, start=first)}
        self._labels = {row.index: row.item.seq for row in rows}

    def target(self, jump: Row, notes: Notes) -> float:
        """The new target; jumps out of the list keep leading out of it."""
        told = jump.item.param1
        if not (math.isfinite(told) and told == round(told)):
            return told
        if self._labels.get(round(told), round(told)) != told:
            notes.add(
                "it jumps to an item by where that stands, not by the number in front of it",
                "line",
                jump.line,
            )
        if round(told) in self._targets:
            return float(self._targets[round(told)])
        if self._mixed:
            raise FormatError(f"it jumps to {told:g}, which is no item of the mission", jump.line, "param 1")
        return told + self._by


def _mission(rows: list[Row], shift: _Shift, notes: Notes) -> Iterator[MissionItem]:
    for row in rows:
        item = row.item
        yield replace(item, param1=shift.target(row, notes)) if item.command == Command.DO_JUMP else item


def _shifted(item: MissionItem, by: int) -> MissionItem:
    """The item renumbered, its jump target moved along."""
    if item.command == Command.DO_JUMP:
        return replace(item, seq=item.seq + by, param1=item.param1 + by)
    return replace(item, seq=item.seq + by)


def _row(item: MissionItem, closed: bool) -> str:
    x, y = in_file(item)
    numbers = (item.param1, item.param2, item.param3, item.param4)
    return "\t".join(
        (
            str(item.seq),
            str(int(item.current)),
            str(int(item.frame)),
            str(int(item.command)),
            *(_number(value, closed) for value in numbers),
            _column(item, x, closed),
            _column(item, y, closed),
            _number(item.z, closed),
            str(int(item.autocontinue)),
        )
    )


def _number(value: float, closed: bool) -> str:
    if math.isnan(value):
        return repr(0.0) if closed else "nan"
    return repr(float(value))


def _column(item: MissionItem, value: float, closed: bool) -> str:
    if item.written is not None:
        return _number(value, closed)
    return f"{value:.7f}" if item.frame in GLOBAL_FRAMES else str(int(value))
