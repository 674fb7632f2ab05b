"""The route of most reward, proved: by dynamic programming where there are few places."""

from __future__ import annotations

from planner.fleet.prizes.choice import Choices
from planner.fleet.prizes.exact_kernels import best_subset
from planner.fleet.prizes.problem import Gathered

#: Beyond so many places between start and end there are too many subsets.
MOST_PLACES = 12


def exact_route(choices: Choices) -> Gathered:
    """The route of most reward, and of those the cheapest.

    Raises
    ------
    ValueError
        Where there are too many places, or the way from start to end is over the budget.
    """
    inner = len(choices.rewards) - 2
    if inner > MOST_PLACES:
        raise ValueError(f"{inner} places are too many to prove; there may be {MOST_PLACES}")
    order, reward, cost = best_subset(choices.costs, choices.rewards, choices.budget)
    if len(order) == 0:
        raise ValueError("the way from start to end is over the budget")
    return Gathered(tuple(int(place) for place in order), float(reward), float(cost))
