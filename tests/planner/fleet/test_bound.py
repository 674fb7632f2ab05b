"""What no assignment can beat."""

from __future__ import annotations

import dataclasses

import pytest

from benchmarks.fleet_cases import case as problem
from planner.fleet.assign import assign
from planner.fleet.auto.build import tables
from planner.fleet.bound import lower_bound
from planner.fleet.problem import Objective
from planner.fleet.schedule import worth_of_all


@pytest.mark.parametrize("seed", range(9))
def test_no_proved_optimum_is_below_it(seed: int) -> None:
    """The relaxation of a small problem never costs more than its best assignment."""
    objective = (
        Objective(total_time=0.3, travel_time=1.0, priority=50.0),
        Objective(last_landing=1.0, total_time=0.01),
        Objective(total_time=1.0, risk=20.0, priority=80.0),
    )[seed % 3]
    given = problem(seed, targets=5, bases=2, required=0.6, objective=objective, max_flight_s=1500.0)
    best = assign(given)
    assert best.status == "optimal"
    assert lower_bound(tables(given)) <= best.cost + worth_of_all(given) + 1e-6


def test_it_is_the_optimum_where_one_aircraft_has_one_way_round() -> None:
    """With nothing left to choose it is the cost itself."""
    given = problem(2, targets=1, members=1, alternatives=1, windows=0.0)
    assert lower_bound(tables(given)) == pytest.approx(assign(given).cost)


def test_a_search_says_its_bound_when_asked() -> None:
    """Bound and cost of more targets than are proved stand in the right order."""
    given = problem(5, targets=12, members=3)
    assert assign(given, iterations=500).bound is None
    answer = assign(given, iterations=500, bounded=True)
    assert answer.status == "feasible"
    assert answer.bound is not None
    assert 0.3 * answer.cost < answer.bound <= answer.cost


def test_tighter_budgets_raise_it() -> None:
    """What all trips together may take is part of the relaxation."""
    loose = problem(3, targets=6, members=1, required=0.0, objective=Objective(total_time=0.0, priority=1.0))
    tight = dataclasses.replace(loose.members[0], max_flight_s=500.0)
    less = dataclasses.replace(loose, members=(tight,))
    assert lower_bound(tables(less)) > lower_bound(tables(loose)) + 1.0
