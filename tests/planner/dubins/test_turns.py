"""Turns at a waypoint against hand-worked figures and shapely's circles, and the quality integral."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.geometry import LineString, Point

from planner.dubins.path import Path, Segment
from planner.dubins.turns import Turn, past_target, quality_m2, short_turn, three_arc
from planner.route import Pose
from tests.planner.dubins.test_words import assert_flyable

RADIUS_M = 100.0
BEFORE, WAYPOINT = (-1000.0, 0.0), (0.0, 0.0)
bends = st.floats(-math.pi + 0.01, math.pi - 0.01).filter(lambda turn_rad: abs(turn_rad) > 1e-3)
radii = st.floats(20.0, 150.0)


def after(turn_rad: float) -> tuple[float, float]:
    return 1000.0 * math.cos(turn_rad), 1000.0 * math.sin(turn_rad)


def flown(turn: Turn, goal: tuple[float, float]) -> Path:
    """The whole line from BEFORE to the goal by a turn."""
    begin = turn.path.start
    pieces = [Segment("straight", Pose(*BEFORE, 0.0), math.dist(BEFORE, begin.position)), *turn.path.segments]
    if math.isfinite(turn.after_m):
        pieces.append(Segment("straight", pieces[-1].end, math.dist(pieces[-1].end.position, goal)))
    return Path(tuple(pieces))


def test_three_arcs_of_a_right_angle() -> None:
    """Worked by hand, R = 100 m: w_k is 70.71 m from the leg, the ingress circle's centre √(200² - 170.71²) =
    104.20 m further back, and the arcs turn by arccos 0.85355 = 31.40° out, 152.80° in and 31.40° out."""
    turn = three_arc(BEFORE, WAYPOINT, after(math.pi / 2), RADIUS_M)
    assert turn.before_m == pytest.approx(174.912, abs=1e-3)
    assert turn.after_m == pytest.approx(174.912, abs=1e-3)
    assert [math.degrees(arc.turn_rad) for arc in turn.path.segments] == pytest.approx(
        [-31.400, 152.799, -31.400], abs=1e-3
    )


@settings(deadline=None, max_examples=60)
@given(bends, radii, radii, radii)
def test_three_arcs_lie_on_the_circles_of_algorithm_4(
    turn_rad: float, radius_m: float, in_m: float, out_m: float
) -> None:
    """Ingress and egress centres are shapely's crossings of the offset legs and the extended circle."""
    goal = after(turn_rad)
    turn = three_arc(BEFORE, WAYPOINT, goal, radius_m, in_m, out_m)
    first, middle, last = turn.path.segments
    side = math.copysign(1.0, turn_rad)
    normal_rad = 0.5 * turn_rad + side * 0.5 * math.pi
    w_k = (radius_m * math.cos(normal_rad), radius_m * math.sin(normal_rad))
    assert middle.centre == pytest.approx(w_k, abs=1e-6)
    for arc, own_m, begin, direction_rad in ((first, in_m, BEFORE, 0.0), (last, out_m, goal, turn_rad)):
        offset = (own_m * side * math.sin(direction_rad), -own_m * side * math.cos(direction_rad))
        parallel = LineString(
            [(begin[0] + offset[0], begin[1] + offset[1]), (WAYPOINT[0] + offset[0], WAYPOINT[1] + offset[1])]
        )
        circle = Point(w_k).buffer(radius_m + own_m, quad_segs=4000).exterior
        crossings = parallel.intersection(circle)
        assert crossings.distance(Point(arc.centre)) < 0.01 * max(1.0, abs(1.0 / math.sin(turn_rad / 2)))
    assert_flyable(turn.path, min(radius_m, in_m, out_m))


@settings(deadline=None, max_examples=80)
@given(bends)
def test_turns_begin_and_end_on_their_legs(turn_rad: float) -> None:
    """Each leaves the first leg and comes onto the second, or the next waypoint, in its direction; three arcs
    and the turn past the target pass through the waypoint, the turn before it does not."""
    goal = after(turn_rad)
    for make, through in ((three_arc, True), (past_target, True), (short_turn, False)):
        turn = make(BEFORE, WAYPOINT, goal, RADIUS_M)
        assert turn is not None
        if turn.before_m > 1000.0:
            assert make is short_turn
            continue
        path = flown(turn, goal)
        assert_flyable(path, RADIUS_M)
        assert path.end.position == pytest.approx(goal, abs=1e-6)
        line = LineString(turn.path.sample(0.5)[:, :2])
        missed_m = 0.0 if through else RADIUS_M * (1.0 / math.cos(0.5 * turn_rad) - 1.0)
        assert line.distance(Point(WAYPOINT)) == pytest.approx(missed_m, abs=2e-3)


@settings(deadline=None, max_examples=30)
@given(bends, st.floats(-3.0, 3.0), st.booleans())
def test_turned_and_mirrored_they_are_as_long(turn_rad: float, by_rad: float, mirrored: bool) -> None:
    """Rotation and mirroring change neither length nor quality."""

    def moved(place: tuple[float, float]) -> tuple[float, float]:
        east_m, north_m = place[0], -place[1] if mirrored else place[1]
        return (
            east_m * math.cos(by_rad) - north_m * math.sin(by_rad) + 500.0,
            east_m * math.sin(by_rad) + north_m * math.cos(by_rad),
        )

    legs = (BEFORE, WAYPOINT, after(turn_rad))
    gone = (moved(BEFORE), moved(WAYPOINT), moved(legs[2]))
    for make in (three_arc, past_target, short_turn):
        here, there = make(*legs, RADIUS_M), make(*gone, RADIUS_M)
        assert there.path.length_m == pytest.approx(here.path.length_m, rel=5e-3)
        assert quality_m2(there.path, gone) == pytest.approx(quality_m2(here.path, legs), rel=5e-3, abs=0.5)


@pytest.mark.parametrize("degrees", [10, 45, 90, 130])
def test_quality_of_a_short_turn(degrees: float) -> None:
    """Worked by hand: an arc R (1 - cos φ) off the leg up to its middle is 2 R² (τ/2 - sin τ/2)."""
    turn_rad = math.radians(degrees)
    turn = short_turn(BEFORE, WAYPOINT, after(turn_rad), RADIUS_M)
    half_rad = 0.5 * turn_rad
    expected_m2 = 2.0 * RADIUS_M**2 * (half_rad - math.sin(half_rad))
    legs = [BEFORE, WAYPOINT, after(turn_rad)]
    assert quality_m2(turn.path, legs, 0.1) == pytest.approx(expected_m2, rel=2e-3)


@pytest.mark.parametrize("degrees", [20, 60, 90, 120, 160])
def test_three_arcs_stray_least_of_turns_through_the_waypoint(
    degrees: float,
) -> None:
    """Eq 48 by shapely's distances; the turn past the target strays more, the one that misses it less."""
    goal = after(math.radians(degrees))
    legs = LineString([BEFORE, WAYPOINT, goal])
    found = {}
    for make in (three_arc, past_target, short_turn):
        path = flown(make(BEFORE, WAYPOINT, goal, RADIUS_M), goal)
        samples = path.sample(0.5, 0.5)
        away_m = shapely.distance(legs, shapely.points(samples[:, :2]))
        steps = np.hypot(*np.diff(samples[:, :2], axis=0).T)
        by_hand_m2 = float(np.sum(0.5 * (away_m[1:] + away_m[:-1]) * steps))
        found[make] = quality_m2(path, legs.coords)
        assert found[make] == pytest.approx(by_hand_m2, rel=5e-3)
    if degrees < 160:
        assert found[short_turn] < found[three_arc]
    assert found[three_arc] < 0.5 * found[past_target]


def test_no_turn_without_legs_and_none_right_back_before_the_waypoint() -> None:
    """A corner without a leg is refused; the turn right back has three arcs, but none before the waypoint."""
    with pytest.raises(ValueError, match="two legs"):
        three_arc(WAYPOINT, WAYPOINT, (1.0, 0.0), RADIUS_M)
    assert short_turn(BEFORE, WAYPOINT, BEFORE, RADIUS_M) is None
    back = three_arc(BEFORE, WAYPOINT, BEFORE, RADIUS_M)
    assert math.degrees(sum(arc.turn_rad for arc in back.path.segments)) == pytest.approx(180.0)
    straight = three_arc(BEFORE, WAYPOINT, (1000.0, 0.0), RADIUS_M)
    assert straight.path.length_m == straight.before_m == 0.0
