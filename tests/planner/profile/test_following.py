"""Heights over ground that is followed: kept, never too steep, at their ends as asked."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planner.airspace.envelope import SMOOTH_M, Envelope
from planner.airspace.terrain import Ground
from planner.dubins.path import Path, Segment, join
from planner.profile.following import Following
from planner.profile.heights import Heights
from planner.profile.rise import Rise
from planner.route import Pose
from tests.planner.terrains import grid

KEPT_M = 40.0


def hills(seed: int) -> Ground:
    """A sum of waves, up to some 30° steep."""
    rng = np.random.default_rng(seed)
    waves = [
        (rng.uniform(10.0, 60.0), *rng.uniform(-1 / 80.0, 1 / 80.0, 2), rng.uniform(0, 6)) for _ in range(4)
    ]

    def surface(east: np.ndarray, north: np.ndarray) -> np.ndarray:
        return np.asarray(sum(a * np.sin(p * east + q * north + c) for a, p, q, c in waves))

    return grid(surface, half_m=1500.0, step_m=15.0)


def following(ground: Ground, slope: float) -> Following:
    return Following(Envelope.over(ground, KEPT_M + SMOOTH_M, slope), slope)


def bent(angle_rad: float, turn_m: float) -> Path:
    """A straight, an arc and a straight."""
    first = Segment("straight", Pose(-700.0, -200.0, angle_rad), 500.0)
    arc = Segment("left", first.end, turn_m, 120.0)
    return join(Path((first,)), Path((arc,)), Path((Segment("straight", arc.end, 400.0),)))


def steepest(heights: Heights) -> float:
    along_m, up_m = np.array(heights.knots).T
    run_m = np.diff(along_m)
    return float(np.max(np.abs(np.diff(up_m))[run_m > 1e-6] / run_m[run_m > 1e-6]))


def over_ground_m(ground: Ground, path: Path, heights: Heights) -> np.ndarray:
    points = path.sample(3.0, 3.0)
    return np.asarray(heights.at(points[:, 3]) - ground.at(points[:, :2]))


@given(st.integers(0, 10_000), st.floats(-3.1, 3.1), st.floats(0.1, 0.6), st.floats(60.0, 200.0))
@settings(max_examples=25)
def test_a_pass_keeps_its_height_as_far_as_it_can_be_climbed(
    seed: int, angle_rad: float, slope: float, height_m: float
) -> None:
    """Never lower than asked less what is smoothed, nor too steep; higher only over steep ground."""
    ground = hills(seed)
    path = Path((Segment("straight", Pose(0.0, 0.0, angle_rad), 900.0),))
    heights = following(ground, slope).over_pass(path, height_m)
    assert steepest(heights) <= slope + 1e-9
    over_m = over_ground_m(ground, path, heights)
    assert over_m.min() >= height_m - SMOOTH_M - 0.5
    gentle = following(ground, 5.0).over_pass(path, height_m)
    assert over_ground_m(ground, path, gentle).max() <= height_m + SMOOTH_M + 0.5


@given(st.integers(0, 10_000), st.floats(-3.1, 3.1), st.floats(0.12, 0.5), st.floats(0.0, 80.0))
@settings(max_examples=25)
def test_a_leg_from_pass_to_pass_is_clear_and_no_steeper_than_either(
    seed: int, angle_rad: float, slope: float, more_m: float
) -> None:
    """Both ends as they were, over the ground by what is kept all along, slopes within the limit."""
    ground = hills(seed)
    follow, path = following(ground, slope), bent(angle_rad, 200.0)
    first_m, last_m = (follow.surface_m(pose.position) for pose in (path.start, path.end))
    last_m += min(more_m, max(0.0, first_m + slope * path.length_m - last_m))
    raised = follow.over_leg(path, Heights(((0.0, first_m), (path.length_m, last_m))))
    assert (raised.knots[0][1], raised.knots[-1][1]) == (first_m, last_m)
    assert steepest(raised) <= max(slope, abs(last_m - first_m) / path.length_m) + 1e-9
    assert over_ground_m(ground, path, raised).min() >= KEPT_M - 0.5


@pytest.mark.parametrize("goal_m", [150.0, 260.0])
def test_a_rise_goes_over_a_ridge_that_stands_before_the_first_pass(goal_m: float) -> None:
    """As steeply as it may, over the ridge by what is kept, and down to the pass behind it."""
    ground = grid(lambda e, n: 180.0 * np.exp(-((e / 250.0) ** 2)), half_m=2500.0, step_m=20.0)
    slope = math.tan(math.radians(15.0))
    path = Path((Segment("straight", Pose(-1800.0, 0.0, 0.0), 3600.0),))
    run_m, low_m = 300.0, 50.0
    flat = Heights(((0.0, 0.0), (run_m, low_m), (run_m + (goal_m - low_m) / slope, goal_m), (3600.0, goal_m)))
    follow = following(ground, slope)
    up = follow.over_rise(Rise(path, flat, run_m, run_m, 0.0), goal_m)
    assert up.heights.at(run_m) == pytest.approx(low_m)
    assert up.heights.knots[-1][1] == goal_m
    assert steepest(up.heights) <= max(slope, low_m / run_m) + 1e-9
    clear_m = over_ground_m(ground, path, up.heights)
    assert clear_m[path.sample(3.0, 3.0)[:, 3] > run_m].min() >= KEPT_M - 0.5
    down = Rise(path.reverse(), flat.reverse(), run_m, run_m, 0.0)
    back = follow.over_fall(down, goal_m).heights.reverse()
    assert np.array(back.knots) == pytest.approx(np.array(up.heights.knots), abs=1e-6)
