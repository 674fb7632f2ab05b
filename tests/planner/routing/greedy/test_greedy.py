"""The paper's route from end to end."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.geometry import LineString, Point

from planner.airspace.threats import metres_inside
from planner.airspace.values import NoFlyZone, Threat
from planner.errors import CancelledError, InfeasibleError
from planner.route import CollectPass
from planner.routing.tour import order, tour_length_m
from planner.scenario import Scenario
from planner.wishes import Region
from tests.planner.coverage.shapes import box, paper_sensor, polygons, sample, unseen_m2
from tests.planner.stages import greedy, li2018_route, zigzag


def flown_m(scenario: Scenario, passes: tuple[CollectPass, ...]) -> float:
    """Length with straight transits."""
    corners = [scenario.start.position]
    for collect in passes:
        corners += [collect.start, collect.end]
    return LineString([*corners, scenario.end.position]).length


def assert_all_seen(scenario: Scenario, passes: tuple[CollectPass, ...]) -> None:
    """Each region is covered by the footprints of the passes that name it."""
    for region in scenario.regions:
        footprints = [p.footprint for p in passes if region.name in p.regions]
        assert unseen_m2(region.area, footprints) < 1e-6 * region.area.area


def assert_inside(scenario: Scenario, passes: tuple[CollectPass, ...]) -> None:
    """No pass leaves the area."""
    assert scenario.area is not None
    for collect in passes:
        assert scenario.area.covers(LineString([collect.start, collect.end]))


@pytest.mark.parametrize("threat_aware", [False, True])
@pytest.mark.parametrize("case", [1, 2, 3, 4])
def test_cases_of_the_paper(case: int, threat_aware: bool) -> None:
    """Eight passes see six regions, two each of R1 and R4, in far less than either zigzag's length."""
    scenario = sample(case)
    found = greedy(scenario, threat_aware=threat_aware)
    passes = found.route.passes
    assert len(passes) == 8
    assert sorted(p.regions[0] for p in passes) == ["R1", "R1", "R2", "R3", "R4", "R4", "R5", "R6"]
    assert found.dropped == ()
    assert_all_seen(scenario, passes)
    assert_inside(scenario, passes)
    # The paper's own figures, section 5.3.1: around 30 km, and about 8 km of collecting.
    assert flown_m(scenario, passes) < 0.9 * min(
        zigzag(scenario, d).length_m for d in ("vertical", "horizontal")
    )
    assert 7000.0 < sum(collect.length_m for collect in passes) < 8500.0
    if threat_aware:
        inside_m = sum(metres_inside(np.array([p.start, p.end]), scenario.threats) for p in passes)
        assert inside_m == 0.0


@pytest.mark.parametrize("case", [1, 2, 3, 4])
def test_visiting_order_is_the_shortest_tour(case: int) -> None:
    """The genetic algorithm's order is as long as the exact one through the centroids."""
    scenario = sample(case)
    centroids = [region.centroid for region in greedy(scenario).regions]
    ends = (scenario.start.position, scenario.end.position)
    shortest = tour_length_m(centroids, *ends, order(centroids, *ends, "exact"))
    assert tour_length_m(centroids, *ends, tuple(range(len(centroids)))) == pytest.approx(shortest)


def test_pairs_follow_each_other() -> None:
    """Both passes of a distributed region come one after the other, in opposite directions."""
    passes = li2018_route(sample(1)).passes
    for one, other in itertools.pairwise(passes):
        if one.regions == other.regions:
            turn_rad = math.remainder(other.angle_rad - one.angle_rad, 2.0 * math.pi)
            assert abs(turn_rad) == pytest.approx(math.pi)
            assert one.eta + other.eta <= 1.0 + 1e-9


def test_same_seed_same_route() -> None:
    """The same scenario and seed give the same route."""
    assert li2018_route(sample(3)) == li2018_route(sample(3))


def test_no_pass_crosses_a_hard_zone() -> None:
    """A no-fly zone on the line the free route takes moves that pass, with threats looked at or not."""
    scenario = sample(1)
    first = li2018_route(scenario).passes[0]
    line = LineString([first.start, first.end])
    zoned = replace(scenario, no_fly=(NoFlyZone("zone", None, line.centroid.coords[0], 150.0),))
    for threat_aware in (False, True):
        passes = li2018_route(zoned, threat_aware=threat_aware).passes
        zone = Point(line.centroid).buffer(150.0)
        assert not any(zone.intersects(LineString([p.start, p.end])) for p in passes)
        assert_all_seen(zoned, passes)


def test_soft_threat_is_crossed_only_where_it_must() -> None:
    """A region all of whose passes cross a soft threat is still seen; a hard one forbids it."""
    target = Region("T", box(300.0, 300.0))
    threat = Threat("M", "missile", (1000.0, -2000.0), 1500.0)
    scenario = replace(sample(1), regions=(target,), threats=(threat,))
    (collect,) = li2018_route(scenario, threat_aware=True).passes
    assert metres_inside(np.array([collect.start, collect.end]), scenario.threats) > 0.0
    hard = replace(scenario, threats=(replace(threat, hard=True),))
    with pytest.raises(InfeasibleError) as caught:
        li2018_route(hard)
    assert (caught.value.constraint, caught.value.feature) == ("hard-zone", "T")


def test_optional_regions_are_dropped_and_named() -> None:
    """What is not required and cannot be seen is left out with the reason; what is required is refused."""
    scenario = sample(1)
    big = Region("big", box(2500.0, 2500.0), required=False)
    sharp = Region("sharp", box(100.0, 100.0), required=False, min_resolution_m=0.1)
    wanted = replace(scenario, regions=(*scenario.regions, big, sharp))
    found = greedy(wanted)
    assert {(reason.feature, reason.constraint) for reason in found.dropped} == {
        ("big", "swath"),
        ("sharp", "resolution"),
    }
    assert len(found.route.passes) == 8
    for region in (big, sharp):
        with pytest.raises(InfeasibleError):
            greedy(replace(scenario, regions=(replace(region, required=True),)))


def test_merged_neighbours_share_a_pass() -> None:
    """Two blocks with a street between them are seen in one pass that names both."""
    scenario = replace(
        sample(1),
        regions=(
            Region("A", shapely.box(0.0, 0.0, 150.0, 200.0)),
            Region("B", shapely.box(180.0, 0.0, 330.0, 200.0)),
        ),
    )
    (collect,) = li2018_route(scenario).passes
    assert collect.regions == ("A", "B")
    assert_all_seen(scenario, (collect,))
    assert len(greedy(scenario, radius_m=0.0).route.passes) == 2


def test_blocks_too_many_for_one_are_seen_one_by_one() -> None:
    """Where the close filter joins more than two swaths see, the parts are seen for themselves."""
    blocks = tuple(
        Region(f"B{i}{j}", shapely.box(400.0 * i, 400.0 * j, 400.0 * i + 360.0, 400.0 * j + 360.0))
        for i in range(4)
        for j in range(4)
    )
    scenario = replace(sample(1), regions=blocks, threats=())
    found = greedy(scenario)
    assert len(found.route.passes) == 16
    assert_all_seen(scenario, found.route.passes)


def test_two_sensors() -> None:
    """Each region is seen with the sensor it names, the first where it names none."""
    wide = replace(paper_sensor("left"), name="wide", elevation_beamwidth_rad=math.radians(50.0))
    scenario = sample(1)
    regions = (scenario.regions[0], replace(scenario.regions[3], sensor="wide"))
    passes = li2018_route(replace(scenario, sensors=(*scenario.sensors, wide), regions=regions)).passes
    assert [(p.regions[0], p.sensor, p.look) for p in sorted(passes, key=lambda p: p.regions)] == [
        ("R1", "sar", "right"),
        ("R1", "sar", "right"),
        ("R4", "wide", "left"),
    ]


def test_progress_and_stop() -> None:
    """Progress never falls and ends at 1; a stop ends the search."""
    reports: list[tuple[str, float]] = []
    greedy(sample(1), lambda stage, fraction: reports.append((stage, fraction)))
    fractions = [fraction for _, fraction in reports]
    assert fractions == sorted(fractions)
    assert fractions[-1] == 1.0
    assert [stage for stage, _ in reports[:1] + reports[-1:]] == ["coverage", "routing"]
    with pytest.raises(CancelledError):
        greedy(sample(1), stop=lambda: len(reports) > 0)


@settings(max_examples=25, deadline=None)
@given(st.lists(polygons((60.0, 540.0)), min_size=1, max_size=5), st.booleans(), st.floats(0.0, 3.0))
def test_whatever_is_asked_is_seen(areas: list[shapely.Polygon], aware: bool, limit_rad: float) -> None:
    """Random regions, overlapping or apart, one of them with limits on its direction, are all seen."""
    regions = tuple(
        Region(f"R{k}", area, approach_rad=(limit_rad, limit_rad + math.pi) if k == 0 else None)
        for k, area in enumerate(areas)
    )
    scenario = replace(sample(2), regions=regions, area=shapely.box(-2e4, -2e4, 2e4, 2e4))
    passes = li2018_route(scenario, threat_aware=aware).passes
    assert_all_seen(scenario, passes)
    assert_inside(scenario, passes)
    for collect in passes:
        if "R0" in collect.regions:
            turned = math.remainder(collect.angle_rad - limit_rad, math.pi)
            assert turned == pytest.approx(0.0, abs=1e-6)
