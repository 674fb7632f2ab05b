"""Which ways there are to do a job does not hang on how its ground is drawn."""

from __future__ import annotations

import math

import numpy as np
import pytest

from planner.tasks.fleet.ways import APART_RAD, MOST_WAYS, best_ways


@pytest.mark.parametrize("seed", range(20))
def test_ways_are_the_same_turned_mirrored_and_in_another_order(seed: int) -> None:
    """Options at random headings, some as they lie on a grid: those chosen are the same ones."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(1, 40))
    headings = rng.uniform(-math.pi, math.pi, count)
    if seed % 2:
        headings = math.radians(15.0) * rng.integers(-12, 12, count)
    entries = np.column_stack([rng.uniform(-500.0, 500.0, (count, 2)), headings])
    inner_m = rng.uniform(500.0, 900.0, count)
    inner_m[rng.random(count) < 0.2] = math.inf

    def chosen(entries: np.ndarray, inner_m: np.ndarray) -> list[float]:
        return best_ways(entries, entries, inner_m).inner_m.tolist()

    expected = chosen(entries, inner_m)
    order = rng.permutation(count)
    turned = entries + np.array([0.0, 0.0, rng.uniform(0.0, math.tau)])
    mirrored = entries * np.array([-1.0, 1.0, -1.0]) + np.array([0.0, 0.0, math.pi])
    assert chosen(entries[order], inner_m[order]) == expected
    assert chosen(turned, inner_m) == expected
    assert chosen(mirrored, inner_m) == expected
    assert len(expected) <= 2 * MOST_WAYS
    if np.isfinite(inner_m).any():
        assert expected[0] == inner_m.min()


def test_no_two_ways_have_headings_near_each_other() -> None:
    """The second is the cheapest of those that are far enough round from the first, past a full turn, too."""
    degrees = np.array([179.0, -179.0, -110.0, 100.0, 10.0])
    entries = np.column_stack([np.zeros((5, 2)), np.radians(degrees)])
    found = best_ways(entries, entries, np.array([1.0, 2.0, 3.0, 4.0, 5.0]))
    # 179 to -110 degrees are 71 apart, to 100 degrees 79.
    assert 71.0 < math.degrees(APART_RAD) < 79.0
    assert found.inner_m.tolist() == [1.0, 4.0, 5.0]


def test_of_as_cheap_ways_side_by_side_those_on_either_side_are_known() -> None:
    """Lanes over one region that see as much are left and right of it: which comes first says nothing."""
    north_m = np.array([-200.0, -60.0, 0.0, 70.0, 190.0])
    entries = np.column_stack([np.zeros(5), north_m, np.zeros(5)])
    found = best_ways(entries, entries, np.array([600.2, 600.0, 600.3, 600.1, 600.4]))
    assert sorted(found.entries[:, 1].tolist()) == [-200.0, 190.0]
    assert best_ways(entries, entries, 600.0 + np.arange(5.0)).inner_m.tolist() == [600.0]
