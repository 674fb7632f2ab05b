"""``auto`` among obstacles: headings, sweeps and their order chosen for the least way in all."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry

from planner.coverage.urban.area import UrbanArea
from planner.coverage.urban.free import FreeSpace, free_space
from planner.coverage.urban.frontier import GRID_M, Frontier, Manner, clipped, seen_from
from planner.coverage.urban.joins import Joins
from planner.coverage.urban.measures import Flown, Sweep, corners, line_m
from planner.coverage.urban.visibility import edges_of
from planner.coverage.urban.waypoints import Joiner

Floats = NDArray[np.float64]

#: Headings tried: the directions that most of the ground's edges have, so far apart, and across the first.
HEADINGS, APART_RAD = 4, math.radians(6.0)
#: Gap and bend (see ``Manner``) of sweeps tried at each heading, from below and from above.
MANNERS = ((0.0, 0.0), (0.0, 0.5), (1.0, 0.75), (2.0, 0.25))
#: Where the lowest of level sweeps lies, in widths over the lowest ground, and as parts of what is to spare.
LEVELS, SPARED = (0.25, 0.0, -0.25), (0.0, 0.5, 1.0)
#: Layouts that a tour is found for: as many as have so many sweeps in all, at least one.
MOST_LAYOUTS, SWEEPS_IN_ALL = 2, 600
#: Layouts that cost this close are one.
SAME_M = 1e-6
#: Sweeps are laid over what is left unseen so often, then it is looked at piece by piece; less is nothing.
LAID_MENDINGS, MOST_MENDINGS, LEAST_M2 = 3, 12, 1e-3
#: Corners that one sweep costs about.
CORNERS = 2.0


@dataclass(frozen=True, slots=True)
class Layout:
    """Sweeps that see all the ground, (N, 2, 2), and what a flight along them costs about, metres."""

    manner: Manner
    angle_rad: float
    lines: Floats
    cost_m: float


@dataclass(frozen=True, slots=True)
class Auto:
    """The planner's own way to cover an area among obstacles.

    1. Sweeps are laid at the headings of the ground's edges in several manners (``frontier``).
    2. Those that promise the shortest flights each get a tour over all their sweeps, either direction of each
       allowed, over true lengths among obstacles (``tour_kernels``).
    3. The tour of the shortest flight is flown: a stop to turn on the spot counts as the way flown meanwhile.

    Parameters
    ----------
    seed
        Of the shakes.
    """

    seed: int = 0

    def __call__(self, urban: UrbanArea) -> Flown:
        """The flight.

        Raises
        ------
        InfeasibleError
            Where obstacles leave no free ground, or sweeps cannot be joined.
        """
        joiner = Joiner.among(urban, free_space(urban))
        flights = []
        for _, sweeps in self._tours(urban, joiner):
            flight = joiner.graph(sweeps).flown()
            turns = corners(flight.line) if flight.turns is None else flight.turns
            flights.append((line_m(flight.line) + turn_m(urban) * turns, flight))
        return min(flights, key=lambda found: found[0])[1]

    def sequence(self, urban: UrbanArea, joiner: Joiner) -> tuple[Sweep, ...]:
        """Sweeps through an area's free ground in the order and direction flown, joined by nobody yet."""
        return min(self._tours(urban, joiner), key=lambda found: found[0])[1]

    def _tours(self, urban: UrbanArea, joiner: Joiner) -> list[tuple[float, tuple[Sweep, ...]]]:
        """Costs of some tours, about, and their sweeps."""
        joins = Joins.among(urban, joiner.free, joiner.ways)
        found: list[tuple[float, tuple[Sweep, ...]]] = []
        count = 0
        for layout in layouts(urban, joiner.free)[:MOST_LAYOUTS]:
            count += len(layout.lines)
            if found and count > SWEEPS_IN_ALL:
                break
            length_m, lines = joins.tour(mended(layout, urban, joiner.free), self.seed)
            sweeps = tuple(Sweep((a, b), (c, d)) for (a, b), (c, d) in lines.tolist())
            found.append((length_m + CORNERS * turn_m(urban) * len(sweeps), sweeps))
        return found


def layouts(urban: UrbanArea, free: FreeSpace) -> list[Layout]:
    """Ways to see all the ground, the most promising first."""
    edges = edges_of(free.ground)
    found = []
    for angle_rad in headings(edges):
        for downwards in (False, True):
            frontier = Frontier.of(edges, angle_rad, downwards, urban.width_m)
            manners = [Manner(None, gap, bent) for gap, bent in MANNERS]
            if not downwards:
                spare = -frontier.height_m / urban.width_m % 1.0
                levels = dict.fromkeys((*LEVELS, *(0.5 - part * spare for part in SPARED)))
                manners += [Manner(level) for level in levels]
            for manner in manners:
                lines = frontier.lines(urban.width_m, urban.length_m, manner)
                length_m = float(np.hypot(*(lines[:, 1] - lines[:, 0]).T).sum())
                each_m = urban.width_m + CORNERS * turn_m(urban)
                found.append(Layout(manner, angle_rad, lines, length_m + each_m * len(lines)))
    found.sort(key=lambda layout: layout.cost_m)
    costs_m = np.array([layout.cost_m for layout in found])
    return [found[k] for k in np.flatnonzero(np.diff(costs_m, prepend=-math.inf) > SAME_M)]


def mended(layout: Layout, urban: UrbanArea, free: FreeSpace) -> Floats:
    """A layout's lines where they can be flown, and more for what those leave unseen."""
    across_m, along_m, angle_rad = urban.width_m, urban.length_m, layout.angle_rad
    more = clipped(layout.lines, free.ground, angle_rad)
    lines = [more]
    left: BaseGeometry = free.ground
    for tries in range(MOST_MENDINGS):
        seen = seen_from(more, across_m, along_m, angle_rad)
        left = shapely.difference(left, seen, grid_size=GRID_M)
        parts = [part for part in shapely.get_parts(left) if part.area > LEAST_M2]
        if not parts:
            break
        left = shapely.MultiPolygon(parts)
        more = np.array([[part.representative_point().coords[0]] * 2 for part in parts])
        if tries < LAID_MENDINGS:
            edges = edges_of(free.ground)
            frontier = Frontier.of(edges, angle_rad, False, across_m, edges_of(left))
            more = frontier.lines(across_m, along_m, Manner())
        more = clipped(more, free.ground, angle_rad)
        lines.append(more)
    return np.concatenate(lines)


def headings(edges: Floats) -> list[float]:
    """Directions that most of the edges have, and across the first of them."""
    along = edges[:, 2:] - edges[:, :2]
    lengths_m = np.hypot(along[:, 0], along[:, 1])
    angles_rad = np.mod(np.arctan2(along[:, 1], along[:, 0]), math.pi)
    weights = lengths_m.copy()
    found: list[float] = []
    for _ in range(HEADINGS):
        apart = np.abs(
            np.mod(angles_rad[:, None] - angles_rad[None] + math.pi / 2.0, math.pi) - math.pi / 2.0
        )
        together = (apart < APART_RAD / 2.0) @ weights
        best = int(np.argmax(np.round(together, 3)))
        if weights[best] <= 0.0:
            break
        found.append(float(angles_rad[best]))
        weights[apart[best] < APART_RAD] = 0.0
    across = (found[0] + math.pi / 2.0) % math.pi
    if all(abs(math.remainder(across - angle, math.pi)) > APART_RAD for angle in found):
        found.append(across)
    return found


def turn_m(urban: UrbanArea) -> float:
    """What a corner costs: the way flown while the aircraft stops and turns on the spot."""
    return urban.stop_s * urban.speed_m_s if urban.turn_radius_m == 0.0 else 0.0
