"""Visiting orders against brute force and against each other."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planner.routing import kernels, tour
from planner.routing.tour import order, tour_length_m

Place = tuple[float, float]
COORDINATES = st.floats(-1e4, 1e4)
PLACES = st.tuples(COORDINATES, COORDINATES)


def brute_force_m(places: list[Place], start: Place, end: Place) -> float:
    """Length of the shortest of all orders."""
    return min(
        sum(math.dist(a, b) for a, b in itertools.pairwise([start, *visiting, end]))
        for visiting in itertools.permutations(places)
    )


def random_places(count: int, seed: int) -> list[Place]:
    """Places in a square of 10 km."""
    return [(float(e), float(n)) for e, n in np.random.default_rng(seed).uniform(0.0, 1e4, (count, 2))]


@settings(max_examples=60, deadline=None)
@given(st.lists(PLACES, min_size=1, max_size=6), PLACES, PLACES)
def test_exact_is_the_shortest(places: list[Place], start: Place, end: Place) -> None:
    """Held–Karp finds what trying all orders finds."""
    visiting = order(places, start, end, "exact")
    assert sorted(visiting) == list(range(len(places)))
    assert tour_length_m(places, start, end, visiting) == pytest.approx(
        brute_force_m(places, start, end), abs=1e-6
    )


@settings(max_examples=40, deadline=None)
@given(st.lists(PLACES, min_size=1, max_size=7), PLACES, PLACES, st.integers(0, 9))
def test_improve_leaves_no_better_neighbour(places: list[Place], start: Place, end: Place, seed: int) -> None:
    """After the local search no turning of a stretch and no move of up to three places shortens the tour."""
    points = np.array(places)
    legs_m = np.hypot(*(points[:, None] - points[None]).transpose(2, 0, 1))
    first_m, last_m = np.hypot(*(points - start).T), np.hypot(*(points - end).T)
    found = kernels.improve(legs_m, first_m, last_m, np.random.default_rng(seed).permutation(len(places)))
    assert sorted(found) == list(range(len(places)))
    visiting = [int(k) for k in found]
    length_m = tour_length_m(points, start, end, tuple(visiting))
    count = len(visiting)
    for i, j in itertools.combinations(range(count + 1), 2):
        turned = visiting[:i] + visiting[i:j][::-1] + visiting[j:]
        assert tour_length_m(points, start, end, tuple(turned)) >= length_m - 1e-6
        if j - i <= 3:
            rest = visiting[:i] + visiting[j:]
            for at in range(len(rest) + 1):
                moved = rest[:at] + visiting[i:j] + rest[at:]
                assert tour_length_m(points, start, end, tuple(moved)) >= length_m - 1e-6


@pytest.mark.parametrize("count", [2, 5, 7, 10])
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_genetic_against_exact(count: int, seed: int) -> None:
    """With as many regions as the paper's cases the genetic algorithm finds the shortest order."""
    places = random_places(count, seed)
    ends = ((0.0, 0.0), (1e4, 5e3))
    exact_m = tour_length_m(places, *ends, order(places, *ends, "exact"))
    assert tour_length_m(places, *ends, order(places, *ends, "genetic", seed)) == pytest.approx(exact_m)


def test_genetic_comes_near_with_more_regions() -> None:
    """With 14 regions it is within 5 % of the shortest order."""
    ends = ((0.0, 0.0), (0.0, 0.0))
    for seed in range(3):
        places = random_places(14, 10 + seed)
        exact_m = tour_length_m(places, *ends, order(places, *ends, "exact"))
        assert tour_length_m(places, *ends, order(places, *ends, "genetic", seed)) <= 1.05 * exact_m


def test_genetic_repeats_itself() -> None:
    """The same seed gives the same order, also where it is not the shortest."""
    places = random_places(40, 5)
    found = [order(places, (0.0, 0.0), (1e4, 1e4), "genetic", seed) for seed in (3, 3, 4)]
    assert found[0] == found[1]
    assert found[0] != found[2]
    assert all(sorted(visiting) == list(range(40)) for visiting in found)


def test_many_regions() -> None:
    """Beyond the exact size the local search visits all and beats nearest neighbours."""
    places = random_places(80, 7)
    ends = ((0.0, 0.0), (1e4, 1e4))
    visiting = order(places, *ends)
    assert sorted(visiting) == list(range(80))
    points = np.array(places)
    legs_m = np.hypot(*(points[:, None] - points[None]).transpose(2, 0, 1))
    greedy = tour._nearest_neighbours(legs_m, np.hypot(*(points - ends[0]).T))
    assert tour_length_m(places, *ends, visiting) < tour_length_m(places, *ends, tuple(greedy))


def test_few_regions_and_bad_method() -> None:
    """None and one need no search; an unknown method is refused."""
    assert order(np.empty((0, 2)), (0.0, 0.0), (1.0, 1.0)) == ()
    assert order([(5.0, 5.0)], (0.0, 0.0), (1.0, 1.0), "genetic") == (0,)
    with pytest.raises(ValueError, match="no such method"):
        order(random_places(3, 0), (0.0, 0.0), (1.0, 1.0), "magic")  # type: ignore[arg-type]
