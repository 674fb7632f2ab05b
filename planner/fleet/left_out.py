"""Why a target is not done, and by how much what binds would have to give."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from planner.fleet.assignment import LeftOut, Limit, Trip
from planner.fleet.problem import Problem, Target
from planner.fleet.schedule import Excess, Stop, fly, stop_at

_FIXES: dict[Limit, str] = {
    "sensor": "Give an aircraft a sensor that meets what the target asks for, or ask for less.",
    "reach": "Move the target or a base, or open what is closed between them.",
    "window": "Let its window close {margin} later.",
    "shift": "Lengthen the shift of {aircraft} by {margin}.",
    "flight-time": "Give {aircraft} {margin} more time in the air.",
    "range": "Give {aircraft} {margin} more range.",
    "energy": "Give {aircraft} {margin} more energy, or a base nearer by.",
    "revisit": "Ask for fewer visits, or nearer to each other, or give it a longer window.",
    "not-worth": "Give it more priority, or require it.",
}


def left_out_of(problem: Problem, trips: Sequence[Trip]) -> tuple[LeftOut, ...]:
    """What these trips do not do, by target: the nearest limit, its margin, the nearest relaxation."""
    done: dict[int, int] = {}
    for trip in trips:
        for visit in trip.visits:
            done[visit.target] = done.get(visit.target, 0) + 1
    return tuple(
        _why(problem, trips, number, target)
        for number, target in enumerate(problem.targets)
        if done.get(number, 0) < target.visits
    )


def _why(problem: Problem, trips: Sequence[Trip], number: int, target: Target) -> LeftOut:
    nearest: tuple[float, Excess, str] | None = None
    for member, excesses in _tries(problem, trips, number):
        aircraft = problem.members[member]
        if not excesses:
            nearest = (0.0, Excess("not-worth", 0.0, ""), aircraft.name)
            break
        size = max(_size(problem, member, target, excess) for excess in excesses) + len(excesses) - 1
        worst = max(excesses, key=lambda excess: _size(problem, member, target, excess))
        if nearest is None or size < nearest[0]:
            nearest = (size, worst, aircraft.name)
    if nearest is None:
        nearest = (math.inf, Excess("sensor", math.inf, ""), "")
    _, excess, name = nearest
    limit = excess.limit
    if limit == "not-worth" and target.visits > 1 and target.revisit_after_s > 0.0:
        limit = "revisit"
    margin = f"{excess.margin:.6g} {excess.unit}".strip()
    of_aircraft = limit in ("shift", "flight-time", "range", "energy")
    message = {
        "sensor": f"no aircraft can fly any of the ways to do {target.name}",
        "reach": f"no aircraft can fly to {target.name} and home",
        "window": f"the window of {target.name} closes {margin} before it can be done",
        "revisit": f"the visits of {target.name} do not fit {target.revisit_after_s:.6g} s apart",
        "not-worth": f"{target.name} costs more than it is worth",
    }.get(limit, f"{target.name} takes {margin} more than the {limit} of {name} allows")
    return LeftOut(
        number,
        target.name,
        target.required,
        limit,
        excess.margin,
        excess.unit,
        name if of_aircraft else "",
        message,
        _FIXES[limit].format(margin=margin, aircraft=name),
    )


def _size(problem: Problem, member: int, target: Target, excess: Excess) -> float:
    """A margin as a part of its limit, so that seconds and watt-hours compare."""
    aircraft = problem.members[member]
    whole = {
        "window": max(60.0, (target.window_s or (0.0, math.inf))[1]),
        "shift": aircraft.shift_s,
        "flight-time": aircraft.max_flight_s,
        "range": aircraft.range_m,
        "energy": aircraft.energy_wh,
    }.get(excess.limit, 1.0)
    return excess.margin / max(whole, 1e-9) if math.isfinite(excess.margin) else math.inf


def _tries(problem: Problem, trips: Sequence[Trip], number: int) -> Iterator[tuple[int, tuple[Excess, ...]]]:
    """What each way to put the target into a trip, or into one of its own, breaks."""
    target = problem.targets[number]
    for member, aircraft in enumerate(problem.members):
        own = sorted((t for t in trips if t.member == member), key=lambda trip: trip.take_off_s)
        for way in range(len(target.alternatives)):
            if target.alternatives[way].services[member] is None:
                continue
            stop = stop_at(problem, number, way)
            ready_s = aircraft.ready_s
            for at, trip in enumerate(own):
                latest_s = own[at + 1].take_off_s - aircraft.turnaround_s if at + 1 < len(own) else math.inf
                yield from _inserted(problem, trip, stop, ready_s, latest_s)
                ready_s = trip.landing_s + aircraft.turnaround_s
            if len(own) < aircraft.trips:
                start = own[-1].end_base if own else aircraft.start_base
                for base in aircraft.end_bases:
                    yield member, fly(problem, member, (start, base), [stop], ready_s)[1]


def _inserted(
    problem: Problem, trip: Trip, stop: Stop, ready_s: float, latest_s: float
) -> Iterator[tuple[int, tuple[Excess, ...]]]:
    stops = [stop_at(problem, visit.target, visit.alternative, visit.number) for visit in trip.visits]
    for place in range(len(stops) + 1):
        tried = [*stops[:place], stop, *stops[place:]]
        flown, excesses = fly(problem, trip.member, (trip.start_base, trip.end_base), tried, ready_s)
        if flown.landing_s > latest_s:
            excesses = (*excesses, Excess("shift", flown.landing_s - latest_s, "s"))
        yield trip.member, excesses
