"""Orders of lanes between a first and a last that stay: none shorter of few, never longer, each lane once."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from planner.coverage.reorder_kernels import order_m, reordered

Floats = NDArray[np.float64]


def random_costs(seed: int, lanes: int, barred: float) -> tuple[Floats, Floats]:
    """Turns between the states of lanes and lengths of these; no rule of geometry, some turns barred."""
    rng = np.random.default_rng(seed)
    turns_m = rng.uniform(10.0, 100.0, (2 * lanes, 2 * lanes))
    turns_m[rng.random(turns_m.shape) < barred] = math.inf
    return turns_m, rng.uniform(50.0, 300.0, 2 * lanes)


@given(st.integers(0, 10_000))
@settings(max_examples=12, deadline=None)
def test_few_lanes_are_ordered_as_every_order_tells(seed: int) -> None:
    """Of five lanes every order and way of the three in the middle is tried by hand."""
    turns_m, own_m = random_costs(seed, 5, 0.0)
    given_order = np.array([0, 2, 4, 6, 8])
    least_m = min(
        order_m(np.array([0, *(2 * k + way for k, way in zip(inner, ways, strict=True)), 8]), turns_m, own_m)
        for inner in itertools.permutations((1, 2, 3))
        for ways in itertools.product((0, 1), repeat=3)
    )
    found = reordered(given_order, turns_m, own_m, 300)
    assert order_m(found, turns_m, own_m) == pytest.approx(least_m, rel=1e-9)


@given(st.integers(0, 10_000), st.integers(1, 30), st.sampled_from([0.0, 0.3]))
@settings(max_examples=30, deadline=None)
def test_orders_are_kept_whole_and_get_no_longer(seed: int, lanes: int, barred: float) -> None:
    """Each lane once, the first and the last as they were, and no turn that is barred comes in."""
    turns_m, own_m = random_costs(seed, lanes, barred)
    rng = np.random.default_rng(seed + 1)
    given_order = 2 * rng.permutation(lanes) + rng.integers(0, 2, lanes)
    for before, after in itertools.pairwise(given_order.tolist()):
        if math.isinf(turns_m[before, after]):
            turns_m[before, after] = 150.0
    found = reordered(given_order, turns_m, own_m, 20)
    assert sorted((found // 2).tolist()) == list(range(lanes))
    assert (found[0], found[-1]) == (given_order[0], given_order[-1])
    added_m = sum(own_m[k] for k in found) + sum(turns_m[a, b] for a, b in itertools.pairwise(found))
    assert order_m(found, turns_m, own_m) == pytest.approx(added_m, rel=1e-12)
    assert added_m <= order_m(given_order, turns_m, own_m) + 1e-6


def test_the_given_order_is_left_as_it_was() -> None:
    """What options hold is theirs."""
    turns_m, own_m = random_costs(3, 12, 0.0)
    given_order = np.arange(0, 24, 2)
    assert order_m(reordered(given_order, turns_m, own_m, 50), turns_m, own_m) < order_m(
        given_order, turns_m, own_m
    )
    assert given_order.tolist() == list(range(0, 24, 2))
