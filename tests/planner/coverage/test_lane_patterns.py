"""Patterns of many lanes: what is left out for its bound is never what would have been the cheapest."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from planner.coverage.lanes_kernels import EXACT_UP_TO, VARIANTS, lane_orders, racetrack, skipping
from planner.coverage.turns_kernels import least_turn_m
from planner.dubins.words import shortest
from planner.route import Pose

Floats = NDArray[np.float64]
NO_DISCS = np.empty((0, 3))


def slanted(rng: np.random.Generator, lanes: int, states: int, spacing_m: float) -> tuple[Floats, Floats]:
    """Entries and exits (N, B, 3) of lanes side by side, aslant, of random ends; every other state back."""
    heading = rng.uniform(-math.pi, math.pi)
    ahead = np.array([math.cos(heading), math.sin(heading)])
    aside = np.array([-ahead[1], ahead[0]])
    entries, exits = np.zeros((2, lanes, states, 3))
    for lane, b in itertools.product(range(lanes), range(states)):
        ends = [
            along * ahead + (spacing_m * lane + 0.4 * spacing_m * (b // 2)) * aside
            for along in (rng.uniform(0.0, 200.0), rng.uniform(400.0, 600.0))
        ]
        back = b % 2 == 1
        entries[lane, b] = [*ends[back], heading + back * math.pi]
        exits[lane, b] = [*ends[not back], heading + back * math.pi]
    return entries, exits


def cheapest(
    order: list[int], turns_m: Floats, own_m: Floats, states: int, onward: Floats, variant: int
) -> float:
    """The best states of an order, by plain layers."""
    lanes = len(own_m) // states
    if (2 * order[0] >= lanes) != (variant >= 2):
        return math.inf
    reach = {order[0] * states + b: own_m[order[0] * states + b] for b in range(states)}
    for lane in order[1:]:
        here = range(lane * states, (lane + 1) * states)
        reach = {j: min(cost + turns_m[i, j] for i, cost in reach.items()) + own_m[j] for j in here}
    return min(cost for k, cost in reach.items() if bool(onward[k % states]) == (variant % 2 == 0))


@given(
    seed=st.integers(0, 10_000), lanes=st.integers(EXACT_UP_TO + 1, 14), states=st.sampled_from([2, 4]),
    spacing_m=st.floats(10.0, 150.0), skips=st.booleans(), barred=st.booleans(),
)  # fmt: skip
@settings(deadline=None, max_examples=12)
def test_no_pattern_tried_by_plain_code_is_cheaper(
    seed: int, lanes: int, states: int, spacing_m: float, skips: bool, barred: bool
) -> None:
    """Of each variant asked for the cost is the least of all patterns in all states; the others have none."""
    rng = np.random.default_rng(seed)
    radius_m, strides = 40.0, 5
    entries, exits = slanted(rng, lanes, states, spacing_m)
    own_m = np.hypot(*(exits - entries)[..., :2].reshape(-1, 2).T)
    if barred:
        own_m[rng.random(own_m.size) < 0.1] = np.inf
    onward, wanted = np.arange(states) % 2 == 0, np.array([True, True, True, seed % 2 == 0])
    turns_m = np.array(
        [[shortest(Pose(*out), Pose(*into), radius_m).length_m for into in entries.reshape(-1, 3)]
         for out in exits.reshape(-1, 3)]
    )  # fmt: skip
    none = np.zeros((1, lanes, states))
    problem = (entries[None], exits[None], own_m.reshape(1, lanes, states), np.zeros((1, lanes, states, 2)))
    how = (np.ones(states, dtype=np.bool_), onward, wanted, skips, strides, radius_m, NO_DISCS)
    costs_m, orders = lane_orders(*problem, none, none, *how)
    tried = [racetrack(lanes, stride).tolist() for stride in range(strides + 1)]
    if skips:
        tried += [skipping(lanes, stride).tolist() for stride in range(2, strides + 1)]
    tried += [[lanes - 1 - lane for lane in order] for order in tried]
    tried += [order[::-1] for order in tried]
    for variant in range(VARIANTS):
        plain_m = min(cheapest(order, turns_m, own_m, states, onward, variant) for order in tried)
        assert costs_m[0, variant] == pytest.approx(plain_m if wanted[variant] else math.inf, rel=1e-9)
        if math.isfinite(costs_m[0, variant]):
            flown = orders[0, variant].tolist()
            flown_m = math.fsum(own_m[flown]) + math.fsum(turns_m[a, b] for a, b in itertools.pairwise(flown))
            assert flown_m == pytest.approx(costs_m[0, variant], rel=1e-9)


@given(st.floats(0.0, 5.0), st.floats(-5.0, 5.0), st.sampled_from([-1.0, 1.0]))
def test_no_turn_back_is_shorter_than_its_bound(across: float, along: float, side: float) -> None:
    """Wherever along the other lane it ends, by the plain words; and some turn is as short."""
    bound = least_turn_m(across, 1.0)
    assert shortest(Pose(0.0, 0.0, 0.0), Pose(along, side * across, math.pi), 1.0).length_m >= bound - 1e-9
    # Aside by α and back: where that ends, as far along as its sines reach.
    alpha = math.acos(min(across / 2.0, 1.0))
    there = Pose(2.0 * math.sin(alpha), across, math.pi)
    assert shortest(Pose(0.0, 0.0, 0.0), there, 1.0).length_m == pytest.approx(bound, abs=1e-6)
