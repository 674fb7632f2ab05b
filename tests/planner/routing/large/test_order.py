"""The search over the order of many regions: its kernels against plain sums and exact answers."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.geometry import LineString, Point

from planner.airspace.surroundings import Surroundings
from planner.airspace.values import Wind
from planner.coverage.strips.options import Options
from planner.dubins.estimate_kernels import point_costs, transit_costs
from planner.orders_kernels import best_options, best_orders
from planner.progress import never, silent
from planner.routing.large import kernels as large_kernels
from planner.routing.large.order import large_order
from planner.vehicle.wind import CIRCLE_RAD, still_air_costs, still_air_factor

RADIUS_M = 100.0
NO_DISCS = np.empty((0, 3))


def surroundings() -> Surroundings:
    return Surroundings(None, None, NO_DISCS, NO_DISCS, (), RADIUS_M, 0.0)


def random_options(rng: np.random.Generator, regions: int) -> tuple[np.ndarray, list[Options]]:
    centres = rng.uniform(0.0, 20_000.0, (regions, 2))
    found = []
    for centre in centres:
        count = int(rng.integers(1, 4))
        angles = rng.uniform(-math.pi, math.pi, count)
        entries = np.column_stack([centre + rng.uniform(-500.0, 500.0, (count, 2)), angles])
        ahead = 400.0 * np.column_stack([np.cos(angles), np.sin(angles), np.zeros(count)])
        nothing = np.full(count, np.nan)
        found.append(
            Options(
                np.zeros(count, dtype=np.int64),
                angles,
                nothing,
                nothing,
                entries,
                entries + ahead,
                np.full(count, 400.0),
                np.full((count, 1), -1, dtype=np.int64),
            )
        )
    return centres, found


def costs_of(options: list[Options]) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    entries = np.concatenate([o.entries for o in options])
    exits = np.concatenate([o.exits for o in options])
    inner = np.concatenate([o.inner_m for o in options])
    between = transit_costs(exits, entries, RADIUS_M, NO_DISCS) + inner[None]
    first = point_costs(0.0, -3000.0, entries, RADIUS_M, NO_DISCS) + inner
    last = np.hypot(exits[:, 0], exits[:, 1] + 3000.0)
    offsets = np.concatenate([[0], np.cumsum([len(o.inner_m) for o in options])]).astype(np.int64)
    return first, between, last, offsets


@pytest.mark.parametrize("seed", range(8))
def test_the_search_finds_the_exact_order_of_few_regions(seed: int) -> None:
    """On eight random regions the order found costs what dynamic programming over all orders says."""
    rng = np.random.default_rng(seed)
    centres, options = random_options(rng, 8)
    first, between, last, offsets = costs_of(options)
    exact, _ = best_orders(first, between, last, offsets)
    start = rng.permutation(8).astype(np.int64)
    ends = (first, last, surroundings(), NO_DISCS)
    cost, order = large_order([start], centres, options, *ends, seed, silent, never, never)
    assert sorted(order) == list(range(8))
    assert cost == pytest.approx(float(exact.min()), abs=0.05)
    again, _ = best_options(first, between, last, offsets, order)
    assert again == pytest.approx(cost, abs=0.05)


def test_the_search_is_the_same_for_the_same_seed_and_stops_when_asked() -> None:
    """Two searches agree to the last bit; one that has had enough keeps every region and costs no less."""
    centres, options = random_options(np.random.default_rng(3), 25)
    first, _, last, _ = costs_of(options)
    start = np.arange(25, dtype=np.int64)
    ends = (first, last, surroundings(), NO_DISCS)
    one = large_order([start], centres, options, *ends, 7, silent, never, never)
    other = large_order([start], centres, options, *ends, 7, silent, never, never)
    hasty = large_order([start], centres, options, *ends, 7, silent, never, lambda: True)
    assert one[0] == other[0]
    assert list(one[1]) == list(other[1])
    assert sorted(hasty[1]) == list(range(25))
    assert hasty[0] >= one[0]


def test_a_small_pool_gives_the_same_order(monkeypatch: pytest.MonkeyPatch) -> None:
    """Blocks of costs thrown away and made anew change nothing."""
    centres, options = random_options(np.random.default_rng(5), 12)
    first, _, last, _ = costs_of(options)
    start = np.arange(12, dtype=np.int64)
    ends = (first, last, surroundings(), NO_DISCS)
    one = large_order([start], centres, options, *ends, 1, silent, never, never)
    monkeypatch.setattr("planner.routing.large.order.POOL_BYTES", 4 * 9 * 5)
    other = large_order([start], centres, options, *ends, 1, silent, never, never)
    assert one[0] == other[0]
    assert list(one[1]) == list(other[1])


@given(
    e=st.floats(-5000.0, 5000.0),
    n=st.floats(-5000.0, 5000.0),
    extra=st.floats(0.0, 2000.0),
    speed=st.floats(0.5, 15.0),
    toward=st.floats(-math.pi, math.pi),
)
def test_wind_costs_are_those_of_the_vehicle(
    e: float, n: float, extra: float, speed: float, toward: float
) -> None:
    """The compiled cost in a wind is the plain one's."""
    wind = Wind(speed, toward)
    length = math.hypot(e, n) + extra
    plain = still_air_costs(np.array([length]), np.zeros((1, 2)), np.array([[e, n]]), 20.0, wind)[0]
    mean = float(still_air_factor(CIRCLE_RAD, 20.0, wind).mean())
    packed = np.array([speed * math.cos(toward), speed * math.sin(toward), speed, 20.0 * mean]) / 20.0
    assert large_kernels.in_wind(length, e, n, packed) == pytest.approx(plain, rel=1e-9, abs=1e-6)


@given(seed=st.integers(0, 500))
@settings(deadline=None, max_examples=40)
def test_no_disc_that_matters_is_left_out(seed: int) -> None:
    """Every disc that a straight line between two sets of places crosses is among those kept."""
    rng = np.random.default_rng(seed)
    places, others = rng.uniform(0, 1000, (4, 2)), rng.uniform(0, 1000, (3, 2)) + np.array([5000.0, 0.0])
    discs = np.column_stack(
        [rng.uniform(-1000, 7000, 12), rng.uniform(-3000, 3000, 12), rng.uniform(50, 400, 12)]
    )
    kept = {tuple(row) for row in large_kernels.discs_between(places, others, discs, 0.0)}
    for place, other in itertools.product(places, others):
        for disc in discs:
            if LineString([place, other]).distance(Point(disc[:2])) < disc[2]:
                assert tuple(disc) in kept
