"""The route of most reward within a budget: pools of annealed routes that are crossed with each other.

After G. Kobeaga, M. Merino, J. A. Lozano, "An efficient evolutionary algorithm for the orienteering problem",
Computers & Operations Research 90 (2018) in outline: a pool, children of two of it, local search on each.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from planner.fleet.prizes.cross_kernels import crossed
from planner.fleet.prizes.draw_kernels import State, draw, seeded
from planner.fleet.prizes.problem import Gathered, Prizes
from planner.fleet.prizes.route_kernels import anneal
from planner.progress import Stop, never

Ints = NDArray[np.int64]

#: Routes in a pool, steps of annealing for each of the first and for each child, children of a pool.
POOL = 12
FIRST_STEPS, CHILD_STEPS = 1500, 300
CHILDREN = 150
#: First routes go through up to so many places drawn at random, where those take no more of the budget.
THROUGH, SHARE, TRIES = 4, 0.8, 30
#: Strings are taken out, and moves sought, among so many nearest places; strings are this long at most.
NEAR, LONGEST = 40, 10
#: Heat of the first routes, of children, and at the end, in mean rewards.
HOT, WARM, COLD = 0.1, 0.05, 0.02
#: What the way of the budget left over is worth, in all rewards.
PER_WAY = 0.3


def best_route(
    prizes: Prizes, seed: int, *, pools: int | None = 1, threads: int = 1, stop: Stop = never
) -> Gathered:
    """The route of most reward found, the shorter of two that bring as much.

    Parameters
    ----------
    pools
        Of each thread, one after the other; None goes on until ``stop`` says so.
    threads
        Each with random numbers of its own. The answer depends on how many there are, not on which is first.

    Raises
    ------
    ValueError
        Where the way from start to end is over the budget.
    """
    if prizes.costs[0, -1] > prizes.budget:
        raise ValueError("the way from start to end is over the budget")
    work = partial(_pools, _Search.of(prizes, stop), seed, pools)
    if threads == 1:
        return work(0)
    with ThreadPoolExecutor(threads) as pool:
        return best_of(pool.map(work, range(threads)))


def best_of(found: Iterable[Gathered]) -> Gathered:
    """The first of the best."""
    listed = list(found)
    best = listed[0]
    for other in listed[1:]:
        if other.better_than(best):
            best = other
    return best


@dataclass(frozen=True, slots=True)
class _Search:
    """One problem as the kernels take it."""

    prizes: Prizes
    near: Ints
    symmetric: bool
    mean: float
    per_way: float
    stop: Stop

    @staticmethod
    def of(prizes: Prizes, stop: Stop) -> _Search:
        rewards, costs = prizes.rewards, prizes.costs
        positive = rewards[rewards > 0.0]
        mean = float(positive.mean()) if len(positive) else 1.0
        symmetric = bool(np.array_equal(costs, costs.T))
        per_way = PER_WAY * float(rewards.sum()) / prizes.budget if prizes.budget > 0.0 else 0.0
        return _Search(prizes, nearest_places(costs), symmetric, mean, per_way, stop)

    @property
    def last(self) -> int:
        """Index of the end."""
        return len(self.prizes.rewards) - 1

    def annealed(self, order: Ints, size: int, steps: int, hot: float, state: State) -> Gathered:
        """The best route seen on the way from one."""
        prizes, best = self.prizes, order.copy()
        heats = (hot * self.mean, COLD * self.mean)
        _, size = anneal(
            prizes.costs, self.near, prizes.rewards, prizes.budget, self.symmetric, order, size, best, size,
            state, steps, *heats, self.per_way, LONGEST,
        )  # fmt: skip
        return self.gathered(tuple(int(place) for place in best[:size]))

    def first(self, state: State) -> tuple[Ints, int]:
        """From the start through some places at random to the end."""
        prizes, row = self.prizes, np.zeros(self.last + 1, dtype=np.int64)
        for _ in range(TRIES if self.last > 1 else 0):
            drawn = [1 + int(draw(state) * (self.last - 1)) for _ in range(1 + int(draw(state) * THROUGH))]
            order = (0, *dict.fromkeys(drawn), self.last)
            if prizes.cost(order) <= SHARE * prizes.budget:
                row[: len(order)] = order
                return row, len(order)
        row[1] = self.last
        return row, 2

    def child(self, one: Gathered, other: Gathered, state: State) -> tuple[Ints, int]:
        """A route of two."""
        row = np.zeros(self.last + 1, dtype=np.int64)
        rows = (self._row(one), len(one.order), self._row(other), len(other.order))
        prizes = self.prizes
        size = crossed(prizes.costs, prizes.rewards, prizes.budget, *rows, state, row)
        return row, size

    def gathered(self, order: tuple[int, ...]) -> Gathered:
        """A route with what it brings and takes."""
        return Gathered(order, self.prizes.reward(order), self.prizes.cost(order))

    def _row(self, found: Gathered) -> Ints:
        return np.array(found.order, dtype=np.int64)


def _pools(search: _Search, seed: int, pools: int | None, stream: int) -> Gathered:
    """What one thread finds."""
    state = seeded(seed, stream)
    best = search.gathered((0, search.last))
    for _ in itertools.count() if pools is None else range(pools):
        for found in _pool(search, state):
            best = best_of((best, found))
            if search.stop():
                return best
        if best.reward >= search.prizes.rewards.sum():
            break
    return best


def _pool(search: _Search, state: State) -> Iterator[Gathered]:
    """Routes of one pool as they are found."""
    pool: list[Gathered] = []
    for _ in range(POOL):
        pool.append(search.annealed(*search.first(state), FIRST_STEPS, HOT, state))
        yield pool[-1]
    for _ in range(CHILDREN):
        one = int(draw(state) * POOL)
        other = (one + 1 + int(draw(state) * (POOL - 1))) % POOL
        born = search.annealed(*search.child(pool[one], pool[other], state), CHILD_STEPS, WARM, state)
        yield born
        # Two of one reward and one way are one route: a pool of copies has no children.
        if any((born.reward, born.cost) == (each.reward, each.cost) for each in pool):
            continue
        worst = min(range(POOL), key=lambda k: (pool[k].reward, -pool[k].cost))
        if born.better_than(pool[worst]):
            pool[worst] = born


def nearest_places(costs: NDArray[np.float64]) -> Ints:
    """The nearest other places of each, nearest first."""
    away = costs.copy()
    np.fill_diagonal(away, np.inf)
    kept = min(NEAR, len(costs) - 1)
    return np.ascontiguousarray(np.argsort(away, axis=1, kind="stable")[:, :kept])
