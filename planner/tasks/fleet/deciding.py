"""By what it is decided who does what, and how a plan names that."""

from __future__ import annotations

from planner.errors import InfeasibleError
from planner.fleet.assign import assign
from planner.fleet.assignment import Assignment
from planner.fleet.problem import Problem
from planner.fleet.stecz2020.network import UnsuitedError
from planner.fleet.stecz2020.solve import assign_stecz2020
from planner.progress import silent
from planner.tasks.methods import chosen_methods
from planner.tasks.task import Controls
from planner.wishes import Method

#: The printed model, and what is used where it is not asked for.
PRINTED, AUTO = "stecz2020", "assign"


def decided_by(method: Method) -> str:
    """The name of what decides."""
    return PRINTED if method.routing == PRINTED else AUTO


def decided(problem: Problem, method: Method, seed: int, controls: Controls) -> Assignment:
    """Who does what.

    Raises
    ------
    InfeasibleError
        ``"method"``: the printed model has no words for the problem, or it is too large for it.
    """
    with controls.stage("assign"):
        if decided_by(method) != PRINTED:
            return assign(problem, seed, controls.stop, silent, enough=controls.enough)
        try:
            return assign_stecz2020(problem, stop=controls.stop)
        except UnsuitedError as error:
            message = f"routing {PRINTED}: {error}"
            raise InfeasibleError("method", "scenario", message, "Use routing auto.") from error


def methods_of(method: Method) -> dict[str, str]:
    """The algorithm of each stage; the printed model is the routing where it decides who does what."""
    by = decided_by(method)
    return chosen_methods(method) | {"fleet": by} | ({"routing": by} if by == PRINTED else {})
