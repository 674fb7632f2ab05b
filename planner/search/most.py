"""What no flight of a search finds more than: the ground that it can sweep at all, were it all worth most.

A flight of length L, its sensor on where and whenever it likes, sees no more ground than a disc round all
that the sensor sees at once sweeps along it, 2 ρ L + π ρ²; one that sees a strip beside the line no more than
the strip's width times L. Looks fall on the ground that is worth most within reach of start and end, each
look on a place worth (1 − p) of the one before: a fractional knapsack of pieces of ground, each of one score,
filled by what a square metre pays. Polygons, rasters and each point are taken by themselves, and added up.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from planner.search.programme import Place
from planner.search.values import Swath
from planner.wishes import Importance, ImportancePatch, ImportancePoint, ImportanceRaster

Floats = NDArray[np.float64]
#: Scores by the square metre and areas of pieces of ground, (N,) each.
Pieces = tuple[Floats, Floats]

#: Looks at one place that are told apart; what is left after these is taken for found.
LOOKS = 8
#: A point's worth is cut into so many rings out to so many spreads, each worth what its inner edge is.
RINGS, SPREADS = 400, 8.0
#: Corners of the ellipse that is within reach.
CORNERS = 256
#: More polygons are not cut along each other's edges, but added up whole.
MOST_OVERLAID = 60
#: Areas of overlays are no more exact than this part of them.
ROUNDING = 1e-6


@dataclass(frozen=True, slots=True)
class Sweeping:
    """One flight's reach.

    Parameters
    ----------
    length_m
        Over the ground at most; inf where nothing limits it.
    swaths
        Of every course and side.
    """

    start: Place
    end: Place
    length_m: float
    swaths: tuple[Swath, ...]

    @property
    def reach_m(self) -> float:
        """Farthest that anything is seen from below the aircraft."""
        return max(
            math.hypot(max(abs(s.left_m), abs(s.right_m)), max(abs(s.run_in_m), abs(s.run_out_m)))
            for s in self.swaths
        )

    @property
    def area_m2(self) -> float:
        """Ground seen at most."""
        widest_m = max(swath.width_m for swath in self.swaths)
        if all(swath.run_in_m + swath.run_out_m >= 0.0 for swath in self.swaths):
            return widest_m * self.length_m
        return 2.0 * self.reach_m * self.length_m + math.pi * self.reach_m**2

    def within(self) -> Polygon | None:
        """All that may be seen on a way from start to end, or a little more; None without a limit."""
        long_m = 0.5 * self.length_m + self.reach_m
        if not math.isfinite(long_m):
            return None
        apart = np.subtract(self.end, self.start)
        half_m = 0.5 * float(np.hypot(*apart))
        axes = np.array([max(long_m, half_m), math.sqrt(max(long_m**2 - half_m**2, 0.0))])
        angles = math.tau * np.arange(CORNERS) / CORNERS
        round_ = np.stack([np.cos(angles), np.sin(angles)], axis=1) / math.cos(math.pi / CORNERS) * axes
        turn = math.atan2(apart[1], apart[0])
        turned = round_ @ np.array([[math.cos(turn), math.sin(turn)], [-math.sin(turn), math.cos(turn)]])
        return Polygon(turned + np.add(self.start, self.end) / 2.0)


def most_found(
    ground: BaseGeometry, importance: Importance, flights: Sequence[Sweeping]
) -> tuple[float, float]:
    """Ground that all flights together see at most, m², and the worth that they find at most."""
    ellipses = [one.within() for one in flights]
    limited = [ellipse for ellipse in ellipses if ellipse is not None]
    if len(limited) == len(ellipses):
        ground = shapely.intersection(ground, shapely.union_all(limited))
    swept_m2 = math.fsum(one.area_m2 for one in flights)
    sources = [*(_of_point(point) for point in importance.points), _of_patches(importance.patches, ground)]
    if importance.raster is not None:
        sources.append(_of_raster(importance.raster, ground))
    worth = math.fsum(most_of(pieces, swept_m2, importance.detection) for pieces in sources)
    return min(swept_m2, ground.area) * (1.0 + ROUNDING), worth * (1.0 + ROUNDING)


def most_of(pieces: Pieces, swept_m2: float, detection: float = 1.0) -> float:
    """The worth that looks over so much ground find at most."""
    scores, areas_m2 = pieces
    missed = 1.0 - detection
    looks = 1 if missed <= 0.0 else LOOKS
    pays = np.concatenate([scores * detection * missed**k for k in range(looks)])
    order = np.argsort(-pays, kind="stable")
    areas_m2 = np.tile(areas_m2, looks)[order]
    taken_m2 = np.clip(swept_m2 - (np.cumsum(areas_m2) - areas_m2), 0.0, areas_m2)
    # Looks beyond those told apart.
    rest = float((scores * pieces[1]).sum()) * missed**looks
    return float((pays[order] * taken_m2).sum()) + rest


def _of_point(point: ImportancePoint) -> Pieces:
    edges = np.linspace(0.0, SPREADS, RINGS + 1)
    scores = point.score * np.exp(-0.5 * edges[:-1] ** 2)
    return scores, math.pi * point.spread_m**2 * np.diff(edges**2)


def _of_patches(patches: Sequence[ImportancePatch], ground: BaseGeometry) -> Pieces:
    """Polygons cut along each other's edges, so that scores of each piece add up."""
    found: list[tuple[float, BaseGeometry]] = []
    for patch in patches:
        left = shapely.intersection(patch.area, ground)
        again: list[tuple[float, BaseGeometry]] = []
        for score, area in found if len(patches) <= MOST_OVERLAID else []:
            both = shapely.intersection(area, left)
            if both.area > 0.0:
                again.append((score + patch.score, both))
                area, left = shapely.difference(area, both), shapely.difference(left, both)
            again.append((score, area))
        if len(patches) > MOST_OVERLAID:
            again = found
        found = [*again, (patch.score, left)]
    return np.array([score for score, _ in found]), np.array([area.area for _, area in found])


def _of_raster(raster: ImportanceRaster, ground: BaseGeometry) -> Pieces:
    """Its cells within reach, those that the edge goes through whole."""
    rows, columns = raster.scores.shape
    row, column = np.divmod(np.arange(rows * columns), columns)
    near = ground.buffer(raster.cell_m)
    shapely.prepare(near)
    east = raster.west_m + raster.cell_m * (column + 0.5)
    north = raster.south_m + raster.cell_m * (row + 0.5)
    inside = shapely.contains_xy(near, east, north)
    scores = raster.scores.ravel()[inside]
    return scores, np.full(len(scores), raster.cell_m**2)
