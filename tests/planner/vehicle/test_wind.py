"""Times, turns and choices in a wind, against the wind triangle solved step by step."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq

from planner.airspace.values import Wind
from planner.check import judge, line_s
from planner.dubins.path import Segment
from planner.dubins.words import shortest
from planner.errors import InfeasibleError
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.plan import Collect, Plan, Transit
from planner.profile.flight import Stretch
from planner.profile.times import wing_times
from planner.route import Pose
from planner.scenario import Scenario
from planner.tasks.setting import Setting
from planner.vehicle.aircraft import Aircraft
from planner.vehicle.atmosphere import true_over_equivalent
from planner.vehicle.manners import manners_of
from planner.vehicle.wind import crab_rad, duration_s, ground_speed_m_s, still_air_costs
from tests.planner.scenarios import case, small

coordinates = st.floats(-2000.0, 2000.0)
directions = st.floats(-math.pi, math.pi)
poses = st.builds(Pose, coordinates, coordinates, directions)
airspeeds = st.floats(12.0, 40.0)
winds = st.builds(Wind, st.floats(0.0, 10.0), directions)


def stepwise_s(points: np.ndarray[Any, np.dtype[np.float64]], airspeed_m_s: float, wind: Wind) -> float:
    """Time along a polyline: for each chord the time, found as a root, that takes the airspeed in the air."""
    toward = (math.cos(wind.toward_rad), math.sin(wind.toward_rad), 0.0)[: points.shape[1]]
    drift_m_s = np.array(toward) * wind.speed_m_s
    total_s = 0.0
    for chord in np.diff(points, axis=0):
        length_m = float(np.linalg.norm(chord))
        if length_m < 1e-9:
            continue

        def too_far(time_s: float, chord: Any = chord) -> float:
            return float(np.linalg.norm(chord - drift_m_s * time_s)) - airspeed_m_s * time_s

        slowest_s = length_m / (airspeed_m_s - wind.speed_m_s)
        total_s += brentq(too_far, 0.0, 1.01 * slowest_s, xtol=1e-13)
    return total_s


@settings(deadline=None, max_examples=25)
@given(poses, poses, airspeeds, winds)
def test_duration_is_that_of_small_steps(start: Pose, goal: Pose, airspeed_m_s: float, wind: Wind) -> None:
    """A Dubins line takes as long as its chords of 2 m, flown one by one; the judge's time agrees, too."""
    line = shortest(start, goal, 150.0)
    points = line.sample(2.0, 50.0)[:, :2]
    expected_s = stepwise_s(points, airspeed_m_s, wind)
    assert duration_s(line, airspeed_m_s, wind) == pytest.approx(expected_s, rel=1e-4, abs=1e-6)
    aircraft = Aircraft("a", "fixed_wing", "ardupilot", airspeed_m_s, 100.0)
    at_sea_s = line_s(points, np.zeros(len(points)), aircraft, wind, 0.0)
    assert at_sea_s == pytest.approx(expected_s, rel=1e-9, abs=1e-9)


@settings(deadline=None, max_examples=60)
@given(
    directions, airspeeds, st.floats(0.0, 0.9999), st.floats(-0.7, 0.7), st.floats(1.0, 3_000.0),
    st.floats(-400.0, 3_000.0),
)  # fmt: skip
def test_climbs_in_any_wind_below_the_airspeed_take_a_time(
    course_rad: float, airspeed_m_s: float, share: float, slope: float, length_m: float, home_m: float
) -> None:
    """Planner and judge: that of short chords in space, through air as dense as at their heights; or none."""
    aircraft = Aircraft("a", "fixed_wing", "ardupilot", airspeed_m_s, 100.0)
    wind = Wind(share * airspeed_m_s, 0.0)
    start, end = Pose(0.0, 0.0, course_rad), length_m * np.exp(1j * course_rad)
    segment = Segment("straight", start, length_m, 0.0)
    climb = Stretch("mission", start, segment, 0.0, 0.0, slope * length_m)
    line_m, heights_m = np.array([[0.0, 0.0], [end.real, end.imag]]), np.array([0.0, slope * length_m])
    judged_s = line_s(line_m, heights_m, aircraft, wind, home_m)
    lowest_m = home_m + min(heights_m)
    if airspeed_m_s * true_over_equivalent(lowest_m) <= wind.speed_m_s:
        assert math.isinf(judged_s)
        with pytest.raises(InfeasibleError):
            wing_times([climb], aircraft, manners_of(aircraft), wind, home_m)
        return
    (time_s,) = wing_times([climb], aircraft, manners_of(aircraft), wind, home_m)
    # Closest where the air is densest: there the wind leaves least.
    parts = np.concatenate([[0.0], np.geomspace(1e-6, 1.0, 400)])
    parts = parts if slope >= 0.0 else 1.0 - parts[::-1]
    places = parts[:, None] * [end.real, end.imag, slope * length_m]
    steps_s = [
        stepwise_s(places[k : k + 2], airspeed_m_s * true_over_equivalent(home_m + z), wind)
        for k, z in enumerate(0.5 * (places[1:, 2] + places[:-1, 2]))
    ]
    assert time_s == pytest.approx(math.fsum(steps_s), rel=1e-3)
    assert judged_s == pytest.approx(time_s, rel=1e-3)


@given(directions, airspeeds, winds)
def test_wind_triangle(course_rad: float, airspeed_m_s: float, wind: Wind) -> None:
    """Air velocity on the crabbed heading and wind add up to the ground speed along the course."""
    heading_rad = course_rad + float(crab_rad(course_rad, airspeed_m_s, wind))
    velocity = airspeed_m_s * np.exp(1j * heading_rad) + wind.speed_m_s * np.exp(1j * wind.toward_rad)
    expected = float(ground_speed_m_s(course_rad, airspeed_m_s, wind)) * np.exp(1j * course_rad)
    assert abs(velocity - expected) < 1e-9


@pytest.mark.parametrize("wind_m_s", [0.0, 3.0, 9.0, 17.0])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_ground_arcs_need_no_more_than_the_bank(wind_m_s: float, side: float) -> None:
    """Flown step by step, an arc of the radius for the wind turns in the air no tighter, just so downwind."""
    still = Aircraft("a", "fixed_wing", "ardupilot", 18.0, 90.0)
    aircraft, wind = still.in_wind(wind_m_s), Wind(wind_m_s, 0.7)
    courses = np.linspace(0.0, 2.0 * math.pi, 40_001) * side
    headings = courses + crab_rad(courses, 18.0, wind)
    step_m = aircraft.ground_turn_radius_m * abs(courses[1] - courses[0])
    speeds = ground_speed_m_s(0.5 * (courses[1:] + courses[:-1]), 18.0, wind)
    air_radii_m = 18.0 * (step_m / speeds) / np.abs(np.diff(headings))
    assert air_radii_m.min() == pytest.approx(90.0, rel=1e-4)


def test_settling_takes_longer_lines_in_wind() -> None:
    """As long in time straight downwind as in still air; told of the same wind twice, no longer."""
    still = Aircraft("a", "fixed_wing", "ardupilot", 20.0, 90.0, settle_m=150.0)
    aircraft = still.in_wind(8.0)
    courses = np.linspace(0.0, 2.0 * math.pi, 721)
    fastest_m_s = float(ground_speed_m_s(courses, 20.0, Wind(8.0, 0.0)).max())
    assert aircraft.settle_m / fastest_m_s == pytest.approx(still.settle_m / 20.0)
    assert aircraft.in_wind(8.0) == aircraft


@pytest.mark.parametrize("from_deg", [0.0, 130.0])
def test_passes_in_wind_have_the_straight_flight(from_deg: float) -> None:
    """Every collect is preceded by settle_m times (V + W) / V of straight flight on its line."""
    document = case(1) | {"wind": {"speed_m_s": 8.0, "from_deg": from_deg}}
    document["vehicles"] = [document["vehicles"][0] | {"settle_m": 150.0}]
    scenario = read_scenario(document)
    plan = make_plan(scenario)
    assert not plan.hard_violations
    for collect in plan.collects:
        straight = [
            s for s in plan.paths[0].segments if s.kind == "straight" and s.start_m < collect.start_m - 0.1
        ]
        assert straight[-1].start_m <= collect.start_m - 150.0 * 28.0 / 20.0 + 0.1
        assert straight[-1].start_m + straight[-1].length_m >= collect.start_m - 0.1


def windy(speed_m_s: float, from_deg: float, **members: Any) -> Scenario:
    """The small scenario in a wind."""
    return read_scenario(small(wind={"speed_m_s": speed_m_s, "from_deg": from_deg}, **members))


@pytest.mark.parametrize(("speed_m_s", "from_deg"), [(6.0, 270.0), (12.0, 20.0)])
def test_plan_times_are_those_of_its_line(speed_m_s: float, from_deg: float) -> None:
    """Duration, energy and times of collects agree within 0.1 % with steps along the published line."""
    document = case(1) | {"wind": {"speed_m_s": speed_m_s, "from_deg": from_deg}}
    document["vehicles"] = [document["vehicles"][0] | {"cruise_power_w": 150.0}]
    scenario = read_scenario(document)
    plan = make_plan(scenario)
    assert not plan.hard_violations
    assert not any("wind-not-planned" in warning for warning in plan.warnings)
    (path,) = plan.paths
    line = np.array(path.line)
    points = scenario.frame.to_local(line[:, :2])
    line_m = np.column_stack([points, line[:, 2]])
    over_m, rises_m = np.hypot(*np.diff(points, axis=0).T), np.diff(line[:, 2])
    middles_m = 0.5 * (line[1:, 2] + line[:-1, 2])
    # Equivalent airspeed through the standard atmosphere.
    density = (1.0 - 2.25577e-5 * middles_m) ** 4.25588
    speeds = scenario.aircraft[0].airspeed_m_s / np.sqrt(density)
    steps_s = [
        stepwise_s(line_m[k : k + 2], float(speed_m_s), scenario.wind) for k, speed_m_s in enumerate(speeds)
    ]
    at_m = np.concatenate([[0.0], np.cumsum(np.hypot(over_m, rises_m))])
    at_s = np.concatenate([[0.0], np.cumsum(steps_s)])
    assert path.duration_s == plan.metrics.flight_duration_s == pytest.approx(at_s[-1], rel=1e-3)
    assert plan.metrics.energy_wh == pytest.approx(150.0 * at_s[-1] / 3600.0, rel=1e-3)
    for collect in plan.collects:
        for there_m, there_s in ((collect.start_m, collect.start_s), (collect.end_m, collect.end_s)):
            expected_s = np.interp(there_m * at_m[-1] / path.length_m, at_m, at_s)
            # Chords of turns are a little shorter than the arcs that distances count.
            assert there_s == pytest.approx(expected_s, rel=3e-3)


def time_of(plan: Plan, scenario: Scenario, wind: Wind) -> float:
    """Time the mission of a plan takes in a wind, by the judge's formula."""
    flown: list[Transit | Collect] = sorted(
        (*plan.transits, *plan.collects), key=lambda one: (one.seq, isinstance(one, Collect))
    )
    line = np.array([place for one in flown for place in one.line])
    points = scenario.frame.to_local(line[:, :2])
    return line_s(points, line[:, 2], scenario.aircraft[0], wind, 0.0)


@pytest.mark.parametrize("from_deg", [0.0, 60.0, 270.0])
def test_wind_in_the_choice_saves_time(from_deg: float) -> None:
    """With turns as wide, the line chosen for the wind takes no longer in it than one for still air."""
    scenario = windy(12.0, from_deg)
    # A steered antenna: the passes are those of still air.
    steered = tuple(replace(sensor, stabilised=True) for sensor in scenario.sensors)
    scenario = replace(scenario, sensors=steered)
    aware = make_plan(scenario)
    wide = scenario.aircraft[0].in_wind(12.0).ground_turn_radius_m
    aircraft = replace(scenario.aircraft[0], min_turn_radius_m=wide)
    blind = make_plan(replace(scenario, wind=Wind(), aircraft=(aircraft,)))
    # Take-off and landing into the wind leave it other first and last legs.
    assert aware.metrics.duration_s <= time_of(blind, scenario, scenario.wind) * 1.02


def test_wind_as_fast_as_the_aircraft_is_infeasible() -> None:
    """The refusal names the constraint, the aircraft and what would help."""
    with pytest.raises(InfeasibleError) as caught:
        make_plan(windy(20.0, 90.0))
    assert (caught.value.constraint, caught.value.feature) == ("wind", "uav")
    assert "20" in caught.value.message


def test_still_air_changes_nothing() -> None:
    """Without wind the aircraft, the sensors, the lengths and the times are what they were."""
    scenario = read_scenario(small())
    setting = Setting.of(scenario)
    assert setting.model.aircraft == scenario.aircraft[0]
    assert setting.suite.sensors == scenario.sensors
    lengths_m = np.array([[120.0]])
    places = np.zeros((1, 1, 3))
    assert still_air_costs(lengths_m, places, places + 100.0, 20.0, Wind()) is lengths_m
    line = shortest(Pose(0.0, 0.0, 0.0), Pose(900.0, 100.0, 1.0), 100.0)
    assert duration_s(line, 20.0, Wind()) == line.length_m / 20.0


def test_judge_minds_the_wind() -> None:
    """A plan made for still air turns too tightly for the wind, and takes another time."""
    still = read_scenario(small())
    plan = make_plan(still)
    verdict = judge(replace(still, wind=Wind(8.0, 0.0)), plan)
    assert {"turn-radius", "duration"} <= {violation.constraint for violation in verdict.violations}


def test_straights_count_by_their_course() -> None:
    """A kilometre against the wind costs what a slower aircraft would take; downwind it costs less."""
    begins, ends = np.array([[[0.0, 0.0]]]), np.array([[[1000.0, 0.0]], [[-1000.0, 0.0]]])
    costs = still_air_costs(np.full((2, 1), 1000.0), begins, ends, 20.0, Wind(5.0, 0.0))
    np.testing.assert_allclose(costs[:, 0], [1000.0 * 20.0 / 25.0, 1000.0 * 20.0 / 15.0])


def across_and_along(from_deg: float, objective: dict[str, float]) -> tuple[Scenario, Plan]:
    """A long region of several lanes, turns cheap beside them, and a steered antenna."""
    document = small(wind={"speed_m_s": 12.0, "from_deg": from_deg}, objective=objective)
    document["vehicles"][0].update(airspeed_m_s=20.0, min_turn_radius_m=30.0)
    document["sensors"][0].update(stabilised=True)
    # As wide as it is long: in still air either way is as good.
    corners = [[0.0, 0.0], [0.02, 0.0], [0.02, 0.02], [0.0, 0.02], [0.0, 0.0]]
    document["features"][0]["geometry"]["coordinates"] = [corners]
    scenario = read_scenario(document)
    return scenario, make_plan(scenario)


@pytest.mark.parametrize("from_deg", [0.0, 90.0])
def test_lanes_lie_the_way_that_takes_less_time(from_deg: float) -> None:
    """The heading chosen takes no more time than either of two at right angles, forced; the wind decides."""
    scenario, free = across_and_along(from_deg, {})
    region = scenario.regions[0]
    times = {}
    for forced_deg in (0.0, 90.0):
        allowed = tuple(math.radians(forced_deg + back) for back in (0.0, 180.0))
        limited = replace(region, approach_rad=allowed)
        plan = make_plan(replace(scenario, regions=(limited, *scenario.regions[1:])))
        assert not plan.hard_violations
        times[forced_deg] = plan.metrics.duration_s
    assert not free.hard_violations
    assert free.metrics.duration_s <= min(times.values()) * 1.005
    assert abs(times[0.0] - times[90.0]) > 10.0


@pytest.mark.parametrize("objective", [{"length": 1.0}, {"length": 0.0, "energy": 1.0}])
def test_by_length_or_by_energy_it_is_time_that_counts(objective: dict[str, float]) -> None:
    """Either objective gives the quicker plan in a wind: metres count through the air."""
    scenario, windy_plan = across_and_along(30.0, objective)
    still = replace(scenario, wind=Wind(), aircraft=(replace(scenario.aircraft[0], min_turn_radius_m=76.8),))
    blind = make_plan(still)
    assert windy_plan.metrics.duration_s <= time_of(blind, scenario, scenario.wind) * 1.001
