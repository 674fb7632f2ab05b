"""Hypothesis strategies for mission items and missions."""

from __future__ import annotations

import math
from dataclasses import replace

from hypothesis import strategies as st

from mavlink.dialects import Autopilot
from mavlink.dialects.mission import Mission, home_item, numbered
from mavlink.wire.items import Command, Frame, MissionItem, MissionType

PLACED = (
    Command.NAV_WAYPOINT,
    Command.NAV_TAKEOFF,
    Command.NAV_LAND,
    Command.NAV_LOITER_TO_ALT,
    Command.NAV_LOITER_TIME,
    Command.NAV_LOITER_UNLIM,
)
PLACELESS = (
    Command.DO_CHANGE_SPEED,
    Command.DO_SET_CAM_TRIGG_DIST,
    Command.IMAGE_START_CAPTURE,
    Command.DO_DIGICAM_CONTROL,
    Command.NAV_RETURN_TO_LAUNCH,
)

latitudes_e7 = st.integers(-900_000_000, 900_000_000)
longitudes_e7 = st.integers(-1_800_000_000, 1_800_000_000)
numbers = st.floats(-1e6, 1e6, width=32)
parameters = st.one_of(numbers, st.just(math.nan))


@st.composite
def placed_items(draw: st.DrawFn, parameter: st.SearchStrategy[float] = parameters) -> MissionItem:
    """An item with a place, not numbered."""
    return MissionItem(
        0,
        draw(st.sampled_from([0, 3, 5, 6, 10])),
        int(draw(st.sampled_from(PLACED))),
        *(draw(parameter) for _ in range(4)),
        x=draw(latitudes_e7),
        y=draw(longitudes_e7),
        z=draw(numbers),
        autocontinue=draw(st.booleans()),
    )


@st.composite
def placeless_items(draw: st.DrawFn, parameter: st.SearchStrategy[float] = parameters) -> MissionItem:
    """An item without a place, not numbered; x and y are any integers."""
    integers = st.integers(-(2**31) + 1, 2**31 - 1)
    return MissionItem(
        0,
        int(Frame.MISSION),
        int(draw(st.sampled_from(PLACELESS))),
        *(draw(parameter) for _ in range(4)),
        x=draw(integers),
        y=draw(integers),
        z=draw(numbers),
    )


@st.composite
def missions(draw: st.DrawFn) -> Mission:
    """Any mission that a file can hold, jumps to items of its own included."""
    autopilot: Autopilot = draw(st.sampled_from(["ardupilot", "px4"]))
    items = draw(st.lists(st.one_of(placed_items(), placeless_items()), min_size=1, max_size=8))
    home_lat_e7, home_lon_e7 = draw(latitudes_e7), draw(longitudes_e7)
    home = (home_lon_e7 / 1e7, home_lat_e7 / 1e7)
    home_altitude_m = round(draw(st.floats(-100.0, 4000.0)), 2)
    first = 1 if autopilot == "ardupilot" else 0
    for _ in range(draw(st.integers(0, 2))):
        target = draw(st.integers(first, first + len(items) - 1))
        items.append(MissionItem(0, 2, int(Command.DO_JUMP), param1=float(target), param2=3.0))
    rows = [home_item(home, home_altitude_m)] if autopilot == "ardupilot" else []
    return Mission(
        mission=numbered([*rows, *items]),
        fence=draw(fences()),
        rally=numbered(draw(st.lists(_rally_points(), max_size=3)), MissionType.RALLY),
        autopilot=autopilot,
        vehicle="",
        vehicle_type=draw(st.sampled_from(["fixed_wing", "multirotor", "vtol"])),
        home=home,
        home_altitude_m=home_altitude_m,
        speed_m_s=draw(st.floats(1.0, 100.0)),
    )


@st.composite
def _rally_points(draw: st.DrawFn) -> MissionItem:
    return MissionItem(
        0,
        3,
        int(Command.NAV_RALLY_POINT),
        x=draw(latitudes_e7),
        y=draw(longitudes_e7),
        z=draw(st.integers(0, 900)),
    )


@st.composite
def fences(draw: st.DrawFn) -> tuple[MissionItem, ...]:
    """Polygons, then circles, as ``.plan`` files order them."""
    items: list[MissionItem] = []
    for _ in range(draw(st.integers(0, 2))):
        command = draw(st.sampled_from([5001, 5002]))
        corners = draw(st.integers(3, 6))
        items += [_vertex(draw, command, float(corners)) for _ in range(corners)]
    for _ in range(draw(st.integers(0, 2))):
        radius_m = draw(st.floats(1.0, 1e4, width=32))
        items.append(_vertex(draw, draw(st.sampled_from([5003, 5004])), radius_m))
    return numbered(items, MissionType.FENCE)


def _vertex(draw: st.DrawFn, command: int, param1: float) -> MissionItem:
    return replace(MissionItem(0, 0, command, param1=param1), x=draw(latitudes_e7), y=draw(longitudes_e7))


def same(a: tuple[MissionItem, ...], b: tuple[MissionItem, ...]) -> bool:
    """Equality of items in which NaN equals NaN."""
    return [_comparable(item) for item in a] == [_comparable(item) for item in b]


def _comparable(item: MissionItem) -> tuple[object, ...]:
    values = (item.param1, item.param2, item.param3, item.param4, item.z)
    return (
        item.seq,
        int(item.frame),
        int(item.command),
        *("nan" if math.isnan(value) else value for value in values),
        item.x,
        item.y,
        item.current,
        item.autocontinue,
        int(item.mission_type),
    )
