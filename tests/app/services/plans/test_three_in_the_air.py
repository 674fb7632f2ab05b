"""Three aircraft are planned anew in mid-flight: each has a line to its end, and none meet."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.schemas.replans import ReplanIn
from app.services.plans.replanning import left_of
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.plan import Plan
from planner.scenario import Scenario

EXAMPLES = Path(__file__).parents[4] / "examples"


@pytest.fixture(scope="module")
def document() -> dict[str, Any]:
    """The example's scenario."""
    found: dict[str, Any] = json.loads((EXAMPLES / "three-aircraft.geojson").read_text())
    return found


@pytest.fixture(scope="module")
def flown(document: dict[str, Any]) -> tuple[Scenario, Plan]:
    """It, read, and its plan."""
    scenario = read_scenario(document)
    return scenario, make_plan(scenario)


@pytest.mark.parametrize("at_s", [200.0, 300.0, 450.0])
def test_each_has_a_line_to_its_end_and_none_meet(
    document: dict[str, Any], flown: tuple[Scenario, Plan], at_s: float
) -> None:
    """Whoever flies at that time goes on, with work or without; the judge measures what is between them."""
    scenario, plan = flown
    aloft = {p.vehicle for p in plan.paths if p.start_s < at_s < p.start_s + p.duration_s}
    assert aloft
    changes = json.loads((EXAMPLES / "three-aircraft-changes.json").read_text())
    asked = ReplanIn.model_validate(changes | {"at_s": at_s}).asked()
    new = make_plan(read_scenario(left_of(document, scenario, plan, asked)))
    assert new.hard_violations == ()
    assert aloft <= {path.vehicle for path in new.paths}
    for path in new.paths:
        if path.vehicle in aloft:
            assert path.start_s == 0.0
            # Where the old path ended, the new one does.
            old = next(p for p in plan.paths if p.vehicle == path.vehicle)
            assert np.allclose(path.line[-1][:2], old.line[-1][:2], atol=2e-3)


def test_one_in_the_air_with_nothing_to_do_flies_home(
    document: dict[str, Any], flown: tuple[Scenario, Plan]
) -> None:
    """Of three in the air with one region left, two have nothing to see: they get their way home."""
    scenario, plan = flown
    at_s = 300.0
    aloft = {p.vehicle for p in plan.paths if p.start_s < at_s < p.start_s + p.duration_s}
    names = [region.name for region in scenario.regions]
    asked = ReplanIn.model_validate({"at_s": at_s, "remove": names[:-1]}).asked()
    left = left_of(document, scenario, plan, asked)
    new = make_plan(read_scenario(left))
    assert new.hard_violations == ()
    assert aloft <= {path.vehicle for path in new.paths}
    working = {collect.vehicle for collect in new.collects}
    assert working < aloft


@pytest.mark.parametrize(("at_s", "left_one"), [(150.0, "weir"), (300.0, "mill")])
def test_of_two_that_fly_home_at_once_one_waits_where_it_is(
    document: dict[str, Any], at_s: float, left_one: str
) -> None:
    """With nothing to do their ways home come too near: one goes round where it is, and none meet.

    With 100 m of straight flight before passes two of them are where that is so.
    """
    document = document | {"vehicles": [own | {"settle_m": 100} for own in document["vehicles"]]}
    scenario = read_scenario(document)
    plan = make_plan(scenario)
    changes = json.loads((EXAMPLES / "three-aircraft-changes.json").read_text())
    gone = [region.name for region in scenario.regions if region.name != left_one]
    asked = ReplanIn.model_validate({"at_s": at_s, "remove": gone, "add": changes["add"][:1]}).asked()
    new = make_plan(read_scenario(left_of(document, scenario, plan, asked)))
    assert new.hard_violations == ()
    idle = [path for path in new.paths if path.vehicle not in {c.vehicle for c in new.collects}]
    assert len(idle) == 2
    assert all(path.start_s == 0.0 for path in idle)
    round_m = 2.0 * math.pi * 80.0
    firsts = [path.segments[0] for path in idle]
    assert sum(first.kind in ("left", "right") and first.length_m > round_m for first in firsts) == 1
