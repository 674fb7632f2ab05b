"""Where one may fly among obstacles, and what is to be seen from there (Majeed and Lee 2019, section 3.2)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from shapely.geometry import MultiPolygon, Point, Polygon
from shapely.geometry.base import BaseGeometry

from planner.coverage.urban.area import Building, UrbanArea
from planner.errors import InfeasibleError
from planner.wishes import HIGHEST_M

#: Corners of enlarged outlines are sharp up to this ratio; sharper ones are cut off beyond the clearance.
MITRE_LIMIT = 2.0
#: Overlays snap to this grid.
GRID_M = 1e-6
#: Free ground in pieces smaller than this is rounding.
LEAST_PIECE_M2 = 1.0


@dataclass(frozen=True, slots=True)
class Cluster:
    """Enlarged obstacles that touch, as one.

    Parameters
    ----------
    outline
        Not to be entered below the top.
    top_m
        Of the highest, over the ground, without the clearance.
    """

    outline: Polygon
    top_m: float


@dataclass(frozen=True, slots=True)
class FreeSpace:
    """The traversable part of an area.

    Parameters
    ----------
    ground
        What is to be seen, and where it is flown at the height of the sweeps: all that can be reached.
    clusters
        What stands in the way.
    unreached_m2
        Free ground that nothing leads to: it is not in ``ground``.
    """

    ground: MultiPolygon
    clusters: tuple[Cluster, ...]
    unreached_m2: float


def free_space(urban: UrbanArea) -> FreeSpace:
    """Hulls, enlargement, clusters, and what is left of the area.

    What the paper's text leaves open: it makes every obstacle a box of eight corners along the axes (its
    matrix O_i) and convex by its hull. Here an obstacle is the hull itself, which for its boxes is the same.
    Its H_min discards obstacles "that fall below" and can be gone over "safely": here those that the height
    of the sweeps clears by D_safe.

    Raises
    ------
    InfeasibleError
        Where no free ground is left, or the start stands in none.
    """
    standing = [building for building in urban.buildings if not urban.passes_over(building)]
    clusters = _clusters(urban, standing)
    inner = urban.area.buffer(-urban.span_m / 2.0, join_style="mitre", mitre_limit=MITRE_LIMIT)
    blocked = shapely.union_all([cluster.outline for cluster in clusters])
    open_ground = _passable(shapely.difference(inner, blocked, grid_size=GRID_M), urban.span_m)
    parts = [part for part in shapely.get_parts(open_ground) if part.area >= LEAST_PIECE_M2]
    if not parts:
        raise InfeasibleError(
            "hard-zone",
            "area",
            "obstacles and their clearance fill the area at this height",
            _relaxation(urban, standing),
        )
    tall = [cluster.outline for cluster in clusters if not urban.may_climb_over(cluster.top_m)]
    within = shapely.difference(inner, shapely.union_all(tall), grid_size=GRID_M)
    reached = _reached(parts, list(shapely.get_parts(within)), urban)
    left_m2 = sum(part.area for part in parts) - sum(part.area for part in reached)
    return FreeSpace(MultiPolygon(reached), clusters, left_m2)


def enlarged(outline: Polygon, clearance_m: float) -> Polygon:
    """The hull of an obstacle, pushed outward by D_safe (figure 4)."""
    hull = outline.convex_hull
    grown: Polygon = hull.buffer(clearance_m, join_style="mitre", mitre_limit=MITRE_LIMIT)
    return grown


def _clusters(urban: UrbanArea, standing: list[Building]) -> tuple[Cluster, ...]:
    """Enlarged obstacles that overlap, or leave too narrow a gap, as one each (section 3.2.2).

    The paper clusters what overlaps "or becomes so close to each other that the UAV can collide": here what
    leaves less than the aircraft's span. The cluster is the outline of its members, not their hull, which
    would take away ground that can be reached.
    """
    grown = [enlarged(building.outline, urban.clearance_m) for building in standing]
    half_m = urban.span_m / 2.0
    closed = _mitred(_mitred(shapely.union_all(grown), half_m), -half_m)
    joined = shapely.union_all([closed, *grown])
    outlines = [part for part in shapely.get_parts(joined) if isinstance(part, Polygon)]
    inside = shapely.point_on_surface(np.array(grown, dtype=object))
    tops_m = [0.0] * len(outlines)
    for member, outline in shapely.STRtree(outlines).query(inside, predicate="intersects").T:
        tops_m[outline] = max(tops_m[outline], standing[member].height_m)
    return tuple(Cluster(outline, top_m) for outline, top_m in zip(outlines, tops_m, strict=True))


def _passable(ground: BaseGeometry, span_m: float) -> BaseGeometry:
    """Ground without what is narrower than the aircraft."""
    if span_m <= 0.0:
        return ground
    wide = _mitred(_mitred(ground, -span_m / 2.0), span_m / 2.0)
    return shapely.intersection(ground, wide, grid_size=GRID_M)


def _mitred(shape: BaseGeometry, by_m: float) -> BaseGeometry:
    return shape.buffer(by_m, join_style="mitre", mitre_limit=MITRE_LIMIT)


def _reached(parts: list[Polygon], within: list[BaseGeometry], urban: UrbanArea) -> list[Polygon]:
    """Parts that flight from the start leads to, round obstacles or over those that are not too high."""
    start = Point(urban.start)
    nearest = min(parts, key=lambda part: float(part.distance(start)))
    if nearest.distance(start) > urban.clearance_m + urban.span_m:
        raise InfeasibleError(
            "hard-zone",
            "start",
            f"the start lies {nearest.distance(start):.0f} m from free ground",
            "move the start out of the obstacles and into the area",
            urban.start,
        )
    home = [piece for piece in within if piece.intersects(nearest.representative_point())]
    return [part for part in parts if any(piece.intersects(part.representative_point()) for piece in home)]


def _relaxation(urban: UrbanArea, standing: list[Building]) -> str:
    over_m = max((building.height_m for building in standing), default=0.0) + urban.clearance_m
    if over_m <= urban.max_height_m:
        return f"a flight height of {over_m:.0f} m passes over all of them"
    higher = f"a highest height of {over_m:.0f} m or more, or " if over_m <= HIGHEST_M else ""
    return f"{higher}less than {urban.clearance_m:g} m clearance"
