"""What is said of an assignment: its objective, and what none has less of."""

from __future__ import annotations

import math

from planner.errors import InfeasibleError
from planner.fleet.assignment import Assignment
from planner.fleet.auto.build import tables
from planner.fleet.bound import lower_bound
from planner.fleet.problem import Problem
from planner.fleet.schedule import worth_of_all
from planner.plan import Assigned
from planner.progress import Stop, never
from planner.tasks.fleet.placing import LateError

#: Of more targets no bound is looked for: it would take longer than a second.
MOST_TARGETS = 30


def told_of(
    problem: Problem, assigned: Assignment, method: str, stop: Stop = never, enough: Stop = never
) -> Assigned:
    """What is said of an assignment of a problem.

    Parameters
    ----------
    stop, enough
        The one cancels; the other ends the search for a bound.

    Raises
    ------
    CancelledError
        When ``stop`` says so.
    """
    worth = worth_of_all(problem)
    objective_s = float(assigned.cost + worth)
    bound_s = None if assigned.bound is None else float(assigned.bound + worth)
    if bound_s is None and len(problem.targets) <= MOST_TARGETS:
        found_s = float(lower_bound(tables(problem), stop, enough))
        bound_s = found_s if math.isfinite(found_s) else None
    if bound_s is None or objective_s <= 0.0:
        return Assigned(method, assigned.status, round(objective_s, 3), bound_s, None)
    # Sums of large worths lose their last digits.
    bound_s = min(max(bound_s, 0.0), objective_s)
    gap = round(1.0 - bound_s / objective_s, 6)
    return Assigned(method, assigned.status, round(objective_s, 3), round(bound_s, 3), gap)


def too_late(late: LateError) -> InfeasibleError:
    """What is said of a window that a flight does not keep."""
    late_s = math.ceil(late.late_s)
    message = f"is seen up to {late_s} s after its window closes, as far as was found"
    relaxation = f"Let time_window_s close {late_s} s later, or add an aircraft."
    return InfeasibleError("window", late.job.of, message, relaxation)
