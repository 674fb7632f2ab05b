"""Pools of annealed routes that are crossed with each other.

After G. Kobeaga, M. Merino, J. A. Lozano, "An efficient evolutionary algorithm for the orienteering problem",
Computers & Operations Research 90 (2018) in outline: a pool, children of two of it, local search on each.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from planner.fleet.prizes.draw_kernels import State, draw, seeded
from planner.fleet.prizes.problem import Gathered
from planner.progress import Stop, never

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: First routes go through up to so many places drawn at random, where those take no more of the budget.
THROUGH, SHARE, TRIES = 4, 0.8, 30
#: Heat of the first routes, of children, and at the end, in mean rewards.
HOT, WARM, COLD = 0.1, 0.05, 0.02
#: Moves are sought among so many nearest places.
NEAR = 40


@dataclass(frozen=True, slots=True)
class Effort:
    """Routes in a pool, steps of annealing for each of the first and for each child, children of a pool."""

    pool: int
    first_steps: int
    child_steps: int
    children: int


class Breed(Protocol):
    """Routes of one problem, made and improved. A row is an order of places with room for all of them."""

    @property
    def effort(self) -> Effort:
        """What a pool takes."""

    def first(self, state: State) -> tuple[Ints, int]:
        """A route to begin with, and its size."""

    def child(self, one: Gathered, other: Gathered, state: State) -> tuple[Ints, int]:
        """A route of two."""

    def annealed(self, order: Ints, size: int, steps: int, hot: float, state: State) -> Gathered:
        """The best route seen on the way from one; heat in mean rewards, ``COLD`` at the end."""

    def confirmed(self, found: Gathered, best: Gathered) -> Gathered:
        """The better of two, where what was found is what it seems to be."""

    def pool(self, number: int) -> Breed:
        """How the pool of a number is bred."""


def bred(
    breed: Breed,
    start: Gathered,
    seed: int,
    *,
    pools: int | None,
    threads: int,
    enough: float,
    stop: Stop = never,
) -> Gathered:
    """The best route found.

    Parameters
    ----------
    start
        A route to be bettered.
    pools
        Of each thread, one after the other; None goes on until ``stop`` says so.
    threads
        Each with random numbers of its own. The answer depends on how many there are, not on which is first.
    enough
        Reward that cannot be bettered.
    """
    work = partial(_pools, breed, start, seed, pools, enough, stop)
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


def _pools(
    breed: Breed, best: Gathered, seed: int, pools: int | None, enough: float, stop: Stop, stream: int
) -> Gathered:
    """What one thread finds."""
    state = seeded(seed, stream)
    for number in itertools.count() if pools is None else range(pools):
        for found in _pool(breed.pool(number), state):
            best = breed.confirmed(found, best)
            if stop():
                return best
        if best.reward >= enough:
            break
    return best


def _pool(breed: Breed, state: State) -> Iterator[Gathered]:
    """Routes of one pool as they are found."""
    pool: list[Gathered] = []
    effort = breed.effort
    for _ in range(effort.pool):
        pool.append(breed.annealed(*breed.first(state), effort.first_steps, HOT, state))
        yield pool[-1]
    for _ in range(effort.children):
        one = int(draw(state) * effort.pool)
        other = (one + 1 + int(draw(state) * (effort.pool - 1))) % effort.pool
        row = breed.child(pool[one], pool[other], state)
        born = breed.annealed(*row, effort.child_steps, WARM, state)
        yield born
        # Two of one reward and one way are one route: a pool of copies has no children.
        if any((born.reward, born.cost) == (each.reward, each.cost) for each in pool):
            continue
        worst = min(range(effort.pool), key=lambda k: (pool[k].reward, -pool[k].cost))
        if born.better_than(pool[worst]):
            pool[worst] = born


def through_some(costs: Floats, budget: float, state: State) -> tuple[Ints, int]:
    """From the start through some places at random to the end."""
    last = len(costs) - 1
    for _ in range(TRIES if last > 1 else 0):
        drawn = [1 + int(draw(state) * (last - 1)) for _ in range(1 + int(draw(state) * THROUGH))]
        order = np.array((0, *dict.fromkeys(drawn), last))
        if costs[order[:-1], order[1:]].sum() <= SHARE * budget:
            return as_row(tuple(order), last + 1), len(order)
    return as_row((0, last), last + 1), 2


def as_row(order: tuple[int, ...], places: int) -> Ints:
    """An order with room for all places."""
    row = np.zeros(places, dtype=np.int64)
    row[: len(order)] = order
    return row


def mean_reward(rewards: Floats) -> float:
    """Of the places that bring some; 1 where none does."""
    positive = rewards[rewards > 0.0]
    return float(positive.mean()) if len(positive) else 1.0


def nearest_places(costs: Floats) -> Ints:
    """The nearest other places of each, nearest first."""
    away = costs.copy()
    np.fill_diagonal(away, np.inf)
    kept = min(NEAR, len(costs) - 1)
    return np.ascontiguousarray(np.argsort(away, axis=1, kind="stable")[:, :kept])
