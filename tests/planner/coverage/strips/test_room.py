"""Grades of collects by the room they have."""

import math
from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.geometry import LineString, Point

from planner.airspace.values import NoFlyZone, Threat
from planner.airspace.zones import TRANSIT_MARGIN_M
from planner.coverage.strips.room import (
    CROSSES_THREAT,
    FORBIDDEN,
    MARGIN_M,
    NO_ROOM_TO_TURN,
    TURNS_IN_THREAT,
    Room,
)
from tests.planner.coverage.shapes import sample
from tests.planner.stages import room_of

NOTHING = shapely.MultiPolygon()
AREA = shapely.box(0.0, 0.0, 4000.0, 3000.0)
MIDDLE = np.array([[1000.0, 1500.0], [2000.0, 1500.0]])


def grade(room: Room, line: np.ndarray) -> int:
    """The grade of one line."""
    return int(room.grade(line[None])[0])


def room(hard: shapely.Geometry = NOTHING, soft: shapely.Geometry = NOTHING, settle_m: float = 0.0) -> Room:
    """An area with zones, for an aircraft that turns in 100 m."""
    return Room(AREA, hard, soft, 100.0, settle_m)


def test_free_line() -> None:
    """In the open nothing is lacking."""
    assert grade(room(), MIDDLE) == 0


def test_hard_zone_and_area() -> None:
    """A line through a hard zone, or one that leaves the area, may not be flown."""
    assert grade(room(hard=Point(1500.0, 1500.0).buffer(50.0)), MIDDLE) == FORBIDDEN
    assert grade(room(), MIDDLE + np.array([2500.0, 0.0])) == FORBIDDEN


def test_run_to_settle_counts() -> None:
    """The straight flight before a collect must be free as well; after it nothing is asked."""
    west, east = Point(850.0, 1500.0).buffer(20.0), Point(2150.0, 1500.0).buffer(20.0)
    assert grade(room(hard=west, settle_m=100.0), MIDDLE) < FORBIDDEN
    assert grade(room(hard=west, settle_m=200.0), MIDDLE) == FORBIDDEN
    assert grade(room(hard=east, settle_m=200.0), MIDDLE) < FORBIDDEN


def test_threats() -> None:
    """Crossing a soft threat is worse than turning in one, and no room to turn at all is worse than both."""
    on_line, at_end = Point(1500.0, 1500.0).buffer(50.0), Point(2200.0, 1500.0).buffer(190.0)
    assert grade(room(soft=on_line), MIDDLE) == CROSSES_THREAT
    assert grade(room(soft=at_end), MIDDLE) == TURNS_IN_THREAT
    assert grade(room(hard=at_end), MIDDLE) == NO_ROOM_TO_TURN
    assert NO_ROOM_TO_TURN > CROSSES_THREAT + TURNS_IN_THREAT
    assert FORBIDDEN > 2 * (NO_ROOM_TO_TURN + CROSSES_THREAT + TURNS_IN_THREAT)


def test_one_free_side_is_enough() -> None:
    """Near the edge of the area one turns to the other side; in a corridor there is no turn."""
    along_edge = MIDDLE - np.array([0.0, 1490.0])
    assert grade(room(), along_edge) == 0
    above = shapely.box(0.0, 150.0, 4000.0, 200.0)
    assert grade(room(hard=above), along_edge) == NO_ROOM_TO_TURN


@settings(max_examples=100, deadline=None)
@given(
    st.tuples(st.floats(0.0, 4000.0), st.floats(0.0, 3000.0)),
    st.floats(-math.pi, math.pi),
    st.floats(100.0, 900.0),
)
def test_grade_0_can_be_flown(start: tuple[float, float], angle_rad: float, length_m: float) -> None:
    """With grade 0 the line and one whole turning circle at each end are in the area and out of all zones.

    The line keeps from the area's edge what transits keep, so that they can meet it.
    """
    zones = shapely.union_all(
        [Point(2000.0, 1000.0).buffer(500.0), shapely.box(500.0, 2000.0, 1500.0, 2500.0)]
    )
    ahead = np.array([math.cos(angle_rad), math.sin(angle_rad)])
    line = np.array([start, start + length_m * ahead])
    found = grade(room(hard=zones), line)
    inner = AREA.buffer(-TRANSIT_MARGIN_M)
    clear = inner.covers(LineString(line)) and not zones.intersects(LineString(line))
    assert (found < FORBIDDEN) == clear
    if not clear:
        return
    left = 100.0 * np.array([-ahead[1], ahead[0]])

    def turns(place: np.ndarray, margin_m: float) -> bool:
        circles = [Point(place + side * left).buffer(100.0 + margin_m, quad_segs=64) for side in (1.0, -1.0)]
        return any(AREA.covers(c) and not zones.intersects(c) for c in circles)

    # shapely's round offsets are polygons, a quarter per cent narrow; the area keeps a margin besides.
    if found == 0:
        assert all(turns(place, -1.5) for place in line)
    else:
        assert not all(turns(place, 2.0 * MARGIN_M) for place in line)


def test_room_of_a_scenario() -> None:
    """Hard threats and no-fly zones forbid, soft threats count only where they are looked at."""
    scenario = replace(
        sample(1),
        threats=(
            Threat("soft", "missile", (0.0, 0.0), 300.0),
            Threat("hard", "radar", (2000.0, 0.0), 300.0, 100.0, hard=True),
            Threat("low", "missile", (-2000.0, 0.0), 300.0, height_m=100.0, hard=True),
        ),
        no_fly=(
            NoFlyZone("zone", None, (0.0, 2000.0), 300.0),
            NoFlyZone("high", None, (0.0, -2000.0), 300.0, 9e3),
        ),
    )
    for aware, soft in ((False, 0), (True, CROSSES_THREAT)):
        found = room_of(scenario, threat_aware=aware)
        lines = np.array(
            [
                [[e - 200.0, n], [e + 200.0, n]]
                for e, n in ((0, 0), (2000, 0), (-2000, 0), (0, 2000), (0, -2000))
            ]
        )
        grades = found.grade(lines)
        assert grades.tolist() == [pytest.approx(soft, abs=TURNS_IN_THREAT), FORBIDDEN, 0, FORBIDDEN, 0]
