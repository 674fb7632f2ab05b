"""Rises and falls: from the ground to the route and back, within the slope, flyable, clear of zones."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.geometry import LineString, Point

from planner.airspace.zones import Disc, KeepOut
from planner.dubins.path import Path
from planner.dubins.run_kernels import NO_DISCS, run_costs
from planner.errors import InfeasibleError
from planner.profile.circling import circle_down
from planner.profile.foot import Foot
from planner.profile.rise import Rise, Terms, fall, rise
from planner.route import Anchor
from planner.transit.tangent import connect

RADIUS_M = 100.0
CIRCLE_M = 105.0
SLOPE_RAD = math.radians(8.0)
OPEN = KeepOut()


def terms(top_m: float, zones: KeepOut = OPEN, spare_m: float = 0.0) -> Terms:
    return Terms(
        top_m,
        SLOPE_RAD,
        SLOPE_RAD,
        CIRCLE_M,
        100.0,
        zones,
        lambda start, goal: connect(start, goal, zones, RADIUS_M),
        lambda path: path.length_m,
        spare_m,
    )


def wing(angle_rad: float | None = None, into_rad: float | None = None) -> Foot:
    return Foot((0.0, 0.0), angle_rad, 0.0, 0.0, 50.0 / math.tan(SLOPE_RAD), 50.0, into_rad)


def foot_for(goal: Anchor) -> Foot:
    """A wing's foot that knows which run leads to a goal best."""
    pose = np.array([[goal.east_m, goal.north_m, goal.angle_rad]])
    runs_rad = np.sort([math.remainder(k * math.tau / 48.0, math.tau) for k in range(48)])
    foot = wing()
    _, best_rad = run_costs(*foot.position, foot.run_m, runs_rad, pose, RADIUS_M, NO_DISCS)
    return replace(foot, likely_rad=float(best_rad[0]))


def sampled(found: Rise) -> tuple[np.ndarray, np.ndarray]:
    points = found.path.sample(5.0, 5.0)
    return points[:, :2], found.heights.at(points[:, 3])


def steepest(found: Rise) -> float:
    rows = found.heights.knots
    return max(abs(b - a) / (b_m - a_m) for (a_m, a), (b_m, b) in pairwise(rows) if b_m > a_m + 1e-6)


def continuous(path: Path) -> bool:
    return all(
        math.dist(a.end.position, b.start.position) < 1e-6
        and abs(math.remainder(a.end.angle_rad - b.start.angle_rad, math.tau)) < 1e-6
        for a, b in pairwise(path.segments)
    )


goals = st.tuples(st.floats(600.0, 9_000.0), st.floats(-math.pi, math.pi), st.floats(-math.pi, math.pi))


@settings(max_examples=40)
@given(goals, st.floats(80.0, 900.0), st.booleans())
def test_up_and_down_keep_the_slope(goal: tuple[float, float, float], top_m: float, down: bool) -> None:
    """Whatever the distance, the height is won within the slope, on a line that can be flown."""
    away_m, way_rad, angle_rad = goal
    there = Anchor(away_m * math.cos(way_rad), away_m * math.sin(way_rad), angle_rad)
    found = fall(wing(), there, terms(top_m)) if down else rise(wing(), there, terms(top_m))
    first, last = found.heights.knots[0][1], found.heights.knots[-1][1]
    assert (first, last) == pytest.approx((top_m, 0.0) if down else (0.0, top_m), abs=1e-6)
    assert steepest(found) <= math.tan(SLOPE_RAD) * (1.0 + 1e-9)
    assert continuous(found.path)
    assert found.heights.length_m == pytest.approx(found.path.length_m, abs=1e-6)
    ends = (found.path.start, found.path.end)
    high, low = ends if down else ends[::-1]
    assert low.position == pytest.approx((0.0, 0.0), abs=1e-6)
    assert high.position == pytest.approx(there.position, abs=1e-6)


@settings(max_examples=30)
@given(goals, st.floats(100.0, 700.0), st.floats(0.0, 300.0), st.booleans())
def test_who_comes_late_to_turns_flies_no_turn_more(
    goal: tuple[float, float, float], top_m: float, spare_m: float, down: bool
) -> None:
    """What may be lost before the turns is made up on them as they are, at the slope that is allowed."""
    there = Anchor(0.2 * goal[0] * math.cos(goal[1]), 0.2 * goal[0] * math.sin(goal[1]), goal[2])
    found = (fall if down else rise)(wing(), there, terms(top_m, spare_m=spare_m))
    last_m = found.path.length_m - found.turns_m if down else found.turns_m
    turns_m = (last_m, last_m + found.inserted_m) if down else (last_m - found.inserted_m, last_m)
    low_m, high_m = sorted(found.heights.at(np.array(turns_m)))
    if found.inserted_m > 0.0:
        late_m = spare_m * math.tan(SLOPE_RAD)
        assert high_m - low_m + late_m <= found.inserted_m * math.tan(SLOPE_RAD) + 1e-6
    assert steepest(found) <= math.tan(SLOPE_RAD) * (1.0 + 1e-9)


@settings(max_examples=30)
@given(goals, st.floats(300.0, 700.0), st.floats(0.0, math.tau), st.booleans())
def test_what_is_flown_low_is_clear_of_zones(
    goal: tuple[float, float, float], away_m: float, way_rad: float, hard: bool
) -> None:
    """With a disc beside the start that holds neither end, run, climb and turns stay out of it."""
    disc = Disc("d", away_m * math.cos(way_rad), away_m * math.sin(way_rad), 0.4 * away_m, hard)
    there = Anchor(goal[0] * math.cos(goal[1]), goal[0] * math.sin(goal[1]), goal[2])
    shape = Point(disc.east_m, disc.north_m).buffer(disc.radius_m, quad_segs=90)
    if shape.distance(Point(there.position)) < 3.0 * RADIUS_M:
        return
    found = rise(wing(), there, terms(500.0, KeepOut(discs=(disc,))))
    places, _ = sampled(found)
    assert LineString(places).intersection(shape.buffer(-0.5)).length == 0.0


def test_a_given_heading_is_flown() -> None:
    """The run goes where the start says, whatever way the route lies."""
    found = rise(wing(angle_rad=2.0), Anchor(4_000.0, -1_000.0, 0.0), terms(300.0))
    assert found.path.start.angle_rad == pytest.approx(2.0)
    down = fall(wing(angle_rad=2.0), Anchor(4_000.0, -1_000.0, 0.0), terms(300.0))
    assert math.remainder(down.path.end.angle_rad - 2.0, math.tau) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("into_rad", [0.0, 1.3, -2.4])
def test_nobody_takes_off_or_lands_with_the_wind_behind(into_rad: float) -> None:
    """Runs go into the wind, or across it."""
    for way_rad in np.linspace(-math.pi, math.pi, 7):
        there = Anchor(3_000.0 * math.cos(way_rad), 3_000.0 * math.sin(way_rad), 0.5)
        foot = wing(into_rad=into_rad)
        assert math.cos(rise(foot, there, terms(300.0)).path.start.angle_rad - into_rad) >= -1e-6
        assert math.cos(fall(foot, there, terms(300.0)).path.end.angle_rad - into_rad) >= -1e-6


@pytest.mark.parametrize("into_rad", [0.0, 1.3, -2.4])
def test_the_wind_is_behind_only_where_no_other_way_leads_and_while_it_is_slow(into_rad: float) -> None:
    """Zones ahead leave ways with half of the wind behind; where it all were behind none is flown."""
    slow = replace(wing(into_rad=into_rad), slow_behind=0.5)
    aside_m = 2.0 * slow.run_m

    def ahead(back_rad: float) -> Terms:
        """Nothing but directions so far off the wind is open, and only to its left."""

        def to(start: Anchor, goal: Anchor) -> Path:
            off_rad = 0.0 if start.angle_rad is None else math.remainder(start.angle_rad - into_rad, math.tau)
            if off_rad < back_rad:
                raise InfeasibleError("area", "area", "is barred", "")
            return connect(start, goal, OPEN, RADIUS_M)

        return replace(terms(300.0), connect=to)

    there = Anchor(aside_m * math.cos(into_rad + 2.0), aside_m * math.sin(into_rad + 2.0), None)
    found = rise(slow, there, ahead(math.radians(100.0)))
    off_rad = math.remainder(found.path.start.angle_rad - into_rad, math.tau)
    assert math.radians(100.0) <= off_rad <= math.radians(120.0) + 1e-6
    assert abs(math.remainder(rise(slow, there, terms(300.0)).path.start.angle_rad - into_rad, math.tau)) <= (
        math.pi / 2.0 + 1e-6
    )
    with pytest.raises(InfeasibleError):
        rise(slow, there, ahead(math.radians(130.0)))


def test_a_long_first_leg_climbs_without_turns() -> None:
    """Where the leg is long enough nothing is inserted."""
    found = rise(wing(), Anchor(8_000.0, 0.0, 0.0), terms(500.0))
    assert found.inserted_m == 0.0
    assert found.path.length_m == pytest.approx(8_000.0)


@settings(max_examples=20)
@given(
    st.floats(150.0, 1_500.0),
    st.floats(-math.pi, math.pi),
    st.floats(-math.pi, math.pi),
    st.sampled_from([180.0, 220.0, 500.0]),
)
def test_a_short_first_leg_climbs_no_further_than_it_needs(
    away_m: float, way: float, angle: float, top_m: float
) -> None:
    """A single turn is as wide as makes it just long enough; turns come at once behind the run."""
    there = Anchor(away_m * math.cos(way), away_m * math.sin(way), angle)
    found = rise(wing(), there, terms(top_m))
    climb_m = top_m / math.tan(SLOPE_RAD) + 100.0
    round_m = math.tau * CIRCLE_M
    plain_m = found.path.length_m - found.inserted_m
    if round_m <= climb_m - plain_m <= 2.0 * round_m:
        assert found.path.length_m <= climb_m + 2.0 * math.tau
    assert found.path.length_m <= max(climb_m, plain_m) + round_m
    assert found.turns_m - found.run_m == pytest.approx(found.inserted_m)
    assert found.run_m == pytest.approx(50.0 / math.tan(SLOPE_RAD))


@settings(max_examples=10)
@given(st.floats(30.0, 1_500.0), st.floats(-math.pi, math.pi), st.floats(-math.pi, math.pi))
def test_no_direction_of_the_run_is_better(away_m: float, way: float, angle: float) -> None:
    """Of directions every two degrees none leads to a shorter line."""
    there = Anchor(away_m * math.cos(way), away_m * math.sin(way), angle)
    here = foot_for(there)
    found = rise(here, there, terms(60.0))
    ways = np.radians(np.arange(0.0, 360.0, 2.0))
    lines_m = [connect(here.run_end(float(each)), there, OPEN, RADIUS_M).length_m for each in ways]
    assert found.path.length_m - found.inserted_m <= here.run_m + min(lines_m) + 1.0


@given(st.floats(120.0, 900.0), st.floats(-math.pi, math.pi))
@settings(max_examples=20)
def test_a_return_ends_on_its_circle(top_m: float, angle_rad: float) -> None:
    """Down to the circle's height, on the circle, at least once round."""
    found = circle_down(Anchor(900.0, 200.0, angle_rad), (0.0, 0.0), 100.0, terms(top_m))
    places, altitudes_m = sampled(found)
    assert altitudes_m[-1] == pytest.approx(100.0, abs=1e-6)
    assert steepest(found) <= math.tan(SLOPE_RAD) * (1.0 + 1e-9)
    last = places[-int(math.tau * CIRCLE_M / 5.0) :]
    np.testing.assert_allclose(np.hypot(*last.T), CIRCLE_M, atol=1e-6)
