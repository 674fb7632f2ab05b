"""Arcs onto and off a straight against tangency measured by shapely and the choices of the paper."""

from __future__ import annotations

import math

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from shapely.geometry import LineString, Point

from planner.angles import wrap_pi
from planner.dubins.path import Segment
from planner.dubins.segment_arcs import egress, ingress
from planner.dubins.words import candidates
from planner.route import Pose
from tests.planner.dubins.test_words import assert_flyable

coordinate = st.floats(-1500.0, 1500.0)
angle = st.floats(-3.0, 3.0)
poses = st.builds(Pose, coordinate, coordinate, angle)
radii = st.floats(50.0, 200.0)
SIDES = {"left": 1.0, "right": -1.0}
sides = st.sampled_from(sorted(SIDES))


def beside(pose: Pose, signed_m: float) -> Point:
    """Centre of the circle through a pose."""
    return Point(
        pose.east_m - signed_m * math.sin(pose.angle_rad), pose.north_m + signed_m * math.cos(pose.angle_rad)
    )


def straight_m(straight: Segment, arc: Segment) -> float:
    """How near a straight comes to the centre of an arc."""
    ends = straight.start.position, straight.end.position
    line = LineString(ends) if straight.length_m > 0.0 else Point(ends[0])
    return line.distance(Point(arc.centre))


@settings(deadline=None)
@given(poses, coordinate, coordinate, radii)
def test_egress_is_one_arc_and_a_straight_to_the_target(
    end: Pose, east_m: float, north_m: float, radius_m: float
) -> None:
    """It begins at the pose, turns to the target's side unless the circle there holds it, ends at it."""
    target = Point(east_m, north_m)
    assume(target.distance(Point(end.position)) > 1.0)
    path = egress(end, (east_m, north_m), radius_m)
    assert path is not None
    arc, straight = path.segments
    assert_flyable(path, radius_m)
    assert path.start == end
    assert path.end.position == pytest.approx((east_m, north_m), abs=1e-6)
    centres = {kind: beside(end, side * radius_m) for kind, side in SIDES.items()}
    nearer = min(centres, key=lambda kind: target.distance(centres[kind]))
    if abs(target.distance(centres["left"]) - target.distance(centres["right"])) > 1e-6:
        held = target.distance(centres[nearer]) < radius_m
        assert (arc.kind == nearer) != held
    assert straight_m(straight, arc) == pytest.approx(radius_m, abs=1e-6)


@settings(deadline=None)
@given(poses, sides, radii, radii, poses, coordinate, coordinate)
def test_ingress_leaves_one_circle_and_meets_the_straight(
    before: Pose, kind: str, before_m: float, radius_m: float, begin: Pose, east_m: float, north_m: float
) -> None:
    """From the arc before, whatever its radius, along a common tangent onto the straight."""
    arc = Segment(kind, before, 1.0, before_m)
    path = ingress(arc, (east_m, north_m), begin, radius_m)
    if path is None:
        held = [Point(arc.centre).distance(beside(begin, side * radius_m)) for side in SIDES.values()]
        assert min(held) < abs(radius_m - before_m) + 1e-6
        return
    first, straight, last = path.segments
    assert_flyable(path, min(before_m, radius_m))
    assert (first.start, first.kind, first.radius_m, last.radius_m) == (before, kind, before_m, radius_m)
    assert path.end.position == pytest.approx(begin.position, abs=1e-5)
    assert abs(wrap_pi(path.end.angle_rad - begin.angle_rad)) < 1e-7
    for circle, own_m in ((first, before_m), (last, radius_m)):
        assert straight_m(straight, circle) == pytest.approx(own_m, abs=1e-5)


@settings(deadline=None)
@given(poses, sides, poses)
def test_with_one_radius_ingress_is_a_dubins_line(before: Pose, kind: str, begin: Pose) -> None:
    """With equal radii arc, straight, arc is one of the four lines of Dubins of that form."""
    path = ingress(Segment(kind, before, 1.0, 100.0), before.position, begin, 100.0)
    assume(path is not None and math.dist(before.position, begin.position) > 1.0)
    known = [line.length_m for line in candidates(before, begin, 100.0)]
    assert any(math.isclose(path.length_m, length_m, abs_tol=1e-4) for length_m in known)


def test_no_room_between_the_circles() -> None:
    """Worked by hand: opposite turns 150 m apart (< 100 + 80); the ingress arc goes to the other side."""
    before = Segment("left", Pose(0.0, -100.0, 0.0), 1.0, 100.0)  # about (0, 0)
    begin = Pose(150.0, 80.0, 0.0)  # circles of 80 m about (150, 0), clockwise, and (150, 160)
    near = ingress(before, (0.0, -300.0), begin, 80.0)
    assert [piece.kind for piece in near.segments] == ["left", "straight", "left"]
    assert near.segments[2].centre == pytest.approx((150.0, 160.0))
    far = ingress(before, (0.0, -300.0), Pose(250.0, 80.0, 0.0), 80.0)
    assert [piece.kind for piece in far.segments] == ["left", "straight", "right"]
    assert far.segments[2].centre == pytest.approx((250.0, 0.0))


def test_egress_turns_away_from_a_target_inside_its_circle() -> None:
    """A target 50 m to the left lies in the left circle of 100 m: the line goes right, most of the way."""
    path = egress(Pose(0.0, 0.0, 0.0), (0.0, 50.0), 100.0)
    assert path.segments[0].kind == "right"
    assert path.segments[0].length_m > math.pi * 100.0
    assert path.end.position == pytest.approx((0.0, 50.0), abs=1e-9)


def test_straight_on_needs_no_arc() -> None:
    """A target straight ahead, and a straight that goes on where one is, have arcs of no length."""
    assert egress(Pose(0.0, 0.0, 0.0), (500.0, 0.0), 100.0).segments[0].length_m == pytest.approx(
        0.0, abs=1e-9
    )
    onto = ingress((0.0, 0.0), (0.0, 0.0), Pose(500.0, 0.0, 0.0), 100.0)
    assert onto.length_m == pytest.approx(500.0)
    with pytest.raises(ValueError, match="an arc"):
        ingress(Segment("straight", Pose(0.0, 0.0, 0.0), 1.0), (0.0, 0.0), Pose(500.0, 0.0, 0.0), 100.0)
