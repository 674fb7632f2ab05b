"""The ground really seen: a flown track with its sensor intervals, to what of each region was covered."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from shapely import difference, intersection, union_all
from shapely.geometry import LineString, MultiPoint, Polygon
from shapely.geometry.base import BaseGeometry

from planner.environment.terrain import Ground
from planner.plan import Collect, Plan
from planner.scenario import Scenario
from planner.sensors.sar import SarSensor
from planner.sensors.view import seen_beside

#: A beam lifted to within this of the horizon by bank sees no farther.
MAX_LOOK_RAD = math.radians(85.0)
#: Footprints are built of slices this long along the track.
SLICE_M = 10.0
#: Overlays are done on a grid: without one, outlines equal but for rounding can be taken for disjoint.
GRID_M = 1e-6


@dataclass(frozen=True, slots=True)
class TrackSample:
    """Where the aircraft was, and whether the sensor was on.

    ``height_m`` is over the ground, on terrain over home; ``roll_deg`` is positive with the right wing down.
    """

    time_s: float
    lon_deg: float
    lat_deg: float
    height_m: float
    roll_deg: float
    sensor_on: bool


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
    """What was seen at full resolution, in the scenario's local frame."""

    fraction: dict[str, float]
    seen: dict[str, BaseGeometry]
    unseen: dict[str, BaseGeometry]
    passes: tuple[FlownPass, ...]


def flown_coverage(scenario: Scenario, plan: Plan, track: Sequence[TrackSample]) -> FlownCoverage:
    """Ground seen along a track.

    A point is seen at full resolution when the beam lay on it over a whole synthetic aperture (eqs 4 and 5 of
    Li et al. 2018): half an aperture after sensor on to half an aperture before sensor off. The beam's edges
    move with the aircraft's height and bank.
    """
    strips: dict[str, list[Polygon]] = {}
    passes: list[FlownPass] = []
    for interval in _intervals(track):
        places = scenario.frame.to_local([(s.lon_deg, s.lat_deg) for s in interval])
        collect = _nearest_collect(scenario, plan, places)
        if collect is None:
            continue
        sensor = next(s for s in scenario.sensors if s.name == collect.sensor)
        strips.setdefault(collect.sensor, []).extend(
            _strip(sensor, collect.look, places, interval, scenario.terrain, scenario.home_amsl_m or 0.0)
        )
        passes.append(_pass(scenario, collect, places))
    seen_by = {name: union_all(parts, grid_size=GRID_M) for name, parts in strips.items()}
    fraction, seen, unseen = {}, {}, {}
    for region in scenario.regions:
        ground = seen_by.get(scenario.sensor_for(region).name, Polygon())
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


def _nearest_collect(scenario: Scenario, plan: Plan, places: NDArray[np.float64]) -> Collect | None:
    """The collect that an interval flew: the nearest line in the nearest direction."""
    flown_rad = math.atan2(*(places[-1] - places[0])[::-1])
    best: tuple[float, Collect] | None = None
    for collect in plan.collects:
        first, last = scenario.frame.to_local([p[:2] for p in collect.line])
        off_rad = abs(math.remainder(math.atan2(*(last - first)[::-1]) - flown_rad, math.tau))
        if off_rad > math.radians(45.0):
            continue
        line = LineString([first, last])
        distance_m = max(line.distance(p) for p in MultiPoint(places[[0, len(places) // 2, -1]]).geoms)
        if best is None or distance_m < best[0]:
            best = (distance_m, collect)
    return None if best is None else best[1]


def _strip(
    sensor: SarSensor,
    look: str,
    places: NDArray[np.float64],
    samples: Sequence[TrackSample],
    ground: Ground | None,
    home_amsl_m: float,
) -> Iterable[Polygon]:
    """Slices of ground seen at full resolution, each between two places of the track."""
    along_m = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(places, axis=0).T))])
    mean_height_m = float(np.mean([s.height_m for s in samples]))
    half_m = sensor.aperture_m(mean_height_m) / 2.0
    if along_m[-1] <= 2.0 * half_m:
        return
    count = max(2, math.ceil((along_m[-1] - 2.0 * half_m) / SLICE_M) + 1)
    at_m = np.linspace(half_m, along_m[-1] - half_m, count)
    centre = np.stack([np.interp(at_m, along_m, places[:, k]) for k in (0, 1)], axis=1)
    ahead = np.stack(
        [
            np.interp(at_m + half_m, along_m, places[:, k]) - np.interp(at_m - half_m, along_m, places[:, k])
            for k in (0, 1)
        ],
        axis=1,
    )
    ahead /= np.hypot(ahead[:, 0], ahead[:, 1])[:, None]
    sign = 1.0 if look == "right" else -1.0
    side = np.stack([ahead[:, 1], -ahead[:, 0]], axis=1) * sign
    height_m = np.interp(at_m, along_m, [s.height_m for s in samples])
    # Right wing down turns a right-looking beam towards the nadir, a left-looking one towards the horizon.
    roll_rad = np.interp(at_m, along_m, [math.radians(s.roll_deg) for s in samples]) * sign
    if ground is not None:
        yield from _slices(sensor, ground, at_m, centre, ahead, side, height_m + home_amsl_m, roll_rad)
        return
    edges = []
    for half_beam_rad in (-sensor.elevation_beamwidth_rad / 2.0, sensor.elevation_beamwidth_rad / 2.0):
        look_rad = np.clip(sensor.incidence_rad + half_beam_rad - roll_rad, 0.0, MAX_LOOK_RAD)
        # A squinted beam sees ground at slant range R abeam R·tan ahead.
        lead_m = height_m / np.cos(look_rad) * math.tan(sensor.squint_rad)
        edges.append(centre + side * (height_m * np.tan(look_rad))[:, None] + ahead * lead_m[:, None])
    near, far = edges
    for (near0, far0), (near1, far1) in pairwise(zip(near, far, strict=True)):
        hull = MultiPoint([near0, near1, far1, far0]).convex_hull
        if isinstance(hull, Polygon):
            yield hull


def _slices(
    sensor: SarSensor,
    ground: Ground,
    at_m: NDArray[np.float64],
    centre: NDArray[np.float64],
    ahead: NDArray[np.float64],
    side: NDArray[np.float64],
    level_m: NDArray[np.float64],
    roll_rad: NDArray[np.float64],
) -> Iterable[Polygon]:
    """The same on terrain, without what it hides: one slice half-way between each two places."""
    half_beam_rad = sensor.elevation_beamwidth_rad / 2.0
    for k in range(len(at_m) - 1):
        here = [(values[k] + values[k + 1]) / 2.0 for values in (centre, ahead, side, level_m, roll_rad)]
        middle, forward, outward, level, roll = here
        looks_rad = [sensor.incidence_rad + sign * half_beam_rad - roll for sign in (-1.0, 1.0)]
        near_tan, far_tan = (math.tan(min(max(float(angle), 0.0), MAX_LOOK_RAD)) for angle in looks_rad)
        # Neighbouring slices of a weaving track are to touch.
        half_m = (at_m[k + 1] - at_m[k]) / 2.0 * 1.02
        pose = np.concatenate([middle, forward / np.hypot(*forward), outward / np.hypot(*outward)])
        squint = math.tan(sensor.squint_rad)
        yield from seen_beside(pose, float(half_m), float(level), (near_tan, far_tan), squint, ground)


def _pass(scenario: Scenario, collect: Collect, places: NDArray[np.float64]) -> FlownPass:
    first, last = scenario.frame.to_local([p[:2] for p in collect.line])
    direction = (last - first) / np.hypot(*(last - first))
    offset = places - first
    across_m = np.abs(offset[:, 0] * direction[1] - offset[:, 1] * direction[0])
    length_m = float(np.hypot(*np.diff(places, axis=0).T).sum())
    return FlownPass(
        collect.seq, collect.roi, float(np.percentile(across_m, 95)), float(across_m.max()), length_m
    )
