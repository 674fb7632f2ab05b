"""Zones and the operating area as obstacles of the program: discs, convex polygons, a box."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import shapely
from shapely.geometry import Polygon
from shapely.geometry.polygon import orient

from planner.airspace.zones import MITRE_LIMIT, KeepOut
from planner.route import Point
from planner.transit.milp.values import Array, Obstacle, convex, disc

#: A polygon that fills so much of its hull is taken for it.
NEARLY_CONVEX = 0.98

#: Polygons of more corners are held by the lines of a disc's directions, where these leave the ends outside.
MOST_CORNERS = 12

#: An end this far outside is outside.
OUTSIDE_M = 1e-6

Box = tuple[float, float, float, float]


def obstacles_of(
    zones: KeepOut, ends: tuple[Point, Point], margin_m: float, directions: int
) -> tuple[tuple[Obstacle, ...], Box | None]:
    """All zones, and what is outside the area, grown by a margin as far as that leaves both ends outside.

    Returns
    -------
    Obstacles, and the box of the area; None without one.
    """
    found = [
        _disc(each.east_m, each.north_m, each.radius_m, ends, margin_m, directions) for each in zones.discs
    ]
    forbidden = [zone.polygon for zone in zones.polygons]
    box: Box | None = None
    if zones.area is not None:
        west, south, east, north = zones.area.bounds
        box = (west + margin_m, south + margin_m, east - margin_m, north - margin_m)
        # What lies outside the area but in its box, and a little over the edge so that nothing slips between.
        around = shapely.box(west, south, east, north).difference(zones.area)
        forbidden.extend(part for part in shapely.get_parts(around) if isinstance(part, Polygon))
    for polygon in forbidden:
        for part in _convex_parts(_grown(polygon, margin_m, ends)):
            found.append(_polygon(part, ends, directions))
    return tuple(found), box


def _disc(
    east_m: float,
    north_m: float,
    radius_m: float,
    ends: tuple[Point, Point],
    margin_m: float,
    directions: int,
) -> Obstacle:
    whole = disc((east_m, north_m), radius_m + margin_m, directions)
    # The ends may touch the disc, inside the polygon about it: that is drawn nearer then.
    inside_m = float(whole.depths(np.array(ends)).max()) + OUTSIDE_M
    if inside_m <= OUTSIDE_M:
        return whole
    return disc((east_m, north_m), max(OUTSIDE_M, radius_m + margin_m - inside_m), directions)


def _grown(polygon: Polygon, margin_m: float, ends: tuple[Point, Point]) -> Polygon:
    grown = polygon.buffer(margin_m, join_style="mitre", mitre_limit=MITRE_LIMIT)
    fits = isinstance(grown, Polygon) and not grown.intersects(shapely.multipoints(list(ends)))
    return grown if fits else polygon


def _convex_parts(polygon: Polygon) -> Iterator[Polygon]:
    hull = polygon.convex_hull
    if isinstance(hull, Polygon) and polygon.area > NEARLY_CONVEX * hull.area:
        yield hull
        return
    for part in shapely.get_parts(shapely.constrained_delaunay_triangles(polygon)):
        if isinstance(part, Polygon) and part.area > 0.0:
            yield part


def _polygon(part: Polygon, ends: tuple[Point, Point], directions: int) -> Obstacle:
    ring: Array = shapely.get_coordinates(orient(part))[:-1]
    if len(ring) > MOST_CORNERS:
        normals = disc((0.0, 0.0), 1.0, directions).normals
        held = Obstacle(normals, np.einsum("lki,ni->nlk", normals, ring).max(axis=0))
        if (held.depths(np.array(ends)) <= 0.0).all():
            return held
    return convex(ring)
