"""``routing: stecz2020``: the model solved, with the solver's status and bound."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import Bounds, LinearConstraint, milp

from planner.errors import OutOfBudgetError
from planner.fleet.assignment import Assignment, Status, Trip
from planner.fleet.left_out import left_out_of
from planner.fleet.problem import Problem
from planner.fleet.schedule import cost_of, fly, stop_at
from planner.fleet.stecz2020.model import Form, Model, write
from planner.fleet.stecz2020.network import Network, UnsuitedError, network_of
from planner.progress import Progress, Stop, never, raise_if, silent

#: Nodes of branch and bound after which the best so far is the answer.
NODES = 5_000
#: Segments times aircraft that a whole problem may have: beyond them the solver takes minutes.
MOST_FLIGHTS = 100


@dataclass(frozen=True, slots=True)
class Routes:
    """What the solver found.

    Parameters
    ----------
    lines
        Vertices each aircraft flies through, bases included; empty where it stays.
    visited
        Waypoints with x = 1.
    missed
        Required targets that are not recognised.
    objective
        Of equation (19) and what ``Goal`` adds, without the penalty of what is missed.
    bound
        None is better than this.
    proved
        Whether the solver closed.
    """

    lines: tuple[tuple[int, ...], ...]
    visited: frozenset[int]
    missed: frozenset[int]
    objective: float
    bound: float
    proved: bool


def solve(network: Network, form: Form = "meant", nodes: int = NODES, seconds: float = math.inf) -> Routes:
    """Solve the model by HiGHS.

    Raises
    ------
    OutOfBudgetError
        When nodes or seconds ended before any answer was found.
    UnsuitedError
        When the model has no solution whatever is left out: printed (23) sends out an aircraft that cannot
        fly.
    """
    model = write(network, form)
    result = run_solver(model, nodes, seconds)
    if result.x is None:
        if result.status == 1:
            raise OutOfBudgetError("routing stecz2020: no answer within its nodes")
        raise UnsuitedError("equations (20)–(33) have no solution: an aircraft that has to fly cannot")
    return _read(network, model, result.x, float(result.mip_dual_bound), bool(result.status == 0))


def run_solver(model: Model, nodes: int = NODES, seconds: float = math.inf) -> Any:
    """What HiGHS says of a model, as ``scipy.optimize.milp`` has it."""
    rows = model.rows
    return milp(
        np.array(rows.cost),
        integrality=np.array(rows.whole),
        bounds=Bounds(np.array(rows.low), np.array(rows.high)),
        constraints=LinearConstraint(rows.matrix(), np.array(rows.least), np.array(rows.most)),
        options={"node_limit": nodes, "time_limit": seconds, "mip_rel_gap": 1e-9},
    )


def _read(network: Network, model: Model, values: np.ndarray, bound: float, proved: bool) -> Routes:
    lines = []
    for h, flyer in enumerate(network.flyers):
        onward = {i: j for (g, i, j), v in model.y.items() if g == h and values[v] > 0.5}
        line = [flyer.start] if flyer.start in onward else []
        while line and line[-1] in onward:
            line.append(onward[line[-1]])
        lines.append(tuple(line))
    missed = frozenset(target for target, v in model.missed.items() if values[v] > 0.5)
    paid = model.penalty * sum(values[v] for v in model.missed.values())
    objective = float(np.dot(model.rows.cost, values)) - paid
    visited = frozenset(i for i, v in enumerate(model.x) if values[v] > 0.5)
    return Routes(tuple(lines), visited, missed, objective, bound - paid, proved)


def assign_stecz2020(
    problem: Problem,
    form: Form = "meant",
    nodes: int = NODES,
    seconds: float = math.inf,
    stop: Stop = never,
    progress: Progress = silent,
) -> Assignment:
    """The assignment by the model, with the solver's status and bound.

    In the printed form an aircraft may fly several alternatives of one target, as equation (29) has it.

    Raises
    ------
    CancelledError
        When ``stop`` says so before the solver starts or after it ended; HiGHS itself is not interrupted.
    OutOfBudgetError, UnsuitedError
        See ``solve`` and ``network_of``.
    """
    raise_if(stop)
    network = network_of(problem)
    flights = len(network.segments) * len(network.flyers)
    if flights > MOST_FLIGHTS:
        raise UnsuitedError(
            f"{len(network.segments)} segments for {len(network.flyers)} aircraft are {flights} choices, "
            f"more than the {MOST_FLIGHTS} that the model is solved for"
        )
    found = solve(network, form, nodes, seconds)
    raise_if(stop)
    trips = tuple(_trip(problem, network, member, line) for member, line in enumerate(found.lines) if line)
    left_out = left_out_of(problem, trips)
    status: Status = "optimal" if found.proved else "feasible"
    if any(each.required for each in left_out):
        status = "infeasible"
    progress("assign", 1.0)
    return Assignment(trips, left_out, status, cost_of(problem, trips), found.bound)


def _trip(problem: Problem, network: Network, member: int, line: tuple[int, ...]) -> Trip:
    aircraft, flyer = problem.members[member], network.flyers[member]
    by_entry = {segment.k: segment for segment in network.segments}
    ways = [by_entry[vertex] for vertex in line if vertex in by_entry]
    stops = [stop_at(problem, way.target, way.alternative) for way in ways]
    base = aircraft.end_bases[flyer.ends.index(line[-1])]
    trip, excesses = fly(problem, member, (aircraft.start_base, base), stops, aircraft.ready_s)
    if excesses:
        raise ValueError(f"{aircraft.name}: the model's line breaks {excesses}")
    return trip
