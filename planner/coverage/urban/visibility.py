"""Shortest ways among obstacles: straight where nothing is between, else round corners of the free ground."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry

from planner.coverage.urban.visibility_kernels import corner_graph, crosses, way_lengths, ways_from

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Places on the edge of free ground, as ends of sweeps are, count as within it.
SPARE_M = 1e-3


@dataclass(frozen=True, slots=True)
class Ways:
    """Ways through free ground.

    Parameters
    ----------
    edges
        Not to be crossed, (E, 4): the ground's rings, a millimetre outside of them.
    corners
        Where a shortest way may bend, (N, 2): corners of obstacles, and where the area's own edge sticks in.
    starts, towards, lengths
        The graph of corners that see each other, see ``visibility_kernels``.
    """

    edges: Floats
    corners: Floats
    starts: Ints
    towards: Ints
    lengths: Floats

    @classmethod
    def through(cls, ground: BaseGeometry) -> Ways:
        """Ways through ground, of one or more pieces."""
        edges = edges_of(ground.buffer(SPARE_M, join_style="mitre"))
        corners = _inward_corners(ground)
        return cls(edges, corners, *corner_graph(edges, corners))

    def is_clear(self, start: tuple[float, float], end: tuple[float, float]) -> bool:
        """Whether the straight line between two places of the ground leaves it nowhere."""
        return not crosses(self.edges, *start, *end)

    def way(self, start: tuple[float, float], end: tuple[float, float]) -> Floats | None:
        """The shortest way between two places of the ground, (K, 2); None where there is none."""
        if self.is_clear(start, end):
            return np.array([start, end], dtype=np.float64)
        best, before = ways_from(
            self.edges, self.corners, self.starts, self.towards, self.lengths, start[0], start[1]
        )
        rest = np.hypot(self.corners[:, 0] - end[0], self.corners[:, 1] - end[1])
        for at in np.argsort(best + rest, kind="stable"):
            if not np.isfinite(best[at]):
                return None
            if self.is_clear((float(self.corners[at, 0]), float(self.corners[at, 1])), end):
                return self._back(int(at), before, start, end)
        return None

    def lengths_m(self, origins: Floats, goals: Floats) -> Floats:
        """Lengths of shortest ways from places (M, 2) to places (K, 2), (M, K); inf where there is none."""
        return way_lengths(self.edges, self.corners, self.starts, self.towards, self.lengths, origins, goals)

    def _back(self, at: int, before: Ints, start: tuple[float, float], end: tuple[float, float]) -> Floats:
        places = [np.asarray(end, dtype=np.float64)]
        while at >= 0:
            places.append(self.corners[at])
            at = int(before[at])
        places.append(np.asarray(start, dtype=np.float64))
        return np.array(places[::-1])


def edges_of(shape: BaseGeometry) -> Floats:
    """The edges of all rings, (E, 4)."""
    rows = [np.empty((0, 4))]
    for polygon in shapely.get_parts(shape):
        for ring in (polygon.exterior, *polygon.interiors):
            places = np.asarray(ring.coords)[:, :2]
            rows.append(np.hstack([places[:-1], places[1:]]))
    return np.vstack(rows)


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
