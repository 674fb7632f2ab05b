"""The program given to HiGHS, with its status, its bound, limits, and a stop that is asked while it runs."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import highspy
import numpy as np

from planner.errors import CancelledError
from planner.progress import Stop, never, raise_if
from planner.transit.milp.model import Program, build
from planner.transit.milp.values import TOUCH_M, Array, Problem, Status, Trajectory, value

#: Rounds that may yet find an obstacle entered are content with this gap and this part of the time left.
ROUGH_GAP = 0.1
ROUGH_PART = 0.3

#: With less than the rest of the time nothing more is begun.
MOST_PART = 0.97


@dataclass(frozen=True, slots=True)
class Limits:
    """When a search ends without its proof.

    Parameters
    ----------
    seconds
        Of all rounds together.
    nodes
        Of each round: the same on any machine, however busy.
    gap
        Ends as optimal where the objective is known so well, of itself.
    """

    seconds: float = 60.0
    nodes: int = 1_000_000
    gap: float = 1e-4


@dataclass(frozen=True, slots=True)
class _Round:
    """How one run of the solver ended."""

    status: Status
    columns: Array | None
    bound: float
    nodes: int
    seconds: float


def solve(
    problem: Problem, limits: Limits = Limits(), stop: Stop = never, *, whole: bool = False
) -> Trajectory:
    """The best trajectory, or the proof that there is none, as far as the limits allow.

    An obstacle's rows come into the program once a trajectory found without them enters it: what is best, or
    infeasible, with fewer obstacles and enters none of the others is so with all. Such rounds are rough; once
    none is entered the program is solved as well as asked.

    Parameters
    ----------
    whole
        Whether all obstacles have their rows from the beginning, as printed.

    Raises
    ------
    CancelledError
        ``stop`` said so; it is asked while the solver runs.
    """
    entered = tuple(range(len(problem.obstacles))) if whole else ()
    last = whole
    best = Trajectory("unknown", None, math.inf, 0.0, 0, len(entered), 0.0)
    while True:
        raise_if(stop)
        model = build(problem, entered)
        if model is None:
            return replace(best, status="infeasible", bound=math.inf)
        left_s = limits.seconds - best.seconds
        gap = limits.gap if last else max(limits.gap, ROUGH_GAP)
        found = _run(model.program, left_s if last else left_s * ROUGH_PART, gap, limits.nodes, stop)
        best = replace(
            best,
            bound=max(best.bound, found.bound),
            nodes=best.nodes + found.nodes,
            entered=len(entered),
            seconds=best.seconds + found.seconds,
        )
        if found.columns is None:
            return replace(best, status=found.status) if best.waypoints is None else best
        waypoints = found.columns[model.places]
        more = _entered(problem, waypoints, entered)
        if not more:
            reached = value(problem.goal, waypoints, problem.step_s)
            if reached < best.objective or found.status == "optimal":
                best = replace(best, waypoints=waypoints, objective=reached)
            best = replace(best, bound=min(best.bound, best.objective), status="feasible")
            if found.status == "optimal" and gap <= limits.gap:
                return replace(best, status="optimal")
            if last:
                return best
        if best.seconds >= limits.seconds * MOST_PART:
            return best
        entered, last = (*entered, *more), not more


def _entered(problem: Problem, waypoints: Array, known: tuple[int, ...]) -> list[int]:
    """The obstacles without rows that points enter, or steps where those count whole."""
    return [
        number
        for number, obstacle in enumerate(problem.obstacles)
        if number not in known and _depth_m(obstacle.depths, waypoints, problem.whole_steps) > TOUCH_M
    ]


def _depth_m(depths: Any, waypoints: Array, whole_steps: bool) -> float:
    """How deep points lie, or places along the steps."""
    if whole_steps:
        parts = np.linspace(0.0, 1.0, 17)[:, None, None]
        waypoints = ((1.0 - parts) * waypoints[None, :-1] + parts * waypoints[None, 1:]).reshape(-1, 2)
    return float(depths(waypoints).max())


def _run(program: Program, seconds: float, gap: float, nodes: int, stop: Stop) -> _Round:
    highs = highspy.Highs()  # type: ignore[no-untyped-call]
    options: dict[str, bool | int | float | str] = {
        "output_flag": False, "threads": 1, "time_limit": max(0.01, seconds), "random_seed": 0,
        "mip_max_nodes": nodes, "mip_rel_gap": gap, "mip_feasibility_tolerance": 1e-7,
    }  # fmt: skip
    for name, option in options.items():
        highs.setOptionValue(name, option)
    cancelled = False

    def asked(event: Any) -> None:
        nonlocal cancelled
        if stop():
            cancelled = True
            event.interrupt()

    highs.cbMipInterrupt += asked
    highs.cbSimplexInterrupt += asked
    highs.passModel(_as_lp(program))
    highs.run()
    if cancelled:
        raise CancelledError("planning was cancelled")
    status, info = highs.getModelStatus(), highs.getInfo()
    has = info.primal_solution_status == highspy.SolutionStatus.kSolutionStatusFeasible
    columns = np.array(highs.getSolution().col_value, dtype=np.float64) if has else None
    kinds = highspy.HighsModelStatus
    ended: Status
    if status == kinds.kOptimal:
        ended = "optimal"
    elif status in (kinds.kInfeasible, kinds.kUnboundedOrInfeasible):
        ended, columns = "infeasible", None
    else:
        ended = "feasible" if has else "unknown"
    # Without whole columns there is nothing to branch on: the optimum is its own bound.
    known = info.mip_dual_bound if any(program.integer) else info.objective_function_value
    bound = math.inf if ended == "infeasible" else float(known)
    return _Round(ended, columns, bound, max(0, int(info.mip_node_count)), float(highs.getRunTime()))


def _as_lp(program: Program) -> Any:
    """Rows and columns as HiGHS takes them."""
    lp = highspy.HighsLp()
    lp.num_col_, lp.num_row_ = len(program.cost), len(program.row_lower)
    lp.col_cost_, lp.col_lower_, lp.col_upper_ = map(np.array, (program.cost, program.lower, program.upper))
    lp.row_lower_, lp.row_upper_ = np.array(program.row_lower), np.array(program.row_upper)
    lp.a_matrix_.format_ = highspy.MatrixFormat.kRowwise
    lp.a_matrix_.start_ = np.array(program.starts, dtype=np.int32)
    lp.a_matrix_.index_ = np.array(program.columns, dtype=np.int32)
    lp.a_matrix_.value_ = np.array(program.factors)
    kinds = highspy.HighsVarType
    lp.integrality_ = [kinds.kInteger if whole else kinds.kContinuous for whole in program.integer]
    return lp
