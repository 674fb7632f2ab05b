"""With the height of home unknown nothing is taken for sea level: what depends on it is kept clear."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from planner.check import judge
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.plan import Plan
from planner.scenario import Scenario
from tests.planner.scenarios import feature, small, square

FAULTS = Path(__file__).parents[2] / "faults"
REFERENCES = ("home", "terrain", "amsl")


def flown_inside_m(scenario: Scenario, plan: Plan, ring: list[list[float]]) -> float:
    """Length of the path inside a ring, in the scenario's own metres."""
    zone = shapely.Polygon(scenario.frame.to_local(ring))
    path = shapely.LineString(scenario.frame.to_local([place[:2] for place in plan.paths[0].line]))
    return float(path.intersection(zone).length)


def warned(scenario: Scenario) -> set[str]:
    return {warning.feature for warning in scenario.warnings if warning.rule == "home-height-unknown"}


@pytest.mark.parametrize(("home_m", "inside"), [(None, False), (0.0, True), (400.0, False), (3000.0, True)])
def test_a_zone_is_crossed_only_where_its_band_is_known_to_be_elsewhere(
    home_m: float | None, inside: bool
) -> None:
    """From an unknown height the zone is flown round, with a warning; from a known one by its band."""
    document = json.loads((FAULTS / "nofly_home_unknown.geojson").read_text())
    if home_m is not None:
        document["features"][1]["geometry"]["coordinates"].append(home_m)
    scenario = read_scenario(document)
    plan = make_plan(scenario)
    ring = document["features"][3]["geometry"]["coordinates"][0]
    assert (flown_inside_m(scenario, plan, ring) > 0.0) is inside
    assert not plan.hard_violations
    assert warned(scenario) == ({"CTR"} if home_m is None else set())
    # The judge, given the plan that crosses, does not believe in sea level either.
    unknown = read_scenario(json.loads((FAULTS / "nofly_home_unknown.geojson").read_text()))
    assert any(v.constraint == "hard-zone" for v in judge(unknown, plan).violations) is inside


def document_with(reference: str, home_m: float | None, **things: dict[str, Any]) -> dict[str, Any]:
    """A scenario at 500 m with a zone, an obstacle and a threat beside the regions."""
    made = small(
        feature("Z", "no_fly", "Polygon", square(0.012, 0.012, 0.002), **things["zone"]),
        feature("O", "obstacle", "Polygon", square(0.012, 0.02, 0.002), **things["obstacle"]),
        feature("T", "threat", "Point", [0.02, 0.03], **things["threat"]),
        altitude_reference=reference,
    )
    start = next(f for f in made["features"] if f["properties"]["role"] == "start")
    if home_m is not None:
        start["geometry"]["coordinates"].append(home_m)
    return made


@given(
    reference=st.sampled_from(REFERENCES),
    home_m=st.floats(-100.0, 450.0),
    floor_m=st.none() | st.floats(-500.0, 1500.0),
    deep_m=st.none() | st.floats(1.0, 1500.0),
    tall_m=st.floats(1.0, 900.0),
    reach_m=st.none() | st.floats(1.0, 900.0),
)
def test_unknown_is_never_less_than_any_height(
    reference: str,
    home_m: float,
    floor_m: float | None,
    deep_m: float | None,
    tall_m: float,
    reach_m: float | None,
) -> None:
    """Whatever some height of home forbids an unknown one forbids as well, and says so if it matters."""
    zone = {} if floor_m is None else {"floor_m": floor_m}
    if deep_m is not None:
        zone["ceiling_m"] = (floor_m or 0.0) + deep_m
    threat = {"model": "missile", "radius_m": 100.0, "hard": True}
    if reach_m is not None:
        threat["height_m"] = reach_m
    things = {"zone": zone, "obstacle": {"height_m": tall_m}, "threat": threat}
    known = read_scenario(document_with(reference, home_m, **things))
    unknown = read_scenario(document_with(reference, None, **things))
    assert hard_names(known) <= hard_names(unknown)
    assert warned(known) == set()
    depends = {"Z"} if zone else set()
    if reference == "amsl":
        depends = {"scenario", "O"} | ({"T"} if reach_m is not None else set())
    assert warned(unknown) == depends
    assert depends - {"scenario"} <= hard_names(unknown)


def hard_names(scenario: Scenario) -> set[str]:
    """What is hard at the flight's height, by heights of the test's own."""
    names = set()
    home_m = scenario.home_amsl_m or 0.0
    over_sea_m = scenario.altitude_m + (0.0 if scenario.altitude_reference == "amsl" else home_m)
    over_ground_m = over_sea_m - home_m
    names |= {z.name for z in scenario.no_fly if z.floor_m <= over_sea_m <= z.ceiling_m}
    names |= {o.name for o in scenario.obstacles if o.base_m + o.height_m >= over_ground_m}
    return names | {t.name for t in scenario.threats if t.hard and t.height_m >= over_ground_m}
