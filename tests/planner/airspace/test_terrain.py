"""Ground heights: interpolation, bounds, high ground, scenarios set on terrain, the judge's clearance."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import RegularGridInterpolator

from planner.airspace.airspace import Level
from planner.airspace.built import bare_ground
from planner.airspace.shapes import banded_shapes
from planner.airspace.terrain import Terrain, local_ground
from planner.check import judge
from planner.errors import ScenarioError
from planner.frames import LocalFrame
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from tests.planner.scenarios import feature, small
from tests.planner.terrains import grid, raster

FRAME = LocalFrame(0.0, 0.0)
MIDDLE = LocalFrame(0.01, 0.01)


def hill(height_m: float, east_m: float, north_m: float, radius_m: float):
    """A Gaussian hill."""
    return lambda e, n: height_m * np.exp(-((e - east_m) ** 2 + (n - north_m) ** 2) / (2.0 * radius_m**2))


@given(st.floats(-2900, 2900), st.floats(-2900, 2900))
def test_between_posts_the_surface_is_bilinear(east_m: float, north_m: float) -> None:
    """Heights agree with scipy's interpolator of the same posts."""
    ground = grid(lambda e, n: 50.0 * np.sin(e / 300.0) + 0.1 * n, step_m=100.0)
    axis = -3000.0 + 100.0 * np.arange(61)
    twin = RegularGridInterpolator((axis, axis), ground.heights_m)
    assert float(ground.at((east_m, north_m))) == pytest.approx(float(twin((north_m, east_m))), abs=1e-9)


def test_no_height_beside_a_missing_post_or_off_the_grid() -> None:
    """A gap in the raster spreads to the cells it touches, no further."""
    ground = grid(lambda e, n: 0.0 * e)
    ground.heights_m[300, 300] = np.nan
    assert np.isnan(ground.at([(5.0, 5.0), (-5.0, 5.0), (4000.0, 0.0)])).all()
    assert float(ground.at((15.0, 5.0))) == 0.0


def test_a_raster_gives_its_own_posts_and_their_means() -> None:
    """Positions of posts, rotated affines included, give the posts; midpoints their mean."""
    heights = np.arange(12, dtype=np.float32).reshape(3, 4)
    for affine in ((0.01, 0.0, 7.0, 0.0, -0.01, 50.0), (0.008, 0.006, 7.0, 0.006, -0.008, 50.0)):
        a, b, c, d, e, f = affine
        terrain = Terrain("x", heights, affine)
        for i, j in np.ndindex(3, 4):
            place = (a * j + b * i + c, d * j + e * i + f)
            assert float(terrain.heights_at(place)) == pytest.approx(heights[i, j], abs=1e-6)
        half = (a * 0.5 + b * 0.5 + c, d * 0.5 + e * 0.5 + f)
        assert float(terrain.heights_at(half)) == pytest.approx(2.5, abs=1e-6)


def test_nodata_is_no_height() -> None:
    """A post with the nodata value gives NaN, not a deep hole."""
    heights = np.full((5, 5), 100.0, dtype=np.float32)
    heights[1, 1] = -32768.0
    terrain = Terrain("x", heights, (0.01, 0, 0, 0, -0.01, 0), -32768.0)
    assert math.isnan(float(terrain.heights_at((0.01, -0.005))))
    assert float(terrain.heights_at((0.03, -0.03))) == 100.0


def test_the_local_grid_keeps_the_surface() -> None:
    """Resampling a smooth hill to metres moves no height by more than its curvature allows."""
    surface = hill(300.0, 500.0, -800.0, 700.0)
    terrain = raster(surface, FRAME)
    ground = local_ground(terrain, FRAME, (-4000.0, -4000.0, 4000.0, 4000.0))
    rng = np.random.default_rng(1)
    places = rng.uniform(-3900.0, 3900.0, (500, 2))
    # Two bilinear steps: each errs by h²/8 times the second derivatives of either axis.
    bound_m = 2.0 * 2.0 * ground.step_m**2 / 8.0 * 300.0 / 700.0**2
    assert np.abs(ground.at(places) - surface(*places.T)).max() < bound_m + 0.01


@given(st.integers(0, 2**32 - 1))
def test_the_range_over_an_area_bounds_every_place_in_it(seed: int) -> None:
    """No place inside an area lies lower or higher than its range says."""
    rng = np.random.default_rng(seed)
    ground = grid(lambda e, n: rng.uniform(0.0, 100.0, e.shape), half_m=500.0, step_m=50.0)
    area = shapely.Point(rng.uniform(-200, 200, 2)).buffer(rng.uniform(10, 150))
    low_m, high_m = ground.range_over(area)
    places = rng.uniform(-400, 400, (400, 2))
    places = places[shapely.contains_xy(area, places)]
    if len(places):
        heights = ground.at(places)
        assert low_m - 1e-9 <= heights.min()
        assert heights.max() <= high_m + 1e-9


def test_high_ground_is_inside_its_polygons_and_low_far_ground_outside() -> None:
    """Every place above the height is in a polygon; two cells away from it none is."""
    ground = grid(hill(200.0, 0.0, 0.0, 500.0), step_m=50.0)
    high = shapely.union_all(ground.above(100.0, shapely.box(-2500, -2500, 2500, 2500)))
    rng = np.random.default_rng(2)
    places = rng.uniform(-2400.0, 2400.0, (4000, 2))
    inside = shapely.contains_xy(high, places)
    assert inside[ground.at(places) > 100.0].all()
    radius_m = 500.0 * math.sqrt(2.0 * math.log(2.0))
    assert not inside[np.hypot(*places.T) > radius_m + 4.0 * ground.step_m].any()


def test_a_scenario_on_terrain_flies_level_over_the_highest_region() -> None:
    """The level is altitude_m over the regions' highest ground, home is the raster's, and findings say so."""
    terrain = raster(lambda e, n: 200.0 + 0.02 * e, MIDDLE)
    scenario = read_scenario(small(terrain="t"), {"t": terrain})
    tops = [scenario.terrain.range_over(r.area)[1] for r in scenario.regions]
    assert scenario.altitude_reference == "amsl"
    assert scenario.altitude_m == pytest.approx(500.0 + max(tops))
    east_m = MIDDLE.to_local(scenario.frame.to_wgs84(scenario.start.position))[0]
    assert scenario.home_amsl_m == pytest.approx(200.0 + 0.02 * east_m, abs=1.0)
    assert "terrain-level" in {finding.rule for finding in scenario.warnings}
    assert scenario.clearance_m == 30.0
    assert read_scenario(small(terrain="t", clearance_m=0.0), {"t": terrain}).clearance_m == 0.0


def test_other_references_keep_their_meaning() -> None:
    """Over home the level counts from the raster's home, over the sea from the sea."""
    terrain = raster(lambda e, n: 200.0 + 0.0 * e, MIDDLE)
    by_home = read_scenario(small(terrain="t", altitude_reference="home"), lambda name: terrain)
    by_sea = read_scenario(small(terrain="t", altitude_reference="amsl"), lambda name: terrain)
    assert by_home.altitude_m == pytest.approx(700.0)
    assert by_sea.altitude_m == 500.0
    assert by_sea.height_m == pytest.approx(300.0)


@pytest.mark.parametrize(
    ("members", "surface", "rule"),
    [
        ({"terrain": "nowhere"}, lambda e, n: 0.0 * e, "unknown-terrain"),
        ({"terrain": 7}, lambda e, n: 0.0 * e, "bad-value"),
        ({"terrain": "t"}, lambda e, n: np.where(e > 0, np.nan, 100.0), "terrain-gap"),
        (
            {"terrain": "t", "altitude_reference": "amsl"},
            lambda e, n: 600.0 + 0.0 * e,
            "altitude-below-ground",
        ),
    ],
)
def test_refusals(members: dict, surface, rule: str) -> None:
    """Unknown rasters, gaps under a region and flights under ground are refused by name."""
    with pytest.raises(ScenarioError) as caught:
        read_scenario(small(**members), {"t": raster(surface, MIDDLE)})
    assert rule in {finding.rule for finding in caught.value.findings}


def test_without_the_member_nothing_changes() -> None:
    """A scenario without terrain reads as before, whatever rasters there are."""
    plain = read_scenario(small())
    assert plain == read_scenario(small(), {"t": raster(lambda e, n: 0.0 * e, MIDDLE)})
    assert plain.terrain is None


def test_heights_over_ground_become_heights_over_home() -> None:
    """A threat and an obstacle on a hill reach as much higher as their ground is."""
    terrain = raster(lambda e, n: np.where(n > 1500.0, 300.0, 100.0), MIDDLE)
    threat = feature("T", "threat", "Point", [0.03, 0.035], model="missile", radius_m=300.0, height_m=400.0)
    scenario = read_scenario(small(threat, terrain="t"), {"t": terrain})
    assert scenario.threats[0].height_m == pytest.approx(600.0)


@pytest.mark.parametrize("ground_m", [300.0, 100.0, 20.0])
@pytest.mark.parametrize("base_m", [0.0, 150.0])
def test_what_stands_on_a_hill_or_in_a_hollow_takes_its_ground_as_on_a_plain(
    ground_m: float, base_m: float
) -> None:
    """A mast's top is as much higher as its ground; whether ground is seen below it asks for its own base."""
    terrain = raster(lambda e, n: np.where(n > 1500.0, ground_m, 100.0), MIDDLE)
    ring = [[0.028, 0.035], [0.032, 0.035], [0.032, 0.039], [0.028, 0.039], [0.028, 0.035]]
    mast = feature("M", "obstacle", "Polygon", [ring], height_m=450.0 - base_m, base_m=base_m)
    scenario = read_scenario(small(mast, terrain="t", clearance_m=10.0), {"t": terrain})
    shape = next(one for one in banded_shapes(scenario.airspace, 100.0) if one.shape.name == "M")
    assert shape.high_m == pytest.approx(450.0 + ground_m - 100.0)
    area = scenario.obstacles[0].area
    level = Level(350.0, 450.0)
    round_it = area.buffer(100.0)
    seen = bare_ground(round_it, scenario.airspace, level)
    assert seen.equals(round_it) == (base_m > 0.0)


def test_a_plan_goes_round_ground_that_is_too_high() -> None:
    """A peak between the regions is flown round, and the judge finds the clearance kept."""
    surface = hill(900.0, 550.0, -400.0, 250.0)
    scenario = read_scenario(small(terrain="t"), {"t": raster(surface, MIDDLE)})
    assert any(zone.name.startswith("terrain-") for zone in scenario.no_fly)
    plan = make_plan(scenario)
    assert not [v for v in plan.violations if v.constraint == "terrain-clearance"]
    line_m = scenario.frame.to_local([p[:2] for p in plan.paths[0].line])
    ground_m = scenario.terrain.at(line_m)
    altitudes_m = np.array([p[2] for p in plan.paths[0].line])
    level = altitudes_m > scenario.altitude_m - 1e-3
    assert (altitudes_m - ground_m)[level].min() >= 30.0
    assert (altitudes_m - ground_m).min() > -0.05
    assert {altitude_m for c in plan.collects for *_, altitude_m in c.line} == {scenario.altitude_m}


def test_the_judge_measures_clearance_on_the_line() -> None:
    """A ridge under a straight line, between its vertices, is found and measured."""
    flat = read_scenario(small(terrain="t"), {"t": raster(lambda e, n: 0.0 * e, MIDDLE)})
    plan = make_plan(flat)
    heights = flat.terrain.heights_m.copy()
    collect = plan.collects[0]
    first, last = flat.frame.to_local([p[:2] for p in collect.line])
    middle = (first + last) / 2.0
    ground = flat.terrain
    i = round((middle[1] - ground.south_m) / ground.step_m)
    j = round((middle[0] - ground.west_m) / ground.step_m)
    heights[i - 1 : i + 2, j - 1 : j + 2] = 490.0
    hilly = replace(flat, terrain=replace(ground, heights_m=heights))
    found = [v for v in judge(hilly, plan).violations if v.constraint == "terrain-clearance"]
    assert len(found) == 1
    assert found[0].hard
    assert found[0].amount == pytest.approx(20.0, abs=0.1)
    heights[:, :] = np.nan
    unknown = [v for v in judge(hilly, plan).violations if v.constraint == "terrain-clearance"]
    assert "no heights" in unknown[0].message


@pytest.mark.parametrize("middle", [(180.0, 10.0), (-180.0, 10.0), (40.0, 89.0)], ids=str)
def test_a_raster_across_the_antimeridian_or_near_a_pole(middle: tuple[float, float]) -> None:
    """Heights are those of the place, whichever side of ±180° its longitude is counted from."""
    frame = LocalFrame(*middle)
    terrain = raster(lambda e, n: 200.0 + 0.02 * e + 0.01 * n, frame, half_deg=0.1)
    half_m = 0.08 * 111_000.0 * math.cos(math.radians(middle[1]))
    ground = local_ground(terrain, frame, (-half_m, -half_m, half_m, half_m))
    for share in (-0.9, -0.01, 0.01, 0.9):
        place_m = np.array([share * half_m, -share * half_m])
        wanted_m = 200.0 + 0.02 * place_m[0] + 0.01 * place_m[1]
        assert float(ground.at(place_m)) == pytest.approx(wanted_m, abs=0.5)
        lon, lat = frame.to_wgs84(place_m)
        for turn_deg in (-360.0, 0.0, 360.0):
            assert float(terrain.heights_at([lon + turn_deg, lat])) == pytest.approx(wanted_m, abs=0.5)
