"""The times of trips whose order is given, and by how much they break what limits: the plain measure.

A trip lands as early as it can and then takes off as late as that landing allows (Savelsbergh 1992: of all
take-offs this one spends the least time in the air), for waiting costs nothing but in the air.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from planner.fleet.assignment import Limit, Trip, Visit
from planner.fleet.problem import FloatArray, Problem

TOLERANCE_S = 1e-6


@dataclass(frozen=True, slots=True)
class Stop:
    """One visit in an order; ``window_s`` is the target's, or what siblings leave of it."""

    target: int
    alternative: int
    number: int
    window_s: tuple[float, float]


@dataclass(frozen=True, slots=True)
class Excess:
    """By how much a trip breaks one limit; ``stop`` counts the stops, None where the whole trip does."""

    limit: Limit
    margin: float
    unit: str
    stop: int | None = None


def stop_at(problem: Problem, target: int, alternative: int, number: int = 0) -> Stop:
    """A stop with the target's own window."""
    return Stop(target, alternative, number, problem.targets[target].window_s or (0.0, math.inf))


def fly(
    problem: Problem, member: int, bases: tuple[int, int], stops: Sequence[Stop], ready_s: float
) -> tuple[Trip, tuple[Excess, ...]]:
    """The trip of an aircraft from base to base in this order, ready to take off at ``ready_s``.

    Returns
    -------
    The trip and what it breaks; where something cannot be flown at all, times are infinite.
    """
    aircraft = problem.members[member]
    nodes = [bases[0], *(problem.node(stop.target, stop.alternative) for stop in stops), bases[1]]
    services = [
        problem.targets[stop.target].alternatives[stop.alternative].services[member] for stop in stops
    ]
    if None in services:
        unable = services.index(None)
        return _grounded(member, bases), (Excess("sensor", math.inf, "", unable),)
    taken = [service.service_s for service in services if service is not None]
    legs_s = [float(aircraft.travel.seconds[a, b]) for a, b in itertools.pairwise(nodes)]
    if not math.isfinite(sum(legs_s)):
        broken = next(i for i, leg in enumerate(legs_s) if not math.isfinite(leg))
        return _grounded(member, bases), (Excess("reach", math.inf, "", min(broken, len(stops) - 1)),)
    late: list[Excess] = []
    start_s, slack_s = ready_s, math.inf
    now_s, delays, waited_s = ready_s, [], 0.0
    for number, (stop, service_s, leg_s) in enumerate(zip(stops, taken, legs_s, strict=False)):
        arrival_s = now_s + leg_s
        begin_s = max(arrival_s, stop.window_s[0])
        waited_s += begin_s - arrival_s
        slack_s = min(slack_s, stop.window_s[1] - service_s - begin_s + waited_s)
        now_s = begin_s + service_s
        if now_s > stop.window_s[1] + TOLERANCE_S:
            late.append(Excess("window", now_s - stop.window_s[1], "s", number))
        delays.append(begin_s)
    landing_s = now_s + legs_s[-1]
    start_s = ready_s + max(0.0, min(slack_s, waited_s))
    visits, now_s = [], start_s
    for stop, service_s, leg_s in zip(stops, taken, legs_s, strict=False):
        arrival_s = now_s + leg_s
        begin_s = max(arrival_s, stop.window_s[0])
        now_s = begin_s + service_s
        visits.append(
            Visit(stop.target, stop.alternative, stop.number, arrival_s, begin_s - arrival_s, begin_s, now_s)
        )
    waiting_wh = sum(visit.wait_s for visit in visits) * aircraft.waiting_w / 3600.0
    own = [service for service in services if service is not None]
    trip = Trip(
        member,
        *bases,
        start_s,
        landing_s,
        tuple(visits),
        along(aircraft.travel.length_m, nodes) + sum(each.length_m for each in own),
        along(aircraft.travel.energy_wh, nodes) + sum(each.energy_wh for each in own) + waiting_wh,
        along(aircraft.travel.risk, nodes) + sum(each.risk for each in own),
    )
    over: list[tuple[Limit, float, str]] = [
        ("shift", landing_s - aircraft.ready_s - aircraft.shift_s, "s"),
        ("flight-time", trip.duration_s - aircraft.max_flight_s, "s"),
        ("range", trip.length_m - aircraft.range_m, "m"),
        ("energy", trip.energy_wh - aircraft.energy_wh, "Wh"),
    ]
    return trip, (*late, *(Excess(*each) for each in over if each[1] > TOLERANCE_S))


def along(values: FloatArray | None, nodes: Sequence[int]) -> float:
    """The sum of a travel matrix along an order of nodes; 0 without a matrix."""
    if values is None:
        return 0.0
    return float(sum(values[a, b] for a, b in itertools.pairwise(nodes)))


def _grounded(member: int, bases: tuple[int, int]) -> Trip:
    return Trip(member, *bases, math.inf, math.inf, (), math.inf, math.inf, math.inf)


def cost_of(problem: Problem, trips: Sequence[Trip]) -> float:
    """The objective of these trips: term by term as ``Objective`` says."""
    weights = problem.objective
    return (
        weights.last_landing * max((trip.landing_s for trip in trips), default=0.0)
        + weights.total_time * sum(trip.duration_s for trip in trips)
        + weights.travel_time * sum(trip.duration_s - _waited_s(trip) for trip in trips)
        + weights.risk * sum(trip.risk for trip in trips)
        - worth_of(problem, trips)
    )


def worth_of(problem: Problem, trips: Sequence[Trip]) -> float:
    """What the targets that trips do are worth in the objective."""
    return problem.objective.priority * sum(
        problem.targets[visit.target].priority / problem.targets[visit.target].visits
        for trip in trips
        for visit in trip.visits
    )


def worth_of_all(problem: Problem) -> float:
    """What all targets together are worth in the objective."""
    return problem.objective.priority * sum(target.priority for target in problem.targets)


def _waited_s(trip: Trip) -> float:
    return sum(visit.wait_s for visit in trip.visits)


def broken(problem: Problem, trips: Sequence[Trip]) -> tuple[str, ...]:
    """What a whole answer breaks, in words: each trip flown anew, turnarounds, exclusion, revisits."""
    found: list[str] = []
    by_member: dict[int, list[Trip]] = {}
    for trip in trips:
        by_member.setdefault(trip.member, []).append(trip)
    for member, own in by_member.items():
        found += _broken_of(problem, member, sorted(own, key=lambda trip: trip.take_off_s))
    done: dict[int, list[Visit]] = {}
    for trip in trips:
        for visit in trip.visits:
            done.setdefault(visit.target, []).append(visit)
    return (*found, *_apart(problem, done))


def _broken_of(problem: Problem, member: int, trips: Sequence[Trip]) -> list[str]:
    aircraft = problem.members[member]
    found = [f"{aircraft.name}: {len(trips)} trips, not {aircraft.trips}"] * (len(trips) > aircraft.trips)
    base, ready_s = aircraft.start_base, aircraft.ready_s
    for trip in trips:
        # A visit may wait for its turn after another of its target: no start is moved forward.
        stops = []
        for visit in trip.visits:
            own = stop_at(problem, visit.target, visit.alternative, visit.number)
            stops.append(replace(own, window_s=(max(own.window_s[0], visit.start_s), own.window_s[1])))
        flown, excesses = fly(problem, member, (trip.start_base, trip.end_base), stops, trip.take_off_s)
        found += [f"{aircraft.name}: {excess.limit} by {excess.margin:.6g}" for excess in excesses]
        if trip.start_base != base or trip.end_base not in aircraft.end_bases:
            found.append(f"{aircraft.name}: flies from {trip.start_base} to {trip.end_base}")
        if trip.take_off_s < ready_s - TOLERANCE_S or abs(flown.landing_s - trip.landing_s) > 1e-3:
            found.append(f"{aircraft.name}: takes off at {trip.take_off_s}, ready at {ready_s}")
        base, ready_s = trip.end_base, trip.landing_s + aircraft.turnaround_s
    return found


def _apart(problem: Problem, done: Mapping[int, Sequence[Visit]]) -> list[str]:
    found: list[str] = []
    for number, visits in done.items():
        target = problem.targets[number]
        in_time = sorted(visits, key=lambda visit: visit.start_s)
        if len(visits) > target.visits:
            found.append(f"{target.name}: done {len(visits)} times, not {target.visits}")
        for former, latter in itertools.pairwise(in_time):
            if latter.start_s - former.end_s < target.revisit_after_s - 1e-3:
                found.append(f"{target.name}: again after {latter.start_s - former.end_s:.6g} s")
    return found
