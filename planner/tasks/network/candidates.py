"""Segments round one target as if nothing were in the way, and what is."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry

from planner.airspace.airspace import Level
from planner.airspace.barriers import COLUMNS
from planner.airspace.surroundings import MARGIN_M, Surroundings
from planner.airspace.zones import AREA, TRANSIT_MARGIN_M, keep_out
from planner.coverage.merge import merge_regions
from planner.coverage.registry import family_of
from planner.errors import Finding, InfeasibleError
from planner.metrics import SAMPLE_M, risks_along
from planner.progress import Stop, never
from planner.route import CollectPass
from planner.sensors.base import Sensor
from planner.sensors.registry import seen as seen_from
from planner.sensors.wanted import UnknownQualityError, wanted_of
from planner.tasks.fleet.crews import Crew
from planner.tasks.network.segments import Line, angle_of, straights
from planner.wishes import Region

Floats = NDArray[np.float64]

#: Headings are the same within this, and offsets within a hundredth.
SAME_RAD = math.radians(1.0)
#: A segment sees its target where no more than this part of it is hidden.
HIDDEN_PART = 1e-3


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """A target as aircraft of one kind see it.

    Parameters
    ----------
    crews
        Of one kind, by their bases apart.
    region
        What is to be seen, with the sensor that was asked for.
    sensor, height_m
        The sensor that is looked at, over the target's ground.
    """

    crews: tuple[Crew, ...]
    region: Region
    sensor: Sensor
    height_m: float
    level: Level
    around: Surroundings

    @classmethod
    def of(cls, crews: tuple[Crew, ...], region: Region, sensor: str) -> View:
        """The view of a target through a sensor on board."""
        crew = crews[0]
        level = crew.setting.level.of(region)
        found, height_m = crew.setting.suite.over(sensor, region.area, crew.setting.airspace, level)
        return cls(crews, region, found, height_m, level, crew.asked.at(level, crew.around))

    @property
    def free(self) -> Surroundings:
        """What it would fly among if nothing were forbidden, and the ground flat."""
        return replace(
            self.around,
            area=None,
            room=None,
            hard=np.empty((0, 3)),
            hard_polygons=(),
            barriers=np.empty((0, COLUMNS)),
            cramped=None,
            ground=None,
        )

    def refusal(self) -> Finding | None:
        """Why the sensor does not give what is asked of it, if it does not."""
        try:
            family_of(self.sensor).check(self.region, self.sensor, self.height_m)
        except InfeasibleError as error:
            return Finding(self.sensor.name, error.constraint, error.message, error.relaxation)
        try:
            wanted = wanted_of(self.region, self.sensor)
        except UnknownQualityError as error:
            return Finding(self.sensor.name, "quality", error.message, error.fix)
        over_m = self._over_lowest_m()
        for wish in wanted:
            if over_m > wish.height_m * (1.0 + 1e-6):
                given = f"{wish.wish} {wish.given(over_m):.3g} from {over_m:.0f} m"
                message = f"gives {given}, and {wish.asked:g} is asked"
                fix = f"Let it be seen from {wish.height_m:.0f} m, or ask for {wish.allowed(over_m):g}."
                return Finding(self.sensor.name, "quality", message, fix)
        return None

    def _over_lowest_m(self) -> float:
        terrain = self.crews[0].setting.airspace.terrain
        if terrain is None or self.level.over_ground_m is not None:
            return self.height_m
        return self.level.amsl_m - terrain.range_over(self.region.area)[0]

    def candidates(
        self, angles_rad: Floats, etas: Floats, stop: Stop = never
    ) -> Iterator[tuple[BaseGeometry, tuple[CollectPass, ...]]]:
        """The cheapest ways at each heading, side and stand-off, whatever is in the way, and what of.

        That is the target, or where it lies in several places one of them.
        """
        whole = replace(self.region, sensor=self.sensor.name, approach_rad=None, revisits=1)
        for part in merge_regions((whole,)):
            try:
                targets = family_of(self.sensor).targets(
                    part, self.sensor, self.height_m, self.free, wide=self.crews[0].asked.wide,
                    division="whole", enough=stop,
                )  # fmt: skip
            except InfeasibleError:
                continue
            for target in targets:
                options = target.options(angles_rad, etas)
                if options is None:
                    continue
                order = np.argsort(options.inner_m, kind="stable").tolist()
                found = [target.passes(options.rows(np.array([k])), 0) for k in order]
                area = shapely.union_all(target.region.originals).intersection(self.region.area)
                yield from ((area, passes) for passes in _distinct(found))

    def allowed(self, angle_rad: float) -> bool:
        """Whether the target may be seen in a direction."""
        return self.region.approach_rad is None or any(
            abs(math.remainder(angle_rad - each, math.tau)) < SAME_RAD for each in self.region.approach_rad
        )

    def in_the_way(self, lines: Sequence[Line]) -> Iterable[Finding]:
        """What passes along lines, and the straight flight before each, enter and may not."""
        airspace = self.crews[0].setting.airspace
        zones = keep_out(airspace, self.level, MARGIN_M, soft=False, edge_m=TRANSIT_MARGIN_M)
        deepest: dict[str, float] = {}
        for path in straights(lines, self.around.settle_m):
            for conflict in zones.conflicts(path):
                deepest[conflict.zone] = max(deepest.get(conflict.zone, 0.0), conflict.depth_m)
        for name, depth_m in deepest.items():
            if name == AREA:
                message = f"leaves the operating area by {depth_m:.0f} m"
                yield Finding(AREA, "area", message, "Enlarge the area there.")
            else:
                message = f"enters {name}, {depth_m:.0f} m deep, what is kept from it included"
                yield Finding(name, "zone", message, "Another stand-off, side or heading keeps clear of it.")

    def seen_part(self, passes: Sequence[CollectPass], area: BaseGeometry) -> float:
        """Which part of an area passes see, line of sight over terrain counted."""
        ground = self.crews[0].setting.airspace.terrain
        prints: list[BaseGeometry] = []
        for each in passes:
            if ground is None or self.level.over_ground_m is not None:
                prints.append(each.footprint)
            else:
                line_m = (each.start, each.end)
                prints.append(seen_from(self.sensor, line_m, each.look, self.level.amsl_m, ground).area)
        return part_of(prints, area)

    def risks(self, lines: Sequence[Line]) -> tuple[float, float]:
        """Risk of kill and of detection along passes and the straight flight before each."""
        airspace = self.crews[0].setting.airspace
        missile = radar = 0.0
        for path in straights(lines, self.around.settle_m):
            points = path.sample(SAMPLE_M)[:, :2]
            more = risks_along(points, np.full(len(points), self.level.height_m), airspace.threats)
            missile, radar = missile + more[0], radar + more[1]
        return missile, radar


def part_of(prints: Sequence[BaseGeometry], area: BaseGeometry) -> float:
    """Which part of an area footprints hold."""
    inside = shapely.union_all([shapely.make_valid(each) for each in prints]).intersection(area)
    return min(float(inside.area / area.area), 1.0)


def _distinct(found: Sequence[tuple[CollectPass, ...]]) -> list[tuple[CollectPass, ...]]:
    """The first of each heading, side and stand-off."""
    known: dict[tuple[int, str, int], tuple[CollectPass, ...]] = {}
    for passes in found:
        first = passes[0]
        angle = round(math.degrees(angle_of((first.start, first.end))) * 2.0) % 720
        known.setdefault((angle, first.look, round(100.0 * first.eta)), passes)
    return list(known.values())
