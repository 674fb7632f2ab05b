"""The ground really seen: records of a plan's flights, to what of each region was seen, missed or neither.

Nothing fails open: what the record does not tell, or what a processor cannot focus, is not seen. Where
nothing was recorded it is not known, which is told apart from what was missed.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
from shapely import difference, get_parts, intersection, union_all
from shapely.geometry import MultiPolygon, Polygon
from shapely.geometry.base import BaseGeometry

from planner.airspace.airspace import Airspace
from planner.as_flown import ground, spot, unknown
from planner.as_flown.limits import MAX_BANK_RAD, MAX_PITCH_RAD
from planner.as_flown.mount import in_gimbal, turned
from planner.as_flown.passes import FlownPass, PlannedPass, Reason, flown_for, flown_pass, matched, runs
from planner.as_flown.photo_judge import PhotoCoverage, PhotoJudge
from planner.as_flown.track import Gap, Line, Record, TrackSample, gaps_of
from planner.as_flown.unknown import UnknownPart
from planner.as_flown.wished import wished_gsd_m
from planner.frames import LocalFrame
from planner.plan import Collect, Plan
from planner.sensors.sar import SarSensor
from planner.sensors.suite import Suite
from planner.vehicle.aircraft import Aircraft
from planner.vehicle.model import FlightModel
from planner.wishes import Region

__all__ = ["Asked", "FlownCoverage", "FlownPass", "NotCounted", "Record", "TrackSample", "flown_coverage"]

Rows = NDArray[np.int64]

#: What leaves open where a sensor that was on looked.
UNTOLD: frozenset[Reason] = frozenset({"height-unknown", "attitude-unknown"})
#: Overlays are done on a grid: without one, outlines equal but for rounding can be taken for disjoint.
GRID_M = 1e-6


@dataclass(frozen=True, slots=True)
class Asked:
    """What was to be seen, with what, where."""

    frame: LocalFrame
    regions: tuple[Region, ...]
    suite: Suite
    aircraft: tuple[Aircraft, ...]
    airspace: Airspace


@dataclass(frozen=True, slots=True)
class NotCounted:
    """A stretch with the sensor on that counts for nothing.

    Parameters
    ----------
    record
        Which of the records, from 0.
    samples
        First and last sample of it.
    """

    record: int
    samples: tuple[int, int]
    reason: Reason
    start_s: float
    end_s: float
    length_m: float


@dataclass(frozen=True, slots=True)
class FlownCoverage:
    """What was seen at full resolution, in the local frame.

    ``seen``, ``unknown`` and ``unseen`` make up each region; ``unseen`` was missed for certain. ``fraction``
    and ``unknown_fraction`` are of the region's area, never above 1. ``gaps`` are those of each record;
    ``photos`` is None where no camera was planned.
    """

    fraction: dict[str, float]
    seen: dict[str, BaseGeometry]
    unseen: dict[str, BaseGeometry]
    passes: tuple[FlownPass, ...]
    unknown: dict[str, BaseGeometry] = field(default_factory=dict)
    unknown_fraction: dict[str, float] = field(default_factory=dict)
    unknown_parts: tuple[UnknownPart, ...] = ()
    gaps: tuple[tuple[Gap, ...], ...] = ()
    not_counted: tuple[NotCounted, ...] = ()
    photos: PhotoCoverage | None = None


def flown_coverage(asked: Asked, plan: Plan, records: Sequence[Record]) -> FlownCoverage:
    """Ground seen by flights of one plan, together.

    Parameters
    ----------
    records
        One for each flight.
    """
    return _judged(asked, plan, records).verdict()


def photo_judge(asked: Asked, plan: Plan, records: Sequence[Record]) -> PhotoJudge:
    """What the cameras of flights of one plan took, to be laid on grids."""
    return _judged(asked, plan, records).cameras


def _judged(asked: Asked, plan: Plan, records: Sequence[Record]) -> _Judge:
    judge = _Judge(asked, plan)
    for number, record in enumerate(records):
        judge.take(number, record)
    return judge


class _Judge:
    """Takes records one by one."""

    def __init__(self, asked: Asked, plan: Plan) -> None:
        self._asked, self._plan = asked, plan
        self._home_m = asked.airspace.home_amsl_m or 0.0
        self._models = {a.name: FlightModel.of(a, asked.airspace.wind) for a in asked.aircraft}
        self._passes = tuple(PlannedPass.of(c, asked.frame, self._beside_m(c)) for c in plan.collects)
        model = next(iter(self._models.values()))
        suite = asked.suite.in_wind(model.drift, model.wind.toward_rad)
        self.cameras = PhotoJudge(
            plan, suite, asked.frame, self._passes, self._home_m, asked.airspace.terrain
        )
        self._ground: dict[str, list[Polygon]] = {}
        self._flown: dict[tuple[str, int], list[tuple[ground.Floats, ground.Floats]]] = {}
        self._lines: list[tuple[Record, Line, tuple[Gap, ...]]] = []
        self._gaps: list[tuple[Gap, ...]] = []
        self._not_counted: list[NotCounted] = []
        self._untold: list[UnknownPart] = []

    def _beside_m(self, collect: Collect) -> float:
        """A swath's width aside, nothing of what the pass was to see is seen."""
        sensor = self._asked.suite.named(collect.sensor).whole()
        return max(sensor.swath_m(collect.line[0][2] - self._home_m), 1.0)

    def _speed_m_s(self, vehicle: str | None) -> float:
        """The most it flies over the ground."""
        wind_m_s = self._asked.airspace.wind.speed_m_s
        return wind_m_s + max(
            a.airspeed_m_s for a in self._asked.aircraft if vehicle is None or a.name == vehicle
        )

    def _higher_m(self, vehicle: str | None, sortie: int) -> float:
        """How much higher than the scenario's home that of a flight lies, which its record counts from."""
        own = vehicle or (self._plan.vehicles[0].name if len(self._plan.vehicles) == 1 else None)
        if own is None or self._asked.airspace.terrain is None or sortie not in self._plan.sorties_of(own):
            return 0.0
        return self._plan.home_altitude_m(own, sortie) - self._home_m

    def _levelled(self, vehicle: str | None) -> bool:
        """Whether it leans into its way, and its antenna does not."""
        flown = [a for a in self._asked.aircraft if vehicle is None or a.name == vehicle]
        return all(aircraft.type == "multirotor" for aircraft in flown)

    def take(self, number: int, record: Record) -> None:
        """One flight."""
        names = {a.name for a in self._asked.aircraft}
        vehicle = record.vehicle if record.vehicle in names else None
        record = record.higher(self._higher_m(vehicle, record.sortie or 1))
        line = Line.of(record, self._asked.frame, self._speed_m_s(vehicle), self._levelled(vehicle))
        gaps = gaps_of(record.samples, line) + (() if record.gap_after is None else (record.gap_after,))
        self._gaps.append(gaps)
        known = record if vehicle is not None else replace(record, vehicle=None)
        self._lines.append((known, line, gaps))
        passes = tuple(p for p in self._passes if known.flies(p.collect.vehicle, p.collect.sortie))
        in_pass = matched(line, passes)
        self.cameras.take(record, line, in_pass, passes)
        line = turned(line, in_pass, passes, self._asked.suite)
        by_photos = np.array([*(self.cameras.sees(p.collect.sensor) for p in passes), False], dtype=bool)
        if by_photos[:-1].all():
            by_photos[:] = True
        label = _labels(in_pass, passes)
        why = self._obstacles(line, in_pass)
        counted: NDArray[np.bool_] = by_photos[in_pass]
        reasons = np.array(why, dtype=object)
        looked = line.sensor_on & ~counted
        for run in runs(looked & np.array([w is None for w in why], dtype=bool), line, label):
            rows = _moving(line, run)
            if len(rows) < 2:
                reasons[run] = "too-short"
                continue
            found = self._stretch(line, rows, passes[int(in_pass[rows[len(rows) // 2]])], passes, in_pass)
            counted[rows[found.counted]] = True
            reasons[run] = found.reason
        at_work = line.sensor_on | line.nearest([photo.time_s for photo in record.photos])
        unclear = ~line.sensor_told | (line.sensor_on & np.isin(np.array(why, dtype=object), list(UNTOLD)))
        for row, planned in enumerate(passes):
            on = line.sensor_on
            if not by_photos[row]:
                self._untold += unknown.untold_parts(planned, line, unclear & (in_pass == row))
            if by_photos[row]:
                along_m = planned.along_m(line.places)
                on = (along_m >= 0.0) & (along_m <= planned.length_m)
            flown = runs(on & (in_pass == row), line)
            if by_photos[row]:
                flown = flown_for(flown, planned.across_m(line.places), at_work)
            stretches = [(line.places[r], line.time_s[r]) for r in flown]
            if sum(len(places) for places, _ in stretches) > 1:
                self._flown.setdefault(planned.key, []).extend(stretches)
        self._leave_out(number, line, counted, reasons)

    def _obstacles(self, line: Line, in_pass: Rows) -> list[Reason | None]:
        """What keeps each place from counting by itself."""
        found: list[Reason | None] = []
        rows = zip(line.height_m, line.roll_rad, line.pitch_rad, in_pass.tolist(), strict=True)
        for height_m, roll_rad, pitch_rad, row in rows:
            reason: Reason | None = None
            if math.isnan(height_m):
                reason = "height-unknown"
            elif math.isnan(roll_rad):
                reason = "attitude-unknown"
            elif abs(roll_rad) > MAX_BANK_RAD:
                reason = "bank"
            elif abs(pitch_rad) > MAX_PITCH_RAD:
                reason = "pitch"
            elif row < 0:
                reason = "no-planned-pass"
            found.append(reason)
        return found

    def _stretch(
        self,
        line: Line,
        rows: Rows,
        planned: PlannedPass,
        passes: Sequence[PlannedPass],
        in_pass: Rows,
    ) -> ground.Judged:
        collect = planned.collect
        sensor = self._asked.suite.named(collect.sensor)
        if not isinstance(sensor, SarSensor):
            return ground.Judged((), np.zeros(len(rows), dtype=bool), "not-judged")
        model = self._models[collect.vehicle]
        places = line.places[rows]
        middle = places[len(places) // 2]
        # Where north is on the map here; it changes little along one pass.
        north_rad = self._asked.frame.angle_rad(float(middle[0]), float(middle[1]), 0.0)
        heights_m = np.empty(len(rows))
        for row in np.unique(in_pass[rows]).tolist():
            here = in_pass[rows] == row
            heights_m[here] = passes[row].height_m(places[here], self._home_m)
        if in_gimbal(line)[rows].all():
            # Where it points was told: it need not be taken to be abeam of the course.
            sensor = replace(sensor, stabilised=False)
        stretch = ground.Stretch(
            sensor.whole().in_wind(model.drift, model.wind.toward_rad),
            "left" if collect.look == "left" else "right",
            self._asked.frame.to_local([place[:2] for place in collect.line]),
            places,
            line.height_m[rows],
            heights_m,
            line.roll_rad[rows],
            line.pitch_rad[rows],
            north_rad - line.heading_rad[rows],
            self._asked.airspace.terrain,
            self._home_m,
        )
        found = ground.judged(stretch) if sensor.turned_rad is None else spot.judged_spot(stretch)
        self._ground.setdefault(collect.sensor, []).extend(found.seen)
        return found

    def _leave_out(
        self, number: int, line: Line, counted: NDArray[np.bool_], reasons: NDArray[np.object_]
    ) -> None:
        """Name what was flown with the sensor on and does not count."""
        left = line.sensor_on & ~counted
        words = {str(reason): k for k, reason in enumerate(dict.fromkeys(reasons.tolist()))}
        label = np.array([words[str(reason)] for reason in reasons.tolist()], dtype=np.int64)
        for run in runs(left, line, label):
            places = line.places[run]
            length_m = float(np.hypot(*np.diff(places, axis=0).T).sum())
            reason = reasons[run.start]
            if len(places) > 1 and reason is not None:
                start_s, end_s = float(line.time_s[run.start]), float(line.time_s[run.stop - 1])
                ends = (run.start, run.stop - 1)
                self._not_counted.append(NotCounted(number, ends, reason, start_s, end_s, length_m))

    def verdict(self) -> FlownCoverage:
        """What all of them saw."""
        seen_by = {name: _areal(union_all(parts, grid_size=GRID_M)) for name, parts in self._ground.items()}
        parts = (*self._unknown_parts(), *self._untold, *self.cameras.unknown_parts())
        photos = self._photos()
        nobody_knows = self._unknown_ground(parts)
        fraction, seen, unseen, dark, dark_fraction = {}, {}, {}, {}, {}
        nothing = Polygon()
        for region in self._asked.regions:
            name, sensor = region.name, self._asked.suite.of(region).name
            found = seen_by.get(sensor, nothing)
            if photos is not None and name in photos.regions:
                found = photos.regions[name].seen
            seen[name] = _areal(intersection(region.area, found, grid_size=GRID_M))
            missing = _areal(difference(region.area, found, grid_size=GRID_M))
            unclear = nobody_knows.get(sensor, nothing)
            dark[name] = _areal(intersection(missing, unclear, grid_size=GRID_M))
            unseen[name] = _areal(difference(missing, dark[name], grid_size=GRID_M))
            fraction[name] = _share(seen[name], region.area)
            dark_fraction[name] = _share(dark[name], region.area)
        by_key = {planned.key: planned for planned in self._passes}
        flown = [
            flown_pass(by_key[key], [places for places, _ in found], [times_s for _, times_s in found])
            for key, found in self._flown.items()
        ]
        return FlownCoverage(
            fraction, seen, unseen, tuple(sorted(flown, key=lambda p: (p.seq, p.vehicle))),
            dark, dark_fraction, parts, tuple(self._gaps), tuple(self._not_counted), photos,
        )  # fmt: skip

    def _photos(self) -> PhotoCoverage | None:
        """What cameras saw, held against what is wished, or else planned, of each region."""
        if not self.cameras.any:
            return None
        limits_m = {
            region.name: wished_gsd_m(region, self._asked.suite.of(region), self._plan, self._passes)
            for region in self._asked.regions
        }
        return self.cameras.coverage(self._asked.regions, limits_m)

    def _unknown_parts(self) -> Iterable[UnknownPart]:
        flights = dict.fromkeys((p.collect.vehicle, p.collect.sortie) for p in self._passes)
        for name, sortie in flights:
            told = [(line, gaps) for record, line, gaps in self._lines if record.flies(name, sortie)]
            gaps = [gap for _, gaps in told for gap in gaps]
            if gaps:
                own = (name, sortie)
                passes = [p for p in self._passes if (p.collect.vehicle, p.collect.sortie) == own]
                lines = [line for line, _ in told]
                yield from unknown.unknown_parts(
                    passes, lines, gaps, self._asked.frame, self._speed_m_s(name), self.cameras.by_photos
                )

    def _unknown_ground(self, parts: Sequence[UnknownPart]) -> dict[str, BaseGeometry]:
        """Ground that may have been seen, sensor by sensor."""
        if not parts:
            return {}
        rings: dict[tuple[str, int], list[Polygon]] = {}
        for print_ in self._plan.footprints:
            local = self._asked.frame.to_local
            outline = Polygon(local(print_.ring), [local(hole) for hole in print_.holes])
            rings.setdefault((print_.vehicle, print_.seq), []).append(outline)
        prints = {planned.key: union_all(rings.get(planned.key, [])) for planned in self._passes}
        margins = {planned.key: self._margins_m(planned) for planned in self._passes}
        by_key = {planned.key: planned for planned in self._passes}
        found: dict[str, list[BaseGeometry]] = {}
        for key, shape in unknown.unknown_ground(parts, by_key, prints, margins).items():
            found.setdefault(by_key[key].collect.sensor, []).append(shape)
        return {name: _areal(union_all(shapes, grid_size=GRID_M)) for name, shapes in found.items()}

    def _margins_m(self, planned: PlannedPass) -> tuple[float, float]:
        """How far behind and ahead of a place ground lies whose aperture or photo has the place in it."""
        collect = planned.collect
        if self.cameras.sees(collect.sensor):
            return (self.cameras.margin_m(planned),) * 2
        sensor = self._asked.suite.named(collect.sensor)
        if not isinstance(sensor, SarSensor) or sensor.turned_rad is not None:
            return math.inf, math.inf
        whole, height_m = sensor.whole(), collect.line[0][2] - self._home_m
        return whole.run_out_m(height_m), whole.run_in_m(height_m)


def _labels(in_pass: Rows, passes: Sequence[PlannedPass]) -> Rows:
    """One number for all passes that look to one side with one sensor: those may be flown as one."""
    looks = [(p.collect.sensor, p.collect.look, p.collect.vehicle) for p in passes]
    numbers = np.array([*(looks.index(look) for look in looks), -1], dtype=np.int64)
    found: Rows = numbers[in_pass]
    return found


def _moving(line: Line, run: slice) -> Rows:
    """The rows of a run whose places differ from the one before."""
    rows = np.arange(run.start, run.stop)
    moved = np.hypot(*np.diff(line.places[run], axis=0).T) > 0.0
    kept: Rows = rows[np.concatenate([[True], moved])]
    return kept


def _areal(shape: BaseGeometry) -> BaseGeometry:
    """Without the points and lines that overlays leave where outlines touch."""
    parts = [part for part in get_parts(shape).tolist() if isinstance(part, Polygon) and part.area > 0.0]
    return parts[0] if len(parts) == 1 else MultiPolygon(parts)


def _share(part: BaseGeometry, whole: BaseGeometry) -> float:
    """Its area by the whole's, rounding kept within 0 and 1."""
    return min(max(float(part.area / whole.area), 0.0), 1.0) if whole.area > 0.0 else 0.0
