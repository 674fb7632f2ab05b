"""The lower bound for many passes: trees over regions, lines between cells of neighbours.

A tour is a tree over the nodes, with a line from the start and one to the end, that leaves every node by the
cell it enters it by, and for another node than it came from. The least tree is found at once; that every node
has two lines and is left as it was entered is paid for by prices and potentials (M. Held, R. M. Karp, "The
traveling-salesman problem and minimum spanning trees", Operations Research 18, 1970; the potentials are the
same for cells). With these alone trees go to a neighbour and back half of the time, to be in another cell
after it; prices of turning back, by cell and neighbour, are for that. Any of them give a bound; subgradient
ascent looks for the best.

Potentials, slopes and the first splits come from the tour in a good order; then cells that trees use are
split.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from planner.bounds import cells_kernels as cells_of
from planner.bounds import tables_kernels as tables
from planner.bounds import trees_kernels as kernels
from planner.bounds.allowance import Allowance
from planner.bounds.nodes import Node, divided
from planner.progress import Stop, raise_if
from planner.routing import tour

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

#: Headings of the first boxes, and how many cells of a node the tour in order may split them into.
HEADINGS, MOST_IN_ORDER = 36, 60
#: Lines that take as long as the tour in order for a node, and as the ascent for a line.
LINES_IN_ORDER, LINES_ASCENT = 4_000, 1.7
#: Of the nearest nodes lines are known by cells, of others by how far apart they are.
NEAREST = 7
#: Rounds of splitting, the last of which ends the search where it gains less than this part.
ROUNDS, LEAST_GAIN = 8, 0.004
STEPS = 500
#: Steps of the ascent between two looks at the clock, where one ends it.
LOOK = 20
#: A cell is split that is in this part of the trees, and of each node so many at a time.
USED, MOST_SPLIT = 0.02, 8


class _Cells:
    """Cells of all nodes, one node after the other, with what is known of each; splitting renews them."""

    def __init__(self, nodes: list[Node], headings: int) -> None:
        self.nodes = nodes
        self.boxes: Floats = np.empty((0, 5))
        self.values: Floats = np.empty((0, cells_of.WIDTH))
        self.slopes: Floats = np.empty((0, 2))
        self.potential: Floats = np.empty(0)
        self.back: Floats = np.empty((0, 0))
        self.offsets: Ints = np.zeros(len(nodes) + 1, dtype=np.int64)
        boxes = [node.boxes(headings) for node in nodes]
        self._fill(
            [(own, np.zeros((len(own), 2)), np.zeros(len(own)), np.zeros((len(own), 0))) for own in boxes]
        )

    @property
    def spans(self) -> list[tuple[int, int]]:
        """Where the cells of each node begin and end."""
        return list(itertools.pairwise(self.offsets.tolist()))

    def _fill(self, columns: list[tuple[Floats, Floats, Floats, Floats]]) -> None:
        rows = []
        for node, (boxes, slopes, potential, back) in zip(self.nodes, columns, strict=True):
            cells = cells_of.cells(node.ring, node.hull, node.families, boxes)
            holds = cells[:, cells_of.HOLDS] > 0.0
            rows.append((boxes[holds], cells[holds], slopes[holds], potential[holds], back[holds]))
        self.boxes, self.values, self.slopes, self.potential, self.back = (
            np.concatenate(column) for column in zip(*rows, strict=True)
        )
        self.offsets = np.concatenate([[0], np.cumsum([len(row[0]) for row in rows])]).astype(np.int64)

    def split(self, chosen: Flags) -> None:
        """Put the parts of the chosen cells in their places."""
        columns = []
        for begin, end in self.spans:
            boxes, slopes, of = [], [], []
            for k in range(begin, end):
                parts, sloped = self.boxes[k : k + 1], self.slopes[k : k + 1]
                if chosen[k]:
                    parts, sloped = divided(self.boxes[k], self.values[k], self.slopes[k])
                boxes.append(parts)
                slopes.append(sloped)
                of += [k] * len(parts)
            columns.append((np.concatenate(boxes), np.concatenate(slopes), self.potential[of], self.back[of]))
        self._fill(columns)


def _unpriced(boxes: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    return boxes, np.zeros((len(boxes), 2)), np.zeros(len(boxes)), np.zeros((len(boxes), 0))


def trees_bound_m(
    nodes: list[Node],
    start: Floats,
    end: Floats,
    radius_m: float,
    known_m: float,
    effort: int,
    stop: Stop,
    allowance: Allowance | None = None,
) -> float:
    """No tour through one pass of each node is shorter.

    Parameters
    ----------
    start, end
        See ``nodes.terminal``.
    known_m
        Length of a known tour: sets the steps of the ascent.
    effort
        Lines between cells to evaluate.
    allowance
        For the search for a better bound.
    """
    allowance = allowance or Allowance()
    middles = np.array([node.middle for node in nodes])
    region = np.array([node.region for node in nodes], dtype=np.int64)
    order = np.array(tour.order(middles, tuple(start[:2]), tuple(end[:2]), "exact"), dtype=np.int64)
    cells = _Cells(nodes, HEADINGS)
    _in_order(cells, order, region, start, end, radius_m)
    allowance.spend(LINES_IN_ORDER * len(nodes))
    gaps_m = np.hypot(*(middles[:, None, :] - middles[None, :, :]).transpose(2, 0, 1))
    pairs = _pairs(gaps_m, order)
    price = np.zeros(len(nodes))
    cells.back = np.zeros((len(cells.potential), kernels.places(pairs, len(nodes))[1]))
    best_m, spent = 0.0, 0
    for _ in range(ROUNDS):
        raise_if(stop)
        if allowance.over:
            break
        counts = np.diff(cells.offsets)
        begins = np.concatenate([[0], np.cumsum(counts[pairs[:, 0]] * counts[pairs[:, 1]])]).astype(np.int64)
        spent += int(begins[-1])
        work = (1.0 + LINES_ASCENT) * begins[-1]
        if best_m > 0.0 and (spent > effort or work > allowance.left):
            break
        allowance.spend(work)
        between = kernels.blocks(cells.values, cells.slopes, cells.offsets, region, pairs, begins, radius_m)
        at = kernels.Prices(price, cells.potential, np.ascontiguousarray(cells.back.T))
        at, best, state = at.copied(), at.copied(), np.array([-np.inf, 1.0, 0.0])
        used, came, went = (np.full(len(cells.potential), fill, dtype=np.int64) for fill in (0, -2, -2))
        fixed = (
            between,
            begins,
            pairs,
            _apart(cells, middles, gaps_m),
            tables.terminals(start, cells.values, cells_of.ENTRY, cells.slopes, radius_m),
            tables.terminals(end, cells.values, cells_of.EXIT, cells.slopes, radius_m),
            np.abs(cells.slopes).sum(axis=1),
            cells.offsets,
        )
        for _ in range(STEPS // LOOK):
            if not kernels.ascent(*fixed, at, best, used, came, went, state, known_m, LOOK) or allowance.told:
                break
        bound_m, (price, cells.potential, back) = float(state[0]), best
        cells.back = back.T
        gained = bound_m - best_m
        best_m = max(best_m, bound_m)
        if gained < LEAST_GAIN * known_m:
            break
        passed = (came >= -1) & (went >= -1)
        ends = (np.where(passed, came, -1), np.where(passed, went, -1))
        better = tables.better_slopes(cells.values, cells.slopes, *ends, start, end, radius_m)
        cells.slopes = np.where(passed[:, None], better, cells.slopes)
        cells.split(_most(cells, used.astype(np.float64), used > USED * STEPS, lambda _: MOST_SPLIT))
    return best_m


def _in_order(cells: _Cells, order: Ints, region: Ints, start: Floats, end: Floats, radius_m: float) -> None:
    """Give cells slopes and potentials by the tour in this order; split those with the least tours."""
    for splits in (False, True, None):
        ahead, behind, prior, after = kernels.along_order(
            order, cells.values, cells.slopes, cells.offsets, region, start, end, radius_m
        )
        cells.slopes = tables.better_slopes(cells.values, cells.slopes, prior, after, start, end, radius_m)
        through = ahead + behind
        if splits:
            everywhere = np.isfinite(through)
            cells.split(_most(cells, -through, everywhere, lambda n: min((MOST_IN_ORDER - n) // 3, n // 6)))
    for begin, end_ in cells.spans:
        best = begin + int(np.argmin(through[begin:end_]))
        known = np.isfinite(through[begin:end_])
        if known.any():
            to, fro = ahead[begin:end_][known], behind[begin:end_][known]
            cells.potential[begin:end_][known] = 0.5 * ((to - ahead[best]) - (fro - behind[best]))


def _most(cells: _Cells, worth: Floats, allowed: Flags, room: Callable[[int], int]) -> Flags:
    """The cells worth most, of each node as many as there is room for among so many."""
    chosen = np.zeros(len(worth), dtype=np.bool_)
    for begin, end in cells.spans:
        best = begin + np.argsort(-worth[begin:end], kind="stable")[: max(room(end - begin), 0)]
        chosen[best] = allowed[best]
    return chosen


def _pairs(gaps_m: Floats, order: Ints) -> Ints:
    """Neighbours and those that follow each other in the order, both ways, (P, 2)."""
    nearest = np.argsort(gaps_m + np.where(np.eye(len(gaps_m)) > 0.0, np.inf, 0.0), axis=1, kind="stable")
    near = np.zeros(gaps_m.shape, dtype=np.bool_)
    np.put_along_axis(near, nearest[:, : min(NEAREST, len(gaps_m) - 1)], True, axis=1)
    near[order[:-1], order[1:]] = True
    return np.argwhere((near | near.T) & ~np.eye(len(gaps_m), dtype=np.bool_)).astype(np.int64)


def _apart(cells: _Cells, middles: Floats, gaps_m: Floats) -> Floats:
    """Least cost between nodes by how far apart they are, (C, C), inf from one to itself."""
    known = [
        kernels.reach(cells.values[begin:end], middle)
        for (begin, end), middle in zip(cells.spans, middles, strict=True)
    ]
    reach_m, inner_m = np.array(known).T
    apart_m = np.maximum(gaps_m - reach_m[:, None] - reach_m[None, :], 0.0) + inner_m[None, :]
    np.fill_diagonal(apart_m, np.inf)
    return np.asarray(apart_m, dtype=np.float64)
