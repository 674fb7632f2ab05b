"""The lower bound: below brute force, below every plan, and close to the plans of the shared cases."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.geometry import Polygon

from planner.airspace.surroundings import Surroundings
from planner.bounds.nodes import nodes, terminal
from planner.bounds.search import exact_bound_m
from planner.bounds.trees import trees_bound_m
from planner.coverage.strips.options import collect_passes, make_options
from planner.coverage.strips.segments import Neighbourhood
from planner.coverage.strips.sweeps import sweeps
from planner.dubins.estimate_kernels import point_costs, transit_costs
from planner.dubins.kernels import dubins_length
from planner.geojson import read_plan, read_scenario, write_plan
from planner.pipeline import make_plan, with_bound
from planner.route import Pose
from planner.sensors.sar import SarSensor
from tests.planner.coverage.shapes import HEIGHT_M, as_merged, paper_sensor
from tests.planner.coverage.strips.test_sweeps import stars
from tests.planner.scenarios import case, feature, small, square
from tests.planner.stages import lower_bound_m, sides_of, surroundings

RADIUS_M = 100.0
NO_DISCS = np.empty((0, 3))


def never() -> bool:
    return False


def pose(where: Pose) -> tuple[float, float, float]:
    return (*where.position, where.angle_rad)


def dubins(begin: tuple[float, float, float], end: tuple[float, float, float]) -> float:
    return float(dubins_length(*begin, *end, RADIUS_M))


@given(seed=st.integers(0, 1000))
@settings(max_examples=8, deadline=None)
def test_the_bound_is_below_brute_force(seed: int) -> None:
    """Three regions, eight headings, three offsets, every order: none is shorter than either bound."""
    rng = np.random.default_rng(seed)
    places = [rng.uniform(-0.04, 0.04, 2).tolist() for _ in range(3)]
    more = [feature(f"N{k}", "roi", "Polygon", square(e, n, 0.003)) for k, (e, n) in enumerate(places)]
    document = small()
    document["features"] = [f for f in document["features"] if f["properties"]["role"] != "roi"] + more
    scenario = read_scenario(document)
    sides = sides_of(scenario)
    around = surroundings(scenario)
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
                legs = point_costs(east_m, north_m, o.entries, around.radius_m, NO_DISCS)
            else:
                table = transit_costs(previous.exits, o.entries, around.radius_m, NO_DISCS)
                legs = (costs[:, None] + table).min(axis=0)
            costs, previous = legs + length, o
        assert previous is not None
        turned = previous.exits + np.array([0.0, 0.0, math.pi])
        back = point_costs(east_m, north_m, turned, around.radius_m, NO_DISCS)
        best = min(best, float((costs + back).min()))
    assert all(isinstance(side, Neighbourhood) and side.turns == 0 for of in sides for side in of)
    exact = lower_bound_m(scenario, sides, 1.5 * best, effort=100_000)
    assert 0.85 * best < exact <= best + 1e-6
    passes = [node for k, of in enumerate(sides) for node in nodes(of, 0.0, k)]
    ends = terminal(scenario.start), terminal(scenario.end)
    trees = trees_bound_m(passes, *ends, around.radius_m, best, 100_000, never)
    assert 0.7 * best < trees <= best + 1e-6


@st.composite
def sensors(draw: st.DrawFn) -> SarSensor:
    """Abeam or squinted, kept abeam of the course or crabbing in a wind."""
    squint_rad, drift = draw(st.sampled_from([(0.0, 0.0), (0.2, 0.0), (0.0, 0.4), (-0.2, 0.25)]))
    looks = draw(st.sampled_from([("right",), ("left",), ("right", "left")]))
    toward_rad = draw(st.floats(-math.pi, math.pi)) if drift else 0.0
    return replace(paper_sensor(*looks), squint_rad=squint_rad, drift=drift, toward_rad=toward_rad)


@given(
    area=stars(most_swaths=4.0),
    sensor=sensors(),
    extra=st.integers(0, 1),
    away=st.tuples(st.floats(-3000.0, 3000.0), st.floats(-3000.0, 3000.0)),
)
@settings(max_examples=16, deadline=None)
def test_no_sweep_of_one_region_is_shorter(
    area: Polygon, sensor: SarSensor, extra: int, away: tuple[float, float]
) -> None:
    """Of any region, in however many lanes: each sweep on offer is as long as the bound or longer."""
    family = sweeps(as_merged(area), sensor, HEIGHT_M, extra)
    around = Surroundings(None, None, NO_DISCS, NO_DISCS, (), RADIUS_M, 0.0)
    options = make_options(family, family[0].angles_rad, np.array([0.0, 0.4, 1.0]), around)
    assert options is not None
    shortest = math.inf
    for k in range(len(options.inner_m)):
        passes = collect_passes(family, options, k)
        length = sum(p.length_m for p in passes)
        for one, other in itertools.pairwise(passes):
            length += dubins(pose(one.exit), pose(other.entry))
        first, last = passes[0].entry, passes[-1].exit
        length += dubins((*away, 0.5), pose(first)) + dubins(pose(last), (*away, 2.0))
        shortest = min(shortest, length)
    begin, end = np.array([*away, 1.0, 0.5]), np.array([*away, 1.0, 2.0])
    passes_of = nodes(family, 0.0, 0)
    bound = exact_bound_m(passes_of, begin, end, RADIUS_M, (2.0 * shortest,), 400_000, never)
    assert 0.0 < bound <= shortest + 1e-6


@pytest.mark.parametrize("number", [1, 2, 3, 4])
def test_the_shared_cases_are_proved_within_five_percent(number: int) -> None:
    """No plan of a shared case is more than 5 % shorter than ours; plans keep their gap when written."""
    scenario = read_scenario(case(number))
    plan = with_bound(scenario, make_plan(scenario))
    assert plan.metrics.lower_bound_m is not None
    assert plan.metrics.gap == pytest.approx(1.0 - plan.metrics.lower_bound_m / plan.metrics.length_m)
    assert 0.0 <= plan.metrics.gap < 0.05
    again = read_plan(write_plan(plan)).metrics
    assert (again.lower_bound_m, again.gap) == (plan.metrics.lower_bound_m, plan.metrics.gap)


@pytest.mark.parametrize("number", [1, 4])
def test_a_bound_that_aims_above_plans_stays_below_them(number: int) -> None:
    """Asked for twice a plan's length, both bounds stay below the plan: threats only make it longer."""
    scenario = read_scenario(case(number))
    plan = make_plan(scenario)
    aircraft = scenario.aircraft[0]
    sides = sides_of(scenario)
    far_m = 2.0 * plan.metrics.length_m
    exact = lower_bound_m(scenario, sides, far_m, effort=300_000)
    assert 0.7 * plan.metrics.length_m < exact < plan.metrics.length_m
    passes = [node for k, of in enumerate(sides) for node in nodes(of, aircraft.settle_m, k)]
    ends = terminal(scenario.start), terminal(scenario.end)
    trees = trees_bound_m(passes, *ends, aircraft.planned_turn_radius_m, far_m, 300_000, never)
    assert 0.5 * plan.metrics.length_m < trees < plan.metrics.length_m


SPOTLIGHT = {"mode": "spotlight", "resolution_m": 0.3, "wavelength_m": 0.03, "azimuth_beamwidth_deg": 50.0}
WIND = {"wind": {"speed_m_s": 8.0, "from_deg": 70.0}}


@pytest.mark.parametrize(
    ("sensor", "members"),
    [
        ({"squint_deg": 15.0}, {}),
        ({"squint_deg": -20.0}, {"method": {"routing": "li2018"}}),
        (SPOTLIGHT, {}),
        (SPOTLIGHT | {"squint_deg": 10.0}, {}),
        ({}, WIND),
        ({"squint_deg": 10.0, "look": "both"}, WIND),
        ({"pointing_margin_deg": 2.0}, WIND | {"method": {"routing": "li2018-threat-aware"}}),
    ],
)
def test_squint_spotlight_and_crab_have_a_bound(sensor: dict[str, Any], members: dict[str, Any]) -> None:
    """Passes that are not abeam, too: the plan says how far it is from the best, and that is not far."""
    document = small(**members)
    document["sensors"][0] |= sensor
    scenario = read_scenario(document)
    plan = with_bound(scenario, make_plan(scenario))
    assert plan.metrics.gap is not None
    assert 0.0 <= plan.metrics.gap < (0.2 if "method" in members else 0.05)
