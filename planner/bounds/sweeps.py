"""The lower bound for regions of many strips: what a stay at each takes, and the way from one to the next.

Of the parallel strips that hold a region, as many as there are at least at a heading, every one is flown as
far as the region surely reaches in it, and after each but the last of a stay comes a turn into another
(``sweeps_kernels.stays``). Stays are held in cells of headings; from one to the next it is no shorter
than from where some pass of the one may end to where some pass of the other may begin.

Passes of a region may be parted: a tour may stay at it several times, m times with n passes, and then has
n − m of its turns, each t or longer. So a tour is no shorter than one with a single stay at each region, the
ways between possibly stopping at others, where a stop at r between X and Y is counted as
d(X, r) + d(r, Y) − s, moves within r as nothing, if

- a single stay that begins and ends where the first of several does is counted no higher than all passes,
  n − 2 turns and s, and n − 2 turns with s are no less than n − 1 turns (t ≤ s);
- s is no more than any way out of r, so that stops never gain by themselves.

Where ways out are shorter than turns, turns are counted no longer than these. With ways so shortened (all of
them, by the shortest paths among regions) dynamic programming over subsets of regions and last cells gives
the bound.
"""

from __future__ import annotations

import heapq
import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planner.bounds import sets_kernels
from planner.bounds import sweeps_kernels as kernels
from planner.bounds.allowance import Allowance
from planner.bounds.nodes import Node
from planner.progress import Stop, raise_if

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

#: Headings looked at one by one, at least and at most, parts of the offsets; up to how many regions how many
#: of the least headings are a cell.
HEADINGS, MOST_HEADINGS, ETAS, PER_CELL = 90, 360, 3, {5: 3, 7: 6, 9: 15, 12: 30}
#: Within half a heading's range no point of a region moves by more than this part of a swath.
MOVED = 0.125
#: Allowed headings are known to this, and taken for each other's opposites within this.
ROUNDING_RAD, SAME_RAD = 1e-8, 2e-4
#: Ways between ends of stays to look at.
EFFORT = 60_000_000
#: Lines between cells that take as long as a tour and a way looked at, and as the stays at a region of so
#: many strips: of their square and their cube.
LINES_EACH, LINES_PER_WAY, LINES_PER_STRIP2, LINES_PER_STRIP3 = 800.0, 0.005, 500.0, 10.0
#: Regions up to which the order is searched.
MOST_ORDERED = 12


@dataclass(frozen=True, slots=True)
class _Stays:
    """All stays at one region.

    Parameters
    ----------
    passes_m, turn_m, turns_m
        Of each heading, group and part of the offsets, (H, G, K), and (H, G, K, 4, 4) by where a stay begins
        and ends: all passes, the least turn between two, all turns; inf where there are none.
    turns
        How many turns there are between the passes of each group, (G,).
    sets, thetas
        Of each cell, (C, 4, L, 2, 4) and (C,): where passes begin and end, in axes turned by its heading.
    """

    passes_m: Floats
    turn_m: Floats
    turns_m: Floats
    turns: Floats
    sets: Floats
    thetas: Floats

    @property
    def cells(self) -> int:
        """How many cells there are."""
        return len(self.thetas)

    def costs_m(self, cap_m: float) -> Floats:
        """Least of each cell's stays by where it begins and ends, (C, 4, 4); see ``_capped_m``."""
        whole_m = self.passes_m[..., None, None] + self._capped_m(cap_m)
        least_m = whole_m.min(axis=(1, 2)).reshape(self.cells, -1, 4, 4).min(axis=1)
        return np.asarray(least_m, dtype=np.float64)

    def saved_m(self, cap_m: float) -> Floats:
        """What leaving the region once more may save at most, of all that ``costs_m`` counts, (C,)."""
        turns_m = self._capped_m(cap_m)
        saved_m = turns_m - self._fewer(cap_m)[..., None, None]
        counts = np.isfinite(turns_m) & np.isfinite(self.passes_m)[..., None, None]
        counts &= (self.turns > 0.0)[:, None, None, None]
        most_m = np.where(counts, saved_m, 0.0).max(axis=(1, 2, 3, 4))
        return np.asarray(most_m.reshape(self.cells, -1).max(axis=1), dtype=np.float64)

    def _capped_m(self, cap_m: float) -> Floats:
        """All turns of a stay, but no more than without one of them, and ``cap_m`` for leaving once more."""
        split_m = np.where(self.turns[:, None] > 0.0, self._fewer(cap_m) + cap_m, np.inf)
        return np.minimum(self.turns_m, split_m[..., None, None])

    def _fewer(self, cap_m: float) -> Floats:
        """All turns but one, each no longer than a way out."""
        turn_m = np.minimum(np.where(np.isfinite(self.turn_m), self.turn_m, 0.0), cap_m)
        return np.asarray(np.maximum(self.turns - 1.0, 0.0)[:, None] * turn_m, dtype=np.float64)


@dataclass(frozen=True, slots=True)
class _Ways:
    """All stays, and the ways from the start, between them and to the end.

    Parameters
    ----------
    found
        Of each region.
    first_m, between_m, last_m
        To where stays begin, from where they end: four ends to a cell, all regions' one after the other.
    """

    found: tuple[_Stays, ...]
    first_m: Floats
    between_m: Floats
    last_m: Floats

    def least_m(self, cells: tuple[Ints, ...]) -> float:
        """No tour with stays of these cells of each region alone is shorter."""
        counts = [len(own) for own in cells]
        before = np.cumsum([0, *(stays.cells for stays in self.found)])
        chosen = np.concatenate([own + begin for own, begin in zip(cells, before, strict=False)])
        ends = (4 * chosen[:, None] + np.arange(4)).ravel()
        offsets = np.concatenate([[0], np.cumsum(counts)]).astype(np.int64)
        regions = 4 * offsets[:-1]
        first_m, between_m, last_m = self.first_m[ends], self.between_m[np.ix_(ends, ends)], self.last_m[ends]
        # Of each end to each region, of each region to each beginning, of region to region.
        into_m = np.minimum.reduceat(between_m, regions, axis=1)
        out_m = np.minimum.reduceat(between_m, regions, axis=0)
        apart_m = np.minimum.reduceat(into_m, regions, axis=0)
        caps = list(zip(self.found, cells, apart_m.min(axis=1).tolist(), strict=True))
        saved_m = np.array([stays.saved_m(cap)[own].max() for stays, own, cap in caps])
        costs_m = np.concatenate([stays.costs_m(cap)[own] for stays, own, cap in caps])
        ways_m = _shortest(apart_m - saved_m[:, None])
        onward_m = (ways_m[:, :, None] + (out_m - saved_m[:, None])[None, :, :]).min(axis=1)
        to_end_m = (ways_m + (np.minimum.reduceat(last_m, regions) - saved_m)[None, :]).min(axis=1)
        first_by_m = np.minimum.reduceat(first_m, regions)
        first_m = np.minimum(first_m, _through(first_by_m[None, :], onward_m)[0])
        last_m = np.minimum(last_m, _through(into_m, to_end_m[:, None])[:, 0])
        between_m = np.minimum(between_m, _through(into_m, onward_m))
        if len(counts) <= MOST_ORDERED:
            return float(sets_kernels.least_tour(first_m, between_m, last_m, costs_m, offsets))
        least_m = np.minimum.reduceat(np.minimum.reduceat(between_m, regions, axis=0), regions, axis=1)
        total_m = np.minimum.reduceat(costs_m.min(axis=(1, 2)), offsets[:-1]).sum()
        return float(total_m + first_m.min() + last_m.min() + _least_tree_m(np.minimum(least_m, least_m.T)))


def sweeps_bound_m(
    nodes: Sequence[Node],
    start: Floats,
    end: Floats,
    radius_m: float,
    target_m: float,
    stop: Stop,
    allowance: Allowance | None = None,
) -> float:
    """No tour that stays at each region at least once, and flies all its strips, is shorter.

    The ranges of the regions' headings are halved, the widest first, where the bound is least: passes of a
    region that are parted have one heading all the same, and other regions lie farther from them.

    Parameters
    ----------
    nodes
        One of each region.
    start, end
        See ``nodes.terminal``.
    target_m
        Nothing better is looked for.
    allowance
        For the search for a better bound.
    """
    allowance = allowance or Allowance()
    per_cell = next((headings for most, headings in PER_CELL.items() if len(nodes) <= most), HEADINGS)
    found = []
    for node in nodes:
        raise_if(stop)
        found.append(_stays(node, radius_m, per_cell))
        allowance.spend(_lines_of_stays(node))
    looks = max(stays.sets.shape[2] for stays in found)
    sets = np.concatenate([_padded(stays.sets, looks) for stays in found])
    thetas = np.concatenate([stays.thetas for stays in found])
    ways = _Ways(
        tuple(found),
        sets_kernels.from_place(start[:2], sets, thetas, 0),
        sets_kernels.distances(sets, thetas, np.repeat(np.arange(len(found)), [s.cells for s in found])),
        sets_kernels.from_place(end[:2], sets, thetas, 1),
    )
    every = tuple(np.arange(stays.cells) for stays in found)
    count = itertools.count()
    heap = [(ways.least_m(every), next(count), every)]
    spent = _work(every)
    allowance.spend(_lines(spent))
    while heap and heap[0][0] < target_m and spent < EFFORT and not allowance.over:
        raise_if(stop)
        bound_m, _, cells = heap[0]
        # Of a region seen in one pass nothing is parted.
        widest = max(range(len(cells)), key=lambda k: len(cells[k]) * bool(found[k].turns.max() > 0.0))
        if len(cells[widest]) < 2 or found[widest].turns.max() == 0.0:
            break
        heapq.heappop(heap)
        for half in np.array_split(cells[widest], 2):
            part = (*cells[:widest], half, *cells[widest + 1 :])
            spent += _work(part)
            allowance.spend(_lines(_work(part)))
            heapq.heappush(heap, (max(bound_m, ways.least_m(part)), next(count), part))
    least_m = heap[0][0]
    return least_m if math.isfinite(least_m) else 0.0


def _work(cells: tuple[Ints, ...]) -> int:
    """What it takes to find the least tour over these cells, about, in ways looked at."""
    ends = 4 * sum(len(own) for own in cells)
    return ends * ends * (2 + (1 << min(len(cells), MOST_ORDERED)) // 4) + 20_000


def _lines(work: int) -> float:
    """Lines between cells that take as long."""
    return LINES_EACH + work * LINES_PER_WAY


def _lines_of_stays(node: Node) -> float:
    """Lines between cells that take as long as finding all stays at one region."""
    strips = float(node.families[:, 8].max())
    return 0.0 if node.seen.one_place else LINES_PER_STRIP2 * strips**2 + LINES_PER_STRIP3 * strips**3


def _least_tree_m(apart_m: Floats) -> float:
    """Least tree over all regions (R. C. Prim)."""
    joined = np.zeros(len(apart_m), dtype=np.bool_)
    reach_m, total_m = np.where(np.arange(len(apart_m)) == 0, 0.0, np.inf), 0.0
    for _ in range(len(apart_m)):
        nearest = int(np.argmin(np.where(joined, np.inf, reach_m)))
        total_m += float(reach_m[nearest])
        joined[nearest] = True
        reach_m = np.minimum(reach_m, apart_m[nearest])
    return total_m


def _stays(node: Node, radius_m: float, per_cell: int) -> _Stays:
    if node.seen.one_place:
        return _anywhere(node)
    families = node.families
    looks = np.unique(families[:, 1])
    groups = np.unique(node.group)
    rows = np.full((len(groups), len(looks), int(families[:, 8].max())), -1, dtype=np.int64)
    for k, (family, group) in enumerate(zip(families, node.group, strict=True)):
        rows[np.searchsorted(groups, group), np.searchsorted(looks, family[1]), int(family[10])] = k
    thetas, alpha, ways = _headings(node)
    per_cell = per_cell * len(thetas) // HEADINGS if node.approach_rad is None else 1
    passes_m, turn_m, turns_m, sets = kernels.stays(
        node.ring, node.hull, families, rows, thetas, alpha, ways, ETAS, per_cell, radius_m
    )
    middles = 0.5 * (thetas[::per_cell] + thetas[per_cell - 1 :: per_cell])
    counts = families[rows[:, 0, 0], 8]
    # However they are laid, passes see no more than a swath for each metre beside run-in and run-out.
    passes_m = np.maximum(passes_m, node.seen.by_area_m + counts[:, None] * node.seen.around_m)
    found = _Stays(passes_m, turn_m, turns_m, counts - 1.0, sets, middles)
    return _joined(found, node, radius_m) if node.seen.joined else found


def _joined(stays: _Stays, node: Node, radius_m: float) -> _Stays:
    """Stays that begin and end with passes over other regions near it, too, wherever these may lie.

    The straight part of a turn may see one of these; half a turn is left of each.
    """
    half_m = math.pi * radius_m
    turns_m = np.minimum(stays.turns_m, stays.turns[:, None, None, None] * half_m)
    turns_m = np.where(np.isfinite(stays.turns_m), turns_m, np.inf)
    turn_m = np.minimum(stays.turn_m, half_m)
    return _Stays(stays.passes_m, turn_m, turns_m, stays.turns, _within(node), np.zeros(1))


def _padded(sets: Floats, looks: int) -> Floats:
    """Sets of one region with so many looks, those that are not there empty."""
    out = np.full((*sets.shape[:2], looks, *sets.shape[3:]), np.inf)
    out[..., [sets_kernels.MOST_X, sets_kernels.MOST_Y]] = -np.inf
    out[:, :, : sets.shape[2]] = sets
    return out


def _anywhere(node: Node) -> _Stays:
    """Stays of many strips: nothing is counted but how much ground they see, and how many they are."""
    passes_m = np.full((1, 1, 1), node.seen.by_area_m + node.seen.fewest * node.seen.around_m)
    none = np.zeros((1, 1, 1))
    return _Stays(passes_m, none, np.zeros((1, 1, 1, 4, 4)), np.zeros(1), _within(node), np.zeros(1))


def _within(node: Node) -> Floats:
    """Sets of ends anywhere within reach of the ground seen."""
    sets = np.empty((1, 4, 1, 2, 4))
    (sets[..., sets_kernels.LEAST_X], sets[..., sets_kernels.LEAST_Y]) = node.seen.extent[0]
    (sets[..., sets_kernels.MOST_X], sets[..., sets_kernels.MOST_Y]) = node.seen.extent[1]
    return sets


def _headings(node: Node) -> tuple[Floats, float, Flags]:
    """Headings from 0 to π, half the range of each, and whether they and their opposites are flown."""
    if node.approach_rad is None:
        far_m, swath_m = float(np.hypot(*node.hull.T).max()), float(node.families[:, 3].min())
        finer = math.ceil(0.5 * math.pi * far_m / (MOVED * swath_m * HEADINGS))
        count = HEADINGS * min(max(finer, 1), MOST_HEADINGS // HEADINGS)
        alpha = 0.5 * math.pi / count
        around = alpha * (2.0 * np.arange(count, dtype=np.float64) + 1.0)
        return around, alpha, np.ones((count, 2), dtype=np.bool_)
    allowed = np.asarray(node.approach_rad, dtype=np.float64)
    thetas: Floats = np.unique(np.round(np.mod(allowed, math.pi), 9)).astype(np.float64)
    flown = thetas[:, None, None] + np.array([0.0, math.pi])[None, :, None]
    apart = np.abs(np.mod(allowed - flown + math.pi, 2.0 * math.pi) - math.pi)
    return thetas, ROUNDING_RAD, (apart <= SAME_RAD).any(axis=2)


def _shortest(ways_m: Floats) -> Floats:
    """Shortest ways from region to region, through others where that is shorter, (R, R); none to itself."""
    out = ways_m.copy()
    np.fill_diagonal(out, 0.0)
    for k in range(len(out)):
        out = np.minimum(out, out[:, k : k + 1] + out[k : k + 1, :])
    return out


def _through(first_m: Floats, then_m: Floats) -> Floats:
    """Least over what lies between of the one and then the other, (N, R) and (R, M), (N, M)."""
    return np.asarray((first_m[:, :, None] + then_m[None, :, :]).min(axis=1), dtype=np.float64)
