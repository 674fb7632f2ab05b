"""Assignments over what is really flown: legs are measured when used, and all is assigned anew."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass, replace

from planner.errors import OutOfBudgetError
from planner.fleet.assign import assign
from planner.fleet.assignment import Assignment, Trip
from planner.fleet.problem import FloatArray, Member, Problem, Travel
from planner.progress import Progress, Stop, never, raise_if, silent

#: Assignments at most; each measures what the one before did not fly.
ROUNDS = 50


@dataclass(frozen=True, slots=True)
class Leg:
    """What an arc really takes; infinite seconds where it cannot be flown."""

    seconds: float
    length_m: float = 0.0
    energy_wh: float = 0.0
    risk: float = 0.0


#: The leg of an aircraft between two nodes, all three by number.
Measure = Callable[[int, int, int], Leg]


def assign_flyable(
    problem: Problem,
    measure: Measure,
    seed: int = 0,
    stop: Stop = never,
    progress: Progress = silent,
    iterations: int | None = None,
    rounds: int = ROUNDS,
) -> tuple[Assignment, Problem]:
    """The assignment whose every arc was measured, and the problem with what was.

    Travel as given should be no more than what is flown: then an answer over measured arcs that is proved for
    the given ones is proved for the flown ones too.

    Raises
    ------
    CancelledError
        When ``stop`` says so.
    OutOfBudgetError
        When no answer flew over measured arcs alone within the rounds.
    """
    known: dict[tuple[int, int, int], Leg] = {}
    for number in range(rounds):
        raise_if(stop)
        answer = assign(problem, seed, stop, iterations=iterations)
        fresh = [arc for arc in _arcs(problem, answer.trips) if arc not in known]
        if not fresh:
            progress("assign", 1.0)
            return answer, problem
        known |= {arc: measure(*arc) for arc in fresh}
        problem = replace(
            problem,
            members=tuple(_measured(member, at, fresh, known) for at, member in enumerate(problem.members)),
        )
        progress("assign", (number + 1) / rounds)
    raise OutOfBudgetError("fleet: no assignment over measured legs alone within its rounds")


def _arcs(problem: Problem, trips: tuple[Trip, ...]) -> list[tuple[int, int, int]]:
    found: list[tuple[int, int, int]] = []
    for trip in trips:
        inner = [problem.node(visit.target, visit.alternative) for visit in trip.visits]
        nodes = [trip.start_base, *inner, trip.end_base]
        found += [(trip.member, a, b) for a, b in itertools.pairwise(nodes)]
    return found


def _measured(
    member: Member, number: int, arcs: list[tuple[int, int, int]], known: dict[tuple[int, int, int], Leg]
) -> Member:
    own = [arc for arc in arcs if arc[0] == number]
    if not own:
        return member

    def changed(values: FloatArray | None, field: str) -> FloatArray | None:
        if values is None:
            return None
        copied = values.copy()
        for arc in own:
            copied[arc[1], arc[2]] = getattr(known[arc], field)
        return copied

    travel = member.travel
    seconds = changed(travel.seconds, "seconds")
    assert seconds is not None
    return replace(
        member,
        travel=Travel(
            seconds,
            changed(travel.length_m, "length_m"),
            changed(travel.energy_wh, "energy_wh"),
            changed(travel.risk, "risk"),
        ),
    )
