"""Small steps and short distances on the WGS 84 ellipsoid, good enough to fly by.

The simulated aircraft has its own geodesy so that an error in the planner's projection shows as a track that
is not where it was meant. Source: radii of curvature of the WGS 84 ellipsoid (NGA.STND.0036, a = 6378137 m,
1/f = 298.257223563).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

_A_M = 6_378_137.0
_F = 1.0 / 298.257_223_563
_E2 = _F * (2.0 - _F)
#: Beyond this latitude the meridians converge too fast for the second order.
_STEEP_DEG = 60.0
#: Nearer to a pole, within 11 km, headings turn too fast to be flown by.
MOST_LATITUDE_DEG = 89.9


@dataclass(frozen=True, slots=True)
class Place:
    """A place on WGS 84; the altitude is in metres above mean sea level."""

    lat_deg: float
    lon_deg: float
    altitude_m: float


def radii_m(lat_deg: float) -> tuple[float, float]:
    """Radii of curvature in the meridian (M) and the prime vertical (N) at a latitude, metres."""
    sine = math.sin(math.radians(lat_deg))
    w2 = 1.0 - _E2 * sine * sine
    normal_m = _A_M / math.sqrt(w2)
    return normal_m * (1.0 - _E2) / w2, normal_m


def offset_m(lat_deg: float, lon_deg: float, to_lat_deg: float, to_lon_deg: float) -> tuple[float, float]:
    """North and east metres from one place to another in the first place's tangent plane.

    Second order in the distance: the meridians' convergence is in it, so that a straight line of the plane is
    a geodesic to within 0.1 m over 15 km; nearer to the poles the chord through the Earth is taken instead.
    """
    if abs(lat_deg) > _STEEP_DEG:
        return _chord_m(lat_deg, lon_deg, to_lat_deg, to_lon_deg)
    meridian_m, normal_m = radii_m(lat_deg)
    d_lat = math.radians(to_lat_deg - lat_deg)
    d_lon = math.radians((to_lon_deg - lon_deg + 180.0) % 360.0 - 180.0)
    to_lat = math.radians(to_lat_deg)
    east_m = normal_m * math.cos(to_lat) * d_lon
    north_m = meridian_m * d_lat + 0.5 * east_m * d_lon * math.sin(math.radians(lat_deg))
    return north_m, east_m


def _chord_m(lat_deg: float, lon_deg: float, to_lat_deg: float, to_lon_deg: float) -> tuple[float, float]:
    """North and east of the straight chord between two places, with its length."""
    lat, d_lon = math.radians(lat_deg), math.radians(to_lon_deg - lon_deg)
    x_m, _, z_m = _earth_m(lat, 0.0)
    to_x_m, to_y_m, to_z_m = _earth_m(math.radians(to_lat_deg), d_lon)
    dx_m, dz_m = to_x_m - x_m, to_z_m - z_m
    north_m = dz_m * math.cos(lat) - dx_m * math.sin(lat)
    level_m = math.hypot(north_m, to_y_m)
    scale = math.hypot(dx_m, to_y_m, dz_m) / level_m if level_m > 0.0 else 1.0
    return north_m * scale, to_y_m * scale


def _earth_m(lat_rad: float, lon_rad: float) -> tuple[float, float, float]:
    """A place of the ellipsoid in metres from the Earth's centre; the third axis is the Earth's own."""
    normal_m = _A_M / math.sqrt(1.0 - _E2 * math.sin(lat_rad) ** 2)
    across_m = normal_m * math.cos(lat_rad)
    return (
        across_m * math.cos(lon_rad),
        across_m * math.sin(lon_rad),
        normal_m * (1.0 - _E2) * math.sin(lat_rad),
    )


def moved(lat_deg: float, lon_deg: float, north_m: float, east_m: float) -> tuple[float, float]:
    """Latitude and longitude after a small step; accurate while the step is metres, not kilometres."""
    if abs(lat_deg) > _STEEP_DEG:
        return _moved_by_chord(lat_deg, lon_deg, north_m, east_m)
    meridian_m, normal_m = radii_m(lat_deg)
    new_lat_deg = lat_deg + math.degrees(north_m / meridian_m)
    middle_rad = math.radians(0.5 * (lat_deg + new_lat_deg))
    new_lon_deg = lon_deg + math.degrees(east_m / (normal_m * math.cos(middle_rad)))
    return new_lat_deg, (new_lon_deg + 180.0) % 360.0 - 180.0


def _moved_by_chord(lat_deg: float, lon_deg: float, north_m: float, east_m: float) -> tuple[float, float]:
    lat = math.radians(lat_deg)
    x_m, _, z_m = _earth_m(lat, 0.0)
    x_m -= north_m * math.sin(lat)
    z_m += north_m * math.cos(lat)
    new_lat_deg = math.degrees(math.atan2(z_m, math.hypot(x_m, east_m) * (1.0 - _E2)))
    new_lon_deg = lon_deg + math.degrees(math.atan2(east_m, x_m))
    return new_lat_deg, (new_lon_deg + 180.0) % 360.0 - 180.0


def distance_m(a: Place, b: Place) -> float:
    """Horizontal distance of two places a few kilometres apart."""
    return math.hypot(*offset_m(a.lat_deg, a.lon_deg, b.lat_deg, b.lon_deg))


def wrap_rad(angle_rad: float) -> float:
    """The same angle in (-pi, pi]."""
    return math.pi - (math.pi - angle_rad) % (2.0 * math.pi)
