"""What a flight missed: triggers, and ground of the regions large enough to be flown again for."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from shapely import union_all
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from app.services.flights.photos import MISSING_PART, Spacing, place_of
from app.services.records import FlightEvent, TrackSample
from planner.as_flown.coverage import GRID_M, FlownCoverage
from planner.as_flown.track import gaps_in
from planner.as_flown.unknown import UnknownPart
from planner.plan import Collect, Plan
from planner.scenario import Scenario

TriggerState = Literal["ok", "missed", "late", "early", "interrupted", "unknown"]

#: On and off may come this far from the collect's ends: telemetry tells of them several times a second.
TRIGGER_M = 25.0
#: A collect of which less than this part was flown with the sensor on was missed.
MISSED_PART = 0.1
#: The sensor counts for a collect when the aircraft is this near to its line, in its direction.
BESIDE_M = 60.0
ALONG_COSINE = math.cos(math.radians(45.0))
#: Ground narrower than twice this, or smaller, is a sliver at the edge of a footprint: a track of a few
#: places a second does not tell better where the sensor was switched.
SLIVER_M = 5.0
SLIVER_M2 = 100.0
#: A region counts as seen from this part of it on: what is missing then is slivers along its edges.
SEEN_FRACTION = 0.995


@dataclass(frozen=True, slots=True)
class Trigger:
    """How the sensor was switched over one collect.

    Parameters
    ----------
    on_m
        Flown along the collect with the sensor on.
    late_m, early_m
        Of the collect's beginning and end, flown with the sensor off; None when it was missed.
    photos_taken
        Along the collect, as cameras report them.
    photos_expected
        By the spacing ordered; None when the sensor is no camera. Then ``photo_gaps``, metres along the
        collect from and to, tell where they are missing, and ``state`` follows them.
    unknown_m
        Of the collect, not recorded; ``state`` is ``unknown`` where nothing else is known to be wrong.
    """

    vehicle: str
    seq: int
    roi: str
    state: TriggerState
    length_m: float
    on_m: float
    late_m: float | None
    early_m: float | None
    photos_taken: int = 0
    photos_expected: int | None = None
    photo_gaps: tuple[tuple[float, float], ...] = ()
    unknown_m: float = 0.0


@dataclass(frozen=True, slots=True)
class Gap:
    """A part of a region that was not seen, in the scenario's local frame."""

    roi: str
    area: Polygon


@dataclass(frozen=True, slots=True)
class Recorded:
    """What was recorded of one flight.

    Parameters
    ----------
    vehicle, sortie
        Its name in the plan, and which of its flights; None for any.
    photos
        With a place, as ``photos.photos_of`` gives them.
    spacing
        How far apart they were ordered; None when the sensor is no camera.
    """

    vehicle: str | None
    samples: tuple[TrackSample, ...]
    photos: Sequence[FlightEvent] = ()
    spacing: Spacing | None = None
    sortie: int | None = None

    def flies(self, collect: Collect) -> bool:
        """Whether it is flown for a collect."""
        own = self.vehicle == collect.vehicle and self.sortie in (None, collect.sortie)
        return self.vehicle is None or own


def collects_of(plan: Plan, flights: Sequence[Recorded]) -> tuple[Collect, ...]:
    """The collects that flights were flown for: of their vehicles and sorties; all where unknown."""
    names = {vehicle.name for vehicle in plan.vehicles}
    known = [flight for flight in flights if flight.vehicle in names]
    if not known or any(flight.vehicle is None for flight in flights):
        return plan.collects
    return tuple(collect for collect in plan.collects if any(flight.flies(collect) for flight in known))


def triggers(
    scenario: Scenario, plan: Plan, flights: Sequence[Recorded], unknown: Sequence[UnknownPart] = ()
) -> tuple[Trigger, ...]:
    """How the sensor was switched, collect by collect that was flown for, by all flights together.

    Parameters
    ----------
    unknown
        Parts of collects that may have been flown while nothing was recorded.
    """
    tracks = [_Track.of(scenario, flight) for flight in flights]
    names = {vehicle.name for vehicle in plan.vehicles}
    known = any(flight.vehicle in names for flight in flights)
    made = []
    for collect in collects_of(plan, flights):
        line = _Line.of(scenario, collect)
        mine = [track for track in tracks if track.flight.flies(collect) or not known]
        on = np.concatenate([np.zeros((0, 2, 2)), *(track.on for track in mine)])
        parts = [p for p in unknown if (p.vehicle, p.seq) == (collect.vehicle, collect.seq)]
        trigger = _told(line, collect, on, parts)
        taken = [track.photos_along(line) for track in mine]
        along_m = np.sort(np.concatenate([np.zeros(0), *taken]))
        spaced = [track for track in mine if track.flight.spacing is not None]
        if spaced and not parts:
            spacing = spaced[0].flight.spacing
            assert spacing is not None
            beside = [sample for track in spaced for sample in track.beside(line)]
            trigger = _by_photos(trigger, along_m, spacing.at(_speed_m_s(collect, beside)))
        made.append(replace(trigger, photos_taken=len(along_m)))
    return tuple(made)


@dataclass(frozen=True, slots=True)
class _Track:
    """A flight's pieces of track in the local frame, shape (N, 2, 2); those across gaps are left out."""

    flight: Recorded
    pieces: NDArray[np.float64]
    rows: NDArray[np.int64]
    on: NDArray[np.float64]
    photos: NDArray[np.float64]
    photo_rows: NDArray[np.int64]

    @classmethod
    def of(cls, scenario: Scenario, flight: Recorded) -> _Track:
        samples = flight.samples
        places = _local(scenario, [(s.lon_deg, s.lat_deg) for s in samples])
        switched = np.array([sample.sensor_on for sample in samples], dtype=bool)
        times_s = np.array([sample.time_s for sample in samples])
        speed_m_s = max(a.airspeed_m_s for a in scenario.aircraft) + scenario.wind.speed_m_s
        rows = np.flatnonzero(~gaps_in(times_s, places, speed_m_s)) if len(samples) else np.zeros(0, int)
        pieces = np.stack([places[rows], places[rows + 1]], axis=1) if len(rows) else np.zeros((0, 2, 2))
        taken = _local(scenario, [at for photo in flight.photos if (at := place_of(photo)) is not None])
        # The piece of track each photo was taken on; clocks of cameras may be a piece early or late.
        piece = np.searchsorted(times_s[rows], [photo.time_s for photo in flight.photos]) - 1
        on = pieces[switched[rows] & switched[rows + 1]] if len(rows) else pieces
        return cls(flight, pieces, rows, on, taken, piece)

    def photos_along(self, line: _Line) -> NDArray[np.float64]:
        """How far along a line the photos taken in it are."""
        beside = line.beside(self.pieces)
        then = np.zeros(len(self.photos), dtype=bool)
        for shift in (-1, 0, 1) if len(beside) else ():
            then |= beside[np.clip(self.photo_rows + shift, 0, len(beside) - 1)]
        return line.along_m(self.photos[then])

    def beside(self, line: _Line) -> list[TrackSample]:
        """The places flown along a line."""
        return [self.flight.samples[k] for k in self.rows[line.beside(self.pieces)].tolist()]


def _told(line: _Line, collect: Collect, on: NDArray[np.float64], parts: Sequence[UnknownPart]) -> Trigger:
    """The trigger of what is recorded; ``unknown`` where only what is not may be wrong with it."""
    known = _trigger(line, collect, on)
    unknown_m = sum(part.end_m - part.start_m for part in parts)
    if known.state == "ok" or not parts:
        return replace(known, unknown_m=unknown_m)
    dark = [[line.first + at_m * line.ahead for at_m in (part.start_m, part.end_m)] for part in parts]
    favourable = _trigger(line, collect, np.concatenate([on, np.array(dark)]))
    state = "unknown" if favourable.state == "ok" else favourable.state
    return replace(known, state=state, unknown_m=unknown_m)


def _speed_m_s(collect: Collect, beside: Sequence[TrackSample]) -> float:
    """Over ground along a collect, as flown, else as planned."""
    flown = [sample.ground_speed_m_s for sample in beside if sample.ground_speed_m_s is not None]
    if flown:
        return float(np.mean(flown))
    return (collect.end_m - collect.start_m) / max(collect.end_s - collect.start_s, 1e-3)


def _local(scenario: Scenario, lonlat: Sequence[tuple[float, float]]) -> NDArray[np.float64]:
    return scenario.frame.to_local(np.array(lonlat, dtype=np.float64).reshape(-1, 2))


@dataclass(frozen=True, slots=True)
class _Line:
    """A collect in the local frame: where it begins, its direction, its length."""

    first: NDArray[np.float64]
    ahead: NDArray[np.float64]
    length_m: float

    @classmethod
    def of(cls, scenario: Scenario, collect: Collect) -> _Line:
        first, last = scenario.frame.to_local([place[:2] for place in collect.line])
        length_m = float(np.hypot(*(last - first)))
        return cls(first, (last - first) / length_m, length_m)

    def beside(self, pieces: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Which pieces of track, shape (N, 2, 2), run along it: near, in its direction, within its ends."""
        moved = pieces[:, 1] - pieces[:, 0]
        offset = pieces - self.first
        along_m = offset @ self.ahead
        across_m = np.abs(offset[:, :, 0] * self.ahead[1] - offset[:, :, 1] * self.ahead[0]).max(axis=1)
        forward = moved @ self.ahead >= ALONG_COSINE * np.hypot(moved[:, 0], moved[:, 1])
        found: NDArray[np.bool_] = (
            forward & (across_m <= BESIDE_M) & (along_m[:, 1] > 0.0) & (along_m[:, 0] < self.length_m)
        )
        return found

    def along_m(self, places: NDArray[np.float64]) -> NDArray[np.float64]:
        """How far along it the places near it are, in order."""
        offset = places - self.first
        across_m = np.abs(offset[:, 0] * self.ahead[1] - offset[:, 1] * self.ahead[0])
        along_m = offset @ self.ahead
        near = (across_m <= BESIDE_M) & (along_m >= -TRIGGER_M) & (along_m <= self.length_m + TRIGGER_M)
        ordered: NDArray[np.float64] = np.sort(along_m[near])
        return ordered


def _trigger(line: _Line, collect: Collect, on: NDArray[np.float64]) -> Trigger:
    """``on``: pieces of track with the sensor on, shape (N, 2, 2): ends, east and north in metres."""
    length_m = line.length_m
    along_m = np.clip((on[line.beside(on)] - line.first) @ line.ahead, 0.0, length_m)
    on_m = float((along_m[:, 1] - along_m[:, 0]).sum())
    if on_m < MISSED_PART * length_m:
        return Trigger(collect.vehicle, collect.seq, collect.roi, "missed", length_m, on_m, None, None)
    late_m, early_m = float(along_m.min()), length_m - float(along_m.max())
    state: TriggerState = "ok"
    if late_m > TRIGGER_M:
        state = "late"
    elif early_m > TRIGGER_M:
        state = "early"
    elif on_m < length_m - late_m - early_m - TRIGGER_M:
        state = "interrupted"
    return Trigger(collect.vehicle, collect.seq, collect.roi, state, length_m, on_m, late_m, early_m)


def _by_photos(trigger: Trigger, along_m: NDArray[np.float64], spacing_m: float) -> Trigger:
    """The trigger judged by photos expected against photos taken."""
    length_m = trigger.length_m
    expected = math.floor(length_m / spacing_m + 1e-6) + 1
    marks = [0.0, *(min(max(float(at_m), 0.0), length_m) for at_m in along_m), length_m]
    gaps = tuple(
        (before_m, after_m)
        for before_m, after_m in pairwise(marks)
        if after_m - before_m > MISSING_PART * spacing_m
    )
    state: TriggerState = "ok"
    if len(along_m) < MISSED_PART * expected:
        state = "missed"
        gaps = ((0.0, length_m),)
    elif gaps:
        state = "interrupted"
        if gaps[0][0] == 0.0:
            state = "late"
        elif gaps[-1][1] == length_m:
            state = "early"
    return replace(trigger, state=state, photos_expected=expected, photo_gaps=gaps)


def regions_json(scenario: Scenario, plan: Plan, result: FlownCoverage) -> list[dict[str, Any]]:
    """Each region: what was seen of it to full quality, planned and flown, and what was wanted."""
    return [
        {
            "roi": region.name,
            "required": region.required,
            "seen": result.fraction[region.name] >= SEEN_FRACTION,
            "fraction": result.fraction[region.name],
            "planned_fraction": plan.metrics.coverage.get(region.name),
            "unseen_m2": float(result.unseen[region.name].area),
            "unknown_fraction": result.unknown_fraction.get(region.name, 0.0),
            "unknown_m2": float(result.unknown[region.name].area) if region.name in result.unknown else 0.0,
            "min_resolution_m": region.min_resolution_m,
        }
        for region in scenario.regions
    ]


def gaps(scenario: Scenario, result: FlownCoverage) -> tuple[Gap, ...]:
    """Parts of the regions worth a pass: slivers left out, outlines made simple, the largest first.

    A part becomes its convex hull within the region, so that all of it is seen and its outline stays short.
    """
    found = []
    for region in scenario.regions:
        # What nobody knows to have been seen is flown again for, too.
        left = [result.unseen[region.name], result.unknown.get(region.name, Polygon())]
        for part in _polygons(union_all(left, grid_size=GRID_M)):
            if part.area < SLIVER_M2 or part.buffer(-SLIVER_M).is_empty:
                continue
            hull = part.convex_hull.buffer(SLIVER_M, join_style="mitre").intersection(region.area)
            found += [Gap(region.name, whole) for whole in _polygons(hull) if whole.intersects(part)]
    merged = sorted(found, key=lambda gap: -gap.area.area)
    kept: list[Gap] = []
    for gap in merged:
        if not any(gap.roi == other.roi and other.area.covers(gap.area) for other in kept):
            kept.append(gap)
    return tuple(kept)


def _polygons(shape: BaseGeometry) -> Iterator[Polygon]:
    for part in getattr(shape, "geoms", [shape]):
        if isinstance(part, Polygon) and not part.is_empty:
            yield part
