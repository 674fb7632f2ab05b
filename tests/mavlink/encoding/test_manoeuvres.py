"""Circles and approaches, in rooms of different shapes."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from shapely.geometry import LineString, Point, box

from mavlink.encoding.fence import Room
from mavlink.encoding.manoeuvres import MARGIN_M, climb_orbit, landing, orbit_radius_m, takeoff_place

OPEN = Room(None, Point(0.0, 0.0).buffer(0.0))


@given(st.floats(5.0, 2500.0))
def test_circles_are_wider_than_the_tightest_turn(turn_m: float) -> None:
    """Whole metres to 255, tens above, as ArduPilot stores them, and never tighter than the turn."""
    radius_m = orbit_radius_m(turn_m)
    assert turn_m <= radius_m <= 1.05 * turn_m + 10.0
    assert radius_m == round(radius_m)
    assert radius_m <= 255.0 or radius_m % 10.0 == 0.0


@given(st.floats(-3.1, 3.1), st.floats(30.0, 300.0))
def test_an_open_room_gets_the_circle_before_the_start(angle_rad: float, radius_m: float) -> None:
    """The first choice touches the line a radius before the path starts."""
    orbit = climb_orbit((10.0, 20.0), angle_rad, radius_m, 0.0, OPEN)
    assert orbit.leave_m == -radius_m
    line = LineString(
        [(10.0 + s * math.cos(angle_rad), 20.0 + s * math.sin(angle_rad)) for s in (-5000, 5000)]
    )
    assert line.distance(Point(orbit.centre)) == pytest.approx(radius_m)


def test_a_barred_place_is_avoided() -> None:
    """With a zone to the left of the start the circle lies to the right: clockwise."""
    room = Room(None, box(-400.0, 10.0, 400.0, 400.0))
    orbit = climb_orbit((0.0, -30.0), 0.0, 100.0, 0.0, room)
    assert orbit.radius_m == 100.0
    assert orbit.centre == pytest.approx((-100.0, -130.0))


def test_a_circle_round_the_start_is_the_last_resort() -> None:
    """In a room just large enough for it, the circle is flown round the start itself."""
    half_m = 100.0 + MARGIN_M + 1.0
    orbit = climb_orbit((0.0, 0.0), 0.3, 100.0, 0.0, Room(box(-half_m, -half_m, half_m, half_m), OPEN.barred))
    assert orbit.centre == (0.0, 0.0)
    assert orbit.leave_m is None
    assert orbit.outside_m2 == 0.0


def test_no_room_says_how_much_is_outside() -> None:
    """The least bad circle is given with the area that leaves the room."""
    orbit = climb_orbit((0.0, 0.0), 0.0, 100.0, 0.0, Room(box(-50.0, -50.0, 50.0, 50.0), OPEN.barred))
    assert orbit.outside_m2 > 10_000.0


@given(st.floats(-3.1, 3.1), st.floats(30.0, 200.0), st.floats(15.0, 60.0))
def test_an_approach_is_as_steep_as_said(angle_rad: float, radius_m: float, altitude_m: float) -> None:
    """From where the approach begins the slope is 4°, and the circle touches the approach line before it."""
    way = landing((0.0, 0.0), angle_rad, radius_m, altitude_m, 4.0, OPEN)
    assert math.degrees(math.atan2(way.approach_altitude_m, math.hypot(*way.approach))) == pytest.approx(4.0)
    assert way.approach_altitude_m == altitude_m
    line = LineString([(0.0, 0.0), tuple(3.0 * c for c in way.approach)])
    assert line.distance(Point(way.orbit.centre)) == pytest.approx(radius_m)
    assert math.dist(way.orbit.centre, way.approach) == pytest.approx(math.sqrt(2.0) * radius_m)


def test_an_approach_turns_where_there_is_room() -> None:
    """Arriving eastwards with the sea to the west barred, the approach comes from elsewhere."""
    room = Room(box(-150.0, -2500.0, 2500.0, 2500.0), OPEN.barred)
    way = landing((0.0, 0.0), 0.0, 100.0, 40.0, 4.0, room)
    assert way.outside_m2 == 0.0
    assert way.approach[0] > -150.0


def test_an_approach_is_lowered_where_there_is_little_room() -> None:
    """In a small room the straight approach begins lower and nearer, at the same slope."""
    way = landing((0.0, -300.0), 0.0, 60.0, 40.0, 4.0, Room(box(-320.0, -360.0, 320.0, 360.0), OPEN.barred))
    assert way.outside_m2 == 0.0
    assert way.approach_altitude_m < 40.0


def test_the_takeoff_turns_away_from_the_fence() -> None:
    """With a fence right ahead the take-off leads elsewhere."""
    room = Room(box(-2000.0, -2000.0, 100.0, 2000.0), OPEN.barred)
    east_m, _ = takeoff_place((0.0, 0.0), 0.0, 350.0, room)
    assert east_m < 100.0
    assert takeoff_place((0.0, 0.0), 0.0, 350.0, OPEN) == (350.0, 0.0)
