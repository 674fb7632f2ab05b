"""Compiled Dubins lengths against the plain twin."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import example, given, settings

from planner.dubins.kernels import dubins_length, dubins_lengths, dubins_matrix
from planner.dubins.words import shortest
from planner.route import Pose
from tests.planner.dubins.test_words import awkward, poses, radii


@settings(deadline=None)
@given(poses | awkward, poses | awkward, radii)
@example(Pose(0.0, 0.0, 0.0), Pose(0.0, 0.0, 0.0), 100.0)
@example(Pose(0.0, 0.0, 0.0), Pose(0.0, 400.0, math.pi), 100.0)
@example(Pose(0.0, 0.0, 0.0), Pose(1e-12, 0.0, 2.0 * math.pi), 100.0)
def test_length_is_the_plain_one(start: Pose, goal: Pose, radius_m: float) -> None:
    """Scalar, pairwise and matrix kernels agree with words.py within 1e-9 m, degenerate cases included."""
    plain_m = shortest(start, goal, radius_m).length_m
    e0, n0, angle0 = start.east_m, start.north_m, start.angle_rad
    e1, n1, angle1 = goal.east_m, goal.north_m, goal.angle_rad
    a, b = np.array([[e0, n0, angle0]]), np.array([[e1, n1, angle1]])
    tolerance = pytest.approx(plain_m, abs=1e-9 * max(1.0, radius_m / 100.0))
    assert dubins_length(e0, n0, angle0, e1, n1, angle1, radius_m) == tolerance
    assert dubins_lengths(a, b, radius_m)[0] == tolerance
    assert dubins_matrix(a, b, radius_m)[0, 0] == tolerance


def test_matrix_is_every_pair() -> None:
    """The matrix holds the length of each pair, rows starting and columns ending."""
    generator = np.random.default_rng(1)
    starts = generator.uniform(-500.0, 500.0, (7, 3))
    goals = generator.uniform(-500.0, 500.0, (5, 3))
    matrix = dubins_matrix(starts, goals, 60.0)
    assert matrix.shape == (7, 5)
    for i, row in enumerate(starts):
        np.testing.assert_allclose(matrix[i], dubins_lengths(np.tile(row, (5, 1)), goals, 60.0), atol=1e-9)


def test_blocks_of_pairs_are_the_plain_ones() -> None:
    """Pairs in several blocks, near and far, angles aligned, equal or huge: the plain length of each."""
    generator = np.random.default_rng(5)
    count = 900
    starts = generator.uniform(-3000.0, 3000.0, (count, 3))
    goals = generator.uniform(-3000.0, 3000.0, (count, 3))
    goals[::3, :2] = starts[::3, :2] + generator.uniform(-350.0, 350.0, (count // 3, 2))
    quarters = 0.5 * math.pi * np.arange(-4, 5)
    starts[:, 2] = np.where(
        np.arange(count) % 2 == 0, generator.choice(quarters, count), starts[:, 2] / 500.0
    )
    goals[:, 2] = np.where(np.arange(count) % 5 == 0, starts[:, 2], generator.choice(quarters, count))
    goals[::7, 1] = starts[::7, 1]
    starts[::50, 2] += 2.0 * math.pi * 100_000.0
    lengths_m = dubins_lengths(starts, goals, 80.0)
    for start, goal, length_m in zip(starts.tolist(), goals.tolist(), lengths_m.tolist(), strict=True):
        assert length_m == pytest.approx(shortest(Pose(*start), Pose(*goal), 80.0).length_m, abs=1e-8)
    assert dubins_lengths(starts[:0], goals[:0], 80.0).shape == (0,)
