"""What may never be entered at the flight altitude, as plain shapes: for the edge and for the judge."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from shapely import get_parts
from shapely.geometry import LineString, Point, Polygon, box
from shapely.geometry.base import BaseGeometry

from planner.airspace import growth
from planner.airspace.airspace import Airspace, Level
from planner.airspace.values import NoFlyZone, Threat

#: Of a quarter of a circle: its chords leave it by less than 0.01 % of the radius.
ROUND_SEGMENTS = 64
#: Rounding of heights; zones begin and end so much lower and higher.
HEIGHT_M = 1e-6


@dataclass(frozen=True, slots=True)
class DiscShape:
    """A disc, exact: east and north of its centre and its radius in metres."""

    name: str
    centre: tuple[float, float]
    radius_m: float

    def depth_m(self, shape: BaseGeometry) -> float:
        """How far a shape reaches inside; 0 or less where it does not."""
        return self.radius_m - float(shape.distance(Point(self.centre)))

    def away_m(self, shape: BaseGeometry) -> float:
        """How far a shape is from it; 0 or less where it reaches inside."""
        return -self.depth_m(shape)

    def grown(self, by_m: float) -> DiscShape:
        """The disc with a margin round it."""
        return DiscShape(self.name, self.centre, self.radius_m + by_m)

    def polygon(self) -> Polygon:
        """A polygon round the disc, at most 0.01 % wider."""
        return Point(self.centre).buffer(self.radius_m * 1.0001, quad_segs=ROUND_SEGMENTS)


@dataclass(frozen=True, slots=True)
class PolygonShape:
    """A polygon."""

    name: str
    area: Polygon

    def depth_m(self, shape: BaseGeometry) -> float:
        """How far a shape reaches inside, measured from the boundary; 0 where it does not."""
        inside = shape.intersection(self.area)
        return 0.0 if inside.is_empty else _depth(inside, self.area)

    def away_m(self, shape: BaseGeometry) -> float:
        """How far a shape is from it; 0 where it reaches inside."""
        return float(self.area.distance(shape))

    def grown(self, by_m: float) -> PolygonShape:
        """The polygon with a margin round it, at most 0.01 % wider at its corners; 1 % of many."""
        if by_m <= 0.0:
            return self
        whole = growth.grown(self.area, by_m * 1.0001, ROUND_SEGMENTS)
        assert isinstance(whole, Polygon)  # one part stays one
        return PolygonShape(self.name, whole)

    def polygon(self) -> Polygon:
        """The polygon itself."""
        return self.area


def _depth(inside: BaseGeometry, area: Polygon) -> float:
    """Largest distance to the boundary among the places, and the quarters of the lines, inside."""
    depth_m = 0.0
    for part in getattr(inside, "geoms", [inside]):
        places = (
            [part.interpolate(fraction, normalized=True) for fraction in (0.25, 0.5, 0.75)]
            if isinstance(part, LineString)
            else [part]
        )
        depth_m = max(depth_m, *(float(area.boundary.distance(place)) for place in places))
    return depth_m


@dataclass(frozen=True, slots=True)
class Banded:
    """A shape that counts between two heights over home; at all heights where these are not known.

    ``kept_m`` is to be kept from it beside, over and under it; shape and heights are without.
    """

    shape: DiscShape | PolygonShape
    hard: bool
    low_m: float = -math.inf
    high_m: float = math.inf
    kept_m: float = 0.0

    def counts(self, from_m: float, to_m: float) -> bool:
        """Whether it counts above ``from_m`` and below ``to_m``, what is kept over and under it included.

        Where the one is above the other: at all heights between them.
        """
        low_m, high_m = self.low_m - self.kept_m, self.high_m + self.kept_m
        return low_m <= to_m + HEIGHT_M and from_m <= high_m + HEIGHT_M


def banded_shapes(airspace: Airspace, home_amsl_m: float | None) -> Iterator[Banded]:
    """Threats, no-fly zones and obstacles with the heights between which they count."""
    kept_m = airspace.clearance_m
    for threat in airspace.threats:
        shape = DiscShape(threat.name, threat.centre, threat.radius_m)
        yield Banded(shape, threat.hard, high_m=threat.height_m, kept_m=kept_m if threat.hard else 0.0)
    for zone in airspace.no_fly:
        low_m, high_m = -math.inf, math.inf
        if home_amsl_m is not None:
            low_m, high_m = zone.floor_m - home_amsl_m, zone.ceiling_m - home_amsl_m
        yield Banded(_of_zone(zone), True, low_m, high_m, 0.0 if zone.of_ground else kept_m)
    for obstacle in airspace.obstacles:
        top_m = obstacle.base_m + obstacle.height_m
        yield Banded(PolygonShape(obstacle.name, obstacle.area), True, high_m=top_m, kept_m=kept_m)


def _of_zone(zone: NoFlyZone) -> DiscShape | PolygonShape:
    if zone.centre is not None and zone.radius_m is not None:
        return DiscShape(zone.name, zone.centre, zone.radius_m)
    return PolygonShape(zone.name, Polygon() if zone.area is None else zone.area)


def hard_shapes(airspace: Airspace, level: Level) -> Iterator[DiscShape | PolygonShape]:
    """Hard threats, no-fly zones and obstacles that reach a level, clearance included.

    Of several levels flown: those that count at all of them. What counts at some is kept clear leg by leg.
    """
    for banded in banded_shapes(airspace, level.amsl_m - level.height_m):
        if banded.hard and banded.counts(*level.counted_m):
            yield banded.shape.grown(banded.kept_m)


def soft_shapes(airspace: Airspace, level: Level) -> Iterator[DiscShape]:
    """Threats that cost and do not forbid, at a level."""
    for threat in airspace.threats:
        if not threat.hard and acts(threat, level.height_m - level.spread_m):
            yield DiscShape(threat.name, threat.centre, threat.radius_m)


def acts(threat: Threat, height_m: float) -> bool:
    """Whether a threat reaches up to a height: its disc is a cylinder capped at ``height_m``."""
    return height_m <= threat.height_m


def without_holes(polygon: Polygon) -> list[Polygon]:
    """A polygon cut through its holes: a fence knows outer rings alone."""
    if not polygon.interiors:
        return [polygon]
    west, south, east, north = polygon.bounds
    cut_m = polygon.interiors[0].centroid.x
    halves = (box(west, south, cut_m, north), box(cut_m, south, east, north))
    parts = [part for half in halves for part in get_parts(polygon.intersection(half))]
    return [
        piece
        for part in parts
        if isinstance(part, Polygon) and part.area > 0.0
        for piece in without_holes(part)
    ]
