"""A sensor that is a camera: its photos tell when it worked, and which of a pass are missing.

A shutter order is no photo. Where the payload takes pictures at a distance or an interval, the sensor counts
as on from the first to the last photo of a run, and a run ends where a photo is missing.
"""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from app.services.records import FlightEvent, TrackSample
from mavlink.encoding.payload import CameraPayload, ImagePayload, TriggerPayload, parse_payload, parts_of
from mavlink.wire.geometry import distance_m

#: Further apart than this times the spacing: a photo is missing between two.
MISSING_PART = 1.5


@dataclass(frozen=True, slots=True)
class Spacing:
    """How far apart photos are ordered: in metres or in seconds, the other is None."""

    distance_m: float | None = None
    interval_s: float | None = None

    def at(self, speed_m_s: float) -> float:
        """In metres, at a speed over ground."""
        if self.distance_m is not None:
            return self.distance_m
        return (self.interval_s or 0.0) * speed_m_s

    def missing(self, before: FlightEvent, after: FlightEvent) -> bool:
        """Whether a photo is missing between two."""
        if self.interval_s is not None:
            return not 0.0 <= after.time_s - before.time_s <= MISSING_PART * self.interval_s
        here, there = place_of(before), place_of(after)
        if here is None or there is None or after.time_s < before.time_s:
            return True
        return distance_m(here, there) > MISSING_PART * (self.distance_m or math.inf)


def spacing_of(payload: str | None) -> Spacing | None:
    """The spacing of a payload's photos; None when it takes none."""
    for part in () if payload is None else parts_of(parse_payload(payload)):
        match part:
            case CameraPayload(distance_m=spacing) | TriggerPayload(by="distance", spacing=float(spacing)):
                return Spacing(distance_m=spacing)
            case ImagePayload(interval_s=spacing) | TriggerPayload(by="time", spacing=float(spacing)):
                return Spacing(interval_s=spacing)
    return None


def photos_of(events: Sequence[FlightEvent]) -> tuple[FlightEvent, ...]:
    """The photos among a flight's events, in order of time."""
    photos = [event for event in events if event.kind == "photo" and place_of(event) is not None]
    return tuple(sorted(photos, key=lambda photo: photo.time_s))


def place_of(event: FlightEvent) -> tuple[float, float] | None:
    """Longitude and latitude in degrees; None where it is not known."""
    return None if event.lon_deg is None or event.lat_deg is None else (event.lon_deg, event.lat_deg)


def switched_by_photos(
    samples: Sequence[TrackSample], photos: Sequence[FlightEvent], spacing: Spacing
) -> tuple[TrackSample, ...]:
    """The track with the sensor on where photos were taken one after the other.

    Each run of photos begins and ends with a sample of its own, where the camera says it was. Without any
    photo nobody knows of any.
    """
    made = list(samples)
    if not photos:
        return tuple(replace(sample, sensor_on=None) for sample in made)
    times_s = [sample.time_s for sample in made]
    on = [False] * len(made)
    added: list[TrackSample] = []
    runs = _runs(photos, spacing)
    for run in runs:
        first = bisect_left(times_s, run[0].time_s)
        while first < len(made) and times_s[first] <= run[-1].time_s:
            on[first] = True
            first += 1
        if made and len(run) > 1:
            added += [_sample(made, times_s, photo) for photo in (run[0], run[-1])]
    for before, after in pairwise(runs):
        # Two runs are two where the track has no place between them, either.
        ended_s, begins_s = before[-1].time_s, after[0].time_s
        if made and bisect_right(times_s, ended_s) >= bisect_left(times_s, begins_s):
            end, begin = (_sample(made, times_s, photo) for photo in (before[-1], after[0]))
            east_deg = math.remainder(begin.lon_deg - end.lon_deg, 360.0)
            added.append(
                replace(
                    end,
                    time_s=(ended_s + begins_s) / 2.0,
                    lon_deg=math.remainder(end.lon_deg + east_deg / 2.0, 360.0),
                    lat_deg=(end.lat_deg + begin.lat_deg) / 2.0,
                    sensor_on=False,
                )
            )
    whole = [replace(sample, sensor_on=is_on) for sample, is_on in zip(made, on, strict=True)]
    return tuple(sorted([*whole, *added], key=lambda sample: sample.time_s))


def _runs(photos: Sequence[FlightEvent], spacing: Spacing) -> list[list[FlightEvent]]:
    runs: list[list[FlightEvent]] = []
    for photo in photos:
        if runs and not spacing.missing(runs[-1][-1], photo):
            runs[-1].append(photo)
        else:
            runs.append([photo])
    return runs


def _sample(samples: Sequence[TrackSample], times_s: Sequence[float], photo: FlightEvent) -> TrackSample:
    """The nearest sample in time, moved to where and when a photo was taken."""
    at = bisect_left(times_s, photo.time_s)
    near = min(samples[max(at - 1, 0) : at + 1], key=lambda sample: abs(sample.time_s - photo.time_s))
    place = place_of(photo)
    assert place is not None
    return replace(near, time_s=photo.time_s, lon_deg=place[0], lat_deg=place[1], sensor_on=True)
