"""Moments at which a camera looked: reported photos, or places of the line as flown."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from planner.as_flown.mount import in_gimbal
from planner.as_flown.passes import PlannedPass, courses
from planner.as_flown.photo import Photo
from planner.as_flown.track import LONGEST_STEP_S, Line, Record
from planner.frames import LocalFrame

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Frames:
    """Moments in the local frame, one row each, N of them; NaN where unknown.

    Parameters
    ----------
    places, height_m
        East and north, (N, 2); over the ground, on terrain over home.
    roll_rad, pitch_rad, yaw_rad, of_camera
        Attitude, yaw clockwise from the local frame's north; whether it is the camera's own.
    course_rad
        Of the track, like yaw.
    row
        The pass they belong to; −1 for none.
    index
        In the camera's count.
    """

    time_s: Floats
    places: Floats
    height_m: Floats
    roll_rad: Floats
    pitch_rad: Floats
    yaw_rad: Floats
    of_camera: NDArray[np.bool_]
    course_rad: Floats
    row: NDArray[np.int64]
    index: Floats

    def chosen(self, which: NDArray[np.bool_]) -> Self:
        """Some of them."""
        return type(self)(
            self.time_s[which], self.places[which], self.height_m[which], self.roll_rad[which],
            self.pitch_rad[which], self.yaw_rad[which], self.of_camera[which], self.course_rad[which],
            self.row[which], self.index[which],
        )  # fmt: skip


def frames_of(record: Record, line: Line, in_pass: NDArray[np.int64], frame: LocalFrame) -> Frames:
    """The reported photos of a record; what one does not tell of its attitude the track tells."""
    photos = record.photos
    count = len(photos)
    time_s = np.array([photo.time_s for photo in photos])
    places = frame.to_local(np.array([(p.lon_deg, p.lat_deg) for p in photos]).reshape(-1, 2))
    told = np.array([_angles(photo) for photo in photos]).reshape(-1, 3)
    yaw_rad = told[:, 2] + _north_rad(places, frame)
    flown = _Flown.of(record, line, frame)
    rows, share = flown.at(time_s)
    between = flown.angles(rows, share)
    own = ~np.isnan(told).any(axis=1)
    near = np.where(share < 0.5, rows, np.minimum(rows + 1, max(len(line.places) - 1, 0)))
    known = rows >= 0
    return Frames(
        time_s,
        places,
        np.array([photo.height_m for photo in photos]),
        np.where(own, told[:, 0], between[:, 0]),
        np.where(own, told[:, 1], between[:, 1]),
        np.where(own, yaw_rad, between[:, 2]),
        np.where(own, [photo.attitude_of == "camera" for photo in photos], flown.hung(rows)).astype(bool),
        flown.course(rows, near),
        np.where(known, in_pass[near] if len(in_pass) else -1, -1) if count else np.zeros(0, dtype=np.int64),
        np.array([math.nan if photo.index is None else float(photo.index) for photo in photos]),
    )


def frames_on(
    record: Record, line: Line, planned: PlannedPass, row: int, run: slice, at_m: Floats, frame: LocalFrame
) -> Frames:
    """Moments at which a run of the track was so far along its pass.

    Parameters
    ----------
    run
        Rows of the line, flown without a gap along the pass.
    """
    along_m = planned.along_m(line.places[run])
    rising = np.concatenate([[True], np.diff(along_m) > 0.0])
    rows = np.arange(run.start, run.stop)[rising]
    along_m = along_m[rising]
    at_m = at_m[(at_m >= along_m[0]) & (at_m <= along_m[-1])] if len(rows) > 1 else np.zeros(0)
    flown = _Flown.of(record, line, frame)

    def between(values: Floats) -> Floats:
        return np.asarray(np.interp(at_m, along_m, values[rows]))

    time_s = between(line.time_s)
    at, share = flown.at(time_s)
    angles = flown.angles(at, share)
    places = np.stack([between(line.places[:, k]) for k in (0, 1)], axis=1)
    course = flown.course_of[rows]
    near = np.clip(np.searchsorted(along_m, at_m), 0, max(len(rows) - 1, 0))
    return Frames(
        time_s, places, between(line.height_m), angles[:, 0], angles[:, 1], angles[:, 2],
        flown.hung(at), course[near] if len(rows) else np.zeros(0),
        np.full(len(at_m), row, dtype=np.int64), np.full(len(at_m), np.nan),
    )  # fmt: skip


@dataclass(frozen=True, slots=True)
class _Flown:
    """The track's attitude as it was recorded, (M, 3), and its course, clockwise from the frame's north.

    Where a gimbal told its own, (M,), it is that.
    """

    line: Line
    attitude: Floats
    of_gimbal: NDArray[np.bool_]
    course_of: Floats

    @classmethod
    def of(cls, record: Record, line: Line, frame: LocalFrame) -> Self:
        samples = record.samples
        rows = [(s.roll_deg, _nan(s.pitch_deg), _nan(s.heading_deg)) for s in samples]
        attitude = np.radians(np.array(rows, dtype=np.float64).reshape(-1, 3))
        told = in_gimbal(line)
        attitude[told] = line.mount_rad[told]
        attitude[:, 2] += _north_rad(line.places, frame)
        course = courses(line)
        course_rad = np.where((course != 0.0).any(axis=1), np.arctan2(course[:, 0], course[:, 1]), np.nan)
        return cls(line, attitude, told, course_rad)

    def at(self, time_s: Floats) -> tuple[NDArray[np.int64], Floats]:
        """The sample before each moment, −1 where none is near enough, and how far on to the next it is."""
        told = self.line.time_s
        if not len(told) or not len(time_s):
            return np.full(len(time_s), -1, dtype=np.int64), np.zeros(len(time_s))
        order = np.argsort(told, kind="stable")
        after = np.searchsorted(told[order], time_s, side="right")
        first, second = (np.clip(after - k, 0, len(told) - 1) for k in (1, 0))
        rows, nexts = order[first], order[second]
        step_s = told[nexts] - told[rows]
        share = np.divide(time_s - told[rows], step_s, out=np.zeros(len(time_s)), where=step_s > 0.0)
        joined = (nexts == rows + 1) & (self.line.piece[rows] == self.line.piece[nexts])
        near = np.minimum(np.abs(time_s - told[rows]), np.abs(time_s - told[nexts])) <= LONGEST_STEP_S
        share = np.clip(np.where(joined, share, np.round(np.clip(share, 0.0, 1.0))), 0.0, 1.0)
        rows = np.where(joined | (share < 0.5), rows, nexts)
        return np.where(near, rows, -1), np.where(joined, share, 0.0)

    def angles(self, rows: NDArray[np.int64], share: Floats) -> Floats:
        """Attitude between samples, (N, 3)."""
        if not len(rows) or not len(self.attitude):
            return np.full((len(rows), 3), np.nan)
        first = self.attitude[rows]
        second = self.attitude[np.minimum(rows + 1, len(self.attitude) - 1)]
        step = np.mod(second - first + math.pi, math.tau) - math.pi
        # Between an airframe's attitude and a gimbal's there is nothing.
        after = np.minimum(rows + 1, len(self.attitude) - 1)
        step[self.of_gimbal[rows] != self.of_gimbal[after]] = 0.0
        found = np.where(share[:, None] > 0.0, first + share[:, None] * step, first)
        found[rows < 0] = np.nan
        return found

    def hung(self, rows: NDArray[np.int64]) -> NDArray[np.bool_]:
        """Whether the attitude at moments is a gimbal's."""
        if not len(self.of_gimbal):
            return np.zeros(len(rows), dtype=bool)
        return np.asarray((rows >= 0) & self.of_gimbal[rows])

    def course(self, rows: NDArray[np.int64], near: NDArray[np.int64]) -> Floats:
        """Of the track at moments."""
        if not len(self.course_of):
            return np.full(len(rows), np.nan)
        return np.where(rows >= 0, self.course_of[near], np.nan)


def _north_rad(places: Floats, frame: LocalFrame) -> Floats:
    """What to add to true headings for angles clockwise from the frame's north; it changes slowly."""
    if not len(places):
        return np.zeros(0)
    middle = np.median(places, axis=0)
    return np.full(len(places), math.pi / 2.0 - frame.angle_rad(float(middle[0]), float(middle[1]), 0.0))


def _angles(photo: Photo) -> tuple[float, float, float]:
    roll_deg, pitch_deg, yaw_deg = (_nan(a) for a in (photo.roll_deg, photo.pitch_deg, photo.yaw_deg))
    return math.radians(roll_deg), math.radians(pitch_deg), math.radians(yaw_deg)


def _nan(value: float | None) -> float:
    return math.nan if value is None else value
