"""The quick look at whether all can be seen refuses what the slow one refuses, for its reason."""

from __future__ import annotations

from dataclasses import replace

import pytest

from planner.coverage.seen import check_visible
from planner.coverage.visible import Seeing
from planner.errors import InfeasibleError
from planner.geojson import read_scenario
from planner.scenario import Scenario
from planner.tasks.setting import Setting, seeing
from tests.planner.random.generator import draw
from tests.planner.scenarios import feature, small, square


def asked_of(scenario: Scenario) -> Seeing:
    return seeing(scenario, Setting.of(scenario))


def slowly(asked: Seeing) -> str:
    """What the search for targets says."""
    try:
        asked.visible(asked.surroundings())
    except InfeasibleError as error:
        return str(error)
    return ""


def quickly(asked: Seeing) -> str:
    """What the look says."""
    try:
        check_visible(asked, asked.surroundings())
    except InfeasibleError as error:
        return str(error)
    return ""


@pytest.mark.parametrize("number", [*range(12), 30, 57])
def test_random_scenarios_are_refused_alike(number: int) -> None:
    """Of every kind, those without terrain."""
    case = draw(number)
    if case.terrain is not None:
        pytest.skip("on a raster")
    asked = asked_of(read_scenario(case.document))
    assert quickly(asked) == slowly(asked)


def test_one_region_of_many_that_is_hidden_is_found() -> None:
    """Merged with another, among others that are not looked at: the same words as by the slow search."""
    document = small(feature("C", "roi", "Polygon", square(0.0001, 0.0032, 0.001)))
    by_name = {each["id"]: each for each in document["features"]}
    by_name["area"]["geometry"]["coordinates"] = square(-0.0005, -0.0005, 0.006)
    by_name["start"]["geometry"]["coordinates"] = [0.004, 0.004]
    document["features"] = [each for name, each in by_name.items() if name != "B"]
    # By the paper's passes alone: no divisions are tried.
    asked = replace(asked_of(read_scenario(document)), wide=False)
    assert "A+C" in quickly(asked)
    assert quickly(asked) == slowly(asked)
