"""Regions as stops of a tour: divided where that saves, visited again from other directions."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.geometry import LineString, Point, Polygon, box
from shapely.ops import unary_union

from planner.check import judge, seen_times
from planner.coverage.lines import roomy
from planner.coverage.merge import split_region
from planner.coverage.strips.alternatives import of_visit
from planner.coverage.strips.headings import grid
from planner.coverage.strips.options import collect_passes, make_options
from planner.coverage.strips.sweeps import Side, sweeps
from planner.coverage.strips.targets import MOST_ROOMY, StripTarget, targets
from planner.dubins.estimate_kernels import transit_costs
from planner.errors import InfeasibleError
from planner.geojson import read_scenario
from planner.orders_kernels import best_orders
from planner.pipeline import make_plan
from planner.route import CollectPass
from planner.wishes import Region
from tests.planner.coverage.shapes import HEIGHT_M, paper_sensor, unseen_m2
from tests.planner.coverage.strips.test_sweeps import open_ground, stars
from tests.planner.coverage.test_decompose import L_SHAPE
from tests.planner.scenarios import feature, small, square
from tests.planner.stages import joint_route

SENSOR = paper_sensor()
ETAS = np.array([0.0, 0.5, 1.0])
STEP_RAD = math.radians(30.0)


def stops(area: Polygon, radius_m: float = 100.0, **known: object) -> tuple[StripTarget, ...]:
    (region,) = split_region(Region("R", area, **known))
    return targets(region, SENSOR, HEIGHT_M, open_ground(radius_m))


def cheapest_passes(
    stop: StripTarget, radius_m: float = 100.0, step_deg: float = 10.0
) -> tuple[CollectPass, ...]:
    angles = np.arange(-180.0, 180.0, step_deg) * math.pi / 180.0
    if stop.region.approach_rad is not None:
        angles = np.asarray(stop.region.approach_rad)
    options = make_options(stop.sides, angles, ETAS, open_ground(radius_m))
    assert options is not None
    return collect_passes(stop.sides, options, int(np.argmin(options.inner_m)))


def tour_m(found: tuple[StripTarget, ...], radius_m: float) -> float:
    """The shortest open tour through the stops, exact."""
    angles = np.arange(-180.0, 180.0, 15.0) * math.pi / 180.0
    around = open_ground(radius_m)
    options = [make_options(stop.sides, angles, ETAS, around) for stop in found]
    entries = np.concatenate([o.entries for o in options if o is not None])
    exits = np.concatenate([o.exits for o in options if o is not None])
    inner_m = np.concatenate([o.inner_m for o in options if o is not None])
    offsets = np.cumsum([0, *(len(o.inner_m) for o in options if o is not None)])
    between = transit_costs(exits, entries, radius_m, around.discs) + inner_m
    costs, _ = best_orders(inner_m, between, np.zeros(len(inner_m)), offsets.astype(np.int64))
    return float(costs.min())


@given(area=stars(), radius_m=st.floats(40.0, 500.0))
@settings(deadline=None, max_examples=15)
def test_all_parts_together_see_the_region(area: Polygon, radius_m: float) -> None:
    """Whatever the division, the footprints of its parts hold the region, and keep its name."""
    found = stops(area, radius_m)
    # Fine enough for parts that but few headings see whole.
    passes = [p for stop in found for p in cheapest_passes(stop, radius_m, step_deg=0.5)]
    assert unseen_m2(area, [p.footprint.buffer(1e-6) for p in passes]) < 1e-2
    assert {p.regions for p in passes} == {("R",)}


def test_an_l_is_shorter_in_two_parts() -> None:
    """An L with long thin arms is divided, and flown shorter than whole."""
    arms = Polygon([(0, 0), (7000, 0), (7000, 550), (550, 550), (550, 6000), (0, 6000)])
    found = stops(arms)
    assert len(found) == 2
    (region,) = split_region(Region("R", arms))
    whole = targets(region, SENSOR, HEIGHT_M, open_ground(), wide=True)
    undivided = min(
        float(options.inner_m.min())
        for options in [
            make_options(
                _families(arms), np.arange(-180.0, 180.0, 10.0) * math.pi / 180.0, ETAS, open_ground()
            )
        ]
        if options is not None
    )
    assert tour_m(whole, 100.0) < 0.9 * undivided


def _families(area: Polygon) -> tuple[Side, ...]:
    (region,) = split_region(Region("R", area))
    return sweeps(region, SENSOR, HEIGHT_M)


def test_what_one_pass_sees_is_not_divided() -> None:
    """A small L inside one swath stays whole."""
    small_l = Polygon(np.asarray(L_SHAPE.exterior.coords) / 6.0)
    assert len(stops(small_l)) == 1


def test_a_corridor_with_a_bend_is_flown_along_its_legs() -> None:
    """Two legs at a right angle are two passes, along each leg but for what still sees it whole."""
    axis = LineString([(0, 0), (4000, 0), (4000, 3500)])
    area = axis.buffer(150.0, cap_style="flat")
    assert isinstance(area, Polygon)
    found = stops(area, axis=axis)
    passes = [cheapest_passes(stop) for stop in found]
    assert [len(p) for p in passes] == [1, 1]
    headings = [abs(math.sin(p[0].angle_rad)) for p in passes]
    assert headings[0] < 0.2
    assert headings[1] > 0.98
    assert unseen_m2(area, [p.footprint.buffer(1e-6) for (p,) in passes]) < 1e-2


def test_visits_are_stops_of_their_own_from_their_own_directions() -> None:
    """Headings of two visits are never the same; with one heading allowed the lines differ."""
    box = Polygon([(0, 0), (400, 0), (400, 200), (0, 200)])
    for known in ({}, {"approach_rad": (0.0, 1.0)}):
        found = stops(box, revisits=2, **known)
        assert len(found) == 2
        angles = np.arange(0.0, 2.0 * math.pi, 0.1) if not known else np.array([0.0, 1.0])
        mine, yours = (of_visit(stop.region, angles, ETAS)[0] for stop in found)
        assert not set(mine) & set(yours)
        assert len(mine)
        assert len(yours)
    found = stops(box, revisits=2, approach_rad=(0.5,))
    first, second = (of_visit(stop.region, np.array([0.5]), np.linspace(0, 1, 9))[1] for stop in found)
    assert not set(first) & set(second)
    assert len(first)
    assert len(second)


@pytest.mark.parametrize("radius_m", [80.0, 300.0])
def test_revisits_are_flown_and_counted(radius_m: float) -> None:
    """A plan sees the region as often as asked, never twice running along one line the same way."""
    document = small(
        feature("P", "roi", "Point", [0.02, 0.02], revisits=3),
        vehicles=[{"name": "uav", "airspeed_m_s": 20.0, "min_turn_radius_m": radius_m}],
    )
    document["features"][0]["properties"]["revisits"] = 2
    scenario = read_scenario(document)
    plan = make_plan(scenario)
    assert plan.violations == ()
    assert plan.metrics.coverage == {"A": 1.0, "B": 1.0, "P": 1.0}
    assert [sum(c.roi == name for c in plan.collects) for name in "ABP"] == [2, 1, 3]
    for a, b in itertools.pairwise(plan.collects):
        assert a.roi != b.roi or abs(math.remainder(a.heading_deg - b.heading_deg, 360.0)) > 5.0


def test_the_judge_counts_visits() -> None:
    """Ground held by k footprints is what shapely's pairwise intersections say."""
    discs = [Point(x, 0.0).buffer(1.0) for x in (0.0, 0.5, 1.0, 5.0)]
    for times in (1, 2, 3):
        expected = unary_union(
            [
                unary_union([]) if not group else _common(group)
                for group in itertools.combinations(discs, times)
            ]
        )
        assert seen_times(discs, times).symmetric_difference(expected).area < 1e-4
    assert seen_times(discs, 4).area == 0.0


def _common(group: tuple) -> Polygon:
    shared = group[0]
    for other in group[1:]:
        shared = shared.intersection(other)
    return shared


def test_a_plan_with_a_visit_missing_is_found_out() -> None:
    """The judge calls one visit to a region that asks for two a violation of coverage."""
    scenario = read_scenario(small())
    plan = make_plan(scenario)
    document = small()
    document["features"][0]["properties"]["revisits"] = 2
    found = judge(read_scenario(document), plan)
    assert [v.feature for v in found.violations if v.constraint == "coverage"] == ["A"]


def test_the_papers_coverage_knows_two_passes_at_most() -> None:
    """By name li2018 refuses what takes three swaths, in the joint choice too; auto flies it."""
    wide = feature("X", "roi", "Polygon", square(0.01, -0.04, 0.02))
    scenario = read_scenario(small(wide, method={"coverage": "li2018", "routing": "joint"}))
    with pytest.raises(InfeasibleError, match="X"):
        joint_route(scenario)
    plan = make_plan(read_scenario(small(wide)))
    assert plan.violations == ()
    assert sum(c.roi == "X" for c in plan.collects) >= 4


@pytest.mark.parametrize("squint", [-0.3, 0.25])
def test_sweeps_see_the_whole_region_with_squint(squint: float) -> None:
    """Lanes of a squinted sensor, seen ahead of or behind the aircraft, hold all of a wide region."""
    area = Polygon([(0, 0), (2600, 300), (2400, 1900), (-300, 1500)])
    (region,) = split_region(Region("R", area))
    found = targets(region, replace(SENSOR, squint_rad=squint), HEIGHT_M, open_ground())
    passes = [p for stop in found for p in cheapest_passes(stop)]
    assert len(passes) > 2
    assert unseen_m2(area, [p.footprint.buffer(1e-6) for p in passes]) < 1e-2


def test_a_spot_is_not_swept() -> None:
    """In spotlight what is longer than the spot is refused, not covered by lanes."""
    spot = replace(SENSOR, mode="spotlight", turned_rad=0.2)
    (region,) = split_region(Region("R", Polygon([(0, 0), (3000, 0), (3000, 2000), (0, 2000)])))
    with pytest.raises(InfeasibleError):
        targets(region, spot, HEIGHT_M, open_ground())


def test_where_few_headings_have_room_they_are_looked_for() -> None:
    """Where no pass of a coarse grid has room to turn, those with room between its headings are taken."""
    (region,) = split_region(Region("R", box(-100.0, -100.0, 100.0, 100.0)))
    around = replace(open_ground(), radius_m=100.0)
    (found,) = targets(region, SENSOR, HEIGHT_M, around)
    every = found.coarse(STEP_RAD, np.array([0.0, 1.0]))
    # Posts at the ends of all coarse passes: wide enough that no full turn fits there.
    ends = np.concatenate([every.entries[:, :2], every.exits[:, :2]])
    posts = shapely.union_all([Point(*end).buffer(1.0) for end in ends])
    cramped = replace(around, cramped=posts.buffer(around.radius_m))
    coarse = make_options(found.sides, grid(region.area, STEP_RAD), np.array([0.0, 1.0]), cramped)
    assert coarse is not None
    assert not (roomy(coarse.entries, cramped) & roomy(coarse.exits, cramped)).any()
    finer = replace(found, around=cramped).coarse(STEP_RAD, np.array([0.0, 1.0]))
    assert (roomy(finer.entries, cramped) & roomy(finer.exits, cramped)).all()
    assert 0 < len(finer.inner_m) <= 2 * MOST_ROOMY


def test_footprints_that_overlap_and_touch_count_by_their_area() -> None:
    """Two footprints that share ground and, elsewhere, an edge, and a third: only what has area is seen."""
    one = box(0.0, 0.0, 10.0, 10.0)
    other = unary_union([box(5.0, 8.0, 20.0, 10.0), box(10.0, 0.0, 20.0, 8.0)])
    assert one.intersection(other).geom_type == "GeometryCollection"
    third = box(0.0, 0.0, 20.0, 20.0)
    assert seen_times([one, other, third], 3).area == pytest.approx(10.0)
    assert seen_times([one, other], 2).area == pytest.approx(10.0)
