"""The judge of several flights: nearness against dense sampling, windows, batteries, visits apart."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from planner.check import judge
from planner.check.fleet import nearest
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.plan import Plan
from planner.scenario import Scenario
from planner.wishes import Separation
from tests.planner.scenarios import of_two

KEPT = Separation(100.0, 30.0)


@pytest.mark.parametrize("seed", range(40))
def test_the_nearest_is_that_of_a_dense_sampling(seed: int) -> None:
    """Broken lines with random times: as near, to a metre, as the nearest of ten thousand moments."""
    rng = np.random.default_rng(seed)
    rows = []
    for _ in range(2):
        times = 9.0 * np.arange(12) + rng.uniform(0.0, 4.0, 12)
        places = rng.uniform(-200.0, 200.0, (12, 2))
        rows.append(np.column_stack([times, places, rng.uniform(80.0, 140.0, 12)]))
    one, other = rows
    moments = np.linspace(max(one[0, 0], other[0, 0]), min(one[-1, 0], other[-1, 0]), 10_001)
    at = [np.column_stack([np.interp(moments, r[:, 0], r[:, k]) for k in (1, 2, 3)]) for r in rows]
    apart = np.hypot(*(at[0] - at[1])[:, :2].T)
    near = (np.abs(at[0][:, 2] - at[1][:, 2]) < KEPT.vertical_m) & (apart < KEPT.horizontal_m)
    found = nearest(one, other, KEPT)
    if not near.any():
        assert found is None or found[0] < 1.0
        return
    assert found is not None
    assert found[0] == pytest.approx(KEPT.horizontal_m - float(apart[near].min()), abs=1.0)


def test_flights_one_after_the_other_are_never_near() -> None:
    """Without a common moment there is nothing to be near in."""
    rows = np.array([[0.0, 0.0, 0.0, 100.0], [10.0, 100.0, 0.0, 100.0]])
    assert nearest(rows, rows + np.array([10.0, 0.0, 0.0, 0.0]), KEPT) is None


@pytest.fixture(scope="module")
def two() -> tuple[Scenario, Plan]:
    """A plan of two aircraft, one region each."""
    scenario = read_scenario(of_two())
    return scenario, make_plan(scenario)


def constraints(scenario: Scenario, plan: Plan) -> set[str]:
    return {violation.constraint for violation in judge(scenario, plan).violations}


def test_a_sound_plan_of_two_is_found_sound(two: tuple[Scenario, Plan]) -> None:
    """Two paths from one base, one behind the other, and nothing to complain of."""
    _, plan = two
    assert {path.vehicle for path in plan.paths} == {"uav", "second"}
    assert plan.violations == ()


def test_aircraft_that_take_off_together_are_told_of(two: tuple[Scenario, Plan]) -> None:
    """Both from one base at one moment."""
    scenario, plan = two
    paths = tuple(replace(path, start_s=0.0) for path in plan.paths)
    assert "separation" in constraints(scenario, replace(plan, paths=paths))


def test_times_that_the_line_does_not_keep_are_told_of(two: tuple[Scenario, Plan]) -> None:
    """A collect that says it is flown a minute sooner than its line is there."""
    scenario, plan = two
    first, *rest = plan.collects
    early = replace(first, start_s=first.start_s - 60.0, end_s=first.end_s - 60.0)
    assert "time" in constraints(scenario, replace(plan, collects=(early, *rest)))


def test_a_window_that_is_missed_is_told_of_and_sees_nothing(two: tuple[Scenario, Plan]) -> None:
    """A collect before its region's window opens."""
    scenario, plan = two
    end_s = max(collect.end_s for collect in plan.collects)
    regions = tuple(replace(r, time_window_s=(end_s + 1.0, end_s + 99.0)) for r in scenario.regions)
    found = constraints(replace(scenario, regions=regions), plan)
    assert {"window", "coverage"} <= found


def test_visits_that_are_too_near_in_time_are_one(two: tuple[Scenario, Plan]) -> None:
    """A region seen twice within the time that is to lie between is seen once."""
    scenario, plan = two
    regions = tuple(replace(r, revisits=2, revisit_after_s=600.0) for r in scenario.regions)
    asked = replace(scenario, regions=regions)
    at = {apart_s: tuple(
        replace(c, start_s=c.start_s + apart_s, end_s=c.end_s + apart_s) for c in plan.collects
    ) for apart_s in (300.0, 900.0)}  # fmt: skip
    assert "coverage" in constraints(asked, replace(plan, collects=(*plan.collects, *at[300.0])))
    assert "coverage" not in constraints(asked, replace(plan, collects=(*plan.collects, *at[900.0])))


def test_more_flights_than_batteries_are_told_of(two: tuple[Scenario, Plan]) -> None:
    """A second flight of an aircraft that has one battery, begun before the first has ended."""
    scenario, plan = two
    again = replace(plan.paths[0], sortie=2, start_s=plan.paths[0].start_s + 10.0)
    found = constraints(scenario, replace(plan, paths=(*plan.paths, again)))
    assert {"batteries", "turnaround"} <= found
