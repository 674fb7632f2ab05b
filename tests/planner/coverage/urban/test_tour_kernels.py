"""Tours over lines that may be flown either way."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from planner.coverage.urban.tour_kernels import nearest_first, neighbours, shortest_tour, tour_cost


def costs_of(places: np.ndarray) -> np.ndarray:
    """Straight lengths between all ends."""
    costs: np.ndarray = np.hypot(*(places[:, None] - places[None]).transpose(2, 0, 1))
    return costs


def brute_force(costs: np.ndarray) -> float:
    """The least cost of all orders and directions of a few lines."""
    lines = len(costs) // 2
    best = np.inf
    for order in itertools.permutations(range(1, lines)):
        for ways in itertools.product((0, 1), repeat=lines - 1):
            ends = [0, 1, *(2 * k + (w ^ side) for k, w in zip(order, ways, strict=True) for side in (0, 1))]
            joins = zip(ends[1::2], [*ends[2::2], ends[0]], strict=True)
            best = min(best, sum(costs[a, b] for a, b in joins))
    return best


@pytest.mark.parametrize("seed", range(6))
def test_few_lines_are_flown_the_shortest_way(seed: int) -> None:
    """As short as the best of all orders and directions."""
    costs = costs_of(np.random.default_rng(seed).uniform(0.0, 100.0, (10, 2)))
    tour = shortest_tour(costs, neighbours(costs, 8), nearest_first(costs, 8), 300, seed)
    assert tour_cost(costs, tour) == pytest.approx(brute_force(costs))


@pytest.mark.parametrize("lines", [1, 2, 3, 60])
def test_every_line_is_flown_once_and_whole(lines: int) -> None:
    """Both ends of each line lie side by side; no change makes the tour longer."""
    costs = costs_of(np.random.default_rng(lines).uniform(0.0, 100.0, (2 * lines, 2)))
    first = nearest_first(costs, 0)
    tour = shortest_tour(costs, neighbours(costs, 10), first, 500, 1)
    assert sorted(tour.tolist()) == list(range(2 * lines))
    assert (tour[::2] // 2 == tour[1::2] // 2).all()
    assert tour_cost(costs, tour) <= tour_cost(costs, first) + 1e-9


def test_parallel_lanes_are_flown_to_and_fro() -> None:
    """Lanes side by side in a random order: joined end to end by the shortest joins there are."""
    heights = np.random.default_rng(2).permutation(40) * 10.0
    places = np.stack([np.array([[0.0, y], [500.0, y]]) for y in heights]).reshape(-1, 2)
    costs = costs_of(places)
    tour = shortest_tour(costs, neighbours(costs, 10), nearest_first(costs, 0), 2000, 0)
    # 39 joins of 10 m and one back over all of them
    assert tour_cost(costs, tour) == pytest.approx(39 * 10.0 + 390.0)


def test_the_same_again() -> None:
    """The same seed gives the same tour."""
    costs = costs_of(np.random.default_rng(3).uniform(0.0, 100.0, (80, 2)))
    ways = [shortest_tour(costs, neighbours(costs, 10), nearest_first(costs, 0), 200, 5) for _ in (0, 1)]
    assert (ways[0] == ways[1]).all()


def test_neighbours_are_the_nearest_ends_of_other_lines() -> None:
    """As sorting all costs says."""
    costs = costs_of(np.random.default_rng(4).uniform(0.0, 100.0, (30, 2)))
    near = neighbours(costs, 6)
    for end in range(30):
        others = [other for other in np.argsort(costs[end]).tolist() if other // 2 != end // 2]
        assert near[end].tolist() == others[:6]
