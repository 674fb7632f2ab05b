"""Polylines made flyable by turns of a name."""

from __future__ import annotations

import math
from itertools import combinations, pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.geometry import LineString, Point

from planner.airspace.zones import Disc, KeepOut
from planner.angles import wrap_pi
from planner.dubins.rounding import TURNS, by_turns, fewest, round_off
from planner.dubins.turns import quality_m2
from tests.planner.dubins.test_smoothing import RADIUS_M, anywhere, polylines
from tests.planner.dubins.test_words import assert_flyable

names = st.sampled_from(sorted(TURNS))
ends = st.none() | st.floats(-3.0, 3.0)


@settings(deadline=None, max_examples=60)
@given(polylines(), ends, ends, names)
def test_flyable_with_exact_ends(
    waypoints: np.ndarray, start_rad: float | None, end_rad: float | None, name: str
) -> None:
    """Whatever the polyline, the line is continuous, no tighter than the radius, and meets its ends."""
    path = round_off(waypoints, start_rad, end_rad, RADIUS_M, anywhere, name)
    assert_flyable(path, RADIUS_M)
    assert path.start.position == pytest.approx(tuple(waypoints[0]), abs=1e-6)
    assert path.end.position == pytest.approx(tuple(waypoints[-1]), abs=1e-4)
    if start_rad is not None:
        assert abs(wrap_pi(path.start.angle_rad - start_rad)) < 1e-9
    if end_rad is not None:
        assert abs(wrap_pi(path.end.angle_rad - end_rad)) < 1e-6


ZIGZAG = np.array([[0.0, 0.0], [1500.0, 0.0], [2000.0, 1400.0], [3500.0, 1400.0], [3900.0, 0.0]])


@pytest.mark.parametrize("name", ["three-arc", "past-target"])
def test_through_every_waypoint(name: str) -> None:
    """On long legs both pass through every waypoint; three arcs keep nearer to the legs all along (eq 48)."""
    path = by_turns(ZIGZAG, 0.3, -1.0, RADIUS_M, name)
    line = LineString(path.sample(0.5)[:, :2])
    assert max(line.distance(Point(waypoint)) for waypoint in ZIGZAG[:-1]) < 0.02
    assert line.distance(Point(ZIGZAG[-1])) < 1e-6
    if name == "three-arc":
        other = by_turns(ZIGZAG, 0.3, -1.0, RADIUS_M, "past-target")
        assert quality_m2(path, ZIGZAG) < quality_m2(other, ZIGZAG)


@pytest.mark.parametrize("name", sorted(TURNS))
def test_turned_and_mirrored_the_line_is_as_long(name: str) -> None:
    """Rotation by any angle and mirroring change the length by less than half a percent."""
    whole = by_turns(ZIGZAG, 0.3, -1.0, RADIUS_M, name)
    cos, sin = math.cos(2.0), math.sin(2.0)
    turned = by_turns(ZIGZAG @ np.array([[cos, sin], [-sin, cos]]), 2.3, 1.0, RADIUS_M, name)
    mirrored = by_turns(ZIGZAG * [1.0, -1.0], -0.3, 1.0, RADIUS_M, name)
    assert turned.length_m == pytest.approx(whole.length_m, rel=5e-3)
    assert mirrored.length_m == pytest.approx(whole.length_m, rel=5e-3)


def test_needless_waypoints_are_left_out() -> None:
    """The fewest waypoints that clear straights join, against every choice of them by shapely."""
    rng = np.random.default_rng(4)
    discs = [(500.0, 60.0, 90.0), (1100.0, -80.0, 120.0)]
    zones = KeepOut(tuple(Disc(f"d{k}", e, n, r, True) for k, (e, n, r) in enumerate(discs)))
    points = np.column_stack(
        [np.linspace(0.0, 1600.0, 9), np.append(rng.uniform(-150.0, 0.0, 4), rng.uniform(50.0, 200.0, 5))]
    )

    def free(here: int, there: int) -> bool:
        line = LineString(points[[here, there]])
        return there == here + 1 or all(line.distance(Point(e, n)) >= r for e, n, r in discs)

    choices = [(0, *inner, 8) for count in range(8) for inner in combinations(range(1, 8), count)]
    sound = [c for c in choices if all(free(*leg) for leg in pairwise(c))]
    best = min(sound, key=lambda c: (len(c), LineString(points[list(c)]).length))
    assert fewest(points, zones.clear).tolist() == points[list(best)].tolist()


def test_where_a_turn_enters_a_zone_it_is_rounded_otherwise() -> None:
    """Three arcs swing out beyond the leg; where a zone stands there, fillets keep clear of it."""
    corner = np.array([[0.0, 0.0], [1000.0, 0.0], [1000.0, 1000.0]])
    swung = by_turns(corner, None, None, RADIUS_M, "three-arc")
    outside = swung.sample(1.0)[:, :2]
    east_m, north_m = outside[np.argmin(outside[:, 1])]
    zones = KeepOut(
        (Disc("post", float(east_m), float(north_m) - 5.0, 8.0, True), Disc("mid", 400.0, 400.0, 350.0, True))
    )
    assert not zones.clear(swung)
    path = round_off(corner, None, None, RADIUS_M, zones.clear, "three-arc")
    assert zones.clear(path)
    assert_flyable(path, RADIUS_M)


def test_no_room_for_a_turn() -> None:
    """Legs of 100 m have no room for three arcs of 100 m radius; the line is flyable anyway."""
    corner = np.array([[0.0, 0.0], [100.0, 0.0], [100.0, 100.0]])
    assert by_turns(corner, None, None, RADIUS_M, "three-arc") is None
    assert_flyable(round_off(corner, None, None, RADIUS_M, anywhere, "three-arc"), RADIUS_M)
