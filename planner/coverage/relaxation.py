"""What would make a region seen that no pass may see: which hard zone is in the way, and by how much.

A zone is in the way when the region could be seen without it. Then it is made smaller, or moved straight away
from the region, by as little as lets some pass through, found by halving; heights past it are tried, too.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

from shapely.affinity import translate
from shapely.geometry import Polygon

from planner.airspace.airspace import Airspace, Level
from planner.airspace.shapes import DiscShape, hard_shapes
from planner.coverage.merge import MergedRegion
from planner.errors import InfeasibleError
from planner.wishes import HIGHEST_M

#: Whether some pass sees the region among these zones, from this level.
Seen = Callable[[Airspace, Level], bool]

#: Found to a metre, among the zones nearest to the region.
STEP_M = 1.0
MOST_ZONES = 4
#: Over a ceiling, or under a floor, by this much.
CLEAR_M = 1.0


def explained(
    airspace: Airspace, level: Level, region: MergedRegion, refused: InfeasibleError, seen: Seen
) -> InfeasibleError:
    """The refusal of a region by the zones in the way; the same refusal where none is."""
    hard = hard_shapes(airspace, level)
    shapes = sorted(hard, key=lambda shape: -shape.depth_m(region.area))
    names = list(dict.fromkeys(shape.name for shape in shapes))
    if not names or not seen(_without(airspace, names), level):
        return refused
    alone = [name for name in names[: 2 * MOST_ZONES] if seen(_without(airspace, [name]), level)][:MOST_ZONES]
    if not alone:
        which = ", ".join(names[:-1]) + f" and {names[-1]}" if len(names) > 1 else names[0]
        return InfeasibleError(
            "hard-zone",
            region.label,
            f"every pass that sees it enters one of the hard zones {which}, none of which is to blame alone",
            "shrink or move several of them, or allow the other look side",
            region.centroid,
        )
    ways = sorted((_ways(airspace, level, region, name, seen) for name in alone), key=lambda way: way[0])
    ways = _keeping_less(airspace, level, seen) + ways
    return InfeasibleError(
        "hard-zone",
        region.label,
        f"every pass that sees it enters hard zone {alone[0]}"
        if len(alone) == 1
        else f"every pass that sees it enters one of the hard zones {', '.join(alone)}",
        "; or ".join(text for _, text in ways),
        region.centroid,
    )


def _keeping_less(airspace: Airspace, level: Level, seen: Seen) -> list[tuple[float, str]]:
    """The most that may be kept from everything hard, where keeping less is enough."""
    kept_m = airspace.clearance_m
    if kept_m < STEP_M:
        return []
    less_m = _least(kept_m, lambda by_m: seen(replace(airspace, clearance_m=max(kept_m - by_m, 0.0)), level))
    if not math.isfinite(less_m):
        return []
    return [(less_m, f"set clearance_m to {max(kept_m - less_m, 0.0):g} instead of {kept_m:g}")]


def _ways(airspace: Airspace, level: Level, region: MergedRegion, name: str, seen: Seen) -> tuple[float, str]:
    """What to do about one zone: how far its edge must go at least, and all ways in words."""
    shape = next(shape for shape in hard_shapes(airspace, level) if shape.name == name)
    middle = shape.centre if isinstance(shape, DiscShape) else shape.area.centroid.coords[0]
    size_m = shape.radius_m if isinstance(shape, DiscShape) else math.sqrt(shape.area.area)
    shrunk_m = _least(size_m, lambda by_m: seen(shrunk(airspace, name, by_m), level))
    away = middle[0] - region.centroid[0], middle[1] - region.centroid[1]
    far_m = math.hypot(*away)
    unit = (away[0] / far_m, away[1] / far_m) if far_m > 1.0 else (1.0, 0.0)
    moved_m = _least(
        4.0 * size_m + far_m, lambda by_m: seen(moved(airspace, name, by_m * unit[0], by_m * unit[1]), level)
    )
    texts = []
    if math.isfinite(shrunk_m):
        texts.append(f"draw the edge of {name} in by {shrunk_m:.0f} m")
    if math.isfinite(moved_m):
        texts.append(f"move {name} {moved_m:.0f} m {_compass(unit)}")
    texts += [
        f"fly at {altitude_m:.0f} m"
        for altitude_m in _altitudes(airspace, level, name)
        if seen(airspace, level.at(altitude_m))
    ]
    if any(threat.name == name for threat in airspace.threats):
        texts.append(f"set hard: false for {name}")
    return min(shrunk_m, moved_m), ", or ".join(texts) or f"remove {name}"


def _least(most_m: float, works: Callable[[float], bool]) -> float:
    """The least distance, to a metre, that works; inf where the most does not."""
    low, high = 0.0, math.ceil(most_m)
    if not works(high):
        return math.inf
    while high - low > STEP_M:
        middle = math.floor((low + high) / 2.0)
        if works(middle):
            high = middle
        else:
            low = middle
    return float(high)


def shrunk(airspace: Airspace, name: str, by_m: float) -> Airspace:
    """The airspace with a zone's edge drawn in."""

    def smaller(area: Polygon) -> Polygon:
        left = area.buffer(-by_m, join_style="mitre")
        parts = sorted(getattr(left, "geoms", [left]), key=lambda part: -part.area)
        return parts[0] if parts else Polygon()

    return _changed(airspace, name, smaller, lambda centre, radius_m: (centre, radius_m - by_m))


def moved(airspace: Airspace, name: str, east_m: float, north_m: float) -> Airspace:
    """The airspace with a zone elsewhere."""
    return _changed(
        airspace,
        name,
        lambda area: translate(area, east_m, north_m),
        lambda centre, radius_m: ((centre[0] + east_m, centre[1] + north_m), radius_m),
    )


def _without(airspace: Airspace, names: list[str]) -> Airspace:
    return replace(
        airspace,
        threats=tuple(threat for threat in airspace.threats if not (threat.hard and threat.name in names)),
        no_fly=tuple(zone for zone in airspace.no_fly if zone.name not in names),
        obstacles=tuple(obstacle for obstacle in airspace.obstacles if obstacle.name not in names),
    )


def _changed(
    airspace: Airspace,
    name: str,
    area_as: Callable[[Polygon], Polygon],
    disc_as: Callable[[tuple[float, float], float], tuple[tuple[float, float], float]],
) -> Airspace:
    """The airspace with one zone's shape changed; a zone of which nothing is left goes."""
    threats, zones, obstacles = [], [], []
    for threat in airspace.threats:
        if threat.name == name:
            centre, radius_m = disc_as(threat.centre, threat.radius_m)
            if radius_m <= 0.0:
                continue
            threat = replace(threat, centre=centre, radius_m=radius_m)
        threats.append(threat)
    for zone in airspace.no_fly:
        if zone.name == name and zone.area is not None:
            area = area_as(zone.area)
            if area.is_empty:
                continue
            zone = replace(zone, area=area)
        elif zone.name == name and zone.centre is not None and zone.radius_m is not None:
            centre, radius_m = disc_as(zone.centre, zone.radius_m)
            if radius_m <= 0.0:
                continue
            zone = replace(zone, centre=centre, radius_m=radius_m)
        zones.append(zone)
    for obstacle in airspace.obstacles:
        if obstacle.name == name:
            area = area_as(obstacle.area)
            if area.is_empty:
                continue
            obstacle = replace(obstacle, area=area)
        obstacles.append(obstacle)
    return replace(airspace, threats=tuple(threats), no_fly=tuple(zones), obstacles=tuple(obstacles))


def _altitudes(airspace: Airspace, level: Level, name: str) -> list[float]:
    """Altitudes over the level's own reference, just over or under a zone."""
    past_m = airspace.clearance_m + CLEAR_M
    over_amsl = [zone.ceiling_m + past_m for zone in airspace.no_fly if zone.name == name]
    under_amsl = [zone.floor_m - past_m for zone in airspace.no_fly if zone.name == name]
    over_ground = [threat.height_m + past_m for threat in airspace.threats if threat.name == name]
    over_ground += [
        obstacle.base_m + obstacle.height_m + past_m
        for obstacle in airspace.obstacles
        if obstacle.name == name
    ]
    changes_m = [value - level.amsl_m for value in over_amsl + under_amsl]
    changes_m += [value - level.height_m for value in over_ground]
    return [
        math.ceil(level.altitude_m + change) if change > 0.0 else math.floor(level.altitude_m + change)
        for change in changes_m
        if 0.0 < level.height_m + change <= HIGHEST_M
    ]


def _compass(unit: tuple[float, float]) -> str:
    names = ("east", "north-east", "north", "north-west", "west", "south-west", "south", "south-east")
    return names[round(math.atan2(unit[1], unit[0]) / (math.pi / 4.0)) % 8]
