"""What of each region the footprints hold, as often as it is to be visited."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import fields, is_dataclass
from typing import Any

from shapely import difference, get_parts, intersection, union_all
from shapely.geometry import MultiPolygon, Polygon
from shapely.geometry.base import BaseGeometry

from planner.airspace.built import bare_ground
from planner.check.footprints import footprint
from planner.check.heights import HEIGHT_TOLERANCE_M
from planner.check.places import middle
from planner.plan import Collect, Plan, Violation
from planner.scenario import Scenario
from planner.sensors.camera import CameraSensor
from planner.wishes import Region

#: Overlays are done on a grid: without one, outlines equal but for rounding can be taken for disjoint.
GRID_M = 1e-6
#: A region counts as seen when no more than this fraction of it is left out.
UNSEEN_FRACTION = 1e-5
#: Times are rounded to a millisecond.
TIME_TOLERANCE_S = 0.01


def covered(
    scenario: Scenario, plan: Plan
) -> tuple[dict[str, float], dict[str, Polygon | MultiPolygon], list[Violation]]:
    """Fraction of each region's bare ground seen, what of it is not, in the local frame, and violations."""
    coverage: dict[str, float] = {}
    unseen: dict[str, Polygon | MultiPolygon] = {}
    violations = []
    seen_by = [(collect, footprint(scenario, collect, plan)) for collect in plan.collects]
    for region in scenario.regions:
        asked = bare_ground(region.area, scenario.airspace, scenario.level.of(region))
        own = [
            (collect, ground)
            for collect, ground in seen_by
            if ground.intersects(region.area) and counts(scenario, region, collect)
        ]
        if region.revisit_after_s > 0.0:
            seen = seen_apart(region, own, asked)
        else:
            seen = seen_times([ground for _, ground in own], region.revisits)
        # A millimetre of slack: coordinates are rounded to a hundredth of one.
        rest = difference(asked, seen.buffer(1e-3), grid_size=GRID_M)
        fraction = max(0.0, 1.0 - rest.area / asked.area)
        coverage[region.name] = fraction
        if rest.area <= UNSEEN_FRACTION * asked.area:
            coverage[region.name] = 1.0
            continue
        polygons = [part for part in getattr(rest, "geoms", [rest]) if isinstance(part, Polygon)]
        unseen[region.name] = polygons[0] if len(polygons) == 1 else MultiPolygon(polygons)
        violations.append(
            Violation(
                "coverage",
                region.name,
                f"{100.0 * fraction:.3f} % of {region.name} is seen"
                + (f" {region.revisits} times" if region.revisits > 1 else ""),
                float(rest.area),
                "m2",
                middle(scenario, rest),
                hard=region.required,
            )
        )
    return coverage, unseen, violations


def seen_apart(
    region: Region, seen_by: Sequence[tuple[Collect, BaseGeometry]], asked: BaseGeometry
) -> BaseGeometry:
    """What the last visit sees of a region whose visits lie apart; all of it where there are enough.

    A visit ends as soon as all is seen; the next one begins with the first collect that is late enough.
    """
    visits, from_s, until_s = 0, -math.inf, -math.inf
    seen: BaseGeometry = Polygon()
    for collect, ground in sorted(seen_by, key=lambda each: each[0].start_s):
        if collect.start_s < from_s - TIME_TOLERANCE_S:
            continue
        seen = union_all([seen, ground], grid_size=GRID_M)
        until_s = max(until_s, collect.end_s)
        rest = difference(asked, seen.buffer(1e-3), grid_size=GRID_M)
        if rest.area <= UNSEEN_FRACTION * asked.area:
            visits += 1
            if visits == region.revisits:
                return seen
            from_s, until_s, seen = until_s + region.revisit_after_s, -math.inf, Polygon()
    return seen


def seen_times(prints: Sequence[BaseGeometry], times: int) -> BaseGeometry:
    """The ground that at least so many of the footprints hold."""
    if times == 1:
        return union_all(prints, grid_size=GRID_M)
    # deep[k] is what the footprints so far hold k + 1 times.
    deep: list[BaseGeometry] = [Polygon() for _ in range(times)]
    for ground in prints:
        for k in range(times - 1, 0, -1):
            again = _areal(intersection(deep[k - 1], ground, grid_size=GRID_M))
            deep[k] = union_all([deep[k], again], grid_size=GRID_M)
        deep[0] = union_all([deep[0], ground], grid_size=GRID_M)
    return deep[-1]


def _areal(geometry: BaseGeometry) -> MultiPolygon:
    """What has area of an overlay: footprints that share an edge besides leave a line, too."""
    return MultiPolygon([part for part in get_parts(geometry).tolist() if isinstance(part, Polygon)])


def _same(one: Any, other: Any) -> bool:
    """Whether sensors see the same: they are one, or differ in their names alone."""
    if one.name == other.name or type(one) is not type(other) or not is_dataclass(one):
        return bool(one.name == other.name)
    traits = [trait.name for trait in fields(one) if trait.name != "name"]
    return all(getattr(one, trait) == getattr(other, trait) for trait in traits)


def _resolves(resolution_m: float | None, asked_m: float | None) -> bool:
    return asked_m is None or (resolution_m is not None and resolution_m <= asked_m)


def counts(scenario: Scenario, region: Region, collect: Collect) -> bool:
    """Whether a collect sees with a sensor, a resolution, a height, a direction, at a time that it allows."""
    if region.time_window_s is not None:
        first_s, last_s = region.time_window_s
        if collect.start_s < first_s - TIME_TOLERANCE_S or collect.end_s > last_s + TIME_TOLERANCE_S:
            return False
    sensor = next(s for s in scenario.sensors if s.name == collect.sensor)
    if not _same(sensor, scenario.sensor_for(region)):
        return False
    asked_m = scenario.altitude_m if region.altitude_m is None else region.altitude_m
    if region.over_ground_m is None and abs(collect.line[0][2] - asked_m) > HEIGHT_TOLERANCE_M:
        return False
    # What cameras resolve is judged photo by photo.
    if not isinstance(sensor, CameraSensor) and not _resolves(sensor.resolution_m, region.min_resolution_m):
        return False
    if region.approach_rad is None:
        return True
    (east0, north0), (east1, north1) = scenario.frame.to_local([place[:2] for place in collect.line])
    angle = math.atan2(north1 - north0, east1 - east0)
    return any(
        abs(math.remainder(angle - allowed, math.tau)) < math.radians(1.0) for allowed in region.approach_rad
    )
