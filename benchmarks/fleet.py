"""Fleets: the printed model and ``auto`` on small cases, ``auto`` at scale.

``swathplan bench fleet``: a row says on how many random cases the model closed and ``auto`` came to the same
cost, rows after it how long ``auto`` takes for many targets, its memory, its bound. ``--seconds`` is what the
model may take for a case.
"""

from __future__ import annotations

import resource
import sys
import time
from collections.abc import Iterator
from typing import Any

from benchmarks.fleet_cases import case
from planner.errors import OutOfBudgetError
from planner.fleet.assign import assign
from planner.fleet.problem import Objective, Problem
from planner.fleet.schedule import broken, worth_of_all
from planner.fleet.stecz2020.solve import assign_stecz2020

#: As in equation (19): ρ = 1 without and with what targets are worth.
OBJECTIVES = (
    Objective(total_time=0.0, travel_time=1.0),
    Objective(total_time=0.0, travel_time=1.0, priority=60.0),
)
#: Two costs are one within this.
SAME = 1e-3


def run(cases: int = 200, seconds: float = 10.0, scale: bool = True) -> Iterator[dict[str, Any]]:
    """A row on agreement, and one for each size."""
    yield _agreement(cases, seconds)
    if scale:
        yield _scale(30, 3, bounded=True)
        yield _scale(200, 5, bounded=False)


def small(seed: int) -> Problem:
    """Two to eight targets with up to two alternatives each, two aircraft, windows on half of them."""
    return case(
        seed,
        targets=2 + seed % 7,
        bases=1 + seed // 7 % 2,
        required=1.0 if seed % 2 else 0.5,
        objective=OBJECTIVES[(seed // 2) % 2],
        max_flight_s=2400.0,
    )


def _agreement(cases: int, seconds: float) -> dict[str, Any]:
    closed = agreed = beaten = 0
    worst = ours_s = model_s = 0.0
    for seed in range(cases):
        problem = small(seed)
        begin = time.perf_counter()
        ours = assign(problem)
        ours_s += time.perf_counter() - begin
        begin = time.perf_counter()
        try:
            model = assign_stecz2020(problem, seconds=seconds)
        except OutOfBudgetError:
            continue
        finally:
            model_s += time.perf_counter() - begin
        missed = [[each.target for each in answer.left_out if each.required] for answer in (ours, model)]
        proved = model.bound is not None and abs(model.bound - model.cost) <= SAME * max(1.0, abs(model.cost))
        off = abs(model.cost - ours.cost) / max(1.0, abs(ours.cost))
        if proved:
            closed += 1
            worst = max(worst, off)
            agreed += off <= SAME and len(missed[0]) == len(missed[1])
        beaten += len(missed[0]) > len(missed[1]) or (
            len(missed[0]) == len(missed[1]) and model.cost < ours.cost - SAME * max(1.0, abs(ours.cost))
        )
    return {
        "case": "stecz2020 and auto",
        "cases": cases,
        "closed": closed,
        "agreed": agreed,
        "auto_beaten": beaten,
        "worst_difference": worst,
        "auto_seconds": round(ours_s, 2),
        "model_seconds": round(model_s, 2),
    }


def _scale(targets: int, members: int, *, bounded: bool) -> dict[str, Any]:
    problem = case(
        targets, targets=targets, members=members, alternatives=4, bases=2, windows=0.3, required=1.0
    )
    assign(problem, iterations=1, bounded=bounded)
    begin, spent = time.perf_counter(), time.process_time()
    answer = assign(problem, seed=1, bounded=bounded)
    seconds, cpu = time.perf_counter() - begin, time.process_time() - spent
    unit = 1024.0 if sys.platform != "darwin" else 1024.0**2
    total = answer.cost + worth_of_all(problem)
    return {
        "case": f"{targets} targets, {members} aircraft",
        "status": answer.status,
        "broken": len(broken(problem, answer.trips)),
        "left_out": len(answer.left_out),
        "cost": answer.cost,
        "bound": answer.bound,
        "gap_percent": None if answer.bound is None else 100.0 * (answer.cost - answer.bound) / total,
        "seconds": round(seconds, 2),
        "cpu_seconds": round(cpu, 2),
        "memory_mb": round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / unit),
    }
