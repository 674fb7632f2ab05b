"""How cameras see regions: the family of surveys."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from shapely.geometry import Polygon

from planner.airspace.surroundings import Surroundings
from planner.coverage.merge import MergedRegion
from planner.coverage.sharing import Apart
from planner.coverage.survey.check import check_camera, check_pattern
from planner.coverage.survey.figure_target import FIGURES, FigureTarget, figure_target
from planner.coverage.survey.lanes import Survey
from planner.coverage.survey.pieces import Pieces, crossed, divided, visits
from planner.coverage.survey.targets import LaneTarget, refusal, surveyed
from planner.coverage.ways import Division
from planner.progress import Stop, never
from planner.sensors.camera import CameraSensor
from planner.wishes import Region

#: Headings looked at where the fewest lanes are told.
FEW_RAD = np.radians(np.arange(0.0, 180.0, 10.0))


@dataclass(frozen=True, slots=True)
class Surveys:
    """See ``planner.coverage.ways.Family``."""

    def check(self, region: Region, sensor: CameraSensor, height_m: float) -> None:
        """Refuse a height from which overlaps cannot be kept."""
        check_camera(region.name, sensor, height_m)
        check_pattern(region, sensor)

    def check_seen(
        self,
        region: Region,
        sensor: CameraSensor,
        height_m: float,
        area: Polygon | None,
        settle_m: float,
        *,
        wide: bool,
    ) -> None:
        """Refuse the same; whether lanes have room is seen when they are laid."""
        self.check(region, sensor, height_m)

    def fewest_passes(self, region: Region, sensor: CameraSensor, height_m: float) -> tuple[int, float]:
        """How many lanes a region takes at least, and the widest distance between them."""
        hull = region.area.convex_hull
        assert isinstance(hull, Polygon)
        survey = Survey(hull, hull, sensor, height_m)
        laid = survey.frames(FEW_RAD)
        if not laid.good.any():
            return 1, 0.0
        return int(survey.counts(FEW_RAD[laid.good]).min()), float(laid.spacing_m.max())

    def targets(
        self,
        region: MergedRegion,
        sensor: CameraSensor,
        height_m: float,
        around: Surroundings,
        *,
        wide: bool,
        division: Division,
        enough: Stop,
    ) -> tuple[LaneTarget | FigureTarget, ...]:
        """The stops that see a region: its pieces, or figures, each as often as it is to be visited."""
        if region.pattern in FIGURES:
            whole = replace(sensor, edge_overlap=True)
            parts = (figure_target(part, whole, height_m, around) for part in region.split())
            return tuple(target for target in parts for _ in range(region.revisits))
        trial = Pieces(sensor, height_m, around)
        if region.pattern == "crosshatch":
            sets = crossed(region, trial)
            return tuple(trial.target(each) for each in sets for _ in range(region.revisits))
        pieces = divided(region, trial, whole=division == "whole" or not wide, enough=enough)
        if not math.isfinite(trial.cost_m(pieces)):
            raise refusal(region, around, surveyed(region, sensor, height_m))
        return tuple(trial.target(visit) for piece in pieces for visit in visits(piece, trial))

    def can_be_flown(
        self, region: MergedRegion, sensor: CameraSensor, height_m: float, around: Surroundings, *, wide: bool
    ) -> bool:
        """Whether lanes over some division of it, or a figure, may be flown."""
        if region.pattern in FIGURES:
            whole = replace(sensor, edge_overlap=True)
            parts = (figure_target(part, whole, height_m, around) for part in region.split())
            return all(part.can_be_flown() for part in parts)
        trial = Pieces(sensor, height_m, around)
        pieces = divided(region, trial, whole=True, enough=never)
        return math.isfinite(trial.cost_m(pieces))

    def sharing(self, *_: Any) -> Apart:
        """Nothing is shared: each piece is seen with lanes of its own."""
        return Apart()

    def undivided(
        self, region: MergedRegion, sensor: CameraSensor, height_m: float, around: Surroundings
    ) -> Iterator[LaneTarget]:
        """All of it lane by lane."""
        trial = Pieces(sensor, height_m, around)
        if trial.options(region) is None:
            raise refusal(region, around, surveyed(region, sensor, height_m))
        yield trial.target(region)
