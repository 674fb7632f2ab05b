"""In how many parts regions are cut, so that aircraft can share them and flights can hold them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from planner.coverage.registry import family_of
from planner.sensors.base import Sensor
from planner.sensors.camera import CameraSensor
from planner.tasks.fleet.crews import Crew, most_s, takes_s
from planner.tasks.fleet.jobs import Job
from planner.tasks.fleet.ways import Ways
from planner.wishes import Region

#: A region is cut where it takes so much more than an even share of all work, or than one flight can give.
MORE_THAN_EVEN, OF_A_FLIGHT = 1.3, 0.8


@dataclass(frozen=True, slots=True)
class Cutting:
    """Who can see what, as far as cuts depend on it.

    Parameters
    ----------
    most_s
        How long a flight of a crew may last so that its mission is held, by the number of the crew.
    """

    crews: Sequence[Crew]
    jobs: Sequence[Job]
    ways: Mapping[tuple[str, int], Ways]
    most_s: Mapping[int, float]

    def first(self) -> dict[str, int]:
        """In how many parts regions are cut at first, those that are."""
        times_s = {job.of: takes_s(job, self.crews, self.ways) for job in self.jobs}
        even_s = math.fsum(s for s in times_s.values() if math.isfinite(s)) / len(self.crews)
        parts = {}
        for job in self.jobs:
            time_s = times_s[job.of]
            if not math.isfinite(time_s):
                continue
            able = [c for c in range(len(self.crews)) if (job.region.name, c) in self.ways]
            shares = math.ceil(time_s / even_s) if time_s > MORE_THAN_EVEN * even_s and len(able) > 1 else 1
            flight_s = min(min(most_s(self.crews[c]), self.most_s.get(c, math.inf)) for c in able)
            flights = math.ceil(time_s / (OF_A_FLIGHT * flight_s)) if math.isfinite(flight_s) else 1
            count = min(max(min(shares, len(able)), flights), self.most_parts(job.region))
            if count > 1:
                parts[job.of] = count
        return parts

    def most_parts(self, region: Region) -> int:
        """As many as it takes passes; what is seen more than once is whole."""
        seen = self._seen_by(region)
        if seen is None or region.revisits > 1 or region.pattern not in ("auto", "lanes"):
            return 1
        sensor, height_m = seen
        return max(family_of(sensor).fewest_passes(region, sensor, height_m)[0], 1)

    def shared_m(self, region: Region) -> float:
        """What photos of two parts have to see both, for their overlap."""
        seen = self._seen_by(region)
        if seen is None or not isinstance(seen[0], CameraSensor):
            return 0.0
        return seen[0].side_overlap * seen[0].swath_m(seen[1])

    def _seen_by(self, region: Region) -> tuple[Sensor, float] | None:
        """The sensor of a region, and its height over the ground; None where nobody sees it."""
        names = {job.region.name for job in self.jobs if job.of == region.name}
        able = [crew for name, crew in self.ways if name in names]
        if not able:
            return None
        setting = self.crews[able[0]].setting
        level = setting.level.of(region)
        return setting.suite.over(region.sensor, region.area, setting.airspace, level)
