"""What the lower bound asks of every tour: passes that must be flown, each one of several families."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry

from planner.coverage.classify import ROUNDING_M
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
        See ``bound_cells_kernels``, (F, 10).
    group
        Of each family: two passes of one region are of families of one group, int64 (F,).
    approach_rad
        The headings allowed; None for any.
    strip
        0 where the region asks for one pass; 1 or 2 for the outermost strips of two or more, to the left and
        to the right of the northward of both directions they are flown in.
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
            if self.strip == 0 or self._sees(family, theta) == self.strip
        ]
        return np.array(rows, dtype=np.float64).reshape(-1, 5)

    def _sees(self, family: int, theta: float) -> int:
        """Which strip a pass of a family sees. A strip is on the side of its line, or on the other."""
        kind, side = self.families[family, :2]
        northward = theta % (2.0 * math.pi) < math.pi - 1e-9
        line_is_left = (side > 0.0) == northward
        return 1 if line_is_left == (kind != kernels.FAR_STRIP) else 2


def nodes(sides: Sequence[Side], settle_m: float, region_index: int) -> list[Node]:
    """The passes one region, part of one or visit to one asks for."""
    region, sensor, height_m = sides[0].region, sides[0].sensor, sides[0].height_m
    ring = _ring(region.area)
    middle = 0.5 * (ring.min(axis=0) + ring.max(axis=0))
    ring = ring - middle
    around = _ring(shapely.convex_hull(shapely.Polygon(ring)))
    swath_m = sensor.swath_m(height_m)
    extras = {side.extra for side in sides if isinstance(side, Sweep)}
    widest = math.ceil(2.0 * float(np.hypot(*around.T).max()) / swath_m)
    # Kind, how many strips, how many of them beyond the fewest, group.
    kinds: list[tuple[float, float, float, int]] = []
    if any(isinstance(side, Neighbourhood) and side.turns == 0 for side in sides) or (
        0 in extras and _narrowest_m(around) <= swath_m + ROUNDING_M
    ):
        kinds.append((kernels.WHOLE, 1.0, ANY_WIDTH, 0))
    single = bool(kinds)
    if any(isinstance(side, Neighbourhood) and side.turns > 0 for side in sides):
        kinds.append((kernels.NEAR_LONG, 2.0, ANY_WIDTH, 1))
    for extra in sorted(extras):
        for strips in range(2, widest + extra + 1):
            group = 2 + len(kinds)
            kinds.append((kernels.NEAR_STRIP, float(strips), float(extra), group))
            kinds.append((kernels.FAR_STRIP, float(strips), float(extra), group))
    fixed = (sensor.near_m(height_m), swath_m, sensor.run_in_m(height_m), settle_m, *middle)
    families = np.array(
        [
            (kind, 1.0 if look == "right" else -1.0, *fixed, strips, extra)
            for look in sensor.looks
            for kind, strips, extra, _ in kinds
        ],
        dtype=np.float64,
    )
    groups = np.array([kind[3] for _ in sensor.looks for kind in kinds], dtype=np.int64)
    return [
        Node(region_index, ring, around, families, groups, region.approach_rad, strip)
        for strip in ((0,) if single else (1, 2))
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
    along = np.roll(hull, -1, axis=0) - hull
    normals = np.stack([-along[:, 1], along[:, 0]], axis=1)
    lengths = np.hypot(*along.T)
    normals = normals[lengths > 0.0] / lengths[lengths > 0.0, None]
    heights = hull @ normals.T
    return float((heights.max(axis=0) - heights.min(axis=0)).min())


def terminal(where: Terminal) -> Floats:
    """East, north, 1 where the heading is fixed, heading; (4,)."""
    angle_rad = where.angle_rad
    return np.array([*where.position, 0.0 if angle_rad is None else 1.0, angle_rad or 0.0])
