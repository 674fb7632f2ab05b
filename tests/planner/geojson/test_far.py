"""A country's zones in a scenario: what is far is left out, what is near stays whole."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import numpy as np
import pytest
from shapely.geometry import Polygon, box

from planner.check.verdict import judge
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from tests.planner.scenarios import feature, small

DEGREE_M = 111_320.0


def country(seed: int, count: int, lon: float = 0.0, lat: float = 0.0) -> list[dict[str, Any]]:
    """Zones of every kind over 10° by 10°, none on the regions."""
    rng, zones = np.random.default_rng(seed), []
    for k in range(count):
        middle = rng.uniform(-5.0, 5.0, 2) + np.array([lon, lat])
        size_deg = float(rng.uniform(0.001, 0.2))
        if math.dist(middle, (lon, lat)) < size_deg + 0.06:
            continue
        angles = np.linspace(0.0, math.tau, 12, endpoint=False)
        ring = [[middle[0] + size_deg * math.cos(a), middle[1] + size_deg * math.sin(a)] for a in angles]
        if k % 3 == 0:
            place, radius_m = [float(v) for v in middle], size_deg * DEGREE_M
            zones.append(feature(f"Z{k}", "no_fly", "Point", place, radius_m=radius_m))
        else:
            zones.append(feature(f"Z{k}", "no_fly", "Polygon", [[*ring, ring[0]]]))
    return zones


def box_m(each: dict[str, Any]) -> Polygon:
    """The box round a zone in metres, longitudes at the equator's scale."""
    places = each["geometry"]["coordinates"]
    places = [places] if each["geometry"]["type"] == "Point" else places[0]
    reach_m = each["properties"].get("radius_m", 0.0)
    xs, ys = (np.array(values) * DEGREE_M for values in zip(*places, strict=True))
    return box(xs.min() - reach_m, ys.min() - reach_m, xs.max() + reach_m, ys.max() + reach_m)


@pytest.mark.parametrize("with_area", [True, False])
def test_zones_near_what_is_flown_all_stay(with_area: bool) -> None:
    """Every zone within 5 km of the area, or 50 km of what is flown without one; of the others few."""
    zones = country(3, 1500)
    document = small(*zones)
    if not with_area:
        document["features"] = [each for each in document["features"] if each["id"] != "area"]
    scenario = read_scenario(document)
    kept = {zone.name for zone in scenario.no_fly}
    flown = [each for each in document["features"] if each["properties"]["role"] != "no_fly"]
    near = box_m(flown[0]).union(box_m(flown[-1])).envelope
    for each in flown:
        near = near.union(box_m(each)).envelope
    reach_m = 4_900.0 if with_area else 49_000.0
    must = {each["id"] for each in zones if box_m(each).distance(near) < reach_m}
    may = {each["id"] for each in zones if box_m(each).distance(near) < 1.6 * reach_m}
    assert must <= kept <= may
    assert kept
    told = next(f for f in scenario.warnings if f.rule == "zones-left-out")
    assert f"{len(zones) - len(kept) - 5} more" in told.message


def test_a_zone_wider_than_a_scenario_may_be_is_cut() -> None:
    """What of it is near forbids as before; the rest is no reason to refuse."""
    wide = feature("FIR", "no_fly", "Polygon", [[[-9, 0.05], [9, 0.05], [9, 9], [-9, 9], [-9, 0.05]]])
    scenario = read_scenario(small(wide))
    zone = scenario.no_fly[0].area
    assert zone is not None
    west, south, east, north = scenario.frame.to_local([[-0.05, 0.05], [0.07, 0.07]]).ravel()
    assert zone.buffer(1.0).covers(box(west, south, east, north))
    assert zone.bounds[2] - zone.bounds[0] < 100_000.0
    assert "zones-cut" in {finding.rule for finding in scenario.warnings}


def test_what_is_left_out_counts_for_no_limit() -> None:
    """More zones than a scenario may have features, all but a few far away."""
    zones = [feature(f"Z{k}", "no_fly", "Point", [2.0 + 1e-4 * k, 1.0], radius_m=5.0) for k in range(5_100)]
    near = feature("near", "no_fly", "Point", [0.02, 0.03], radius_m=50.0)
    assert [zone.name for zone in read_scenario(small(*zones, near)).no_fly] == ["near"]


def test_across_the_antimeridian_near_zones_stay() -> None:
    """A zone on the other side of ±180° is near."""
    document = small(
        feature("near", "no_fly", "Point", [-179.96, 0.03], radius_m=300.0),
        feature("away", "no_fly", "Point", [-175.0, 0.03], radius_m=300.0),
    )
    document["features"] = [
        feature("A", "roi", "Point", [179.99, 0.0]),
        feature("start", "start", "Point", [179.98, -0.02]),
        *document["features"][4:],
    ]
    assert [zone.name for zone in read_scenario(document).no_fly] == ["near"]


def test_a_flight_beyond_where_zones_were_looked_for_is_a_violation() -> None:
    """Nobody knows what is forbidden there."""
    scenario = read_scenario(small(*country(3, 300)))
    plan = make_plan(scenario)
    assert scenario.looked_at is not None
    assert not [v for v in plan.violations if v.constraint == "zones-unknown"]
    narrow = dataclasses.replace(scenario, looked_at=Polygon([(0, 0), (10, 0), (10, 10)]))
    assert [v for v in judge(narrow, plan).violations if v.constraint == "zones-unknown" and v.hard]
