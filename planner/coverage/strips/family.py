"""How sensors that look to the side see regions: the family of strips."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from shapely.geometry import Polygon

from planner.airspace.surroundings import Surroundings
from planner.coverage.merge import MergedRegion
from planner.coverage.strips.alternatives import families
from planner.coverage.strips.classify import angles_around, hull_points, spans_at
from planner.coverage.strips.neighbourhood import can_be_seen, check_sensor
from planner.coverage.strips.sharing import StripSharing
from planner.coverage.strips.targets import StripTarget, can_be_flown, targets
from planner.coverage.ways import Division, Over
from planner.progress import Stop
from planner.sensors.sar import SarSensor
from planner.sensors.strip import swaths_m
from planner.wishes import Region


@dataclass(frozen=True, slots=True)
class Strips:
    """See ``planner.coverage.ways.Family``."""

    def check(self, region: Region, sensor: SarSensor, height_m: float) -> None:
        """Refuse a sensor that cannot give what a region asks for, at this height."""
        check_sensor(region, sensor, height_m)

    def check_seen(
        self,
        region: Region,
        sensor: SarSensor,
        height_m: float,
        area: Polygon | None,
        settle_m: float,
        *,
        wide: bool,
    ) -> None:
        """Refuse a region that no passes inside an area see."""
        can_be_seen(region, sensor, height_m, area, wide=wide, settle_m=settle_m)

    def fewest_passes(self, region: Region, sensor: SarSensor, height_m: float) -> tuple[int, float]:
        """How many passes a region takes at least, and the widest strip."""
        angles_rad = angles_around(math.radians(10.0))
        swath_m = swaths_m(sensor, height_m, angles_rad)
        lanes = spans_at(hull_points(region.area), angles_rad).across_m / np.maximum(swath_m, 1e-9)
        return math.ceil(float(lanes.min())), float(swath_m.max())

    def targets(
        self,
        region: MergedRegion,
        sensor: SarSensor,
        height_m: float,
        around: Surroundings,
        *,
        wide: bool,
        division: Division,
        enough: Stop,
    ) -> tuple[StripTarget, ...]:
        """The stops that see a region."""
        return targets(region, sensor, height_m, around, wide=wide, division=division, enough=enough)

    def can_be_flown(
        self, region: MergedRegion, sensor: SarSensor, height_m: float, around: Surroundings, *, wide: bool
    ) -> bool:
        """Whether some pass, or some sweep of the whole region, may be flown."""
        return can_be_flown(region, sensor, height_m, around, wide=wide)

    def sharing(self, targets: Sequence[StripTarget], over: Over, around: Surroundings) -> StripSharing:
        """Which targets one strip may hold."""
        return StripSharing(targets, over, around)

    def undivided(
        self, region: MergedRegion, sensor: SarSensor, height_m: float, around: Surroundings
    ) -> Iterator[StripTarget]:
        """A target for each set of families, those with the fewest passes first."""
        for sides in families(region, sensor, height_m):
            yield StripTarget(region, sides, around)
