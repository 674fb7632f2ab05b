"""Circles on the Earth as rings, on the safe side of what they mean."""

from __future__ import annotations

import math

from pyproj import Geod

from app.imports.errors import file_error
from app.imports.shapes import LonLat

_CORNERS = 64
_WGS84 = Geod(ellps="WGS84")
#: More is no fence and no zone, but a slip of units.
_MOST_M = 1_000_000.0


def inner_circle(centre: LonLat, radius_m: float) -> tuple[LonLat, ...]:
    """A ring within the circle: for what must not be left."""
    return _ring(centre, radius_m)


def outer_circle(centre: LonLat, radius_m: float) -> tuple[LonLat, ...]:
    """A ring about the circle: for what must not be entered."""
    return _ring(centre, radius_m / math.cos(math.pi / _CORNERS))


def _ring(centre: LonLat, radius_m: float) -> tuple[LonLat, ...]:
    lon, lat = centre
    if not 0.0 < radius_m <= _MOST_M or not abs(lat) <= 90.0 or not abs(lon) <= 360.0:
        raise file_error("circle", f"a circle has the radius {radius_m:g} m", "give a place and metres")
    corners = []
    for index in range(_CORNERS + 1):
        east, north, _ = _WGS84.fwd(lon, lat, 360.0 * (index % _CORNERS) / _CORNERS, radius_m)
        corners.append((float(east), float(north)))
    return tuple(corners)
