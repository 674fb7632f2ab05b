"""The search over tables: seeded, stopped by iterations or by its caller."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from planner.errors import CancelledError
from planner.fleet.auto.insert_kernels import SLOPE, cost_of
from planner.fleet.auto.search_kernels import improve
from planner.fleet.auto.tables import Costs, Crew, Floats, Ints, Jobs, Routes, Weights
from planner.fleet.auto.times_kernels import renew
from planner.progress import Stop, never

#: Iterations between two looks at ``stop``.
CHUNK = 500
#: Iterations between two looks at ``enough``.
LOOK = 20
#: Temperatures at the begin and at the end, as parts of what one job costs on average.
HOT, COLD = 8.0, 0.08


@dataclass(frozen=True, slots=True)
class Tables:
    """All that the search knows."""

    jobs: Jobs
    costs: Costs
    crew: Crew
    weights: Weights


@dataclass(frozen=True, slots=True)
class Found:
    """The best solution found: per route its nodes, bases included, and the windows of its revisits."""

    routes: tuple[tuple[int, ...], ...]
    members: tuple[int, ...]
    early: Floats
    late: Floats
    cost: float
    iterations: int


def empty(tables: Tables) -> Routes:
    """Routes that do nothing."""
    first = tables.crew.first
    members = np.repeat(np.arange(len(first) - 1), np.diff(first)).astype(np.int64)
    count, jobs = len(members), len(tables.jobs.prize)
    shape = (count, jobs + 2, 4)
    routes = Routes(
        members,
        np.zeros(shape[:2], dtype=np.int64),
        np.zeros(count, dtype=np.int64),
        np.full(jobs, -1, dtype=np.int64),
        np.zeros(shape),
        np.zeros(shape),
        np.zeros((count, 7)),
    )
    for member in range(len(first) - 1):
        renew(tables.jobs, tables.costs, tables.crew, tables.weights, routes, member)
    return routes


def search(
    tables: Tables,
    seed: int,
    done: Callable[[int], float],
    stop: Stop,
    progress: Callable[[float], None],
    enough: Stop = never,
) -> Found:
    """The best solution found.

    Parameters
    ----------
    tables
        What is known.
    seed
        Decides all that is drawn.
    done
        The part of the search that so many iterations are; it ends at 1.
    stop, progress
        Asked, and told the part done, every ``CHUNK`` iterations.
    enough
        Asked every ``LOOK`` iterations: ends the search with the best found.

    Raises
    ------
    CancelledError
        When ``stop`` says so.
    """
    jobs, costs, crew, weights = tables.jobs, tables.costs, tables.crew, tables.weights
    routes, work, best = empty(tables), empty(tables), empty(tables)
    state: Ints = np.array([(seed * 2_654_435_761 + 88_172_645_463_325_252) & (2**62 - 1)], dtype=np.int64)
    windows = np.array([jobs.early, jobs.late, jobs.early, jobs.late])
    value = np.array([cost_of(jobs, crew, weights, routes, SLOPE), cost_of(jobs, crew, weights, best, 0.0)])
    iterations, part = 0, done(0)
    while part < 1.0:
        if stop():
            raise CancelledError("planning was cancelled")
        scale = _scale(jobs, best, value[1])
        heats = np.full(CHUNK, scale * HOT * (COLD / HOT) ** part) if iterations else np.zeros(1)
        for first in range(0, len(heats), LOOK):
            some = heats[first : first + LOOK]
            improve(jobs, costs, crew, weights, routes, work, best, windows, state, value, some)
            iterations += len(some)
            if enough():
                break
        part = 1.0 if enough() else done(iterations)
        progress(min(1.0, part))
    orders = tuple(
        tuple(int(node) for node in best.seq[r, : best.filled[r] + 2]) for r in range(len(best.filled))
    )
    return Found(
        orders, tuple(int(m) for m in best.member), windows[2], windows[3], float(value[1]), iterations
    )


def _scale(jobs: Jobs, best: Routes, value: float) -> float:
    inside = best.at >= 0
    return max(1e-9, (value - float(jobs.prize[~inside].sum())) / max(1, int(inside.sum())))
