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
from planner.scenario import Scenario
from tests.planner.moved import box, put_at
from tests.planner.scenarios import feature
from tests.planner.tasks.blocks import SIDE_M, among_blocks, buildings

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


def seen_whole(scenario: Scenario, flown_m: float) -> None:
    """A plan sees all but what stands higher than it is flown, and keeps clear of that."""
    plan = make_plan(scenario)
    assert plan.hard_violations == ()
    (region,) = scenario.regions
    frame = scenario.frame
    seen = shapely.union_all([Polygon(frame.to_local(each.ring)) for each in plan.footprints])
    tall = [each.area for each in scenario.obstacles if each.height_m > flown_m]
    left = region.area.difference(shapely.union_all([seen.buffer(1e-3), *tall]))
    assert left.area < 1e-4 * region.area.area
    line = LineString(frame.to_local([place[:2] for place in plan.paths[0].line]))
    assert all(line.distance(each) > scenario.clearance_m - 0.1 for each in tall)


@pytest.mark.parametrize("seed", [4, 17, 22, 58])
def test_a_city_drawn_otherwise_is_seen_whole(seed: int) -> None:
    """Each was refused for some square metres beside the church, which a pass sees, or for a sliver."""
    scenario = read_scenario(other_city(seed))
    seen_whole(scenario, 21.0)


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


def streets(seed: int) -> dict[str, Any]:
    """Blocks on three by three lots, low and high, with streets between them: all of it is required."""
    rng, put = np.random.default_rng(seed), put_at((8.55, 47.4))
    lot_m, street_m = float(rng.uniform(45.0, 60.0)), float(rng.uniform(12.0, 22.0))
    document = among_blocks(0, 0.0)
    document["features"] = [
        feature("R", "roi", "Polygon", box(put, 0, 0, 3 * lot_m, 3 * lot_m)),
        feature("start", "start", "Point", put(-60, -60)),
    ]
    for name, (east, north) in enumerate(np.ndindex(3, 3)):
        if rng.random() < 0.7:
            low, high = 0.5 * street_m, lot_m - 0.5 * street_m
            corners = (east * lot_m + low, north * lot_m + low, east * lot_m + high, north * lot_m + high)
            block = feature(f"B{name}", "obstacle", "Polygon", box(put, *corners))
            block["properties"]["height_m"] = float(rng.choice([15.0, 100.0]))
            document["features"].append(block)
    document["vehicles"][0]["autopilot"] = "ardupilot"
    return document | {"altitude_m": 50.0}


@pytest.mark.parametrize("seed", [1, 4, 11])
def test_streets_without_room_for_turns_are_seen(seed: int) -> None:
    """However much sweeps leave: a fifth of each of these, which was refused."""
    scenario = read_scenario(streets(seed))
    seen_whole(scenario, 50.0)


@pytest.mark.parametrize("seed", [0, 9])
def test_the_border_of_two_regions_is_in_photos_of_either(seed: int) -> None:
    """What passes over one see of the other counts for coverage, and for photos too."""
    put = put_at((8.55, 47.4))
    document = among_blocks(seed, 0.0, 6.0)
    document["features"][:1] = [
        feature("W", "roi", "Polygon", box(put, 0, 0, 70, SIDE_M)),
        feature("E", "roi", "Polygon", box(put, 70, 0, SIDE_M, SIDE_M)),
    ]
    plan = make_plan(read_scenario(document))
    assert plan.metrics.coverage == {"W": 1.0, "E": 1.0}
    assert plan.hard_violations == ()
