"""The joint choice of order, heading and offset against brute force: 3 regions, 8 headings, 3 offsets."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable

import numpy as np
import pytest

from planner.coverage.strips.options import Options, make_options
from planner.dubins.estimate_kernels import transit_costs
from planner.dubins.words import shortest_between
from planner.geojson import read_scenario
from planner.orders_kernels import best_orders
from planner.progress import never
from planner.route import Anchor
from planner.routing.joint.chain import from_start, to_end
from planner.scenario import Scenario
from tests.planner.scenarios import case, feature, small, square
from tests.planner.stages import joint_route, sides_of, surroundings
from tests.planner.stages import legs_of as legs_in

HEADINGS_RAD = np.arange(-math.pi, math.pi - 1e-9, math.radians(45.0))
ETAS = np.array([0.0, 0.5, 1.0])
C = feature("C", "roi", "Polygon", square(0.012, 0.03, 0.003))
#: As wide as one swath and a half: seen by two passes.
WIDE = feature("C", "roi", "Polygon", square(0.012, 0.03, 0.0075))
THREAT = feature("M", "threat", "Point", [0.017, 0.009], model="missile", radius_m=900.0)
SETTLE = [{"name": "uav", "airspeed_m_s": 20.0, "min_turn_radius_m": 100.0, "settle_m": 120.0}]
WIDER = read_scenario(small(WIDE))


def options_of(scenario: Scenario) -> list[Options]:
    """Eight headings and three offsets for each region, on every side it has."""
    found = []
    for sides in sides_of(scenario):
        options = make_options(sides, HEADINGS_RAD, ETAS, surroundings(scenario))
        assert options is not None
        found.append(options)
    return found


def cheapest(
    scenario: Scenario, options: list[Options], leg_m: Callable[[Anchor, Anchor], float]
) -> tuple[float, tuple[int, ...]]:
    """The cheapest order of regions and its cost, every order and every option tried."""
    start, end = [Anchor(*scenario.start.position)], [Anchor(*scenario.end.position)]
    entries = [[Anchor(*row) for row in o.entries.tolist()] for o in options]
    exits = [[Anchor(*row) for row in o.exits.tolist()] for o in options]

    def table(begins: list[Anchor], goals: list[Anchor]) -> np.ndarray:
        return np.array([[leg_m(a, b) for b in goals] for a in begins])

    first = [table(start, here)[0] + o.inner_m for here, o in zip(entries, options, strict=True)]
    last = [table(here, end)[:, 0] for here in exits]
    count = range(len(options))
    between = {
        (a, b): table(exits[a], entries[b]) + options[b].inner_m for a in count for b in count if a != b
    }
    best = (math.inf, ())
    for order in itertools.permutations(count):
        cost = first[order[0]]
        for a, b in itertools.pairwise(order):
            cost = cost[..., :, None] + between[a, b]
        best = min(best, (float((cost + last[order[-1]]).min()), order))
    return best


def best_of(scenario: Scenario, options: list[Options]) -> tuple[float, tuple[int, ...]]:
    """What the compiled search finds: the cost and the order of regions."""
    around = surroundings(scenario)
    entries, exits, inner_m = (
        np.concatenate([getattr(o, name) for o in options]) for name in ("entries", "exits", "inner_m")
    )
    offsets = np.concatenate([[0], np.cumsum([len(o.inner_m) for o in options])]).astype(np.int64)
    between = transit_costs(exits, entries, around.radius_m, around.discs) + inner_m
    first = from_start(scenario.start, around, entries, around.discs) + inner_m
    costs, tours = best_orders(first, between, to_end(scenario.end, around, exits, around.discs), offsets)
    order = np.searchsorted(offsets, tours[int(np.argmin(costs))], side="right") - 1
    return float(costs.min()), tuple(order)


@pytest.mark.parametrize(
    "scenario",
    [
        read_scenario(small(C)),
        read_scenario(small(C, vehicles=SETTLE)),
        WIDER,
    ],
    ids=["one pass each", "with settling runs", "one region of two passes"],
)
def test_the_chosen_order_and_options_are_the_best_of_all(scenario: Scenario) -> None:
    """On open ground the exact order over real options is what trying all by plain Dubins words finds."""
    around = surroundings(scenario)
    options = options_of(scenario)
    assert all(len(o.inner_m) >= 24 for o in options)
    assert np.isnan(options[-1].eta_second).all() == (scenario is not WIDER)

    def leg_m(a: Anchor, b: Anchor) -> float:
        return shortest_between(a, b, around.radius_m).length_m

    brute_m, order = cheapest(scenario, options, leg_m)
    cost_m, found = best_of(scenario, options)
    assert cost_m == pytest.approx(brute_m, abs=1e-6)
    # Start and end are one place here, and turned round a tour is as long where its options allow it.
    assert found in (order, order[::-1])


@pytest.mark.parametrize(
    "scenario",
    [
        read_scenario(small(C)),
        read_scenario(small(WIDE)),
        read_scenario(small(C, THREAT)),
    ],
    ids=["open", "one region of two passes", "a threat between"],
)
def test_the_route_is_no_dearer_than_the_best_of_the_grid(scenario: Scenario) -> None:
    """By true costs, threats and all, the joint route costs no more than the best of the whole grid."""
    legs = legs_in(scenario, never)
    brute_m, _ = cheapest(scenario, options_of(scenario), legs.cost_m)
    found = joint_route(scenario)
    assert found.cost_m == pytest.approx(legs.tour_m(found.route.passes))
    assert found.cost_m <= brute_m + 1e-6
    assert found.cost_m >= 0.8 * brute_m


def test_finer_headings_and_offsets_pay() -> None:
    """Refined, the route is shorter than the best of every tenth degree and every half offset."""
    scenario = read_scenario(case(1))
    around = surroundings(scenario)
    tens = np.arange(-math.pi, math.pi - 1e-9, math.radians(10.0))
    options = [
        found
        for sides in sides_of(scenario)
        if (found := make_options(sides, tens, ETAS, around)) is not None
    ]
    coarse_m = best_of(scenario, options)[0]
    assert joint_route(scenario).cost_m < coarse_m - 5.0
