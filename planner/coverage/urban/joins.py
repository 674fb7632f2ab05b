"""The shortest tour over sweeps among obstacles."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planner.coverage.urban.area import UrbanArea
from planner.coverage.urban.free import FreeSpace
from planner.coverage.urban.reach_kernels import join_lengths
from planner.coverage.urban.tour_kernels import nearest_first, neighbours, shortest_tour, tour_cost
from planner.coverage.urban.visibility import Ways, edges_of

Floats = NDArray[np.float64]

#: Places to which joins are exact, and neighbours that an end may be joined to.
NEAR, NEIGHBOURS = 40, 12
#: How far what nothing leads to is, in extents of all.
FAR = 10.0
#: Shakes of a tour for each of its sweeps.
SHAKES = 5


@dataclass(frozen=True, slots=True)
class Joins:
    """What joins of sweeps are made among.

    Parameters
    ----------
    urban, ways
        The area, and ways through its free ground.
    outlines, rises
        Edges of obstacles and of the area, (E, 4), and the climb over each, inf where that is not allowed.
    """

    urban: UrbanArea
    ways: Ways
    outlines: Floats
    rises: Floats

    @classmethod
    def among(cls, urban: UrbanArea, free: FreeSpace, ways: Ways) -> Joins:
        """Joins through free ground, or over what may be climbed over straight up."""
        edges = [edges_of(urban.area)]
        rises = [np.full(len(edges[0]), np.inf)]
        for cluster in free.clusters:
            edges.append(edges_of(cluster.outline))
            rise_m = cluster.top_m + urban.clearance_m - urban.height_m
            allowed = urban.may_climb_over(cluster.top_m)
            rises.append(np.full(len(edges[-1]), rise_m if allowed else np.inf))
        return cls(urban, ways, np.vstack(edges), np.concatenate(rises))

    def tour(self, lines: Floats, seed: int) -> tuple[float, Floats]:
        """The shortest flight along lines, (N, 2, 2), from start to end: its length, and them as flown.

        Each turn counts as much as a bend of the ways. Lines that nothing leads to come as if they were far.
        """
        ends = np.array([self.urban.end, self.urban.start], dtype=np.float64)
        places = np.concatenate([lines.reshape(-1, 2), ends])
        ways = self.ways
        upright = self.urban.max_climb_rad >= math.pi / 2.0 - 1e-9
        steepest = math.inf if upright else math.tan(self.urban.max_climb_rad)
        costs = join_lengths(
            ways.walls,
            ways.corners,
            ways.between,
            self.outlines,
            self.rises,
            steepest,
            places,
            _ahead(lines),
            ways.bend_m,
            NEAR,
        )
        far_m = FAR * float(np.ptp(places, axis=0).sum()) + 1.0
        costs = np.where(np.isfinite(costs), costs, far_m)
        last = len(places) - 2
        first = nearest_first(costs, last)
        tour = shortest_tour(costs, neighbours(costs, NEIGHBOURS), first, SHAKES * len(lines), seed)
        at = int(np.flatnonzero(tour == last + 1)[0])
        if at % 2 == 0:
            # found the other way round: the start follows the end
            tour, at = tour[::-1], len(tour) - 1 - at
        order = np.roll(tour, -at - 1)[:-2]
        flown: Floats = places[order].reshape(-1, 2, 2)
        length_m = float(np.hypot(*(lines[:, 1] - lines[:, 0]).T).sum()) + tour_cost(costs, tour)
        return length_m, flown


def _ahead(lines: Floats) -> Floats:
    """Unit directions in which lines are left at their ends, (2 N + 2, 2); nought at start and end."""
    along = lines[:, 1] - lines[:, 0]
    along = along / np.maximum(np.hypot(along[:, 0], along[:, 1]), 1e-12)[:, None]
    return np.concatenate([np.stack([-along, along], axis=1).reshape(-1, 2), np.zeros((2, 2))])
