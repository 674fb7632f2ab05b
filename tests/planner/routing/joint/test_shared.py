"""One pass for several regions: wherever a swath holds them, and wherever that is shorter."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from planner.geojson import read_scenario
from planner.pipeline import make_plan, with_bound
from planner.plan import Plan
from planner.scenario import Scenario
from tests.planner.scenarios import feature, small

FAULTS = Path(__file__).parents[3] / "faults"


def fault(name: str) -> dict[str, Any]:
    document: dict[str, Any] = json.loads((FAULTS / f"{name}.geojson").read_text())
    return document


def lines(gap_deg: float, **properties: Any) -> list[dict[str, Any]]:
    """Two corridors side by side, so far apart, and none of the regions of the small scenario."""
    return [
        feature("N", "roi", "LineString", [[-0.02, gap_deg], [0.04, gap_deg]], width_m=60.0),
        feature("S", "roi", "LineString", [[-0.02, 0.0], [0.04, 0.0]], width_m=60.0, **properties),
    ]


def alone(*more: dict[str, Any], **members: Any) -> dict[str, Any]:
    document = small(**members)
    kept = [f for f in document["features"] if f["properties"]["role"] != "roi"]
    return document | {"features": kept + list(more)}


def planned(document: dict[str, Any]) -> tuple[Scenario, Plan]:
    scenario = read_scenario(document)
    plan = make_plan(scenario)
    assert not plan.hard_violations
    return scenario, plan


def test_two_corridors_far_apart_take_one_pass() -> None:
    """1.2 km apart, far more than the close filter bridges: one pass, and the bound allows for it."""
    scenario, plan = planned(fault("bound_two_corridors"))
    shorter = fault("bound_two_corridors.shorter_plan")["metrics"]["length_m"]
    assert plan.metrics.length_m <= 1.001 * shorter
    assert [collect.regions for collect in plan.collects] == [("road", "river")]
    bound = with_bound(scenario, plan).metrics.lower_bound_m
    assert bound is not None
    assert 0.95 * plan.metrics.length_m < bound <= shorter


def test_a_cluster_of_points_takes_few_passes() -> None:
    """Twelve points within two kilometres: 20.2 km where each near pair was merged, 18.0 km known."""
    scenario, plan = planned(fault("cluster_12_points"))
    assert plan.metrics.length_m <= 18_000.0
    bound = with_bound(scenario, plan).metrics.lower_bound_m
    assert bound is not None
    assert 0.9 * plan.metrics.length_m < bound <= plan.metrics.route_length_m


@pytest.mark.parametrize(
    ("gap_deg", "properties", "passes"),
    [
        (0.0018, {}, 1),
        (0.0043, {}, 1),
        (0.006, {}, 2),
        (0.0036, {"priority": 5.0}, 1),
        (0.0036, {"sensor": "twin"}, 1),
        (0.0036, {"sensor": "other"}, 2),
        (0.0036, {"approach_deg": [90.0, 270.0]}, 1),
        (0.0036, {"approach_deg": [0.0, 180.0]}, 2),
        (0.0036, {"required": False}, 1),
    ],
)
def test_what_agrees_on_a_pass_shares_it(gap_deg: float, properties: dict[str, Any], passes: int) -> None:
    """Within a swath of 577 m, whatever the gap and what else is asked, but for what no pass gives both."""
    document = alone(*lines(gap_deg, **properties))
    sar = document["sensors"][0]
    twin, other = sar | {"name": "twin"}, sar | {"name": "other", "elevation_beamwidth_deg": 28.0}
    _, plan = planned(document | {"sensors": [sar, twin, other]})
    assert plan.metrics.coverage == {"N": 1.0, "S": 1.0}
    sharing = [collect for collect in plan.collects if set(collect.regions) == {"N", "S"}]
    assert len(sharing) == (1 if passes == 1 else 0)
    if passes == 1:
        assert len(plan.collects) == 1


def test_what_is_revisited_has_passes_of_its_own() -> None:
    """One corridor to be seen twice beside one to be seen once: all visits are made."""
    _, plan = planned(alone(*lines(0.003, revisits=2)))
    assert plan.metrics.coverage == {"N": 1.0, "S": 1.0}
    assert sum("S" in collect.regions for collect in plan.collects) >= 2
