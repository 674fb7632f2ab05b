"""How near flights come to the edge of their operating area, by shapely's own distances."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import shapely
from shapely.geometry import Polygon, shape

from planner.geojson import read_scenario, write_plan
from planner.pipeline import make_plan
from tests.planner.check.test_kept import FRAME, METRE_DEG, cluttered, line_of
from tests.planner.scenarios import feature

#: Lines keep this from the edge, and chords and rounding take so much of it.
KEPT_M, SLACK_M = 2.0, 0.05


def tight(number: int) -> dict[str, Any]:
    """Two regions among hard things in an area drawn close round them, with bites out of its edge."""
    rng = np.random.default_rng([7, number])
    document = cluttered(number)
    flown = [f for f in document["features"] if f["properties"]["role"] in ("roi", "start")]
    shapes = [shape(each["geometry"]) for each in flown]
    around = shapely.union_all(shapes).convex_hull.buffer(rng.uniform(150.0, 500.0) * METRE_DEG, quad_segs=2)
    needed = shapely.union_all([each.buffer(250.0 * METRE_DEG) for each in shapes])
    for _ in range(4):
        at = around.boundary.interpolate(rng.uniform(), normalized=True)
        bite = at.buffer(rng.uniform(100.0, 900.0) * METRE_DEG, quad_segs=2)
        bitten = around.difference(bite.difference(needed))
        around = bitten if isinstance(bitten, Polygon) else around
    document["features"] = [f for f in document["features"] if f["id"] != "area"]
    document["features"].append(
        feature("area", "area", "Polygon", [shapely.get_coordinates(around).tolist()])
    )
    return document


@pytest.mark.parametrize("number", [1, 3, 5, 6, 8, 17, 18, 20])
def test_the_edge_is_kept_and_what_comes_near_it_is_told(number: int) -> None:
    """The line is inside by the lines' margin; nearer than ``clearance_m`` is a warning with how near."""
    document = tight(number)
    scenario = read_scenario(document)
    plan = write_plan(make_plan(scenario))
    (outline,) = [f["geometry"]["coordinates"][0] for f in document["features"] if f["id"] == "area"]
    area = Polygon([FRAME.transform(*place) for place in outline])
    line = line_of(plan)
    assert plan["violations"] == []
    assert area.contains(line)
    away_m = area.exterior.distance(line)
    assert away_m >= KEPT_M - SLACK_M
    told = [warning for warning in plan["warnings"] if "edge-near" in warning]
    assert bool(told) == (away_m < scenario.clearance_m - SLACK_M)
    for warning in told:
        assert warning.startswith("uav: ")
        assert float(warning.split("comes to ")[1].split(" m")[0]) == pytest.approx(away_m, abs=0.1)


def test_both_are_among_them() -> None:
    """A small clearance is kept from the edge unasked, a large one is not."""
    plans = [make_plan(read_scenario(tight(8) | {"clearance_m": kept_m})) for kept_m in (1.0, 150.0)]
    near = [any("edge-near" in warning for warning in plan.warnings) for plan in plans]
    assert near == [False, True]
