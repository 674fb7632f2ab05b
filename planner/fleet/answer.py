"""From what a search found to the answer."""

from __future__ import annotations

from planner.fleet.assignment import Trip
from planner.fleet.auto.build import ENDLESS, doings
from planner.fleet.auto.search import Found
from planner.fleet.problem import Problem
from planner.fleet.schedule import Stop, fly


def trips_of(problem: Problem, found: Found) -> tuple[Trip, ...]:
    """The trips found, flown by the plain measure.

    Raises
    ------
    ValueError
        When one breaks a limit there: the search and the measure disagree.
    """
    bases, nodes = len(problem.bases), doings(problem)
    trips: list[Trip] = []
    ready: dict[int, float] = {}
    for member, order in zip(found.members, found.routes, strict=True):
        if len(order) == 2:
            continue
        stops = []
        for node in order[1:-1]:
            doing = nodes[node - bases]
            until = float(found.late[node])
            window = (float(found.early[node]), until if until < ENDLESS else float("inf"))
            stops.append(Stop(doing.target, doing.alternative, doing.number, window))
        aircraft = problem.members[member]
        trip, excesses = fly(
            problem, member, (order[0], order[-1]), stops, ready.get(member, aircraft.ready_s)
        )
        if excesses:
            raise ValueError(f"{aircraft.name}: a trip was found that breaks {excesses}")
        ready[member] = trip.landing_s + aircraft.turnaround_s
        trips.append(trip)
    return tuple(trips)
