"""What the lower bound asks of every tour: passes that must be flown, each one of several families."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry

from planner.coverage.classify import ROUNDING_M, spans_at
from planner.coverage.segments import Neighbourhood
from planner.coverage.sweeps import Side, Sweep
from planner.routing import bound_cells_kernels as kernels
from planner.scenario import Terminal

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: A pair of strips has no least width that asks for it.
ANY_WIDTH = 1e6


@dataclass(frozen=True, slots=True)
class Node:
    """A pass that every tour flies: the families it may be of.

    Parameters
    ----------
    region
        Which one, counted from 0.
    ring, hull
        The region's and its convex hull's, (V, 2), counter-clockwise, relative to ``middle``.
    families
        See ``bound_cells_kernels``, (F, 11).
    group
        Of each family: the passes of one region are of families of one group, int64 (F,).
    approach_rad
        The headings allowed; None for any.
    strip
        0 where the region asks for one pass. Of several, counted to the right from the left of the northward
        of both directions they are flown in: 1 for the first strip, 2 for the last, 2 + k for the one k after
        the first.
    """

    region: int
    ring: Floats
    hull: Floats
    families: Floats
    group: Ints
    approach_rad: tuple[float, ...] | None
    strip: int

    @property
    def middle(self) -> Floats:
        """Where the region is."""
        return np.asarray(self.families[0, 6:8], dtype=np.float64)

    def boxes(self, headings: int) -> Floats:
        """Boxes of that many headings that hold all its passes, (B, 5)."""
        alpha = math.pi / headings
        ways = [((2 * k + 1) * alpha, alpha) for k in range(headings)]
        if self.approach_rad is not None:
            ways = [(float(angle_rad), 0.0) for angle_rad in self.approach_rad]
        rows = [
            (family, theta, alpha, 0.5, 0.5)
            for family in range(len(self.families))
            for theta, alpha in ways
            if self._sees(family, theta)
        ]
        return np.array(rows, dtype=np.float64).reshape(-1, 5)

    def _sees(self, family: int, theta: float) -> bool:
        """Whether a pass of a family, flown that way, sees the strip; of several, one pass sees the first."""
        kind, side = self.families[family, :2]
        if kind == kernels.WHOLE:
            return True
        strips, _, index = self.families[family, 8:]
        northward = theta % (2.0 * math.pi) < math.pi - 1e-9
        from_left = index if (side > 0.0) == northward else strips - 1.0 - index
        return bool(from_left == {0: 0.0, 1: 0.0, 2: strips - 1.0}.get(self.strip, self.strip - 2.0)) and (
            self.strip < 3 or from_left < strips - 1.0
        )


def nodes(sides: Sequence[Side], settle_m: float, region_index: int, most: int = 8) -> list[Node]:
    """The passes one region, part of one or visit to one asks for; of many strips no more than ``most``."""
    region, sensor, height_m = sides[0].region, sides[0].sensor, sides[0].height_m
    ring = _ring(region.area)
    middle = 0.5 * (ring.min(axis=0) + ring.max(axis=0))
    ring = ring - middle
    around = _ring(shapely.convex_hull(shapely.Polygon(ring)))
    swath_m = sensor.swath_m(height_m)
    extras = sorted({side.extra for side in sides if isinstance(side, Sweep)})
    fewest = max(math.ceil((_narrowest_m(around) - ROUNDING_M) / swath_m), 1)
    widest = math.ceil(2.0 * float(np.hypot(*around.T).max()) / swath_m)
    # Kind, how many strips, how many of them beyond the fewest, which one, group.
    kinds: list[tuple[float, int, float, int, int]] = []
    strips = [fewest + extra for extra in extras]
    if any(isinstance(side, Neighbourhood) and side.turns == 0 for side in sides) or 1 in strips:
        kinds.append((kernels.WHOLE, 1, ANY_WIDTH, 0, 0))
        strips.append(1)
    if any(isinstance(side, Neighbourhood) and side.turns > 0 for side in sides):
        kinds.append((kernels.LONG, 2, ANY_WIDTH, 0, 1))
        strips.append(2)
    for extra in extras:
        for count in range(2, widest + extra + 1):
            group = 2 + len(kinds)
            kinds += [(kernels.STRIP, count, float(extra), index, group) for index in range(count)]
    fixed = (sensor.near_m(height_m), swath_m, sensor.run_in_m(height_m), settle_m, *middle)
    families = np.array(
        [
            (kind, 1.0 if look == "right" else -1.0, *fixed, count, extra, index)
            for look in sensor.looks
            for kind, count, extra, index, _ in kinds
        ],
        dtype=np.float64,
    )
    groups = np.array([kind[4] for _ in sensor.looks for kind in kinds], dtype=np.int64)
    flown = min(min(strips), max(most, 2))
    return [
        Node(region_index, ring, around, families, groups, region.approach_rad, strip)
        for strip in (range(1, flown + 1) if flown > 1 else (0,))
    ]


def divided(box: Floats, cell: Floats, slopes: Floats) -> tuple[Floats, Floats]:
    """The parts of a box, (P, 5), and their slopes, (P, 2): a slope is by a whole half-width."""
    parts = kernels.parts(box, cell)
    widths = box[[2, 4]]
    smaller = np.divide(parts[:, [2, 4]], widths, out=np.zeros((len(parts), 2)), where=widths > 0.0)
    return parts, slopes * smaller


def _ring(area: BaseGeometry) -> Floats:
    """The outer ring of a polygon, counter-clockwise, (V, 2)."""
    if not isinstance(area, shapely.Polygon):
        raise TypeError(f"a region has an area, not a {area.geom_type}")
    outer = shapely.geometry.polygon.orient(shapely.Polygon(area.exterior)).exterior
    return np.asarray(shapely.get_coordinates(outer)[:-1], dtype=np.float64)


def _narrowest_m(hull: Floats) -> float:
    """Least width of a convex ring (V, 2): across one of its edges."""
    east, north = (np.roll(hull, -1, axis=0) - hull).T
    return float(spans_at(hull, np.arctan2(north, east)).across_m.min())


def terminal(where: Terminal) -> Floats:
    """East, north, 1 where the heading is fixed, heading; (4,)."""
    angle_rad = where.angle_rad
    return np.array([*where.position, 0.0 if angle_rad is None else 1.0, angle_rad or 0.0])
