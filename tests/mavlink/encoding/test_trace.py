"""The line that somebody else's items are flown on, against geodesics of pyproj and distances of shapely."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import pytest
from pyproj import Geod
from shapely.geometry import LineString, Point

from mavlink.dialects import Autopilot, VehicleType
from mavlink.dialects.mission import Declared, Mission, home_item, numbered, placed, unplaced
from mavlink.encoding.trace import length_m, trace
from mavlink.wire.geometry import LocalMap
from mavlink.wire.items import Command, Frame, MissionItem
from planner.plan import LonLat

GEOD = Geod(ellps="WGS84")
HOME = (8.2, 47.1)
LOCAL = LocalMap(HOME)


def at(east_m: float, north_m: float) -> LonLat:
    return LOCAL.lonlat((east_m, north_m))


def waypoint(
    east_m: float, north_m: float, z: float = 50.0, frame: int = 3, command: int = 16
) -> MissionItem:
    return placed(command, at(east_m, north_m), z, frame)


def mission(
    *items: MissionItem, autopilot: Autopilot = "px4", vehicle_type: VehicleType = "fixed_wing"
) -> Mission:
    rows = [home_item(HOME, 400.0)] if autopilot == "ardupilot" else []
    declared = Declared()
    return Mission(
        numbered([*rows, *items]),
        (),
        (),
        autopilot,
        "",
        vehicle_type,
        HOME,
        home_altitude_m=400.0,
        declared=declared,
    )


def metres(line: tuple[tuple[float, float, float], ...]) -> LineString:
    return LineString([LOCAL.xy(place[:2]) for place in line])


@pytest.mark.parametrize("autopilot", ["ardupilot", "px4"])
def test_straight_legs_are_geodesics(autopilot: Autopilot) -> None:
    """Through every place in order; the length is that of the geodesics and climbs between."""
    places = [(0.0, 500.0), (800.0, 500.0), (800.0, -300.0)]
    found = trace(mission(*(waypoint(*place) for place in places), autopilot=autopilot), 0.0, 80.0, 400.0)
    corners = [HOME, *(at(*place) for place in places)]
    legs_m = [GEOD.inv(*a, *b)[2] for a, b in pairwise(corners)]
    legs_m[0] = math.hypot(legs_m[0], 50.0)
    assert length_m(found.line) == pytest.approx(math.fsum(legs_m), rel=1e-5)
    assert [place[2] for place in found.line] == [0.0, 50.0, 50.0, 50.0]


def test_corners_are_rounded_with_the_aircrafts_turn() -> None:
    """The arc touches both legs, and comes as near to the corner as a circle of that radius does."""
    radius_m, corner = 60.0, (0.0, 500.0)
    found = trace(mission(waypoint(*corner), waypoint(800.0, 500.0)), radius_m, 80.0, None)
    line = metres(found.line)
    assert line.distance(Point(*corner)) == pytest.approx(radius_m * (math.sqrt(2.0) - 1.0), abs=0.3)
    assert line.hausdorff_distance(metres(found.corners)) < radius_m
    centre = Point(radius_m, corner[1] - radius_m)
    assert line.distance(centre) == pytest.approx(radius_m, abs=0.3)
    assert [turn.seq for turn in found.turns] == [0]
    assert found.turns[0].radius_m == pytest.approx(500.0, rel=1e-3)


def test_legs_too_short_for_a_turn_leave_it_sharp() -> None:
    """Two corners 40 m apart leave each 20 m: a turn of 20 m at right angles, and no arc of 60."""
    found = trace(
        mission(waypoint(0.0, 500.0), waypoint(40.0, 500.0), waypoint(40.0, 1000.0)), 60.0, 80.0, None
    )
    assert sorted(turn.radius_m for turn in found.turns) == pytest.approx([20.0, 20.0], rel=1e-3)
    assert metres(found.line).distance(Point(40.0, 500.0)) < 0.01


def test_circles_are_flown_whole_with_the_radius_said_or_the_usual_one() -> None:
    """LOITER_TURNS says param 3, LOITER_TO_ALT param 2; without a radius the vehicle's own is taken."""
    loiter = replace(waypoint(0.0, 500.0, command=Command.NAV_LOITER_UNLIM), param3=-70.0)
    to_alt = replace(waypoint(900.0, 500.0, 90.0, command=Command.NAV_LOITER_TO_ALT), param2=0.0)
    found = trace(mission(loiter, to_alt), 60.0, 80.0, None)
    line = metres(found.line)
    for centre, radius_m in (((0.0, 500.0), 70.0), ((900.0, 500.0), 80.0)):
        round_about = [p for p in line.coords if math.dist(p, centre) < radius_m + 0.5]
        assert len(round_about) > 40
        assert min(math.dist(p, centre) for p in round_about) == pytest.approx(radius_m, abs=0.01)
    assert {turn.radius_m for turn in found.turns} >= {70.0, 80.0}
    assert found.line[-1][2] == 90.0


def test_jumps_are_taken_once_and_places_of_others_are_not_flown_to() -> None:
    """A jump back is a leg of its own; regions of interest and landing marks are no places."""
    look = replace(waypoint(5000.0, 0.0), command=int(Command.NAV_ROI))
    mark = replace(waypoint(-5000.0, 0.0), command=int(Command.DO_LAND_START))
    jump = unplaced(Command.DO_JUMP, (0.0, 3.0, 0.0, 0.0))
    found = trace(mission(waypoint(0.0, 300.0), look, waypoint(300.0, 300.0), jump, mark), 0.0, 80.0, None)
    seen = [tuple(round(value) for value in LOCAL.xy(place[:2])) for place in found.corners]
    assert seen == [(0, 0), (0, 300), (300, 300), (0, 300), (300, 300)]
    endless = mission(waypoint(0.0, 300.0), replace(jump, param1=0.0), replace(jump, param1=1.0))
    assert len(trace(endless, 0.0, 80.0, None).corners) < 20


def test_heights_count_from_home() -> None:
    """Above the sea less home's height, above the ground with the ground's; unknown ones are told."""
    items = (
        waypoint(0.0, 300.0, 460.0, Frame.GLOBAL),
        waypoint(0.0, 600.0, 30.0, Frame.GLOBAL_TERRAIN_ALT),
        waypoint(0.0, 900.0, 20.0),
    )
    found = trace(mission(*items), 0.0, 80.0, 400.0, lambda place: 12.0)
    assert [place[2] for place in found.corners] == [0.0, 60.0, 42.0, 20.0]
    assert trace(mission(*items), 0.0, 80.0, None).unknown_heights == (0,)


def test_multirotors_climb_and_land_upright() -> None:
    """ArduCopter climbs where it stands, PX4 goes on to the take-off's place; both come down on the spot."""
    for autopilot, places in (("ardupilot", 4), ("px4", 5)):
        items = (
            waypoint(100.0, 0.0, 30.0, command=Command.NAV_TAKEOFF),
            waypoint(0.0, 200.0, 40.0),
            waypoint(0.0, 200.0, 0.0, command=Command.NAV_LAND),
        )
        found = trace(mission(*items, autopilot=autopilot, vehicle_type="multirotor"), 60.0, 80.0, 400.0)
        assert len(found.line) == places
        assert LOCAL.xy(found.line[1][:2]) == pytest.approx((0.0, 0.0), abs=0.01)
        assert [place[2] for place in (found.line[0], found.line[1], found.line[-1])] == [0.0, 30.0, 0.0]
        assert (found.turns, found.finish) == ((), "land")
