"""Shortest ways among obstacles: straight where nothing is between, else round corners of the free ground."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from planner.coverage.urban.visibility_kernels import (
    Walls,
    bends_of_way,
    corner_graph,
    crosses,
    gridded,
    way_lengths,
)

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Places on the edge of free ground, as ends of sweeps are, count as within it.
SPARE_M = 1e-3
#: Cells of the grid at most, each way.
MOST_CELLS = 256.0


@dataclass(frozen=True, slots=True)
class Ways:
    """Ways through free ground.

    Parameters
    ----------
    walls
        Not to be crossed: the ground's rings, a millimetre outside of them.
    corners
        Where a shortest way may bend, (N, 2): corners of obstacles, and where the area's own edge sticks in.
    between, before
        Lengths of ways from corner to corner, (N, N), and the corner before each on the way there.
    bend_m
        What each bend counts besides the length.
    """

    walls: Walls
    corners: Floats
    between: Floats
    before: Ints
    bend_m: float = 0.0

    @classmethod
    def through(cls, ground: BaseGeometry, bend_m: float = 0.0) -> Ways:
        """Ways through ground, of one or more pieces."""
        walls = walls_of(edges_of(ground.buffer(SPARE_M, join_style="mitre")))
        corners = _inward_corners(ground)
        starts, towards, lengths = corner_graph(walls, corners)
        count = len(corners)
        graph: csr_array[np.float64, tuple[int, int]] = csr_array(
            (lengths + bend_m, towards, starts), shape=(count, count)
        )
        if count == 0:
            return cls(walls, corners, np.empty((0, 0)), np.empty((0, 0), dtype=np.int64), bend_m)
        between, before = dijkstra(graph, return_predecessors=True)
        return cls(walls, corners, between, before.astype(np.int64), bend_m)

    def is_clear(self, start: tuple[float, float], end: tuple[float, float]) -> bool:
        """Whether the straight line between two places of the ground leaves it nowhere."""
        return not crosses(self.walls, *start, *end)

    def way(self, start: tuple[float, float], end: tuple[float, float]) -> Floats | None:
        """The shortest way between two places of the ground, (K, 2); None where there is none."""
        if self.is_clear(start, end):
            return np.array([start, end], dtype=np.float64)
        first, last, _ = bends_of_way(self.walls, self.corners, self.between, *start, *end)
        if first < 0:
            return None
        bends = [last]
        while bends[-1] != first:
            bends.append(int(self.before[first, bends[-1]]))
        return np.vstack([start, self.corners[bends[::-1]], end])

    def lengths_m(self, origins: Floats, goals: Floats) -> Floats:
        """Lengths of shortest ways from places (M, 2) to places (K, 2), (M, K); inf where there is none."""
        return way_lengths(self.walls, self.corners, self.between, origins, goals)


def walls_of(edges: Floats) -> Walls:
    """Edges, (E, 4), in a grid with about as many cells."""
    low, high = edges.reshape(-1, 2).min(axis=0), edges.reshape(-1, 2).max(axis=0)
    span = np.maximum(high - low, 1.0)
    cell_m = math.sqrt(float(span.prod()) / len(edges))
    cells = np.clip(np.ceil(span / cell_m), 1.0, MOST_CELLS)
    frame = np.concatenate([low, cells / span, cells])
    return Walls(edges, *gridded(edges, frame), frame)


def edges_of(shape: BaseGeometry) -> Floats:
    """The edges of all rings, (E, 4)."""
    polygons = [part for part in shapely.get_parts(shape) if isinstance(part, Polygon)]
    places, rings = shapely.get_coordinates(shapely.get_rings(polygons), return_index=True)
    same = rings[:-1] == rings[1:]
    return np.hstack([places[:-1][same], places[1:][same]]) if len(places) else np.empty((0, 4))


def _inward_corners(ground: BaseGeometry) -> Floats:
    """Corners where the ground turns round what is not ground: the only ones that shortest ways touch."""
    found = [np.empty((0, 2))]
    for polygon in shapely.get_parts(shapely.orient_polygons(ground)):
        for ring in (polygon.exterior, *polygon.interiors):
            places = np.asarray(ring.coords)[:-1, :2]
            before, after = places - np.roll(places, 1, axis=0), np.roll(places, -1, axis=0) - places
            turn = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
            found.append(places[turn < 0.0])
    return np.vstack(found)
