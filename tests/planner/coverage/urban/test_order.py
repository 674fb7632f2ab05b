"""The order of sweeps: ants against a plain twin, HiGHS against all permutations."""

import itertools
import math

import numpy as np
import pytest

from planner.coverage.urban.colony_kernels import colony_tour
from planner.coverage.urban.measures import Sweep
from planner.coverage.urban.order import best_tour, colony, opened, oriented, visiting_order


def table(count: int, seed: int) -> np.ndarray:
    points = np.random.default_rng(seed).uniform(0, 100, (count, 2))
    return np.hypot(*(points[:, None] - points[None]).transpose(2, 0, 1))


def length(distances: np.ndarray, tour: np.ndarray) -> float:
    return float(distances[tour, np.roll(tour, -1)].sum())


def plain_colony(d: np.ndarray, draws: np.ndarray, alpha: float, beta: float, rho: float, k: float, t: float):
    """Equations 3 to 6 as they stand, with lists."""
    m = len(d)
    tau = [[t] * m for _ in range(m)]
    best, best_m = None, math.inf
    for ants in draws:
        tours = []
        for walk in ants:
            allowed = list(range(m))
            at = int(walk[0] * m)
            tour = []
            for step in range(m):
                here = allowed[at]
                tour.append(here)
                allowed[at] = allowed[-1]
                allowed.pop()
                if not allowed:
                    break
                weights = [tau[here][j] ** alpha * (1.0 / d[here, j]) ** beta for j in allowed]
                mark, running, at = walk[step + 1] * sum(weights), 0.0, len(allowed) - 1
                for place, weight in enumerate(weights):
                    running += weight
                    if running > mark:
                        at = place
                        break
            tours.append((sum(d[a, b] for a, b in zip(tour, tour[1:] + tour[:1], strict=True)), tour))
            if tours[-1][0] < best_m:
                best_m, best = tours[-1]
        tau = [[(1 - rho) * value for value in row] for row in tau]
        for total, tour in tours:
            for a, b in zip(tour, tour[1:] + tour[:1], strict=True):
                tau[a][b] += k / total
                tau[b][a] += k / total
    return np.array(best)


def test_ants_walk_as_the_equations_say() -> None:
    """The compiled colony is its plain twin, choice for choice."""
    distances = table(9, 4)
    draws = np.random.default_rng(1).random((6, 5, 9))
    for alpha in (1.0, 0.7):
        found = colony_tour(distances, draws, alpha, 3.0, 0.4, 1.5, 0.2)
        assert found.tolist() == plain_colony(distances, draws, alpha, 3.0, 0.4, 1.5, 0.2).tolist()


def test_both_solvers_find_the_shortest_tour_of_eight() -> None:
    """Of eight points ants and HiGHS find what all permutations find."""
    distances = table(8, 6)
    least = min(length(distances, np.array((0, *rest))) for rest in itertools.permutations(range(1, 8)))
    assert length(distances, colony(distances, 3)) == pytest.approx(least)
    assert length(distances, best_tour(distances, np.arange(8))) == pytest.approx(least)


def test_highs_is_no_worse_than_ants_and_visits_all() -> None:
    """Of sixty points, clustered so that subtours arise, each is visited once and the tour is shorter."""
    rng = np.random.default_rng(9)
    points = np.vstack([rng.normal(centre, 2.0, (10, 2)) for centre in rng.uniform(0, 400, (6, 2))])
    distances = np.hypot(*(points[:, None] - points[None]).transpose(2, 0, 1))
    ants = colony(distances, 0)
    exact = best_tour(distances, ants)
    assert sorted(exact) == sorted(ants) == list(range(60))
    assert length(distances, exact) <= length(distances, ants) + 1e-9


def test_the_same_seed_gives_the_same_order() -> None:
    """Ants are seeded."""
    sweeps = [Sweep((0, 20.0 * k), (50 + k, 20.0 * k)) for k in range(12)]
    assert visiting_order(sweeps, "ants", 5).tolist() == visiting_order(sweeps, "ants", 5).tolist()


def test_a_closed_tour_is_cut_where_the_flight_begins() -> None:
    """The cut, and the way round, are the cheapest of all."""
    rng = np.random.default_rng(7)
    sweeps = [Sweep(tuple(a), tuple(b)) for a, b in rng.uniform(0, 100, (7, 2, 2))]
    start, end, tour = (0.0, 0.0), (100.0, 0.0), np.arange(7)

    def cost(order: list[int]) -> float:
        places = [start, *(sweeps[k].midpoint for k in order), end]
        return sum(math.dist(a, b) for a, b in itertools.pairwise(places))

    every = [list(np.roll(way, k)) for k in range(7) for way in (tour, tour[::-1])]
    assert cost(list(opened(tour, sweeps, start, end))) == pytest.approx(min(map(cost, every)))


def test_sweeps_are_flown_in_the_directions_that_join_them_best() -> None:
    """Directions chosen are the best of all combinations."""
    rng = np.random.default_rng(8)
    sweeps = [Sweep(tuple(a), tuple(b)) for a, b in rng.uniform(0, 100, (6, 2, 2))]
    start, end = (0.0, 0.0), (50.0, 50.0)

    def cost(flown: tuple[Sweep, ...]) -> float:
        exits, entries = [start, *(s.end for s in flown)], [*(s.start for s in flown), end]
        return sum(math.dist(a, b) for a, b in zip(exits, entries, strict=True))

    every = itertools.product(*((s, s.reversed()) for s in sweeps))
    assert cost(oriented(sweeps, start, end)) == pytest.approx(min(map(cost, every)))
