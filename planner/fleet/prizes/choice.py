"""The route of most reward within a budget, where each place is passed in one of several ways."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from planner.fleet.prizes.choice_kernels import anneal_ways, cheapest_ways
from planner.fleet.prizes.cross_kernels import crossed
from planner.fleet.prizes.draw_kernels import State, seeded
from planner.fleet.prizes.pools import (
    COLD,
    HOT,
    Breed,
    Effort,
    as_row,
    bred,
    mean_reward,
    nearest_places,
    through_some,
)
from planner.fleet.prizes.problem import Gathered
from planner.progress import Stop, never

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

EFFORT = Effort(pool=8, first_steps=400, child_steps=100, children=80)
#: Strings taken out are this long at most.
LONGEST = 10
#: What the way of the budget left over is worth, in rewards of a first route, which takes so many steps.
PER_WAY, FIRST = 0.3, 50
#: The same but for the last digits.
SAME = 1e-9


@dataclass(frozen=True, slots=True)
class Choices:
    """Places with rewards, each passed in one of several ways.

    Parameters
    ----------
    costs
        Shape (P, P, H, H): from each place left in each way to each met in each, inf where there is none. The
        first place is the start, the last the end.
    rewards
        Shape (P,), each counted once.
    budget
        What the route may cost.
    """

    costs: Floats
    rewards: Floats
    budget: float

    def __post_init__(self) -> None:
        places = len(self.rewards)
        ways = self.costs.shape[-1]
        if self.costs.shape != (places, places, ways, ways) or places < 2 or ways < 1:
            raise ValueError(f"costs are {self.costs.shape}, there are {places} places")
        if np.isnan(self.costs).any() or not np.isfinite(self.rewards).all():
            raise ValueError("costs and rewards are numbers")
        object.__setattr__(self, "costs", np.ascontiguousarray(self.costs, dtype=np.float64))
        object.__setattr__(self, "rewards", np.ascontiguousarray(self.rewards, dtype=np.float64))

    @property
    def least(self) -> Floats:
        """The least cost from each place to each, shape (P, P)."""
        least: Floats = self.costs.min(axis=(2, 3))
        return least

    def ways(self, order: tuple[int, ...]) -> tuple[int, ...]:
        """In which way each place of a route is passed where the whole is cheapest."""
        return tuple(int(way) for way in cheapest_ways(self.costs, np.array(order, dtype=np.int64)))

    def cost(self, order: tuple[int, ...]) -> float:
        """Of a route in the cheapest ways."""
        ways = self.ways(order)
        steps = zip(order[:-1], order[1:], ways[:-1], ways[1:], strict=True)
        return float(sum(self.costs[step] for step in steps))


class Flown:
    """What routes truly take, where that is less than the costs between ways say; asked once for each."""

    def __init__(self, length: Callable[[tuple[int, ...]], float], shares: tuple[float, ...]) -> None:
        self.length = length
        #: Budgets of pools, one after the other, as parts of the true one.
        self.shares = shares


def best_choice(
    choices: Choices,
    seed: int,
    *,
    pools: int | None = 1,
    threads: int = 1,
    stop: Stop = never,
    flown: Flown | None = None,
    effort: Effort = EFFORT,
) -> Gathered:
    """The route of most reward found, the shorter of two that bring as much.

    Parameters
    ----------
    flown
        Routes somewhat over the budget are sought, too, and count where what they truly take is within it;
        the cost of what is found is then the true one.
    effort
        What a pool takes.

    Others are those of ``pools.bred``.

    Raises
    ------
    ValueError
        Where the way from start to end is over the budget.
    """
    least = choices.least
    if least[0, -1] > choices.budget:
        raise ValueError("the way from start to end is over the budget")
    breed = ChoiceBreed(
        choices,
        least,
        nearest_places(least),
        mean_reward(choices.rewards),
        0.0,
        choices.budget,
        flown,
        effort,
    )
    home = (0, len(choices.rewards) - 1)
    some = breed.annealed(as_row(home, len(choices.rewards)), 2, FIRST, HOT, seeded(seed))
    if flown is not None:
        some = replace(some, cost=min(some.cost, flown.length(some.order)))
    if choices.budget > 0.0:
        breed = replace(breed, per_way=PER_WAY * some.reward / choices.budget)
    enough = float(choices.rewards.sum())
    return bred(breed, some, seed, pools=pools, threads=threads, enough=enough, stop=stop)


@dataclass(frozen=True, slots=True)
class ChoiceBreed:
    """One problem as the kernels take it; ``budget`` is that of the pool at hand."""

    choices: Choices
    least: Floats
    near: Ints
    mean: float
    per_way: float
    budget: float
    flown: Flown | None
    effort: Effort

    def annealed(self, order: Ints, size: int, steps: int, hot: float, state: State) -> Gathered:
        """The best route seen on the way from one."""
        best = order.copy()
        size, reward, cost = anneal_ways(
            self.choices.costs, self.least, self.near, self.choices.rewards, self.budget, order, size, best,
            state, steps, hot * self.mean, COLD * self.mean, self.per_way, LONGEST,
        )  # fmt: skip
        return Gathered(tuple(int(place) for place in best[:size]), reward, cost)

    def first(self, state: State) -> tuple[Ints, int]:
        """From the start through some places at random to the end."""
        return through_some(self.least, self.budget, state)

    def child(self, one: Gathered, other: Gathered, state: State) -> tuple[Ints, int]:
        """A route of two; over the budget, perhaps, as it is judged by least costs."""
        row = np.zeros(len(self.choices.rewards), dtype=np.int64)
        parents = (np.array(one.order), len(one.order), np.array(other.order), len(other.order))
        return row, crossed(self.least, self.choices.rewards, self.budget, *parents, state, row)

    def confirmed(self, found: Gathered, best: Gathered) -> Gathered:
        """The better of two, by what the route truly takes."""
        if found.reward < best.reward or found.order == best.order:
            return best
        if self.flown is not None:
            found = replace(found, cost=min(found.cost, self.flown.length(found.order)))
        fits = found.cost <= self.choices.budget + SAME
        return found if fits and found.better_than(best) else best

    def pool(self, number: int) -> Breed:
        """Pools take the budgets that may turn out to be kept, one after the other."""
        if self.flown is None:
            return self
        share = self.flown.shares[number % len(self.flown.shares)]
        return replace(self, budget=share * self.choices.budget)
