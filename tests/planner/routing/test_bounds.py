"""The lower bound: below every line it speaks of, below brute force, below every plan."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planner.coverage.segments import Neighbourhood
from planner.dubins.kernels import dubins_length
from planner.geojson import read_plan, read_scenario, write_plan
from planner.pipeline import make_plan
from planner.routing import bounds, joint_kernels
from planner.routing import bounds_kernels as kernels
from planner.routing.joint import sides_of, surroundings
from planner.routing.options import make_options
from tests.planner.scenarios import case, feature, small, square

angle = st.floats(-math.pi, math.pi)
unit = st.floats(-1.0, 1.0)
RADIUS_M = 100.0


@given(
    e=st.floats(-3000.0, 3000.0),
    n=st.floats(-3000.0, 3000.0),
    t0=angle,
    t1=angle,
    a0=st.floats(0.0, 0.3),
    a1=st.floats(0.0, 0.3),
    r0=st.floats(0.0, 200.0),
    r1=st.floats(0.0, 200.0),
    inside=st.lists(unit, min_size=6, max_size=6),
)
@settings(max_examples=400, deadline=None)
def test_no_line_between_two_sets_of_poses_is_shorter(
    e: float, n: float, t0: float, t1: float, a0: float, a1: float, r0: float, r1: float, inside: list[float]
) -> None:
    """Any pose of one set to any of the other: the Dubins line is as long as the bound, or longer."""
    least = kernels.between_least(0.0, 0.0, t0, a0, r0, e, n, t1, a1, r1, RADIUS_M)
    u, v, w, x, y, z = inside
    begin = (r0 * abs(u) * math.cos(math.pi * v), r0 * abs(u) * math.sin(math.pi * v), t0 + a0 * w)
    end = (e + r1 * abs(x) * math.cos(math.pi * y), n + r1 * abs(x) * math.sin(math.pi * y), t1 + a1 * z)
    assert dubins_length(*begin, *end, RADIUS_M) >= least - 1e-6
    free = kernels.place_least(0.0, 0.0, e, n, t1, a1, r1, RADIUS_M)
    assert dubins_length(0.0, 0.0, t0, *end, RADIUS_M) >= free - 1e-6


@given(e=st.floats(800.0, 3000.0), n=st.floats(-3000.0, 3000.0), t0=angle, t1=angle)
@settings(deadline=None)
def test_between_two_poses_the_bound_is_the_dubins_length(e: float, n: float, t0: float, t1: float) -> None:
    """Sets of one pose each, far enough apart: nothing is given away."""
    least = kernels.between_least(0.0, 0.0, t0, 0.0, 0.0, e, n, t1, 0.0, 0.0, RADIUS_M)
    plain = dubins_length(0.0, 0.0, t0, e, n, t1, RADIUS_M)
    assert least <= plain + 1e-6
    # A turn of nothing may come out as a full one, which the bound takes for none.
    assert least == pytest.approx(plain, abs=1e-6) or least >= plain - 2.0 * math.pi * RADIUS_M - 1e-6


@pytest.mark.parametrize("look", ["right", "left"])
@given(
    theta=angle, alpha=st.floats(0.0, 0.3), eta=st.floats(0.0, 1.0), half=st.floats(0.0, 0.5), u=unit, v=unit
)
@settings(max_examples=150, deadline=None)
def test_cells_hold_their_passes(
    look: str, theta: float, alpha: float, eta: float, half: float, u: float, v: float
) -> None:
    """Every pass at a heading and offset of the cell begins and ends within its slack and is no shorter."""
    document = small()
    document["sensors"][0]["look"] = look
    document["vehicles"][0]["settle_m"] = 40.0
    scenario = read_scenario(document)
    sides = sides_of(scenario, scenario.aircraft[0])[0]
    visit = bounds.visits(sides, 40.0, 0)[0]
    cell = kernels.cell(visit.points_m, visit.families[0], theta, alpha, eta, half)
    around = surroundings(scenario, scenario.aircraft[0])
    offset = min(max(eta + v * half, 0.0), 1.0)
    options = make_options(sides, np.array([theta + u * alpha]), np.array([offset]), around)
    if options is None:
        return
    assert cell[kernels.HOLDS] == 1.0
    entry, exit_ = options.entries[0], options.exits[0]
    assert math.dist(entry[:2], cell[[kernels.E_IN, kernels.N_IN]]) <= cell[kernels.SLACK_IN] + 1e-6
    assert math.dist(exit_[:2], cell[[kernels.E_OUT, kernels.N_OUT]]) <= cell[kernels.SLACK_OUT] + 1e-6
    assert math.dist(entry[:2], exit_[:2]) >= cell[kernels.INNER] - 1e-6


@given(seed=st.integers(0, 1000))
@settings(max_examples=12, deadline=None)
def test_the_bound_is_below_brute_force(seed: int) -> None:
    """Three regions, eight headings, three offsets, every order: none is shorter than the bound."""
    rng = np.random.default_rng(seed)
    more = [
        feature(f"N{k}", "roi", "Polygon", square(*(float(x) for x in rng.uniform(-0.04, 0.04, 2)), 0.003))
        for k in range(3)
    ]
    document = small()
    document["features"] = [f for f in document["features"] if f["properties"]["role"] != "roi"] + more
    scenario = read_scenario(document)
    aircraft = scenario.aircraft[0]
    sides = sides_of(scenario, aircraft)
    around = surroundings(scenario, aircraft)
    angles = np.arange(8) * math.pi / 4.0
    options = [make_options(of_region, angles, np.array([0.0, 0.5, 1.0]), around) for of_region in sides]
    best = math.inf
    east_m, north_m = scenario.start.position
    for order in itertools.permutations(options):
        costs, previous = None, order[0]
        for o in order:
            assert o is not None
            assert previous is not None
            length = np.hypot(*(o.exits - o.entries)[:, :2].T)
            if costs is None:
                legs = joint_kernels.point_costs(
                    east_m, north_m, o.entries, around.radius_m, np.empty((0, 3))
                )
            else:
                table = joint_kernels.transit_costs(
                    previous.exits, o.entries, around.radius_m, np.empty((0, 3))
                )
                legs = (costs[:, None] + table).min(axis=0)
            costs, previous = legs + length, o
        assert previous is not None
        turned = previous.exits + np.array([0.0, 0.0, math.pi])
        back = joint_kernels.point_costs(east_m, north_m, turned, around.radius_m, np.empty((0, 3)))
        best = min(best, float((costs + back).min()))
    assert all(isinstance(side, Neighbourhood) and side.turns == 0 for of in sides for side in of)
    exact = bounds.lower_bound_m(scenario, aircraft, sides, 1.5 * best)
    assert 0.5 * best < exact <= best + 1e-6
    nodes = [visit for k, of in enumerate(sides) for visit in bounds.visits(of, 0.0, k)]
    ends = bounds._terminal(scenario.start), bounds._terminal(scenario.end)
    assert bounds._by_trees(nodes, *ends, around.radius_m, best, lambda: False) <= best + 1e-6


@pytest.mark.parametrize("number", [1, 2, 3, 4])
def test_the_bound_is_below_plans_and_survives_the_journey(number: int) -> None:
    """Even a bound that aims far above stays below our plan; plans are written and read with theirs."""
    scenario = read_scenario(case(number))
    plan = make_plan(scenario)
    assert plan.metrics.lower_bound_m is not None
    assert plan.metrics.gap == pytest.approx(1.0 - plan.metrics.lower_bound_m / plan.metrics.length_m)
    again = read_plan(write_plan(plan)).metrics
    assert (again.lower_bound_m, again.gap) == (plan.metrics.lower_bound_m, plan.metrics.gap)
    aircraft = scenario.aircraft[0]
    sides = sides_of(scenario, aircraft)
    free = bounds.lower_bound_m(scenario, aircraft, sides, 2.0 * plan.metrics.length_m)
    assert 0.6 * plan.metrics.length_m < free < plan.metrics.length_m


def test_squint_and_spotlight_have_no_bound() -> None:
    """Passes the bound does not know get none, and the plan says so by leaving it out."""
    document = small()
    document["sensors"][0]["squint_deg"] = 10.0
    assert not bounds.bounded(read_scenario(document))
    assert bounds.bounded(read_scenario(small()))
