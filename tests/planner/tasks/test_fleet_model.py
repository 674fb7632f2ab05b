"""``routing: stecz2020`` end to end: the printed model says who does what."""

from __future__ import annotations

import pytest

from planner.errors import InfeasibleError
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from tests.planner.scenarios import of_two


def test_the_model_shares_regions_out_among_aircraft() -> None:
    """Two aircraft see both regions of a scenario by the model's assignment, and no limit is broken."""
    document = of_two() | {"method": {"routing": "stecz2020"}}
    plan = make_plan(read_scenario(document))
    assert plan.hard_violations == ()
    assert min(plan.metrics.coverage.values()) == 1.0


def test_one_aircraft_is_the_printed_case() -> None:
    """The model serves one aircraft alone."""
    document = of_two() | {"method": {"routing": "stecz2020"}}
    document["vehicles"] = document["vehicles"][:1]
    plan = make_plan(read_scenario(document))
    assert plan.hard_violations == ()
    assert min(plan.metrics.coverage.values()) == 1.0


def test_batteries_to_change_are_no_words_of_the_model() -> None:
    """What it cannot say is refused by name, with the fix."""
    document = of_two() | {"method": {"routing": "stecz2020"}}
    document["vehicles"][0]["batteries"] = 2
    with pytest.raises(InfeasibleError, match=r"one trip.*Use routing auto"):
        make_plan(read_scenario(document))


def test_model_and_auto_agree_and_say_how_good_they_are() -> None:
    """Both prove the same objective through ``make_plan``, which is no less than its bound."""
    ours = make_plan(read_scenario(of_two())).metrics.assignment
    model = make_plan(read_scenario(of_two() | {"method": {"routing": "stecz2020"}})).metrics.assignment
    assert ours is not None
    assert model is not None
    assert (ours.method, model.method, ours.status, model.status) == (
        "assign", "stecz2020", "optimal", "optimal",
    )  # fmt: skip
    assert model.objective_s == pytest.approx(ours.objective_s, abs=0.5)
    assert model.lower_bound_s == pytest.approx(model.objective_s, abs=0.5)
    assert ours.gap == 0.0


def test_more_than_the_model_is_solved_for_is_refused() -> None:
    """Its limit is named, with the fix."""
    document = of_two() | {"method": {"routing": "stecz2020"}}
    first = document["vehicles"][0]
    document["vehicles"] = [first | {"name": f"aircraft {k}"} for k in range(13)]
    with pytest.raises(InfeasibleError, match=r"more than the 100.*Use routing auto"):
        make_plan(read_scenario(document))
