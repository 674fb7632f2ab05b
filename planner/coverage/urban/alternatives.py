"""CA-CPP: cells with four coverage alternatives each, in the order that joins them best (Torres et al. 2016).

The second of the two methods that Majeed and Lee 2019 compare theirs with, their [54].
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import Polygon

from planner.coverage.urban.area import UrbanArea
from planner.coverage.urban.boustrophedon import LEAST_CELL_M2, cells
from planner.coverage.urban.cellwise import back_and_forth, cell_lanes
from planner.coverage.urban.fitting import Fitting, directions
from planner.coverage.urban.free import FreeSpace, free_space
from planner.coverage.urban.lanes_kernels import level_pieces
from planner.coverage.urban.measures import Flown, Sweep
from planner.coverage.urban.visibility import edges_of
from planner.coverage.urban.waypoints import Joiner
from planner.orders_kernels import best_options, best_orders, improve_order

Floats = NDArray[np.float64]

#: So many cells are ordered by all permutations, as there; more by moves, with this many evaluations.
MOST_EXACT = 8
EVALUATIONS = 60_000
#: Cells that share less of an edge than this part of F_w are not merged.
LEAST_EDGE = 0.5


@dataclass(frozen=True, slots=True)
class CoverageAlternatives:
    """The method, with nothing to choose."""

    def __call__(self, urban: UrbanArea) -> Flown:
        """The coverage path.

        Raises
        ------
        InfeasibleError
            Where obstacles leave no free ground, or sweeps cannot be joined.
        """
        free = free_space(urban)
        joiner = Joiner.among(urban, free)
        return joiner.graph(self._sequence(urban, joiner)).flown()

    def sequence(self, urban: UrbanArea, free: FreeSpace) -> tuple[Sweep, ...]:
        """Sweeps in the order and direction flown, joined by nobody yet."""
        return self._sequence(urban, Joiner.among(urban, free))

    def _sequence(self, urban: UrbanArea, joiner: Joiner) -> tuple[Sweep, ...]:
        """Sweeps in the order and direction flown: of each cell its alternative, in the order of cells.

        They try all permutations, with adjacencies to prune them; their cost is exponential in the number of
        cells. Here few cells are ordered exactly, by dynamic programming, and more by moves from the order
        of nearest neighbours. Ways between cells are those round obstacles.
        """
        free, fitting = joiner.free, Fitting.of(urban)
        parts = merged(_cells(urban, free, fitting), fitting)
        ways = [alternatives(part, fitting, free) for part in parts]
        entries = np.array([way[0].start for four in ways for way in four])
        exits = np.array([way[-1].end for four in ways for way in four])
        inner_m = np.array([_flown_m(way) for four in ways for way in four])
        offsets = np.cumsum([0, *(len(four) for four in ways)]).astype(np.int64)
        first = joiner.ways.lengths_m(np.array([urban.start]), entries)[0]
        last = joiner.ways.lengths_m(np.array([urban.end]), exits)[0]
        between = joiner.ways.lengths_m(exits, entries)
        # ground that only a flight over obstacles leads to is far, but no obstacle to an order
        far_m = 10.0 * float(np.hypot(*np.ptp(entries, axis=0))) + 1.0
        first, last, between = (np.where(np.isfinite(each), each, far_m) for each in (first, last, between))
        chosen = _ordered(first + inner_m, between + inner_m, last, offsets)
        flat = [way for four in ways for way in four]
        return tuple(sweep for k in chosen for sweep in flat[k])


def alternatives(part: Polygon, fitting: Fitting, free: FreeSpace) -> list[tuple[Sweep, ...]]:
    """Back and forth over a cell in four ways: from either side of it, beginning at either end of a lane.

    The lanes lie along the direction of the fewest (their optimal line sweep).
    """
    angle_rad = min(_angles(part), key=lambda each: _whole_lanes(part, each, fitting.width_m) or math.inf)
    lanes, extras = cell_lanes(part, free.ground, fitting, angle_rad)
    return [
        tuple(back_and_forth(order, extras, first))
        for order in (lanes, lanes[::-1])
        for first in (order[0].start, order[0].end)
    ]


def merged(parts: list[Polygon], fitting: Fitting) -> list[Polygon]:
    """Adjacent cells as one where one sweep back and forth sees both, uninterrupted, with fewer lanes."""
    waiting = list(parts)
    done: list[Polygon] = []
    while waiting:
        one = waiting.pop()
        mate = _mate(one, waiting, fitting)
        if mate is None:
            done.append(one)
            continue
        waiting[mate[0]] = mate[1]
    return done


def _mate(one: Polygon, others: list[Polygon], fitting: Fitting) -> tuple[int, Polygon] | None:
    own = _fewest(one, fitting.width_m)
    if own is None:
        return None
    for k in shapely.STRtree(others).query(one, predicate="intersects"):
        edge = shapely.intersection(one, others[k], grid_size=1e-4)
        other = _fewest(others[k], fitting.width_m)
        if edge.length < LEAST_EDGE * fitting.width_m or other is None:
            continue
        both = shapely.union_all([one, others[k]], grid_size=1e-4)
        if not isinstance(both, Polygon) or both.interiors:
            continue
        lanes = _fewest(both, fitting.width_m)
        if lanes is not None and lanes < own + other:
            return int(k), both
    return None


def _fewest(part: Polygon, width_m: float) -> int | None:
    counts = [count for angle in _angles(part) if (count := _whole_lanes(part, angle, width_m)) is not None]
    return min(counts, default=None)


def _angles(part: Polygon) -> list[float]:
    corners = shapely.get_coordinates(shapely.minimum_rotated_rectangle(part))[:3]
    sides = np.diff(corners, axis=0)
    own = [math.atan2(north, east) % math.pi for east, north in sides]
    return own if len(own) == 2 else [0.0, math.pi / 2.0]


def _whole_lanes(part: Polygon, angle_rad: float, width_m: float) -> int | None:
    """Lanes along a direction; None where the cell's outline interrupts one."""
    edges = edges_of(part)
    cosine, sine = math.cos(angle_rad), math.sin(angle_rad)
    turn = np.array([[cosine, -sine], [sine, cosine]])
    edges = np.hstack([edges[:, :2] @ turn, edges[:, 2:] @ turn])
    south, north = float(edges[:, 1].min()), float(edges[:, 1].max())
    count = max(math.ceil((north - south) / width_m - 1e-9), 1)
    heights = south + (np.arange(2 * count) + 0.5) * (north - south) / (2 * count)
    ends, _ = level_pieces(edges, heights, 0.0)
    return count if len(ends) == len(heights) else None


def _cells(urban: UrbanArea, free: FreeSpace, fitting: Fitting) -> list[Polygon]:
    """Cells along either axis of the area: those of the fewest lanes."""
    ways = [
        [
            part
            for cell in cells(free.ground, angle)
            for part in shapely.get_parts(cell.outline)
            if part.area >= LEAST_CELL_M2
        ]
        for angle in directions(urban.area, free.ground, fitting)
    ]
    return min(ways, key=lambda way: sum(_fewest(part, fitting.width_m) or 1 for part in way))


def _flown_m(way: tuple[Sweep, ...]) -> float:
    joins_m = sum(math.dist(a.end, b.start) for a, b in itertools.pairwise(way))
    return joins_m + sum(sweep.length_m for sweep in way)


def _ordered(first: Floats, between: Floats, last: Floats, offsets: NDArray[np.int64]) -> list[int]:
    count = len(offsets) - 1
    if count <= MOST_EXACT:
        costs, tours = best_orders(first, between, last, offsets)
        return [int(k) for k in tours[int(np.argmin(costs))]]
    order = improve_order(first, between, last, offsets, _nearest(first, between, offsets), EVALUATIONS)
    _, chosen = best_options(first, between, last, offsets, order)
    return [int(k) for k in chosen]


def _nearest(first: Floats, between: Floats, offsets: NDArray[np.int64]) -> NDArray[np.int64]:
    """Cells in the order of the nearest neighbour from the start."""
    owner = np.repeat(np.arange(len(offsets) - 1), np.diff(offsets))
    left = np.ones(len(owner), dtype=bool)
    row, order = first, []
    while left.any():
        option = int(np.argmin(np.where(left, row, np.inf)))
        order.append(int(owner[option]))
        left &= owner != owner[option]
        row = between[option]
    return np.array(order)
