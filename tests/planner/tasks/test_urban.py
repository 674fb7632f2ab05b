"""Regions with buildings flown by methods of coverage by name, judged by the house's judge and by shapely."""

from __future__ import annotations

import json
from typing import Any

import pytest
import shapely
from shapely.geometry import LineString, shape

from planner.errors import InfeasibleError, ScenarioError
from planner.geojson import read_scenario, write_plan
from planner.pipeline import make_plan
from tests.planner.scenarios import feature, small, square

#: Degrees of a metre.
M = 1.0 / 111320.0
METHODS = ("majeed2019", "boustrophedon-cells", "coverage-alternatives")


def block(x_m: float, y_m: float, wide_m: float, deep_m: float) -> list[list[list[float]]]:
    """Coordinates of a rectangle."""
    w, s, e, n = x_m * M, y_m * M, (x_m + wide_m) * M, (y_m + deep_m) * M
    return [[[w, s], [e, s], [e, n], [w, n], [w, s]]]


def city(method: str, beside_m: float = 11.0, **members: Any) -> dict[str, Any]:
    """A district of 500 by 360 m with three tall buildings and a low one, cut out with D_safe."""
    document = small(**members)
    buildings = [
        (90, 80, 40, 60, 110),
        (260, 60, 60, 30, 90),
        (300, 200, 30, 70, 200),
        (120, 250, 50, 40, 20),
    ]
    holes = [
        block(x - beside_m, y - beside_m, wide + 2.0 * beside_m, deep + 2.0 * beside_m)[0]
        for x, y, wide, deep, height_m in buildings
        if height_m > 60.0
    ]
    document["features"] = [
        feature("district", "roi", "Polygon", [*block(0, 0, 500, 360), *holes]),
        feature("area", "area", "Polygon", square(-0.01, -0.01, 0.03)),
        feature("start", "start", "Point", [-20 * M, -20 * M]),
        *(
            feature(f"B{k}", "obstacle", "Polygon", block(*place), height_m=height_m)
            for k, (*place, height_m) in enumerate(buildings)
        ),
    ]
    document["altitude_m"] = 60.0
    document["clearance_m"] = 5.0
    document["method"] = {"coverage": method}
    document["vehicles"] = [
        {"name": "quad", "type": "multirotor", "airspeed_m_s": 8.0, "min_turn_radius_m": 4.0, "settle_m": 0.0}
    ]
    document["sensors"] = [{"name": "eye", "type": "camera", "model": "Sony a6000 20 mm"}]
    return document


@pytest.mark.parametrize("method", METHODS)
def test_a_district_is_seen_whole_and_nothing_is_hit(method: str) -> None:
    """All of it is seen, the judge finds nothing, and the line keeps the clearance of every tall building."""
    document = city(method)
    plan = make_plan(read_scenario(document))
    assert plan.violations == ()
    assert plan.metrics.coverage == {"district": 1.0}
    frame = read_scenario(document).frame
    line = LineString(frame.to_local([place[:2] for place in plan.paths[0].line]))
    for each in document["features"]:
        if each["properties"].get("height_m", 0.0) > 55.0:
            outline = LineString(frame.to_local(shapely.get_coordinates(shape(each["geometry"]))))
            assert line.distance(outline) > 5.0 - 0.02
    assert len(plan.photos) == len(plan.collects)
    assert {collect.look for collect in plan.collects} == {"down"}


def test_beside_walls_all_is_seen_and_overlaps_are_judged() -> None:
    """Up to the walls all is seen from free ground; that only one lane is near there is no secret."""
    plan = make_plan(read_scenario(city("majeed2019", beside_m=0.0)))
    assert plan.metrics.coverage == {"district": 1.0}
    assert [violation.constraint for violation in plan.violations] == ["overlap"]


def test_auto_flies_round_what_cuts_a_region() -> None:
    """Without a method's name, and shorter than by any."""
    plans = {name: make_plan(read_scenario(city(name))) for name in ("auto", *METHODS)}
    ours = plans["auto"]
    assert ours.violations == ()
    assert ours.metrics.coverage == {"district": 1.0}
    assert ours.metrics.length_m < 0.96 * min(plans[name].metrics.length_m for name in METHODS)


def test_a_region_filled_by_an_obstacle_is_refused() -> None:
    """An obstacle higher than the flight, over all of it: with the height that would pass over it."""
    document = city("auto")
    document["features"].append(
        feature("tower", "obstacle", "Polygon", block(-5, -5, 510, 370), height_m=90.0)
    )
    with pytest.raises(InfeasibleError, match="altitude_m of 96") as caught:
        make_plan(read_scenario(document))
    assert caught.value.constraint == "hard-zone"
    assert caught.value.feature == "district"


def test_the_same_seed_gives_the_same_plan() -> None:
    """Ants are seeded by the scenario."""
    plans = []
    for _ in range(2):
        written = write_plan(make_plan(read_scenario(city("majeed2019", seed=3))))
        written["metrics"].pop("planning_time_s")
        plans.append(json.dumps(written, sort_keys=True))
    assert plans[0] == plans[1]


def test_ground_beside_obstacles_that_is_not_seen_is_told() -> None:
    """A block too wide to be looked into from beside it: a required region is refused, another a warning."""
    document = city("majeed2019")
    wide = feature("mall", "obstacle", "Polygon", block(180, 110, 110, 130), height_m=150.0)
    document["features"].append(wide)
    with pytest.raises(InfeasibleError, match="required: false"):
        make_plan(read_scenario(document))
    (district,) = (each for each in document["features"] if each["id"] == "district")
    district["properties"]["required"] = False
    plan = make_plan(read_scenario(document))
    assert not any(violation.hard for violation in plan.violations)
    assert any("beside-obstacles" in warning or "too near obstacles" in warning for warning in plan.warnings)
    assert 0.9 < plan.metrics.coverage["district"] < 1.0
    assert "coverage" in {violation.constraint for violation in plan.violations}


def test_obstacles_that_fill_a_region_are_refused() -> None:
    """The region is named, with what would work."""
    document = city("majeed2019")
    document["features"].append(
        feature("all", "obstacle", "Polygon", block(-5, -5, 510, 370), height_m=100.0)
    )
    with pytest.raises(InfeasibleError) as error:
        make_plan(read_scenario(document))
    assert error.value.feature == "district"
    assert "fly higher" in error.value.relaxation


@pytest.mark.parametrize(("wish", "value"), [("approach_deg", [90.0]), ("revisits", 2)])
def test_wishes_that_sweeps_do_not_know_are_refused(wish: str, value: Any) -> None:
    """A heading or visits asked for are no silent loss."""
    document = city("majeed2019")
    document["features"][0]["properties"][wish] = value
    with pytest.raises(ScenarioError) as error:
        read_scenario(document)
    (finding,) = error.value.findings
    assert (finding.feature, finding.rule) == ("district", "not-supported")
    assert wish in finding.fix


def test_a_radar_is_refused() -> None:
    """Footprint sweeps are for what looks down."""
    with pytest.raises(ScenarioError) as error:
        read_scenario(small(method={"coverage": "majeed2019"}))
    assert {finding.feature for finding in error.value.findings} == {"A", "B"}


def test_an_order_besides_is_refused() -> None:
    """Sweeps come in the paper's order: another routing is a contradiction."""
    with pytest.raises(ScenarioError) as error:
        read_scenario(small(method={"coverage": "majeed2019", "routing": "joint"}))
    assert "Leave routing out" in str(error.value.findings[0])
