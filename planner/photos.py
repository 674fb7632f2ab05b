"""Cameras and photos as the plan publishes them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from planner.plan import LonLatAlt, Metrics, Photos, PlanCamera
from planner.profile.compose import Composed
from planner.profile.heights import Heights
from planner.route import CollectPass
from planner.sensors.camera import CameraSensor
from planner.sensors.suite import Suite
from planner.vehicle.model import FlightModel

#: Of a length so little more than whole spacings the last is not divided.
ROUNDING_M = 1e-6
#: By less than this part photos may come sooner than a camera is said to take them.
INTERVAL_SPARE = 0.005


def plan_cameras(suite: Suite) -> tuple[PlanCamera, ...]:
    """The cameras on board."""
    return tuple(
        PlanCamera(
            sensor.name,
            sensor.optics.focal_length_m,
            sensor.optics.pixel_pitch_m,
            sensor.optics.columns,
            sensor.optics.rows,
            sensor.forward_overlap,
            sensor.side_overlap,
            math.degrees(sensor.tilt_rad),
            sensor.min_interval_s,
            sensor.trigger,
            sensor.model,
            sensor.spectrum,
        )
        for sensor in suite.sensors
        if isinstance(sensor, CameraSensor)
    )


def intervals(collect: CollectPass) -> int:
    """Between how many equal intervals its photos are taken: as few as its spacing allows."""
    if collect.photo_spacing_m is None:
        raise ValueError("a pass without photos has no intervals")
    return max(math.ceil((collect.length_m - ROUNDING_M) / collect.photo_spacing_m), 1)


def photos_of(
    collect: CollectPass,
    seq: int,
    line: tuple[LonLatAlt, LonLatAlt],
    heights: Heights,
    sensor: CameraSensor,
    model: FlightModel,
) -> Photos | None:
    """The photos of a pass, at equal distances from its first point to its last; None for a video.

    Parameters
    ----------
    line, heights
        Of the pass: its ends, and the altitudes along it.
    """
    if sensor.trigger == "video" or collect.photo_spacing_m is None:
        return None
    count = intervals(collect)
    start, end = np.array(line)
    part = np.linspace(0.0, 1.0, count + 1)
    places = start + part[:, None] * (end - start)
    places[:, 2] = heights.at(part * heights.length_m)
    interval_m = collect.length_m / count
    interval_s = None
    if sensor.trigger == "time":
        speed_m_s = float(model.ground_speed_m_s(collect.angle_rad))
        slow_m_s = math.inf if collect.slow is None else collect.slow.speed_m_s
        interval_s = interval_m / min(speed_m_s, slow_m_s)
    listed = tuple((float(lon), float(lat), float(alt)) for lon, lat, alt in places)
    return Photos(model.name, seq, collect.sensor, listed, interval_m, interval_s)


@dataclass(frozen=True, slots=True)
class TooSoon:
    """A pass on which photos come sooner than its camera takes them.

    Parameters
    ----------
    number
        Of the pass, from 0.
    between_s, least_s
        From one photo to the next, and what the camera takes.
    """

    number: int
    between_s: float
    least_s: float


def too_soon(suite: Suite, composed: Composed, passes: Sequence[CollectPass]) -> tuple[TooSoon, ...]:
    """The passes of a flight on which photos come too soon, as they are flown: from and to the corners."""
    found = []
    for number, (collect, spans_m) in enumerate(zip(passes, composed.passes_m, strict=True)):
        sensor = suite.named(collect.sensor)
        if not isinstance(sensor, CameraSensor) or sensor.trigger == "video":
            continue
        if collect.photo_spacing_m is None:
            continue
        (_, begun_s), (_, ended_s) = (composed.flight.along(at_m) for at_m in spans_m)
        between_s = (ended_s - begun_s) / intervals(collect)
        if between_s < sensor.min_interval_s * (1.0 - INTERVAL_SPARE):
            found.append(TooSoon(number, between_s, sensor.min_interval_s))
    return tuple(found)


def with_photos(metrics: Metrics, photos: Sequence[Photos], suite: Suite) -> Metrics:
    """With how many there are and what they take to be stored; as it is without a camera on board."""
    stored_mb = {
        sensor.name: sensor.stored_mb for sensor in suite.sensors if isinstance(sensor, CameraSensor)
    }
    if not stored_mb:
        return metrics
    return replace(
        metrics,
        photos=sum(len(each.places) for each in photos),
        photos_mb=math.fsum(len(each.places) * stored_mb[each.sensor] for each in photos),
    )
