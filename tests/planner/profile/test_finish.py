"""How a flight ends near the edge of its area: never outside while there is a way inside."""

from __future__ import annotations

import re
from typing import Any

import pytest
from shapely.geometry import LineString

from planner.errors import InfeasibleError
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from tests.planner.moved import box, put_at
from tests.planner.scenarios import feature, small

PUT = put_at((8.55, 47.4))
#: A circle of a return is so wide here.
RADIUS_M = 84.0


def beside_edge(away_m: float, **vehicle: Any) -> dict[str, Any]:
    """A start so far inside the western edge of an area."""
    document = small(
        features=[
            feature("A", "roi", "Polygon", box(PUT, 1500, -100, 1700, 100)),
            feature("area", "area", "Polygon", box(PUT, -away_m, -1500, 4000, 1500)),
            feature("start", "start", "Point", PUT(0, 0)),
        ],
        clearance_m=150.0,
    )
    document["vehicles"][0] |= {"min_turn_radius_m": 80.0} | vehicle
    return document


@pytest.mark.parametrize("away_m", [5.0, 40.0, 80.0, 120.0, 400.0])
def test_a_flight_from_near_the_edge_stays_inside(away_m: float) -> None:
    """It lands where a circle round home would leave the area, says so, and returns where that has room."""
    scenario = read_scenario(beside_edge(away_m))
    plan = make_plan(scenario)
    assert scenario.area is not None
    line = LineString(scenario.frame.to_local([place[:2] for place in plan.paths[0].line]))
    assert scenario.area.buffer(0.5).covers(line)
    assert not plan.hard_violations
    lands = away_m < RADIUS_M
    assert plan.vehicles[0].finish == ("land" if lands else "return")
    assert any("ends with a landing" in warning for warning in plan.warnings) == lands


@pytest.mark.parametrize("away_m", [40.0, 80.0])
def test_a_return_that_is_asked_for_is_refused_with_what_would_work(away_m: float) -> None:
    """A landing there is flown, and a return from as far inside as it says."""
    with pytest.raises(InfeasibleError, match="finish: return ends in would leave the area") as refused:
        make_plan(read_scenario(beside_edge(away_m, finish="return")))
    assert (refused.value.constraint, refused.value.feature) == ("area", "start")
    told = re.search(r"finish: land .* (\d+) m farther", refused.value.relaxation)
    assert told is not None
    for away, finish in ((away_m, "land"), (away_m + float(told[1]), "return")):
        plan = make_plan(read_scenario(beside_edge(away, finish=finish)))
        assert (plan.vehicles[0].finish, plan.hard_violations) == (finish, ())
