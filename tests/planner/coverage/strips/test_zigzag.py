"""The zigzag baselines see everything, and are as long as the paper's."""

import math
from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.geometry import LineString, Polygon
from shapely.ops import substring

from planner.coverage.intervals import operating_function
from planner.coverage.strips.zigzag import Direction, Zigzag
from planner.route import Look, Terminal
from planner.scenario import Scenario
from planner.sensors.sar import SarSensor
from planner.wishes import Region
from tests.planner.coverage.shapes import paper_sensor, polygons, sample, unseen_m2
from tests.planner.stages import zigzag

#: Table 5, route lengths in metres.
PAPER_LENGTHS_M = {
    "vertical": (51085.0, 56897.0, 57060.0, 53489.0),
    "horizontal": (47319.0, 41444.0, 41943.0, 46505.0),
}


def assert_full_resolution(found: Zigzag, scenario: Scenario) -> None:
    """Judge by the flown line itself: what it sees for one aperture length, while on, holds every region."""
    sensor, height_m = scenario.sensors[0], scenario.height_m
    assert isinstance(sensor, SarSensor)
    half_m, look = sensor.aperture_m(height_m) / 2.0, "right" if "right" in sensor.looks else "left"
    line = LineString(found.waypoints)
    seen = []
    for begin_m, end_m in found.on_intervals:
        part = substring(line, begin_m + half_m, end_m - half_m)
        assert len(shapely.simplify(substring(line, begin_m, end_m), 1e-6).coords) == 2
        near = part.parallel_offset(sensor.near_m(height_m), look)
        far = part.parallel_offset(sensor.far_m(height_m), look)
        seen.append(Polygon([*near.coords, *reversed(far.coords)]))
    for region in scenario.regions:
        assert unseen_m2(region.area, seen) < 1e-6 * region.area.area


@pytest.mark.parametrize("direction", ["vertical", "horizontal"])
@pytest.mark.parametrize("case", [1, 2, 3, 4])
def test_as_in_the_paper(case: int, direction: Direction) -> None:
    """Route lengths are within a quarter of Table 5's, collection lengths within a quarter of 8 km."""
    scenario = sample(case)
    found = zigzag(scenario, direction)
    assert found.length_m == pytest.approx(PAPER_LENGTHS_M[direction][case - 1], rel=0.25)
    assert found.collection_length_m == pytest.approx(8000.0, rel=0.25)
    assert found.duty_cycle == pytest.approx(found.collection_length_m / found.length_m)
    assert 6 <= found.turns <= 9
    assert_full_resolution(found, scenario)


@settings(max_examples=40, deadline=None)
@given(
    st.lists(polygons(), min_size=1, max_size=5),
    st.sampled_from(["vertical", "horizontal"]),
    st.sampled_from(["left", "right"]),
)
def test_sees_whatever_there_is(areas: list[Polygon], direction: Direction, look: Look) -> None:
    """Any regions are seen whole at full resolution, with a sensor to either side."""
    regions = tuple(Region(f"R{k}", area) for k, area in enumerate(areas))
    scenario = replace(sample(1), regions=regions, sensors=(paper_sensor(look),))
    found = zigzag(scenario, direction)
    assert_full_resolution(found, scenario)
    assert tuple(found.waypoints[0]) == pytest.approx(scenario.start.position)
    assert tuple(found.waypoints[-1]) == pytest.approx(scenario.end.position)
    assert found.length_m == pytest.approx(LineString(found.waypoints).length)
    assert len(found.waypoints) == 2 * (found.turns + 1) + 2


def test_lanes_run_as_named() -> None:
    """Vertical lanes run north–south, horizontal ones east–west."""
    for direction, still in (("vertical", 0), ("horizontal", 1)):
        found = zigzag(sample(1), direction)
        lanes = found.waypoints[1:-1].reshape(-1, 2, 2)
        np.testing.assert_allclose(lanes[:, 0, still], lanes[:, 1, still])


def test_sweep_follows_start_and_end() -> None:
    """With start and end swapped the route is swept the other way and is no longer."""
    scenario = sample(2)
    swapped = replace(
        scenario,
        start=Terminal("start", scenario.end.position),
        end=Terminal("end", scenario.start.position),
    )
    for direction in ("vertical", "horizontal"):
        one, other = zigzag(scenario, direction), zigzag(swapped, direction)
        assert other.length_m == pytest.approx(one.length_m, rel=0.1)
        assert math.dist(one.waypoints[1], other.waypoints[1]) > 1000.0


def test_operating_function_fills_the_duty_cycle() -> None:
    """The mean of the operating function along the path is the duty cycle."""
    found = zigzag(sample(1), "vertical")
    along_m = np.linspace(0.0, found.length_m, 200001)
    working = operating_function(found.on_intervals, along_m)
    assert working.mean() == pytest.approx(found.duty_cycle, abs=1e-3)
