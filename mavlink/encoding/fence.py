"""The plan's fence as items, and as the room that manoeuvres of the mission must keep to."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from shapely.geometry import LineString, Point, Polygon
from shapely.geometry.base import BaseGeometry
from shapely.ops import unary_union

from mavlink.dialects.mission import numbered, placed
from mavlink.dialects.stores import FenceStore
from mavlink.encoding.fit import Piece, fitted, near_notes
from mavlink.encoding.options import EncodeError
from mavlink.wire.geometry import LocalMap, Xy
from mavlink.wire.items import Command, Frame, MissionItem, MissionType
from planner.plan import Fence, FlownPath, LonLat, Plan, ZoneCircle, ZonePolygon


def fence_items(
    plan: Plan, paths: tuple[FlownPath, ...], store: FenceStore | None = None
) -> tuple[tuple[MissionItem, ...], tuple[str, ...]]:
    """The fence of a plan as NAV_FENCE items, and notes on what of it is not as drawn.

    Fences of both autopilots are horizontal. A zone with a floor or a ceiling that the paths fly over or
    under would stop the vehicle in flight, so it is left out, with a note. What does not fit into ``store``
    is made smaller where that is safe: see ``fit``.
    """
    local = LocalMap(plan.home)
    lines = [LineString([local.xy((lon, lat)) for lon, lat, _ in path.line]) for path in paths]
    zones: dict[str, ZonePolygon | ZoneCircle] = {}
    drawn = [Piece.polygon(_key(zones, zone), zone_shape(zone, local), True) for zone in plan.fence.inclusion]
    notes: list[str] = []
    exclusion: tuple[ZonePolygon | ZoneCircle, ...] = plan.fence.exclusion + plan.fence.exclusion_circles
    for zone in exclusion:
        shape = zone_shape(zone, local)
        if _is_flown_over(zone, shape, lines):
            notes.append(_left_out(zone.name))
        elif isinstance(zone, ZoneCircle):
            drawn.append(Piece(_key(zones, zone), shape))
        else:
            drawn.append(Piece.polygon(_key(zones, zone), shape, False))
    pieces, of_size = fitted(drawn, lines, store)
    items = [item for piece in pieces for item in _items(piece, zones[piece.name], local)]
    return numbered(items, MissionType.FENCE), (*notes, *of_size, *near_notes(pieces, lines))


def _items(piece: Piece, zone: ZonePolygon | ZoneCircle, local: LocalMap) -> list[MissionItem]:
    if isinstance(zone, ZoneCircle):
        item = placed(Command.NAV_FENCE_CIRCLE_EXCLUSION, zone.centre, 0.0, Frame.GLOBAL)
        return [replace(item, param1=_radius_m(zone))]
    if piece.radius_m is not None:
        middle = piece.shape.centroid
        centre = local.lonlat((middle.x, middle.y))
        item = placed(Command.NAV_FENCE_CIRCLE_EXCLUSION, centre, 0.0, Frame.GLOBAL)
        return [replace(item, param1=piece.radius_m)]
    command = (
        Command.NAV_FENCE_POLYGON_VERTEX_INCLUSION
        if piece.inside
        else Command.NAV_FENCE_POLYGON_VERTEX_EXCLUSION
    )
    if piece.thinned_m == 0.0:
        return _polygon(command, zone)
    ring = tuple(local.lonlat((x, y)) for x, y in piece.shape.exterior.coords[:-1])
    return _polygon(command, replace(zone, ring=ring))


def _key(zones: dict[str, ZonePolygon | ZoneCircle], zone: ZonePolygon | ZoneCircle) -> str:
    """A name for a zone that no other has, kept for it."""
    name = zone.name
    while name in zones:
        name += "'"
    zones[name] = zone
    return name


def _radius_m(circle: ZoneCircle) -> float:
    # A NaN here would stop ArduPilot's simulator altogether.
    if not 0.0 < circle.radius_m < math.inf:
        raise EncodeError(f"fence circle {circle.name!r} has radius {circle.radius_m}")
    return circle.radius_m


def _corners(zone: ZonePolygon) -> tuple[LonLat, ...]:
    """Corners of a ring, a last one that repeats the first left out."""
    ring = zone.ring
    corners = ring[:-1] if len(ring) > 1 and ring[0] == ring[-1] else ring
    if len(corners) < 3:
        raise EncodeError(f"fence polygon {zone.name!r} has {len(corners)} corners")
    return corners


def _polygon(command: int, zone: ZonePolygon) -> list[MissionItem]:
    corners = _corners(zone)
    count = float(len(corners))
    return [replace(placed(command, corner, 0.0, Frame.GLOBAL), param1=count) for corner in corners]


def _is_flown_over(zone: ZonePolygon | ZoneCircle, shape: BaseGeometry, lines: list[LineString]) -> bool:
    if zone.floor_m is None and zone.ceiling_m is None:
        return False
    return any(shape.intersects(line) for line in lines)


def _left_out(name: str) -> str:
    return f"fence: zone {name!r} is passed above or below, and fences have no heights: left out"


def zone_shape(zone: ZonePolygon | ZoneCircle, local: LocalMap) -> Polygon:
    """A zone in local metres."""
    if isinstance(zone, ZoneCircle):
        return Point(local.xy(zone.centre)).buffer(_radius_m(zone), quad_segs=32)
    return Polygon([local.xy(corner) for corner in _corners(zone)])


@dataclass(frozen=True, slots=True)
class Room:
    """Where the vehicle may be, in local metres: in ``allowed`` (anywhere when None), not in ``barred``."""

    allowed: BaseGeometry | None
    barred: BaseGeometry

    def outside_m2(self, shape: BaseGeometry) -> float:
        """Area of a shape that lies where the vehicle may not be."""
        outside = 0.0 if self.allowed is None else float(shape.difference(self.allowed).area)
        return outside + float(shape.intersection(self.barred).area)

    def line_outside_m2(self, line: list[Xy], margin_m: float) -> float:
        """The same for a line and the margin round it."""
        return self.outside_m2(LineString(line).buffer(margin_m))

    def orbit_outside_m2(self, centre: Xy, radius_m: float, margin_m: float) -> float:
        """The same for a circle flown round a centre, its inside included: wind pushes inwards too."""
        return self.outside_m2(Point(centre).buffer(radius_m + margin_m))


def room_of(fence: Fence, local: LocalMap) -> Room:
    """The room that a plan's fence leaves, zones with floor or ceiling taken as barred at all heights."""
    inside = [zone_shape(zone, local) for zone in fence.inclusion]
    barred = [zone_shape(zone, local) for zone in fence.exclusion]
    barred += [zone_shape(circle, local) for circle in fence.exclusion_circles]
    return Room(unary_union(inside) if inside else None, unary_union(barred))
