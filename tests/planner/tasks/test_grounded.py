"""An aircraft that is not faster than the wind stays on the ground, and the others do what they can."""

from __future__ import annotations

from typing import Any

import pytest

from planner.errors import InfeasibleError
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.validate import findings
from tests.planner.scenarios import feature, of_two, square

WIND = {"speed_m_s": 12.0, "from_deg": 270.0}


def slow_and_fast(**slow: Any) -> dict[str, Any]:
    """Two aircraft in a wind that only the second is faster than."""
    document = of_two(wind=WIND)
    document["vehicles"][0] |= {"airspeed_m_s": 11.0, **slow}
    return document


def test_the_other_does_the_work() -> None:
    """All is seen by the one that can fly; of the other it is said why it does not, and it is no error."""
    document = slow_and_fast()
    plan = make_plan(read_scenario(document))
    assert {path.vehicle for path in plan.paths} == {"second"}
    assert plan.hard_violations == ()
    assert set(plan.metrics.coverage.values()) == {1.0}
    (said,) = [warning for warning in plan.warnings if "not-flown-wind" in warning]
    assert said.startswith("uav: does not fly: the wind of 12 m/s is not slower than its airspeed of 11 m/s")
    (found,) = [each for each in findings(document) if each.rule == "wind-too-strong"]
    assert (found.feature, found.severity) == ("uav", "warning")


def test_what_it_alone_can_see_is_left_out_with_the_reason() -> None:
    """A region for its sensor: left out where it need not be seen, refused by name where it must."""
    document = slow_and_fast(sensors=["other"])
    document["sensors"].append(document["sensors"][0] | {"name": "other"})
    document["vehicles"][1]["sensors"] = ["sar"]
    document["features"].append(
        feature("C", "roi", "Polygon", square(0.0, 0.02, 0.003), sensor="other", required=False)
    )
    plan = make_plan(read_scenario(document))
    assert [(left.roi, left.reason) for left in plan.metrics.left_out] == [("C", "wind")]
    assert plan.metrics.coverage["A"] == plan.metrics.coverage["B"] == 1.0
    document["features"][-1]["properties"]["required"] = True
    with pytest.raises(InfeasibleError, match="is seen by none that flies: uav does not fly") as refused:
        make_plan(read_scenario(document))
    assert (refused.value.constraint, refused.value.feature) == ("wind", "C")


def test_none_that_flies_is_refused() -> None:
    """Both slower than the wind: each is an error, and there is no plan."""
    document = slow_and_fast()
    document["vehicles"][1]["airspeed_m_s"] = 10.0
    errors = {each.feature for each in findings(document) if each.severity == "error"}
    assert errors == {"uav", "second"}
    with pytest.raises(InfeasibleError) as refused:
        make_plan(read_scenario(document))
    assert refused.value.constraint == "wind"


def test_one_in_the_air_is_not_forgotten() -> None:
    """Flying already it cannot stay on the ground: that is refused, not left out."""
    place = {"lon_deg": 0.0, "lat_deg": 0.0, "height_m": 400.0, "heading_deg": 90.0}
    document = slow_and_fast(in_flight=place)
    with pytest.raises(InfeasibleError) as refused:
        make_plan(read_scenario(document))
    assert (refused.value.constraint, refused.value.feature) == ("wind", "uav")


def test_a_search_is_shared_out_among_those_that_fly() -> None:
    """The ground is searched by the one that can, and the other is told of."""
    document = slow_and_fast() | {"task": "search"}
    document["features"] = [f for f in document["features"] if f["properties"]["role"] != "roi"]
    document["features"].append(feature("I", "importance", "Polygon", square(0.0, 0.0, 0.01), score=1.0))
    document["vehicles"][1]["max_flight_time_s"] = 1500.0
    document["vehicles"][0]["max_flight_time_s"] = 1500.0
    plan = make_plan(read_scenario(document))
    assert {path.vehicle for path in plan.paths} == {"second"}
    assert any("not-flown-wind" in warning for warning in plan.warnings)
