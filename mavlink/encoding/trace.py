"""The line that a mission's items are flown on, for a mission that was not made of a plan.

Straight from place to place, corners rounded with the aircraft's turn where the legs leave room for it,
circles whole. Each jump is taken once. Heights are over home. What no item says (where a wing climbs to at
its take-off, how high a return is flown) is drawn straight.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import pairwise

from mavlink.dialects import Autopilot
from mavlink.dialects.base import GLOBAL_FRAMES
from mavlink.dialects.mission import Mission
from mavlink.wire.geometry import LocalMap, Xy, distance_m
from mavlink.wire.items import Command, Frame, MissionItem
from planner.plan import Finish, LonLat, LonLatAlt

#: Commands up to this number fly somewhere, but for those that point at a place.
_LAST_NAV = 95
_POINTING = frozenset({Command.NAV_ROI, 81})
_LANDS = frozenset({Command.NAV_LAND, Command.NAV_VTOL_LAND})
_TAKES_OFF = frozenset({Command.NAV_TAKEOFF, Command.NAV_VTOL_TAKEOFF})
#: Circles, and the parameter that holds their radius.
_CIRCLES: dict[int, str] = {
    Command.NAV_LOITER_UNLIM: "param3",
    Command.NAV_LOITER_TURNS: "param3",
    Command.NAV_LOITER_TIME: "param3",
    Command.NAV_LOITER_TO_ALT: "param2",
}
_JUMP_TO_TAG = 601
_SEA = frozenset({Frame.GLOBAL, Frame.GLOBAL_INT})
_GROUND = frozenset({Frame.GLOBAL_TERRAIN_ALT, Frame.GLOBAL_TERRAIN_ALT_INT})
_CHORD_M = 10.0
#: Farther from its start than this no place of a mission is believed: home is often 0, 0.
FARTHEST_M = 200_000.0
#: Jumps can make a list of a thousand items a flight of a million.
_MOST_VISITS = 20_000
#: Corners of less than this are no turns.
_STRAIGHT_DEG = 0.5
_SAME_PLACE_M = 0.01


@dataclass(frozen=True, slots=True)
class Turn:
    """What a corner or a circle leaves room for: its largest radius, where, and at which item."""

    radius_m: float
    place: LonLat
    seq: int


@dataclass(frozen=True, slots=True)
class Trace:
    """A mission as it is flown.

    Parameters
    ----------
    line
        With rounded corners; altitudes over home.
    corners
        The same through every place.
    turns
        Of wings; empty for what hovers.
    unknown_heights
        Items whose height counts from the sea, which home's height is not known over.
    """

    line: tuple[LonLatAlt, ...]
    corners: tuple[LonLatAlt, ...]
    turns: tuple[Turn, ...]
    finish: Finish
    unknown_heights: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class _Stop:
    """A place of the line; ``rounded`` where the aircraft may cut the corner."""

    xy: Xy
    height_m: float
    seq: int
    rounded: bool = True


class _Line:
    """Stops as they come."""

    def __init__(self, home: Xy) -> None:
        self.stops = [_Stop(home, 0.0, 0, rounded=False)]

    @property
    def last(self) -> _Stop:
        return self.stops[-1]

    def to(self, xy: Xy, height_m: float, seq: int, *, rounded: bool = True) -> None:
        if math.dist(xy, self.last.xy) > _SAME_PLACE_M or height_m != self.last.height_m:
            self.stops.append(_Stop(xy, height_m, seq, rounded))


def trace(
    mission: Mission,
    turn_radius_m: float,
    circle_m: float,
    home_amsl_m: float | None,
    ground_m: Callable[[LonLat], float] = lambda place: 0.0,
) -> Trace:
    """Follow a mission's items.

    Parameters
    ----------
    turn_radius_m
        Of the aircraft; corners are rounded with it.
    circle_m
        Radius of circles whose item says none.
    home_amsl_m
        Height of home above the sea; None where it is not known.
    ground_m
        Height of the ground over home, for items that count from it.
    """
    hovers = mission.vehicle_type == "multirotor"
    start = start_of(mission)
    local = LocalMap(start)
    line = _Line((0.0, 0.0))
    turns: list[Turn] = []
    unknown: list[int] = []
    items = mission.mission[1:] if mission.dialect.home_row else mission.mission
    ended: Finish = "loiter"
    for item in _visits(items):
        if item.command == Command.NAV_RETURN_TO_LAUNCH:
            line.to((0.0, 0.0), line.last.height_m, item.seq)
            ended = "return"
            continue
        height_m = _height_m(item, home_amsl_m, ground_m)
        if height_m is None:
            unknown.append(item.seq)
            height_m = line.last.height_m
        xy = local.xy((item.y / 1e7, item.x / 1e7)) if item.x or item.y else line.last.xy
        ended = "land" if item.command in _LANDS else "loiter"
        if item.command in _TAKES_OFF and mission.vehicle_type != "fixed_wing":
            line.to(line.last.xy, height_m, item.seq, rounded=False)
            if mission.autopilot == "px4":
                line.to(xy, height_m, item.seq)
        elif item.command in _TAKES_OFF and not (item.x or item.y):
            continue
        elif item.command in _LANDS and mission.vehicle_type != "fixed_wing":
            line.to(xy, line.last.height_m, item.seq, rounded=False)
            line.to(xy, 0.0, item.seq, rounded=False)
        elif item.command in _CIRCLES and (not hovers or item.command == Command.NAV_LOITER_TURNS):
            said_m = getattr(item, _CIRCLES[item.command])
            radius_m = abs(said_m) if math.isfinite(said_m) and said_m else (0.0 if hovers else circle_m)
            _circle(line, xy, height_m, radius_m, item.seq)
            if not hovers:
                turns.append(Turn(radius_m, local.lonlat(xy), item.seq))
        else:
            line.to(xy, height_m, item.seq)
    # The last place is no corner, and leaves its leg to the one before it.
    stops = [*line.stops[:-1], replace(line.stops[-1], rounded=False)]
    if not hovers:
        turns += _corners(stops, local)
    rounded = list(_rounded(stops, 0.0 if hovers else turn_radius_m))
    return Trace(
        tuple((*local.lonlat(xy), height_m) for xy, height_m in rounded),
        tuple((*local.lonlat(stop.xy), stop.height_m) for stop in stops),
        tuple(turns),
        ended,
        tuple(unknown),
    )


def start_of(mission: Mission) -> LonLat:
    """Home; the first place where home is not known, or so far away that it is another one's."""
    items = mission.mission[1:] if mission.dialect.home_row else mission.mission
    places = ((item.y / 1e7, item.x / 1e7) for item in items if steers(item) and (item.x or item.y))
    first = next(places, mission.home)
    if not any(mission.home) or distance_m(mission.home, first) > FARTHEST_M:
        return first
    return mission.home


def steers(item: MissionItem) -> bool:
    """Whether an item is flown to, or flies the aircraft home."""
    if item.command == Command.NAV_RETURN_TO_LAUNCH:
        return True
    return item.command < _LAST_NAV and item.command not in _POINTING and item.frame in GLOBAL_FRAMES


def holds_place(item: MissionItem, autopilot: Autopilot) -> bool:
    """Whether the autopilot takes an item's two columns for a place, whatever frame the file gives it."""
    if item.command == Command.DO_LAND_START:
        return autopilot == "ardupilot"
    return item.command < _LAST_NAV and item.command not in (Command.NAV_RETURN_TO_LAUNCH, Command.NAV_DELAY)


def _visits(items: tuple[MissionItem, ...]) -> Iterator[MissionItem]:
    """The items that steer in the order in which they are flown, each jump taken once."""
    by_seq = {item.seq: index for index, item in enumerate(items)}
    tags = {item.param1: index for index, item in enumerate(items) if item.command == Command.JUMP_TAG}
    taken: set[int] = set()
    index = count = 0
    while index < len(items) and count < _MOST_VISITS:
        item = items[index]
        target: int | None = None
        if index not in taken and item.param2 != 0.0:
            if item.command == Command.DO_JUMP:
                target = by_seq.get(int(item.param1)) if math.isfinite(item.param1) else None
            elif item.command == _JUMP_TO_TAG:
                target = tags.get(item.param1)
        if target is not None:
            taken.add(index)
            index = target
            continue
        if steers(item):
            count += 1
            yield item
        index += 1


def _height_m(
    item: MissionItem, home_amsl_m: float | None, ground_m: Callable[[LonLat], float]
) -> float | None:
    if not math.isfinite(item.z):
        return None
    if item.frame in _SEA:
        return None if home_amsl_m is None else item.z - home_amsl_m
    if item.frame in _GROUND:
        return item.z + ground_m((item.y / 1e7, item.x / 1e7))
    return item.z


def _circle(line: _Line, centre: Xy, height_m: float, radius_m: float, seq: int) -> None:
    """A whole round, begun where the way in meets it, its height reached on the way round."""
    from_m = line.last.height_m
    if radius_m <= _SAME_PLACE_M:
        line.to(centre, height_m, seq)
        return
    begin_rad = math.atan2(line.last.xy[1] - centre[1], line.last.xy[0] - centre[0])
    count = max(12, math.ceil(math.tau * radius_m / _CHORD_M))
    for step in range(count + 1):
        angle_rad = begin_rad + math.tau * step / count
        xy = (centre[0] + radius_m * math.cos(angle_rad), centre[1] + radius_m * math.sin(angle_rad))
        line.to(xy, from_m + (height_m - from_m) * step / count, seq, rounded=False)


def _corner(before: Xy, at: Xy, behind: Xy) -> tuple[float, float, float]:
    """The angle turned at a place, and the lengths of the legs beside it."""
    first, second = (at[0] - before[0], at[1] - before[1]), (behind[0] - at[0], behind[1] - at[1])
    lengths_m = (math.hypot(*first), math.hypot(*second))
    if min(lengths_m) <= _SAME_PLACE_M:
        return 0.0, *lengths_m
    turned_rad = math.atan2(
        first[0] * second[1] - first[1] * second[0], first[0] * second[0] + first[1] * second[1]
    )
    return turned_rad, *lengths_m


def _corners(stops: list[_Stop], local: LocalMap) -> Iterator[Turn]:
    """What each corner leaves room for: half of the shorter leg beside it."""
    for before, at, behind in zip(stops, stops[1:], stops[2:], strict=False):
        turned_rad, into_m, out_m = _corner(before.xy, at.xy, behind.xy)
        if at.rounded and abs(math.degrees(turned_rad)) > _STRAIGHT_DEG:
            room_m = _share(before, at, into_m, out_m, behind)
            yield Turn(room_m / math.tan(abs(turned_rad) / 2.0), local.lonlat(at.xy), at.seq)


def _share(before: _Stop, at: _Stop, into_m: float, out_m: float, behind: _Stop) -> float:
    """How much of its legs a corner may take: half, and all of a leg whose other end is no corner."""
    return min(into_m / (2.0 if before.rounded else 1.0), out_m / (2.0 if behind.rounded else 1.0))


def _rounded(stops: list[_Stop], radius_m: float) -> Iterator[tuple[Xy, float]]:
    """The line with an arc at each corner that has room for one."""
    yield stops[0].xy, stops[0].height_m
    for before, at, behind in zip(stops, stops[1:], stops[2:], strict=False):
        turned_rad, into_m, out_m = _corner(before.xy, at.xy, behind.xy)
        size_rad = abs(turned_rad)
        cut_m = radius_m * math.tan(size_rad / 2.0) if size_rad < math.pi - 1e-9 else math.inf
        if (
            not at.rounded
            or radius_m <= 0.0
            or math.degrees(size_rad) <= _STRAIGHT_DEG
            or cut_m > _share(before, at, into_m, out_m, behind)
        ):
            yield at.xy, at.height_m
            continue
        yield from _arc(before, at, behind, cut_m, turned_rad, radius_m)
    if len(stops) > 1:
        yield stops[-1].xy, stops[-1].height_m


def _arc(
    before: _Stop, at: _Stop, behind: _Stop, cut_m: float, turned_rad: float, radius_m: float
) -> Iterator[tuple[Xy, float]]:
    into_rad = math.atan2(at.xy[1] - before.xy[1], at.xy[0] - before.xy[0])
    side = math.copysign(1.0, turned_rad)
    begin = (at.xy[0] - cut_m * math.cos(into_rad), at.xy[1] - cut_m * math.sin(into_rad))
    abeam = (-side * radius_m * math.sin(into_rad), side * radius_m * math.cos(into_rad))
    centre = (begin[0] + abeam[0], begin[1] + abeam[1])
    heights_m = (
        at.height_m + (before.height_m - at.height_m) * cut_m / math.dist(before.xy, at.xy),
        at.height_m + (behind.height_m - at.height_m) * cut_m / math.dist(behind.xy, at.xy),
    )
    count = max(2, math.ceil(abs(turned_rad) * radius_m / _CHORD_M))
    for step in range(count + 1):
        part = step / count
        angle_rad = into_rad + turned_rad * part
        xy = (
            centre[0] + side * radius_m * math.sin(angle_rad),
            centre[1] - side * radius_m * math.cos(angle_rad),
        )
        yield xy, heights_m[0] + (heights_m[1] - heights_m[0]) * part


def length_m(line: tuple[LonLatAlt, ...]) -> float:
    """Of a line in three dimensions."""
    if not line:
        return 0.0
    local = LocalMap(line[0][:2])
    places = [(*local.xy(place[:2]), place[2]) for place in line]
    return math.fsum(math.dist(a, b) for a, b in pairwise(places))
