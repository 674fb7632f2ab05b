"""The joint choice: its kernels against brute force, its routes against the rules and the greedy ones."""

from __future__ import annotations

import functools
import itertools
import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.geometry import LineString, Point
from shapely.ops import unary_union

from planner.dubins.estimate_kernels import detour_m, point_to_pose_m
from planner.dubins.words import shortest, shortest_between
from planner.errors import InfeasibleError
from planner.geojson import read_scenario
from planner.orders_kernels import best_options, best_orders, improve_order
from planner.route import Anchor, CollectPass, Pose
from planner.routing.joint import route as joint
from planner.routing.joint.route import JointRoute
from planner.scenario import Scenario
from tests.planner.scenarios import case, feature, small, square
from tests.planner.stages import greedy, joint_route

angle = st.floats(-math.pi, math.pi)
metre = st.floats(-3000.0, 3000.0)


def brute_force(first: np.ndarray, between: np.ndarray, last: np.ndarray, offsets: np.ndarray) -> float:
    clusters = [range(offsets[c], offsets[c + 1]) for c in range(len(offsets) - 1)]
    best = math.inf
    for order in itertools.permutations(clusters):
        for chosen in itertools.product(*order):
            cost = first[chosen[0]] + last[chosen[-1]]
            cost += sum(between[a, b] for a, b in itertools.pairwise(chosen))
            best = min(best, float(cost))
    return best


@given(seed=st.integers(0, 10_000), sizes=st.lists(st.integers(1, 4), min_size=1, max_size=4))
@settings(deadline=None, max_examples=60)
def test_best_orders_is_the_brute_force_optimum(seed: int, sizes: list[int]) -> None:
    """Dynamic programming finds the cost that trying every order and every option finds."""
    rng = np.random.default_rng(seed)
    offsets = np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64)
    count = int(offsets[-1])
    first, last = rng.uniform(0, 100, count), rng.uniform(0, 100, count)
    between = rng.uniform(0, 100, (count, count))
    costs, tours = best_orders(first, between, last, offsets)
    found = int(np.argmin(costs))
    assert costs[found] == pytest.approx(brute_force(first, between, last, offsets))
    tour = tours[found]
    again = first[tour[0]] + last[tour[-1]] + sum(between[a, b] for a, b in itertools.pairwise(tour))
    assert again == pytest.approx(costs[found])
    order = np.searchsorted(offsets, tour, side="right") - 1
    fixed, chosen = best_options(first, between, last, offsets, order.astype(np.int64))
    assert fixed == pytest.approx(costs[found])
    assert sorted(order) == list(range(len(sizes)))
    assert len(chosen) == len(sizes)


@given(seed=st.integers(0, 1000))
@settings(deadline=None, max_examples=20)
def test_improve_order_never_gets_worse(seed: int) -> None:
    """Moves and reversals keep every cluster once and end no dearer than they began."""
    rng = np.random.default_rng(seed)
    offsets = np.arange(0, 13, 2).astype(np.int64)
    first, last = rng.uniform(0, 100, 12), rng.uniform(0, 100, 12)
    between = rng.uniform(0, 100, (12, 12))
    start = rng.permutation(6).astype(np.int64)
    before, _ = best_options(first, between, last, offsets, start)
    order = improve_order(first, between, last, offsets, start.copy(), 5000)
    after, _ = best_options(first, between, last, offsets, order)
    assert sorted(order) == list(range(6))
    assert after <= before
    assert after >= brute_force(first, between, last, offsets) - 1e-9


@given(e=metre, n=metre, a=angle)
@settings(deadline=None)
def test_point_to_pose_is_the_shortest_with_free_start(e: float, n: float, a: float) -> None:
    """The closed form is the plain one's length, and no fixed start direction gives less."""
    if math.hypot(e, n) < 250.0:
        return
    length_m = point_to_pose_m(0.0, 0.0, e, n, a, 100.0)
    assert length_m == pytest.approx(
        shortest_between(Anchor(0, 0), Anchor(e, n, a), 100.0).length_m, abs=1e-6
    )
    for k in range(12):
        start = Pose(0.0, 0.0, k * math.pi / 6)
        assert length_m <= shortest(start, Pose(e, n, a), 100.0).length_m + 1e-6


@given(x=st.floats(200.0, 2000.0), y=st.floats(-400.0, 400.0), r=st.floats(10.0, 190.0))
def test_detour_round_one_disc_is_the_shortest(x: float, y: float, r: float) -> None:
    """The detour is what the convex hull of both ends and the disc says, on its shorter side."""
    end = 2200.0
    discs = np.array([[x, y, r]])
    disc = Point(x, y).buffer(r, quad_segs=256)
    extra_m = detour_m(0.0, 0.0, end, 0.0, discs)
    hull = unary_union([disc, Point(0, 0), Point(end, 0)]).convex_hull
    if min(math.hypot(x, y), math.hypot(end - x, y)) <= r:
        assert extra_m == 0.0
        return
    ring = shapely.get_exterior_ring(hull)
    if not LineString([(0, 0), (end, 0)]).crosses(disc):
        assert extra_m == pytest.approx(0.0, abs=0.05)
        return
    first, second = ring.project(Point(0, 0)), ring.project(Point(end, 0))
    one = abs(first - second)
    assert extra_m == pytest.approx(min(one, ring.length - one) - end, abs=0.05)


@functools.cache
def of_case(number: int) -> tuple[Scenario, JointRoute]:
    """A shared case, and its joint route."""
    scenario = read_scenario(case(number))
    return scenario, joint_route(scenario)


def seen_whole(scenario: Scenario, footprints: list[object]) -> bool:
    ground = unary_union(footprints).buffer(1e-6)
    return all(ground.covers(region.area) for region in scenario.regions)


@pytest.mark.parametrize("number", [1, 2, 3, 4])
def test_joint_routes_see_all_and_enter_nothing(number: int) -> None:
    """On the shared cases the passes see every region, stay inside the area and out of every threat."""
    scenario, found = of_case(number)
    route = found.route
    assert seen_whole(scenario, [p.footprint for p in route.passes])
    for collect in route.passes:
        line = LineString([collect.start, collect.end])
        assert scenario.area is not None
        assert scenario.area.covers(line)
        for threat in scenario.threats:
            assert line.distance(Point(threat.centre)) >= threat.radius_m


@pytest.mark.parametrize("number", [1, 2, 3, 4])
def test_joint_routes_are_shorter_than_greedy_ones(number: int) -> None:
    """With shortest Dubins connections the joint route is at least 4 % shorter than the greedy one."""
    scenario, found = of_case(number)
    radius_m = scenario.aircraft[0].planned_turn_radius_m

    def length_m(passes: tuple[CollectPass, ...]) -> float:
        anchors = [Anchor(*scenario.start.position)]
        for p in passes:
            anchors += [Anchor(*p.start, p.angle_rad), Anchor(*p.end, p.angle_rad)]
        anchors.append(Anchor(*scenario.end.position))
        return sum(shortest_between(a, b, radius_m).length_m for a, b in itertools.pairwise(anchors))

    ours = length_m(found.route.passes)
    assert ours < 0.96 * length_m(greedy(scenario).route.passes)


def test_same_scenario_same_route() -> None:
    """Planning twice gives the same passes to the last bit."""
    scenario, first = of_case(1)
    assert first.route == joint_route(scenario).route


def test_more_regions_than_the_exact_order_takes() -> None:
    """Twelve regions are all seen, in an order found by moves."""
    more = [
        feature(f"N{k}", "roi", "Polygon", square(-0.03 + 0.008 * k, 0.03 - 0.011 * (k % 3), 0.002))
        for k in range(10)
    ]
    scenario = read_scenario(small(*more))
    route = joint_route(scenario).route
    assert seen_whole(scenario, [p.footprint for p in route.passes])


def test_what_cannot_be_seen_is_refused_or_dropped_by_name() -> None:
    """A region behind a hard zone fails the plan when required, else is named and left out."""
    wall = feature("Z", "no_fly", "Polygon", square(-0.013, -0.013, 0.029))
    scenario = read_scenario(small(wall))
    with pytest.raises(InfeasibleError, match="A"):
        joint_route(scenario)
    document = small(wall)
    document["features"][0]["properties"]["required"] = False
    scenario = read_scenario(document)
    found = joint_route(scenario)
    assert [f.feature for f in found.seen.dropped] == ["A"]
    assert {p.regions for p in found.route.passes} == {("B",)}


def test_allowed_approach_headings_are_kept() -> None:
    """Passes fly in the allowed directions alone."""
    document = small()
    document["features"][0]["properties"]["approach_deg"] = [90.0]
    scenario = read_scenario(document)
    route = joint_route(scenario).route
    chosen = next(p for p in route.passes if p.regions == ("A",))
    assert scenario.frame.heading_deg(chosen.angle_rad) == pytest.approx(90.0, abs=0.01)


def ring(*lon_lat: tuple[float, float]) -> list[list[list[float]]]:
    return [[list(place) for place in (*lon_lat, lon_lat[0])]]


def test_more_families_do_not_hide_the_shorter_tour() -> None:
    """Pairs of passes and sweeps together are never longer than pairs alone; here they would be by 3 %."""
    one = ring(
        (0.00246, 0.00839),
        (0.00066, 0.00894),
        (0.00305, 0.01322),
        (0.00634, 0.01435),
        (0.00753, 0.0101),
        (0.00461, 0.00848),
    )
    two = ring(
        (0.00805, 0.00911),
        (0.00625, 0.00966),
        (0.00864, 0.01393),
        (0.01193, 0.01507),
        (0.01312, 0.01082),
        (0.0102, 0.0092),
    )
    near = ring(
        (0.01108, 0.00013), (0.01007, 0.00135), (0.01047, 0.00229), (0.01104, 0.00198), (0.01195, 0.00088)
    )
    far = ring(
        (0.01362, 0.00084), (0.01261, 0.00206), (0.01302, 0.00301), (0.01358, 0.0027), (0.01449, 0.0016)
    )
    headings = {"approach_deg": [90.32293, 270.32293]}
    document = small()
    document["features"] = [
        feature("A", "roi", "Polygon", one),
        feature("B", "roi", "Polygon", two),
        feature("C", "roi", "Polygon", near, **headings),
        feature("D", "roi", "Polygon", far, **headings),
        feature("start", "start", "Point", [-0.04023, 0.01449], heading_deg=256.96461),
    ]
    document["vehicles"][0] |= {"min_turn_radius_m": 250.0, "settle_m": 100.0}
    document["sensors"][0] |= {"incidence_deg": 50.0, "elevation_beamwidth_deg": 15.0, "look": "both"}
    document["sensors"][0]["squint_deg"] = 14.90537
    costs = []
    for method in ({}, {"coverage": "li2018", "routing": "joint"}):
        scenario = read_scenario(document | {"method": method})
        costs.append(joint_route(scenario).cost_m)
    assert costs[0] <= costs[1] + 1e-6


def test_a_divided_region_is_flown_whole_where_the_tour_is_shorter(monkeypatch: pytest.MonkeyPatch) -> None:
    """Dividing this L seems cheaper by itself; with the way to and from it, it is not. No pass is shared."""
    corner = ring(
        (-0.0308, -0.0326),
        (-0.0182, -0.0326),
        (-0.0182, -0.0275),
        (-0.0258, -0.0275),
        (-0.0258, -0.02),
        (-0.0308, -0.02),
    )
    document = small(wind={"speed_m_s": 9.9, "from_deg": 346.0})
    document["features"] = [
        feature("point", "roi", "Point", [0.0326, -0.0014]),
        feature("small", "roi", "Polygon", ring((0.0258, -0.0322), (0.0249, -0.031), (0.0274, -0.0322))),
        feature("L", "roi", "Polygon", corner),
        feature("start", "start", "Point", [0.037, 0.0108]),
    ]
    document["sensors"][0] |= {
        "incidence_deg": 50.0,
        "elevation_beamwidth_deg": 30.0,
        "look": "both",
        "stabilised": True,
    }
    # Turns of 100 m over the ground in this wind.
    document["vehicles"][0]["min_turn_radius_m"] = 100.0 * (20.0 / 29.9) ** 2
    scenario = read_scenario(document)
    monkeypatch.setattr(joint, "SHARED_ROUNDS", 0)
    tried = joint_route(scenario)
    monkeypatch.setattr(joint, "MOST_WHOLE", 0)
    divided = joint_route(scenario)
    assert tried.cost_m < 0.99 * divided.cost_m
    assert len(tried.seen.targets) == len(divided.seen.targets) - 1
