"""By what it is decided who does what, and how a plan names that."""

from __future__ import annotations

from dataclasses import replace

from planner.errors import InfeasibleError
from planner.fleet.assign import assign
from planner.fleet.assignment import Assignment
from planner.fleet.problem import Member, Problem
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
            found = [
                assign(each, seed, controls.stop, silent, enough=controls.enough)
                for each in (problem, *_changing_at_one_base(problem))
            ]
            best = min(found, key=_rank)
            # What is proved of some bases alone is not proved of all.
            return (
                best
                if best is found[0]
                else replace(
                    best,
                    status=best.status if best.status == "infeasible" else "feasible",
                    bound=found[0].bound,
                )
            )
        try:
            return assign_stecz2020(problem, stop=controls.stop)
        except UnsuitedError as error:
            message = f"routing {PRINTED}: {error}"
            raise InfeasibleError("method", "scenario", message, "Use routing auto.") from error


def _rank(assigned: Assignment) -> tuple[int, float]:
    """Required targets left out, and the cost: less is better."""
    return sum(each.required for each in assigned.left_out), assigned.cost


def _changing_at_one_base(problem: Problem) -> list[Problem]:
    """Where batteries are changed at any of several bases: the same problem with each of them alone.

    The search lands a flight where it suits that flight, not the one that starts there behind it.
    """

    def free(member: Member) -> bool:
        return member.trips > 1 and len(member.end_bases) > 1

    bases = dict.fromkeys(base for member in problem.members if free(member) for base in member.end_bases)
    return [
        replace(
            problem,
            members=tuple(
                replace(member, end_bases=(base,)) if free(member) and base in member.end_bases else member
                for member in problem.members
            ),
        )
        for base in bases
    ]


def methods_of(method: Method) -> dict[str, str]:
    """The algorithm of each stage; the printed model is the routing where it decides who does what."""
    by = decided_by(method)
    return chosen_methods(method) | {"fleet": by} | ({"routing": by} if by == PRINTED else {})
