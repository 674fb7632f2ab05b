"""True costs of legs: against the plain Dubins words, shapely and the wind triangle, each found but once."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.geometry import LineString, Point

from planner.airspace.prices import INSIDE_FACTOR
from planner.airspace.zones import TRANSIT_MARGIN_M, keep_out
from planner.check import line_s
from planner.dubins.words import shortest_between
from planner.errors import InfeasibleError
from planner.geojson import read_scenario
from planner.profile.ends import with_run
from planner.progress import never
from planner.route import Anchor, CollectPass
from planner.routing.legs import Legs, anchor, leaves
from planner.scenario import Scenario
from planner.tasks.setting import Setting
from planner.transit import tangent
from planner.transit.tangent import connect
from tests.planner.scenarios import feature, small
from tests.planner.stages import legs_of as legs_in

metre = st.floats(-1500.0, 1500.0)
anchors = st.builds(Anchor, metre, metre, st.none() | st.floats(-3.0, 3.0))
lines = st.tuples(metre, metre, st.floats(-3.0, 3.0), st.floats(50.0, 900.0)).map(
    lambda row: flown((row[0], row[1]), row[2], row[3])
)


def flown(start: tuple[float, float], angle_rad: float, length_m: float) -> CollectPass:
    """A pass from a place, so far in a direction."""
    end = start[0] + length_m * math.cos(angle_rad), start[1] + length_m * math.sin(angle_rad)
    ground = Point(*start).buffer(1.0)
    return CollectPass(("A",), "sar", "right", start, end, 0.0, ground)


def open_ground(**members: object) -> Scenario:
    """The small scenario without an operating area."""
    document = small(**members)
    document["features"] = [f for f in document["features"] if f["properties"]["role"] != "area"]
    return read_scenario(document)


OPEN = open_ground()
THREATENED = read_scenario(
    small(feature("M", "threat", "Point", [-0.02, -0.02], model="missile", radius_m=500.0))
)
SETTLED = open_ground(
    vehicles=[{"name": "uav", "airspeed_m_s": 20.0, "min_turn_radius_m": 100.0, "settle_m": 150.0}]
)


def legs_of(scenario: Scenario) -> Legs:
    """Legs of the scenario's first aircraft."""
    return legs_in(scenario, never)


def radius_of(scenario: Scenario) -> float:
    """The radius its transits are flown with."""
    return scenario.aircraft[0].planned_turn_radius_m


@settings(deadline=None, max_examples=60)
@given(anchors, anchors)
def test_open_ground_costs_the_shortest_dubins_line(start: Anchor, goal: Anchor) -> None:
    """With nothing in the way a leg costs the length of the plain Dubins word."""
    if math.dist(start.position, goal.position) < 1.0:
        return
    expected_m = shortest_between(start, goal, radius_of(OPEN)).length_m
    assert legs_of(OPEN).cost_m(start, goal) == pytest.approx(expected_m, abs=1e-6)


@settings(deadline=None, max_examples=30)
@given(st.lists(lines, min_size=1, max_size=4))
def test_a_tour_is_the_sum_of_its_parts(passes: list[CollectPass]) -> None:
    """From start to end: Dubins lines between settling runs, the runs and the passes, summed by hand."""
    settle_m, radius_m = SETTLED.aircraft[0].settle_m, radius_of(SETTLED)
    expected_m, before = 0.0, Anchor(*SETTLED.start.position)
    for one in passes:
        back = np.array(one.start) - settle_m * np.array([math.cos(one.angle_rad), math.sin(one.angle_rad)])
        expected_m += shortest_between(
            before, Anchor(float(back[0]), float(back[1]), one.angle_rad), radius_m
        ).length_m
        expected_m += settle_m + one.length_m
        before = Anchor(*one.end, one.angle_rad)
    expected_m += shortest_between(before, Anchor(*SETTLED.end.position), radius_m).length_m
    legs = legs_of(SETTLED)
    assert legs.tour_m(passes) == pytest.approx(expected_m, abs=1e-4)
    ends_m = legs.between_m(None, pose(legs.arrives(passes[0]))) + legs.between_m(
        pose(leaves(passes[-1])), None
    )
    assert legs.inner_m(passes) == pytest.approx(expected_m - ends_m, abs=1e-4)


def pose(at: Anchor) -> np.ndarray:
    """An anchor as the arrays of options have it."""
    return np.array([at.east_m, at.north_m, at.angle_rad])


@given(lines)
def test_a_transit_ends_where_settling_begins(one: CollectPass) -> None:
    """The settling run lies straight before the pass and is as long as the aircraft wants."""
    arrives = legs_of(SETTLED).arrives(one)
    assert math.dist(arrives.position, one.start) == pytest.approx(SETTLED.aircraft[0].settle_m)
    assert math.dist(arrives.position, one.end) == pytest.approx(
        SETTLED.aircraft[0].settle_m + one.length_m, abs=1e-6
    )
    assert arrives.angle_rad == one.angle_rad
    assert leaves(one) == Anchor(*one.end, one.angle_rad)


def test_what_was_asked_for_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each pair of ends is connected once however often it is asked for; the way back is another pair."""
    asked = []

    def counted(start: Anchor, goal: Anchor, *rest: object) -> object:
        asked.append((start, goal))
        return connect(start, goal, *rest)

    monkeypatch.setattr(tangent, "connect", counted)
    legs = legs_of(OPEN)
    a, b = Anchor(0.0, 0.0, 1.0), Anchor(900.0, 300.0, 2.0)
    costs = [legs.cost_m(a, b), legs.cost_m(a, b), legs.between_m(pose(a), pose(b))]
    assert len(set(costs)) == 1
    legs.cost_m(b, a)
    assert asked == [(a, b), (b, a)]


def test_no_line_costs_infinitely_much() -> None:
    """An end inside a hard zone cannot be reached: the leg, and any tour with it, costs inf."""
    zone = feature("Z", "no_fly", "Point", [0.02, 0.02], radius_m=400.0)
    scenario = read_scenario(small(zone))
    legs = legs_of(scenario)
    ((east_m, north_m),) = scenario.frame.to_local([(0.02, 0.02)])
    inside, away = Anchor(float(east_m), float(north_m), 0.0), Anchor(*scenario.start.position)
    assert legs.cost_m(away, inside) == math.inf
    assert legs.tour_m([flown(inside.position, 0.0, 100.0)]) == math.inf
    with pytest.raises(InfeasibleError, match="Z"):
        connect(
            away,
            inside,
            keep_out(scenario.airspace, scenario.level, TRANSIT_MARGIN_M),
            radius_of(scenario),
            never,
        )


def test_a_way_round_a_hard_zone_is_longer_than_straight_on() -> None:
    """A zone between two ends costs what the convex hull of ends and zone says, arcs of entry apart."""
    scenario = read_scenario(
        small(feature("Z", "no_fly", "Point", [0.02, 0.02], radius_m=400.0), clearance_m=0.0)
    )
    ((east_m, north_m),) = scenario.frame.to_local([(0.02, 0.02)])
    start, goal = (
        Anchor(float(east_m) - 1500.0, float(north_m)),
        Anchor(float(east_m) + 1500.0, float(north_m)),
    )
    disc = Point(east_m, north_m).buffer(400.0 + TRANSIT_MARGIN_M, quad_segs=512)
    hull = disc.union(LineString([start.position, goal.position])).convex_hull
    assert legs_of(scenario).cost_m(start, goal) == pytest.approx(hull.length / 2.0, abs=0.05)


@settings(deadline=None, max_examples=40)
@given(st.floats(-700.0, 700.0), st.floats(-700.0, 700.0), st.floats(-3.0, 3.0), st.floats(50.0, 900.0))
def test_metres_inside_a_soft_threat_cost_as_said(
    east_m: float, north_m: float, angle_rad: float, length_m: float
) -> None:
    """A pass costs its length and, for each metre that shapely finds in the disc, the factor more."""
    centre, radius_m = THREATENED.threats[0].centre, THREATENED.threats[0].radius_m
    one = flown((centre[0] + east_m, centre[1] + north_m), angle_rad, length_m)
    line = LineString([one.start, one.end])
    inside_m = line.intersection(Point(*centre).buffer(radius_m, quad_segs=2048)).length
    expected_m = one.length_m + INSIDE_FACTOR * inside_m
    assert legs_of(THREATENED).pass_m(one) == pytest.approx(expected_m, abs=0.5)


def test_a_transit_that_cannot_keep_out_pays_for_what_it_crosses() -> None:
    """A leg that begins in a soft disc costs its length and the factor for the metres inside."""
    centre = THREATENED.threats[0].centre
    start, goal = Anchor(centre[0] + 200.0, centre[1], 0.0), Anchor(centre[0] + 2000.0, centre[1], 0.0)
    assert legs_of(THREATENED).cost_m(start, goal) == pytest.approx(1800.0 + INSIDE_FACTOR * 300.0, rel=2e-3)


@settings(deadline=None, max_examples=30)
@given(anchors, anchors, st.floats(0.0, 359.0))
def test_in_a_wind_time_counts(start: Anchor, goal: Anchor, from_deg: float) -> None:
    """A leg costs its time by the airspeed, as the judge times its line."""
    if math.dist(start.position, goal.position) < 1.0:
        return
    scenario = open_ground(wind={"speed_m_s": 8.0, "from_deg": from_deg})
    aircraft = scenario.aircraft[0].in_wind(8.0)
    legs = legs_in(scenario, never)
    zones = keep_out(scenario.airspace, scenario.level, TRANSIT_MARGIN_M)
    path = connect(start, goal, zones, aircraft.planned_turn_radius_m, never)
    points = path.sample(0.5)[:, :2]
    seconds = line_s(points, np.zeros(len(points)), aircraft, scenario.wind, 0.0)
    assert legs.cost_m(start, goal) == pytest.approx(aircraft.airspeed_m_s * seconds, rel=1e-4)


def test_a_pass_along_the_wind_costs_less_than_one_against_it() -> None:
    """Downwind at V + W, upwind at V - W: metres through the air for the same line."""
    scenario = open_ground(wind={"speed_m_s": 5.0, "from_deg": 270.0})
    legs = legs_in(scenario, never)
    along_rad = scenario.frame.direction_rad(90.0)
    behind = (600.0 * math.cos(along_rad), 600.0 * math.sin(along_rad))
    east, west = flown((0.0, 0.0), along_rad, 600.0), flown(behind, along_rad + math.pi, 600.0)
    assert legs.pass_m(east) == pytest.approx(600.0 * 20.0 / 25.0, rel=1e-3)
    assert legs.pass_m(west) == pytest.approx(600.0 * 20.0 / 15.0, rel=1e-3)


def test_terminals_keep_their_directions() -> None:
    """A start with a heading is left in it, an end with one reached in it."""
    document = small()
    for each in document["features"]:
        if each["properties"]["role"] == "start":
            each["properties"]["heading_deg"] = 90.0
    scenario = read_scenario(document)
    legs = legs_of(scenario)
    along_rad = scenario.frame.direction_rad(90.0)
    assert anchor(scenario.start).angle_rad == pytest.approx(along_rad, abs=1e-3)
    ahead = np.array([math.cos(along_rad), math.sin(along_rad)])
    behind = np.array([*(np.array(scenario.start.position) - 1000.0 * ahead), along_rad + math.pi])
    free = shortest_between(Anchor(*scenario.start.position), Anchor(*behind), radius_of(scenario)).length_m
    assert legs.between_m(None, behind) > free + math.pi * radius_of(scenario) - 1.0


def test_the_order_of_passes_matters_to_the_tour() -> None:
    """Of all orders of three passes in a row, the one along the row is the cheapest."""
    east_m, north_m = OPEN.start.position
    row = [flown((east_m + 1000.0 * k, north_m), 0.0, 200.0) for k in (1, 2, 3)]
    legs = legs_of(OPEN)
    best = min(itertools.permutations(row), key=legs.tour_m)
    assert list(best) == row


@given(
    st.lists(st.tuples(st.floats(-900.0, 900.0), st.floats(-900.0, 900.0)), min_size=2, max_size=4),
    st.builds(Anchor, metre, metre, st.floats(-3.0, 3.0)),
    st.floats(0.0, 359.0),
)
@settings(deadline=None, max_examples=15)
def test_from_the_start_no_run_is_missed_that_keeps_out_of_threats(
    middles: list[tuple[float, float]], goal: Anchor, from_deg: float
) -> None:
    """Where runs that look shortest enter soft threats all are tried: none costs less by more than a turn."""
    threats = [
        feature(f"M{k}", "threat", "Point", [-0.02 + east_m / 111e3, -0.02 + north_m / 111e3])
        for k, (east_m, north_m) in enumerate(middles)
    ]
    for each in threats:
        each["properties"] |= {"model": "missile", "radius_m": 300.0}
    scenario = read_scenario(small(*threats, wind={"speed_m_s": 8.0, "from_deg": from_deg}))
    setting = Setting.of(scenario)
    model = setting.model
    start, end = with_run(setting.ends, setting.level.height_m, model)
    legs = Legs(setting.airspace, setting.level, model, scenario.objective, (start, end), never)
    behind = np.array([start.after_run(angle_rad) for angle_rad in start.runs_rad])
    ways_m = [
        start.run_m * float(model.air_factor(pose[2])) + legs.cost_m(Anchor(*pose.tolist()), goal)
        for pose in behind
    ]
    at = np.array([goal.east_m, goal.north_m, goal.angle_rad])
    assert legs.between_m(None, at) <= min(ways_m) + 2.0 * math.pi * model.turn_radius_m
