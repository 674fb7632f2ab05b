"""Lines round zones: always clear, always flyable, as short as outside references say."""

from __future__ import annotations

import itertools
import math
import random
from unittest import mock

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import minimize_scalar
from shapely.geometry import LineString, Point, Polygon, box

from planner.airspace.zones import Disc, KeepOut, PolygonZone
from planner.angles import wrap_pi
from planner.dubins.path import Path
from planner.dubins.words import candidates_between, shortest_between
from planner.errors import CancelledError, InfeasibleError
from planner.route import Anchor
from planner.transit import tangent
from planner.transit.tangent import connect

RADIUS_M = 100.0
#: Chords of sampled arcs leave the arc by less than this: 2 m on a radius of 100 m.
CHORD_ERROR_M = 0.005 + 1e-3

place = st.floats(-2500.0, 2500.0)
direction = st.none() | st.floats(-math.pi, math.pi)
anchors = st.builds(Anchor, place, place, direction)
circles = st.lists(st.tuples(place, place, st.floats(20.0, 700.0)), max_size=12).map(
    lambda rows: tuple(Disc(f"d{i}", e, n, r, True) for i, (e, n, r) in enumerate(rows))
)
boxes = st.lists(st.tuples(place, place, st.floats(20.0, 600.0), st.floats(20.0, 600.0)), max_size=6).map(
    lambda rows: tuple(
        PolygonZone(f"p{i}", box(e - w, n - h, e + w, n + h), True) for i, (e, n, w, h) in enumerate(rows)
    )
)


def assert_connects(path: Path, start: Anchor, goal: Anchor) -> None:
    """From anchor to anchor, continuous in place and direction, no tighter than the radius."""
    assert math.dist(path.start.position, start.position) < 1e-6
    assert math.dist(path.end.position, goal.position) < 1e-5
    if start.angle_rad is not None:
        assert abs(wrap_pi(path.start.angle_rad - start.angle_rad)) < 1e-6
    if goal.angle_rad is not None:
        assert abs(wrap_pi(path.end.angle_rad - goal.angle_rad)) < 1e-6
    for before, after in itertools.pairwise(path.segments):
        assert math.dist(before.end.position, after.start.position) < 1e-5
        assert abs(wrap_pi(before.end.angle_rad - after.start.angle_rad)) < 1e-6
    for segment in path.segments:
        assert segment.kind == "straight" or segment.radius_m >= RADIUS_M * (1.0 - 1e-9)


def assert_outside(path: Path, zones: KeepOut) -> None:
    """By shapely, on the sampled line: inside the area, outside every hard zone."""
    line = LineString(path.sample(2.0)[:, :2]) if path.length_m > 0.0 else Point(path.start.position)
    for disc in zones.discs:
        if disc.hard:
            assert line.distance(Point(disc.east_m, disc.north_m)) >= disc.radius_m - CHORD_ERROR_M, disc.name
    for zone in zones.polygons:
        assert not line.crosses(zone.polygon.buffer(-CHORD_ERROR_M)), zone.name
        assert not line.within(zone.polygon.buffer(-CHORD_ERROR_M)), zone.name
    if zones.area is not None:
        assert line.within(zones.area.buffer(CHORD_ERROR_M))


@settings(deadline=None, max_examples=200)
@given(anchors, anchors, circles, boxes)
def test_never_enters_a_zone(
    start: Anchor, goal: Anchor, discs: tuple[Disc, ...], polygons: tuple[PolygonZone, ...]
) -> None:
    """Among random discs and boxes the line is clear by shapely, flyable, and no longer than a clear word."""
    zones = KeepOut(discs, polygons, box(-3500, -3500, 3500, 3500))
    try:
        path = connect(start, goal, zones, RADIUS_M)
    except InfeasibleError:
        return
    assert_connects(path, start, goal)
    assert_outside(path, zones)
    words = candidates_between(start, goal, RADIUS_M)
    assert path.length_m >= words[0].length_m - 1e-5
    for word in words:
        if zones.clear(word):
            assert path.length_m <= word.length_m + 1e-6


@given(anchors, anchors)
def test_without_zones_it_is_the_dubins_line(start: Anchor, goal: Anchor) -> None:
    """Nothing in the way: the Dubins word."""
    assert connect(start, goal, KeepOut(), RADIUS_M) == shortest_between(start, goal, RADIUS_M)


def round_one_disc_m(half_m: float, offset_m: float, radius_m: float) -> float:
    """Length from (-half, 0) to (half, 0) round a disc at (0, offset), by tangents and an arc."""
    distance_m = math.hypot(half_m, offset_m)
    wide = 2.0 * math.atan2(half_m, abs(offset_m))
    return 2.0 * math.sqrt(distance_m**2 - radius_m**2) + radius_m * (
        wide - 2.0 * math.acos(radius_m / distance_m)
    )


@pytest.mark.parametrize(
    ("offset_m", "disc_m"), [(1e-6, 400.0), (150.0, 400.0), (-390.0, 400.0), (90.0, 100.0)]
)
def test_one_disc_between_free_ends(offset_m: float, disc_m: float) -> None:
    """Two far places and one disc: the length is the textbook one, on the shorter side."""
    zones = KeepOut((Disc("d", 0.0, offset_m, disc_m, True),))
    path = connect(Anchor(-2000.0, 0.0), Anchor(2000.0, 0.0), zones, RADIUS_M)
    assert path.length_m == pytest.approx(round_one_disc_m(2000.0, offset_m, disc_m), abs=1e-6)
    assert [segment.kind for segment in path.segments][1] == ("right" if offset_m < 0.0 else "left")


def test_small_disc_is_near_the_numerical_optimum() -> None:
    """Round a disc tighter than the turn radius the line is the best single arc, within 0.1 %."""
    disc_m, half_m = 40.0, 300.0
    zones = KeepOut((Disc("d", 0.0, -5.0, disc_m, True),))

    def length_m(lean_rad: float) -> float:
        """Tangents to a leaning circle of the turn radius that touches the disc from around it."""
        off_m = RADIUS_M - disc_m
        centre = (off_m * math.sin(lean_rad), -5.0 - off_m * math.cos(lean_rad))
        total_m, wide = 0.0, 0.0
        for end_e in (-half_m, half_m):
            distance_m = math.dist((end_e, 0.0), centre)
            total_m += math.sqrt(distance_m**2 - RADIUS_M**2)
            wide += abs(math.atan2(end_e - centre[0], -centre[1])) - math.acos(RADIUS_M / distance_m)
        return total_m + RADIUS_M * wide

    reference_m = minimize_scalar(length_m, bounds=(-1.0, 1.0), method="bounded").fun
    path = connect(Anchor(-half_m, 0.0), Anchor(half_m, 0.0), zones, RADIUS_M)
    assert reference_m - 1e-6 <= path.length_m <= reference_m * 1.001


def test_corner_of_a_wall_is_taken_with_the_turn_radius() -> None:
    """Round a long thin wall the line turns at its end, close to the corner's tangent arc."""
    wall = PolygonZone("wall", box(-5.0, -2000.0, 5.0, 300.0), True)
    zones = KeepOut((), (wall,))
    path = connect(Anchor(-1000.0, 0.0), Anchor(1000.0, 0.0), zones, RADIUS_M)
    assert_outside(path, zones)
    polyline_m = 2.0 * math.hypot(995.0, 300.0) + 10.0
    assert polyline_m - 20.0 < path.length_m < polyline_m * 1.005


def test_matches_a_fine_search_over_headings() -> None:
    """A gate of two discs: the line beats every pair of Dubins words through a fine grid of poses in it."""
    zones = KeepOut((Disc("a", 0.0, 250.0, 200.0, True), Disc("b", 0.0, -650.0, 600.0, True)))
    start, goal = Anchor(-900.0, -500.0, math.pi / 2), Anchor(700.0, -600.0, -math.pi / 2)
    path = connect(start, goal, zones, RADIUS_M)
    best_m = math.inf
    for north_m, angle in itertools.product(np.linspace(-49.0, 49.0, 15), np.linspace(-1.2, 1.2, 25)):
        gate = Anchor(0.0, float(north_m), float(angle))
        halves = (
            min((w.length_m for w in candidates_between(a, b, RADIUS_M) if zones.clear(w)), default=math.inf)
            for a, b in ((start, gate), (gate, goal))
        )
        best_m = min(best_m, sum(halves))
    assert path.length_m <= best_m + 1e-6


def test_thirty_overlapping_circles() -> None:
    """A crowd of thirty discs, many overlapping, is crossed clear, and the same way each time."""
    generator = random.Random(7)
    discs = tuple(
        Disc(
            f"d{i}",
            generator.uniform(-3000, 3000),
            generator.uniform(-3000, 3000),
            generator.uniform(100, 700),
            True,
        )
        for i in range(30)
    )
    zones = KeepOut(discs, area=box(-5000, -5000, 5000, 5000))
    start, goal = Anchor(-4500.0, -4500.0, 0.0), Anchor(4500.0, 4500.0, 0.0)
    path = connect(start, goal, zones, RADIUS_M)
    assert_connects(path, start, goal)
    assert_outside(path, zones)
    assert connect(start, goal, zones, RADIUS_M) == path


def test_ends_that_touch_zones() -> None:
    """Ends on a disc's circle and on a polygon's edge, flying along it, are no obstacle."""
    disc = Disc("d", 0.0, 0.0, 500.0, True)
    wall = PolygonZone("wall", box(800, -500, 900, 500), True)
    zones = KeepOut((disc,), (wall,))
    tangent_start = Anchor(500.0 * math.cos(0.7), 500.0 * math.sin(0.7), 0.7 + math.pi / 2)
    for goal in (Anchor(-499.0, -300.0, -math.pi / 2), Anchor(800.0, -400.0, -math.pi / 2)):
        path = connect(tangent_start, goal, zones, RADIUS_M)
        assert_connects(path, tangent_start, goal)
        assert_outside(path, zones)


def test_no_line_between_adjoining_polygons() -> None:
    """Two boxes that share an edge, and one that adjoins the area's edge, leave no gap to fly through."""
    boxes = (
        PolygonZone("north", box(-50, 0, 50, 1000), True),
        PolygonZone("south", box(-60, -1000, 60, 0), True),
    )
    zones = KeepOut((), boxes, box(-3000, -3000, 3000, 1000))
    for start in (Anchor(-1000.0, 400.0), Anchor(-1000.0, 0.0)):
        path = connect(start, Anchor(1000.0, 300.0), zones, RADIUS_M)
        assert_outside(path, zones)
        assert path.sample(5.0, 5.0)[:, 1].min() < -999.0


def test_stays_in_the_area() -> None:
    """In a horseshoe of an area the line goes round its inner corners."""
    horseshoe = Polygon(
        [(0, 0), (3000, 0), (3000, 2000), (2000, 2000), (2000, 1000), (1000, 1000), (1000, 2000), (0, 2000)]
    )
    zones = KeepOut(area=horseshoe)
    start, goal = Anchor(500.0, 1800.0), Anchor(2500.0, 1800.0, math.pi / 2)
    path = connect(start, goal, zones, RADIUS_M)
    assert_connects(path, start, goal)
    assert_outside(path, zones)
    assert path.length_m < math.hypot(500, 800) * 2 + 1000 + 20


def test_turns_away_from_a_near_boundary() -> None:
    """Beside the edge of the area, where one side has no room to turn, the line turns the other way."""
    zones = KeepOut(area=box(0, 0, 3000, 3000))
    start, goal = Anchor(1500.0, 2950.0, 0.0), Anchor(1000.0, 2950.0, math.pi)
    path = connect(start, goal, zones, RADIUS_M)
    assert_connects(path, start, goal)
    assert_outside(path, zones)


@settings(deadline=None, max_examples=60)
@given(anchors, anchors, circles)
def test_soft_zones_never_make_it_fail(start: Anchor, goal: Anchor, discs: tuple[Disc, ...]) -> None:
    """With soft discs alone there is always a line; any it enters could not be kept clear of, too."""
    soft = tuple(Disc(d.name, d.east_m, d.north_m, d.radius_m, False) for d in discs)
    zones = KeepOut(soft)
    path = connect(start, goal, zones, RADIUS_M)
    assert_connects(path, start, goal)
    hard = KeepOut(discs)
    entered = {conflict.zone for conflict in zones.conflicts(path)}
    for name in entered:
        with pytest.raises(InfeasibleError):
            connect(start, goal, hard.without(entered - {name}), RADIUS_M)


def test_soft_disc_at_an_end_is_left_out_and_others_are_not() -> None:
    """A soft disc that holds the start cannot be kept clear; one on the way still is."""
    zones = KeepOut((Disc("home", 0.0, 0.0, 300.0, False), Disc("way", 1000.0, 0.0, 300.0, False)))
    path = connect(Anchor(0.0, 0.0), Anchor(2000.0, 0.0), zones, RADIUS_M)
    assert {conflict.zone for conflict in zones.conflicts(path)} == {"home"}


def metres_inside(path: Path, disc: Disc) -> float:
    """How much of the line lies in the disc, by shapely."""
    line = LineString(path.sample(1.0)[:, :2])
    return line.intersection(Point(disc.east_m, disc.north_m).buffer(disc.radius_m, quad_segs=256)).length


@pytest.mark.parametrize("reverse", [False, True])
def test_short_way_out_of_a_soft_disc(reverse: bool) -> None:
    """An end just inside a soft disc, the other beyond it: out the near side and round, not across."""
    disc = Disc("soft", 0.0, 0.0, 800.0, False)
    inner, outer = Anchor(-700.0, 0.0, math.pi), Anchor(3000.0, 0.0, 0.0)
    if reverse:
        inner, outer = Anchor(-700.0, 0.0, 0.0), Anchor(3000.0, 0.0, math.pi)
    start, goal = (outer, inner) if reverse else (inner, outer)
    path = connect(start, goal, KeepOut((disc,)), RADIUS_M)
    assert_connects(path, start, goal)
    assert 99.0 < metres_inside(path, disc) < 120.0
    assert path.length_m < 6000.0


def test_ends_in_two_soft_discs() -> None:
    """Both ends in soft discs of their own: both crossings are short, and a third disc is kept clear."""
    first, last = Disc("a", 0.0, 0.0, 500.0, False), Disc("b", 4000.0, 0.0, 500.0, False)
    between = Disc("c", 2000.0, 0.0, 600.0, False)
    zones = KeepOut((first, between, last))
    start, goal = Anchor(-300.0, 0.0, math.pi), Anchor(4300.0, 0.0, math.pi)
    path = connect(start, goal, zones, RADIUS_M)
    assert_connects(path, start, goal)
    assert {conflict.zone for conflict in zones.conflicts(path)} == {"a", "b"}
    for disc in (first, last):
        assert metres_inside(path, disc) < 260.0


def test_the_shallowest_soft_disc_is_given_up() -> None:
    """Between two hard walls a soft disc that closes the gate is crossed, one that does not is avoided."""
    walls = (
        PolygonZone("north", box(-50, 200, 50, 5000), True),
        PolygonZone("south", box(-50, -5000, 50, -200), True),
    )
    gate, aside = Disc("gate", 0.0, 0.0, 250.0, False), Disc("aside", 800.0, 0.0, 200.0, False)
    zones = KeepOut((gate, aside), walls, box(-3000, -5000, 3000, 5000))
    path = connect(Anchor(-1500.0, 0.0, 0.0), Anchor(1500.0, 0.0, 0.0), zones, RADIUS_M)
    assert [conflict.zone for conflict in zones.conflicts(path)] == ["gate"]


@pytest.mark.parametrize(
    ("start", "constraint", "feature"),
    [
        (Anchor(0.0, 0.0, 0.0), "hard-zone", "disc"),
        (Anchor(1000.0, 0.0, 0.0), "hard-zone", "block"),
        (Anchor(9000.0, 0.0, 0.0), "area", "area"),
        (Anchor(-350.0, 0.0, 0.0), "hard-zone", "disc"),
        (Anchor(1950.0, 1950.0, 0.9), "area", "area"),
    ],
    ids=["in disc", "in polygon", "outside area", "too close to turn", "into the corner"],
)
def test_refusals_name_zone_and_place(start: Anchor, constraint: str, feature: str) -> None:
    """An end in a hard zone, outside the area or too close to turn is refused by name, with the place."""
    zones = KeepOut(
        (Disc("disc", 0.0, 0.0, 300.0, True),),
        (PolygonZone("block", box(900, -100, 1100, 100), True),),
        box(-2000, -2000, 2000, 2000),
    )
    for there, back in ((start, Anchor(0.0, -1500.0, 0.0)), (Anchor(0.0, -1500.0, 0.0), start)):
        if there is not start and back.angle_rad is not None:
            back = Anchor(back.east_m, back.north_m, back.angle_rad + math.pi)
        with pytest.raises(InfeasibleError) as caught:
            connect(there, back, zones, RADIUS_M)
        assert (caught.value.constraint, caught.value.feature) == (constraint, feature)
        assert caught.value.where_enu_m is not None


def test_enclosed_goal_is_refused() -> None:
    """A goal walled in on all sides is refused, naming a zone of the wall."""
    ring = Point(0, 0).buffer(800).difference(Point(0, 0).buffer(700))
    assert isinstance(ring, Polygon)
    with pytest.raises(InfeasibleError, match="ring"):
        connect(
            Anchor(-2000.0, 0.0), Anchor(0.0, 0.0), KeepOut((), (PolygonZone("ring", ring, True),)), RADIUS_M
        )


def test_stops_when_told() -> None:
    """A search ends with CancelledError once asked to stop; a bad radius or a bad end is refused."""
    zones = KeepOut((Disc("d", 0.0, 0.0, 500.0, True),))
    with pytest.raises(CancelledError):
        connect(Anchor(-1000.0, 0.0), Anchor(1000.0, 0.0), zones, RADIUS_M, stop=lambda: True)
    for radius_m in (0.0, -1.0, math.nan, math.inf):
        with pytest.raises(ValueError, match="radius"):
            connect(Anchor(-1000.0, 0.0), Anchor(1000.0, 0.0), zones, radius_m)
    with pytest.raises(ValueError, match="finite"):
        connect(Anchor(math.nan, 0.0), Anchor(1000.0, 0.0), zones, RADIUS_M)


def test_narrow_neck_of_the_area_is_closed() -> None:
    """Two rooms of the area joined by a neck of a millimetre are not joined."""
    area = box(-1000, -500, 0, 500).union(box(0, -0.0005, 50, 0.0005)).union(box(50, -500, 1000, 500))
    with pytest.raises(InfeasibleError) as caught:
        connect(Anchor(-500.0, 0.0), Anchor(500.0, 0.0), KeepOut(area=area), RADIUS_M)
    assert caught.value.constraint == "area"


@settings(deadline=None, max_examples=40)
@given(anchors, anchors, circles, boxes)
def test_searched_backwards_it_is_as_short(
    start: Anchor, goal: Anchor, discs: tuple[Disc, ...], polygons: tuple[PolygonZone, ...]
) -> None:
    """A search given up at once and made from the goal finds a line of the same length, or none either."""
    zones = KeepOut(discs, polygons)
    found: list[Path | None] = []
    for most in (10_000, 0):
        with mock.patch.object(tangent, "FORWARD_WHEELS", most):
            found.append(tangent._search.__wrapped__(start, goal, zones, RADIUS_M, math.inf))
    forwards, backwards = found
    assert (forwards is None) == (backwards is None)
    if forwards is not None and backwards is not None:
        assert backwards.length_m == pytest.approx(forwards.length_m, abs=1e-5)
        assert_connects(backwards, start, goal)
