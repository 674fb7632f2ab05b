"""Which ways there are to do a job does not hang on how its ground is drawn."""

from __future__ import annotations

import math

import numpy as np
import pytest

from planner.tasks.fleet.crews import APART_RAD, MOST_WAYS, _best


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
        return _best(entries, entries, inner_m).inner_m.tolist()

    expected = chosen(entries, inner_m)
    order = rng.permutation(count)
    turned = entries + np.array([0.0, 0.0, rng.uniform(0.0, math.tau)])
    mirrored = entries * np.array([-1.0, 1.0, -1.0]) + np.array([0.0, 0.0, math.pi])
    assert chosen(entries[order], inner_m[order]) == expected
    assert chosen(turned, inner_m) == expected
    assert chosen(mirrored, inner_m) == expected
    assert len(expected) <= MOST_WAYS
    if np.isfinite(inner_m).any():
        assert expected[0] == inner_m.min()


def test_no_two_ways_have_headings_near_each_other() -> None:
    """The second is the cheapest of those that are far enough round from the first, past a full turn, too."""
    degrees = np.array([179.0, -179.0, -110.0, 100.0, 10.0])
    entries = np.column_stack([np.zeros((5, 2)), np.radians(degrees)])
    found = _best(entries, entries, np.array([1.0, 2.0, 3.0, 4.0, 5.0]))
    # 179 to -110 degrees are 71 apart, to 100 degrees 79.
    assert 71.0 < math.degrees(APART_RAD) < 79.0
    assert found.inner_m.tolist() == [1.0, 4.0, 5.0]
