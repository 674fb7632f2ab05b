"""Plans where terrain hides ground: the judge counts none of it, another look is sought, plans show it."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from planner.check import footprint, judge
from planner.frames import LocalFrame
from planner.geojson import read_plan, read_scenario, write_plan
from planner.pipeline import make_plan
from planner.scenario import Scenario
from tests.planner.scenarios import small
from tests.planner.terrains import raster

MIDDLE = LocalFrame(0.01, 0.01)


def on_ridge(height_m: float) -> Scenario:
    """A ridge a little south of region A, flown over rather than round."""
    ridge = raster(lambda e, n: height_m * np.exp(-(((n + 1230.0) / 60.0) ** 2)), MIDDLE, posts=801)
    return read_scenario(small(terrain="t", clearance_m=10.0), {"t": ridge})


def test_a_pass_planned_blind_to_the_ridge_does_not_count_the_shadow() -> None:
    """The plan made for flat ground, flown over the ridge, leaves what the judge calls uncovered."""
    flat, ridge = on_ridge(0.0), on_ridge(330.0)
    line = None
    for angle in (0.0, 180.0):
        document = small(terrain="t", clearance_m=10.0)
        document["features"][0]["properties"]["approach_deg"] = [90.0 + angle]
        plan = make_plan(read_scenario(document, {"t": raster(lambda e, n: 0.0 * e, MIDDLE)}))
        verdict = judge(ridge, plan)
        line = (verdict, plan) if verdict.coverage["A"] < 1.0 else line
    assert line is not None
    verdict, plan = line
    assert "coverage" in {v.constraint for v in verdict.violations if v.feature == "A"}
    collect = next(c for c in plan.collects if "A" in c.regions)
    assert not footprint(ridge, collect).intersects(verdict.unseen["A"].buffer(-0.1))
    assert footprint(flat, collect).intersects(verdict.unseen["A"])


def test_another_look_is_sought() -> None:
    """The planner finds passes from which the ridge hides nothing of the regions."""
    plan = make_plan(on_ridge(330.0))
    assert plan.metrics.coverage == {"A": 1.0, "B": 1.0}
    assert plan.violations == ()


def test_footprints_carry_what_is_hidden_and_come_back_from_geojson() -> None:
    """Written footprints have their holes and hidden areas, and read back equal."""
    plan = make_plan(on_ridge(330.0))
    assert all(print_.shadow_m2 is not None for print_ in plan.footprints)
    assert any(print_.shadow_m2 + print_.layover_m2 > 0.0 for print_ in plan.footprints)
    back = read_plan(write_plan(plan))
    assert [f.holes for f in back.footprints] == [pytest.approx(f.holes) for f in plan.footprints]
    assert [f.shadow_m2 for f in back.footprints] == [
        pytest.approx(f.shadow_m2, abs=0.06) for f in plan.footprints
    ]
    for print_ in plan.footprints:
        assert shapely.Polygon(print_.ring, print_.holes).is_valid


def test_flat_plans_say_nothing_of_terrain() -> None:
    """Without terrain footprints have no hidden areas, in the value and in GeoJSON."""
    document = write_plan(make_plan(read_scenario(small())))
    prints = [f for f in document["features"] if f["properties"]["role"] == "footprint"]
    assert all("shadow_m2" not in f["properties"] for f in prints)
