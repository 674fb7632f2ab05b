"""The benchmark's problems and figures hold what they claim, with and without the peer."""

from __future__ import annotations

import math

import numpy as np
import pytest

from benchmarks import kernels, transit
from benchmarks.transit import Look
from planner.dubins.kernels import dubins_lengths


@pytest.mark.parametrize("tight", [False, True])
def test_problems_are_those_of_their_seed(tight: bool) -> None:
    """A seed gives one problem: 30 discs, both ends outside them, with room for a full turn unless tight."""
    for seed in range(5):
        given, again = transit.problem(seed, tight), transit.problem(seed, tight)
        assert (given.start, given.goal) == (again.start, again.goal)
        assert np.array_equal(given.discs, again.discs)
        assert len(given.discs) == 30
        for end in (given.start, given.goal):
            gaps_m = np.hypot(*(given.discs[:, :2] - end.position).T) - given.discs[:, 2]
            assert gaps_m.min() > (0.0 if tight else transit.OPEN_M)


def test_without_the_peer_the_row_says_so() -> None:
    """With no time for OMPL ours is measured by itself, and OMPL's row names its absence."""
    rows = list(transit.run(problems=3, seconds=0.0, repeats=1, sets=("open",)))
    assert rows[0]["planner"] == "tangent"
    assert rows[0]["solved"] == 3
    assert "absent" in rows[1]
    assert len(rows) == 2


def test_against_the_peer() -> None:
    """Where OMPL is installed a line of ours is never longer than its line by more than 0.5 %."""
    pytest.importorskip("ompl")
    found = list(transit.run(problems=3, seconds=0.3, repeats=1, sets=("open",)))[-1]
    assert found["at_end_solved"] > 0
    assert found["at_end_ours_to_ompl_max"] < 1.005


def test_time_is_compared_at_equal_quality_and_quality_at_equal_time() -> None:
    """By hand: one line is there late and longer, one is as good from its third look on, one never is."""
    ours = [(100.0, 0.002), (200.0, 0.002), (300.0, 0.002)]
    looks = [
        [Look(0.001, 150.0), Look(0.0025, 130.0), Look(1.0, 102.0)],
        [Look(0.001, math.nan), Look(0.004, 260.0), Look(0.5, 201.0), Look(1.0, 199.0)],
        [Look(0.001, math.nan), Look(1.0, math.nan)],
    ]
    row = transit._compared("open", "X", ours, looks)
    assert (row["solved"], row["at_equal_time_solved"], row["at_end_solved"]) == (3, 2, 2)
    assert row["at_equal_time_ompl_to_ours_median_of_solved"] == pytest.approx(1.3)
    assert (row["equal_quality_reached"], row["equal_quality_median_s_of_reached"]) == (1, 0.5)
    assert row["equal_quality_times_ours_median_of_reached"] == pytest.approx(250.0)
    assert row["at_end_ours_to_ompl_max"] == pytest.approx(200.0 / 199.0)
    row = transit._compared("open", "X", ours[2:], looks[2:])
    assert (row["equal_quality_reached"], row["equal_quality_median_s_of_reached"]) == (0, None)


def test_numpy_lengths_are_the_kernel_s() -> None:
    """The peers of the kernel benchmark measure the same lines: numpy's, and OMPL's where installed."""
    starts, goals = kernels.pairs(20_000, seed=3)
    compiled = dubins_lengths(starts, goals, kernels.RADIUS_M)
    np.testing.assert_allclose(
        kernels.chunked_lengths(starts, goals, kernels.RADIUS_M), compiled, atol=1e-9, rtol=0
    )
    row = list(kernels.run(count=2_000, plain=200, peer=2_000, repeats=1))[-1]
    assert row["off_plain_m"] < 1e-9
    assert row.get("off_ompl_m", 0.0) < 1e-9
    assert math.isfinite(row["to_numpy"])
