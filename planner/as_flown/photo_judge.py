"""What the cameras of flights saw: photo by photo, each from its own place, height and attitude.

An order is no photo: what counts was reported as taken. Where an autopilot reports none at all, photos where
the plan has them on the line as flown are assumed, and told apart from what is proven: nobody knows of them.
A video sees as long as it is on; where nothing told of it, it is assumed likewise.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from shapely import intersection
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from planner.airspace.terrain import Ground
from planner.as_flown.cameras import asked_photos, cameras_of
from planner.as_flown.frames import Frames, frames_of, frames_on
from planner.as_flown.limits import FLATTEST_RAD, GSD_PART, MAX_TURNED_RAD
from planner.as_flown.passes import PlannedPass, runs
from planner.as_flown.photo import Shots, axes, half_tangents, joined_shots, outlines
from planner.as_flown.photo_ground import PhotoGrid
from planner.as_flown.photo_pass import (
    PhotoPass,
    Reached,
    Taken,
    forward_overlaps,
    photo_pass,
    side_overlaps,
    untold,
)
from planner.as_flown.track import Line, Record
from planner.as_flown.unknown import UnknownPart, untold_parts
from planner.frames import LocalFrame
from planner.plan import Plan, PlanCamera
from planner.sensors.camera import CameraSensor
from planner.sensors.cameras import hangs_level
from planner.sensors.suite import Suite
from planner.wishes import Region

Floats = NDArray[np.float64]

#: Without an interval of the plan's, frames of a video are this part of the image's length apart.
VIDEO_PART = 0.25

#: Photos so far beside the line of a pass are of it, whatever the track says of that moment.
ON_LINE_M = 5.0


@dataclass(frozen=True, slots=True)
class RegionPhotos:
    """What photos saw of one region.

    Parameters
    ----------
    grid
        How often and how finely, over the region's bounds.
    limit_m
        The ground sampled distance up to which ground counts as seen; infinite where none is wished.
    seen, assumed
        Ground so seen; ``assumed`` beside it from photos that nobody reported.
    asked
        How many photos see a place at least where both overlaps are kept.
    overlap_fraction, planned_overlap_fraction
        Part of the region that so many photos see, as flown and as planned: where lanes end fewer do.
    gsd_worst_m, gsd_mean_m
        Over what photos see of it; None where they see nothing.
    """

    grid: PhotoGrid
    limit_m: float
    seen: BaseGeometry
    assumed: BaseGeometry
    asked: int
    overlap_fraction: float
    planned_overlap_fraction: float
    gsd_worst_m: float | None
    gsd_mean_m: float | None
    forward: Reached
    side: Reached


@dataclass(frozen=True, slots=True)
class PhotoCoverage:
    """What the photos of all flights saw.

    Parameters
    ----------
    taken, counted
        How many were reported, and how many of those show where they looked.
    not_counted
        Reasons, and how many each.
    assumed
        How many were not reported but planned where an autopilot reports none.
    """

    regions: dict[str, RegionPhotos]
    passes: tuple[PhotoPass, ...]
    taken: int
    counted: int
    not_counted: dict[str, int]
    assumed: int


@dataclass(slots=True)
class _Heap:
    """Photos of one camera."""

    shots: list[Shots] = field(default_factory=list)
    assumed: list[Shots] = field(default_factory=list)


class PhotoJudge:
    """Takes the photos of records one by one.

    Parameters
    ----------
    passes
        All of the plan; those of cameras matter.
    home_m
        Height of home over the terrain's datum, and terrain, None for level ground.
    """

    def __init__(
        self,
        plan: Plan,
        suite: Suite,
        frame: LocalFrame,
        passes: Sequence[PlannedPass],
        home_m: float,
        ground: Ground | None,
    ) -> None:
        self._plan, self._suite, self._frame = plan, suite, frame
        self._ground, self._home_m = ground, home_m
        self._level_m = home_m if ground is not None else 0.0
        self._cameras = {camera.name: camera for camera in plan.cameras or cameras_of(plan, suite)}
        self._passes = {planned.key: planned for planned in passes if planned.collect.sensor in self._cameras}
        self._photos = {(each.vehicle, each.seq): each for each in plan.photos}
        self._heaps: dict[str, _Heap] = {name: _Heap() for name in self._cameras}
        self._taken: dict[tuple[str, int], list[Taken]] = {key: [] for key in self._passes}
        self._why: Counter[str] = Counter()
        self._untold: list[UnknownPart] = []
        self._count = self._counted = self._assumed = 0

    @property
    def any(self) -> bool:
        """Whether there are cameras."""
        return bool(self._cameras)

    def sees(self, sensor: str) -> bool:
        """Whether a sensor is a camera."""
        return sensor in self._cameras

    @property
    def by_photos(self) -> frozenset[str]:
        """The sensors that take photos; what tells of a video is its switch."""
        return frozenset(name for name, camera in self._cameras.items() if camera.trigger != "video")

    def take(
        self, record: Record, line: Line, in_pass: NDArray[np.int64], passes: Sequence[PlannedPass]
    ) -> None:
        """One flight.

        Parameters
        ----------
        in_pass
            The pass of each place of the line, by its row in ``passes``; −1 for none.
        """
        mine = {row: planned for row, planned in enumerate(passes) if planned.key in self._passes}
        if not mine and self._passes:
            return
        frames = frames_of(record, line, in_pass, self._frame)
        self._count += len(frames.time_s)
        if not mine and len(self._cameras) == 1:
            self._add(next(iter(self._cameras.values())), frames, {})
        for name, camera in self._cameras.items():
            here = {row: planned for row, planned in mine.items() if planned.collect.sensor == name}
            if not here:
                continue
            alone = len({planned.collect.sensor for planned in mine.values()}) == 1
            if camera.trigger != "video" and len(frames.time_s):
                among = np.isin(frames.row, list(here)) | (alone & ~np.isin(frames.row, list(mine)))
                self._add(camera, frames.chosen(among), here)
                continue
            video = camera.trigger == "video"
            untold = ~line.sensor_told if video else np.ones(len(line.places), dtype=bool)
            for row, planned in here.items():
                at_m = self._wanted_m(camera, planned)
                for proven, held in ((True, video & line.sensor_on), (False, untold)):
                    for run in runs((in_pass == row) & held, line):
                        made = frames_on(record, line, planned, row, run, at_m, self._frame)
                        self._add(camera, made, here, proven=proven)
                self._untold += untold_parts(planned, line, untold & (in_pass == row))

    def _wanted_m(self, camera: PlanCamera, planned: PlannedPass) -> Floats:
        """Where along a pass its photos are planned, or frames of its video looked at."""
        photos = self._photos.get(planned.key)
        if photos is not None and camera.trigger != "video":
            places = self._frame.to_local([place[:2] for place in photos.places])
            return planned.along_m(places)
        length_m = 2.0 * half_tangents(camera)[1] * self._height_m(planned)
        step_m = photos.interval_m if photos is not None else VIDEO_PART * length_m
        return np.linspace(0.0, planned.length_m, max(2, math.ceil(planned.length_m / step_m) + 1))

    def _at_an_end(self, frames: Frames, planned: PlannedPass) -> NDArray[np.bool_]:
        """Photos on a pass's line, or half an interval beyond it, at a moment that counts for no pass.

        The first and the last are taken as the aircraft rolls in or out.
        """
        photos = self._photos.get(planned.key)
        if photos is None:
            return np.zeros(len(frames.row), dtype=bool)
        along_m, across_m = planned.along_m(frames.places), planned.across_m(frames.places)
        beyond_m = photos.interval_m / 2.0
        on_line = (along_m >= -beyond_m) & (along_m <= planned.length_m + beyond_m)
        near = across_m <= min(planned.beside_m, ON_LINE_M)
        return np.asarray((frames.row < 0) & on_line & near)

    def _add(
        self, camera: PlanCamera, frames: Frames, passes: Mapping[int, PlannedPass], *, proven: bool = True
    ) -> None:
        if not len(frames.time_s):
            return
        sensor = self._suite.named(camera.name)
        roll_rad, pitch_rad, yaw_rad = frames.roll_rad, frames.pitch_rad, frames.yaw_rad
        held = isinstance(sensor, CameraSensor) and sensor.stabilised
        if held:
            # What keeps it in line with the course is no part of the airframe's own yaw.
            yaw_rad = np.where(frames.of_camera | np.isnan(frames.course_rad), yaw_rad, frames.course_rad)
        if held or hangs_level(camera.model):
            # A gimbal takes off what the airframe rolls and pitches.
            roll_rad, pitch_rad = (np.where(frames.of_camera, each, 0.0) for each in (roll_rad, pitch_rad))
        known = ~(np.isnan(roll_rad) | np.isnan(pitch_rad) | np.isnan(yaw_rad))
        high = ~np.isnan(frames.height_m)
        place = np.concatenate([frames.places, frames.height_m[:, None] + self._level_m], axis=1)
        roll, pitch, yaw = (np.where(known, angle, 0.0) for angle in (roll_rad, pitch_rad, yaw_rad))
        shots = Shots(place, *axes(camera, roll, pitch, yaw, frames.of_camera))
        tilted = np.arccos(np.clip(-shots.axis[:, 2], -1.0, 1.0)) - math.radians(camera.tilt_deg)
        straight = np.abs(tilted) <= MAX_TURNED_RAD
        counts = known & high & straight
        if proven:
            video = camera.trigger == "video"
            self._count += len(counts) if video else 0
            self._counted += int(counts.sum())
            for reason, wrong in (
                ("attitude-unknown", ~known),
                ("height-unknown", known & ~high),
                ("turned", known & high & ~straight),
            ):
                self._why[reason] += int(wrong.sum())
        else:
            self._assumed += int(counts.sum())
        heap = self._heaps[camera.name]
        (heap.shots if proven else heap.assumed).append(shots.chosen(counts))
        if not proven:
            return
        below_m = np.zeros(len(place)) if self._ground is None else self._ground.at(frames.places)
        corners = outlines(shots, camera, below_m)
        corners[~counts] = np.nan
        for row, planned in passes.items():
            own = (frames.row == row) | self._at_an_end(frames, planned)
            along_m = planned.along_m(frames.places[own])
            half_m = float(np.diff(self._wanted_m(camera, planned)[:2]).sum()) / 2.0
            for at_m in along_m[~(known & high)[own]].tolist():
                from_m, until_m = np.clip([at_m - half_m, at_m + half_m], 0.0, planned.length_m).tolist()
                self._untold += [UnknownPart(*planned.key, from_m, until_m)] if until_m > from_m else []
            order = np.argsort(along_m, kind="stable")
            self._taken[planned.key].append(
                Taken(along_m[order], frames.index[own][order], corners[own][order])
            )

    def unknown_parts(self) -> Iterator[UnknownPart]:
        """Parts of passes with photos that nobody heard of, or that do not tell where they looked.

        The camera counted them, or nothing told of any.
        """
        yield from self._untold
        for key in self._passes:
            for taken in self._taken[key]:
                for from_m, to_m, _ in untold(taken):
                    yield UnknownPart(*key, from_m, to_m)

    def grid(self, area: BaseGeometry, sensor: str, assumed: bool = False) -> PhotoGrid:
        """How often and how finely the photos of a camera see an area."""
        camera = self._cameras[sensor]
        short_m = self._short_m(camera)
        grid = PhotoGrid.over(area, short_m)
        heap = self._heaps[sensor]
        for shots in [*heap.shots, *(heap.assumed if assumed else ())]:
            grid.lay(shots, camera, self._ground, 0.0)
        return grid

    def _short_m(self, camera: PlanCamera) -> float:
        """The shorter side of a photo at the lowest planned height."""
        heights_m = [
            self._height_m(planned)
            for planned in self._passes.values()
            if planned.collect.sensor == camera.name
        ]
        places = [shots.place for shots in self._heaps[camera.name].shots if len(shots.place)]
        if not heights_m and places:
            over_m = np.concatenate(places)
            below_m = 0.0 if self._ground is None else self._ground.at(over_m[:, :2])
            heights_m = [max(float(np.nanmedian(over_m[:, 2] - below_m)), 1.0)]
        return 2.0 * min(half_tangents(camera)) * min(heights_m, default=1.0)

    def _height_m(self, planned: PlannedPass) -> float:
        """Of a pass over the ground where it begins, as planned."""
        altitude_m = planned.collect.line[0][2]
        below_m = self._home_m if self._ground is None else float(self._ground.at(planned.first[None])[0])
        return max(altitude_m - (self._home_m if math.isnan(below_m) else below_m), 1.0)

    def margin_m(self, planned: PlannedPass) -> float:
        """How far from a place of a pass ground lies that a photo there sees."""
        camera = self._cameras[planned.collect.sensor]
        widest_rad = math.atan(math.hypot(*half_tangents(camera))) + abs(math.radians(camera.tilt_deg))
        return self._height_m(planned) * math.tan(min(widest_rad, FLATTEST_RAD))

    def coverage(self, regions: Iterable[Region], limits_m: Mapping[str, float]) -> PhotoCoverage:
        """What was seen of regions that a camera was to see.

        Parameters
        ----------
        limits_m
            Ground sampled distance wished, by region.
        """
        found = {
            region.name: self._region(region, limits_m.get(region.name, math.inf))
            for region in regions
            if self.sees(self._suite.of(region).name)
        }
        told = [
            photo_pass(planned, self._photos[key], Taken.joined(self._taken[key]), self._count > 0)
            for key, planned in self._passes.items()
            if key in self._photos and self._cameras[planned.collect.sensor].trigger != "video"
        ]
        return PhotoCoverage(
            found,
            tuple(sorted(told, key=lambda each: (each.vehicle, each.seq))),
            self._count,
            self._counted,
            {reason: count for reason, count in self._why.items() if count},
            self._assumed,
        )

    def _planned(self, sensor: str) -> Shots:
        """The photos of a camera as they are planned, flown level."""
        camera, sees = self._cameras[sensor], self._suite.named(sensor)
        parts = []
        for planned in self._passes.values():
            if planned.collect.sensor != sensor:
                continue
            at_m = self._wanted_m(camera, planned)
            places = planned.first + at_m[:, None] * planned.ahead
            up_m = planned.height_m(places, self._home_m) + self._level_m
            course_rad = math.atan2(planned.ahead[1], planned.ahead[0])
            crab_rad = sees.crab_rad(course_rad) if isinstance(sees, CameraSensor) else 0.0
            yaw_rad = np.full(len(at_m), math.pi / 2.0 - course_rad - crab_rad)
            level = np.zeros(len(at_m))
            turned = axes(camera, level, level, yaw_rad, np.zeros(len(at_m), dtype=bool))
            parts.append(Shots(np.column_stack([places, up_m]), *turned))
        return joined_shots(parts)

    def _region(self, region: Region, limit_m: float) -> RegionPhotos:
        name = self._suite.of(region).name
        camera = self._cameras[name]
        grid = self.grid(region.area, name)
        most_m = limit_m * (1.0 + GSD_PART)
        seen = intersection(region.area, grid.shape_of(grid.seen(most_m)))
        assumed: BaseGeometry = Polygon()
        if self._heaps[name].assumed:
            both = self.grid(region.area, name, assumed=True)
            assumed = intersection(region.area, both.shape_of(both.seen(most_m) & ~grid.seen(most_m)))
        asked = asked_photos(camera)
        planned = PhotoGrid.over(region.area, self._short_m(camera))
        planned.lay(self._planned(name), camera, self._ground, 0.0)
        gsd_m = grid.finest_m[grid.counts > 0]
        rows = dict(enumerate(self._passes.values()))
        mine = {row: each for row, each in rows.items() if region.name in each.collect.regions}
        taken = {row: Taken.joined(self._taken[planned.key]) for row, planned in mine.items()}
        forward = [part for each in taken.values() for part in forward_overlaps(each, region.area)]
        video = camera.trigger == "video"
        return RegionPhotos(
            grid, limit_m, seen, assumed, asked,
            _share(grid.shape_of(grid.counts >= asked), region.area),
            _share(planned.shape_of(planned.counts >= asked), region.area),
            float(gsd_m.max()) if gsd_m.size else None,
            float(gsd_m.mean(dtype=np.float64)) if gsd_m.size else None,
            Reached() if video else Reached.of(forward),
            Reached.of(side_overlaps(mine, taken, region.area)),
        )  # fmt: skip


def _share(part: BaseGeometry, whole: BaseGeometry) -> float:
    return min(float(intersection(part, whole).area / whole.area), 1.0)
