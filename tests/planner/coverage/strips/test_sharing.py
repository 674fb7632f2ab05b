"""Groups of regions that one strip holds, judged by shapely."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import shapely
from shapely import affinity

from planner.coverage.strips.segments import Neighbourhood
from planner.coverage.strips.sharing import StripSharing
from planner.errors import InfeasibleError
from planner.geojson import read_scenario
from planner.scenario import Scenario
from tests.planner.scenarios import feature, small
from tests.planner.stages import seeing, surroundings


def discs(seed: int, **properties: Any) -> Scenario:
    """Five discs of random sizes within two kilometres."""
    rng = np.random.default_rng(seed)
    document = small()
    kept = [f for f in document["features"] if f["properties"]["role"] != "roi"]
    for k in range(5):
        lon, lat = (float(x) for x in rng.uniform(-0.01, 0.01, 2))
        radius_m = float(rng.uniform(5.0, 150.0))
        kept.append(feature(f"P{k}", "roi", "Point", [lon, lat], radius_m=radius_m, **properties))
    return read_scenario(document | {"features": kept})


def sharing_of(scenario: Scenario, over: Any = None) -> StripSharing:
    around = surroundings(scenario)
    found: Any = seeing(scenario).visible(around).targets
    return StripSharing(found, over or (lambda *_: (scenario.sensors[0], scenario.height_m)), around)


def sides_m(hull: Any) -> tuple[float, float]:
    """Both sides of the narrowest rectangle round a shape."""
    best = (math.inf, math.inf)
    for angle in np.arange(0.0, 180.0, 0.5):
        west, south, east, north = affinity.rotate(hull, float(angle), origin=(0.0, 0.0)).bounds
        best = min(best, (north - south, east - west))
    return best


@pytest.mark.parametrize("seed", range(4))
def test_groups_are_what_one_strip_holds(seed: int) -> None:
    """Each group's passes see all of it; every pair near enough that a strip holds is a group."""
    scenario = discs(seed)
    sharing = sharing_of(scenario)
    groups = sharing.groups()
    assert groups
    areas = []
    for k in range(len(sharing.owners)):
        target = sharing.target(frozenset([k]))
        assert target is not None
        areas.append(target.region.area)
    for group in groups[:20]:
        wanted = shapely.union_all([areas[k] for k in group])
        target = sharing.target(group)
        assert target is not None
        side = target.sides[0]
        assert isinstance(side, Neighbourhood)
        for index in (0, len(side.angles_rad) // 2):
            assert side.collect(index, 0.5).footprint.buffer(1e-3).covers(wanted)
    swath_m = scenario.sensors[0].swath_m(scenario.height_m)
    gap_m = math.tau * surroundings(scenario).radius_m
    for k, one in enumerate(areas):
        for j, other in enumerate(areas[:k]):
            narrowest_m = min(sides_m(shapely.union_all([one, other]).convex_hull))
            if narrowest_m < swath_m - 1.0 and one.distance(other) < gap_m:
                assert frozenset((k, j)) in groups


def test_what_is_revisited_is_no_item() -> None:
    """Two visits are two passes."""
    assert sharing_of(discs(0, revisits=2)).owners == ()


def test_what_no_sensor_sees_together_is_no_group() -> None:
    """Where none is fit for the ground of both."""

    def refuse(name: str | None, area: Any) -> Any:
        raise InfeasibleError("swath", "both", "no", "none", None)

    assert sharing_of(discs(0), refuse).groups() == []
