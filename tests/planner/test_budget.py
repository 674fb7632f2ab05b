"""A time budget ends the search for anything better, wherever it goes on; the plan is whole all the same."""

from __future__ import annotations

import itertools
from typing import Any

import pytest

from planner.coverage.strips import alternatives
from planner.geojson import read_scenario
from planner.pipeline import make_plan, time_for_bound_s, with_bound
from tests.planner.scenarios import case, feature, small

BEND = [[-0.02, -0.01], [-0.01, 0.0], [-0.005, 0.012], [0.005, 0.015], [0.02, 0.01], [0.03, -0.005]]


def with_corridor(**members: Any) -> dict[str, Any]:
    return small(feature("C", "roi", "LineString", BEND, width_m=120.0), **members)


def test_a_spent_budget_ends_the_search_for_divisions(monkeypatch: pytest.MonkeyPatch) -> None:
    """With the time over from the start every region is seen all the same, and few divisions are tried."""
    tried: list[int] = []
    whole = alternatives.parts_of

    def counting(region: Any, estimate: Any, *rest: Any) -> Any:
        def counted(parts: Any) -> float:
            tried.append(len(parts))
            return float(estimate(parts))

        return whole(region, counted, *rest)

    monkeypatch.setattr("planner.coverage.strips.targets.parts_of", counting)
    ticks = itertools.count()
    hasty = make_plan(read_scenario(with_corridor(time_budget_s=1.0)), clock=lambda: 100.0 * next(ticks))
    few = len(tried)
    tried.clear()
    patient = make_plan(read_scenario(with_corridor()))
    assert set(hasty.metrics.coverage.values()) == {1.0} == set(patient.metrics.coverage.values())
    assert not hasty.hard_violations
    assert patient.metrics.length_m <= hasty.metrics.length_m + 1e-6
    assert few < len(tried)


def test_the_bound_ends_when_it_is_told_and_says_what_it_has() -> None:
    """Asked for longer it is no lower; asked for no time at all it is a bound."""
    scenario = read_scenario(case(2))
    plan = make_plan(scenario)
    bounds = []
    for most in (0, 5, 40, 10_000):
        asked = itertools.count()
        found = with_bound(scenario, plan, enough=lambda: next(asked) >= most)  # noqa: B023
        assert found.metrics.lower_bound_m is not None
        bounds.append(found.metrics.lower_bound_m)
    assert bounds[0] > 0.0
    assert bounds == sorted(bounds)
    assert bounds[-1] <= plan.metrics.length_m


def test_plan_and_bound_share_the_budget() -> None:
    """The bound's time is a part of the plan's, and no more than the budget leaves."""
    assert time_for_bound_s(9.0, None) <= 9.0 / 2.0
    assert time_for_bound_s(9.0, 10.0) == 1.0
    assert time_for_bound_s(9.0, 8.0) == 0.0
