"""Majeed and Lee 2019: coverage by footprint sweeps fitted into free ground, seven steps (section 3)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import shapely
from shapely.geometry import MultiPolygon
from shapely.geometry.base import BaseGeometry

from planner.coverage.decompose import cuts, is_plain
from planner.coverage.urban.area import UrbanArea
from planner.coverage.urban.fitting import Fitting, directions
from planner.coverage.urban.free import FreeSpace, free_space
from planner.coverage.urban.measures import Flown, Sweep
from planner.coverage.urban.order import Solver, opened, oriented, visiting_order
from planner.coverage.urban.waypoints import Joiner

#: ``back-and-forth`` takes every g-th sweep and comes back for the others; ``zamboni`` goes g on, g - 1 back.
Pattern = Literal["back-and-forth", "zamboni"]

#: "The gap g of two or three" (section 3.6).
WIDEST_GAP = 3
#: Divisions of an area of complex shape that are tried.
MOST_DIVISIONS = 6


@dataclass(frozen=True, slots=True)
class Majeed2019:
    """What the paper leaves to choose.

    Parameters
    ----------
    solver
        Of the order of sweeps.
    pattern
        How the order is flown.
    gap
        g: how many sweeps on the next one is. None: 1 for an aircraft that turns on the spot, and for
        others the least, up to 3, that its turn takes.
    seed
        Of the ants.
    """

    solver: Solver = "ants"
    pattern: Pattern = "back-and-forth"
    gap: int | None = None
    seed: int = 0

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
        """Sweeps in the order and direction of the visiting sequence, before they are joined."""
        sweeps = fitted(urban, free.ground)
        tour = opened(visiting_order(sweeps, self.solver, self.seed), sweeps, urban.start, urban.end)
        places = with_gap(len(sweeps), self.gap or least_gap(urban), self.pattern)
        return oriented([sweeps[tour[place]] for place in places], urban.start, urban.end)


def fitted(urban: UrbanArea, ground: MultiPolygon) -> tuple[Sweep, ...]:
    """Sweeps that see all the ground, in one direction or in several (sections 3.3 and 3.4).

    "We employ either one or multiple coverage directions depending upon the AOI complexity": where an area is
    far from convex, it is also cut in two at a corner that sticks in, each part with a direction of its own;
    the division, or the whole, whose lanes are cut into the fewest pieces is taken.
    """
    fitting = Fitting.of(urban)
    outline = shapely.Polygon(urban.area.exterior)
    whole = [(ground, directions(outline, ground, fitting))]
    ways = [whole]
    if not is_plain(outline):
        for pieces, _ in zip(cuts(outline), range(MOST_DIVISIONS), strict=False):
            parts = _parts(ground, pieces)
            ways.append([(part, directions(piece, part, fitting)) for part, piece in parts])
    best = min(ways, key=lambda way: sum(fitting.lanes_needed(part, angles[0]) for part, angles in way))
    return tuple(sweep for part, angles in best for sweep in fitting.sweeps(part, angles[0], ground))


def least_gap(urban: UrbanArea) -> int:
    """g sweeps apart an aircraft turns round in a half circle, if three are enough."""
    return min(max(math.ceil(2.0 * urban.turn_radius_m / urban.width_m), 1), WIDEST_GAP)


def with_gap(count: int, gap: int, pattern: Pattern) -> Sequence[int]:
    """Places of a sequence in the order that a pattern with gap g flies them, each once."""
    if gap <= 1:
        return range(count)
    if pattern == "zamboni":
        found: list[int] = []
        for block in range(0, count, 2 * gap):
            for k in range(gap):
                found += [each for each in (block + k, block + k + gap) if each < count]
        return found
    return [
        place
        for first in range(gap)
        for place in (range(first, count, gap) if first % 2 == 0 else reversed(range(first, count, gap)))
    ]


def _parts(
    ground: MultiPolygon, pieces: tuple[shapely.Polygon, ...]
) -> list[tuple[MultiPolygon, shapely.Polygon]]:
    """Of each piece the ground that no piece before it has."""
    found = []
    left: BaseGeometry = ground
    for piece in pieces:
        inside = shapely.intersection(left, piece, grid_size=1e-6)
        areas = [part for part in shapely.get_parts(inside) if isinstance(part, shapely.Polygon)]
        left = shapely.difference(left, piece, grid_size=1e-6)
        if areas:
            found.append((MultiPolygon(areas), piece))
    return found
