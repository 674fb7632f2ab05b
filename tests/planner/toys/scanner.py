"""A line scanner that looks straight down and sees a strip of fixed width: all there is to know of it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from shapely.affinity import rotate
from shapely.geometry import LineString, Polygon

from planner.airspace.surroundings import Surroundings
from planner.coverage.lines import Floats, judge_lines, poses_of
from planner.coverage.merge import MergedRegion
from planner.coverage.sharing import Apart
from planner.coverage.ways import Between
from planner.errors import InfeasibleError
from planner.route import CollectPass, Look
from planner.sensors.base import Properties, SeenGround
from planner.wishes import Region

HEADINGS_RAD = np.radians(np.arange(0.0, 360.0, 5.0))
#: A region counts as within the strip with this to spare.
SPARE_M = 0.5


@dataclass(frozen=True)
class Scanner:
    """Sees ``swath`` metres of ground below the line, as long as it is on."""

    name: str
    swath: float
    kind: str = "scanner"
    looks: tuple[Look, ...] = ("down",)
    resolution_m: float | None = None

    def in_wind(self, drift: float, toward_rad: float) -> Scanner:
        return self

    def over_relief(self, relief_m: float) -> Scanner:
        return self

    def whole(self) -> Scanner:
        return self

    def swath_m(self, height_m: float) -> float:
        return self.swath


def read(fields: Properties) -> Scanner | None:
    """Its own property, ``swath_m``."""
    name, swath_m = fields.text("name"), fields.number("swath_m", above=0.0)
    return None if name is None or swath_m is None else Scanner(name, swath_m)


def below(line_m: Any, swath_m: float) -> Polygon:
    """Ground within half the strip of a line."""
    strip = LineString(line_m).buffer(swath_m / 2.0, cap_style="flat")
    assert isinstance(strip, Polygon)
    return strip


def seen_on_terrain(sensor: Scanner, line_m: Any, *_: Any) -> SeenGround:
    """Straight down nothing hides anything."""
    return SeenGround(below(line_m, sensor.swath))


def footprint(sensor: Scanner, line_m: Any, *_: Any) -> Polygon:
    """The judge's: a rectangle along the line."""
    (e0, n0), (e1, n1) = line_m
    length_m, half_m = math.hypot(e1 - e0, n1 - n0), sensor.swath / 2.0
    along = Polygon(
        [(e0, n0 - half_m), (e0 + length_m, n0 - half_m), (e0 + length_m, n0 + half_m), (e0, n0 + half_m)]
    )
    return rotate(along, math.atan2(n1 - n0, e1 - e0), origin=(e0, n0), use_radians=True)


@dataclass(frozen=True)
class Options:
    """One pass over the middle for each heading."""

    lines: Floats
    entries: Floats
    exits: Floats
    inner_m: Floats

    def rows(self, kept: Any) -> Options:
        return Options(self.lines[kept], self.entries[kept], self.exits[kept], self.inner_m[kept])


@dataclass(frozen=True)
class Target:
    """A region seen in one pass, at headings where the strip holds it."""

    region: MergedRegion
    sensor: Scanner
    around: Surroundings

    def options(self, angles_rad: Floats, etas: Floats) -> Options | None:
        rows = [line for angle in angles_rad if (line := self._line(float(angle))) is not None]
        if not rows:
            return None
        lines, angles = np.array([line for line, _ in rows]), np.array([angle for _, angle in rows])
        good, cost_m = judge_lines(lines[:, None], self.around)
        entries, exits = poses_of(lines, angles, self.around.settle_m)
        kept = np.flatnonzero(good[:, 0])
        return Options(lines, entries, exits, cost_m[:, 0]).rows(kept) if len(kept) else None

    def coarse(self, step_rad: float, etas: Floats) -> Options:
        angles_rad = np.arange(0.0, math.tau - 1e-9, step_rad)
        found = self.options(angles_rad, etas) or self.options(HEADINGS_RAD, etas)
        if found is None:
            raise InfeasibleError("area", self.region.label, "no pass may be flown", "enlarge the area")
        return found

    def key(self, picked: Options) -> tuple[float, ...]:
        return (float(picked.entries[0, 2]),)

    def near(
        self, picked: Options, step_rad: float, step_eta: float, between: Between | None = None
    ) -> Options:
        angles_rad = picked.entries[0, 2] + step_rad * np.arange(-3.0, 4.0)
        return self.options(angles_rad, np.array([0.5])) or picked

    def passes(self, options: Options, index: int) -> tuple[CollectPass, ...]:
        start, end = ((float(e), float(n)) for e, n in options.lines[index])
        seen = below((start, end), self.sensor.swath)
        return (CollectPass(self.region.names, self.sensor.name, "down", start, end, 0.5, seen),)

    def hidden_m(self, passes: Sequence[CollectPass]) -> float:
        return 0.0

    def plain(self) -> Target:
        return self

    def _line(self, angle_rad: float) -> tuple[Floats, float] | None:
        turned = rotate(self.region.area, -angle_rad, origin=(0.0, 0.0), use_radians=True)
        west, south, east, north = turned.bounds
        if north - south > self.sensor.swath - SPARE_M:
            return None
        middle = (south + north) / 2.0
        line = rotate(
            LineString([(west, middle), (east, middle)]), angle_rad, origin=(0.0, 0.0), use_radians=True
        )
        return np.asarray(line.coords), angle_rad


class Scanners:
    """The family: see ``planner.coverage.ways.Family``."""

    def check(self, region: Region, sensor: Scanner, height_m: float) -> None:
        if region.min_resolution_m is not None:
            raise InfeasibleError("resolution", region.name, "is not known", "leave min_resolution_m out")

    def check_seen(self, region: Region, sensor: Scanner, height_m: float, *_: Any, wide: bool) -> None:
        self.check(region, sensor, height_m)

    def fewest_passes(self, region: Region, sensor: Scanner, height_m: float) -> tuple[int, float]:
        return 1, sensor.swath

    def targets(
        self, region: MergedRegion, sensor: Scanner, height_m: float, around: Surroundings, **_: Any
    ) -> tuple[Target, ...]:
        found = tuple(self.undivided(part, sensor, height_m, around) for part in region.split())
        return tuple(target for part in found for target in part)

    def can_be_flown(
        self, region: MergedRegion, sensor: Scanner, height_m: float, around: Surroundings, **_: Any
    ) -> bool:
        return Target(region, sensor, around).options(HEADINGS_RAD, np.array([0.5])) is not None

    def sharing(self, *_: Any) -> Apart:
        return Apart()

    def undivided(
        self, region: MergedRegion, sensor: Scanner, height_m: float, around: Surroundings
    ) -> Iterator[Target]:
        target = Target(region, sensor, around)
        open_ground = replace(around, area=None, hard_polygons=(), hard=np.empty((0, 3)))
        if Target(region, sensor, open_ground).options(HEADINGS_RAD, np.array([0.5])) is None:
            raise InfeasibleError("swath", region.label, "is wider than the strip", "cut it")
        yield target
