"""An assignment made better by what its flights truly take, until none that is close to it is better.

Assignments are proved, or searched for, with estimated times; of several that are nearly as good these tell
no best one, and a tenth of a millimetre in a corner may choose another. So what is close to the one that was
flown is looked at: of few regions all ways to share them out that are estimated to take little more; then a
region flown by another aircraft or at another place, two exchanged, a part of a flight turned round, flights
continued as each other. Those that seem the best are routed, and the best of these flown.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations

from planner.errors import InfeasibleError
from planner.fleet.assignment import Assignment, Trip
from planner.fleet.auto.build import tables
from planner.fleet.exact import Shared, nearly_best
from planner.fleet.kept import shortest
from planner.fleet.problem import Problem
from planner.fleet.schedule import cost_of as estimated
from planner.fleet.schedule import worth_of
from planner.tasks.fleet.barred import BarredError
from planner.tasks.fleet.crews import Crew
from planner.tasks.fleet.flights import thought_s
from planner.tasks.fleet.flown import items_in, over
from planner.tasks.fleet.jobs import Job
from planner.tasks.fleet.placing import Errand, LateError, Sortie, cost_of
from planner.tasks.fleet.problem import Lessons, WaysOf, problem_of
from planner.tasks.task import Controls
from planner.wishes import Objective

#: Of more jobs neighbours are too many.
MOST_JOBS = 20
#: So often a better neighbour is gone to, and of each one's neighbours so many are routed, and flown.
STEPS, ROUTED, FLOWN = 6, 30, 10
#: Estimates of neighbours may be so much over what the best takes, before and after they are routed.
FAR, NEAR = 0.06, 0.05
#: Of ways to share jobs out so many are looked at; half of them or more are the same but for who flies what.
MOST_SHARES = 100
#: A neighbour is better by this part at least.
BETTER = 1e-4


@dataclass(frozen=True, slots=True)
class Hand:
    """How flights of an assignment are made: a trip's errand, and all of them on one clock."""

    errand: Callable[[Trip], Errand]
    placed: Callable[[Sequence[Errand]], tuple[Sortie, ...]]


@dataclass(frozen=True, slots=True)
class Bettered:
    """Better flights, and the assignment that they are of."""

    sorties: tuple[Sortie, ...]
    problem: Problem
    assigned: Assignment


def bettered(
    crews: Sequence[Crew],
    jobs: Sequence[Job],
    ways: WaysOf,
    assigned: Assignment,
    sorties: Sequence[Sortie],
    lessons: Lessons,
    weights: Objective,
    hand: Hand,
    controls: Controls,
) -> Bettered | None:
    """The best that is found from an assignment and its flights; None where nothing better is.

    Parameters
    ----------
    ways, lessons
        By which neighbours are estimated; what flights take besides is learnt anew, for each kind of crew.
    """
    if not _suits(crews, jobs, assigned):
        return None
    orders: list[tuple[int, ...]] = [()] * len(crews)
    for trip in assigned.trips:
        orders[trip.member] = tuple(visit.target for visit in trip.visits)
    begun: Shared = tuple(orders)
    search = _Search(crews, jobs, weights, hand, controls)
    search.learn(ways, lessons, begun, sorties)
    best, flown, cost = begun, tuple(sorties), cost_of(sorties, weights)
    among = search.nearly_best(begun)
    for step in range(STEPS):
        if controls.enough():
            break
        found = search.better(among if step == 0 else _neighbours(best), cost)
        if found is None and step > 0:
            break
        if found is None:
            continue
        best, flown, cost = found
    if best == begun:
        return None
    trips = tuple(trip for trip in search.trips(best) if trip is not None)
    cost = estimated(search.problem, trips)
    bound = min(search.least - worth_of(search.problem, trips), cost) if math.isfinite(search.least) else None
    return Bettered(flown, search.problem, Assignment(trips, assigned.left_out, "feasible", cost, bound))


def _suits(crews: Sequence[Crew], jobs: Sequence[Job], assigned: Assignment) -> bool:
    """Whether each crew flies once from the ground, at any time, and there are few jobs."""
    members = [trip.member for trip in assigned.trips]
    return (
        len(crews) > 1
        and 1 < len(jobs) <= MOST_JOBS
        and len(members) == len(set(members))
        and all(crew.aircraft.aloft is None and len(crew.landings) == 1 for crew in crews)
        and all(job.visits == 1 and job.region.time_window_s is None for job in jobs)
    )


@dataclass(slots=True)
class _Search:
    """What is known of flights, by crew and order."""

    crews: Sequence[Crew]
    jobs: Sequence[Job]
    weights: Objective
    hand: Hand
    controls: Controls
    problem: Problem = field(init=False)
    #: What the best of the same jobs costs by estimates; infinity where it is not known.
    least: float = math.inf
    _trips: dict[tuple[int, tuple[int, ...]], float] = field(default_factory=dict)
    _routed: dict[tuple[int, tuple[int, ...]], float] = field(default_factory=dict)
    _besides_s: list[float] = field(default_factory=list)
    _tried: set[Shared] = field(default_factory=set)

    def learn(self, ways: WaysOf, lessons: Lessons, orders: Shared, sorties: Sequence[Sortie]) -> None:
        """What flights of each kind of crew take besides what is estimated of them, on their mean."""
        plain = replace(lessons, besides_s={})
        self.problem = problem_of(self.crews, self.jobs, ways, self.weights, plain)
        by_crew = {sortie.flown.crew: sortie.flown.duration_s for sortie in sorties}
        told = {m: by_crew[m] - self._estimated_s(m, orders[m]) for m in by_crew}
        routed = {m: by_crew[m] - self._routed_s(m, orders[m]) for m in by_crew}
        self._besides_s = self._of_kinds(routed)
        besides = dict(enumerate(self._of_kinds(told)))
        self.problem = problem_of(
            self.crews, self.jobs, ways, self.weights, replace(lessons, besides_s=besides)
        )
        self._trips.clear()
        self._tried.add(self._same(orders))

    def _of_kinds(self, told: dict[int, float]) -> list[float]:
        """The mean of each crew's kind; of all where none of its kind has flown."""
        found = []
        for crew in self.crews:
            own = [more_s for m, more_s in told.items() if self.crews[m].kind == crew.kind]
            own = [s for s in own or told.values() if math.isfinite(s)]
            found.append(math.fsum(own) / max(len(own), 1))
        return found

    def nearly_best(self, orders: Shared) -> list[Shared]:
        """All ways to share out what is flown that are estimated to take little more than the best."""
        jobs = sum(1 << number for order in orders for number in order)
        self.least, found = nearly_best(tables(self.problem), jobs, FAR, MOST_SHARES, self.controls.stop)
        return found

    def better(self, among: Iterable[Shared], cost: float) -> tuple[Shared, tuple[Sortie, ...], float] | None:
        """The best of some assignments, of those that seem so, where it costs less than this."""
        near = self._likely(among, self._estimated_s, (1.0 + FAR) * cost, ROUTED)
        near = self._likely(near, self._thought_s, (1.0 + NEAR) * cost, FLOWN)
        best: tuple[Shared, tuple[Sortie, ...], float] | None = None
        for each in near:
            if self.controls.enough():
                break
            self._tried.add(self._same(each))
            sorties = self._flown(each)
            if sorties is None:
                continue
            found = cost_of(sorties, self.weights)
            if found < (1.0 - BETTER) * (cost if best is None else best[2]):
                best = (each, sorties, found)
        return best

    def _likely(
        self,
        among: Iterable[Shared],
        takes_s: Callable[[int, tuple[int, ...]], float],
        least: float,
        most: int,
    ) -> list[Shared]:
        """Those not tried that seem to cost less than this, the cheapest first."""
        costs: dict[Shared, tuple[float, Shared]] = {}
        for orders in among:
            same = self._same(orders)
            if same in self._tried or same in costs:
                continue
            times_s = [takes_s(m, order) for m, order in enumerate(orders) if order]
            cost = self.weights.last_landing * max(times_s) + self.weights.total_time * math.fsum(times_s)
            if cost < least:
                costs[same] = (cost, orders)
        # Costs by the millisecond: what is as dear comes in the order of its jobs.
        ranked = sorted(costs.items(), key=lambda item: (round(item[1][0], 3), item[0]))
        return [orders for _, (_, orders) in ranked[:most]]

    def _same(self, orders: Shared) -> Shared:
        """Shared as they are the same among crews of one kind that begin and end at the same places."""
        places: dict[tuple[object, ...], list[int]] = {}
        for m, crew in enumerate(self.crews):
            limits = (crew.aircraft.energy_wh, crew.aircraft.max_range_m, crew.aircraft.max_flight_time_s)
            places.setdefault((crew.kind, crew.ends, limits), []).append(m)
        found = list(orders)
        for own in places.values():
            for m, order in zip(own, sorted(orders[m] for m in own), strict=True):
                found[m] = order
        return tuple(found)

    def _estimated_s(self, member: int, order: tuple[int, ...]) -> float:
        key = (member, order)
        if key not in self._trips:
            trip = shortest(self.problem, member, order)
            self._trips[key] = math.inf if trip is None else trip.duration_s
        return self._trips[key]

    def _thought_s(self, member: int, order: tuple[int, ...]) -> float:
        return self._routed_s(member, order) + self._besides_s[member]

    def _routed_s(self, member: int, order: tuple[int, ...]) -> float:
        key = (member, order)
        if key not in self._routed:
            with self.controls.stage("routing"):
                self._routed[key] = thought_s(self.crews[member], [(self.jobs[n], 0) for n in order])
        return self._routed[key]

    def trips(self, orders: Shared) -> list[Trip | None]:
        """The flights of an assignment as they are estimated; None for one over a limit."""
        return [shortest(self.problem, m, order) for m, order in enumerate(orders) if order]

    def _flown(self, orders: Shared) -> tuple[Sortie, ...] | None:
        """The flights of an assignment on one clock; None where there are none within the limits."""
        trips = self.trips(orders)
        try:
            errands = [self.hand.errand(trip) for trip in trips if trip is not None]
            if len(errands) < len(trips):
                return None
            sorties = self.hand.placed(errands)
        except (BarredError, LateError, InfeasibleError):
            # It is no better, whatever it is: the one that is known can be flown.
            return None
        for sortie in sorties:
            crew = self.crews[sortie.flown.crew]
            if over(crew, sortie.flown) or items_in(crew, sortie.flown) > crew.aircraft.most_items:
                return None
        return sorties


def _neighbours(orders: Shared) -> Iterator[Shared]:
    """Assignments that differ from one by a single move."""
    places = [(m, k) for m, order in enumerate(orders) for k in range(len(order))]
    for m, k in places:
        job, rest = orders[m][k], orders[m][:k] + orders[m][k + 1 :]
        for other, order in enumerate(orders):
            into = rest if other == m else order
            for at in range(len(into) + 1):
                yield _with(orders, {m: rest, other: (*into[:at], job, *into[at:])})
    for (m, k), (other, at) in combinations(places, 2):
        swapped = [list(order) for order in orders]
        swapped[m][k], swapped[other][at] = orders[other][at], orders[m][k]
        yield tuple(tuple(order) for order in swapped)
        if m == other:
            order = orders[m]
            yield _with(orders, {m: order[:k] + order[k : at + 1][::-1] + order[at + 1 :]})
    for m, other in combinations(range(len(orders)), 2):
        one, two = orders[m], orders[other]
        for k in range(len(one) + 1):
            for at in range(len(two) + 1):
                yield _with(orders, {m: one[:k] + two[at:], other: two[:at] + one[k:]})
                yield _with(orders, {m: one[:k] + two[:at][::-1], other: one[k:][::-1] + two[at:]})


def _with(orders: Shared, changed: dict[int, tuple[int, ...]]) -> Shared:
    return tuple(changed.get(m, order) for m, order in enumerate(orders))
