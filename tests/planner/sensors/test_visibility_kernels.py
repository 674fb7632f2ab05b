"""What is hidden of a region, place by place, against whole profiles with every sample flagged."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from planner.airspace.terrain_kernels import ground_at, heights_between
from planner.sensors.view_kernels import SEEN, lead_m, profile_flags
from planner.sensors.visibility_kernels import line_visibility

Floats = NDArray[np.float64]

STEP_M, CELL_M = 30.0, 15.0


def plain_visibility(
    heights_m: Floats,
    poses: Floats,
    places_m: Floats,
    level_m: float,
    tans: tuple[float, float],
    squint_tan: float,
    yaw_rad: float,
) -> Floats:
    """Fraction hidden from each line: the profile through each place, all of it flagged."""
    hidden = np.zeros(len(poses))
    for i, pose in enumerate(poses):
        for place in places_m:
            foot_m, reach_m = float((place - pose[:2]) @ pose[2:4]), float((place - pose[:2]) @ pose[4:6])
            z_m = ground_at(heights_m, 0.0, 0.0, STEP_M, *place)
            if reach_m <= 0.0 or math.isnan(z_m) or z_m >= level_m:
                continue
            if not tans[0] <= reach_m / (level_m - z_m) <= tans[1]:
                continue
            ahead_m = lead_m(reach_m, level_m - z_m, squint_tan, yaw_rad)
            last = int(reach_m / CELL_M)
            out_m = reach_m + CELL_M * (np.arange(last + 3 + int(0.5 * reach_m / CELL_M)) - last)
            at_m = foot_m - ahead_m * (1.0 - out_m / reach_m)
            spots = pose[:2] + at_m[:, None] * pose[2:4] + out_m[:, None] * pose[4:6]
            profile = np.array([ground_at(heights_m, 0.0, 0.0, STEP_M, e, n) for e, n in spots])
            profile[last] = z_m
            flags = profile_flags(level_m, out_m, profile, *tans, math.hypot(1.0, ahead_m / reach_m))
            hidden[i] += flags[last] != SEEN
    return hidden / len(places_m)


@pytest.mark.parametrize("seed", range(24))
def test_as_whole_profiles_say(seed: int) -> None:
    """On smooth and rough ground, with gaps, squinted and turned, from low and high: the same fractions."""
    generator = np.random.default_rng(seed)
    heights_m = generator.uniform(-60.0, 60.0, (60, 60)) * generator.choice([0.05, 0.3, 1.0, 4.0])
    if seed % 2:
        heights_m = 6.0 * gaussian_filter(heights_m, 3.0)
    if seed % 3 == 0:
        heights_m[generator.random((60, 60)) < 0.02] = np.nan
    angle_rad = generator.uniform(-math.pi, math.pi, 6)
    ahead = np.column_stack([np.cos(angle_rad), np.sin(angle_rad)])
    poses = np.column_stack([generator.uniform(100, 1700, (6, 2)), ahead, ahead[:, 1], -ahead[:, 0]])
    places_m = generator.uniform(100.0, 1700.0, (25, 2))
    level_m = float(generator.uniform(80.0, 700.0))
    near_tan = float(generator.uniform(0.1, 1.0))
    tans = (near_tan, near_tan + float(generator.uniform(0.1, 1.5)))
    squint_tan = math.tan(generator.uniform(-0.4, 0.4)) if seed % 4 == 1 else 0.0
    yaw_rad = float(generator.uniform(-0.2, 0.2)) if seed % 4 == 2 else 0.0
    found = line_visibility(
        heights_m, 0.0, 0.0, STEP_M, poses, places_m, CELL_M, level_m, np.full(6, tans[0]),
        np.full(6, tans[1]), squint_tan, np.full(6, yaw_rad),
    )  # fmt: skip
    assert found == pytest.approx(
        plain_visibility(heights_m, poses, places_m, level_m, tans, squint_tan, yaw_rad)
    )


def test_heights_between_bounds_the_ground_of_a_box() -> None:
    """No ground in the box is beyond; gaps do not count; off the grid nothing is known."""
    heights_m = np.random.default_rng(1).uniform(0.0, 100.0, (20, 30))
    heights_m[5, 5] = np.nan
    low_m, high_m = heights_between(heights_m, 0.0, 0.0, 10.0, np.array([33.0, 41.0, 87.0, 66.0]))
    inside = [
        ground_at(heights_m, 0.0, 0.0, 10.0, e, n)
        for e in np.linspace(33.0, 87.0, 40)
        for n in np.linspace(41.0, 66.0, 40)
    ]
    assert low_m <= np.nanmin(inside)
    assert np.nanmax(inside) <= high_m
    assert heights_between(heights_m, 0.0, 0.0, 10.0, np.array([1e4, 1e4, 2e4, 2e4])) == (math.inf, -math.inf)
