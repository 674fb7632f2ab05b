"""Merging of neighbouring regions: the close filter of eq 15.

Li, Chen, Wang, Li (2018), section 4.1, works on a binary map image; here the same filter works on the
outlines themselves, so nothing depends on a pixel size. The paper's structuring element is a disk of 15
pixels of 5.4 m.
"""

from __future__ import annotations

import math
from collections import defaultdict
from dataclasses import dataclass, replace

import numpy as np
import shapely
from shapely.geometry import LineString, MultiPolygon, Polygon
from shapely.geometry.base import BaseGeometry

from planner.airspace.growth import grown
from planner.wishes import Pattern, Region

#: 15 pixels of 5.4 m, section 5.1.
PAPER_RADIUS_M = 81.0

#: A smaller disk bridges nothing that matters and is lost in the rounding of coordinates.
_LEAST_RADIUS_M = 0.001

#: Patterns that are one region's own.
ALONE: tuple[Pattern, ...] = ("crosshatch", "orbit", "spiral", "look")

#: Overlays snap to this grid: GEOS 3.14 takes polygons that agree but for 1e-13 m as lying apart.
GRID_M = 1e-9

#: Segments per quarter circle: the disk is 0.1 m too small at most at the paper's radius.
_QUADRANT_SEGMENTS = 16


@dataclass(frozen=True, slots=True)
class MergedRegion:
    """One connected component after the close filter: what one pass, or one pair of passes, must see.

    Parameters
    ----------
    names
        The regions it holds parts of, in the scenario's order.
    area
        The closed shape: the parts and the gaps the filter filled.
    originals
        The parts as they were asked for.
    owners
        The name of each part's region, in step with ``originals``.
    sensor
        Name of the sensor asked for, None for the scenario's first.
    approach_rad
        Allowed flight directions, None for any.
    required
        Whether a plan without it is a failure.
    revisits
        How many visits are asked for.
    visit
        Which of how many visits this is; None for the only one.
    axes
        Of each part the line it follows as a corridor, None for others, in step with ``originals``; empty for
        pieces of what was asked for.
    altitude_m, over_ground_m
        Of its passes, see ``Region``.
    pattern
        See ``Region``.
    """

    names: tuple[str, ...]
    area: Polygon
    originals: tuple[Polygon, ...]
    owners: tuple[str, ...]
    sensor: str | None = None
    approach_rad: tuple[float, ...] | None = None
    required: bool = True
    revisits: int = 1
    visit: tuple[int, int] | None = None
    axes: tuple[LineString | None, ...] = ()
    altitude_m: float | None = None
    over_ground_m: float | None = None
    pattern: Pattern = "auto"

    @property
    def axis(self) -> LineString | None:
        """The line that it follows as a corridor; None for other shapes and for merged ones."""
        return self.axes[0] if len(self.axes) == 1 else None

    @property
    def label(self) -> str:
        """The names in one word, for messages."""
        return "+".join(self.names)

    @property
    def centroid(self) -> tuple[float, float]:
        """Centroid of the closed shape, east and north in metres."""
        centroid = self.area.centroid
        return (centroid.x, centroid.y)

    def split(self) -> tuple[MergedRegion, ...]:
        """The parts again, each for itself."""
        return tuple(
            replace(
                self, names=(owner,), area=part, originals=(part,), owners=(owner,), axes=self.axes[k : k + 1]
            )
            for k, (owner, part) in enumerate(zip(self.owners, self.originals, strict=True))
        )

    def piece(self, area: Polygon) -> MergedRegion:
        """A piece of it, under the names of the parts it holds ground of."""
        owners = [
            owner
            for owner, original in zip(self.owners, self.originals, strict=True)
            if original.intersection(area).area > 0.0
        ]
        names = tuple(name for name in self.names if name in owners) or self.names
        return replace(self, names=names, area=area, originals=(area,) * len(names), owners=names, axes=())


def polygons_of(area: BaseGeometry) -> tuple[Polygon, ...]:
    """The polygons of a geometry, in its order."""
    if isinstance(area, Polygon):
        return (area,)
    if isinstance(area, MultiPolygon):
        return tuple(area.geoms)
    raise TypeError(f"a region is a polygon or several, not a {area.geom_type}")


def split_region(region: Region) -> tuple[MergedRegion, ...]:
    """The connected parts of one region, unmerged; each must be seen, each keeps the region's name."""
    return tuple(
        MergedRegion(
            (region.name,),
            part,
            (part,),
            (region.name,),
            region.sensor,
            region.approach_rad,
            region.required,
            region.revisits,
            None,
            (region.axis,),
            region.altitude_m,
            region.over_ground_m,
            region.pattern,
        )
        for part in polygons_of(region.area)
    )


def merge_regions(
    regions: tuple[Region, ...], radius_m: float = PAPER_RADIUS_M, default_sensor: str | None = None
) -> tuple[MergedRegion, ...]:
    """Close filter, then connected components (eq 15 and section 4.1).

    Dilation and erosion by a disk are shapely's buffers by +r and −r. Parts further apart than the filter
    bridges stay apart, also parts of one MultiPolygon: each becomes a region of its own under the same name.
    Regions merge only where they ask for the same sensor, approach directions, altitude, pattern and number
    of visits, and are both required or both not: otherwise one would lose what it asked for. Those of a
    pattern of their own stay alone.

    Parameters
    ----------
    regions
        As asked for.
    radius_m
        Radius of the disk; 0 merges only what touches.
    default_sensor
        The sensor meant by regions that name none, so that naming it makes no difference.

    Returns
    -------
    tuple of MergedRegion
        In the order of their first region.
    """
    groups: dict[object, list[tuple[int, MergedRegion]]] = defaultdict(list)
    for index, region in enumerate(regions):
        limits = None
        if region.approach_rad is not None:
            limits = frozenset(round(math.degrees(angle) % 360.0, 6) % 360.0 for angle in region.approach_rad)
        key = (
            region.sensor or default_sensor, limits, region.required, region.revisits, region.altitude_m,
            region.over_ground_m, region.pattern, region.name if region.pattern in ALONE else None,
        )  # fmt: skip
        groups[key].extend((index, part) for part in split_region(region))
    merged = [found for group in groups.values() for found in _merge_group(group, radius_m)]
    merged.sort(key=lambda item: item[0])
    return tuple(region for _, region in merged)


def _merge_group(parts: list[tuple[int, MergedRegion]], radius_m: float) -> list[tuple[int, MergedRegion]]:
    closed = close_filter(shapely.union_all([part.area for _, part in parts], grid_size=GRID_M), radius_m)
    components = polygons_of(closed)
    tree = shapely.STRtree(components)
    members: dict[int, list[tuple[int, MergedRegion]]] = defaultdict(list)
    for index, part in parts:
        component = int(tree.nearest(part.area.representative_point()))
        members[component].append((index, part))
    merged: list[tuple[int, MergedRegion]] = []
    for component, group in members.items():
        first_index, first = group[0]
        owners = tuple(part.names[0] for _, part in group)
        names = tuple(dict.fromkeys(owners))
        originals = tuple(part.area for _, part in group)
        whole = replace(
            first,
            names=names,
            area=components[component],
            originals=originals,
            owners=owners,
            axes=tuple(axis for _, part in group for axis in part.axes),
        )
        merged.append((first_index, whole))
    return merged


def _is_convex(shape: BaseGeometry) -> bool:
    """Whether closing adds nothing to it, roundings aside."""
    hull = shape.convex_hull
    return bool(hull.area - shape.area <= GRID_M * hull.length)


def close_filter(area: BaseGeometry, radius_m: float) -> BaseGeometry:
    """Eq 15 on outlines: dilation, then erosion, by a disk.

    As with a true disk, the result holds ``area`` and keeps to the convex hull of what the dilation joins:
    what the polygonal disk nibbles off or adds is put right, so a lone region keeps its exact spans.
    """
    if radius_m < _LEAST_RADIUS_M:
        return shapely.union_all([area], grid_size=GRID_M)
    wide = grown(area, radius_m, _QUADRANT_SEGMENTS)
    pieces: list[BaseGeometry] = []
    parts = polygons_of(area)
    tree = shapely.STRtree(parts)
    for island in polygons_of(wide):
        there = shapely.MultiPolygon([parts[k] for k in np.sort(tree.query(island, predicate="intersects"))])
        inside = shapely.intersection(there, island, grid_size=GRID_M)
        if _is_convex(inside):
            pieces.append(inside)
            continue
        closed = island.buffer(-radius_m, quad_segs=_QUADRANT_SEGMENTS)
        kept = shapely.intersection(closed, inside.convex_hull, grid_size=GRID_M)
        pieces.append(shapely.union_all([kept, inside], grid_size=GRID_M))
    whole = shapely.union_all(pieces, grid_size=GRID_M)
    return shapely.MultiPolygon([p for p in shapely.get_parts(whole) if isinstance(p, Polygon)])
