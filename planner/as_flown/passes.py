"""Which planned pass each place of a track belongs to, and the stretches flown as one with the sensor on."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, Self

import numpy as np
from numpy.typing import NDArray

from planner.as_flown.limits import MAX_BANK_RAD, MAX_OFF_COURSE_RAD, MAX_PITCH_RAD
from planner.as_flown.track import Floats, Line
from planner.frames import LocalFrame
from planner.plan import Collect

#: The course is that from so far behind to so far ahead.
COURSE_M = 5.0

Reason = Literal[
    "attitude-unknown",
    "height-unknown",
    "bank",
    "pitch",
    "no-planned-pass",
    "out-of-range",
    "not-straight",
    "too-short",
    "not-judged",
]

#: What each means, for people.
REASONS: dict[Reason, str] = {
    "attitude-unknown": "the roll was not recorded",
    "height-unknown": "the height was not recorded",
    "bank": f"banked by more than {math.degrees(MAX_BANK_RAD):g}°",
    "pitch": f"pitched by more than {math.degrees(MAX_PITCH_RAD):g}°",
    "no-planned-pass": "no planned pass lies here in this direction",
    "out-of-range": "the ground lay outside the sensor's range or incidence",
    "not-straight": "not flown straight over an aperture",
    "too-short": "shorter than an aperture",
    "not-judged": "what this kind of sensor saw in flight is not judged",
}


@dataclass(frozen=True, slots=True)
class PlannedPass:
    """A collect in the local frame; ``beside_m`` is how far aside of it a flight is still of it."""

    collect: Collect
    first: Floats
    ahead: Floats
    length_m: float
    beside_m: float

    @classmethod
    def of(cls, collect: Collect, frame: LocalFrame, beside_m: float) -> Self:
        """A collect."""
        first, last = frame.to_local([place[:2] for place in collect.line])
        length_m = float(np.hypot(*(last - first)))
        return cls(collect, first, (last - first) / length_m, length_m, beside_m)

    @property
    def key(self) -> tuple[str, int]:
        """What tells it from others."""
        return self.collect.vehicle, self.collect.seq

    def along_m(self, places: Floats) -> Floats:
        """How far along it places are."""
        found: Floats = (places - self.first) @ self.ahead
        return found

    def across_m(self, places: Floats) -> Floats:
        """How far beside it places are, to either side."""
        offset = places - self.first
        found: Floats = np.abs(offset[:, 0] * self.ahead[1] - offset[:, 1] * self.ahead[0])
        return found

    def height_m(self, places: Floats, home_amsl_m: float) -> Floats:
        """How high over home it is planned beside places."""
        share = np.clip(self.along_m(places) / self.length_m, 0.0, 1.0)
        low, high = (place[2] - home_amsl_m for place in self.collect.line)
        found: Floats = low + share * (high - low)
        return found


def courses(line: Line) -> Floats:
    """Unit vectors of the course at each place, (N, 2); zero where it does not move."""
    found = np.zeros_like(line.places)
    for number in np.unique(line.piece):
        rows = np.flatnonzero(line.piece == number)
        places = line.places[rows]
        steps_m = np.hypot(*np.diff(places, axis=0).T)
        along_m = np.concatenate([[0.0], np.cumsum(steps_m)])
        moving = np.concatenate([[True], steps_m > 0.0])
        if np.count_nonzero(moving) < 2:
            continue
        ends = [
            np.stack([np.interp(along_m + off, along_m[moving], places[moving, k]) for k in (0, 1)], axis=1)
            for off in (-COURSE_M, COURSE_M)
        ]
        moved = ends[1] - ends[0]
        length_m = np.hypot(*moved.T)
        found[rows] = moved / np.maximum(length_m, 1e-9)[:, None]
    return found


def matched(line: Line, passes: Sequence[PlannedPass]) -> NDArray[np.int64]:
    """The pass that each place of a track is flown in, by its row in ``passes``; −1 for none, (N,).

    It lies beside the pass, in its direction; the nearest of several counts. Before and behind its ends,
    straight on, it is the pass's as well, if the stretch reaches the pass itself.
    """
    found = np.full(len(line.places), -1, dtype=np.int64)
    if not passes or not len(found):
        return found
    course = courses(line)
    nearest_m = np.full(len(found), np.inf)
    for row, planned in enumerate(passes):
        across_m, along_m = planned.across_m(line.places), planned.along_m(line.places)
        fits = (across_m <= planned.beside_m) & (course @ planned.ahead >= math.cos(MAX_OFF_COURSE_RAD))
        fits &= _reaching(fits, line, (along_m >= 0.0) & (along_m <= planned.length_m))
        beyond_m = np.maximum(np.maximum(-along_m, along_m - planned.length_m), 0.0)
        distance_m = np.hypot(across_m, beyond_m)
        better = fits & (distance_m < nearest_m)
        found[better], nearest_m[better] = row, distance_m[better]
    return found


def _reaching(fits: NDArray[np.bool_], line: Line, within: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """The places of runs that fit and have one within the pass's own ends."""
    made = np.zeros_like(fits)
    for run in runs(fits, line):
        made[run] = within[run].any()
    return made


def runs(held: NDArray[np.bool_], line: Line, label: NDArray[np.int64] | None = None) -> list[slice]:
    """Runs of places that hold, without a gap between, and of one label."""
    if not len(held):
        return []
    joined = held[1:] & held[:-1] & line.pieces()
    if label is not None:
        joined &= label[1:] == label[:-1]
    begins = np.flatnonzero(held & ~np.concatenate([[False], joined]))
    ends = np.flatnonzero(held & ~np.concatenate([joined, [False]]))
    return [slice(int(a), int(b) + 1) for a, b in zip(begins, ends, strict=True)]


def flown_for(beside: Sequence[slice], across_m: Floats, at_work: NDArray[np.bool_]) -> list[slice]:
    """Of the runs beside a pass, in its direction, those flown for it: its camera was at work in them.

    The way back between lanes may lie beside one, too. Where nothing shows the camera, the nearest run is it.
    """
    shown = [run for run in beside if at_work[run].any()]
    if shown or not beside:
        return shown
    return [min(beside, key=lambda run: float(across_m[run].mean()))]


@dataclass(frozen=True, slots=True)
class FlownPass:
    """How well one collect was flown: distance from its line while the sensor was on.

    ``start_s`` and ``end_s`` are the first and last moment of that by the clock of its record; of several
    records, of the earliest and the latest.
    """

    seq: int
    roi: str
    cross_track_p95_m: float
    cross_track_max_m: float
    sensor_on_m: float
    vehicle: str = ""
    start_s: float = math.nan
    end_s: float = math.nan


def flown_pass(planned: PlannedPass, stretches: Sequence[Floats], times_s: Sequence[Floats]) -> FlownPass:
    """Of the places flown in it with the sensor on, stretch by stretch, and when."""
    across_m = np.concatenate([planned.across_m(places) for places in stretches])
    length_m = sum(float(np.hypot(*np.diff(places, axis=0).T).sum()) for places in stretches)
    collect = planned.collect
    return FlownPass(
        collect.seq,
        collect.roi,
        float(np.percentile(across_m, 95)),
        float(across_m.max()),
        length_m,
        collect.vehicle,
        min(float(each.min()) for each in times_s),
        max(float(each.max()) for each in times_s),
    )
