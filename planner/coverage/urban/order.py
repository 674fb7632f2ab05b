"""The order of footprint sweeps as a travelling salesman's (Majeed and Lee 2019, section 3.5)."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import Literal

import numpy as np
import scipy.sparse
import scipy.sparse.csgraph
from numpy.typing import NDArray
from scipy.optimize import Bounds, LinearConstraint, milp

from planner.coverage.urban.area import Place
from planner.coverage.urban.colony_kernels import colony_tour
from planner.coverage.urban.measures import Sweep

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: How the order is found: by ants, or by HiGHS as a mixed integer programme.
Solver = Literal["ants", "highs"]

#: Parameters of eqs 3 to 6: Dorigo's own for the ant system; the paper gives none.
ALPHA, BETA, RHO, DEPOSIT = 1.0, 5.0, 0.5, 1.0
#: "Parameters of ACO according to problem size": ants, iterations at least and at most, choices in all.
ANTS = 20
FEWEST_ITERATIONS, MOST_ITERATIONS = 15, 100
WORK = 2.0e8
#: Points nearer than this are kept apart by it, so that the visibility stays finite.
LEAST_APART_M = 0.01
#: Neighbours of each point among which HiGHS chooses, besides the ants' tour; rounds of the whole programme.
NEIGHBOURS = 8
MOST_ROUNDS = 3
#: Gap at which HiGHS may stop each round.
GAP = 0.01


def visiting_order(sweeps: Sequence[Sweep], solver: Solver, seed: int) -> Ints:
    """The closed tour over all sweeps, each once.

    The points are the sweeps' midpoints m_i, "calculated from the footprint sweeps' endpoints": section 3.4
    says that midpoints are found for the visiting sequence, 3.5 that the points come of the endpoints.
    Obstacles are left out here, as there.
    """
    distances = _apart(np.array([sweep.midpoint for sweep in sweeps], dtype=np.float64).reshape(-1, 2))
    tour = colony(distances, seed)
    return tour if solver == "ants" or len(tour) < 4 else best_tour(distances, tour)


def colony(distances: Floats, seed: int) -> Ints:
    """The tour of an ant colony (eqs 3 to 6)."""
    count = len(distances)
    if count < 3:
        return np.arange(count)
    ants = min(ANTS, count)
    iterations = int(np.clip(WORK / (ants * count**2), FEWEST_ITERATIONS, MOST_ITERATIONS))
    draws = np.random.default_rng(seed).random((iterations, ants, count))
    trail = ants * DEPOSIT / _nearest_m(distances)
    return colony_tour(distances, draws, ALPHA, BETA, RHO, DEPOSIT, trail)


def best_tour(distances: Floats, known: Ints) -> Ints:
    """A short closed tour over edges between neighbours and those of a known one, by HiGHS.

    Degrees of two, and subtours cut off round by round (Dantzig, Fulkerson and Johnson 1954): of the relaxed
    programme until what it chooses holds together, then of the whole one. Subtours that are left after
    the rounds are joined where that costs least.
    """
    count = len(distances)
    edges = _candidates(distances, known)
    cost = distances[edges[:, 0], edges[:, 1]]
    numbers = np.arange(len(edges))
    degree = scipy.sparse.csr_array(
        (np.ones(2 * len(edges)), (edges.T.ravel(), np.concatenate([numbers, numbers]))),
        shape=(count, len(edges)),
    )
    cuts: list[LinearConstraint] = []
    whole = False
    rounds = 0
    while True:
        found = milp(
            cost,
            integrality=np.full(len(edges), int(whole)),
            bounds=Bounds(0.0, 1.0),
            constraints=[LinearConstraint(degree, 2.0, 2.0), *cuts],
            options={"mip_rel_gap": GAP},
        )
        chosen = edges[np.asarray(found.x) > 1e-6]
        graph = scipy.sparse.coo_array((np.ones(len(chosen)), chosen.T), shape=(count, count))
        parts, labels = scipy.sparse.csgraph.connected_components(graph, directed=False)
        rounds += whole
        if whole and (parts == 1 or rounds == MOST_ROUNDS):
            return _joined(_walks(chosen, labels.astype(np.int64), parts), distances)
        if parts == 1:
            whole = True
        for part in range(parts if parts > 1 else 0):
            inside = labels == part
            row = (inside[edges[:, 0]] & inside[edges[:, 1]]).astype(float)
            cuts.append(LinearConstraint(row[None, :], -np.inf, float(inside.sum() - 1)))


def opened(tour: Ints, sweeps: Sequence[Sweep], start: Place, end: Place) -> Ints:
    """A closed tour cut where that serves best a flight that begins and ends elsewhere."""
    middles = np.array([sweep.midpoint for sweep in sweeps])[tour]
    first = np.hypot(*(middles - start).T)
    last = np.hypot(*(middles - end).T)
    joint = np.hypot(*(np.roll(middles, -1, axis=0) - middles).T)
    # cut after place k: forward the flight begins at k + 1 and ends at k, backward the other way round
    forward, backward = np.roll(first, -1) + last - joint, first + np.roll(last, -1) - joint
    if forward.min() <= backward.min():
        return np.roll(tour, -int(np.argmin(forward)) - 1)
    return np.roll(tour, -int(np.argmin(backward)) - 1)[::-1]


def oriented(order: Sequence[Sweep], start: Place, end: Place) -> tuple[Sweep, ...]:
    """Sweeps in a given order, each flown in the direction that joins them by the least straight lines.

    Line 3 of algorithm 1, "identify the relevant endpoint pair", for all pairs at once.
    """
    ways = [(sweep, sweep.reversed()) for sweep in order]
    costs = [[math.dist(start, way.start) for way in ways[0]]]
    came: list[list[int]] = []
    for before, here in itertools.pairwise(ways):
        options = [[costs[-1][k] + math.dist(before[k].end, way.start) for k in (0, 1)] for way in here]
        came.append([int(np.argmin(each)) for each in options])
        costs.append([min(each) for each in options])
    state = int(np.argmin([costs[-1][k] + math.dist(ways[-1][k].end, end) for k in (0, 1)]))
    chosen = [ways[-1][state]]
    for back, way in zip(reversed(came), reversed(ways[:-1]), strict=True):
        state = back[state]
        chosen.append(way[state])
    return tuple(chosen[::-1])


def _apart(points: Floats) -> Floats:
    gaps = np.hypot(*(points[:, None] - points[None]).transpose(2, 0, 1))
    apart: Floats = np.maximum(gaps, LEAST_APART_M)
    np.fill_diagonal(apart, 0.0)
    return apart


def _nearest_m(distances: Floats) -> float:
    """Length of the tour that goes to the nearest point each time, for the first trail."""
    left = np.ones(len(distances), dtype=bool)
    here, total_m = 0, 0.0
    left[0] = False
    for _ in range(len(distances) - 1):
        row = np.where(left, distances[here], np.inf)
        here = int(np.argmin(row))
        total_m += float(row[here])
        left[here] = False
    return total_m + float(distances[here, 0])


def _candidates(distances: Floats, known: Ints) -> Ints:
    near = np.argsort(distances, axis=1, kind="stable")[:, 1 : NEIGHBOURS + 1]
    rows = np.repeat(np.arange(len(distances)), near.shape[1])
    pairs = np.vstack([np.column_stack([rows, near.ravel()]), np.column_stack([known, np.roll(known, -1)])])
    pairs.sort(axis=1)
    unique: Ints = np.unique(pairs[pairs[:, 0] != pairs[:, 1]], axis=0)
    return unique


def _walks(edges: Ints, labels: Ints, parts: int) -> list[Ints]:
    """Of each part its round, from edges of which two meet at every point."""
    beside: list[list[int]] = [[] for _ in labels]
    for a, b in edges:
        beside[a].append(int(b))
        beside[b].append(int(a))
    found = []
    for part in range(parts):
        members = np.flatnonzero(labels == part)
        tour, before = [int(members[0])], -1
        while len(tour) < len(members):
            step = next(each for each in beside[tour[-1]] if each != before)
            before = tour[-1]
            tour.append(step)
        found.append(np.array(tour))
    return found


def _joined(tours: list[Ints], distances: Floats) -> Ints:
    """Rounds made one: the smallest first, each with another where exchanging edges costs least."""
    tours = sorted(tours, key=len)
    while len(tours) > 1:
        one, after = tours[0], np.roll(tours[0], -1)
        best = (np.inf, 0, 0, 0, False)
        for k, other in enumerate(tours[1:], 1):
            behind = np.roll(other, -1)
            saved = distances[one, after][:, None] + distances[other, behind]
            for turned, added in (
                (False, distances[np.ix_(one, behind)] + distances[np.ix_(after, other)]),
                (True, distances[np.ix_(one, other)] + distances[np.ix_(after, behind)]),
            ):
                cost = added - saved
                i, j = divmod(int(np.argmin(cost)), len(other))
                best = min(best, (float(cost[i, j]), k, i, j, turned))
        _, k, i, j, turned = best
        other = np.roll(tours[k], -j - 1)
        middle = other[::-1] if turned else other
        merged = np.concatenate([one[: i + 1], middle, one[i + 1 :]])
        tours = sorted([*tours[1:k], *tours[k + 1 :], merged], key=len)
    return tours[0]
