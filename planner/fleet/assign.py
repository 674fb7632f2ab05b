"""``auto``: who does what, when."""

from __future__ import annotations

import math
from collections.abc import Sequence

from planner.fleet.assignment import Assignment, LeftOut, Status, Trip
from planner.fleet.problem import Problem
from planner.fleet.schedule import Excess, Stop, cost_of, fly, stop_at
from planner.progress import Progress, never, raise_if, silent
from planner.progress import Stop as Stopped


def assign(problem: Problem, seed: int = 0, stop: Stopped = never, progress: Progress = silent) -> Assignment:
    """The best assignment found.

    Parameters
    ----------
    problem
        What is to be done and by whom.
    seed
        The same seed gives the same answer.
    stop, progress
        To be asked between steps, and told.

    Raises
    ------
    CancelledError
        When ``stop`` says so.
    """
    orders: list[list[Stop]] = [[] for _ in problem.members]
    waiting = sorted(
        range(len(problem.targets)),
        key=lambda number: (not problem.targets[number].required, -problem.targets[number].priority),
    )
    left: list[int] = []
    for done, target in enumerate(waiting):
        raise_if(stop)
        if not _insert(problem, orders, target):
            left.append(target)
        progress("assign", (done + 1) / len(waiting))
    trips = [
        trip for member, order in enumerate(orders) if order for trip in [_best(problem, member, order)[0]]
    ]
    left_out = tuple(
        LeftOut(
            target,
            problem.targets[target].name,
            problem.targets[target].required,
            "reach",
            math.inf,
            "",
            "",
            f"{problem.targets[target].name} does not fit into any trip",
            "Allow more aircraft or more time.",
        )
        for target in sorted(left)
    )
    status: Status = "infeasible" if any(each.required for each in left_out) else "feasible"
    return Assignment(tuple(trips), left_out, status, cost_of(problem, trips))


def _best(problem: Problem, member: int, order: Sequence[Stop]) -> tuple[Trip, tuple[Excess, ...]]:
    aircraft = problem.members[member]
    flown = [
        fly(problem, member, (aircraft.start_base, base), order, aircraft.ready_s)
        for base in aircraft.end_bases
    ]
    return min(flown, key=lambda each: (len(each[1]), each[0].duration_s))


def _insert(problem: Problem, orders: list[list[Stop]], target: int) -> bool:
    best: tuple[float, int, list[Stop]] | None = None
    for member, order in enumerate(orders):
        for alternative in range(len(problem.targets[target].alternatives)):
            for place in range(len(order) + 1):
                tried = [*order[:place], stop_at(problem, target, alternative), *order[place:]]
                trip, excesses = _best(problem, member, tried)
                if not excesses and (best is None or trip.landing_s < best[0]):
                    best = (trip.landing_s, member, tried)
    if best is None:
        return False
    orders[best[1]] = best[2]
    return True
