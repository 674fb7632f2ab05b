"""A change of one region leaves the order of the others as it was; what was kept is told."""

from __future__ import annotations

import random
from typing import Any

import pytest

from app.schemas.replans import ReplanIn
from app.services.plans.replanning import left_of
from benchmarks import replan
from planner.geojson import read_plan, read_scenario, write_plan
from planner.pipeline import make_plan
from planner.plan import Plan
from planner.scenario import Scenario


@pytest.fixture(scope="module")
def flown() -> tuple[dict[str, Any], Scenario, Plan]:
    """Eleven regions under one aircraft, and the plan."""
    document = replan.scenario(11, 1)
    scenario = read_scenario(document)
    return document, scenario, make_plan(scenario)


def again(flown: tuple[dict[str, Any], Scenario, Plan], unless_better: float) -> Plan:
    """Planned anew at a third: the last region is gone, another comes in."""
    document, scenario, plan = flown
    gone = plan.collects[-1].regions[0]
    new = replan.region(random.Random(5), "new")
    at_s = plan.paths[0].duration_s / 3.0
    told = {"at_s": at_s, "remove": [gone], "add": [new], "unless_better": unless_better}
    return make_plan(read_scenario(left_of(document, scenario, plan, ReplanIn.model_validate(told).asked())))


def test_all_others_stay_in_their_order(flown: tuple[dict[str, Any], Scenario, Plan]) -> None:
    """As first seen by the plan before; told by the plan, and by what is read of it."""
    *_, plan = flown
    new = again(flown, 1.0)
    assert new.hard_violations == ()
    assert min(new.metrics.coverage.values()) > 0.9999
    order = list(dict.fromkeys(name for collect in new.collects for name in collect.regions))
    before = list(dict.fromkeys(name for collect in plan.collects for name in collect.regions))
    told = new.metrics.replan
    assert told is not None
    assert [name for name in before if name in order] == [name for name in order if name != "new"]
    assert (told.kept, told.moved, told.new) == (tuple(n for n in order if n != "new"), (), ("new",))
    assert read_plan(write_plan(new)).metrics.replan == told


def test_another_order_that_is_better_is_flown(flown: tuple[dict[str, Any], Scenario, Plan]) -> None:
    """With no share to be better by, the plan is no longer than the kept one, but for what is estimated."""
    free, held = again(flown, 0.0), again(flown, 1.0)
    assert free.hard_violations == held.hard_violations == ()
    assert free.metrics.length_m <= 1.05 * held.metrics.length_m
