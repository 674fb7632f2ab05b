"""The objective's weights decide what soft threats and turns cost: in the choice, transits, SSAS alike."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from shapely.geometry import LineString, Point

from planner.airspace.prices import INSIDE_FACTOR, risk_m
from planner.dubins.words import shortest
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.plan import Plan
from planner.route import Pose
from planner.routing.legs import TURN_M, turns_m
from planner.scenario import Scenario
from planner.wishes import Objective
from tests.planner.scenarios import feature, small
from tests.planner.stages import soft_prices, surroundings

#: Between start and the regions, so wide that going round costs some.
BETWEEN = {
    "missile": feature("M", "threat", "Point", [-0.005, -0.005], model="missile", radius_m=900.0),
    "radar": feature(
        "M", "threat", "Point", [-0.005, -0.005], model="radar", radius_m=900.0, intensity_m=500.0
    ),
}


def with_threat(model: str, objective: dict[str, float], **members: Any) -> Scenario:
    """The small scenario with a threat in the way."""
    return read_scenario(small(BETWEEN[model], objective=objective, **members))


def metres_inside(scenario: Scenario, plan: Plan) -> float:
    """How much of the flown line lies in the threat, as shapely has it."""
    (threat,) = scenario.threats
    line = LineString(scenario.frame.to_local([place[:2] for place in plan.paths[0].line]))
    return float(line.intersection(Point(threat.centre).buffer(threat.radius_m, 64)).length)


@pytest.mark.parametrize("model", ["missile", "radar"])
@pytest.mark.parametrize("transit", ["tangent", "ssas"])
def test_no_weight_flies_through_and_a_large_one_round(model: str, transit: str) -> None:
    """Weight 0 gives the plan there is without the threat; 1 and 50 keep out of it, at more length."""
    method = {"transit": transit}
    plans = {
        weight: make_plan(scenario)
        for weight in (0.0, 1.0, 50.0)
        for scenario in [with_threat(model, {"length": 1.0, model: weight}, method=method)]
    }
    scenario = with_threat(model, {})
    assert metres_inside(scenario, plans[0.0]) > 500.0
    assert metres_inside(scenario, plans[1.0]) < 1.0
    assert metres_inside(scenario, plans[50.0]) < 1.0
    assert plans[0.0].metrics.length_m < plans[1.0].metrics.length_m
    if transit == "tangent":
        free = make_plan(read_scenario(small(method=method)))
        assert plans[0.0].metrics.length_m == pytest.approx(free.metrics.length_m, rel=1e-6)
        assert plans[50.0].metrics.length_m == pytest.approx(plans[1.0].metrics.length_m, rel=1e-3)


def test_only_the_weighted_model_matters() -> None:
    """With the radar's weight 0 and the missile's 1, a radar is flown through and a missile gone round."""
    objective = {"length": 1.0, "missile": 1.0, "radar": 0.0}
    for model, through in (("missile", False), ("radar", True)):
        scenario = with_threat(model, objective)
        assert (metres_inside(scenario, make_plan(scenario)) > 500.0) is through


def test_the_more_weight_the_less_risk() -> None:
    """From weight to weight risk never rises and length never falls by more than rounding."""
    found = []
    for weight in (0.0, 0.003, 0.01, 0.03, 0.1, 0.3, 1.0):
        plan = make_plan(with_threat("missile", {"length": 1.0, "missile": weight}))
        found.append((plan.metrics.risk_missile, plan.metrics.length_m))
    for (risk, length_m), (riskier, shorter_m) in zip(found[1:], found[:-1], strict=True):
        assert risk <= riskier + 0.5
        assert length_m >= shorter_m - 5.0
    assert found[0][0] > found[-1][0]


def test_passes_by_price() -> None:
    """A line of 1,000 m, 600 of them inside, costs these at the weights' ratio; equal weights as ever."""
    line = np.array([[-500.0, 400.0], [500.0, 400.0]])
    for missile, length, energy, factor in (
        (1.0, 1.0, 0.0, 20.0),
        (0.5, 1.0, 0.0, 10.0),
        (3.0, 0.5, 0.5, 60.0),
    ):
        scenario = with_threat("missile", {"length": length, "missile": missile, "energy": energy})
        priced = soft_prices(scenario)
        moved = np.column_stack([[0.0], [0.0], [500.0], priced[:, 3]])
        assert risk_m(line, moved) == pytest.approx(600.0 * factor, rel=1e-3)
    assert len(soft_prices(with_threat("missile", {"missile": 0.0}))) == 0


def test_equal_weights_are_what_they_were() -> None:
    """With equal weights no disc may be crossed, and a metre inside costs the old factor."""
    scenario = with_threat("missile", {})
    around = surroundings(scenario)
    assert around.discs.shape == (1, 3)
    assert around.priced[:, 3].tolist() == [INSIDE_FACTOR]


def test_turns_cost_by_their_weight() -> None:
    """Two arcs and a straight cost two turns; a weight on turns never gives a plan with more of them."""
    line = shortest(Pose(0.0, 0.0, 0.0), Pose(2000.0, 800.0, math.pi / 2.0), 100.0)
    assert turns_m([line], Objective(turns=0.5)) == pytest.approx(2.0 * 0.5 * TURN_M)
    assert turns_m([line], Objective()) == 0.0
    plain, few = (make_plan(with_threat("missile", {"turns": weight})) for weight in (0.0, 20.0))
    assert few.metrics.turns <= plain.metrics.turns
    assert few.hard_violations == ()


def test_threats_that_reach_less_high_have_no_price() -> None:
    """Flown over, a threat is neither gone round nor paid for; one that reaches higher is."""
    low, high = (
        {**BETWEEN["missile"], "properties": BETWEEN["missile"]["properties"] | {"height_m": m}}
        for m in (10.0, 5000.0)
    )
    assert len(soft_prices(read_scenario(small(low)))) == 0
    assert len(soft_prices(read_scenario(small(high)))) == 1
