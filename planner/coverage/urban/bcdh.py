"""BCDH-CPP: boustrophedon cells joined by an Eulerian circuit (Xu, Viriyasuthee, Rekleitis 2014).

The first of the two methods that Majeed and Lee 2019 compare theirs with, their [53].
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import scipy.sparse
import shapely
from scipy.optimize import Bounds, LinearConstraint, milp
from shapely.geometry.base import BaseGeometry

from planner.coverage.urban.area import Place, UrbanArea
from planner.coverage.urban.boustrophedon import LEAST_CELL_M2, Cell, cells
from planner.coverage.urban.cellwise import back_and_forth, cell_lanes
from planner.coverage.urban.fitting import Fitting, directions
from planner.coverage.urban.free import FreeSpace, free_space
from planner.coverage.urban.measures import Flown, Sweep
from planner.coverage.urban.waypoints import Joiner


@dataclass(frozen=True, slots=True)
class BoustrophedonCells:
    """The method, with nothing to choose."""

    def __call__(self, urban: UrbanArea) -> Flown:
        """The coverage path.

        Raises
        ------
        InfeasibleError
            Where obstacles leave no free ground, or sweeps cannot be joined.
        """
        free = free_space(urban)
        return Joiner.among(urban, free).graph(self.sequence(urban, free)).flown()

    def sequence(self, urban: UrbanArea, free: FreeSpace) -> tuple[Sweep, ...]:
        """Sweeps in the order and direction flown: cell by cell as the circuit visits them."""
        fitting = Fitting.of(urban)
        angle_rad = directions(urban.area, free.ground, fitting)[0]
        found = cells(free.ground, angle_rad)
        doubled = doubled_cells(found)
        here: Place = urban.start
        flown: list[Sweep] = []
        for part, upward in circuit(found, doubled, here, angle_rad):
            if part.area < LEAST_CELL_M2:
                continue
            lanes, extras = cell_lanes(part, free.ground, fitting, angle_rad)
            flown += back_and_forth(lanes if upward else lanes[::-1], extras, here)
            here = flown[-1].end
        return tuple(flown)


def doubled_cells(found: tuple[Cell, ...]) -> frozenset[int]:
    """Cells to be visited twice so that every node of the Reeb graph has an even number, at least cost.

    The Chinese postman's problem, posed as they pose it: Σ x_e over the cells at a node, with the cells that
    are there, is twice a whole number; solved by HiGHS. A cell costs its area.
    """
    nodes = 1 + max(max(cell.low, cell.high) for cell in found)
    ends = np.array([(cell.low, cell.high) for cell in found])
    numbers = np.repeat(np.arange(len(found)), 2)
    meets = scipy.sparse.csr_array((np.ones(2 * len(found)), (ends.ravel(), numbers)), (nodes, len(found)))
    degree = np.bincount(ends.ravel(), minlength=nodes)
    table = scipy.sparse.hstack([meets, -2.0 * scipy.sparse.eye_array(nodes)])
    cost = np.concatenate([[cell.outline.area for cell in found], np.zeros(nodes)])
    most = np.concatenate([np.ones(len(found)), np.full(nodes, np.inf)])
    chosen = milp(
        cost,
        integrality=np.ones(len(cost), dtype=np.int64),
        bounds=Bounds(0.0, most),
        constraints=[LinearConstraint(table, -degree, -degree)],
    )
    return frozenset(int(k) for k in np.flatnonzero(np.asarray(chosen.x)[: len(found)] > 0.5))


def circuit(
    found: tuple[Cell, ...], doubled: frozenset[int], start: Place, angle_rad: float
) -> list[tuple[BaseGeometry, bool]]:
    """Cells, or halves of those visited twice, in the order of an Eulerian circuit, and whether upward.

    Pieces of ground without a way between them have circuits of their own, the nearer ones first.
    """
    at: dict[int, list[tuple[int, int]]] = {}
    for k, cell in enumerate(found):
        for half in range(2 if k in doubled else 1):
            at.setdefault(cell.low, []).append((k, half))
            at.setdefault(cell.high, []).append((k, half))
    places = {
        node: min((_end(found[k], node, angle_rad) for k, _ in edges), key=lambda p: math.dist(p, start))
        for node, edges in at.items()
    }
    used: set[tuple[int, int]] = set()
    visits: list[tuple[BaseGeometry, bool]] = []
    for first in sorted(places, key=lambda node: (math.dist(places[node], start), node)):
        for k, half, upward in _round(first, at, found, used):
            visits.append((found[k].halves[half] if k in doubled else found[k].outline, upward))
    return visits


def _round(
    first: int, at: dict[int, list[tuple[int, int]]], found: tuple[Cell, ...], used: set[tuple[int, int]]
) -> list[tuple[int, int, bool]]:
    """The edges of Hierholzer's circuit through a node that are not used yet, each with its direction."""
    stack: list[tuple[int, tuple[int, int, bool] | None]] = [(first, None)]
    trail: list[tuple[int, int, bool]] = []
    while stack:
        node, came = stack[-1]
        edge = next((each for each in at[node] if each not in used), None)
        if edge is None:
            stack.pop()
            if came is not None:
                trail.append(came)
            continue
        used.add(edge)
        cell = found[edge[0]]
        upward = node == cell.low
        stack.append((cell.high if upward else cell.low, (*edge, upward)))
    return trail[::-1]


def _end(cell: Cell, node: int, angle_rad: float) -> Place:
    """Where a cell meets one of its nodes."""
    places = shapely.get_coordinates(cell.outline)
    heights = places @ np.array([-math.sin(angle_rad), math.cos(angle_rad)])
    east, north = places[int(np.argmin(heights) if node == cell.low else np.argmax(heights))]
    return (float(east), float(north))
