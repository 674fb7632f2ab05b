"""What may not be entered: discs and polygons inflated by their margins, and the area kept to.

Zones know lines by their shape alone (``Line``), so that the judge of a plan can use them without the
planner's own curves.
"""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import dataclass, field, replace
from functools import lru_cache

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import MultiPolygon, Polygon
from shapely.geometry.base import BaseGeometry

from planner.airspace.airspace import Airspace, Level
from planner.airspace.shapes import DiscShape, banded_shapes
from planner.airspace.zone_kernels import depths, is_clear
from planner.route import Line, Point

#: A line no deeper than this in a zone touches it and is clear.
TOUCH_M = 1e-3

#: Transits keep this far from zones and the area's edge, more than the chords of arcs can cut.
TRANSIT_MARGIN_M = 2.0

#: Name of the operating area in conflicts.
AREA = "area"

#: Gaps between polygons narrower than twice this are closed: no line passes between adjoining zones.
SEAM_M = TOUCH_M

#: Corners of inflated polygons are mitred up to this many margins, so that they hold the rounded ones.
MITRE_LIMIT = 2.0

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Disc:
    """A disc kept clear; ``hard`` ones always."""

    name: str
    east_m: float
    north_m: float
    radius_m: float
    hard: bool


@dataclass(frozen=True, slots=True)
class PolygonZone:
    """A polygon kept clear; ``hard`` ones always."""

    name: str
    polygon: Polygon
    hard: bool


@dataclass(frozen=True, slots=True)
class Conflict:
    """A line enters a zone: the deepest place (east, north) and how far it is from the zone's edge there."""

    zone: str
    where: Point
    depth_m: float
    hard: bool


@dataclass(frozen=True, slots=True, eq=False)
class Ground:
    """Polygons and area as one shape: what is free inside an area, else what is forbidden.

    ``shape`` is exact; ``closed`` has the seams between adjoining zones closed, ``edges`` are its edges.
    """

    shape: Polygon | MultiPolygon
    closed: Polygon | MultiPolygon
    edges: Array
    free: bool


@dataclass(frozen=True, slots=True)
class KeepOut:
    """Discs and polygons to keep out of and the area to stay in, margins included."""

    discs: tuple[Disc, ...] = ()
    polygons: tuple[PolygonZone, ...] = ()
    area: Polygon | MultiPolygon | None = None
    _discs: Array = field(init=False, repr=False, compare=False)
    _edges: tuple[Array, NDArray[np.int64]] = field(init=False, repr=False, compare=False)
    _area: Array = field(init=False, repr=False, compare=False)
    _barrier: Array = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        discs = [(disc.east_m, disc.north_m, disc.radius_m) for disc in self.discs]
        rings = [ring_edges(zone.polygon) for zone in self.polygons]
        offsets = np.cumsum([0, *(len(edges) for edges in rings)], dtype=np.int64)
        edges = np.concatenate(rings) if rings else np.empty((0, 4))
        object.__setattr__(self, "_discs", np.array(discs, dtype=np.float64).reshape(-1, 3))
        object.__setattr__(self, "_edges", (edges, offsets))
        object.__setattr__(self, "_area", np.empty((0, 4)) if self.area is None else ring_edges(self.area))
        object.__setattr__(self, "_barrier", self.ground().edges)

    def disc_array(self) -> Array:
        """Discs, float64, shape (K, 3): east_m, north_m, radius_m. Not to be written to."""
        return self._discs

    def edge_arrays(self) -> tuple[Array, NDArray[np.int64]]:
        """Edges of the polygons, float64 (E, 4): east0, north0, east1, north1; and offsets, int64 (P + 1).

        Polygon p has ``edges[offsets[p]:offsets[p + 1]]``, holes among them. Not to be written to.
        """
        return self._edges

    def area_edges(self) -> Array:
        """Edges of the area, float64 (A, 4), none without an area. Not to be written to."""
        return self._area

    def ground(self) -> Ground:
        """The polygons and the area as one."""
        return _ground(tuple(zone.polygon for zone in self.polygons), self.area)

    def conflicts(self, path: Line) -> tuple[Conflict, ...]:
        """Every zone the line enters by more than ``TOUCH_M``, hard ones first, deepest first."""
        pieces = pieces_of(path)
        edges, offsets = self._edges
        found = depths(pieces, self._discs, edges, offsets, self._area, self.area is not None)
        names = [
            *((disc.name, disc.hard) for disc in self.discs),
            *((zone.name, zone.hard) for zone in self.polygons),
            (AREA, True),
        ]
        conflicts = [
            Conflict(name, (float(east_m), float(north_m)), float(depth_m), hard)
            for (name, hard), (depth_m, east_m, north_m) in zip(names, found, strict=True)
            if depth_m > TOUCH_M
        ]
        if not any(depth_m > TOUCH_M for depth_m in found[len(self.discs) :, 0]):
            conflicts.extend(self._seam_conflicts(pieces))
        return tuple(sorted(conflicts, key=lambda c: (not c.hard, -c.depth_m, c.zone)))

    def conflict(self, path: Line) -> Conflict | None:
        """The worst of ``conflicts``: the deepest hard one, else the deepest soft one; None when clear."""
        return None if self.clear(path) else next(iter(self.conflicts(path)), None)

    def clear(self, path: Line) -> bool:
        """Whether the line stays in the area and out of every zone, touching them at most."""
        return bool(is_clear(pieces_of(path), self._discs, *self._barriers(), TOUCH_M))

    def _barriers(self) -> tuple[Array, NDArray[np.int64], Array, bool]:
        """Edges, offsets, area edges and whether there is an area, of the polygons and the area as one."""
        if self.area is None:
            return self._barrier, np.array([0, len(self._barrier)], dtype=np.int64), self._area, False
        return np.empty((0, 4)), np.zeros(1, dtype=np.int64), self._barrier, True

    def _seam_conflicts(self, pieces: Array) -> list[Conflict]:
        """The zones between which a line squeezes that enters neither."""
        found = depths(pieces, np.empty((0, 3)), *self._barriers())
        depth_m, east_m, north_m = (float(value) for value in found[int(np.argmax(found[:, 0]))])
        if depth_m <= TOUCH_M:
            return []
        where = shapely.Point(east_m, north_m)
        squeezed = [
            Conflict(zone.name, (east_m, north_m), depth_m, zone.hard)
            for zone in self.polygons
            if zone.polygon.distance(where) <= 4.0 * SEAM_M
        ]
        return squeezed or [Conflict(AREA, (east_m, north_m), depth_m, True)]

    def without(self, names: Collection[str]) -> KeepOut:
        """The same without the zones of these names; ``"area"`` takes the area away."""
        if not names:
            return self
        return replace(
            self,
            discs=tuple(disc for disc in self.discs if disc.name not in names),
            polygons=tuple(zone for zone in self.polygons if zone.name not in names),
            area=None if AREA in names else self.area,
        )


@lru_cache(maxsize=1024)
def _ground(polygons: tuple[Polygon, ...], area: Polygon | MultiPolygon | None) -> Ground:
    solid = _areal(shapely.union_all(polygons))
    shape, inward = (solid, -1.0) if area is None else (_areal(area.difference(solid)), 1.0)
    # Closing what is forbidden is opening what is free.
    closed = shape.buffer(-inward * SEAM_M, join_style="mitre").buffer(inward * SEAM_M, join_style="mitre")
    return Ground(shape, _areal(closed), ring_edges(_areal(closed)), area is not None)


def _areal(geometry: BaseGeometry) -> Polygon | MultiPolygon:
    """The geometry where it is polygons; none where there is nothing."""
    return geometry if isinstance(geometry, Polygon | MultiPolygon) else Polygon()


def ring_edges(area: Polygon | MultiPolygon) -> Array:
    """Edges of all rings, float64 (E, 4): east0, north0, east1, north1."""
    edges: list[Array] = [np.empty((0, 4))]
    for ring in shapely.get_rings(shapely.get_parts(area)):
        points = shapely.get_coordinates(ring)
        edges.append(np.hstack([points[:-1], points[1:]]))
    return np.ascontiguousarray(np.concatenate(edges))


def pieces_of(path: Line) -> Array:
    """The pieces of a line for ``zone_kernels``, float64, shape (S, 8)."""
    rows = np.zeros((len(path.segments), 8))
    for row, segment in zip(rows, path.segments, strict=True):
        pose = segment.start
        row[:5] = (0.0, pose.east_m, pose.north_m, pose.angle_rad, segment.length_m)
        if segment.kind != "straight":
            side = 1.0 if segment.kind == "left" else -1.0
            lever_m = side * segment.radius_m
            row[0], row[5] = side, segment.radius_m
            row[6] = pose.east_m - lever_m * math.sin(pose.angle_rad)
            row[7] = pose.north_m + lever_m * math.cos(pose.angle_rad)
    return rows


def keep_out(
    airspace: Airspace,
    level: Level,
    margin_m: float = 0.0,
    soft: bool = True,
    lowest: Level | None = None,
    edge_m: float | None = None,
) -> KeepOut:
    """What is forbidden at a level, or anywhere from a lower one up to it.

    Parameters
    ----------
    level
        Decides which zones count: those whose heights, clearance included, hold it. Of several levels flown:
        zones that count at all of them.
    margin_m
        Every zone grows by this much, besides the clearance of what is hard.
    soft
        Whether soft threats are among the zones, with ``hard=False``.
    lowest
        The lower level; None for the one level alone.
    edge_m
        The area shrinks by this much; by the margin where not given.
    """
    counted_m = level.counted_m if lowest is None else (lowest.height_m, level.height_m)
    discs: list[Disc] = []
    polygons: list[PolygonZone] = []
    for banded in banded_shapes(airspace, level.amsl_m - level.height_m):
        if not (banded.hard or soft) or not banded.counts(*counted_m):
            continue
        shape, grown_m = banded.shape, banded.kept_m + margin_m
        if isinstance(shape, DiscShape):
            discs.append(Disc(shape.name, *shape.centre, shape.radius_m + grown_m, banded.hard))
        else:
            polygons.extend(_inflated(shape.name, shape.area, grown_m))
    return KeepOut(
        tuple(discs), tuple(polygons), inner_area(airspace.area, margin_m if edge_m is None else edge_m)
    )


def inner_area(area: Polygon | None, margin_m: float) -> Polygon | MultiPolygon | None:
    """What of the operating area is this far from its edge; None without an area."""
    if area is None or margin_m <= 0.0:
        return area
    return _areal(area.buffer(-margin_m, join_style="mitre", mitre_limit=MITRE_LIMIT))


def _inflated(name: str, area: Polygon, margin_m: float) -> list[PolygonZone]:
    grown = area if margin_m <= 0.0 else area.buffer(margin_m, join_style="mitre", mitre_limit=MITRE_LIMIT)
    # A multi-part or emptied result gives one zone a part.
    return [PolygonZone(name, part, True) for part in shapely.get_parts(grown) if not part.is_empty]
