"""The independent judge of a plan.

It reads the published plan back from its WGS 84 line and judges that: not waypoints, not what the stages
believe. It shares no algorithm with them: radius from the vertices of the line, zones and coverage from
shapely, the footprint drawn anew from the sensor's angles.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from shapely import difference, intersection, line_merge, union_all
from shapely.geometry import LineString, MultiPolygon, Point, Polygon
from shapely.geometry.base import BaseGeometry
from shapely.ops import substring

from planner.environment.shapes import hard_shapes, soft_shapes
from planner.plan import Collect, FlownPath, LonLat, Plan, Violation
from planner.scenario import Region, Scenario, Wind
from planner.sensors.view import seen_on_flat, seen_on_terrain
from planner.vehicle.aircraft import Aircraft

#: Arcs have vertices at most this far apart, so a longer edge is straight.
MAX_ARC_EDGE_M = 10.0
RADIUS_TOLERANCE = 1e-4
PLACE_TOLERANCE_M = 0.05
LENGTH_TOLERANCE = 1e-3
#: What rounding to 11 decimals of a degree may move both ends of an edge against each other.
DIRECTION_NOISE_M = 2e-6
#: Overlays are done on a grid: without one, outlines equal but for rounding can be taken for disjoint.
GRID_M = 1e-6
#: A region counts as seen when no more than this fraction of it is left out.
UNSEEN_FRACTION = 1e-5


@dataclass(frozen=True, slots=True)
class Verdict:
    """What the judge measured.

    Parameters
    ----------
    violations
        Empty for a sound plan.
    length_m
        Of all paths, along their vertices.
    min_turn_radius_m
        Tightest turn found, inf without any.
    coverage
        Fraction of each region inside the footprints, as often as it is to be visited.
    unseen
        What is left of each region that is not covered whole, in the local frame.
    """

    violations: tuple[Violation, ...]
    length_m: float
    min_turn_radius_m: float
    coverage: dict[str, float]
    unseen: dict[str, Polygon | MultiPolygon]


def judge(scenario: Scenario, plan: Plan) -> Verdict:
    """Judge a plan against the scenario it answers; see :class:`Verdict`."""
    violations: list[Violation] = []
    lengths_m: list[float] = []
    tightest_m = math.inf
    for path in plan.paths:
        aircraft = next(a for a in scenario.aircraft if a.name == path.vehicle).in_wind(
            scenario.wind.speed_m_s
        )
        line_m = scenario.frame.to_local([place[:2] for place in path.line])
        lengths_m.append(float(np.hypot(*np.diff(line_m, axis=0).T).sum()))
        radius_m, where = turn_radius_m(line_m)
        tightest_m = min(tightest_m, radius_m)
        limit_m = aircraft.ground_turn_radius_m
        if radius_m < limit_m * (1.0 - RADIUS_TOLERANCE):
            violations.append(
                Violation(
                    "turn-radius",
                    path.vehicle,
                    f"a turn of {radius_m:.2f} m radius, the limit is {limit_m:g} m",
                    limit_m - radius_m,
                    "m",
                    _lonlat(scenario, where),
                )
            )
        line = LineString(line_m)
        violations += _place_violations(scenario, path, line)
        violations += _clearance_violations(scenario, plan, path, line_m)
        violations += _terminal_violations(scenario, path, line_m)
        time_s = flown_s(line_m, aircraft.airspeed_m_s, scenario.wind)
        if abs(time_s - path.duration_s) > LENGTH_TOLERANCE * max(time_s, 1.0):
            violations.append(
                Violation(
                    "duration",
                    path.vehicle,
                    f"the path says {path.duration_s:.1f} s, its line takes {time_s:.1f} s",
                    abs(time_s - path.duration_s),
                    "s",
                )
            )
        violations += _limit_violations(aircraft, path, lengths_m[-1], time_s)
        violations += _collect_violations(scenario, plan, path, line)
    coverage, unseen, missed = _coverage(scenario, plan)
    violations += missed
    length_m = math.fsum(lengths_m)
    if abs(length_m - plan.metrics.length_m) > LENGTH_TOLERANCE * max(length_m, 1.0):
        violations.append(
            Violation(
                "length",
                "metrics",
                f"metrics say {plan.metrics.length_m:.1f} m, the line measures {length_m:.1f} m",
                abs(length_m - plan.metrics.length_m),
                "m",
            )
        )
    return Verdict(tuple(violations), length_m, tightest_m, coverage, unseen)


def turn_radius_m(line_m: NDArray[np.float64]) -> tuple[float, NDArray[np.float64]]:
    """Tightest turn of a polyline whose arcs have vertices at most 10 m apart, and where it is.

    At each vertex the direction changes by δ over half of either edge; an edge counts for no more than an arc
    may have, so that a kink between two long straights is as tight as it looks.
    """
    edges = np.diff(line_m, axis=0)
    keep = np.hypot(edges[:, 0], edges[:, 1]) > 1e-6
    points = np.vstack([line_m[:1], line_m[1:][keep]])
    edges = np.diff(points, axis=0)
    if len(edges) < 2:
        return math.inf, points[0]
    lengths_m = np.minimum(np.hypot(edges[:, 0], edges[:, 1]), MAX_ARC_EDGE_M)
    directions = np.arctan2(edges[:, 1], edges[:, 0])
    delta = np.abs(np.mod(np.diff(directions) + np.pi, 2.0 * np.pi) - np.pi)
    # Directions of edges are known no better than the coordinates' last digit allows.
    noise = DIRECTION_NOISE_M / np.minimum(lengths_m[:-1], lengths_m[1:])
    with np.errstate(divide="ignore"):
        radii = (lengths_m[:-1] + lengths_m[1:]) / 4.0 / np.sin(np.maximum(delta - noise, 0.0) / 2.0)
    worst = int(np.argmin(radii))
    return float(radii[worst]), points[worst + 1]


def _place_violations(scenario: Scenario, path: FlownPath, line: LineString) -> Iterator[Violation]:
    if scenario.area is not None:
        outside = line.difference(scenario.area.buffer(PLACE_TOLERANCE_M))
        if not outside.is_empty:
            yield Violation(
                "area",
                path.vehicle,
                f"{outside.length:.1f} m are flown outside the operating area",
                float(outside.length),
                "m",
                _middle(scenario, outside),
            )
    for hard, shapes in ((True, hard_shapes(scenario)), (False, soft_shapes(scenario))):
        for shape in shapes:
            depth_m = shape.depth_m(line)
            if depth_m <= 0.0:
                continue
            inside = line.intersection(shape.polygon())
            yield Violation(
                "hard-zone" if hard else "soft-threat",
                shape.name,
                f"{inside.length:.1f} m are flown inside {shape.name}, up to {depth_m:.1f} m deep",
                float(inside.length),
                "m",
                _middle(scenario, inside),
                hard=hard,
            )


def _clearance_violations(
    scenario: Scenario, plan: Plan, path: FlownPath, line_m: NDArray[np.float64]
) -> Iterator[Violation]:
    """Height over the ground all along the line, no farther apart than half the ground's posts."""
    ground = scenario.terrain
    if ground is None:
        return
    altitude_m = np.array([place[2] for place in path.line])
    if plan.altitude_reference != "amsl":
        altitude_m = altitude_m + (scenario.home_amsl_m or 0.0)
    reached_m = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line_m, axis=0).T))])
    count = max(2, math.ceil(reached_m[-1] / (ground.step_m / 2.0)) + 1)
    at_m = np.union1d(np.linspace(0.0, reached_m[-1], count), reached_m)
    places = np.stack([np.interp(at_m, reached_m, line_m[:, k]) for k in (0, 1)], axis=1)
    clear_m = np.interp(at_m, reached_m, altitude_m) - ground.at(places)
    unknown = np.isnan(clear_m)
    if unknown.any():
        length_m = float(unknown.mean() * reached_m[-1])
        yield Violation(
            "terrain-clearance",
            path.vehicle,
            f"about {length_m:.0f} m are flown where the raster {ground.name} has no heights",
            length_m,
            "m",
            _lonlat(scenario, places[int(np.argmax(unknown))]),
        )
    worst = int(np.argmin(np.where(unknown, np.inf, clear_m)))
    if clear_m[worst] < scenario.clearance_m:
        yield Violation(
            "terrain-clearance",
            path.vehicle,
            f"{clear_m[worst]:.1f} m over the ground, {scenario.clearance_m:g} m are to be kept",
            float(scenario.clearance_m - clear_m[worst]),
            "m",
            _lonlat(scenario, places[worst]),
        )


def _terminal_violations(
    scenario: Scenario, path: FlownPath, line_m: NDArray[np.float64]
) -> Iterator[Violation]:
    for terminal, place, direction in (
        (scenario.start, line_m[0], line_m[1] - line_m[0]),
        (scenario.end, line_m[-1], line_m[-1] - line_m[-2]),
    ):
        gap_m = math.dist(terminal.position, place)
        if gap_m > PLACE_TOLERANCE_M:
            yield Violation(
                "continuity",
                terminal.name,
                f"the path misses {terminal.name} by {gap_m:.2f} m",
                gap_m,
                "m",
                _lonlat(scenario, place),
            )
        if terminal.angle_rad is not None:
            off_rad = abs(
                math.remainder(math.atan2(direction[1], direction[0]) - terminal.angle_rad, math.tau)
            )
            if off_rad > math.radians(3.0):
                yield Violation(
                    "continuity",
                    terminal.name,
                    f"the path's direction at {terminal.name} is {math.degrees(off_rad):.1f}° off",
                    math.degrees(off_rad),
                    "deg",
                    _lonlat(scenario, place),
                )


def flown_s(line_m: NDArray[np.float64], airspeed_m_s: float, wind: Wind) -> float:
    """Time to fly a polyline in a steady wind, edge by edge.

    The velocity over the ground is v along the edge; less the wind it must be as long as the airspeed, so
    v² - 2 v w + W² = V² with w the wind's component along the edge.
    """
    if wind.speed_m_s >= airspeed_m_s:
        return math.inf
    edges = np.diff(line_m, axis=0)
    lengths_m = np.hypot(edges[:, 0], edges[:, 1])
    edges, lengths_m = edges[lengths_m > 0.0], lengths_m[lengths_m > 0.0]
    toward = np.array([math.cos(wind.toward_rad), math.sin(wind.toward_rad)])
    along_m_s = wind.speed_m_s * (edges @ toward) / lengths_m
    speeds_m_s = along_m_s + np.sqrt(along_m_s**2 + airspeed_m_s**2 - wind.speed_m_s**2)
    return float((lengths_m / speeds_m_s).sum())


def _limit_violations(
    aircraft: Aircraft, path: FlownPath, length_m: float, time_s: float
) -> Iterator[Violation]:
    energy_wh = None if aircraft.cruise_power_w is None else aircraft.cruise_power_w * time_s / 3600.0
    for constraint, used, limit, unit in (
        ("range", length_m, aircraft.max_range_m, "m"),
        ("flight-time", time_s, aircraft.max_flight_time_s, "s"),
        ("energy", energy_wh, aircraft.energy_wh, "Wh"),
    ):
        if used is not None and limit is not None and used > limit:
            yield Violation(
                constraint,
                path.vehicle,
                f"needs {used:.0f} {unit} but has {limit:.0f} {unit}",
                used - limit,
                unit,
            )


def _collect_violations(
    scenario: Scenario, plan: Plan, path: FlownPath, line: LineString
) -> Iterator[Violation]:
    """Each collect lies on the path, where it says, straight and in its direction."""
    for collect in plan.collects_of(path.vehicle):
        (east0, north0), (east1, north1) = scenario.frame.to_local([place[:2] for place in collect.line])
        flown = np.asarray(substring(line, collect.start_m, collect.end_m).coords)
        length_m = math.hypot(east1 - east0, north1 - north0)
        along = np.array([east1 - east0, north1 - north0]) / length_m
        offset = flown - np.array([east0, north0])
        across_m = np.abs(offset[:, 0] * along[1] - offset[:, 1] * along[0])
        ends_m = max(math.dist(flown[0], (east0, north0)), math.dist(flown[-1], (east1, north1)))
        off_m = max(float(across_m.max()), ends_m)
        # Distances along the published line are those of arcs, the line's own are those of chords.
        allowed_m = PLACE_TOLERANCE_M + LENGTH_TOLERANCE * collect.start_m
        if float(across_m.max()) > PLACE_TOLERANCE_M or ends_m > allowed_m:
            yield Violation(
                "collect-straight",
                collect.roi,
                f"collect {collect.seq} and the path are {off_m:.2f} m apart",
                off_m,
                "m",
                collect.line[0][:2],
            )


def footprint(scenario: Scenario, collect: Collect) -> Polygon | MultiPolygon:
    """Ground seen at full resolution during a collect, in the local frame; on terrain without what is hidden.

    Between half an aperture after sensor on and half an aperture before sensor off every point between the
    near and the far edge of the beam is lit over a whole aperture.
    """
    sensor = next(s for s in scenario.sensors if s.name == collect.sensor)
    line_m = scenario.frame.to_local([place[:2] for place in collect.line])
    if scenario.terrain is not None:
        level_m = collect.line[0][2]
        return seen_on_terrain(sensor, line_m, collect.look, level_m, scenario.terrain).area
    (east0, north0), (east1, north1) = line_m
    length_m = math.hypot(east1 - east0, north1 - north0)
    along = np.array([east1 - east0, north1 - north0]) / length_m
    side = np.array([along[1], -along[0]]) * (1.0 if collect.look == "right" else -1.0)
    height_m = scenario.height_m
    if sensor.squint_rad != 0.0 or sensor.mode == "spotlight":
        return seen_on_flat(sensor, line_m, collect.look, height_m)
    half_beam_rad = sensor.elevation_beamwidth_rad / 2.0
    near_m = height_m * math.tan(sensor.incidence_rad - half_beam_rad)
    far_m = height_m * math.tan(sensor.incidence_rad + half_beam_rad)
    half_aperture_m = height_m * sensor.azimuth_beamwidth_rad / math.cos(sensor.incidence_rad) / 2.0
    if length_m <= 2.0 * half_aperture_m:
        return Polygon()
    first = np.array([east0, north0]) + along * half_aperture_m
    last = np.array([east1, north1]) - along * half_aperture_m
    return Polygon([first + side * near_m, last + side * near_m, last + side * far_m, first + side * far_m])


def _coverage(
    scenario: Scenario, plan: Plan
) -> tuple[dict[str, float], dict[str, Polygon | MultiPolygon], list[Violation]]:
    coverage: dict[str, float] = {}
    unseen: dict[str, Polygon | MultiPolygon] = {}
    violations = []
    seen_by = [(collect, footprint(scenario, collect)) for collect in plan.collects]
    for region in scenario.regions:
        prints = [
            ground
            for collect, ground in seen_by
            if ground.intersects(region.area) and _counts(scenario, region, collect)
        ]
        seen = seen_times(prints, region.revisits)
        # A millimetre of slack: coordinates are rounded to a hundredth of one.
        rest = difference(region.area, seen.buffer(1e-3), grid_size=GRID_M)
        fraction = 1.0 - rest.area / region.area.area
        coverage[region.name] = fraction
        if rest.area <= UNSEEN_FRACTION * region.area.area:
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
                _middle(scenario, rest),
                hard=region.required,
            )
        )
    return coverage, unseen, violations


def seen_times(prints: Sequence[BaseGeometry], times: int) -> BaseGeometry:
    """The ground that at least so many of the footprints hold."""
    if times == 1:
        return union_all(prints, grid_size=GRID_M)
    # deep[k] is what the footprints so far hold k + 1 times.
    deep: list[BaseGeometry] = [Polygon() for _ in range(times)]
    for ground in prints:
        for k in range(times - 1, 0, -1):
            again = intersection(deep[k - 1], ground, grid_size=GRID_M)
            deep[k] = union_all([deep[k], again], grid_size=GRID_M)
        deep[0] = union_all([deep[0], ground], grid_size=GRID_M)
    return deep[-1]


def _counts(scenario: Scenario, region: Region, collect: Collect) -> bool:
    """Whether a collect sees with a sensor, a resolution and a direction that the region allows."""
    sensor = next(s for s in scenario.sensors if s.name == collect.sensor)
    if sensor.name != scenario.sensor_for(region).name:
        return False
    if region.min_resolution_m is not None and (
        sensor.resolution_m is None or sensor.resolution_m > region.min_resolution_m
    ):
        return False
    if region.approach_rad is None:
        return True
    (east0, north0), (east1, north1) = scenario.frame.to_local([place[:2] for place in collect.line])
    angle = math.atan2(north1 - north0, east1 - east0)
    return any(
        abs(math.remainder(angle - allowed, math.tau)) < math.radians(1.0) for allowed in region.approach_rad
    )


def _lonlat(scenario: Scenario, place_m: NDArray[np.float64] | tuple[float, float]) -> LonLat:
    lon_deg, lat_deg = scenario.frame.to_wgs84(place_m)
    return (float(lon_deg), float(lat_deg))


def _middle(scenario: Scenario, shape: BaseGeometry) -> LonLat:
    if shape.geom_type == "MultiLineString":
        shape = line_merge(shape)
    largest = max(getattr(shape, "geoms", [shape]), key=lambda part: (part.area, part.length))
    place: Point = (
        largest.interpolate(0.5, normalized=True)
        if isinstance(largest, LineString)
        else largest.representative_point()
    )
    return _lonlat(scenario, (place.x, place.y))
