"""The judge: sound plans pass, each way of breaking one is found, and nothing of the stages is believed."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from pyproj import Geod
from shapely.geometry import Point, Polygon

from planner.airspace.values import NoFlyZone, Threat
from planner.check import footprint, judge, turn_radius_m
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.plan import Plan
from planner.scenario import Scenario
from planner.vehicle.energy import ConstantPower
from tests.planner.scenarios import planned_case, small

GEOD = Geod(ellps="WGS84")


def constraints(scenario: Scenario, plan: Plan) -> set[str]:
    return {v.constraint for v in judge(scenario, plan).violations}


def shifted(plan: Plan, index: int, north_deg: float) -> Plan:
    """The plan with one vertex of its line moved."""
    (path,) = plan.paths
    line = list(path.line)
    lon, lat, alt = line[index]
    line[index] = (lon, lat + north_deg, alt)
    return replace(plan, paths=(replace(path, line=tuple(line)),))


@pytest.mark.parametrize("number", [1, 2, 3, 4])
def test_shared_cases_are_sound(number: int) -> None:
    """Planned by `auto`, each case is seen whole, in limits, and out of every threat."""
    scenario, plan = planned_case(number)
    assert judge(scenario, plan).violations == ()
    assert all(fraction >= 0.9999 for fraction in plan.metrics.coverage.values())


@pytest.mark.parametrize("number", [1, 2, 3, 4])
def test_lengths_agree_with_geodesics(number: int) -> None:
    """Metrics, judge and pyproj's geodesics of the published line with its heights agree within 0.1 %."""
    scenario, plan = planned_case(number)
    lons, lats, altitudes_m = zip(*plan.paths[0].line, strict=True)
    geodesic_m = float(np.hypot(GEOD.line_lengths(lons, lats), np.diff(altitudes_m)).sum())
    assert plan.metrics.flight_length_m == pytest.approx(geodesic_m, rel=1e-3)
    assert judge(scenario, plan).length_m == pytest.approx(geodesic_m, rel=1e-4)


@pytest.mark.parametrize("radius_m", [50.0, 100.0, 400.0])
@pytest.mark.parametrize("edge_m", [1.0, 5.0, 9.9])
def test_turn_radius_of_an_arc_between_straights(radius_m: float, edge_m: float) -> None:
    """The radius of a sampled arc with straights before and after it is found within 0.1 %."""
    pieces = math.ceil(radius_m * 1.2 / edge_m)
    angles = np.linspace(0.0, 1.2, pieces + 1)
    arc = np.stack([radius_m * np.sin(angles), radius_m * (1.0 - np.cos(angles))], axis=1)
    out = arc[-1] + 500.0 * np.array([math.cos(1.2), math.sin(1.2)])
    found_m, _ = turn_radius_m(np.vstack([[[-800.0, 0.0]], arc, [out]]))
    assert found_m == pytest.approx(radius_m, rel=1e-3)


def test_a_kink_between_long_straights_is_a_tight_turn() -> None:
    """A corner of 10° between straights of a kilometre is not taken for a wide arc."""
    corner = np.array([[0.0, 0.0], [1000.0, 0.0], [1000.0 + 985.0, 174.0]])
    assert turn_radius_m(corner)[0] < 60.0


def test_a_tight_turn_is_found() -> None:
    """One vertex moved by four metres is a turn the aircraft cannot fly."""
    scenario, plan = planned_case(1)
    index = len(plan.paths[0].line) // 2
    assert "turn-radius" in constraints(scenario, shifted(plan, index, 4.0 / 111_000.0))


def test_leaving_the_area_is_found() -> None:
    """The same plan in a smaller area has metres outside it."""
    scenario, plan = planned_case(1)
    assert scenario.area is not None
    small_area = scenario.area.buffer(-800.0)
    assert "area" in constraints(replace(scenario, area=small_area), plan)


def test_zones_on_the_path_are_found() -> None:
    """A hard threat, a no-fly polygon and a soft threat put on the path are each named."""
    scenario, plan = planned_case(1)
    middle = plan.paths[0].line[len(plan.paths[0].line) // 2]
    east, north = scenario.frame.to_local(middle[:2])
    place = (float(east), float(north))
    box = Polygon(Point(place).buffer(30.0).exterior)
    for changed, constraint, hard in (
        (replace(scenario, threats=(Threat("X", "missile", place, 40.0, hard=True),)), "hard-zone", True),
        (replace(scenario, no_fly=(NoFlyZone("X", box),)), "hard-zone", True),
        (replace(scenario, threats=(Threat("X", "missile", place, 40.0),)), "soft-threat", False),
    ):
        found = [v for v in judge(changed, plan).violations if v.constraint == constraint]
        assert [v.feature for v in found] == ["X"]
        assert found[0].hard is hard
        assert found[0].amount > 1.0
        assert found[0].where is not None


def test_a_zone_above_the_flight_does_not_count() -> None:
    """A no-fly zone whose floor is higher than the flight is no violation."""
    scenario, plan = planned_case(1)
    middle = plan.paths[0].line[len(plan.paths[0].line) // 2]
    place = tuple(float(v) for v in scenario.frame.to_local(middle[:2]))
    zone = NoFlyZone("X", None, (place[0], place[1]), 50.0, floor_m=600.0)
    assert judge(replace(scenario, no_fly=(zone,)), plan).violations == ()


def test_a_missing_pass_leaves_a_region_uncovered() -> None:
    """Without its pass a region is unseen, and the judge says how much of it."""
    scenario, plan = planned_case(1)
    without = replace(plan, collects=tuple(c for c in plan.collects if c.roi != "R2"))
    verdict = judge(scenario, without)
    assert [v.feature for v in verdict.violations if v.constraint == "coverage"] == ["R2"]
    assert verdict.unseen["R2"].area == pytest.approx(scenario.regions[1].area.area, rel=1e-6)


def test_a_pass_beside_the_path_is_found() -> None:
    """A collect that the path does not fly is not believed."""
    scenario, plan = planned_case(1)
    first = plan.collects[0]
    moved = tuple((lon, lat + 1e-4, alt) for lon, lat, alt in first.line)
    broken = replace(plan, collects=(replace(first, line=(moved[0], moved[1])), *plan.collects[1:]))
    assert "collect-straight" in constraints(scenario, broken)


def test_arcs_are_longer_than_their_chords() -> None:
    """After many turns a collect begins metres sooner on the line than arcs tell: sound; far off is not."""
    scenario, plan = planned_case(1)

    def moved(along_m: float) -> Plan:
        later = [c for c in plan.collects if c.start_m > 5000.0]
        assert later
        return replace(
            plan,
            collects=tuple(
                replace(c, start_m=c.start_m + along_m, end_m=c.end_m + along_m) if c in later else c
                for c in plan.collects
            ),
        )

    assert "collect-straight" not in constraints(scenario, moved(4.0))
    for far_m in (100.0, 1e6):
        assert "collect-straight" in constraints(scenario, moved(far_m))


def test_limits_of_the_aircraft_are_judged() -> None:
    """Range, flight time and energy that do not suffice are each a violation."""
    scenario, plan = planned_case(1)
    poor = replace(
        scenario.aircraft[0],
        max_range_m=20_000.0,
        max_flight_time_s=900.0,
        energy_wh=50.0,
        power=ConstantPower(300.0),
    )
    found = constraints(replace(scenario, aircraft=(poor,)), plan)
    assert {"range", "flight-time", "energy"} <= found


def test_false_metrics_are_found() -> None:
    """A length that the line does not have is a violation."""
    scenario, plan = planned_case(1)
    lying = replace(plan, metrics=replace(plan.metrics, length_m=plan.metrics.length_m * 1.01))
    assert constraints(scenario, lying) == {"length"}


def test_a_path_that_does_not_begin_at_the_start_is_found() -> None:
    """The start moved by a hundred metres is missed by the path."""
    scenario, plan = planned_case(1)
    east, north = scenario.start.position
    moved = replace(scenario, start=replace(scenario.start, position=(east + 100.0, north)))
    assert "continuity" in constraints(moved, plan)


def test_footprints_of_judge_and_stages_agree() -> None:
    """The judge's footprint, drawn anew, is the published one."""
    scenario, plan = planned_case(1)
    for collect, published in zip(plan.collects, plan.footprints, strict=True):
        ours = footprint(scenario, collect)
        theirs = Polygon(scenario.frame.to_local(published.ring))
        assert ours.symmetric_difference(theirs).area < 1e-3 * ours.area


def test_left_look_is_the_mirror_of_right() -> None:
    """A left-looking sensor's footprint lies on the other side of the line at the same distance."""
    document = small()
    document["sensors"][0]["look"] = "left"
    scenario = read_scenario(document)
    plan = make_plan(scenario)
    assert plan.violations == ()
    collect = plan.collects[0]
    right = footprint(scenario, replace(collect, look="right"))
    left = footprint(scenario, collect)
    assert left.area == pytest.approx(right.area)
    assert not left.intersects(right)
