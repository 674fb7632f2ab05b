"""The benchmark's problems and figures hold what they claim, with and without the peer."""

from __future__ import annotations

import math

import numpy as np
import pytest

from benchmarks import kernels, transit
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
    ratios = list(transit.run(problems=3, seconds=0.3, repeats=1, sets=("open",)))[-1]
    assert ratios["both_solved"] > 0
    assert ratios["length_ratio_max"] < 1.005


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
