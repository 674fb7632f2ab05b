"""Routes of most reward against every order of small problems."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from planner.fleet.prizes.bound import reward_bound
from planner.fleet.prizes.draw_kernels import draw, seeded
from planner.fleet.prizes.problem import Prizes
from planner.fleet.prizes.route import best_route

PLACES = 8


def _problem(seed: int, *, symmetric: bool, closed: bool) -> Prizes:
    generator = np.random.default_rng(seed)
    points = generator.uniform(0.0, 100.0, (PLACES, 2))
    if closed:
        points[-1] = points[0]
    costs = np.hypot(*(points[:, None] - points[None]).transpose(2, 0, 1))
    if not symmetric:
        costs = costs + generator.uniform(0.0, 30.0, costs.shape)
        np.fill_diagonal(costs, 0.0)
    rewards = np.round(generator.uniform(1.0, 20.0, PLACES))
    rewards[[0, -1]] = 0.0
    return Prizes(costs, rewards, costs[0, -1] + 120.0)


def _every_order(prizes: Prizes) -> tuple[float, float]:
    """Most reward, and least cost for it."""
    last = len(prizes.rewards) - 1
    best = (0.0, prizes.costs[0, last])
    for size in range(1, last):
        for middle in itertools.permutations(range(1, last), size):
            order = (0, *middle, last)
            cost = sum(prizes.costs[a, b] for a, b in itertools.pairwise(order))
            if cost <= prizes.budget + 1e-9:
                best = max(best, (sum(prizes.rewards[k] for k in middle), cost), key=lambda b: (b[0], -b[1]))
    return best


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("symmetric", [True, False])
@pytest.mark.parametrize("closed", [True, False])
def test_small_problems_are_solved(seed: int, symmetric: bool, closed: bool) -> None:
    """Reward and cost are those of the best of all orders, and of the order given."""
    prizes = _problem(seed, symmetric=symmetric, closed=closed)
    found = best_route(prizes, seed)
    reward, cost = _every_order(prizes)
    assert found.reward == pytest.approx(reward)
    assert found.cost <= prizes.budget + 1e-9
    assert (found.order[0], found.order[-1]) == (0, PLACES - 1)
    assert len(set(found.order)) == len(found.order)
    steps = itertools.pairwise(found.order)
    assert found.cost == pytest.approx(sum(prizes.costs[a, b] for a, b in steps))
    assert found.cost == pytest.approx(cost)
    assert reward <= reward_bound(prizes) <= prizes.rewards.sum() * (1.0 + 2e-6)


def test_no_budget_brings_nothing() -> None:
    """A bound without any way is what is had without any."""
    east = np.array([0.0, 10.0, 20.0, 30.0, 40.0, 0.0])
    costs = np.abs(east[:, None] - east[None])
    bound = reward_bound(Prizes(costs, np.array([0.0, 1.0, 1.0, 1.0, 1.0, 0.0]), 0.0))
    assert bound == pytest.approx(0.0, abs=1e-4)


def test_same_seed_same_route() -> None:
    """One seed gives one route, with two threads also."""
    prizes = _problem(5, symmetric=True, closed=False)
    assert best_route(prizes, 3, threads=2) == best_route(prizes, 3, threads=2)


def test_place_without_a_way_is_left_out() -> None:
    """A place that nothing leads to is on no route."""
    prizes = _problem(1, symmetric=True, closed=True)
    costs = prizes.costs.copy()
    costs[:, 3] = costs[3, :] = np.inf
    assert 3 not in best_route(Prizes(costs, prizes.rewards, 400.0), 0).order


def test_all_that_stops_is_asked() -> None:
    """A search told to stop ends with what it has."""
    prizes = _problem(2, symmetric=True, closed=True)
    assert best_route(prizes, 0, pools=None, stop=lambda: True).cost <= prizes.budget


def test_refused() -> None:
    """A budget under the way home, and what is no problem."""
    costs = np.ones((3, 3))
    with pytest.raises(ValueError, match="over the budget"):
        best_route(Prizes(costs, np.ones(3), 0.5), 0)
    with pytest.raises(ValueError, match="no route"):
        reward_bound(Prizes(costs, np.ones(3), 0.5))
    with pytest.raises(ValueError, match="places"):
        Prizes(costs, np.ones(2), 1.0)
    with pytest.raises(ValueError, match="numbers"):
        Prizes(np.full((3, 3), np.nan), np.ones(3), 1.0)
    with pytest.raises(ValueError, match="start and an end"):
        Prizes(np.zeros((1, 1)), np.ones(1), 1.0)


def test_draws_are_uniform() -> None:
    """Draws fill [0, 1) evenly, and streams of a seed differ."""
    one, other = seeded(7, 0), seeded(7, 1)
    draws = np.array([draw(one) for _ in range(4000)])
    assert draws.min() >= 0.0
    assert draws.max() < 1.0
    counts, _ = np.histogram(draws, bins=10, range=(0.0, 1.0))
    # Of 400 a bin: four standard deviations.
    assert abs(counts - 400).max() < 80
    assert draw(other) != draws[0]
