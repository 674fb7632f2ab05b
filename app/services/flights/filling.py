"""Gaps of a flight's record, filled from a log that the vehicle kept aboard or another station recorded.

Times with places of which nothing told whether the sensor was on are gaps, too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from app.services.errors import RefusedError
from app.services.flights.photos import spacing_of
from app.services.records import FlightEvent, TrackSample
from app.services.vehicles.recorder import flight_event
from mavlink.encoding.options import DEFAULT_PAYLOAD
from mavlink.encoding.payload import parse_payload
from mavlink.formats import FormatError
from mavlink.formats.onboard import OnboardLog, Switch, read_log, switch_of
from mavlink.state.track import TrackPoint
from mavlink.wire.geometry import distance_m
from planner.as_flown.track import LONGEST_STEP_S
from planner.errors import Finding

#: A log is of the flight when its places, at the same times, are those of the record to this, half of them
#: and nine of ten: estimates aboard and over the link are the same but for delays.
MATCH_M, MATCH_MOST_M = 25.0, 100.0
#: In so many seconds they are compared at least.
LEAST_COMMON_S = 5.0
#: Where clocks differ, the record's start is known to this; finer steps are tried within.
CLOCK_S, CLOCK_STEP_S = 10.0, 0.1
#: Places taken from a log are no closer together.
INTERVAL_S = 0.2


@dataclass(frozen=True, slots=True)
class Span:
    """A time of the record's clock; ``until_s`` is None where the record ends."""

    from_s: float
    until_s: float | None


@dataclass(frozen=True, slots=True)
class Filling:
    """What a log gives to a record.

    Parameters
    ----------
    clock_s
        What the log's clock is behind the record's.
    filled, left
        Gaps that it fills, and those it does not, with the reason.
    """

    samples: tuple[TrackSample, ...]
    events: tuple[FlightEvent, ...]
    clock_s: float
    filled: tuple[Span, ...]
    left: tuple[tuple[Span, str], ...]

    def json(self) -> dict[str, Any]:
        """As the answer tells."""
        return {
            "clock_s": self.clock_s,
            "points": len(self.samples),
            "photos": len(self.events),
            "filled": [{"start_s": span.from_s, "end_s": span.until_s} for span in self.filled],
            "left": [{"start_s": span.from_s, "end_s": span.until_s, "why": why} for span, why in self.left],
        }


def filling(
    path: str,
    payload_text: str | None,
    samples: Sequence[TrackSample],
    unix_minus_boot_s: float,
    open_end: bool,
) -> Filling:
    """What a log tells of the gaps of a record.

    Parameters
    ----------
    samples
        The record, its sensor as it was switched.
    unix_minus_boot_s
        What the record's clock is behind the world's, to some seconds.
    open_end
        Whether the flight went on when the record had ended.

    Raises
    ------
    RefusedError
        Rules ``log-unreadable`` and ``not-this-flight``.
    """
    payload = DEFAULT_PAYLOAD if payload_text is None else parse_payload(payload_text)
    try:
        log = read_log(Path(path), payload)
    except FormatError as error:
        fix = "Send the .bin, .ulg or .tlog as it is, whole."
        raise RefusedError(
            f"the log is refused: {error}", (Finding("log", "log-unreadable", str(error), fix),)
        ) from error
    clock_s = _clock_s(log, samples, unix_minus_boot_s)
    if clock_s is None:
        message = "its places at the times of the flight are not the flight's, or it has none at those times"
        fix = "Send the log that the vehicle kept of this very flight."
        raise RefusedError(
            f"the log is refused: {message}", (Finding("log", "not-this-flight", message, fix),)
        )
    by_photos = spacing_of(payload_text) is not None
    spans = [] if by_photos else _untold(samples)
    spans += [
        Span(a.time_s, b.time_s)
        for a, b in pairwise(samples)
        if b.time_s - a.time_s > LONGEST_STEP_S
        and not any(span.from_s <= a.time_s < (span.until_s or a.time_s) for span in spans)
    ]
    if open_end:
        spans.append(Span(samples[-1].time_s, None))
    switch = (lambda _: False) if by_photos else switch_of(log, payload)
    made: list[TrackSample] = []
    events: list[FlightEvent] = []
    filled, left = [], []
    for span in spans:
        points, why = _within(log, switch, span, clock_s)
        if why:
            left.append((span, why))
            continue
        filled.append(span)
        made += points
        events += [
            flight_event(photo)
            for photo in log.photos
            if span.from_s < photo.time_s + clock_s and photo.time_s + clock_s < (span.until_s or np.inf)
        ]
    return Filling(tuple(made), tuple(events), clock_s, tuple(filled), tuple(left))


def _untold(samples: Sequence[TrackSample]) -> list[Span]:
    """Times with places, and nothing that tells whether the sensor was on; by one boot each."""
    spans: list[Span] = []
    for k, sample in enumerate(samples):
        before = samples[k - 1] if k and samples[k - 1].time_s < sample.time_s else None
        after = samples[k + 1] if k + 1 < len(samples) and samples[k + 1].time_s > sample.time_s else None
        if sample.sensor_on is not None:
            continue
        from_s = sample.time_s - INTERVAL_S if before is None else before.time_s
        until_s = sample.time_s + INTERVAL_S if after is None else after.time_s
        if spans and before is not None and before.sensor_on is None:
            spans[-1] = Span(spans[-1].from_s, until_s)
        else:
            spans.append(Span(from_s, until_s))
    return spans


def _clock_s(log: OnboardLog, samples: Sequence[TrackSample], unix_minus_boot_s: float) -> float | None:
    """What to add to the log's times: nothing, where both count from one boot, else by the world's clock."""
    candidates = [0.0]
    if log.unix_minus_boot_s is not None:
        about_s = log.unix_minus_boot_s - unix_minus_boot_s
        steps = round(CLOCK_S / CLOCK_STEP_S)
        candidates += [about_s + k * CLOCK_STEP_S for k in range(-steps, steps + 1)]
    scored = [(_away_m(log.points, samples, clock_s), clock_s) for clock_s in candidates]
    fits = [(away_m, clock_s) for away_m, clock_s in scored if away_m is not None]
    if fits and scored[0][0] is not None:
        return 0.0
    return min(fits)[1] if fits else None


def _away_m(points: Sequence[TrackPoint], samples: Sequence[TrackSample], clock_s: float) -> float | None:
    """How far apart log and record are, half of the time; None where that is not one flight."""
    times_s = np.array([point.time_s for point in points]) + clock_s
    common = [s for s in samples if not s.from_log and times_s[0] <= s.time_s <= times_s[-1]]
    if len(common) < 2 or common[-1].time_s - common[0].time_s < LEAST_COMMON_S:
        return None
    asked = common[:: max(len(common) // 200, 1)]
    lons, lats = (np.array([getattr(p, name) for p in points]) for name in ("lon_deg", "lat_deg"))
    at_s = [sample.time_s for sample in asked]
    away_m = [
        distance_m((float(lon), float(lat)), (sample.lon_deg, sample.lat_deg))
        for lon, lat, sample in zip(
            np.interp(at_s, times_s, lons), np.interp(at_s, times_s, lats), asked, strict=True
        )
    ]
    moved_m = distance_m((asked[0].lon_deg, asked[0].lat_deg), (asked[-1].lon_deg, asked[-1].lat_deg)) + max(
        distance_m((s.lon_deg, s.lat_deg), (asked[0].lon_deg, asked[0].lat_deg)) for s in asked
    )
    # Two aircraft that stood at one place the while are not told apart.
    if moved_m < 2.0 * MATCH_M or np.median(away_m) > MATCH_M or np.percentile(away_m, 90) > MATCH_MOST_M:
        return None
    return float(np.median(away_m))


def _within(
    log: OnboardLog, switch: Switch | None, span: Span, clock_s: float
) -> tuple[list[TrackSample], str]:
    """Places of a log in a gap; why not, where it cannot be filled."""
    made: list[TrackSample] = []
    for point in log.points:
        at_s = point.time_s + clock_s
        if at_s <= span.from_s or (span.until_s is not None and at_s >= span.until_s):
            continue
        if switch is None:
            return [], "the log tells nothing of what switches the sensor"
        on = switch(point.time_s)
        if on is None:
            return [], f"the log does not tell whether the sensor was on at {at_s:.1f} s"
        if not made or at_s - made[-1].time_s >= INTERVAL_S or on != made[-1].sensor_on:
            made.append(_sample(point, at_s, on))
    ends = [span.from_s, *(sample.time_s for sample in made)]
    if span.until_s is not None:
        ends.append(span.until_s)
    if not made or max(b - a for a, b in pairwise(ends)) > LONGEST_STEP_S:
        return [], "the log has no places over the whole of it"
    return made, ""


def _sample(point: TrackPoint, time_s: float, on: bool) -> TrackSample:
    return TrackSample(
        time_s=time_s,
        lon_deg=point.lon_deg,
        lat_deg=point.lat_deg,
        altitude_amsl_m=point.amsl_m,
        altitude_home_m=point.relative_m,
        heading_deg=point.heading_deg,
        roll_deg=point.roll_deg,
        ground_speed_m_s=point.ground_speed_m_s,
        mission_seq=None,
        sensor_on=on,
        pitch_deg=point.pitch_deg,
        from_log=True,
    )
