"""Runs: no direction that is allowed leads to a shorter line."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planner.dubins.kernels import dubins_lengths
from planner.dubins.run_kernels import NO_DISCS, run_costs

RADIUS_M = 30.0
ALL_ROUND = np.sort([math.remainder(k * math.tau / 48.0, math.tau) for k in range(48)])


def by_runs_m(run_m: float, ways_rad: np.ndarray, goal: np.ndarray) -> np.ndarray:
    begins = np.stack([run_m * np.cos(ways_rad), run_m * np.sin(ways_rad), ways_rad], axis=1)
    return run_m + dubins_lengths(begins, np.tile(goal, (len(begins), 1)), RADIUS_M)


@settings(max_examples=200)
@given(
    st.floats(0.0, 1_500.0),
    st.floats(-math.pi, math.pi),
    st.floats(-math.pi, math.pi),
    st.sampled_from([100.0, 355.0]),
    st.sampled_from([None, 0.4, 2.9]),
)
def test_no_direction_is_better(
    away_m: float, way: float, angle: float, run_m: float, into: float | None
) -> None:
    """Of directions every half degree none is shorter by a metre, and what is said is what is flown."""
    goal = np.array([away_m * math.cos(way), away_m * math.sin(way), angle])
    runs_rad, ways_rad = ALL_ROUND, np.radians(np.arange(0.0, 360.0, 0.5))
    if into is not None:
        runs_rad = runs_rad[np.cos(runs_rad - into) >= 0.0]
        # Between the outermost directions given.
        offs_rad = [math.remainder(run_rad - into, math.tau) for run_rad in runs_rad]
        ways_rad = into + np.linspace(min(offs_rad), max(offs_rad), 360)
    costs_m, found_rad = run_costs(0.0, 0.0, run_m, runs_rad, goal[None], RADIUS_M, NO_DISCS)
    assert costs_m[0] <= by_runs_m(run_m, ways_rad, goal).min() + 1.0
    assert costs_m[0] == pytest.approx(by_runs_m(run_m, found_rad, goal)[0], abs=1e-6)
    if into is not None:
        off_rad = abs(math.remainder(float(found_rad[0]) - into, math.tau))
        assert off_rad <= math.pi / 2.0 + 1e-9


def test_a_given_direction_is_kept() -> None:
    """With one direction there is nothing to choose."""
    goal = np.array([[800.0, -300.0, 1.0]])
    costs_m, found_rad = run_costs(0.0, 0.0, 200.0, np.array([2.0]), goal, RADIUS_M, NO_DISCS)
    assert found_rad.tolist() == [2.0]
    assert costs_m[0] == pytest.approx(by_runs_m(200.0, found_rad, goal[0])[0])
