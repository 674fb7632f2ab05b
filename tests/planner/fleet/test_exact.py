"""The proved assignment against every order of every share."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator

import pytest

from benchmarks.fleet_cases import case as problem
from planner.fleet.answer import trips_of
from planner.fleet.assignment import Trip
from planner.fleet.auto.build import tables
from planner.fleet.auto.search import search
from planner.fleet.exact import exact, nearly_best
from planner.fleet.problem import Objective, Problem
from planner.fleet.schedule import broken, cost_of, fly, stop_at
from planner.progress import never

OBJECTIVES = (
    Objective(),
    Objective(last_landing=1.0, total_time=0.01),
    Objective(total_time=0.0, travel_time=1.0, priority=100.0),
    Objective(total_time=0.5, risk=2.0, priority=80.0),
)


def orders(given: Problem) -> Iterator[list[Trip]]:
    """Every way to share targets out, in every order, by every alternative, that keeps the limits."""
    nobody = len(given.members)
    for owners in itertools.product(range(nobody + 1), repeat=len(given.targets)):
        lines: list[list[Trip]] = []
        for member, aircraft in enumerate(given.members):
            own = [target for target, owner in enumerate(owners) if owner == member]
            flown = []
            for order in itertools.permutations(own):
                ways = [range(len(given.targets[target].alternatives)) for target in order]
                for chosen, base in itertools.product(itertools.product(*ways), aircraft.end_bases):
                    stops = [stop_at(given, *pair) for pair in zip(order, chosen, strict=True)]
                    trip, excesses = fly(given, member, (aircraft.start_base, base), stops, 0.0)
                    if not excesses:
                        flown.append(trip)
            lines.append(flown if own else [])
            if own and not flown:
                break
        else:
            yield from (list(trips) for trips in itertools.product(*(line for line in lines if line)))


def least(given: Problem) -> tuple[int, float]:
    """The fewest required targets left out, and the least cost with so few."""

    def worth(trips: list[Trip]) -> tuple[int, float]:
        done = {visit.target for trip in trips for visit in trip.visits}
        missed = sum(target.required for n, target in enumerate(given.targets) if n not in done)
        return missed, cost_of(given, trips)

    return min(map(worth, orders(given)))


@pytest.mark.parametrize("seed", range(8))
def test_no_order_of_any_share_is_better(seed: int) -> None:
    """Enumeration finds nothing below it, whatever is paid for and whatever limits."""
    given = problem(
        seed,
        targets=3,
        bases=1 + seed % 2,
        required=0.5 if seed % 4 > 1 else 1.0,
        objective=OBJECTIVES[seed % 4],
        waiting_w=60.0,
        energy_wh=450.0,
        max_flight_s=1200.0,
    )
    found = exact(tables(given), never)
    assert found is not None
    trips = trips_of(given, found)
    assert broken(given, trips) == ()
    done = {visit.target for trip in trips for visit in trip.visits}
    missed = sum(target.required for n, target in enumerate(given.targets) if n not in done)
    assert (missed, pytest.approx(cost_of(given, trips), abs=1e-6)) == least(given)


@pytest.mark.parametrize("seed", range(8))
def test_the_search_never_beats_it_and_finds_it_on_few_targets(seed: int) -> None:
    """Search and enumeration, which share no step but the times, agree on six targets."""
    given = problem(
        seed, targets=6, required=0.6, objective=OBJECTIVES[seed % 4], waiting_w=60.0, range_m=30_000.0
    )
    known = tables(given)
    best = exact(known, never)
    found = search(known, 1, lambda done: done / 6000, never, lambda _: None)
    assert best is not None
    assert found.cost == pytest.approx(best.cost, rel=1e-9)


@pytest.mark.parametrize("seed", range(4))
def test_nearly_as_good_are_all_that_enumeration_finds(seed: int) -> None:
    """Every way to share three targets out that costs up to a tenth more, each in its best order."""
    given = problem(seed, targets=3, windows=0.0, objective=OBJECTIVES[seed % 2])
    shares: dict[tuple[frozenset[int], ...], float] = {}
    for trips in orders(given):
        own = {trip.member: frozenset(visit.target for visit in trip.visits) for trip in trips}
        if sum(map(len, own.values())) == len(given.targets):
            share = tuple(own.get(member, frozenset()) for member in range(len(given.members)))
            shares[share] = min(shares.get(share, math.inf), cost_of(given, trips))
    cost, found = nearly_best(tables(given), 0b111, 0.1, 100, never)
    assert cost == pytest.approx(min(shares.values()), abs=1e-3)
    expected = {share for share, each in shares.items() if each <= 1.1 * min(shares.values())}
    assert {tuple(frozenset(own) for own in each) for each in found} == expected
