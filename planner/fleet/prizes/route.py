"""The route of most reward within a budget, where each place is passed in one way."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

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
from planner.fleet.prizes.problem import Gathered, Prizes
from planner.fleet.prizes.route_kernels import anneal
from planner.progress import Stop, never

Ints = NDArray[np.int64]

EFFORT = Effort(pool=12, first_steps=1500, child_steps=300, children=150)
#: Strings taken out are this long at most.
LONGEST = 10
#: What the way of the budget left over is worth, in rewards of a first route, which takes so many steps.
PER_WAY, FIRST = 0.3, 100


def best_route(
    prizes: Prizes, seed: int, *, pools: int | None = 1, threads: int = 1, stop: Stop = never
) -> Gathered:
    """The route of most reward found, the shorter of two that bring as much.

    Parameters are those of ``pools.bred``.

    Raises
    ------
    ValueError
        Where the way from start to end is over the budget.
    """
    if prizes.costs[0, -1] > prizes.budget:
        raise ValueError("the way from start to end is over the budget")
    breed = RouteBreed(
        prizes,
        nearest_places(prizes.costs),
        bool(np.array_equal(prizes.costs, prizes.costs.T)),
        mean_reward(prizes.rewards),
        0.0,
    )
    home = (0, len(prizes.rewards) - 1)
    some = breed.annealed(as_row(home, len(prizes.rewards)), 2, FIRST, HOT, seeded(seed))
    if prizes.budget > 0.0:
        breed = replace(breed, per_way=PER_WAY * some.reward / prizes.budget)
    enough = float(prizes.rewards.sum())
    return bred(breed, some, seed, pools=pools, threads=threads, enough=enough, stop=stop)


@dataclass(frozen=True, slots=True)
class RouteBreed:
    """One problem as the kernels take it."""

    prizes: Prizes
    near: Ints
    symmetric: bool
    mean: float
    per_way: float

    @property
    def effort(self) -> Effort:
        """What a pool takes."""
        return EFFORT

    def annealed(self, order: Ints, size: int, steps: int, hot: float, state: State) -> Gathered:
        """The best route seen on the way from one."""
        prizes, best = self.prizes, order.copy()
        heats = (hot * self.mean, COLD * self.mean)
        _, size = anneal(
            prizes.costs, self.near, prizes.rewards, prizes.budget, self.symmetric, order, size, best, size,
            state, steps, *heats, self.per_way, LONGEST,
        )  # fmt: skip
        taken = tuple(int(place) for place in best[:size])
        return Gathered(taken, prizes.reward(taken), prizes.cost(taken))

    def first(self, state: State) -> tuple[Ints, int]:
        """From the start through some places at random to the end."""
        return through_some(self.prizes.costs, self.prizes.budget, state)

    def child(self, one: Gathered, other: Gathered, state: State) -> tuple[Ints, int]:
        """A route of two."""
        prizes = self.prizes
        row = np.zeros(len(prizes.rewards), dtype=np.int64)
        parents = (np.array(one.order), len(one.order), np.array(other.order), len(other.order))
        return row, crossed(prizes.costs, prizes.rewards, prizes.budget, *parents, state, row)

    def confirmed(self, found: Gathered, best: Gathered) -> Gathered:
        """The better of two."""
        return found if found.better_than(best) else best

    def pool(self, number: int) -> Breed:
        """All pools are alike."""
        return self
