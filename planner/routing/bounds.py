"""A lower bound on the length of any plan that sees given regions.

What is relaxed. A plan flies passes, straight and each with its settling run, joined by lines that turn no
tighter than the aircraft can. Here

- there are no threats, no zones, no operating area: lines and passes may be anywhere;
- a region that one pass sees whole asks for one of those passes: any heading, any offset, both continuous;
- a region that takes several passes, one after the other or with other regions between, asks for two: of the
  fewest parallel strips of one swath that hold it, the outermost to the left of the heading and the outermost
  to the right; each is flown as far as the region surely reaches in it, to the same or the opposite heading
  where the two follow each other, at any heading where not; all other passes are dropped;
- where one pass may see the region whole and several may too, one of either is kept.

Dropping a part of a line between two poses cannot make the shortest line through the rest longer, so every
plan over these regions is a tour of the relaxed problem, and no shorter than its best. Regions divided into
parts count as divided, and more strips than the fewest are not considered.

How the relaxed one is bounded. Passes are held in cells: boxes of headings and offsets. No line between two
cells is shorter than ``bounds_kernels.between_least`` says, which evaluates the words of Dubins (1957) with
intervals, so no sampling error can make the bound too high.

- Up to ``EXACT_UP_TO`` passes: dynamic programming over subsets, exact over the order, and over cells. Cells
  that no tour up to a target length goes through are dropped, those with the shortest tours split in four,
  until none is left or the effort is spent. The bound is the target, or the least tour over what is left.
- Beyond: the least cost between every two regions, cells split where it matters, and Held and Karp's
  ascent over least trees: M. Held, R. M. Karp, "The traveling-salesman problem and minimum spanning trees",
  Operations Research 18 (1970).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from planner.coverage.segments import Neighbourhood
from planner.coverage.sweeps import Side
from planner.progress import Stop, never, raise_if
from planner.routing import bounds_kernels as kernels
from planner.scenario import Scenario, Terminal
from planner.vehicle.aircraft import Aircraft

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Passes up to which the order is searched exactly.
EXACT_UP_TO = 9
#: The exact search ends when it has proved that the known plan is at most this much longer than the best.
TARGET = 0.02
#: Headings of the first cells.
HEADINGS = 24
#: Cells the exact search may hold at a time: its matrices are of this squared.
MOST_CELLS = 1_000
#: Splits of pairs of cells for neighbours and for others, and how many nearest are neighbours.
SPLITS_NEAR, SPLITS_FAR, NEIGHBOURS = 120, 3, 10
PAIR_HEADINGS = 12
ASCENT_STEPS = 1_500


@dataclass(frozen=True, slots=True)
class Visit:
    """A pass that every tour flies: the families it may be of.

    Parameters
    ----------
    region
        Which one, counted from 0.
    points_m
        The region's ring, (V, 2), relative to ``middle``.
    families
        See ``bounds_kernels``, (F, 8).
    approach_rad
        The headings allowed; None for any.
    """

    region: int
    points_m: Floats
    families: Floats
    approach_rad: tuple[float, ...] | None

    @property
    def boxes(self) -> Floats:
        """The first cells, (B, 5)."""
        return _boxes(len(self.families), self.approach_rad, HEADINGS)

    @property
    def middle(self) -> Floats:
        """Where the region is: the middle of its families."""
        return self.families[0, 6:8]


def lower_bound_m(
    scenario: Scenario,
    aircraft: Aircraft,
    sides: Sequence[Sequence[Side]],
    known_m: float,
    most_cells: int = MOST_CELLS,
    stop: Stop = never,
) -> float:
    """No plan that sees these regions is shorter than this.

    Parameters
    ----------
    sides
        For each region, part of one or visit to one its ways to be seen.
    known_m
        Length of a plan: the bound is never above it, and says most just below it.
    most_cells
        Effort of the search that is exact over the order; the time goes with its square.
    """
    nodes = [
        node for index, of_region in enumerate(sides) for node in visits(of_region, aircraft.settle_m, index)
    ]
    radius_m = aircraft.planned_turn_radius_m
    start, end = _terminal(scenario.start), _terminal(scenario.end)
    if len(nodes) <= EXACT_UP_TO:
        return _exact(nodes, start, end, radius_m, known_m, most_cells, stop)
    return _by_trees(nodes, start, end, radius_m, known_m, stop)


def bounded(scenario: Scenario) -> bool:
    """Whether passes are as the bound takes them: abeam, and not longer than a strip asks for."""
    return all(sensor.squint_rad == 0.0 and sensor.mode != "spotlight" for sensor in scenario.sensors)


def visits(sides: Sequence[Side], settle_m: float, region_index: int) -> list[Visit]:
    """The passes one region asks for."""
    whole = [side for side in sides if isinstance(side, Neighbourhood) and side.turns == 0]
    several = [side for side in sides if not isinstance(side, Neighbourhood) or side.turns > 0]
    region, sensor, height_m = sides[0].region, sides[0].sensor, sides[0].height_m
    ring = np.asarray(shapely.get_coordinates(region.area.exterior)[:-1], dtype=np.float64)
    middle = 0.5 * (ring.min(axis=0) + ring.max(axis=0))
    kinds = [kernels.WHOLE] if whole else []
    if several and all(isinstance(side, Neighbourhood) for side in several):
        kinds.append(kernels.NEAR_LONG)
    elif several:
        kinds += [kernels.NEAR_STRIP, kernels.FAR_STRIP]
    strip = (sensor.near_m(height_m), sensor.swath_m(height_m), sensor.run_in_m(height_m), settle_m)
    families = [
        (kind, 1.0 if look == "right" else -1.0, *strip, *middle) for look in sensor.looks for kind in kinds
    ]
    visit = Visit(region_index, ring - middle, np.array(families, dtype=np.float64), region.approach_rad)
    return [visit] if whole else [visit, visit]


def _boxes(families: int, approach_rad: tuple[float, ...] | None, count: int) -> Floats:
    if approach_rad is None:
        alpha = math.pi / count
        headings = [(2 * k * alpha, alpha) for k in range(count)]
    else:
        headings = [(float(angle_rad), 0.0) for angle_rad in approach_rad]
    rows = [(family, theta, alpha, 0.5, 0.5) for family in range(families) for theta, alpha in headings]
    return np.array(rows, dtype=np.float64)


def _terminal(terminal: Terminal) -> Floats:
    angle_rad = terminal.angle_rad
    return np.array([*terminal.position, 0.0 if angle_rad is None else 1.0, angle_rad or 0.0])


def _exact(
    nodes: list[Visit],
    start: Floats,
    end: Floats,
    radius_m: float,
    known_m: float,
    most_cells: int,
    stop: Stop,
) -> float:
    bound_m = 0.0
    target_m = known_m * (1.0 - TARGET)
    boxes = [node.boxes for node in nodes]
    while True:
        raise_if(stop)
        cells, offsets = _cells(nodes, boxes)
        region = np.repeat([visit.region for visit in nodes], np.diff(offsets))
        through = _through(cells, offsets, region, start, end, radius_m)
        bound_m = max(bound_m, min(float(through.min()), target_m))
        open_ = through < target_m
        room = min((most_cells - int(open_.sum())) // 3, max(int(open_.sum()) // 2, 1))
        if bound_m >= target_m or room <= through.size // 20:
            return bound_m
        # Tours through the others are longer than the target, or than what is split: they need not be known
        # better yet.
        order = np.argsort(through, kind="stable")
        split = np.zeros(len(through), dtype=np.bool_)
        split[order[:room]] = True
        split &= open_
        boxes = [
            np.concatenate([_split(of_node[divide]), of_node[keep & ~divide]])
            for of_node, divide, keep in zip(
                boxes, np.split(split, offsets[1:-1]), np.split(open_, offsets[1:-1]), strict=True
            )
        ]


def _split(boxes: Floats) -> Floats:
    return np.concatenate([np.empty((0, 5)), *(kernels.quarters(box) for box in boxes)])


def _cells(nodes: list[Visit], boxes: list[Floats]) -> tuple[Floats, Ints]:
    """The cells of all boxes that hold a pass, or might, and where those of each node begin."""
    rows = [
        kernels.box_cell(node.points_m, node.families, box)
        for node, of_node in zip(nodes, boxes, strict=True)
        for box in of_node
    ]
    offsets = np.concatenate([[0], np.cumsum([len(of_node) for of_node in boxes])])
    return np.array(rows).reshape(-1, 10), offsets.astype(np.int64)


def _through(
    cells: Floats, offsets: Ints, region: Ints, start: Floats, end: Floats, radius_m: float
) -> Floats:
    """The least tour through each cell, (N,); inf where it holds no pass."""
    node = np.repeat(np.arange(len(offsets) - 1), np.diff(offsets)).astype(np.int64)
    empty = cells[:, kernels.HOLDS] == 0.0
    inner = cells[:, kernels.INNER]
    between = kernels.matrix_least(cells, node, region, radius_m)
    between[:, empty] = np.inf
    between[empty] = np.inf
    first = np.where(empty, np.inf, kernels.terminal_least(start, cells, False, radius_m) + inner)
    last = np.where(empty, np.inf, kernels.terminal_least(end, cells, True, radius_m) + inner)
    backwards = np.ascontiguousarray((between - inner[None, :] + inner[:, None]).T)
    ahead = kernels.subset_costs(first, between, offsets)
    behind = kernels.subset_costs(last, backwards, offsets)
    return np.asarray(kernels.through_costs(ahead, behind, inner, offsets), dtype=np.float64)


def _by_trees(
    nodes: list[Visit], start: Floats, end: Floats, radius_m: float, known_m: float, stop: Stop
) -> float:
    middles = np.array([node.middle for node in nodes])
    gaps = np.hypot(*(middles[:, None, :] - middles[None, :, :]).transpose(2, 0, 1))
    coarse = [_boxes(len(node.families), node.approach_rad, PAIR_HEADINGS) for node in nodes]
    edges = np.full(gaps.shape, np.inf)
    for i, node in enumerate(nodes):
        raise_if(stop)
        nearest = np.argsort(gaps[i], kind="stable")[: NEIGHBOURS + 1]
        for j, other in enumerate(nodes):
            if i == j:
                continue
            # A pair is near when either is among the nearest of the other: both ways get the same effort.
            near = j in nearest or gaps[i, j] <= np.partition(gaps[j], NEIGHBOURS)[NEIGHBOURS]
            edges[i, j] = kernels.pair_least(
                node.points_m,
                node.families,
                coarse[i],
                other.points_m,
                other.families,
                coarse[j],
                radius_m,
                SPLITS_NEAR if near else SPLITS_FAR,
            )
    edges = np.minimum(edges, edges.T)
    ends = []
    for terminal, arriving in ((start, False), (end, True)):
        least = []
        for node in nodes:
            cells, _ = _cells([node], [_split(_split(node.boxes))])
            cells = cells[cells[:, kernels.HOLDS] > 0.0]
            leg_m = kernels.terminal_least(terminal, cells, arriving, radius_m)
            least.append(float((leg_m + 0.5 * cells[:, kernels.INNER]).min()))
        ends.append(np.array(least))
    return float(kernels.ascent(edges, ends[0], ends[1], known_m, ASCENT_STEPS))
