"""The surface that a flight over ground keeps to, against the greatest of all cones."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from planner.airspace.envelope import BETWEEN_POSTS, Envelope
from planner.airspace.envelope_kernels import LONGER
from planner.airspace.terrain import Ground


def rough(seed: int, rows: int = 23, columns: int = 31, step_m: float = 25.0) -> Ground:
    """Ground with cliffs and with posts that are missing."""
    rng = np.random.default_rng(seed)
    heights_m = rng.uniform(0.0, 60.0, (rows, columns)) + 200.0 * (rng.random((rows, columns)) < 0.03)
    heights_m[rng.random((rows, columns)) < 0.05] = np.nan
    return Ground("rough", "EGM96", heights_m, 100.0, -300.0, step_m)


def cones_m(ground: Ground, slope: float) -> np.ndarray:
    """At every post the greatest of h − slope · d over all posts that are known."""
    rows, columns = ground.heights_m.shape
    i, j = np.indices((rows, columns))
    known = np.argwhere(np.isfinite(ground.heights_m))
    away_m = ground.step_m * np.hypot(i[..., None] - known[:, 0], j[..., None] - known[:, 1])
    heights_m = ground.heights_m[known[:, 0], known[:, 1]]
    return np.asarray((heights_m - slope * away_m).max(axis=-1))


@given(st.integers(0, 10_000), st.floats(0.02, 1.5), st.floats(0.0, 120.0))
@settings(max_examples=30)
def test_the_surface_is_the_greatest_cone(seed: int, slope: float, over_m: float) -> None:
    """Between the cones of the slope asked for and those of the least that it may be taken for."""
    ground = rough(seed)
    surface_m = Envelope.over(ground, over_m, slope).surface_m - over_m
    assert np.all(surface_m >= cones_m(ground, slope) - 1e-9)
    assert np.all(surface_m <= cones_m(ground, slope * BETWEEN_POSTS / LONGER) + 1e-9)


@given(st.integers(0, 10_000), st.floats(0.05, 0.6))
@settings(max_examples=20)
def test_no_straight_over_the_surface_is_too_steep(seed: int, slope: float) -> None:
    """Along any line, and from post to post, it rises no faster than asked; over ground it is kept."""
    ground = rough(seed)
    envelope = Envelope.over(ground, 40.0, slope)
    rng = np.random.default_rng(seed)
    size_m = ground.step_m * np.array([ground.heights_m.shape[1] - 1, ground.heights_m.shape[0] - 1])
    corner_m = np.array([ground.west_m, ground.south_m])
    ends = corner_m + rng.uniform(0.0, 1.0, (200, 2, 2)) * size_m
    apart_m = np.hypot(*(ends[:, 1] - ends[:, 0]).T)
    far = apart_m > 4.0 * ground.step_m
    rises_m = np.abs(np.diff(envelope.at(ends), axis=1))[:, 0]
    assert np.all(rises_m[far] <= slope * apart_m[far] * 1.02)
    places = corner_m + rng.uniform(0.0, 1.0, (500, 2)) * size_m
    clear_m = envelope.at(places) - ground.at(places)
    assert np.nanmin(clear_m) >= 40.0 - 1e-9
