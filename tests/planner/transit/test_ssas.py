"""SSAS against its plain twin, and against the laws every route of legs must keep."""

from __future__ import annotations

import math
import random
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from shapely.geometry import LineString, Point, Polygon

from planner.airspace.threats import line_risk, threat_arrays
from planner.airspace.values import Threat
from planner.airspace.zones import ring_edges
from planner.errors import CancelledError, InfeasibleError, OutOfBudgetError
from planner.route import Anchor
from planner.transit.ssas import SsasParameters, search
from planner.transit.ssas_kernels import Space

from .plain_ssas import Surroundings, plain_search

#: What the connector compares neighbours by; the paper's comparison of places alone is ``faithful``.
DIRECTED = SsasParameters(neighbour_angle_rad=math.radians(10.0))
FREER = replace(DIRECTED, coarse_legs=16.0, neighbour_part=0.5, coarse_neighbour_angle_rad=math.radians(10.0))

AREA = Polygon([(0.0, 0.0), (8000.0, 0.0), (8000.0, 6000.0), (0.0, 6000.0)])
THREATS = (
    Threat("M1", "missile", (2011.0, 2003.0), 800.0),
    Threat("M2", "missile", (4607.0, 3511.0), 800.0),
    Threat("M3", "missile", (5903.0, 1307.0), 800.0),
    Threat("D1", "radar", (3301.0, 4507.0), 600.0, intensity_m=600.0),
    Threat("D2", "radar", (6607.0, 4703.0), 600.0, intensity_m=600.0),
)
WALL = Polygon([(3500.0, 500.0), (4000.0, 500.0), (4000.0, 2500.0), (3700.0, 2600.0)])
OPEN = Surroundings()
MAP = Surroundings(THREATS, area=AREA)
ZONED = Surroundings(THREATS, discs=((1200.0, 4300.0, 500.0),), polygons=(WALL,), area=AREA)


def space_of(around):
    missiles, radars = threat_arrays(around.threats)
    rings = [ring_edges(polygon) for polygon in around.polygons]
    return Space(
        missiles,
        radars,
        np.array(around.discs, dtype=np.float64).reshape(-1, 3),
        np.concatenate([np.empty((0, 4)), *rings]),
        np.cumsum([0, *(len(ring) for ring in rings)], dtype=np.int64),
        np.empty((0, 4)) if around.area is None else ring_edges(around.area),
    )


def random_anchor(rng, around, near=None):
    """A pose with 350 m of room from the area's edge and from everything in it."""
    while True:
        if near is None:
            place = (rng.uniform(0.0, 8000.0), rng.uniform(0.0, 6000.0))
        else:
            place = (near[0] + rng.uniform(-700.0, 700.0), near[1] + rng.uniform(-700.0, 700.0))
        point = Point(place)
        kept = [Point(t.centre).buffer(t.radius_m) for t in around.threats]
        kept += [Point(e, n).buffer(radius) for e, n, radius in around.discs]
        kept += list(around.polygons)
        if AREA.buffer(-350.0).contains(point) and all(shape.distance(point) > 350.0 for shape in kept):
            return Anchor(*place, rng.uniform(-math.pi, math.pi))


def random_pairs(seed, count, around, close=False):
    rng = random.Random(seed)
    pairs = []
    for _ in range(count):
        start = random_anchor(rng, around)
        pairs.append((start, random_anchor(rng, around, start.position if close else None)))
    return pairs


def turns(start, goal, points):
    """Turning angles (eq 7) at every waypoint, those at directed ends included."""
    legs = np.diff(points, axis=0)
    angles = np.arctan2(legs[:, 1], legs[:, 0])
    if start.angle_rad is not None:
        angles = np.concatenate([[start.angle_rad], angles])
    if goal.angle_rad is not None:
        angles = np.concatenate([angles, [goal.angle_rad]])
    return np.abs(np.remainder(np.diff(angles) + math.pi, 2.0 * math.pi) - math.pi)


def assert_lawful(start, goal, around, parameters, found):
    points = found.waypoints
    assert tuple(points[0]) == pytest.approx(start.position)
    assert tuple(points[-1]) == pytest.approx(goal.position)
    assert (turns(start, goal, points) <= parameters.max_turn_rad + 1e-6).all()
    legs_m = np.hypot(*np.diff(points, axis=0).T)
    coarse, fine = found.stages[-2], found.stages[-1]
    assert legs_m[: coarse.legs] == pytest.approx(coarse.leg_m)
    # of the fine legs the last two close the route
    assert legs_m[coarse.legs : -2] == pytest.approx(fine.leg_m)
    assert (legs_m[-2:] >= 0.6 * fine.leg_m - 1e-6).all()
    assert (legs_m[-2:] <= 3.0 * fine.leg_m).all()
    for a, b in pairwise(points):
        assert around.allows(tuple(a), tuple(b))


@pytest.mark.parametrize("around", [OPEN, MAP, ZONED], ids=["open", "map", "zoned"])
@pytest.mark.parametrize(
    "parameters", [DIRECTED.faithful(), DIRECTED, FREER], ids=["faithful", "directed", "freer"]
)
def test_search_equals_its_plain_twin(around, parameters):
    """The compiled search gives the plain one's waypoints and cost, or fails where it fails."""
    rng = random.Random(5)
    solved = 0
    for start, goal in random_pairs(7, 20, around):
        # directions within a quarter turn of the way keep the plain search short
        way_rad = math.atan2(goal.north_m - start.north_m, goal.east_m - start.east_m)
        start = replace(start, angle_rad=way_rad + rng.uniform(-0.7, 0.7))
        goal = replace(goal, angle_rad=way_rad + rng.uniform(-0.7, 0.7))
        kind = rng.randrange(4)
        start = Anchor(*start.position) if kind in (1, 3) else start
        goal = Anchor(*goal.position) if kind in (2, 3) else goal
        try:
            capped = replace(parameters, max_nodes=400)
            found = search(start, goal, space_of(around), (1.0, 1.0, 1.0), capped)
        except (InfeasibleError, OutOfBudgetError):
            continue
        line, cost = plain_search(start, goal, around, (1.0, 1.0, 1.0), parameters)
        assert found.cost == pytest.approx(cost, rel=1e-9)
        assert found.waypoints == pytest.approx(np.array(line), abs=1e-6)
        solved += 1
    assert solved >= 10


@pytest.mark.parametrize("close", [False, True], ids=["far", "close"])
@pytest.mark.parametrize("around", [OPEN, MAP, ZONED], ids=["open", "map", "zoned"])
def test_every_route_keeps_the_laws(around, close):
    """Leg lengths, turning angles at every joint, area and hard zones, on random pairs of poses."""
    space = space_of(around)
    solved = 0
    pairs = random_pairs(11, 60, around, close)
    for start, goal in pairs:
        try:
            found = search(start, goal, space, (1.0, 1.0, 1.0), DIRECTED)
        except InfeasibleError:
            continue
        assert_lawful(start, goal, around, DIRECTED, found)
        solved += 1
    assert solved >= 0.8 * len(pairs)


def test_reported_cost_is_eq_25_of_the_waypoints():
    """Without our settings the costs are eqs 10, 12, 14 and 25 of the waypoints, worked out anew."""
    space = space_of(MAP)
    risky = 0
    # weights so small that routes do go through threats
    weights = (1.0, 0.01, 0.02)
    for start, goal in random_pairs(13, 60, MAP):
        for begin, end in ((start, goal), (Anchor(*start.position), goal), (start, Anchor(*goal.position))):
            try:
                found = search(begin, end, space, weights, DIRECTED.faithful())
            except InfeasibleError:
                continue
            kill, detection = line_risk(found.waypoints, THREATS)
            plr = LineString(found.waypoints).length / math.dist(start.position, goal.position)
            assert found.cost_plr == pytest.approx(plr)
            assert found.cost_missile == pytest.approx(kill)
            assert found.cost_radar == pytest.approx(detection)
            assert found.cost == pytest.approx(plr + 0.01 * kill + 0.02 * detection)
            risky += kill + detection > 0.0
    assert risky > 5


def test_clipped_discs_are_seen():
    """A chord shorter than the dividing distance costs something with clipping, nothing without."""
    clipped = Surroundings((Threat("M", "missile", (50.0, 799.5), 800.0),))
    start, goal = Anchor(0.0, 0.0), Anchor(100.0, 0.0)
    plain = search(start, goal, space_of(clipped), parameters=SsasParameters().faithful())
    assert len(plain.waypoints) == 2
    assert plain.cost_missile == 0.0
    ours = SsasParameters(soft_margin_m=0.0)
    straight = search(start, goal, space_of(clipped), (1.0, 0.0, 0.0), ours)
    assert straight.cost_missile == pytest.approx(800.0**4 / (800.0**4 + 799.5**4))
    # where risk is all that counts, the way leads round
    around = search(start, goal, space_of(clipped), (0.0, 1.0, 0.0), ours)
    assert around.cost_missile == 0.0
    assert LineString(around.waypoints).distance(Point(50.0, 799.5)) > 800.0


def test_from_goal_is_the_search_of_the_way_back():
    """Grown from the goal, a route is the way back of the search the other way round."""
    space = space_of(ZONED)
    for start, goal in random_pairs(17, 20, ZONED):
        try:
            found = search(start, goal, space, parameters=DIRECTED, from_goal=True)
        except InfeasibleError:
            continue
        back = search(
            replace(goal, angle_rad=goal.angle_rad + math.pi),
            replace(start, angle_rad=start.angle_rad + math.pi),
            space,
            parameters=DIRECTED,
        )
        assert (turns(start, goal, found.waypoints) <= DIRECTED.max_turn_rad + 1e-6).all()
        # dividing points are counted the other way, so risks and with them ways may differ
        if back.cost_missile == back.cost_radar == found.cost_missile == found.cost_radar == 0.0:
            assert found.waypoints == pytest.approx(back.waypoints[::-1])


def test_overestimating_heuristics_leave_paths_whole():
    """With α2, α3 > 0 samples may be replaced after their expansion; every route still keeps the laws."""
    parameters = SsasParameters(
        neighbour_angle_rad=math.radians(10.0), heuristic_missile=1.0, heuristic_radar=1.0
    )
    space = space_of(MAP)
    solved = 0
    for start, goal in random_pairs(19, 40, MAP):
        try:
            found = search(start, goal, space, parameters=parameters)
        except InfeasibleError:
            continue
        assert_lawful(start, goal, MAP, parameters, found)
        solved += 1
    assert solved > 25


def test_the_same_search_gives_the_same_route():
    """Two runs agree to the last bit."""
    space = space_of(ZONED)
    start, goal = Anchor(500.0, 500.0, 0.3), Anchor(7400.0, 5400.0, 2.0)
    one = search(start, goal, space, parameters=DIRECTED)
    two = search(start, goal, space, parameters=DIRECTED)
    assert one.waypoints.tobytes() == two.waypoints.tobytes()
    assert one.cost == two.cost


def test_straight_ahead_is_one_leg():
    """Collinear poses within two legs are joined by the straight line, however near."""
    for apart_m in (5.0, 60.0, 150.0):
        found = search(Anchor(0.0, 0.0, 0.0), Anchor(apart_m, 0.0, 0.0), space_of(OPEN))
        assert found.waypoints.tolist() == [[0.0, 0.0], [apart_m, 0.0]]


@pytest.mark.parametrize("apart_m", [600.0, 750.0, 900.0])
def test_half_turn_between_antiparallel_passes(apart_m):
    """The two passes of one region are joined by a half turn."""
    found = search(Anchor(0.0, 0.0, 0.0), Anchor(0.0, apart_m, math.pi), space_of(OPEN), parameters=DIRECTED)
    assert_lawful(Anchor(0.0, 0.0, 0.0), Anchor(0.0, apart_m, math.pi), OPEN, DIRECTED, found)
    assert found.length_m < 4.0 * apart_m


def test_closed_in_start_is_infeasible():
    """A start walled in by a ring of zones is refused for the zones, with the place."""
    ring = tuple(
        (300.0 * math.cos(k * math.pi / 6.0), 300.0 * math.sin(k * math.pi / 6.0), 120.0) for k in range(12)
    )
    space = space_of(Surroundings(discs=ring))
    with pytest.raises(InfeasibleError) as caught:
        search(Anchor(0.0, 0.0, 0.0), Anchor(3000.0, 0.0), space)
    assert caught.value.constraint == "hard-zone"
    assert math.hypot(*caught.value.where_enu_m) < 300.0


def test_goal_outside_the_area_is_infeasible():
    """No leg leaves the area, so a goal outside it is refused for the area."""
    with pytest.raises(InfeasibleError) as caught:
        search(Anchor(4000.0, 3000.0, 0.0), Anchor(9000.0, 3000.0), space_of(Surroundings(area=AREA)))
    assert caught.value.constraint == "area"


def test_budget_and_stop_are_said():
    """Too few nodes end the search as out of budget, a stop as cancelled."""
    start, goal = Anchor(500.0, 500.0, 0.3), Anchor(7400.0, 5400.0, 2.0)
    with pytest.raises(OutOfBudgetError):
        search(start, goal, space_of(MAP), parameters=SsasParameters(max_nodes=20))
    with pytest.raises(CancelledError):
        search(start, goal, space_of(MAP), stop=lambda: True)


def test_n_ex_is_eq_27():
    """Six extensions are enough for a half turn at 30° each."""
    assert SsasParameters().extensions == 6
    assert SsasParameters(max_turn_rad=math.radians(50.0)).extensions == 4


@pytest.mark.parametrize(
    "bad", [{"neighbour_radius_m": 100.0}, {"max_turn_rad": 2.0}, {"sectors": 0}, {"soft_margin_m": -1.0}]
)
def test_senseless_parameters_are_refused(bad):
    """Neighbourhoods as wide as a leg, turns past a right angle and the like are errors."""
    with pytest.raises(ValueError, match="must"):
        SsasParameters(**bad)
