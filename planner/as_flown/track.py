"""The record of a flight: where the aircraft was, and where nobody knows."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from planner.as_flown.limits import MAX_TRIM_RAD
from planner.as_flown.photo import Photo
from planner.frames import LocalFrame

Floats = NDArray[np.float64]

#: Between two places further apart in time than this, and than three times the record's own step, nothing is
#: known; records are no sparser than the second. At 20 m/s it is a third of the aperture of Li et al. (2018).
LONGEST_STEP_S, LONGEST_STEPS, LONGEST_AT_ALL_S = 2.0, 3.0, 5.0
#: Two places that no aircraft of this many times the speed reaches from each other are not of one line.
JUMP_SPEEDS, JUMP_M = 3.0, 50.0
#: Where the aircraft is not known, no place is too far from another.
ANY_SPEED_M_S = 1e6
NO_MOUNT = (math.nan, math.nan, math.nan)


@dataclass(frozen=True, slots=True)
class TrackSample:
    """Where the aircraft was, and whether the sensor was on; None where nothing told of it.

    ``height_m`` is over the home that the aircraft took off from; ``roll_deg`` is positive with the right
    wing down, ``pitch_deg`` with the nose up; ``heading_deg`` is where the nose points, clockwise from true
    north, None where unknown. Without a roll (NaN) nothing is seen; without a pitch it counts as level.
    ``mount_deg`` are roll, pitch up from the horizon and yaw from true north of what a gimbal holds; None
    where none told.
    """

    time_s: float
    lon_deg: float
    lat_deg: float
    height_m: float
    roll_deg: float
    sensor_on: bool | None
    heading_deg: float | None = None
    pitch_deg: float | None = None
    mount_deg: tuple[float, float, float] | None = None


@dataclass(frozen=True, slots=True)
class Gap:
    """A time of which nothing is recorded.

    Parameters
    ----------
    start_s, end_s
        By the record's clock; ``end_s`` is None where the record ends while the aircraft flies on.
    duration_s
        None where nobody knows: the clock began anew, or the record has no end.
    places
        Longitude and latitude before and after; the second is None where the record has no end.
    """

    start_s: float
    end_s: float | None
    duration_s: float | None
    places: tuple[tuple[float, float], tuple[float, float] | None]


@dataclass(frozen=True, slots=True)
class Record:
    """What was recorded of one flight of one aircraft.

    Parameters
    ----------
    samples
        In order; the time goes back only where the aircraft's clock began anew.
    vehicle
        Its name in the plan; None for any.
    gap_after
        Where the flight went on when the record had ended.
    photos
        Those that a camera or its autopilot reported as taken, in order of time.
    sortie
        Which of the vehicle's flights in the plan, from 1; None for any: its own passes alone count.
    """

    samples: tuple[TrackSample, ...]
    vehicle: str | None = None
    gap_after: Gap | None = None
    photos: tuple[Photo, ...] = ()
    sortie: int | None = None

    def flies(self, vehicle: str, sortie: int) -> bool:
        """Whether it is flown for the passes of a vehicle's sortie."""
        return self.vehicle is None or (self.vehicle == vehicle and self.sortie in (None, sortie))

    def higher(self, more_m: float) -> Self:
        """The same with heights that count from so much lower."""
        if more_m == 0.0:
            return self
        return replace(
            self,
            samples=tuple(replace(each, height_m=each.height_m + more_m) for each in self.samples),
            photos=tuple(replace(each, height_m=each.height_m + more_m) for each in self.photos),
        )


@dataclass(frozen=True, slots=True)
class Line:
    """A record in a local frame, one row a sample; rows of one ``piece`` follow each other without a gap.

    ``sensor_told`` is where something told whether the sensor was on, which it is nowhere else.
    ``pitch_rad`` counts from the attitude that the aircraft cruises with; ``mount_rad`` (N, 3) are a gimbal's
    roll, pitch and yaw, NaN where untold.
    """

    time_s: Floats
    places: Floats
    height_m: Floats
    roll_rad: Floats
    pitch_rad: Floats
    heading_rad: Floats
    sensor_on: NDArray[np.bool_]
    sensor_told: NDArray[np.bool_]
    piece: NDArray[np.int64]
    mount_rad: Floats

    @classmethod
    def of(cls, record: Record, frame: LocalFrame, speed_m_s: float, levelled: bool = False) -> Self:
        """The line of a record flown at a speed over the ground at most; ``levelled``: without pitch."""
        samples = record.samples
        pitch_rad = np.radians([0.0 if s.pitch_deg is None else s.pitch_deg for s in samples])
        on = np.array([bool(s.sensor_on) for s in samples], dtype=bool)
        trim_rad = float(np.median(pitch_rad[on])) if on.any() else 0.0
        places = frame.to_local(np.array([(s.lon_deg, s.lat_deg) for s in samples]).reshape(-1, 2))
        time_s = np.array([s.time_s for s in samples])
        broken = gaps_in(time_s, places, speed_m_s)
        return cls(
            time_s,
            places,
            np.array([s.height_m for s in samples]),
            np.radians([s.roll_deg for s in samples]),
            0.0 * pitch_rad if levelled else pitch_rad - min(max(trim_rad, -MAX_TRIM_RAD), MAX_TRIM_RAD),
            np.radians([np.nan if s.heading_deg is None else s.heading_deg for s in samples]),
            on,
            np.array([s.sensor_on is not None for s in samples], dtype=bool),
            np.concatenate([[0], np.cumsum(broken)]) if len(samples) else np.zeros(0, dtype=np.int64),
            np.radians(np.array([s.mount_deg or NO_MOUNT for s in samples]).reshape(-1, 3)),
        )

    def nearest(self, times_s: Sequence[float]) -> NDArray[np.bool_]:
        """The samples nearest in time to some moments, (N,)."""
        found = np.zeros(len(self.time_s), dtype=bool)
        if len(found) and len(times_s):
            wanted_s = np.asarray(times_s)[:, None]
            order = np.argsort(self.time_s)
            behind = np.clip(np.searchsorted(self.time_s[order], wanted_s[:, 0]), 1, max(len(found) - 1, 1))
            pairs = order[np.clip(np.stack([behind - 1, behind], axis=1), 0, len(found) - 1)]
            closest = np.abs(self.time_s[pairs] - wanted_s).argmin(axis=1)
            found[pairs[np.arange(len(pairs)), closest]] = True
        return found

    def pieces(self) -> NDArray[np.bool_]:
        """Which steps from one sample to the next are recorded."""
        recorded: NDArray[np.bool_] = self.piece[1:] == self.piece[:-1]
        return recorded


def gaps_in(time_s: Floats, places: Floats, speed_m_s: float) -> NDArray[np.bool_]:
    """Which steps of a record are gaps: too long, back in time, or further than the aircraft flies."""
    steps_s = np.diff(time_s)
    known = steps_s[steps_s > 0.0]
    usual_s = float(np.median(known)) if len(known) else 0.0
    longest_s = min(max(LONGEST_STEP_S, LONGEST_STEPS * usual_s), LONGEST_AT_ALL_S)
    moved_m = np.hypot(*np.diff(places, axis=0).T)
    jumped = moved_m > JUMP_SPEEDS * speed_m_s * np.maximum(steps_s, 0.0) + JUMP_M
    found: NDArray[np.bool_] = (steps_s > longest_s) | (steps_s < 0.0) | jumped
    return found


def gaps_of(samples: Sequence[TrackSample], line: Line) -> tuple[Gap, ...]:
    """The gaps within a record."""
    found = []
    for k in np.flatnonzero(~line.pieces()).tolist():
        before, after = samples[k], samples[k + 1]
        lasted_s = after.time_s - before.time_s
        there = ((before.lon_deg, before.lat_deg), (after.lon_deg, after.lat_deg))
        found.append(Gap(before.time_s, after.time_s, lasted_s if lasted_s >= 0.0 else None, there))
    return tuple(found)


def silences(record: Record) -> tuple[Gap, ...]:
    """The gaps of a record by itself, whatever was flown: places further apart in time than it is dense."""
    if not record.samples:
        return () if record.gap_after is None else (record.gap_after,)
    first = record.samples[0]
    line = Line.of(record, LocalFrame(first.lon_deg, first.lat_deg), ANY_SPEED_M_S)
    return gaps_of(record.samples, line) + (() if record.gap_after is None else (record.gap_after,))
