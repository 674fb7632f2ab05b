"""Orders of lanes: each once, the cheapest of the patterns, every order where lanes are few."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from planner.coverage.lanes_kernels import VARIANTS, lane_orders, skipping
from planner.dubins.words import shortest
from planner.route import Pose

Floats = NDArray[np.float64]
NOTHING = np.empty((0, 9))


def lanes(count: int, spacing_m: float, ends_m: Floats) -> tuple[Floats, Floats, Floats]:
    """Entries, exits and lengths of lanes from west to east, (N, 2, …); ``ends_m`` (N, 2) in x."""
    entries, exits = np.zeros((count, 2, 3)), np.zeros((count, 2, 3))
    for k in range(count):
        y_m = k * spacing_m
        entries[k] = [[ends_m[k, 0], y_m, 0.0], [ends_m[k, 1], y_m, math.pi]]
        exits[k] = [[ends_m[k, 1], y_m, 0.0], [ends_m[k, 0], y_m, math.pi]]
    own_m = np.repeat((ends_m[:, 1] - ends_m[:, 0])[:, None], 2, axis=1)
    return entries, exits, own_m


def solved(
    entries: Floats, exits: Floats, own_m: Floats, strides: int, radius_m: float
) -> tuple[Floats, Floats]:
    """Costs and orders of one problem, (4,) and (4, N)."""
    none = np.zeros((1, len(own_m), 2))
    cramped_m = np.zeros((1, len(own_m), 2, 2))
    problem = (entries[None], exits[None], own_m[None], cramped_m, none, none)
    either, onward = np.ones(2, dtype=np.bool_), np.array([True, False])
    every = np.ones(VARIANTS, dtype=np.bool_)
    costs, orders = lane_orders(*problem, either, onward, every, True, strides, radius_m, NOTHING)
    return costs[0], orders[0]


def cost_m(entries: Floats, exits: Floats, own_m: Floats, order: list[int], radius_m: float) -> float:
    """What an order costs: its lanes, and the shortest turns between them by the plain words."""
    poses_in, poses_out = entries.reshape(-1, 3), exits.reshape(-1, 3)
    turns_m = [
        shortest(Pose(*poses_out[a]), Pose(*poses_in[b]), radius_m).length_m
        for a, b in itertools.pairwise(order)
    ]
    return math.fsum(turns_m) + math.fsum(own_m.reshape(-1)[k] for k in order)


@given(st.integers(1, 30), st.integers(2, 12))
def test_orders_that_skip_lanes_have_each_once(count: int, stride: int) -> None:
    """A permutation whose steps are the stride, but for one at the end of each way."""
    order = skipping(count, stride)
    assert sorted(order.tolist()) == list(range(count))
    others = [abs(step) for step in np.diff(order).tolist() if abs(step) != stride]
    assert len(others) <= min(stride, count) - 1
    assert max(others, default=0) <= stride


def test_two_by_two_is_every_other_lane_out_and_the_others_back() -> None:
    """As drawn in books on ploughing."""
    assert skipping(7, 2).tolist() == [0, 2, 4, 6, 5, 3, 1]
    assert skipping(6, 2).tolist() == [0, 2, 4, 5, 3, 1]


@given(st.integers(1, 4), st.floats(10.0, 80.0), st.integers(0, 10_000))
@settings(max_examples=15, deadline=None)
def test_few_lanes_are_ordered_as_every_order_tells(count: int, spacing_m: float, seed: int) -> None:
    """The least of all variants is the least of all orders and ways, by the plain shortest turns."""
    ends_m = np.sort(np.random.default_rng(seed).uniform(0.0, 300.0, (count, 2)), axis=1)
    ends_m[:, 1] += 10.0
    entries, exits, own_m = lanes(count, spacing_m, ends_m)
    costs, orders = solved(entries, exits, own_m, 12, 25.0)
    least_m = min(
        cost_m(entries, exits, own_m, [2 * lane + way for lane, way in zip(order, ways, strict=True)], 25.0)
        for order in itertools.permutations(range(count))
        for ways in itertools.product((0, 1), repeat=count)
    )
    assert costs.min() == pytest.approx(least_m, rel=1e-9)
    for variant in np.flatnonzero(np.isfinite(costs)):
        order = orders[variant].tolist()
        assert sorted(k // 2 for k in order) == list(range(count))
        assert order[-1] % 2 == variant % 2
        assert (2 * (order[0] // 2) >= count) == (variant >= 2)
        assert cost_m(entries, exits, own_m, order, 25.0) == pytest.approx(costs[variant], rel=1e-9)


@pytest.mark.parametrize(("spacing_m", "best"), [(70.0, {1}), (40.0, {2}), (21.0, {3, 6})])
def test_turns_wider_than_the_spacing_skip_lanes(spacing_m: float, best: set[int]) -> None:
    """With turns of 60 m: the next lane where it is 70 m away, every other at 40 m, more at 21 m."""
    ends_m = np.tile([0.0, 800.0], (24, 1))
    entries, exits, own_m = lanes(24, spacing_m, ends_m)
    costs, orders = solved(entries, exits, own_m, 12, 30.0)
    order = orders[int(costs.argmin())]
    assert cost_m(entries, exits, own_m, order.tolist(), 30.0) == pytest.approx(costs.min(), rel=1e-9)
    steps = np.abs(np.diff(order // 2))
    assert set(np.flatnonzero(np.bincount(steps) == np.bincount(steps).max()).tolist()) & best
    boustrophedon = [2 * k + k % 2 for k in range(24)]
    assert costs.min() <= cost_m(entries, exits, own_m, boustrophedon, 30.0) + 1e-6
