"""An order that was flown before, kept: what is new is put in where it costs least, nothing else moves."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from planner.fleet.assignment import Assignment, Status, Trip
from planner.fleet.left_out import left_out_of
from planner.fleet.problem import Problem
from planner.fleet.schedule import cost_of, fly, stop_at

#: With more that is new, hardly anything is kept, and putting it in would take long.
MOST_NEW = 10


def kept(problem: Problem, orders: Mapping[int, Sequence[int]]) -> Assignment | None:
    """The assignment whose trips do their targets in the order given.

    Parameters
    ----------
    orders
        Targets in flight order by member, each once; the others are new.

    Returns
    -------
    None where there is none within the limits, more than ``MOST_NEW`` are new, or members make several trips.
    """
    if any(each.trips > 1 for each in problem.members) or any(each.visits > 1 for each in problem.targets):
        return None
    old = {target for order in orders.values() for target in order}
    new = [number for number in range(len(problem.targets)) if number not in old]
    if not old or len(new) > MOST_NEW:
        return None
    routes = {member: list(orders.get(member, ())) for member in range(len(problem.members))}
    trips: dict[int, Trip] = {}
    for member, route in routes.items():
        trip = shortest(problem, member, route) if route else None
        if route and trip is None:
            return None
        if trip is not None:
            trips[member] = trip
    for target in new:
        _put_in(problem, routes, trips, target)
    found = tuple(trips[member] for member in sorted(trips))
    left_out = left_out_of(problem, found)
    status: Status = "infeasible" if any(each.required for each in left_out) else "feasible"
    return Assignment(found, left_out, status, cost_of(problem, found))


def _put_in(problem: Problem, routes: dict[int, list[int]], trips: dict[int, Trip], target: int) -> None:
    """One target more, where it costs least; nowhere if it fits nowhere, or is not worth it."""
    best = math.inf if problem.targets[target].required else cost_of(problem, list(trips.values()))
    place: tuple[int, list[int], Trip] | None = None
    for member, route in routes.items():
        for at in range(len(route) + 1):
            longer = [*route[:at], target, *route[at:]]
            trip = shortest(problem, member, longer)
            if trip is None:
                continue
            cost = cost_of(problem, list((trips | {member: trip}).values()))
            if cost < best:
                best, place = cost, (member, longer, trip)
    if place is not None:
        member, routes[member], trips[member] = place


def shortest(problem: Problem, member: int, order: Sequence[int]) -> Trip | None:
    """The shortest trip of a member by targets in an order, of all ways to do each; None over a limit."""
    aircraft = problem.members[member]
    seconds = aircraft.travel.seconds
    at = np.array([aircraft.start_base])
    so_far_s = np.zeros(1)
    picked: list[NDArray[np.int64]] = []
    for target in order:
        own = problem.targets[target].alternatives
        nodes = np.array([problem.node(target, way) for way in range(len(own))])
        services = [each.services[member] for each in own]
        takes_s = np.array([math.inf if each is None else each.service_s for each in services])
        reached_s = so_far_s[:, None] + seconds[np.ix_(at, nodes)] + takes_s[None, :]
        picked.append(reached_s.argmin(axis=0))
        at, so_far_s = nodes, reached_s.min(axis=0)
    home_s = so_far_s[:, None] + seconds[np.ix_(at, np.array(aircraft.end_bases))]
    way, end = np.unravel_index(int(home_s.argmin()), home_s.shape)
    if not math.isfinite(float(home_s[way, end])):
        return None
    ways: list[int] = []
    row = int(way)
    for chosen in reversed(picked):
        ways.append(row)
        row = int(chosen[row])
    stops = [stop_at(problem, target, taken) for target, taken in zip(order, reversed(ways), strict=True)]
    bases = (aircraft.start_base, aircraft.end_bases[int(end)])
    trip, excesses = fly(problem, member, bases, stops, aircraft.ready_s)
    return None if excesses else trip
