"""What footprints say of their images' worth, measured again by rays through image or beam."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from shapely.geometry import Polygon

from planner.plan import Collect, Footprint, Plan, Violation
from planner.scenario import Scenario
from planner.sensors.camera import CameraSensor
from planner.sensors.sar import SarSensor

#: The worst is told to this part of itself, plans being rounded; means, sums here and there, to this.
WORST_TOLERANCE, MEAN_TOLERANCE = 1e-4, 1e-3
#: Outlines are known to this: ground that begins beyond it may count or not.
OUTLINE_M = 0.05
#: Rows of the image, and places of the swath, that means are taken over.
ROWS = 2_000


@dataclass(frozen=True, slots=True)
class _Found:
    gsd_m: float | None
    gsd_mean_m: float | None
    niirs: float | None
    niirs_mean: float | None


def footprint_violations(scenario: Scenario, plan: Plan) -> Iterator[Violation]:
    """Footprints whose values are not those measured; of passes that follow the ground none is looked at."""
    collects = {(each.vehicle, each.seq): each for each in plan.collects}
    following = {region.name for region in scenario.regions if region.over_ground_m is not None}
    for footprint in plan.footprints:
        collect = collects.get((footprint.vehicle, footprint.seq))
        if collect is None or following.intersection(collect.regions):
            continue
        found = _measured(scenario, collect, footprint)
        for name, tolerance in (
            ("gsd_m", WORST_TOLERANCE),
            ("niirs", WORST_TOLERANCE),
            ("gsd_mean_m", MEAN_TOLERANCE),
            ("niirs_mean", MEAN_TOLERANCE),
        ):
            said, measured = getattr(footprint, name), [getattr(each, name) for each in found]
            if not measured or None in measured:
                continue
            low, high = min(measured), max(measured)
            off = math.inf if said is None else max(low - said, said - high)
            if off > tolerance * max(abs(low), 1e-3):
                message = f"a footprint of collect {collect.seq} says {name} {said}, it is {low:.6g}"
                where = collect.line[0][:2]
                yield Violation("footprint-quality", footprint.sensor, message, off, "", where, hard=False)


def _measured(scenario: Scenario, collect: Collect, footprint: Footprint) -> list[_Found]:
    """Over terrain with a little less and a little more ground; nothing where the sensor is unknown."""
    sensor, level = scenario.suite.named(footprint.sensor), scenario.level.at(collect.line[0][2])
    drops_m = [(level.height_m, level.height_m)]
    if scenario.terrain is not None:
        to_local = scenario.frame.to_local
        seen = Polygon(to_local(footprint.ring), [to_local(hole) for hole in footprint.holes])
        shapes = (seen.buffer(off_m) for off_m in (-OUTLINE_M, OUTLINE_M))
        ranges_m = [scenario.terrain.range_over(shape) for shape in shapes if not shape.is_empty]
        drops_m = [
            (level.amsl_m - low_m, level.amsl_m - (low_m + high_m) / 2.0) for low_m, high_m in ranges_m
        ]
    known = [each for each in drops_m if not math.isnan(each[1])]
    if isinstance(sensor, CameraSensor):
        return [_of_camera(sensor, *drop_m) for drop_m in known]
    return [_of_radar(sensor, *drop_m) for drop_m in known] if isinstance(sensor, SarSensor) else []


def _of_camera(sensor: CameraSensor, worst_m: float, mean_m: float) -> _Found:
    optics = sensor.optics
    half = optics.rows * optics.pixel_pitch_m / optics.focal_length_m / 2.0
    up = (np.arange(ROWS) + 0.5) / ROWS * 2.0 * half - half
    off = np.arctan(np.append(up, [-half, half])) + sensor.tilt_rad
    # Equations 4 and 5 by slant range and depression; a pixel's ground is along times across.
    pixel = optics.pixel_pitch_m / optics.focal_length_m * np.cos(off - sensor.tilt_rad)
    across = pixel / np.cos(off)
    along = across * np.cos(off - sensor.tilt_rad) / np.cos(off)
    gsd, ground = (along + across) / 2.0, (along * across)[:ROWS]
    most_m = float(gsd.max()) * worst_m
    mean = float((gsd[:ROWS] * ground).sum() / ground.sum()) * mean_m
    if sensor.quality is None:
        return _Found(most_m, mean, None, None)
    niirs = np.array([sensor.quality.niirs(float(each) * mean_m) for each in gsd[:ROWS]])
    return _Found(most_m, mean, sensor.quality.niirs(most_m), float((niirs * ground).sum() / ground.sum()))


def _of_radar(sensor: SarSensor, worst_m: float, mean_m: float) -> _Found:
    half_rad = sensor.elevation_beamwidth_rad / 2.0
    edges = np.tan([sensor.incidence_rad - half_rad, sensor.incidence_rad + half_rad])
    out = edges[0] + (np.arange(ROWS) + 0.5) / ROWS * (edges[1] - edges[0])

    def niirs(outward: np.ndarray[tuple[int], np.dtype[np.float64]], height_m: float) -> float:
        down = np.arctan2(1.0, outward)
        each = 5.606 - 0.763 * height_m * np.hypot(outward, 1.0) / 1000.0 + 3.657 * down - 3.422 * down**2
        return float(each.min() if len(each) == 2 else each.mean())

    return _Found(None, None, niirs(edges, worst_m), niirs(out, mean_m))
