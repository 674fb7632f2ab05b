"""What may never be entered at the flight altitude, as plain shapes: for the edge and for the judge."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from shapely.geometry import LineString, Point, Polygon
from shapely.geometry.base import BaseGeometry

from planner.airspace.airspace import Airspace, Level
from planner.airspace.values import Threat


@dataclass(frozen=True, slots=True)
class DiscShape:
    """A disc, exact: east and north of its centre and its radius in metres."""

    name: str
    centre: tuple[float, float]
    radius_m: float

    def depth_m(self, shape: BaseGeometry) -> float:
        """How far a shape reaches inside; 0 or less where it does not."""
        return self.radius_m - float(shape.distance(Point(self.centre)))

    def polygon(self) -> Polygon:
        """A polygon round the disc, at most 0.01 % wider."""
        segments = 64
        return Point(self.centre).buffer(self.radius_m * 1.0001, quad_segs=segments)


@dataclass(frozen=True, slots=True)
class PolygonShape:
    """A polygon."""

    name: str
    area: Polygon

    def depth_m(self, shape: BaseGeometry) -> float:
        """How far a shape reaches inside, measured from the boundary; 0 where it does not."""
        inside = shape.intersection(self.area)
        return 0.0 if inside.is_empty else _depth(inside, self.area)

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
    """A shape that counts between two heights over home; at all heights where these are not known."""

    shape: DiscShape | PolygonShape
    hard: bool
    low_m: float = -math.inf
    high_m: float = math.inf


def banded_shapes(airspace: Airspace, home_amsl_m: float | None) -> Iterator[Banded]:
    """Threats, no-fly zones and obstacles with the heights between which they count, clearance included."""
    for threat in airspace.threats:
        yield Banded(
            DiscShape(threat.name, threat.centre, threat.radius_m), threat.hard, high_m=threat.height_m
        )
    for zone in airspace.no_fly:
        low_m, high_m = -math.inf, math.inf
        if home_amsl_m is not None:
            low_m, high_m = zone.floor_m - home_amsl_m, zone.ceiling_m - home_amsl_m
        if zone.area is not None:
            yield Banded(PolygonShape(zone.name, zone.area), True, low_m, high_m)
        elif zone.centre is not None and zone.radius_m is not None:
            yield Banded(DiscShape(zone.name, zone.centre, zone.radius_m), True, low_m, high_m)
    for obstacle in airspace.obstacles:
        shape = PolygonShape(obstacle.name, obstacle.area.buffer(airspace.clearance_m))
        top_m = obstacle.base_m + obstacle.height_m + airspace.clearance_m
        yield Banded(shape, True, high_m=top_m)


def hard_shapes(airspace: Airspace, level: Level) -> Iterator[DiscShape | PolygonShape]:
    """Hard threats, no-fly zones and obstacles that reach a level, clearance included.

    Of several levels flown: those that count at all of them. What counts at some is kept clear leg by leg.
    """
    for threat in airspace.threats:
        if threat.hard and acts(threat, level.height_m):
            yield DiscShape(threat.name, threat.centre, threat.radius_m)
    for zone in airspace.no_fly:
        if zone.floor_m <= level.lowest.amsl_m and level.amsl_m <= zone.ceiling_m:
            if zone.area is not None:
                yield PolygonShape(zone.name, zone.area)
            elif zone.centre is not None and zone.radius_m is not None:
                yield DiscShape(zone.name, zone.centre, zone.radius_m)
    for obstacle in airspace.obstacles:
        if obstacle.base_m + obstacle.height_m + airspace.clearance_m >= level.height_m:
            yield PolygonShape(obstacle.name, obstacle.area.buffer(airspace.clearance_m))


def soft_shapes(airspace: Airspace, level: Level) -> Iterator[DiscShape]:
    """Threats that cost and do not forbid, at a level."""
    for threat in airspace.threats:
        if not threat.hard and acts(threat, level.height_m):
            yield DiscShape(threat.name, threat.centre, threat.radius_m)


def acts(threat: Threat, height_m: float) -> bool:
    """Whether a threat reaches up to a height: its disc is a cylinder capped at ``height_m``."""
    return height_m <= threat.height_m
