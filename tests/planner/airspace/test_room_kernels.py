"""Compiled costs of options against shapely's discs and numpy's distances."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely

from planner.airspace.prices import risks_m
from planner.airspace.room_kernels import circles_fit, inside_m

RNG = np.random.default_rng(5)
DISCS = np.column_stack([RNG.uniform(-3000.0, 3000.0, (6, 2)), RNG.uniform(300.0, 900.0, 6)])
#: Chords of a buffer with so many segments to a quarter are within this of the arc.
ROUND, CHORD_M = 512, 0.05


def test_lengths_in_discs_are_those_of_shapely() -> None:
    """Lines across overlapping discs have as much of them inside as the union of shapely's buffers says."""
    lines = RNG.uniform(-4000.0, 4000.0, (50, 2, 2))
    union = shapely.union_all([shapely.Point(e, n).buffer(r, quad_segs=ROUND) for e, n, r in DISCS])
    wanted = [shapely.LineString(line).intersection(union).length for line in lines]
    assert max(wanted) > 500.0
    assert inside_m(lines, DISCS) == pytest.approx(wanted, abs=200.0 * CHORD_M)


def test_each_price_for_what_lies_in_its_discs() -> None:
    """Lines of a batch cost what each costs by itself: every price times the length in its discs."""
    lines = RNG.uniform(-4000.0, 4000.0, (20, 2, 2))
    prices = np.array([20.0, 5.0, 20.0, 5.0, 5.0, 20.0])
    wanted = 20.0 * inside_m(lines, DISCS[prices == 20.0]) + 5.0 * inside_m(lines, DISCS[prices == 5.0])
    assert wanted.max() > 0.0
    assert risks_m(lines, np.column_stack([DISCS, prices])) == pytest.approx(wanted)
    assert not risks_m(lines, np.empty((0, 4))).any()


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_circles_fit_where_numpy_finds_them_clear(side: float) -> None:
    """Turning circles are free exactly where their centres are farther from all discs than both radii."""
    poses = np.column_stack([RNG.uniform(-4000.0, 4000.0, (300, 2)), RNG.uniform(-math.pi, math.pi, 300)])
    centres = poses[:, :2] + side * 250.0 * np.column_stack([-np.sin(poses[:, 2]), np.cos(poses[:, 2])])
    away_m = np.hypot(*(centres[:, None] - DISCS[None, :, :2]).T).T
    wanted = (away_m >= DISCS[None, :, 2] + 250.0).all(axis=1)
    assert 0 < wanted.sum() < len(wanted)
    assert circles_fit(poses, side, 250.0, DISCS).tolist() == wanted.tolist()
