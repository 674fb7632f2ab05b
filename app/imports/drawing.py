"""Geometry of shapes: as GeoJSON, and outlines drawn as lines."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import shapely
from pyproj import Proj
from shapely import STRtree, convex_hull, polygonize, remove_repeated_points
from shapely.geometry import LineString, Polygon
from shapely.geometry.polygon import orient
from shapely.ops import unary_union

from app.imports.roles import KINDS
from app.imports.shapes import LonLat, Rings, Shape
from planner.geojson.sheet import MOST_LONGITUDE_DEG, continued, wrapped_deg

#: A ring that crosses itself more often is taken for its convex hull.
_MOST_CROSSINGS = 100
_LONG_RING = 5_000
#: Pieces looked at together: few at first, as each of a scribble's meets most others.
_AT_FIRST, _AT_ONCE = 1, 512


def closed(shape: Shape, role: str) -> Shape:
    """A line that comes back to its start as a polygon, where the role wants one."""
    if shape.kind != "line" or "line" in KINDS[role] or "polygon" not in KINDS[role]:
        return shape
    line = shape.parts[0][0]
    if len(line) < 4 or line[0] != line[-1]:
        return shape
    return replace(shape, kind="polygon")


def forbidden_area(shape: Shape, width_m: float | None) -> Shape | None:
    """What an open line, or a ring of less than three corners, may forbid; None where it encloses nothing.

    As an outline it is closed by a straight edge, as a wall it has the width given: it forbids both.
    Where it crosses itself, its convex hull.
    """
    places = continued(list(shape.parts[0][0]), shape.parts[0][0][0][0])
    if len(set(places)) < 2:
        return None
    if not _crosses_seldom(places):
        hull = convex_hull(LineString(places))
        places = [(x, y) for x, y in hull.exterior.coords] if isinstance(hull, Polygon) else places[:1]
    parts = []
    ring = Polygon(places) if len(set(places)) > 2 else None
    if ring is not None:
        area = ring if ring.is_valid else convex_hull(LineString(places))
        if area.geom_type == "Polygon" and area.area > 0.0:
            parts.append(area)
    if width_m is not None:
        parts.append(_strip(places, width_m))
    if not parts:
        return None
    united = unary_union(parts)
    both = united if isinstance(united, Polygon) else convex_hull(united)
    assert isinstance(both, Polygon)
    rings = tuple(tuple((x, y) for x, y in ring.coords) for ring in (both.exterior, *both.interiors))
    return replace(shape, kind="polygon", parts=(rings,))


def mended(shape: Shape) -> Shape | None:
    """A polygon whose rings cross, as all that it encloses; None where nothing has to be mended.

    Holes that do not lie well within are closed: more is forbidden, never less.
    """
    near_deg = shape.parts[0][0][0][0]
    rings = [continued(ring, near_deg) for ring in shape.parts[0]]
    # Of a long scribble it takes minutes to find that it is none of a polygon.
    few = len(rings[0]) < _LONG_RING or _crosses_seldom(rings[0])
    if few and Polygon(rings[0], rings[1:]).is_valid:
        return None
    outer = Polygon(rings[0])
    if not few or not outer.is_valid:
        ring = LineString([*rings[0], rings[0][0]])
        few = few and _crosses_seldom(rings[0])
        faces = unary_union(list(polygonize([unary_union(ring)]).geoms)) if few else None
        whole = faces if isinstance(faces, Polygon) else convex_hull(ring)
        if not isinstance(whole, Polygon):
            return None
        outer = whole
    return replace(shape, parts=((tuple((x, y) for x, y in outer.exterior.coords),),))


def _crosses_seldom(ring: list[LonLat]) -> bool:
    """Whether a ring has few crossings: all of a scribble's grow with the square of its corners."""
    corners = np.array([*ring, ring[0]])
    pieces = np.asarray(shapely.linestrings(np.stack([corners[:-1], corners[1:]], axis=1)))
    tree = STRtree(pieces)
    found = start = 0
    count = _AT_FIRST
    while start < len(pieces):
        found += len(tree.query(pieces[start : start + count], predicate="crosses")[0])
        if found > 2 * _MOST_CROSSINGS:
            return False
        start, count = start + count, min(2 * count, _AT_ONCE)
    return True


def _strip(places: list[LonLat], width_m: float) -> Polygon:
    lon, lat = places[len(places) // 2]
    local = Proj(proj="aeqd", lat_0=lat, lon_0=lon, ellps="WGS84")
    east, north = local([p[0] for p in places], [p[1] for p in places])
    line = remove_repeated_points(LineString(zip(east, north, strict=True)))
    ring = line.buffer(width_m / 2.0, quad_segs=4, join_style="mitre").exterior
    xs, ys = local(*ring.xy, inverse=True)
    return Polygon(continued(list(zip(xs, ys, strict=True)), places[0][0]))


def on_earth(place: LonLat) -> bool:
    """Whether a place has a latitude and a longitude that mean something."""
    return abs(place[0]) <= MOST_LONGITUDE_DEG and abs(place[1]) <= 90.0


def geometry(shape: Shape) -> dict[str, Any]:
    """Its GeoJSON geometry."""
    if shape.kind == "point":
        return {"type": "Point", "coordinates": _place(shape.parts[0][0][0])}
    if shape.kind == "line":
        return {"type": "LineString", "coordinates": [_place(place) for place in shape.parts[0][0]]}
    polygons = [_rings(part) for part in shape.parts]
    if len(polygons) == 1:
        return {"type": "Polygon", "coordinates": polygons[0]}
    return {"type": "MultiPolygon", "coordinates": polygons}


def _rings(part: Rings) -> list[list[list[float]]]:
    """Closed rings, the outer counter-clockwise and holes clockwise (RFC 7946)."""
    near_deg = part[0][0][0]
    polygon = orient(Polygon(continued(part[0], near_deg), [continued(ring, near_deg) for ring in part[1:]]))
    return [[_place((x, y)) for x, y in ring.coords] for ring in (polygon.exterior, *polygon.interiors)]


def _place(place: LonLat) -> list[float]:
    """Within ±180°; what crosses there jumps to the other side, as the scenario's reader takes it."""
    return [wrapped_deg(float(place[0])), float(place[1])]
