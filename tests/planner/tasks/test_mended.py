"""Ground beside obstacles that sweeps leave is seen by passes of its own, and no region refused for it."""

from __future__ import annotations

import copy
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from shapely.geometry import LineString, Polygon

from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.route import Terminal
from planner.routing.legs import Legs
from tests.planner.tasks.blocks import among_blocks, buildings

#: Transits asked for with few passes put in; with all that see a piece there were 6,900.
MOST_ASKED = 1_000
CITY = Path(__file__).parents[3] / "examples" / "city-block.geojson"


def other_city(seed: int) -> dict[str, Any]:
    """The example, a quarter of its buildings gone and the others some metres aside."""
    rng = np.random.default_rng(seed)
    document: dict[str, Any] = json.loads(CITY.read_text())
    kept = []
    for each in copy.deepcopy(document["features"]):
        if each["properties"].get("role") == "obstacle":
            if rng.random() < 0.25:
                continue
            off = rng.normal(0.0, 1e-4, 2)
            rings = each["geometry"]["coordinates"]
            each["geometry"]["coordinates"] = [(np.array(ring) + off).tolist() for ring in rings]
        kept.append(each)
    return document | {"features": kept}


@pytest.mark.parametrize("seed", [4, 17, 22, 58])
def test_a_city_drawn_otherwise_is_seen_whole(seed: int) -> None:
    """Each was refused for some square metres beside the church, which a pass sees, or for a sliver."""
    scenario = read_scenario(other_city(seed))
    plan = make_plan(scenario)
    assert plan.hard_violations == ()
    (region,) = scenario.regions
    frame = scenario.frame
    seen = shapely.union_all([Polygon(frame.to_local(each.ring)) for each in plan.footprints])
    tall = [each.area for each in scenario.obstacles if each.height_m > 21.0]
    left = region.area.difference(shapely.union_all([seen.buffer(1e-3), *tall]))
    assert left.area < 1e-4 * region.area.area
    line = LineString(frame.to_local([place[:2] for place in plan.paths[0].line]))
    assert all(line.distance(each) > scenario.clearance_m - 0.1 for each in tall)


@pytest.mark.parametrize("seed", [0, 34])
def test_required_ground_among_close_buildings_is_seen(seed: int) -> None:
    """Where sweeps as laid leave some of it, or cannot be joined, and nothing is hit for it."""
    scenario = read_scenario(among_blocks(seed, 1.4))
    plan = make_plan(scenario)
    assert plan.hard_violations == ()
    assert plan.metrics.coverage == {"R": 1.0}
    frame = scenario.frame
    put = frame.north_up(frame.to_local([(8.55, 47.4)])[0])
    line = LineString(frame.north_up(frame.to_local([place[:2] for place in plan.paths[0].line])))
    for outline, height_m in buildings(seed):
        if height_m > scenario.altitude_m:
            there = shapely.transform(outline, lambda places: places + put)
            assert line.distance(there) > scenario.clearance_m - 0.1


def test_few_of_the_passes_that_see_a_piece_are_put_in(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where those that come first are barred, as many others are tried as elsewhere, not all of hundreds."""
    asked = 0
    known = Legs.cost_m

    def counted(legs: Legs, before: Terminal, behind: Terminal) -> float:
        nonlocal asked
        asked += 1
        return known(legs, before, behind)

    monkeypatch.setattr(Legs, "cost_m", counted)
    plan = make_plan(read_scenario(among_blocks(58, 1.0)))
    assert plan.metrics.coverage == {"R": 1.0}
    assert asked < MOST_ASKED
