"""A time budget ends the search for anything better, wherever it goes on; the plan is whole all the same."""

from __future__ import annotations

import itertools
import json
import math
import pkgutil
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest

from planner.coverage.strips import alternatives
from planner.errors import CancelledError
from planner.geojson import read_scenario, write_plan
from planner.pipeline import lines_for_bound, make_plan, time_for_bound_s, with_bound
from planner.progress import Until, in_time, never, raise_if
from tests.planner.scenarios import EXAMPLES, case, feature, small

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


@pytest.mark.parametrize(
    ("name", "step", "most"),
    [
        # A route once, and none that may be better.
        ("island-volcano", "planner.routing.joint.route._route", 1),
        # Sweeps are an answer: no cells are looked for.
        ("city-block", "planner.coverage.survey.pieces.Pieces.options", 0),
        # One pattern cut to the limits, and as flights of it turn out.
        ("missing-at-sea", "planner.search.choose.Search._cut", 8),
        # The first look at who does what, once for each of few rounds.
        ("three-aircraft", "planner.fleet.auto.search.improve", 3),
    ],
)
def test_a_spent_budget_ends_every_search(
    name: str, step: str, most: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With the time over from the start every task has its plan after the fewest steps that make one."""
    owner, own = step.rsplit(".", 1)
    taken: list[str] = []
    module = pkgutil.resolve_name(owner)
    plain = getattr(module, own)

    def counted(*given: Any, **named: Any) -> Any:
        taken.append(own)
        return plain(*given, **named)

    monkeypatch.setattr(module, own, counted)
    ticks = itertools.count()
    document = json.loads((EXAMPLES / f"{name}.geojson").read_text()) | {"time_budget_s": 1.0}
    plan = make_plan(read_scenario(document), clock=lambda: 100.0 * next(ticks))
    assert not plan.hard_violations
    assert len(taken) <= most


def test_time_ends_what_may_be_better_and_nothing_else() -> None:
    """A trial that time ends is none; one that is done is; who cancels cancels the trial, too."""
    assert in_time(lambda stop: stop(), never, never) is False
    assert in_time(lambda stop: "done", never, lambda: True) is None
    asked = itertools.count()
    assert in_time(raise_if, never, lambda: next(asked) > 0) is None
    with pytest.raises(CancelledError):
        in_time(raise_if, lambda: True, never)


def test_a_part_of_the_time_ends_within_it() -> None:
    """Half of what is left is over at half of it; of no end every part is as long."""
    now = [10.0]
    whole = Until(lambda: now[0], 20.0)
    half = whole.part(0.5)
    now[0] = 16.0
    assert half()
    assert not whole()
    assert not Until().part(0.1)()


def test_the_bound_ends_when_it_is_told_and_says_what_it_has() -> None:
    """Asked for longer it is no lower; asked for no time at all it is a bound."""
    scenario = read_scenario(case(2))
    plan = make_plan(scenario)
    bounds = []
    for most in (0, 5, 40, 10_000):
        asked = itertools.count()
        found = with_bound(scenario, plan, enough=lambda asked=asked, most=most: next(asked) >= most)
        assert found.metrics.lower_bound_m is not None
        bounds.append(found.metrics.lower_bound_m)
    assert bounds[0] > 0.0
    assert bounds == sorted(bounds)
    assert bounds[-1] <= plan.metrics.length_m


def test_plan_and_bound_share_the_budget() -> None:
    """With a budget the bound's time is what it leaves; without one no clock ends it."""
    assert time_for_bound_s(9.0, None) == math.inf
    assert time_for_bound_s(9.0, 10.0) == 1.0
    assert time_for_bound_s(9.0, 8.0) == 0.0


def written(document: dict[str, Any], clock: Callable[[], float]) -> str:
    """The plan of a scenario with its share of a bound, but for the times."""
    scenario = read_scenario(document)
    plan = with_bound(scenario, make_plan(scenario, clock=clock), clock=clock, share=True)
    out = write_plan(plan)
    assert out["metrics"].pop("planning_time_s")
    return json.dumps(out)


@pytest.mark.parametrize("number", [1, 3])
def test_no_clock_changes_a_plan_or_its_bound(number: int) -> None:
    """One clock stands still, with the other everything takes days: the same bytes."""
    days, document = itertools.count(), case(number) | {"seed": 3}
    slow = written(document, lambda: 1e6 * next(days))
    assert slow == written(document, lambda: 0.0)
    assert json.loads(slow)["metrics"]["lower_bound_m"] > 0.0


def test_the_share_of_the_bound_is_of_work() -> None:
    """More passes, more work; the paper's stages take less; what is found in it is not far from all."""
    scenario = read_scenario(case(1))
    plan = make_plan(scenario)
    lines = lines_for_bound(scenario, plan)
    assert 0.0 < lines < lines_for_bound(scenario, replace(plan, collects=2 * plan.collects))
    by_paper = replace(scenario, method=replace(scenario.method, routing="li2018"))
    assert lines_for_bound(by_paper, plan) < lines
    shared = with_bound(scenario, plan, share=True).metrics.lower_bound_m
    whole = with_bound(scenario, plan).metrics.lower_bound_m
    assert shared is not None
    assert whole is not None
    assert 0.8 * whole < shared <= whole
