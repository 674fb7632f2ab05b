"""What no assignment can beat: a linear relaxation over the whole fleet at once.

All aircraft become one that flies every arc as cheaply as the cheapest of them can, every trip leaves one
base and lands there, and flows may be fractions of ones. Kept are: each job once or, at its prize, not at
all; as much flow out of each way to do it as into it; arcs that windows allow; energy, range and time in the
air of all trips together; and, for any set of jobs, that as much leaves it as is done in it (G. Dantzig, R.
Fulkerson and S. Johnson 1954), added where a solution breaks it. The last landing is no earlier than all
aircraft's shares of the time flown, nor than the earliest landing after any one required job.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog
from scipy.sparse import coo_array, csr_array, vstack
from scipy.sparse.csgraph import breadth_first_order, maximum_flow

from planner.fleet.auto.build import REQUIRED
from planner.fleet.auto.search import Tables
from planner.fleet.auto.tables import ENERGY, FLIGHT, RANGE, READY, SHIFT_END, Floats, Ints
from planner.progress import Stop, never, raise_if

#: Rounds of cuts; arcs above which the ways to do a job are one.
ROUNDS, ARCS = 8, 40_000
#: Flow counted as whole numbers of this share.
GRAIN = 1_000_000


@dataclass(frozen=True, slots=True)
class _Arcs:
    """Arcs from node to node, 0 for all bases; what each costs and uses at the least."""

    tail: Ints
    head: Ints
    seconds: Floats
    cost: Floats
    length: Floats
    energy: Floats


def lower_bound(tables: Tables, stop: Stop = never, enough: Stop = never) -> float:
    """No assignment that does everything required costs less, prizes of what is left out included.

    Parameters
    ----------
    enough
        Asked before each round of cuts: ends them with what is known, −inf where that is nothing.

    Raises
    ------
    CancelledError
        When ``stop`` says so.
    """
    jobs, crew, weights = tables.jobs, tables.crew, tables.weights
    total = len(jobs.prize)
    if not total:
        return 0.0
    arcs, job = _arcs(tables)
    members = len(crew.profile)
    spread = arcs.cost + weights.landing * arcs.seconds / members
    found = _relaxed(tables, arcs, job, spread, stop, enough)
    if weights.landing > 0.0:
        alone = weights.landing * _last_of_one(tables)
        found = max(found, alone + _relaxed(tables, arcs, job, arcs.cost, stop, enough))
    return found


def _least(tables: Tables) -> tuple[Floats, Floats, Floats, Floats]:
    """Least seconds, cost, length and energy of arcs over the fleet, between bases and nodes, (N, N)."""
    costs, crew, weights = tables.costs, tables.crew, tables.weights
    profiles = crew.profile
    service = np.where(np.isfinite(costs.service), costs.service, math.inf)
    moving = costs.seconds + service[:, None, :]
    late = np.minimum(tables.jobs.late, crew.limits[:, SHIFT_END].max())
    early = np.maximum(tables.jobs.early, 0.0)
    lead = np.min(
        [costs.seconds[p, crew.start[m]] + crew.limits[m, READY] for m, p in enumerate(profiles)], 0
    )
    begin = np.maximum(early, lead)
    keeps = (begin + service)[:, :, None] + moving <= late[None, None, :] + 1e-6
    moving = np.where(keeps, moving, math.inf)
    cost = weights.time * np.where(np.isfinite(moving), moving, math.inf) if weights.time else 0.0
    cost = cost + np.where(np.isfinite(moving), costs.price, math.inf)
    length = costs.length.min(axis=0) if costs.length.shape[1] > 1 else np.zeros(moving.shape[1:])
    energy = costs.energy.min(axis=0) if costs.energy.shape[1] > 1 else np.zeros(moving.shape[1:])
    return moving.min(axis=0), cost.min(axis=0), length, energy


def _arcs(tables: Tables) -> tuple[_Arcs, Ints]:
    """The arcs, and the job of each of their nodes, −1 for the bases."""
    jobs, crew = tables.jobs, tables.crew
    bases = int(jobs.first[0])
    grids = _least(tables)
    starts, ends = np.unique(crew.start), np.unique(crew.ends)
    cut = np.arange(bases, len(jobs.of))
    job = np.concatenate([[-1], jobs.of[bases:]])
    squares = []
    for grid in grids:
        square = np.full((len(cut) + 1, len(cut) + 1), math.inf)
        square[1:, 1:] = grid[np.ix_(cut, cut)]
        square[0, 1:] = grid[np.ix_(starts, cut)].min(axis=0)
        square[1:, 0] = grid[np.ix_(cut, ends)].min(axis=1)
        squares.append(square)
    if len(job) ** 2 > ARCS:
        groups = np.concatenate([[0], jobs.first[:-1] - bases + 1])
        squares = [
            np.minimum.reduceat(np.minimum.reduceat(square, groups, axis=0), groups, axis=1)
            for square in squares
        ]
        job = np.arange(-1, len(jobs.prize))
    tail, head = np.nonzero(np.isfinite(squares[1]) & (job[:, None] != job[None, :]))
    return _Arcs(tail, head, *(square[tail, head] for square in squares)), job


def _relaxed(tables: Tables, arcs: _Arcs, job: Ints, cost: Floats, stop: Stop, enough: Stop) -> float:
    jobs, crew = tables.jobs, tables.crew
    total, nodes, count = len(jobs.prize), len(job), len(arcs.tail)
    ones, at = np.ones(count), np.arange(count)
    inner = arcs.head > 0
    done = coo_array((ones[inner], (job[arcs.head[inner]], at[inner])), shape=(total, count + total))
    left = coo_array((np.ones(total), (np.arange(total), count + np.arange(total))), shape=done.shape)
    flow = coo_array(
        (np.r_[ones, -ones], (np.r_[arcs.head, arcs.tail], np.r_[at, at])), shape=(nodes, count + total)
    )
    equal: Any = vstack([done + left, flow]).tocsr()
    sides = np.r_[np.ones(total), np.zeros(nodes)]
    trips = np.diff(crew.first)
    rows = [np.r_[np.where(arcs.tail == 0, 1.0, 0.0), np.zeros(total)]]
    most = [float(trips.sum())]
    for values, column in ((arcs.seconds, FLIGHT), (arcs.length, RANGE), (arcs.energy, ENERGY)):
        budget = float((crew.limits[:, column] * trips).sum())
        if math.isfinite(budget):
            rows.append(np.r_[values, np.zeros(total)])
            most.append(budget)
    above: Any = csr_array(np.array(rows))
    required = jobs.prize >= REQUIRED
    limits = [(0.0, 1.0)] * count + [(0.0, 0.0 if needed else 1.0) for needed in required]
    objective = np.r_[cost, np.where(required, 0.0, jobs.prize)]
    found = -math.inf
    for _ in range(ROUNDS):
        raise_if(stop)
        if enough():
            break
        result: Any = linprog(
            objective, A_ub=above, b_ub=most, A_eq=equal, b_eq=sides, bounds=limits, method="highs"
        )
        if result.x is None:
            return math.inf if result.status == 2 else found
        found = float(result.fun)
        cuts = _cuts(arcs, job, result.x[:count], 1.0 - result.x[count:])
        if not cuts:
            break
        more: list[Floats] = []
        for inside, member in cuts:
            leaving = inside[job[arcs.tail]] & (arcs.tail > 0) & ~(inside[job[arcs.head]] & (arcs.head > 0))
            row = np.r_[-leaving.astype(float), np.zeros(total)]
            row[count + member] = -1.0
            more.append(row)
            most.append(-1.0)
        above = vstack([above, csr_array(np.array(more))]).tocsr()
    return found


def _cuts(arcs: _Arcs, job: Ints, flown: Floats, done: Floats) -> list[tuple[NDArray[np.bool_], int]]:
    """Sets of jobs that less leaves than is done in them, each with the job that shows it."""
    total = len(done)
    whole = np.round(flown * GRAIN).astype(np.int32)
    used = whole > 0
    tails, heads = job[arcs.tail[used]] % (total + 1), job[arcs.head[used]] % (total + 1)
    between: Any = coo_array((whole[used], (tails, heads)), shape=(total + 1, total + 1)).tocsr()
    between.sum_duplicates()
    graph: Any = between.astype(np.int32)
    found: dict[bytes, tuple[NDArray[np.bool_], int]] = {}
    for member in np.flatnonzero(done > 1e-3):
        result = maximum_flow(graph, int(member), total)
        if result.flow_value >= done[member] * GRAIN * 0.999 - total:
            continue
        residual: Any = csr_array(graph - result.flow)
        residual.data[residual.data < 0] = 0
        residual.eliminate_zeros()
        side = np.zeros(total + 1, dtype=bool)
        side[breadth_first_order(residual, int(member), return_predecessors=False)] = True
        found.setdefault(side.tobytes(), (side, int(member)))
    return list(found.values())


def _last_of_one(tables: Tables) -> float:
    """The earliest last landing that any one required job allows."""
    jobs, crew, costs = tables.jobs, tables.crew, tables.costs
    latest = 0.0
    for j in np.flatnonzero(jobs.prize >= REQUIRED):
        ways = np.arange(jobs.first[j], jobs.first[j + 1])
        earliest = math.inf
        for m, p in enumerate(crew.profile):
            ends = crew.ends[crew.ends_first[m] : crew.ends_first[m + 1]]
            lead = costs.seconds[p, crew.start[m], ways] + crew.limits[m, READY]
            home = costs.seconds[p][np.ix_(ways, ends)].min(axis=1)
            landing = np.maximum(lead, jobs.early[ways]) + costs.service[p, ways] + home
            earliest = min(earliest, float(landing.min()))
        latest = max(latest, earliest)
    return latest
