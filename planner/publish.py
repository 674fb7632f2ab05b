"""From the local frame to the published plan: WGS 84, degrees, one feature a role."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray
from shapely.geometry import LinearRing, LineString, MultiPolygon, Polygon
from shapely.geometry.base import BaseGeometry

from planner.airspace.airspace import Airspace, Level
from planner.airspace.shapes import DiscShape, banded_shapes, without_holes
from planner.airspace.terrain import Ground
from planner.airspace.values import Wind
from planner.airspace.zones import keep_out
from planner.flown import flown_path, line_between
from planner.frames import LocalFrame
from planner.metrics import risks
from planner.photos import photos_of, plan_cameras, with_photos
from planner.plan import (
    Collect,
    Fence,
    Finish,
    Footprint,
    LonLat,
    Metrics,
    Photos,
    Plan,
    PlanVehicle,
    PlanWind,
    Transit,
    Uncovered,
    ZoneCircle,
    ZonePolygon,
)
from planner.profile.compose import Composed
from planner.profile.heights import SAME_M, Heights
from planner.profile.lines import cut
from planner.route import CollectPass, Terminal
from planner.sensors.base import Sensor
from planner.sensors.camera import CameraSensor
from planner.sensors.registry import seen as seen_from
from planner.sensors.suite import Suite
from planner.sensors.worth import Worth, worth_of
from planner.transit.certificate import proven_m
from planner.vehicle.aircraft import Aircraft
from planner.vehicle.model import FlightModel

Floats = NDArray[np.float64]

#: Altitudes nearer than this are one.
HEIGHT_SAME_M = 0.01
#: Vertices of straights of the published line: the chord in longitude and latitude must not leave the
#: straight by more than a centimetre or so.
MAX_STRAIGHT_EDGE_M = 1000.0
#: From this latitude on straights have more vertices, so that the chord stays as near; the last degree counts
#: as one.
STEEP_DEG = 60.0
MOST_STEEP_DEG = 89.9


@dataclass(frozen=True, slots=True)
class Chart:
    """The local frame, and the level flown in it."""

    frame: LocalFrame
    level: Level

    def lonlats(self, places_m: ArrayLike) -> tuple[LonLat, ...]:
        """Places (N, 2) in degrees; longitudes go on from the first, beyond ±180 where they cross there."""
        lons, lats = self.frame.to_wgs84(np.asarray(places_m)).T
        return tuple(zip(np.unwrap(lons, period=360.0).tolist(), lats.tolist(), strict=True))

    def ring(self, ring: LinearRing) -> tuple[LonLat, ...]:
        """A ring of ground; nearer to the pole its edges are cut: straight in metres, bent in degrees."""
        if abs(self.frame.lat_deg) > STEEP_DEG:
            ring = shapely.segmentize(ring, self.straight_edge_m)
        return self.lonlats(shapely.get_coordinates(ring))

    @property
    def straight_edge_m(self) -> float:
        """``MAX_STRAIGHT_EDGE_M``, less towards the poles, where a line straight in degrees bends more."""
        lat_deg = abs(self.frame.lat_deg)
        if lat_deg <= STEEP_DEG:
            return MAX_STRAIGHT_EDGE_M
        bend = math.tan(math.radians(min(lat_deg, MOST_STEEP_DEG))) / math.tan(math.radians(STEEP_DEG))
        return MAX_STRAIGHT_EDGE_M / math.sqrt(bend)


@dataclass(frozen=True, slots=True)
class Leg:
    """Where a leg leads, and the method that found it."""

    from_name: str
    to_name: str
    method: str


def vehicle_value(aircraft: Aircraft, finish: Finish) -> PlanVehicle:
    """What the mission needs to know of an aircraft."""
    return PlanVehicle(
        aircraft.name,
        aircraft.type,
        aircraft.autopilot,
        aircraft.airspeed_m_s,
        aircraft.min_turn_radius_m,
        aircraft.max_climb_deg,
        finish,
    )


def collects_and_transits(
    chart: Chart,
    model: FlightModel,
    airspace: Airspace,
    suite: Suite,
    composed: Composed,
    legs: tuple[Leg, ...],
    passes: tuple[CollectPass, ...],
) -> tuple[tuple[Collect, ...], tuple[Transit, ...], tuple[Footprint, ...], tuple[Photos, ...]]:
    """The features along the line, numbered from 1 in flight order."""
    collects, transits = [], []
    footprints: list[Footprint] = []
    photos: list[Photos] = []
    level, flight = chart.level, composed.flight
    # Its distance from the things themselves, whatever was to be kept from them.
    bare = replace(airspace, clearance_m=0.0)
    zones = replace(keep_out(bare, level, soft=False), area=None)
    for seq, (leg, (from_m, until_m)) in enumerate(zip(legs, composed.legs_m, strict=True), start=1):
        path = cut(flight.path, from_m, until_m)
        missile, radar = risks(flight, from_m, until_m, airspace.threats, level)
        line = line_between(flight, from_m, until_m, chart.lonlats, chart.straight_edge_m)
        length_m = flight.along(until_m)[0] - flight.along(from_m)[0]
        flown = _levels(flight.heights.within(from_m, until_m), level)
        near = (
            zones
            if flown is None
            else replace(keep_out(bare, flown[1], soft=False, lowest=flown[0]), area=None)
        )
        transits.append(
            Transit(
                model.name, seq, leg.from_name, leg.to_name, line, length_m,
                missile, radar, leg.method, proven_m(path, near),
            )
        )  # fmt: skip
    for seq, (collect, (from_m, until_m)) in enumerate(zip(passes, composed.passes_m, strict=True), start=1):
        name = "+".join(collect.regions)
        (lon0, lat0), (lon1, lat1) = chart.lonlats([collect.start, collect.end])
        middle = ((collect.start[0] + collect.end[0]) / 2.0, (collect.start[1] + collect.end[1]) / 2.0)
        (start_m, start_s), (end_m, end_s) = flight.along(from_m), flight.along(until_m)
        heights = flight.heights.within(from_m, until_m)
        (_, altitude_m), (_, last_m) = heights.knots[0], heights.knots[-1]
        collects.append(
            Collect(
                model.name, seq, name, collect.regions, collect.sensor, collect.look,
                ((lon0, lat0, altitude_m), (lon1, lat1, last_m)),
                chart.frame.true_heading_deg(*middle, collect.angle_rad),
                start_m, end_m, start_s, end_s,
                speed_m_s=None if collect.slow is None else collect.slow.speed_m_s,
            )
        )  # fmt: skip
        sensor, ground = suite.named(collect.sensor), airspace.terrain
        there = level.at(altitude_m)
        footprints.extend(_footprints(chart, ground, model.name, seq, name, collect, sensor, there, heights))
        if isinstance(sensor, CameraSensor):
            taken = photos_of(collect, seq, collects[-1].line, heights, sensor, model)
            photos.extend([] if taken is None else [taken])
    return tuple(collects), tuple(transits), tuple(footprints), tuple(photos)


def _levels(heights: Heights, level: Level) -> tuple[Level, Level] | None:
    """The lowest and the highest level of a leg that is flown at another than what it leads between."""
    if level.spread_m > 0.0:
        return None
    ends_m = (heights.knots[0][1], heights.knots[-1][1])
    flat_m = [low_m for (_, low_m), (_, high_m) in pairwise(heights.knots) if abs(high_m - low_m) <= SAME_M]
    if all(min(abs(each - end_m) for end_m in ends_m) <= HEIGHT_SAME_M for each in flat_m):
        return None
    return level.at(min(*flat_m, max(ends_m))), level.at(max(*flat_m, max(ends_m)))


def _footprints(
    chart: Chart,
    ground: Ground | None,
    vehicle: str,
    seq: int,
    name: str,
    collect: CollectPass,
    sensor: Sensor,
    level: Level,
    heights: Heights,
) -> Iterator[Footprint]:
    """The ground seen: the pass's own footprint, on terrain one for each part really seen."""
    if ground is None:
        ring = chart.ring(collect.footprint.exterior)
        yield _valued(
            Footprint(vehicle, seq, name, collect.sensor, ring, sensor.resolution_m),
            worth_of(sensor, level.height_m, 0.0, 0.0),
        )
        return
    line_m = (collect.start, collect.end)
    levels_m: float | Floats = level.amsl_m
    if not heights.is_level:
        count = max(2, math.ceil(collect.length_m / ground.step_m) + 1)
        levels_m = heights.at(np.linspace(0.0, collect.length_m, count)) + level.amsl_m - level.altitude_m
    seen = seen_from(sensor, line_m, collect.look, levels_m, ground)
    # Specks of a cell or two say nothing on a map.
    tidy = seen.area.simplify(ground.step_m / 20.0)
    parts = [part for part in shapely.get_parts(tidy) if part.area > ground.step_m**2 / 10.0]
    for part in parts:
        outer, *holes = (chart.ring(ring) for ring in (part.exterior, *part.interiors))
        high_m, low_m = _heights_over(ground, part, line_m, levels_m)
        mean_m = (low_m + high_m) / 2.0
        yield _valued(
            Footprint(
                vehicle,
                seq,
                name,
                collect.sensor,
                outer,
                sensor.resolution_m,
                holes=tuple(holes),
                shadow_m2=seen.shadow_m2,
                layover_m2=seen.layover_m2,
            ),
            worth_of(sensor, mean_m, mean_m - high_m, mean_m - low_m),
        )


def _heights_over(
    ground: Ground, part: Polygon, line_m: ArrayLike, levels_m: float | Floats
) -> tuple[float, float]:
    """Greatest and least height over ground from which a part of it is seen, from beside it."""
    if isinstance(levels_m, float):
        low_m, high_m = ground.range_over(part)
        return levels_m - low_m, levels_m - high_m
    start, end = np.asarray(line_m, dtype=np.float64)
    along = end - start
    posts = ground.posts_of(part)
    at = (posts[:, :2] - start) @ along / (along @ along)
    over_m = np.interp(at, np.linspace(0.0, 1.0, len(levels_m)), levels_m) - posts[:, 2]
    return float(over_m.max()), float(over_m.min())


def _valued(footprint: Footprint, worth: Worth) -> Footprint:
    """With what its images are worth; a camera resolves what a pixel covers."""
    return replace(
        footprint,
        resolution_m=worth.gsd_m if footprint.resolution_m is None else footprint.resolution_m,
        gsd_m=worth.gsd_m,
        gsd_mean_m=worth.gsd_mean_m,
        niirs=worth.niirs,
        niirs_mean=worth.niirs_mean,
    )


def uncovered(
    chart: Chart, unseen: dict[str, Polygon | MultiPolygon], reasons: dict[str, str]
) -> tuple[Uncovered, ...]:
    """What the judge found unseen, with the reason where a stage gave one."""
    return tuple(
        Uncovered(
            name,
            tuple(
                tuple(chart.ring(ring) for ring in (part.exterior, *part.interiors))
                for part in (shape.geoms if isinstance(shape, MultiPolygon) else [shape])
            ),
            float(shape.area),
            reasons.get(name, "no footprint sees it"),
        )
        for name, shape in unseen.items()
    )


def fence(chart: Chart, airspace: Airspace, flown: BaseGeometry, lowest_m: float) -> Fence:
    """The operating area and everything hard up to the route's level; with a ceiling what is flown over.

    Fences know no holes: those of the area are zones, and zones are cut through holes that something of
    ``flown`` lies in.

    Parameters
    ----------
    lowest_m
        The lowest altitude flown, over the plan's datum: a base may lie lower than home.
    """
    inclusion = () if airspace.area is None else (_zone(chart, "area", airspace.area),)
    holes = () if airspace.area is None else airspace.area.interiors
    polygons, circles = (
        [_zone(chart, f"hole {k} of the area", Polygon(h)) for k, h in enumerate(holes, 1)],
        [],
    )
    level = chart.level
    home_m = level.altitude_m - level.height_m
    for banded in banded_shapes(airspace, level.amsl_m - level.height_m):
        shape = banded.shape
        if not banded.hard or banded.low_m > level.height_m or banded.high_m < min(lowest_m - home_m, 0.0):
            continue
        ceiling_m = None if banded.high_m >= level.height_m else banded.high_m
        if isinstance(shape, DiscShape):
            centre = chart.lonlats([shape.centre])[0]
            circles.append(ZoneCircle(shape.name, centre, shape.radius_m, ceiling_m=ceiling_m))
        else:
            whole = Polygon(shape.area.exterior)
            parts = without_holes(shape.area) if flown.intersects(whole.difference(shape.area)) else [whole]
            polygons.extend(replace(_zone(chart, shape.name, part), ceiling_m=ceiling_m) for part in parts)
    return Fence(inclusion, tuple(polygons), tuple(circles), home_m)


def _zone(chart: Chart, name: str, area: Polygon) -> ZonePolygon:
    # Reading a ring cut its edges fine; for the autopilot the corners are enough.
    outline = area.exterior.simplify(0.05)
    corners = np.asarray(outline.coords)[:-1, :2]
    return ZonePolygon(name, chart.lonlats(corners))


def _plan_wind(wind: Wind, frame: LocalFrame) -> PlanWind:
    """In still air from nowhere, so from north, however the frame lies."""
    if wind.speed_m_s == 0.0:
        return PlanWind()
    return PlanWind(wind.speed_m_s, round(frame.heading_deg(wind.toward_rad + math.pi), 9) % 360.0)


def assemble(
    name: str,
    chart: Chart,
    model: FlightModel,
    airspace: Airspace,
    suite: Suite,
    ends: tuple[Terminal, Terminal],
    composed: Composed,
    legs: tuple[Leg, ...],
    passes: tuple[CollectPass, ...],
    *,
    metrics: Metrics,
    methods: dict[str, str],
    planner_version: str,
    scenario_hash: str,
    seed: int,
    warnings: tuple[str, ...],
) -> Plan:
    """The plan of one aircraft, not yet judged: without violations and what is uncovered."""
    collects, transits, footprints, photos = collects_and_transits(
        chart, model, airspace, suite, composed, legs, passes
    )
    flight, begin = composed.flight, composed.flight.path.start
    aloft = ends[0].over_home_m is not None
    heading_deg = None if aloft else chart.frame.true_heading_deg(*begin.position, begin.angle_rad)
    path = flown_path(flight, model, metrics.energy_wh, chart.lonlats, chart.straight_edge_m, heading_deg)
    level_m = chart.level.altitude_m
    value = vehicle_value(model.aircraft, composed.finish)
    home, end = chart.lonlats([ends[0].ground, ends[1].position])
    return Plan(
        name=name,
        vehicles=(replace(value, home_altitude_m=level_m - chart.level.height_m) if aloft else value,),
        altitude_m=chart.level.altitude_m,
        altitude_reference=chart.level.reference,
        home=home,
        end=end,
        paths=(path,),
        collects=collects,
        transits=transits,
        footprints=footprints,
        uncovered=(),
        fence=fence(chart, airspace, LineString(flight.path.sample(10.0)[:, :2]), flight.heights.range_m[0]),
        metrics=with_photos(metrics, photos, suite),
        violations=(),
        methods=methods,
        scenario_hash=scenario_hash,
        planner_version=planner_version,
        seed=seed,
        warnings=warnings,
        photos=photos,
        cameras=plan_cameras(suite),
        wind=_plan_wind(model.wind, chart.frame),
    )
