"""``auto``: who does what, when."""

from __future__ import annotations

from functools import partial

from planner.fleet.answer import trips_of
from planner.fleet.assignment import Assignment, Status
from planner.fleet.auto.build import tables
from planner.fleet.auto.search import search
from planner.fleet.bound import lower_bound
from planner.fleet.exact import exact
from planner.fleet.left_out import left_out_of
from planner.fleet.problem import Problem
from planner.fleet.schedule import cost_of, worth_of_all
from planner.progress import Progress, Stop, never, silent

#: Iterations of the search: so many, and so many more for each job.
ITERATIONS, PER_JOB = 2_000, 250


def assign(
    problem: Problem,
    seed: int = 0,
    stop: Stop = never,
    progress: Progress = silent,
    iterations: int | None = None,
    *,
    bounded: bool = False,
    enough: Stop = never,
) -> Assignment:
    """The best assignment found: proved so for few targets, by search for many.

    Parameters
    ----------
    problem
        What is to be done and by whom.
    seed
        The same seed gives the same answer.
    stop, progress
        To be asked between steps, and told.
    iterations
        Of the search; by the number of targets when not given.
    bounded
        Whether to say what no assignment can beat, also where nothing is proved.
    enough
        Ends the search with the best found.

    Raises
    ------
    CancelledError
        When ``stop`` says so.
    """
    known = tables(problem)
    found = exact(known, stop)
    proved = found is not None
    if found is None:
        most = iterations or ITERATIONS + PER_JOB * len(known.jobs.prize)
        told = partial(progress, "assign")
        found = search(known, seed, lambda done: done / most, stop, told, enough)
    trips = trips_of(problem, found)
    left_out = left_out_of(problem, trips)
    cost = cost_of(problem, trips)
    status: Status = "optimal" if proved else "feasible"
    if any(each.required for each in left_out):
        status = "infeasible"
    bound = cost if proved else None
    if bounded and not proved and status == "feasible":
        bound = lower_bound(known, stop) - worth_of_all(problem)
    progress("assign", 1.0)
    return Assignment(trips, left_out, status, cost, bound)
