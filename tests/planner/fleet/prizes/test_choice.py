"""Routes with several ways to pass each place, against all orders and all ways of small problems."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from planner.fleet.prizes.choice import Choices, Flown, best_choice
from planner.fleet.prizes.exact import MOST_PLACES, exact_route

PLACES, WAYS = 6, 2


def _problem(seed: int) -> Choices:
    generator = np.random.default_rng(seed)
    points = generator.uniform(0.0, 100.0, (PLACES, 2))
    straight = np.hypot(*(points[:, None] - points[None]).transpose(2, 0, 1))
    costs = straight[:, :, None, None] + generator.uniform(0.0, 40.0, (PLACES, PLACES, WAYS, WAYS))
    rewards = np.round(generator.uniform(1.0, 20.0, PLACES))
    rewards[[0, -1]] = 0.0
    return Choices(costs, rewards, float(costs[0, -1].min() + 150.0))


def _cheapest(choices: Choices, order: tuple[int, ...]) -> float:
    return min(
        sum(
            choices.costs[a, b, g, h]
            for a, b, g, h in zip(order[:-1], order[1:], ways[:-1], ways[1:], strict=True)
        )
        for ways in itertools.product(range(WAYS), repeat=len(order))
    )


@pytest.mark.parametrize("seed", range(6))
def test_small_problems_are_solved(seed: int) -> None:
    """Reward and cost are those of the best of all orders in all ways."""
    choices = _problem(seed)
    found = best_choice(choices, seed)
    best = (0.0, -_cheapest(choices, (0, PLACES - 1)))
    for size in range(1, PLACES - 1):
        for middle in itertools.permutations(range(1, PLACES - 1), size):
            cost = _cheapest(choices, (0, *middle, PLACES - 1))
            if cost <= choices.budget:
                best = max(best, (float(choices.rewards[list(middle)].sum()), -cost))
    assert (found.reward, -found.cost) == pytest.approx(best)
    proved = exact_route(choices)
    assert (proved.reward, -proved.cost) == pytest.approx(best)
    assert _cheapest(choices, proved.order) == pytest.approx(proved.cost)
    assert found.cost == pytest.approx(_cheapest(choices, found.order))
    assert choices.cost(found.order) == pytest.approx(found.cost)


def test_what_is_truly_flown_counts() -> None:
    """Routes over the budget count where they truly take less, and their cost is the true one."""
    choices = _problem(1)
    dear = Choices(choices.costs * 1.05, choices.rewards, choices.budget)
    found = best_choice(dear, 0, pools=2, flown=Flown(choices.cost, (1.0, 1.05)))
    assert found.reward == best_choice(choices, 0).reward
    assert found.cost == pytest.approx(choices.cost(found.order))
    assert found.cost <= choices.budget


def test_refused() -> None:
    """A budget under the way home, and shapes that do not fit."""
    with pytest.raises(ValueError, match="over the budget"):
        best_choice(Choices(np.ones((3, 3, 1, 1)), np.ones(3), 0.5), 0)
    with pytest.raises(ValueError, match="places"):
        Choices(np.ones((3, 3, 2, 1)), np.ones(3), 1.0)
    with pytest.raises(ValueError, match="over the budget"):
        exact_route(Choices(np.ones((3, 3, 1, 1)), np.ones(3), 0.5))
    many = MOST_PLACES + 3
    with pytest.raises(ValueError, match="too many"):
        exact_route(Choices(np.ones((many, many, 1, 1)), np.ones(many), 9.0))
    with pytest.raises(ValueError, match="numbers"):
        Choices(np.ones((3, 3, 1, 1)), np.array([0.0, np.inf, 0.0]), 1.0)
