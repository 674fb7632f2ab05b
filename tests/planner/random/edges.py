"""Random scenarios in which there is hardly more room than one way to fly them takes: each has such a way.

Passes are laid first, each with a whole turning circle to one side of either end; then the area is drawn
close round these, round ways between their circles and round a field at the start, or zones are put all about
them. From circle to circle a line leads within the hull of both (turn, straight, turn): the way is there.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import LineString, MultiPoint, Point, Polygon
from shapely.geometry.base import BaseGeometry

from tests.planner.moved import put_at

Floats = NDArray[np.float64]

PUT = put_at((8.5, 47.0))
#: Room round the way: for what transits keep from edges and for the rounding of places.
ROOM_M, ROOM_PART = 12.0, 0.02
#: What zones keep away besides, more than the autopilot's clearance, and how many are put.
CLEAR_M, ZONES = 35.0, 40
#: Passes see so much more than the region.
MORE_M = 3.0


@dataclass(frozen=True, slots=True)
class _Strip:
    """What passes take: radius, settling run, half an aperture, near and far edge, and the side: 1 left."""

    radius_m: float
    settle_m: float
    half_m: float
    near_m: float
    far_m: float
    side: float

    @property
    def room_m(self) -> float:
        return ROOM_M + ROOM_PART * self.radius_m

    @property
    def swath_m(self) -> float:
        return self.far_m - self.near_m


def scenario(number: int) -> dict[str, Any]:
    """A scenario that can be flown; the same for the same number."""
    rng = np.random.default_rng([991, number])
    radius_m, height_m = round(float(rng.uniform(40.0, 200.0)), 1), round(float(rng.uniform(100.0, 600.0)), 1)
    settle_m = round(float(rng.choice([0.0, rng.uniform(0.3, 3.0) * radius_m])), 1)
    look = str(rng.choice(["left", "right", "both"]))
    middle, high, wide = (round(float(rng.uniform(*pair)), 1) for pair in ((38, 52), (14, 30), (2, 10)))
    half_m = height_m * math.radians(wide) / 2.0 / math.cos(math.radians(middle))
    near_m, far_m = (height_m * math.tan(math.radians(middle + off)) for off in (-high / 2.0, high / 2.0))
    field = Point(0.0, 0.0).buffer(5.0 * radius_m + 2.0 * height_m + 300.0)
    home = Point(0.0, 0.0).buffer(3.0 * radius_m)
    shapes: list[BaseGeometry] = [field]
    features = [_feature("start", "start", "Point", [*PUT(0.0, 0.0), 0.0])]
    for k in range(int(rng.integers(1, 3))):
        side = {"left": 1.0, "right": -1.0, "both": float(rng.choice([-1.0, 1.0]))}[look]
        strip = _Strip(radius_m, settle_m, half_m + MORE_M, near_m, far_m, side)
        region, taken = _seen(rng, strip, field.bounds[2], home)
        shapes += taken
        features.append(_feature(f"R{k}", "roi", "Polygon", _rings(region)))
    kind = str(rng.choice(["convex", "close", "zones"]))
    whole = shapely.union_all(shapes)
    # Holes would be no part of an area, and what is apart no way from one to the other.
    free = whole.convex_hull if kind == "convex" else Polygon(shapely.get_parts(whole)[0].exterior)
    assert free.covers(whole)
    if kind == "zones":
        features += [
            _feature(f"Z{n}", "no_fly", "Polygon", _rings(zone)) for n, zone in enumerate(_zones(rng, free))
        ]
    else:
        features.append(_feature("area", "area", "Polygon", _rings(free)))
    return {
        "type": "FeatureCollection",
        "name": f"edges {number}",
        "seed": number,
        "features": features,
        "vehicles": [
            {
                "name": "uav", "type": "fixed_wing", "airspeed_m_s": 20.0,
                "min_turn_radius_m": radius_m, "settle_m": settle_m,
            }
        ],
        "sensors": [
            {
                "name": "sar", "type": "sar", "incidence_deg": middle, "elevation_beamwidth_deg": high,
                "azimuth_beamwidth_deg": wide, "look": look, "resolution_m": 1.0,
                "pointing_margin_deg": 0.0, "position_margin_m": 0.0,
            }
        ],
        "altitude_m": height_m,
        "altitude_reference": "home",
    }  # fmt: skip


def _seen(
    rng: np.random.Generator, strip: _Strip, far_m: float, home: BaseGeometry
) -> tuple[Polygon, list[BaseGeometry]]:
    """A region that so many passes side by side see, and what flying these takes: passes, circles, ways."""
    passes = int(rng.choice([1, 1, 2, 3]))
    turned, bearing = rng.uniform(0.0, math.tau, 2)
    away_m = far_m * float(rng.uniform(0.5, 3.0))
    middle = away_m * np.array([math.cos(bearing), math.sin(bearing)])
    ahead = np.array([math.cos(turned), math.sin(turned)])
    left = np.array([-ahead[1], ahead[0]])
    wide_m = strip.swath_m - 2.0 * MORE_M
    long_m = float(rng.uniform(0.02, 2.0)) * strip.swath_m
    across_m = (passes - 1.0 + float(rng.uniform(0.2, 0.9))) * wide_m
    spare_m = passes * wide_m - across_m
    # One pass may lie anywhere; of several the outer ones see as much beyond either edge.
    lowest_m = -spare_m * (0.5 if passes > 1 else float(rng.uniform(0.0, 1.0)))
    region = Polygon(
        [middle + x * long_m * ahead + y * across_m * left for x, y in _corners(rng, int(rng.integers(4, 8)))]
    )
    taken: list[BaseGeometry] = []
    before = home
    for k in range(passes):
        way = 1.0 if k % 2 == 0 else -1.0
        low_m = lowest_m + k * wide_m - MORE_M
        # Seen to its left flown onward the strip lies left of the line, flown back right of it.
        aside_m = low_m - strip.near_m if strip.side * way > 0.0 else low_m + strip.far_m
        begin_m, end_m = -strip.half_m, long_m + strip.half_m
        if way < 0.0:
            begin_m, end_m = end_m, begin_m
        begin = middle + (begin_m - way * strip.settle_m) * ahead + aside_m * left
        end = middle + end_m * ahead + aside_m * left
        entry, exit_ = (_circle(rng, strip, place, left) for place in (begin, end))
        line = LineString([begin, end])
        taken += [line.buffer(strip.room_m), _hull(before, entry, strip.room_m), _hull(line, region, 2.0)]
        before = exit_
    taken.append(_hull(before, home, strip.room_m))
    return region, taken


def _circle(rng: np.random.Generator, strip: _Strip, place: Floats, left: Floats) -> BaseGeometry:
    """A whole turn at a place, to one side."""
    radius_m = 1.01 * strip.radius_m
    return Point(place + float(rng.choice([-1.0, 1.0])) * radius_m * left).buffer(radius_m)


def _hull(one: BaseGeometry, other: BaseGeometry, room_m: float) -> BaseGeometry:
    return shapely.union_all([one, other]).convex_hull.buffer(room_m)


def _corners(rng: np.random.Generator, count: int) -> Floats:
    """Corners of a convex polygon as wide and as long as 1."""
    angles_rad = np.sort(rng.uniform(0.0, math.tau, count))
    at = np.stack([np.cos(angles_rad), np.sin(angles_rad)], axis=1)
    at = (at - at.min(axis=0)) / np.ptp(at, axis=0)
    return np.asarray(at, dtype=np.float64)


def _zones(rng: np.random.Generator, free: BaseGeometry) -> Iterator[Polygon]:
    """Polygons that may not be entered, none near the way."""
    west, south, east, north = free.buffer(500.0).bounds
    kept = free.buffer(CLEAR_M)
    for _ in range(ZONES):
        place = rng.uniform((west, south), (east, north))
        around = place + float(rng.uniform(60.0, 300.0)) * (_corners(rng, 6) - 0.5)
        zone = MultiPoint(around).convex_hull
        if not zone.intersects(kept):
            yield zone


def _rings(shape: Polygon) -> list[list[list[float]]]:
    return [[PUT(*place) for place in ring.coords] for ring in (shape.exterior, *shape.interiors)]


def _feature(name: str, role: str, kind: str, coordinates: Any) -> dict[str, Any]:
    return {
        "type": "Feature",
        "id": name,
        "properties": {"role": role},
        "geometry": {"type": kind, "coordinates": coordinates},
    }
