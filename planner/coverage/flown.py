"""The ground really seen: a flown track with its sensor intervals, to what of each region was covered."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from shapely import difference, intersection, union_all
from shapely.geometry import LineString, MultiPoint, Polygon
from shapely.geometry.base import BaseGeometry

from planner.airspace.airspace import Airspace
from planner.coverage.flown_ground import Flown, ground_seen
from planner.frames import LocalFrame
from planner.plan import Collect, Plan
from planner.sensors.sar import SarSensor
from planner.sensors.suite import Suite
from planner.vehicle.aircraft import Aircraft
from planner.vehicle.model import FlightModel
from planner.wishes import Region

#: Overlays are done on a grid: without one, outlines equal but for rounding can be taken for disjoint.
GRID_M = 1e-6


@dataclass(frozen=True, slots=True)
class TrackSample:
    """Where the aircraft was, and whether the sensor was on.

    ``height_m`` is over the ground, on terrain over home; ``roll_deg`` is positive with the right wing down;
    ``heading_deg`` is where the nose points, clockwise from true north, None where unknown.
    """

    time_s: float
    lon_deg: float
    lat_deg: float
    height_m: float
    roll_deg: float
    sensor_on: bool
    heading_deg: float | None = None


@dataclass(frozen=True, slots=True)
class Asked:
    """What was to be seen, with what, where."""

    frame: LocalFrame
    regions: tuple[Region, ...]
    suite: Suite
    aircraft: tuple[Aircraft, ...]
    airspace: Airspace


@dataclass(frozen=True, slots=True)
class FlownPass:
    """How well one collect was flown: distance from its line while the sensor was on."""

    seq: int
    roi: str
    cross_track_p95_m: float
    cross_track_max_m: float
    sensor_on_m: float


@dataclass(frozen=True, slots=True)
class FlownCoverage:
    """What was seen at full resolution, in the local frame."""

    fraction: dict[str, float]
    seen: dict[str, BaseGeometry]
    unseen: dict[str, BaseGeometry]
    passes: tuple[FlownPass, ...]


def flown_coverage(asked: Asked, plan: Plan, track: Sequence[TrackSample]) -> FlownCoverage:
    """Ground seen along a track.

    A point is seen at full resolution when the beam lay on it over a whole synthetic aperture (eqs 4 and 5 of
    Li et al. 2018): half an aperture after sensor on to half an aperture before sensor off. The beam's edges
    move with the aircraft's height and bank, and with its nose where the antenna is fixed to it. In spotlight
    the spot is seen where the line of sight to it turned as far as its resolution asks.
    """
    strips: dict[str, list[Polygon]] = {}
    passes: list[FlownPass] = []
    for interval in _intervals(track):
        places = asked.frame.to_local([(s.lon_deg, s.lat_deg) for s in interval])
        collect = _nearest_collect(asked, plan, places)
        if collect is None:
            continue
        sensor = asked.suite.named(collect.sensor)
        if isinstance(sensor, SarSensor):
            # What other sensors saw as flown is not known, so it is not seen.
            flown = _flown(asked, sensor, collect, places, interval)
            strips.setdefault(collect.sensor, []).extend(ground_seen(flown))
        passes.append(_pass(asked, collect, places))
    seen_by = {name: union_all(parts, grid_size=GRID_M) for name, parts in strips.items()}
    fraction, seen, unseen = {}, {}, {}
    for region in asked.regions:
        ground = seen_by.get(asked.suite.of(region).name, Polygon())
        seen[region.name] = intersection(region.area, ground, grid_size=GRID_M)
        unseen[region.name] = difference(region.area, ground, grid_size=GRID_M)
        fraction[region.name] = float(seen[region.name].area / region.area.area)
    return FlownCoverage(fraction, seen, unseen, tuple(sorted(passes, key=lambda p: p.seq)))


def _intervals(track: Sequence[TrackSample]) -> Iterable[list[TrackSample]]:
    """Runs of samples with the sensor on, of at least two distinct places."""
    run: list[TrackSample] = []
    for sample in track:
        if sample.sensor_on:
            if not run or (sample.lon_deg, sample.lat_deg) != (run[-1].lon_deg, run[-1].lat_deg):
                run.append(sample)
            continue
        if len(run) > 1:
            yield run
        run = []
    if len(run) > 1:
        yield run


def _nearest_collect(asked: Asked, plan: Plan, places: NDArray[np.float64]) -> Collect | None:
    """The collect that an interval flew: the nearest line in the nearest direction."""
    flown_rad = math.atan2(*(places[-1] - places[0])[::-1])
    best: tuple[float, Collect] | None = None
    for collect in plan.collects:
        first, last = asked.frame.to_local([p[:2] for p in collect.line])
        off_rad = abs(math.remainder(math.atan2(*(last - first)[::-1]) - flown_rad, math.tau))
        if off_rad > math.radians(45.0):
            continue
        line = LineString([first, last])
        distance_m = max(line.distance(p) for p in MultiPoint(places[[0, len(places) // 2, -1]]).geoms)
        if best is None or distance_m < best[0]:
            best = (distance_m, collect)
    return None if best is None else best[1]


def _flown(
    asked: Asked,
    sensor: SarSensor,
    collect: Collect,
    places: NDArray[np.float64],
    samples: Sequence[TrackSample],
) -> Flown:
    """One interval in the local frame, matched to its collect."""
    aircraft = next(a for a in asked.aircraft if a.name == collect.vehicle)
    model = FlightModel.of(aircraft, asked.airspace.wind)
    middle = places[len(places) // 2]
    # Where north is on the interval's map; it changes little along one pass.
    north_rad = asked.frame.angle_rad(float(middle[0]), float(middle[1]), 0.0)
    headings_deg = [math.nan if s.heading_deg is None else s.heading_deg for s in samples]
    return Flown(
        sensor.in_wind(model.drift, model.wind.toward_rad),
        collect.look,
        asked.frame.to_local([place[:2] for place in collect.line]),
        places,
        np.array([s.height_m for s in samples]),
        np.radians([s.roll_deg for s in samples]),
        north_rad - np.radians(headings_deg),
        asked.airspace.terrain,
        asked.airspace.home_amsl_m or 0.0,
    )


def _pass(asked: Asked, collect: Collect, places: NDArray[np.float64]) -> FlownPass:
    first, last = asked.frame.to_local([p[:2] for p in collect.line])
    direction = (last - first) / np.hypot(*(last - first))
    offset = places - first
    across_m = np.abs(offset[:, 0] * direction[1] - offset[:, 1] * direction[0])
    length_m = float(np.hypot(*np.diff(places, axis=0).T).sum())
    return FlownPass(
        collect.seq, collect.roi, float(np.percentile(across_m, 95)), float(across_m.max()), length_m
    )
