"""Scenarios drawn in metres and put anywhere on Earth along geodesics, for laws about places."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

from pyproj import Geod

from tests.planner.scenarios import feature, small

GEOD = Geod(ellps="WGS84")

Place = tuple[float, float]
#: Metres east and north of the origin to longitude and latitude.
Put = Callable[[float, float], list[float]]

#: An ordinary place, and those where longitudes jump, converge or are nought.
#: The last has the pole amid its things: there edges in degrees are no straight lines.
PLACES: tuple[Place, ...] = (
    (8.5, 47.0), (179.99, 10.0), (-179.99, -40.0), (0.0, 0.0), (25.0, 89.0), (-120.0, -89.0), (0.0, 89.99),
)  # fmt: skip


def put_at(origin: Place) -> Put:
    """Places by distance and azimuth from an origin, as pyproj's geodesics have it."""

    def put(east_m: float, north_m: float) -> list[float]:
        azimuth_deg = math.degrees(math.atan2(east_m, north_m))
        lon, lat, _ = GEOD.fwd(*origin, azimuth_deg, math.hypot(east_m, north_m))
        return [lon, lat]

    return put


def ring(put: Put, corners_m: Sequence[Place], step_m: float = 200.0) -> list[list[list[float]]]:
    """A polygon's coordinates; its edges are cut, for edges in degrees are no geodesics near a pole."""
    places = []
    for (e0, n0), (e1, n1) in zip(corners_m, [*corners_m[1:], corners_m[0]], strict=True):
        count = max(1, math.ceil(math.hypot(e1 - e0, n1 - n0) / step_m))
        places += [put(e0 + (e1 - e0) * k / count, n0 + (n1 - n0) * k / count) for k in range(count)]
    return [[*places, places[0]]]


def box(put: Put, west: float, south: float, east: float, north: float) -> list[list[list[float]]]:
    """A box in metres."""
    return ring(put, [(west, south), (east, south), (east, north), (west, north)])


def everything(origin: Place) -> dict[str, Any]:
    """Two regions, a corridor, a target, an area, a zone, an obstacle and threats round an origin."""
    put = put_at(origin)
    return small(
        features=[
            feature("A", "roi", "Polygon", box(put, -1300, -150, -700, 150)),
            feature("B", "roi", "Polygon", box(put, 900, 600, 1500, 1000)),
            feature("C", "roi", "LineString", [put(-800, -1500), put(600, -1700)], width_m=150.0),
            feature("D", "roi", "Point", put(200, 1700), radius_m=60.0),
            feature("area", "area", "Polygon", box(put, -4000, -4000, 4000, 4000)),
            feature("N", "no_fly", "Polygon", box(put, -200, -600, 300, 500)),
            feature("O", "obstacle", "Polygon", box(put, 2200, 0, 2400, 200), height_m=900.0),
            feature("T", "threat", "Point", put(-1700, 1500), model="missile", radius_m=500.0, hard=True),
            feature("R", "threat", "Point", put(2500, -1500), model="radar", radius_m=600, intensity_m=300),
            feature("start", "start", "Point", put(-2500, 0)),
            feature("end", "end", "Point", put(2600, 100)),
        ]
    )
