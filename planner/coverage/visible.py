"""What is asked to be seen, as targets of a tour: regions merged, parts and visits told apart."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from types import MappingProxyType

from shapely.geometry import Polygon

from planner.airspace.airspace import Airspace, Level
from planner.airspace.surroundings import Surroundings, surroundings
from planner.coverage.merge import MergedRegion, merge_regions
from planner.coverage.registry import FAMILIES, family_of
from planner.coverage.relaxation import explained
from planner.coverage.sharing import Apart, ByFamily
from planner.coverage.ways import Division, Sharing, Target
from planner.errors import Finding, InfeasibleError
from planner.progress import Stop, never
from planner.sensors.base import Sensor
from planner.sensors.suite import Suite
from planner.vehicle.model import FlightModel
from planner.wishes import Objective, Region

#: How merged regions, by their numbers, are to be divided.
Divisions = Mapping[int, Division]
NO_DIVISIONS: Divisions = MappingProxyType({})


@dataclass(frozen=True, slots=True)
class Seeing:
    """What is to be seen, with which sensors, from which level, by whom.

    Parameters
    ----------
    wide
        Whether any number of passes, and divisions, are allowed; the paper's coverage, asked for by name, has
        two passes at most and divides nothing.
    max_height_m
        The greatest height over ground that passes may have; None where none is given.
    """

    regions: tuple[Region, ...]
    suite: Suite
    airspace: Airspace
    level: Level
    model: FlightModel
    objective: Objective
    wide: bool = True
    max_height_m: float | None = None

    def surroundings(self) -> Surroundings:
        """Area, zones and prices at the level, with the margin transits keep."""
        return surroundings(self.airspace, self.level, self.model, self.objective)

    def visible(
        self,
        around: Surroundings,
        divisions: Divisions = NO_DIVISIONS,
        enough: Stop = never,
        *,
        told: bool = True,
    ) -> Visible:
        """Targets that see the regions.

        Regions that are not required and not to be seen are named and left out.

        Parameters
        ----------
        divisions
            Of merged regions that are to be divided in a certain way.
        enough
            Ends the search for shorter divisions.
        told
            Whether refusals are to say which zones are in the way, and what would help.

        Raises
        ------
        InfeasibleError
            Where a required region cannot be seen.
        """
        targets: list[Target] = []
        divided: list[int] = []
        bent: list[int] = []
        dropped: list[Finding] = []
        by_name = {region.name: region for region in self.regions}
        for index, region in enumerate(merge_regions(self.regions, default_sensor=self.suite.first)):
            sensor_name = by_name[region.names[0]].sensor
            try:
                level = self.level.of(region)
                sensor, height_m = self.suite.over(sensor_name, region.area, self.airspace, level)
                family = family_of(sensor)
                for name in region.names:
                    family.check(by_name[name], sensor, height_m)
                found = family.targets(
                    region,
                    sensor,
                    height_m,
                    self.at(level, around),
                    wide=self.wide,
                    division=divisions.get(index, "auto"),
                    enough=enough,
                )
            except InfeasibleError as refused:
                error = refused
                if told and error.constraint == "area":
                    error = explained(
                        self.airspace,
                        level,
                        region,
                        refused,
                        partial(self._some_pass, region),
                    )
                if region.required:
                    raise error from refused
                rule = f"not-seen-{error.constraint}"
                dropped.append(Finding(error.feature, rule, error.message, error.relaxation, "warning"))
                continue
            targets.extend(found)
            if len(found) > region.revisits:
                divided.append(index)
            if region.axis is not None and len(region.axis.coords) > 2:
                bent.append(index)
        return Visible(tuple(targets), tuple(divided), tuple(bent), tuple(dropped))

    def sharing(self, targets: Sequence[Target], around: Surroundings) -> Sharing:
        """Which targets may be seen in one pass; the paper's coverage joins none but by its filter."""
        if not self.wide:
            return Apart()
        together: dict[tuple[str, Level], list[int]] = {}
        for k, target in enumerate(targets):
            of = (self.suite.named(target.region.sensor).kind, self.level.of(target.region))
            together.setdefault(of, []).append(k)
        parts = []
        for (kind, level), own in together.items():
            family, over = FAMILIES[kind], partial(self._over, level)
            there = self.at(level, around)
            parts.append((tuple(own), family.sharing([targets[k] for k in own], over, there)))
        return ByFamily(tuple(parts))

    def _over(self, level: Level, name: str | None, area: Polygon) -> tuple[Sensor, float]:
        return self.suite.over(name, area, self.airspace, level)

    def at(self, level: Level, around: Surroundings) -> Surroundings:
        """What passes at one of the levels fly among: ``around`` where it is the only one."""
        if self.level.depth_m <= 0.0:
            return around
        return surroundings(self.airspace, level, self.model, self.objective)

    def _some_pass(self, region: MergedRegion, airspace: Airspace, level: Level) -> bool:
        """Whether a region can be seen among other zones or from another level."""
        around = surroundings(airspace, level, self.model, self.objective)
        try:
            sensor, height_m = self.suite.over(region.sensor, region.area, airspace, level)
            return family_of(sensor).can_be_flown(region, sensor, height_m, around, wide=self.wide)
        except InfeasibleError:
            return False


@dataclass(frozen=True, slots=True)
class Visible:
    """What can be seen, and how.

    Parameters
    ----------
    targets
        Each region, part of one or visit to one.
    divided
        Which of the merged regions are divided.
    bent
        Which of them are corridors with bends.
    dropped
        Those that cannot be seen and need not be.
    """

    targets: tuple[Target, ...]
    divided: tuple[int, ...]
    bent: tuple[int, ...]
    dropped: tuple[Finding, ...]
