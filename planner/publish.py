"""From the local frame to the published plan: WGS 84, degrees, one feature a role."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import shapely
from shapely.geometry import LinearRing, MultiPolygon, Polygon

from planner.airspace.shapes import DiscShape, hard_shapes
from planner.airspace.threats import curve_risk
from planner.airspace.zones import keep_out
from planner.dubins.path import Path, Segment, join
from planner.metrics import DIVIDING_M, energy_wh
from planner.plan import (
    Collect,
    Fence,
    FlownPath,
    Footprint,
    LonLat,
    LonLatAlt,
    Metrics,
    PathSegment,
    Plan,
    PlanVehicle,
    Transit,
    Uncovered,
    ZoneCircle,
    ZonePolygon,
)
from planner.route import CollectPass
from planner.scenario import Scenario
from planner.sensors.sar import SarSensor
from planner.sensors.view import seen_on_terrain
from planner.transit.certificate import proven_m
from planner.vehicle.aircraft import Aircraft
from planner.vehicle.wind import duration_s

#: Vertices of the published line: on arcs (the contract asks for at most 10 m; closer on tight ones, so that
#: chords stay near the arc and hardly shorter than it) and on straights, where the chord in longitude and
#: latitude must not leave the straight by more than a centimetre or so.
MAX_ARC_EDGE_M = 5.0
MAX_ARC_EDGE_RAD = 0.08
MAX_STRAIGHT_EDGE_M = 1000.0
#: From this latitude on straights have more vertices, so that the chord stays as near; the last degree counts
#: as one.
STEEP_DEG = 60.0
MOST_STEEP_DEG = 89.9


@dataclass(frozen=True, slots=True)
class Leg:
    """A flyable connection and where it leads: names, and the method that found it."""

    from_name: str
    to_name: str
    path: Path
    method: str


def whole_path(legs: tuple[Leg, ...], passes: tuple[CollectPass, ...]) -> Path:
    """Legs and passes in turn, beginning and ending with a leg."""
    pieces = [legs[0].path]
    for collect, leg in zip(passes, legs[1:], strict=True):
        pieces.append(Path((Segment("straight", collect.entry, collect.length_m),)))
        pieces.append(leg.path)
    return join(*pieces)


def vehicle_value(aircraft: Aircraft) -> PlanVehicle:
    """What the mission needs to know of an aircraft."""
    return PlanVehicle(
        aircraft.name,
        aircraft.type,
        aircraft.autopilot,
        aircraft.airspeed_m_s,
        aircraft.min_turn_radius_m,
        aircraft.max_climb_deg,
    )


def flown_path(scenario: Scenario, aircraft: Aircraft, path: Path) -> FlownPath:
    """The whole line of one aircraft."""
    radii = [segment.radius_m for segment in path.segments if segment.kind != "straight"]
    flown_s = duration_s(path, aircraft.airspeed_m_s, scenario.wind)
    return FlownPath(
        vehicle=aircraft.name,
        line=_line(scenario, path),
        segments=_segments(scenario, path),
        length_m=path.length_m,
        duration_s=flown_s,
        energy_wh=energy_wh(aircraft, flown_s),
        min_turn_radius_m=min(radii) if radii else None,
    )


def collects_and_transits(
    scenario: Scenario, aircraft: Aircraft, legs: tuple[Leg, ...], passes: tuple[CollectPass, ...]
) -> tuple[tuple[Collect, ...], tuple[Transit, ...], tuple[Footprint, ...]]:
    """The features along the line, numbered from 1 in flight order."""
    collects, transits = [], []
    footprints: list[Footprint] = []
    zones = replace(keep_out(scenario.airspace, scenario.level, soft=False), area=None)
    along_m = along_s = 0.0
    for seq, leg in enumerate(legs, start=1):
        missile, radar = curve_risk(
            leg.path.sample(5.0)[:, :2], scenario.threats, DIVIDING_M, scenario.height_m
        )
        transits.append(
            Transit(
                aircraft.name, seq, leg.from_name, leg.to_name, _line(scenario, leg.path), leg.path.length_m,
                missile, radar, leg.method, proven_m(leg.path, zones),
            )
        )  # fmt: skip
        along_m += leg.path.length_m
        along_s += duration_s(leg.path, aircraft.airspeed_m_s, scenario.wind)
        if seq > len(passes):
            break
        collect = passes[seq - 1]
        name = "+".join(collect.regions)
        (lon0, lat0), (lon1, lat1) = _lonlats(scenario, [collect.start, collect.end])
        middle = ((collect.start[0] + collect.end[0]) / 2.0, (collect.start[1] + collect.end[1]) / 2.0)
        end_m = along_m + collect.length_m
        flown = Path((Segment("straight", collect.entry, collect.length_m),))
        end_s = along_s + duration_s(flown, aircraft.airspeed_m_s, scenario.wind)
        collects.append(
            Collect(
                aircraft.name, seq, name, collect.regions, collect.sensor, collect.look,
                ((lon0, lat0, scenario.altitude_m), (lon1, lat1, scenario.altitude_m)),
                scenario.frame.true_heading_deg(*middle, collect.angle_rad),
                along_m, end_m, along_s, end_s,
            )
        )  # fmt: skip
        sensor = next(s for s in scenario.sensors if s.name == collect.sensor)
        footprints.extend(_footprints(scenario, aircraft, seq, name, collect, sensor))
        along_m, along_s = end_m, end_s
    return tuple(collects), tuple(transits), tuple(footprints)


def _footprints(
    scenario: Scenario, aircraft: Aircraft, seq: int, name: str, collect: CollectPass, sensor: SarSensor
) -> Iterator[Footprint]:
    """The ground seen: the pass's own footprint, on terrain one for each part really seen."""
    if scenario.terrain is None:
        ring = _ring(scenario, collect.footprint.exterior)
        yield Footprint(aircraft.name, seq, name, collect.sensor, ring, sensor.resolution_m)
        return
    line_m = (collect.start, collect.end)
    seen = seen_on_terrain(sensor, line_m, collect.look, scenario.altitude_amsl_m, scenario.terrain)
    # Specks of a cell or two say nothing on a map.
    tidy = seen.area.simplify(scenario.terrain.step_m / 20.0)
    parts = [part for part in shapely.get_parts(tidy) if part.area > scenario.terrain.step_m**2 / 10.0]
    for part in parts:
        outer, *holes = (_ring(scenario, ring) for ring in (part.exterior, *part.interiors))
        yield Footprint(
            aircraft.name,
            seq,
            name,
            collect.sensor,
            outer,
            sensor.resolution_m,
            holes=tuple(holes),
            shadow_m2=seen.shadow_m2,
            layover_m2=seen.layover_m2,
        )


def uncovered(
    scenario: Scenario, unseen: dict[str, Polygon | MultiPolygon], reasons: dict[str, str]
) -> tuple[Uncovered, ...]:
    """What the judge found unseen, with the reason where a stage gave one."""
    return tuple(
        Uncovered(
            name,
            tuple(
                tuple(_ring(scenario, ring) for ring in (part.exterior, *part.interiors))
                for part in (shape.geoms if isinstance(shape, MultiPolygon) else [shape])
            ),
            float(shape.area),
            reasons.get(name, "no footprint sees it"),
        )
        for name, shape in unseen.items()
    )


def fence(scenario: Scenario) -> Fence:
    """The operating area and everything hard."""
    inclusion = () if scenario.area is None else (_zone(scenario, "area", scenario.area),)
    polygons, circles = [], []
    for shape in hard_shapes(scenario.airspace, scenario.level):
        if isinstance(shape, DiscShape):
            circles.append(ZoneCircle(shape.name, _lonlats(scenario, [shape.centre])[0], shape.radius_m))
        else:
            polygons.append(_zone(scenario, shape.name, shape.area))
    return Fence(inclusion, tuple(polygons), tuple(circles))


def _zone(scenario: Scenario, name: str, area: Polygon) -> ZonePolygon:
    # Reading a ring cut its edges fine; for the autopilot the corners are enough.
    outline = area.exterior.simplify(0.05)
    corners = np.asarray(outline.coords)[:-1, :2]
    return ZonePolygon(name, _lonlats(scenario, corners))


def _segments(scenario: Scenario, path: Path) -> tuple[PathSegment, ...]:
    ends = _lonlats(scenario, [segment.start.position for segment in path.segments] + [path.end.position])
    values = []
    along_m = 0.0
    for segment, start, end in zip(path.segments, ends, ends[1:], strict=False):
        centre = segment.centre
        values.append(
            PathSegment(
                segment.kind,
                start,
                end,
                along_m,
                segment.length_m,
                None if centre is None else segment.radius_m,
                None if centre is None else _lonlats(scenario, [centre])[0],
                None if centre is None else abs(math.degrees(segment.turn_rad)),
                scenario.altitude_m,
                scenario.altitude_m,
            )
        )
        along_m += segment.length_m
    return tuple(values)


def _line(scenario: Scenario, path: Path) -> tuple[LonLatAlt, ...]:
    tightest_m = min(segment.radius_m for segment in path.segments)
    arc_edge_m = min(MAX_ARC_EDGE_M, MAX_ARC_EDGE_RAD * tightest_m)
    points = path.sample(arc_edge_m, _straight_edge_m(scenario))[:, :2]
    return tuple((lon, lat, scenario.altitude_m) for lon, lat in _lonlats(scenario, points))


def _ring(scenario: Scenario, ring: LinearRing) -> tuple[LonLat, ...]:
    """A ring of ground; nearer to the pole its edges are cut: straight in metres they are not in degrees."""
    if abs(scenario.frame.lat_deg) > STEEP_DEG:
        ring = shapely.segmentize(ring, _straight_edge_m(scenario))
    return _lonlats(scenario, shapely.get_coordinates(ring))


def _straight_edge_m(scenario: Scenario) -> float:
    """``MAX_STRAIGHT_EDGE_M``, less towards the poles, where a line straight in degrees bends more."""
    lat_deg = abs(scenario.frame.lat_deg)
    if lat_deg <= STEEP_DEG:
        return MAX_STRAIGHT_EDGE_M
    bend = math.tan(math.radians(min(lat_deg, MOST_STEEP_DEG))) / math.tan(math.radians(STEEP_DEG))
    return MAX_STRAIGHT_EDGE_M / math.sqrt(bend)


def _lonlats(scenario: Scenario, points: object) -> tuple[LonLat, ...]:
    """Places in degrees; longitudes go on from the first, beyond ±180 where the line crosses there."""
    lons, lats = scenario.frame.to_wgs84(np.asarray(points)).T
    return tuple(zip(np.unwrap(lons, period=360.0).tolist(), lats.tolist(), strict=True))


def assemble(
    scenario: Scenario,
    aircraft: Aircraft,
    legs: tuple[Leg, ...],
    passes: tuple[CollectPass, ...],
    *,
    metrics: Metrics,
    methods: dict[str, str],
    planner_version: str,
    warnings: tuple[str, ...],
) -> Plan:
    """The plan of one aircraft, not yet judged: without violations and what is uncovered."""
    collects, transits, footprints = collects_and_transits(scenario, aircraft, legs, passes)
    home, end = _lonlats(scenario, [scenario.start.position, scenario.end.position])
    return Plan(
        name=scenario.name,
        vehicles=(vehicle_value(aircraft),),
        altitude_m=scenario.altitude_m,
        altitude_reference=scenario.altitude_reference,
        home=home,
        end=end,
        paths=(flown_path(scenario, aircraft, whole_path(legs, passes)),),
        collects=collects,
        transits=transits,
        footprints=footprints,
        uncovered=(),
        fence=fence(scenario),
        metrics=metrics,
        violations=(),
        methods=methods,
        scenario_hash=scenario.scenario_hash,
        planner_version=planner_version,
        seed=scenario.seed,
        warnings=warnings,
    )
