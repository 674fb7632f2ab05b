"""Proof that a line keeps its distance from what is hard.

The distance to a zone changes by no more than one goes along the line, so between two samples Δ apart, at
distances a and b from it, the line comes no nearer than (a + b - Δ) / 2. Where that is not enough to decide,
the stretch is halved.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from planner.airspace.zones import KeepOut
from planner.dubins.path import Path

Array = NDArray[np.float64]

#: First spacing of samples.
STEP_M = 25.0

#: The proof ends when the line is known this well.
TOLERANCE_M = 0.01


@dataclass(frozen=True, slots=True)
class Clearance:
    """How far a line stays from hard zones and from the area's edge; negative inside (outside the area).

    Parameters
    ----------
    proven_m
        It is nowhere nearer.
    seen_m
        So near it is at ``where``; no more than the tolerance above ``proven_m``.
    where
        east_m, north_m of the nearest place sampled.
    """

    proven_m: float
    seen_m: float
    where: tuple[float, float]


def clearance(path: Path, zones: KeepOut, tolerance_m: float = TOLERANCE_M) -> Clearance | None:
    """Least distance of a line from the hard zones and the area's edge, proven; None without any.

    Parameters
    ----------
    path
        Measured as it is, arcs as arcs.
    zones
        Soft ones among them do not count.
    """
    discs = np.array([row for row, d in zip(zones.disc_array(), zones.discs, strict=True) if d.hard])
    solid = _solid(tuple(zone.polygon for zone in zones.polygons if zone.hard))
    if len(discs) == 0 and solid.is_empty and zones.area is None:
        return None
    discs = discs.reshape(-1, 3)
    begins = np.cumsum([0.0, *(segment.length_m for segment in path.segments)])

    def places(along_m: Array) -> Array:
        which = np.clip(np.searchsorted(begins, along_m, side="right") - 1, 0, len(path.segments) - 1)
        poses = [path.segments[k].at(at_m) for k, at_m in zip(which, along_m - begins[which], strict=True)]
        return np.array([pose.position for pose in poses], dtype=np.float64)

    def distances(points: Array) -> Array:
        least = np.full(len(points), np.inf)
        for east_m, north_m, radius_m in discs:
            least = np.minimum(least, np.hypot(points[:, 0] - east_m, points[:, 1] - north_m) - radius_m)
        if not solid.is_empty:
            least = np.minimum(least, _signed(solid, points))
        if zones.area is not None:
            least = np.minimum(least, -_signed(zones.area, points))
        return least

    count = max(2, int(begins[-1] / STEP_M) + 2)
    along_m = np.linspace(0.0, begins[-1], count)
    points = places(along_m)
    found_m = distances(points)
    nearest = int(np.argmin(found_m))
    seen_m, where = float(found_m[nearest]), points[nearest]
    proven_m = seen_m
    low_m, high_m, at_low, at_high = along_m[:-1], along_m[1:], found_m[:-1], found_m[1:]
    while len(low_m):
        bounds = 0.5 * (at_low + at_high - (high_m - low_m))
        open_ = bounds < seen_m - tolerance_m
        proven_m = min(proven_m, float(bounds[~open_].min(initial=np.inf)))
        low_m, high_m, at_low, at_high = low_m[open_], high_m[open_], at_low[open_], at_high[open_]
        if len(low_m) == 0:
            break
        middle_m = 0.5 * (low_m + high_m)
        points = places(middle_m)
        at_middle = distances(points)
        nearest = int(np.argmin(at_middle))
        if at_middle[nearest] < seen_m:
            seen_m, where = float(at_middle[nearest]), points[nearest]
        low_m, high_m = np.concatenate([low_m, middle_m]), np.concatenate([middle_m, high_m])
        at_low, at_high = np.concatenate([at_low, at_middle]), np.concatenate([at_middle, at_high])
    return Clearance(proven_m, seen_m, (float(where[0]), float(where[1])))


@lru_cache(maxsize=64)
def _solid(polygons: tuple[Polygon, ...]) -> BaseGeometry:
    """Zones as one; every leg of a plan is among the same."""
    solid = shapely.union_all(polygons)
    shapely.prepare(solid)
    return solid


def _signed(shape: BaseGeometry, points: Array) -> Array:
    """Distance from a shape, negative inside, shape (N,)."""
    spots = shapely.points(points)
    outside = shapely.distance(shape, spots)
    within = shapely.contains_xy(shape, points[:, 0], points[:, 1])
    depth = shapely.distance(shapely.boundary(shape), spots) if within.any() else outside
    return np.asarray(np.where(within, -depth, outside), dtype=np.float64)


def proven_m(path: Path, zones: KeepOut) -> float | None:
    """The proven clearance alone, for a plan."""
    found = clearance(path, zones)
    return None if found is None else found.proven_m
