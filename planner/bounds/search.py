"""The lower bound for few passes: exact over the order, over cells that are split where it pays.

A *problem* is a set of boxes for each node. Dynamic programming over subsets of nodes gives the least tour
through each cell, over all orders. Cells and pairs of neighbours in the order that no tour shorter than the
target goes through are dropped; cells with the shortest tours are split; slopes follow the best tours.
Problems are worked on in the order of their bounds, least first, so that the least of them is the bound.

The passes of a region with several nodes are flown along one direction, and belong to one group: problems are
divided by group, then by direction until that is known as well as cells are fine.
"""

from __future__ import annotations

import heapq
import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from planner.bounds import cells_kernels as cells_of
from planner.bounds import lines_kernels as lines
from planner.bounds import tables_kernels as tables
from planner.bounds import tours_kernels as tours
from planner.bounds.allowance import Allowance
from planner.bounds.nodes import Node, divided
from planner.progress import Stop, raise_if

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

#: Headings of the first boxes, up to so many nodes and beyond; and where little work is allowed for, so that
#: the first problem takes no more than this part of it.
HEADINGS, FEW, HEADINGS_BEYOND, HEADINGS_LEAST, FIRST_PART = 48, 9, 24, 12, 0.5
#: Directions of a region's two passes are divided once they span this many times its finest cell's.
WIDE = 16.0
#: What it takes in lines between cells: a cell; and two cells, as a part, for being there and for each set of
#: the other nodes that may come before them.
WORK_EACH, WORK_PAIR, WORK_SET = 10, 1.0 / 10.0, 1.0 / 200.0
#: No problem is begun that takes more than this many times what is left.
MOST_OVER = 1.5
#: Problems to begin with.
MOST_FIRST = 64
#: The search ends so close below a tour of the relaxed problem.
CLOSE = 0.01
#: Of the open cells, the part split at a time, and at least how many.
SPLIT, LEAST_SPLIT = 0.6, 8


@dataclass(frozen=True, slots=True)
class _Problem:
    """Boxes of each node with their slopes and the bounds known of tours through them.

    Parameters
    ----------
    boxes, slopes, known_m
        Of each node: (B, 5), (B, 2), (B,).
    parent, open_pairs
        For each box in turn, which cell it is part of, int64 (N,), and which of those cells may come right
        after which, bool; None where all may.
    directions
        For each region with several nodes, from where to where its passes' directions lie, from 0 to π.
    """

    boxes: tuple[Floats, ...]
    slopes: tuple[Floats, ...]
    known_m: tuple[Floats, ...]
    parent: tuple[Ints, ...]
    open_pairs: Flags | None
    directions: dict[int, tuple[float, float]]

    @property
    def sloped(self) -> bool:
        """Whether slopes have been found."""
        return self.open_pairs is not None


@dataclass(frozen=True, slots=True)
class _Solved:
    """The cells of a problem, all nodes' one after the other, the least tours through them, and the work.

    ``flown_m`` is the length of about the tour that bounds the problem, through the middles of its cells.
    """

    boxes: Floats
    cells: Floats
    slopes: Floats
    known_m: Floats
    offsets: Ints
    open_pairs: Flags
    work: int
    flown_m: float


def exact_bound_m(
    nodes: list[Node],
    start: Floats,
    end: Floats,
    radius_m: float,
    targets_m: tuple[float, ...],
    effort: int,
    stop: Stop,
    allowance: Allowance | None = None,
    shared: Flags | None = None,
) -> float:
    """No tour through one pass of each node is shorter.

    Parameters
    ----------
    start, end
        See ``nodes.terminal``.
    targets_m
        Bounds worth proving, ascending: nothing better than the last is looked for, and each is proved with
        less effort than the next.
    effort
        Lines between cells to evaluate, or as much work.
    stop, allowance
        The one cancels; the other is for the search for a better bound.
    shared
        Of which two regions passes may be parts of one, bool (R, R): a tour then goes from the end of one
        straight on to that of the other. Tours visit nodes in the order of their passes' ends.
    """
    allowance = allowance or Allowance()
    if shared is None:
        regions = 1 + max(node.region for node in nodes)
        shared = np.zeros((regions, regions), dtype=np.bool_)
    best_m = 0.0
    for node in nodes:
        cells = cells_of.cells(node.ring, node.hull, node.families, node.boxes(HEADINGS_BEYOND))
        if not (cells[:, cells_of.HOLDS] > 0.0).any():
            # Nothing is known of how it is seen.
            return best_m
    for target_m in targets_m:
        found_m, spent = _prove(nodes, start, end, radius_m, target_m, effort, stop, allowance, shared)
        best_m = max(best_m, found_m)
        # The next takes several times as much, or there is hardly more to prove.
        if found_m < target_m or spent > effort // 8 or allowance.over:
            break
        effort -= spent
    return best_m


def _prove(
    nodes: list[Node],
    start: Floats,
    end: Floats,
    radius_m: float,
    target_m: float,
    effort: int,
    stop: Stop,
    allowance: Allowance,
    shared: Flags,
) -> tuple[float, int]:
    """The bound, at most the target, and the lines evaluated."""
    count = itertools.count()
    heap = [(0.0, next(count), problem) for problem in _first(nodes, _headings(nodes, allowance))]
    spent = 0
    while heap and heap[0][0] < target_m and spent + _least_work(heap[0][2]) < effort:
        raise_if(stop)
        if _least_work(heap[0][2]) > allowance.left or allowance.over:
            break
        if _pairs_of(heap[0][2]) > MOST_OVER * allowance.left:
            break
        bound_m, _, problem = heapq.heappop(heap)
        solved = _solve(nodes, problem, start, end, radius_m, target_m, shared)
        if solved is None:
            continue
        spent += solved.work
        allowance.spend(solved.work)
        target_m = min(target_m, (1.0 - CLOSE) * solved.flown_m)
        bound_m = max(bound_m, float(solved.known_m.min()))
        if bound_m >= target_m:
            continue
        for part in _parts_of(nodes, problem, solved, target_m):
            heapq.heappush(heap, (bound_m, next(count), part))
    return min([target_m, *(item[0] for item in heap[:1])]), spent


def _headings(nodes: list[Node], allowance: Allowance) -> int:
    """How many headings the first boxes are of."""
    headings = HEADINGS if len(nodes) <= FEW else HEADINGS_BEYOND
    while headings > HEADINGS_LEAST:
        count = sum(len(node.boxes(headings)) for node in nodes)
        if _work_on(count, len(nodes)) + count * count <= FIRST_PART * allowance.left:
            break
        headings //= 2
    return headings


def _first(nodes: list[Node], headings: int) -> Iterator[_Problem]:
    """A problem for each choice of groups of regions with several nodes, of as many as there is room for."""
    several = sorted({node.region for node in nodes if node.strip})
    groups = {node.region: sorted(set(node.group.tolist())) for node in nodes if node.strip}
    count, chosen_of = 1, []
    for region in sorted(several, key=lambda region: len(groups[region])):
        count *= len(groups[region])
        if count <= MOST_FIRST:
            chosen_of.append(region)
    for chosen in itertools.product(*(groups[region] for region in chosen_of)):
        of_region = dict(zip(chosen_of, chosen, strict=True))
        boxes = []
        for node in nodes:
            own = node.boxes(headings)
            if node.region in of_region:
                own = own[node.group[own[:, 0].astype(np.int64)] == of_region[node.region]]
            boxes.append(own)
        yield _Problem(
            tuple(boxes),
            tuple(np.zeros((len(own), 2)) for own in boxes),
            tuple(np.zeros(len(own)) for own in boxes),
            tuple(np.zeros(len(own), dtype=np.int64) for own in boxes),
            None,
            dict.fromkeys(several, (0.0, math.pi)),
        )


def _solve(
    nodes: list[Node],
    problem: _Problem,
    start: Floats,
    end: Floats,
    radius_m: float,
    target_m: float,
    shared: Flags,
) -> _Solved | None:
    """The least tours through all cells; None where a node has no cell left below the target."""
    kept: list[tuple[NDArray[np.generic], ...]] = []
    for node, boxes, slopes, known_m, parent in zip(
        nodes, problem.boxes, problem.slopes, problem.known_m, problem.parent, strict=True
    ):
        cells = cells_of.cells(node.ring, node.hull, node.families, boxes)
        open_ = (cells[:, cells_of.HOLDS] > 0.0) & (known_m < target_m)
        if not open_.any():
            return None
        kept.append((boxes[open_], cells[open_], slopes[open_], known_m[open_], parent[open_]))
    boxes, cells, slopes, known_m, parent = (np.concatenate(column) for column in zip(*kept, strict=True))
    offsets = np.concatenate([[0], np.cumsum([len(rows[0]) for rows in kept])]).astype(np.int64)
    region = np.array([node.region for node in nodes])
    pairs = np.ones((len(boxes), len(boxes)), dtype=np.bool_)
    if problem.open_pairs is not None:
        pairs = problem.open_pairs[parent][:, parent]
    looks = np.concatenate(
        [node.families[rows[0][:, 0].astype(np.int64), 1] for node, rows in zip(nodes, kept, strict=True)]
    )
    between, evaluated = tables.matrix(cells, offsets, region, looks, shared, pairs, slopes, radius_m)
    first = tables.terminals(start, cells, cells_of.ENTRY, slopes, radius_m)
    last = tables.terminals(end, cells, cells_of.EXIT, slopes, radius_m)
    ahead = tours.ahead_costs(first, between, offsets)
    behind = tours.ahead_costs(last, np.ascontiguousarray(between.T), offsets)
    through, prior, after = tours.through_costs(ahead, behind, between, offsets)
    return _Solved(
        boxes,
        cells,
        tables.better_slopes(cells, slopes, prior, after, start, end, radius_m),
        np.maximum(known_m, through),
        offsets,
        tours.short_pairs(ahead, behind, between, offsets, target_m),
        evaluated + _least_work(problem),
        _flown_m(nodes, boxes, offsets, _chain(int(np.argmin(through)), prior, after), start, end, radius_m),
    )


def _chain(cell: int, prior: Ints, after: Ints) -> list[int]:
    """The cells of the least tour through one, in order."""
    chain = [cell]
    while prior[chain[0]] >= 0 and len(chain) <= len(prior):
        chain.insert(0, int(prior[chain[0]]))
    while after[chain[-1]] >= 0 and len(chain) <= len(prior):
        chain.append(int(after[chain[-1]]))
    return chain


def _flown_m(
    nodes: list[Node],
    boxes: Floats,
    offsets: Ints,
    chain: list[int],
    start: Floats,
    end: Floats,
    radius_m: float,
) -> float:
    """Length of a tour through the middle passes of cells; inf where it is none."""
    of_node = [int(np.searchsorted(offsets, cell, side="right")) - 1 for cell in chain]
    if sorted(of_node) != list(range(len(nodes))):
        return math.inf
    passes = []
    for cell, k in zip(chain, of_node, strict=True):
        middle = boxes[cell] * np.array([1.0, 1.0, 0.0, 1.0, 0.0])
        node = nodes[k]
        found = cells_of.cell(node.ring, node.hull, node.families[int(middle[0])], middle)
        # Of passes that are to be parallel the middles rarely are.
        if found[cells_of.HOLDS] == 0.0 or node.strip:
            return math.inf
        passes.append(found)
    none, gains = np.zeros(2), np.empty(4)
    total_m = lines.from_terminal(start, passes[0], cells_of.ENTRY, none, radius_m, gains[:2])
    for one, other in itertools.pairwise(passes):
        total_m += lines.between(one, other, none, none, radius_m, gains)
    return float(total_m + lines.from_terminal(end, passes[-1], cells_of.EXIT, none, radius_m, gains[:2]))


def _least_work(problem: _Problem) -> int:
    """What solving a problem takes besides lines between its cells."""
    return _work_on(sum(len(boxes) for boxes in problem.boxes), len(problem.boxes))


def _pairs_of(problem: _Problem) -> float:
    """Lines between its cells that may be part of short tours, about."""
    counts = np.array([len(boxes) for boxes in problem.boxes], dtype=np.float64)
    part = 1.0 if problem.open_pairs is None else float(problem.open_pairs.mean())
    return part * float(counts.sum() ** 2 - (counts**2).sum())


def _work_on(count: int, nodes: int) -> int:
    sets = 2.0 ** (nodes - 2)
    return int(count * WORK_EACH + count * count * (WORK_PAIR + sets * WORK_SET))


def _parts_of(nodes: list[Node], problem: _Problem, solved: _Solved, target_m: float) -> Iterator[_Problem]:
    """Problems that together hold all tours of one that may be shorter than the target."""
    known_m, open_ = solved.known_m, solved.known_m < target_m
    split = np.zeros(len(open_), dtype=np.bool_)
    region = _widest(nodes, problem, solved) if problem.sloped else None
    halves: list[tuple[float, float] | None] = [None]
    if region is not None:
        low, high = problem.directions[region]
        halves = [(low, 0.5 * (low + high)), (0.5 * (low + high), high)]
    elif problem.sloped:
        split[np.argsort(known_m, kind="stable")[: max(int(open_.sum() * SPLIT), LEAST_SPLIT)]] = True
        split &= open_
    for half in halves:
        kept = open_ if half is None else open_ & _along(nodes, solved, region, half)
        if not all(kept[begin:end].any() for begin, end in itertools.pairwise(solved.offsets)):
            continue
        columns = [_rows(solved, kept, split, *ends) for ends in itertools.pairwise(solved.offsets)]
        boxes, slopes, bounds_m, parent = zip(*columns, strict=True)
        directions = problem.directions
        if region is not None and half is not None:
            directions = directions | {region: half}
        yield replace(
            problem,
            boxes=boxes,
            slopes=slopes,
            known_m=bounds_m,
            parent=parent,
            open_pairs=solved.open_pairs,
            directions=directions,
        )


def _rows(
    solved: _Solved, kept: Flags, split: Flags, begin: int, end: int
) -> tuple[Floats, Floats, Floats, Ints]:
    """Boxes, slopes, bounds and origins of one node's cells that are kept, those to be split in parts."""
    whole = np.array([k for k in range(begin, end) if kept[k] and not split[k]], dtype=np.int64)
    boxes, slopes, parent = [solved.boxes[whole]], [solved.slopes[whole]], [whole]
    for k in range(begin, end):
        if not kept[k] or not split[k]:
            continue
        parts, sloped = divided(solved.boxes[k], solved.cells[k], solved.slopes[k])
        boxes.append(parts)
        slopes.append(sloped)
        parent.append(np.full(len(parts), k, dtype=np.int64))
    origin = np.concatenate(parent)
    return np.concatenate(boxes), np.concatenate(slopes), solved.known_m[origin], origin


def _widest(nodes: list[Node], problem: _Problem, solved: _Solved) -> int | None:
    """The region whose passes' direction is known worst, if that is much worse than its cells are fine."""
    if not problem.directions:
        return None
    region = max(problem.directions, key=lambda r: problem.directions[r][1] - problem.directions[r][0])
    low, high = problem.directions[region]
    finest = min(
        float(solved.boxes[begin:end, 2].min())
        for node, (begin, end) in zip(nodes, itertools.pairwise(solved.offsets), strict=True)
        if node.region == region
    )
    return region if finest > 0.0 and high - low > WIDE * 2.0 * finest + 1e-9 else None


def _along(nodes: list[Node], solved: _Solved, region: int | None, half: tuple[float, float]) -> Flags:
    """Which cells hold passes along some direction of a range; all those of other regions."""
    middle, reach = 0.5 * (half[0] + half[1]), 0.5 * (half[1] - half[0])
    apart = solved.boxes[:, 1] - middle
    apart -= math.pi * np.floor(apart / math.pi + 0.5)
    other = np.repeat([node.region != region for node in nodes], np.diff(solved.offsets))
    return np.asarray((np.abs(apart) <= reach + solved.boxes[:, 2] - 1e-9) | other, dtype=np.bool_)
