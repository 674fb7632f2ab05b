"""The lower bound where passes may be shared: over every way to share places among passes.

Every place to be seen is seen by some pass, and strips are convex: a pass that sees several places sees
their hull. So each plan parts the places into sets, one a pass, and is no shorter than a tour of passes that
see the sets' hulls, whole. Of some of the places alone no tour is longer. That makes a tree: at its root one
place has a set of its own; below, one more place joins one of the sets, if one pass may see it with these, or
has another. The place is the one furthest from all sets: what lies in the hull of a set is seen without being
asked for. Tours are bounded over cells (``search``), the least first, and the least of all is the bound.

Passes may have any heading: nothing is taken for granted of how a region is seen but that ones that a pass is
to see whole are seen so.
"""

from __future__ import annotations

import heapq
import itertools
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import Polygon

from planner.bounds.allowance import Allowance
from planner.bounds.nodes import PLACE_M, Node, nodes, terminal
from planner.bounds.search import exact_bound_m
from planner.bounds.units import Unit, alone, hull_of, in_one, outline, seen_at_once
from planner.progress import Stop, raise_if
from planner.route import Terminal
from planner.vehicle.model import FlightModel

Floats = NDArray[np.float64]

#: Lines between cells to evaluate for a tour of few sets, first and again while that proves so much more, as
#: a part; of more sets with the square of their number.
EFFORTS, FEW, WORTH = (25_000, 150_000, 900_000), 4, 0.005
#: Of all tours together, and the sets of one at most.
MOST_LINES, MOST_SETS = 5_000_000.0, 13
#: Up to so many sets those are not bounded below which there is one way to see one place more.
MOST_FORCED = 5
#: More is worth proving where that takes no more than this part of it.
LITTLE = 0.05
#: What it takes besides, in lines: to find the place asked for next, and to bound a tour.
LINES_NEXT, LINES_TOUR = 2_000.0, 10_000.0
#: A place no further than this from the hull of a set is seen with it.
WITHIN_M = 2.0 * PLACE_M


@dataclass(frozen=True, slots=True)
class _Shares:
    """Some places parted into sets: the hull of each, and the node that asks for a pass over it."""

    hulls: tuple[Polygon, ...]
    asked: tuple[Node, ...]


class _Places:
    """What is to be seen, each by one pass: a unit, or a place of one that passes may see in parts."""

    def __init__(self, found: Sequence[Unit], in_parts: Collection[int], settle_m: float) -> None:
        self._first = found[0]
        self._settle_m = settle_m
        self.hulls: list[Polygon] = []
        for k, unit in enumerate(found):
            if unit.whole and k not in in_parts:
                self.hulls.append(hull_of([unit.region.area]))
            else:
                self.hulls += [place.buffer(PLACE_M, quad_segs=1) for place in outline(unit)]
        corners = [shapely.get_coordinates(hull) for hull in self.hulls]
        self._corners = shapely.points(np.concatenate(corners))
        self._begins = np.cumsum([0, *(len(each) for each in corners[:-1])])

    def first(self, start: Floats, end: Floats) -> Polygon:
        """The place that is furthest from start and end."""
        off_m = sum(shapely.distance(self._corners, shapely.Point(at)) for at in (start[:2], end[:2]))
        return self.hulls[int(np.argmax(np.maximum.reduceat(off_m, self._begins)))]

    def next(self, shares: _Shares) -> Polygon | None:
        """The place that is furthest from all sets; None where all are seen with these."""
        off_m = np.stack([shapely.distance(self._corners, hull) for hull in shares.hulls])
        least_m = np.maximum.reduceat(off_m, self._begins, axis=1).min(axis=0)
        furthest = int(np.argmax(least_m))
        return self.hulls[furthest] if least_m[furthest] > WITHIN_M else None

    def asked(self, hull: Polygon, number: int) -> Node | None:
        """One pass over a set; None where no pass sees it."""
        region = alone(self._first.region, hull)
        if not seen_at_once(region, self._first.sensor, self._first.height_m):
            return None
        sides = in_one(region, self._first.sensor, self._first.height_m)
        return nodes(sides, self._settle_m, number)[0]

    def below(self, shares: _Shares, place: Polygon) -> Iterator[_Shares]:
        """All ways to see one more place: with one of the sets, or by another pass; none where none does."""
        for k, hull in enumerate(shares.hulls):
            both = hull_of([hull, place])
            node = self.asked(both, k)
            if node is not None:
                yield _Shares(
                    (*shares.hulls[:k], both, *shares.hulls[k + 1 :]),
                    (*shares.asked[:k], node, *shares.asked[k + 1 :]),
                )
        node = self.asked(place, len(shares.hulls))
        if node is not None:
            yield _Shares((*shares.hulls, place), (*shares.asked, node))


def alike(found: Sequence[Unit]) -> bool:
    """Whether any pass that may see one unit may see any other: one sensor, height and set of headings."""
    first = found[0]
    return all(
        unit.sensor == first.sensor
        and unit.height_m == first.height_m
        and unit.region.approach_rad == first.region.approach_rad
        and unit.visits == 1
        for unit in found
    )


def partitions_bound_m(
    found: Sequence[Unit],
    in_parts: Collection[int],
    ends: tuple[Terminal, Terminal],
    model: FlightModel,
    targets_m: Sequence[float],
    stop: Stop,
    allowance: Allowance,
) -> float:
    """No plan that sees the units, shared by passes in whatever way, is shorter.

    Parameters
    ----------
    found
        Units that are ``alike``.
    in_parts
        Those, besides wide ones, that passes may see in parts: of these each place counts by itself.
    targets_m
        Bounds worth proving, ascending: nothing better than the last is looked for, and more than the first
        only where that took little.
    stop, allowance
        The one cancels; the other is for the search for a better bound.
    """
    within, best_m = allowance.part(MOST_LINES), 0.0
    enough = within.left * (1.0 - LITTLE)
    for target_m in targets_m:
        best_m = max(best_m, _proved_m(found, in_parts, ends, model, target_m, stop, within))
        if best_m < target_m or within.left < enough:
            break
    return best_m


def _proved_m(
    found: Sequence[Unit],
    in_parts: Collection[int],
    ends: tuple[Terminal, Terminal],
    model: FlightModel,
    target_m: float,
    stop: Stop,
    within: Allowance,
) -> float:
    """The least of all ways to part the places, at most the target."""
    start, end = terminal(ends[0]), terminal(ends[1])
    places = _Places(found, in_parts, model.settle_m)

    def proved_m(shares: _Shares, level: int) -> float:
        if within.over:
            return 0.0
        within.spend(LINES_TOUR)
        effort = int(EFFORTS[level] * max(len(shares.asked) / FEW, 1.0) ** 2)
        return exact_bound_m(
            list(shares.asked), start, end, model.turn_radius_m, (target_m,), effort, stop, within
        )

    place = places.first(start, end)
    node = places.asked(place, 0)
    if node is None:
        return 0.0
    count = itertools.count()
    root = _Shares((place,), (node,))
    # Bound, number, sets, what has been looked at of them, whether looking again is worth it.
    heap = [(proved_m(root, 0), next(count), root, 0, False)]
    while heap[0][0] < target_m and not within.over:
        raise_if(stop)
        bound_m, _, shares, level, worth = heap[0]
        if worth and level + 1 < len(EFFORTS):
            found_m = proved_m(shares, level + 1)
            worth = found_m > (1.0 + WORTH) * bound_m
            heapq.heapreplace(heap, (max(bound_m, found_m), next(count), shares, level + 1, worth))
            continue
        within.spend(LINES_NEXT)
        another = places.next(shares) if len(shares.hulls) < MOST_SETS else None
        if another is None:
            break
        below = list(places.below(shares, another))
        if not below:
            # Nothing is known of how it is seen.
            break
        if len(below) == 1 and len(below[0].hulls) < MOST_FORCED:
            # No other way to see it: nothing to be chosen, and more to be asked for.
            heapq.heapreplace(heap, (bound_m, next(count), below[0], level, False))
            continue
        bounds_m = [max(bound_m, proved_m(each, 0)) for each in below]
        heapq.heappop(heap)
        for least_m, each in zip(bounds_m, below, strict=True):
            heapq.heappush(heap, (least_m, next(count), each, 0, True))
    return min(heap[0][0], target_m)
