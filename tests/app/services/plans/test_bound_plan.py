"""The bound as the service looks for it: its share of the work, or what time a budget leaves, or not."""

from __future__ import annotations

import itertools
import json
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from app.cli.planning import Bound, make
from app.services.plans import work
from tests.planner.scenarios import case


def clocks(seconds: Callable[[], float]) -> SimpleNamespace:
    """A stand-in for the module of time."""
    return SimpleNamespace(perf_counter=seconds, monotonic=seconds)


def bounded(document: dict[str, Any], plan: dict[str, Any], wanted: Path) -> dict[str, Any] | None:
    """The plan's document with what the service adds."""
    result = work.bound_plan(json.dumps(document), json.dumps(plan), str(wanted))
    if result is None:
        return None
    assert result.plan is not None
    found: dict[str, Any] = json.loads(result.plan)
    return found


def without_times(document: dict[str, Any] | None) -> str:
    """A plan's bytes but for the times."""
    assert document is not None
    assert document["metrics"].pop("planning_time_s")
    return json.dumps(document, sort_keys=True)


def test_service_and_command_line_say_the_same_at_any_pace(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """However slowly the clock of either goes: the same plan and the same bound, byte for byte."""
    wanted, document = tmp_path / "wanted", case(1)
    wanted.touch()
    plan = make(document, bound=Bound.NONE)
    days = itertools.count()
    found = []
    for seconds in (lambda: 0.0, lambda: 1e6 * next(days)):
        monkeypatch.setattr("app.services.plans.work.time", clocks(seconds))
        monkeypatch.setattr("app.cli.planning.time", clocks(seconds))
        found.append(without_times(bounded(document, plan, wanted)))
        found.append(without_times(make(document, bound=Bound.SHARE)))
    assert len(set(found)) == 1
    assert '"lower_bound_m"' in found[0]


def test_a_bound_that_makes_room_says_nothing(tmp_path: Path) -> None:
    """What would be found by then hangs on when that was: no bound at all."""
    document = case(1)
    assert bounded(document, make(document, bound=Bound.NONE), tmp_path / "gone") is None


def test_a_budget_ends_the_search(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Spent on the plan it leaves nothing for the bound; with some left there is one, if a low one."""
    wanted, document = tmp_path / "wanted", case(1)
    wanted.touch()
    plan = make(document, bound=Bound.NONE)
    ticks = itertools.count()
    monkeypatch.setattr("app.services.plans.work.time", clocks(lambda: 0.5 * next(ticks)))
    spent_s = sum(plan["metrics"]["planning_time_s"].values())
    assert bounded(document | {"time_budget_s": spent_s}, plan, wanted) is None
    hasty = bounded(document | {"time_budget_s": spent_s + 2.0}, plan, wanted)
    patient = bounded(document, plan, wanted)
    assert hasty is not None
    assert patient is not None
    assert 0.0 < hasty["metrics"]["lower_bound_m"] < patient["metrics"]["lower_bound_m"]
