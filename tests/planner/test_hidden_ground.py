"""Plans where terrain hides ground: the judge counts none of it, another look is sought, plans show it."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from planner.airspace.terrain import Ground
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


def hidden(ground: Ground, line_m: np.ndarray, level_m: float, places: np.ndarray) -> np.ndarray:
    """Which places a straight ray from abeam of them on the line does not reach: ground stands over it."""
    along = (line_m[1] - line_m[0]) / np.hypot(*(line_m[1] - line_m[0]))
    abeam = line_m[0] + ((places - line_m[0]) @ along)[:, None] * along
    part = np.linspace(0.0, 0.995, 800)[:, None, None]
    on_rays = abeam + part * (places - abeam)
    rays_m = level_m + part[..., 0] * (ground.at(places) - level_m)
    over_m = ground.at(on_rays.reshape(-1, 2)).reshape(rays_m.shape) - rays_m
    return np.asarray(over_m.max(axis=0) > 0.5)


def test_what_rays_do_not_reach_is_never_counted() -> None:
    """Places of a region that no ray reaches are in no footprint, and the judge calls them unseen."""
    ridge = on_ridge(330.0)
    assert ridge.terrain is not None
    east, north = np.meshgrid(*(np.arange(-1200.0, 1200.0, 12.0),) * 2)
    area = next(region.area for region in ridge.regions if region.name == "A")
    inside = shapely.contains_xy(area.buffer(-5.0), east, north)
    places = np.column_stack([east[inside], north[inside]])
    cut_off = 0
    for heading_deg in (90.0, 270.0):
        document = small(terrain="t", clearance_m=10.0)
        document["features"][0]["properties"]["approach_deg"] = [heading_deg]
        plan = make_plan(read_scenario(document, {"t": raster(lambda e, n: 0.0 * e, MIDDLE)}))
        verdict = judge(ridge, plan)
        dark = np.ones(len(places), dtype=np.bool_)
        for collect in plan.collects:
            line_m = ridge.frame.to_local([place[:2] for place in collect.line])
            unlit = hidden(ridge.terrain, line_m, collect.line[0][2], places)
            seen = shapely.contains_xy(footprint(ridge, collect), places[:, 0], places[:, 1])
            assert not (seen & unlit).any()
            dark &= unlit | ~seen
        cut_off += int(dark.sum())
        if dark.any():
            unseen = shapely.contains_xy(verdict.unseen["A"].buffer(1.0), places[dark, 0], places[dark, 1])
            assert unseen.all()
            assert verdict.coverage["A"] <= 1.0 - 0.9 * dark.mean()
    assert cut_off > 20


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
