"""Places round the home position in metres, for the geometry that only a mission needs.

A transverse Mercator projection with scale 1 at its origin: conformal, so circles stay circles and right
angles right; at 20 km from the origin's meridian lengths are off by 5 parts in a million.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

from pyproj import Geod, Transformer

from planner.plan import LonLat

Xy = tuple[float, float]

_WGS84 = Geod(ellps="WGS84")


def distance_m(a: LonLat, b: LonLat) -> float:
    """Length of the geodesic between two places (longitude, latitude in degrees)."""
    return float(_WGS84.inv(a[0], a[1], b[0], b[1])[2])


def course_deg(a: LonLat, b: LonLat) -> float:
    """Direction from one place to another, clockwise from true north."""
    return float(_WGS84.inv(a[0], a[1], b[0], b[1])[0])


def here(place: LonLat) -> LonLat:
    """A place of a line that may go on beyond ±180°, with its longitude within."""
    lon_deg, lat_deg = place
    return (lon_deg if abs(lon_deg) <= 180.0 else (lon_deg + 180.0) % 360.0 - 180.0), lat_deg


@lru_cache(maxsize=32)
def _transformers(lon_deg: float, lat_deg: float) -> tuple[Transformer, Transformer]:
    local = f"+proj=tmerc +lat_0={lat_deg!r} +lon_0={lon_deg!r} +k_0=1 +ellps=WGS84 +units=m +no_defs"
    geographic = "+proj=longlat +ellps=WGS84 +no_defs"
    return (
        Transformer.from_crs(geographic, local, always_xy=True),
        Transformer.from_crs(local, geographic, always_xy=True),
    )


@dataclass(frozen=True, slots=True)
class LocalMap:
    """Metres east and north of an origin given as longitude, latitude in degrees."""

    origin: LonLat

    def xy(self, place: LonLat) -> Xy:
        """East and north in metres."""
        east_m, north_m = _transformers(*self.origin)[0].transform(place[0], place[1], errcheck=True)
        return float(east_m), float(north_m)

    def lonlat(self, xy: Xy) -> LonLat:
        """Longitude and latitude in degrees."""
        lon_deg, lat_deg = _transformers(*self.origin)[1].transform(xy[0], xy[1], errcheck=True)
        return float(lon_deg), float(lat_deg)


def offset(start: Xy, angle_rad: float, ahead_m: float, left_m: float = 0.0) -> Xy:
    """The place ahead and to the left of one that looks along an angle (counter-clockwise from east)."""
    cos, sin = math.cos(angle_rad), math.sin(angle_rad)
    return start[0] + ahead_m * cos - left_m * sin, start[1] + ahead_m * sin + left_m * cos


def arc_points(start: Xy, end: Xy, centre: Xy, turn_rad: float, max_step_rad: float) -> list[Xy]:
    """Points on an arc between its ends, both ends left out.

    Parameters
    ----------
    turn_rad
        Angle turned, positive counter-clockwise, of any size.
    max_step_rad
        Largest angle between neighbours.

    Notes
    -----
    The radius runs evenly from that of the start to that of the end, so that ends rounded elsewhere are met.
    """
    pieces = max(1, math.ceil(abs(turn_rad) / max_step_rad - 1e-9))
    radius_start_m = math.dist(start, centre)
    radius_end_m = math.dist(end, centre)
    angle_rad = math.atan2(start[1] - centre[1], start[0] - centre[0])
    points: list[Xy] = []
    for piece in range(1, pieces):
        part = piece / pieces
        radius_m = radius_start_m + part * (radius_end_m - radius_start_m)
        points.append(offset(centre, angle_rad + part * turn_rad, radius_m))
    return points


def chord_step_rad(radius_m: float, sagitta_m: float, largest_rad: float) -> float:
    """Angle of the chord whose sagitta is r (1 − cos(θ/2)), and no more than the largest wanted."""
    if sagitta_m >= radius_m:
        return largest_rad
    return min(largest_rad, 2.0 * math.acos(1.0 - sagitta_m / radius_m))
