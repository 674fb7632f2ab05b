"""Longitudes that go on: a line or ring on one sheet of degrees, however it was written.

GeoJSON gives a place beyond the antimeridian a longitude on the other side of the map. RFC 7946 (3.1.9) cuts
what crosses in two; others let longitudes run past 180°, or jump. Here the way from one position to the next
is always the short way round, so that all of them mean the same.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import shapely
from shapely.affinity import translate
from shapely.geometry import MultiPolygon, Polygon

LonLat = tuple[float, float]

#: Longitudes are read up to here: once more round the Earth.
MOST_LONGITUDE_DEG = 360.0


def wrapped_deg(lon_deg: float) -> float:
    """The longitude in [-180, 180]; one that lies there is left as it is."""
    return lon_deg if abs(lon_deg) <= 180.0 else (lon_deg + 180.0) % 360.0 - 180.0


def continued(places: Sequence[LonLat], near_deg: float) -> list[LonLat]:
    """The same places, the first within 180° of a longitude, each within 180° of the one before."""
    lon_deg, out = near_deg, []
    for lon, lat in places:
        lon_deg = lon + 360.0 * round((lon_deg - lon) / 360.0)
        out.append((lon_deg, lat))
    return out


def arc_deg(lons_deg: Sequence[float]) -> tuple[float, float]:
    """West and east end, west in [-180, 180], of the shortest arc that holds all longitudes."""
    around = sorted({-180.0 if abs(lon) == 180.0 else wrapped_deg(lon) for lon in lons_deg})
    gaps = [after - before for before, after in pairwise(around)]
    seam_deg = around[0] + 360.0 - around[-1]
    if not gaps or max(gaps) <= seam_deg:
        return around[0], around[-1]
    first = gaps.index(max(gaps)) + 1
    return around[first], around[first - 1] + 360.0


def goes_round(ring: Sequence[LonLat]) -> bool:
    """Whether a continued, closed ring goes once round a pole."""
    return abs(ring[-1][0] - ring[0][0]) > 180.0


def cut(rings: Sequence[Sequence[LonLat]]) -> list[list[list[LonLat]]]:
    """A polygon (outer ring, holes) as polygons within ±180°, cut at the antimeridian where it crosses."""
    sheets = [continued(ring, ring[0][0]) for ring in rings]
    flat = [lon for ring in sheets for lon, _ in ring]
    if max(flat) <= 180.0 and min(flat) >= -180.0:
        return [sheets]
    outer = _round_the_pole(sheets[0]) if goes_round(sheets[0]) else sheets[0]
    lons = [lon for lon, _ in outer]
    holes = [continued(hole, (min(lons) + max(lons)) / 2.0) for hole in sheets[1:]]
    shape = shapely.make_valid(Polygon(outer, holes))
    pieces = []
    for turn in range(-2, 3):
        band = shapely.box(360.0 * turn - 180.0, -90.0, 360.0 * turn + 180.0, 90.0)
        piece = translate(shape.intersection(band), -360.0 * turn)
        pieces += [part for part in shapely.get_parts(piece) if isinstance(part, Polygon) and part.area > 0.0]
    return [[list(ring.coords) for ring in (part.exterior, *part.interiors)] for part in pieces]


def _round_the_pole(ring: list[LonLat]) -> list[LonLat]:
    """A ring round a pole as one on the sheet, along the pole's edge back to where it began."""
    pole_deg = 90.0 if np.mean([lat for _, lat in ring]) > 0.0 else -90.0
    return [*ring, (ring[-1][0], pole_deg), (ring[0][0], pole_deg), ring[0]]


def joined(polygons: Sequence[Sequence[Sequence[LonLat]]]) -> list[list[list[LonLat]]]:
    """Polygons (outer ring, holes), those that ``cut`` took apart as one again."""
    whole = []
    halves: list[Polygon] = []
    for rings in polygons:
        if all(abs(lon) != 180.0 for ring in rings for lon, _ in ring):
            whole.append([list(ring) for ring in rings])
            continue
        half = Polygon(rings[0], rings[1:])
        halves.append(translate(half, 360.0) if half.bounds[0] == -180.0 else half)
    united = shapely.union_all(halves)
    parts = [part for part in shapely.get_parts(united) if isinstance(part, Polygon)]
    return whole + [[list(ring.coords) for ring in (part.exterior, *part.interiors)] for part in parts]


def multi(shape: Polygon | MultiPolygon) -> tuple[Polygon, ...]:
    """The polygons of a shape."""
    return tuple(shape.geoms) if isinstance(shape, MultiPolygon) else (shape,)
