"""A figure round a place as a stop of the tour: its turn, and the way round, are what is chosen."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from planner.airspace.surroundings import Surroundings
from planner.coverage.lines import cramped_m, judge_lines, poses_of
from planner.coverage.merge import MergedRegion
from planner.coverage.survey.figures import LOOKS, Figure, Looks, rings, spiral
from planner.coverage.survey.lanes import Survey
from planner.coverage.survey.options import allowed, collect_along
from planner.coverage.survey.targets import refusal
from planner.coverage.ways import Between
from planner.dubins.kernels import dubins_lengths
from planner.errors import InfeasibleError
from planner.route import CollectPass
from planner.sensors.camera import CameraSensor
from planner.wishes import Pattern

Floats = NDArray[np.float64]

#: Patterns that are figures.
FIGURES: tuple[Pattern, ...] = ("orbit", "spiral", "look")
#: Angles tried all round at most this far apart, and to either side of one chosen.
MOST_STEP_RAD, NEAR_ANGLES = math.radians(10.0), 4


@dataclass(frozen=True, slots=True)
class FigureOptions:
    """Ways to fly a figure: turned by ``angles_rad``, to the left or the right round its middle, (K,)."""

    angles_rad: Floats
    left: NDArray[np.bool_]
    entries: Floats
    exits: Floats
    inner_m: Floats

    def rows(self, kept: NDArray[np.int64]) -> FigureOptions:
        """Some of them."""
        return FigureOptions(*(getattr(self, name)[kept] for name in FigureOptions.__slots__))


@dataclass(frozen=True, slots=True)
class FigureTarget:
    """Ground that is seen by flying a figure."""

    region: MergedRegion
    survey: Survey
    figure: Figure
    around: Surroundings

    def options(self, angles_rad: Floats, etas: Floats) -> FigureOptions | None:
        """Options at these angles; None where none may be flown."""
        found = [
            (angle, left, *way)
            for angle in angles_rad.tolist()
            for left in ((True,) if self.figure.period_rad == math.tau else (True, False))
            if (way := self._flown(angle, left)) is not None
        ]
        if not found:
            return None
        angles, lefts, entries, exits, inner_m = zip(*found, strict=True)
        return FigureOptions(
            np.array(angles), np.array(lefts), np.array(entries), np.array(exits), np.array(inner_m)
        )

    def coarse(self, step_rad: float, etas: Floats) -> FigureOptions:
        """Options all round.

        Raises
        ------
        InfeasibleError
            Where none may be flown.
        """
        period_rad = self.figure.period_rad
        steps = max(math.ceil(period_rad / min(step_rad, MOST_STEP_RAD)), 2)
        angles_rad: Floats = period_rad / steps * np.arange(float(steps))
        if self.region.approach_rad is not None and self.figure.period_rad == math.tau:
            angles_rad = np.asarray(self.region.approach_rad, dtype=np.float64)
        found = self.options(angles_rad, etas)
        if found is None:
            raise refusal(self.region, self.around)
        return found

    def key(self, picked: FigureOptions) -> tuple[float, ...]:
        """What those near an option are found by."""
        return (float(picked.angles_rad[0]),)

    def near(
        self, picked: FigureOptions, step_rad: float, step_eta: float, between: Between | None = None
    ) -> FigureOptions:
        """Options at angles round one."""
        angles_rad = picked.angles_rad[0] + step_rad * np.arange(-NEAR_ANGLES, NEAR_ANGLES + 1.0)
        return self.options(angles_rad, np.zeros(1)) or picked

    def passes(self, options: FigureOptions, index: int) -> tuple[CollectPass, ...]:
        """A pass each line."""
        left = bool(options.left[index])
        lines = self.figure.lines(float(options.angles_rad[index]), left)
        return tuple(
            collect_along(self.region, self.survey, line, 0.5, goes_on=bool(goes_on))
            for line, goes_on in zip(lines, self.figure.goes_on(left), strict=True)
        )

    def hidden_m(self, passes: Sequence[CollectPass]) -> float:
        """Nothing: what terrain hides hardly depends on the choice."""
        return 0.0

    def plain(self) -> FigureTarget:
        """Itself: there are no simpler ways."""
        return self

    def can_be_flown(self) -> bool:
        """Whether some way may be flown."""
        try:
            self.coarse(MOST_STEP_RAD, np.zeros(1))
        except InfeasibleError:
            return False
        return True

    def _flown(self, angle_rad: float, left: bool) -> tuple[Floats, Floats, float] | None:
        """Entry, exit and cost; None where a line of it may not be flown."""
        if isinstance(self.figure, Looks) and not self._looks(angle_rad):
            return None
        lines, around = self.figure.lines(angle_rad, left), self.around
        ahead = lines[:, 1] - lines[:, 0]
        angles_rad = np.arctan2(ahead[:, 1], ahead[:, 0])
        entries, exits = poses_of(lines, angles_rad, around.settle_m)
        goes_on = self.figure.goes_on(left)
        entries[goes_on] = poses_of(lines[goes_on], angles_rad[goes_on], 0.0)[0]
        inner_m = 0.0
        for some, where in ((~goes_on, around), (goes_on, replace(around, settle_m=0.0))):
            good, cost_m = judge_lines(lines[some][:, None], where)
            if not good.all():
                return None
            inner_m += float(cost_m.sum())
        inner_m += float(dubins_lengths(exits[:-1], entries[1:], around.radius_m).sum())
        return entries[0], exits[-1], inner_m + float(cramped_m(entries[:1], exits[-1:], around)[0])

    def _looks(self, angle_rad: float) -> bool:
        """Whether looks turned by an angle hold the ground, from allowed headings."""
        figure = self.figure
        assert isinstance(figure, Looks)
        headings_rad: Floats = angle_rad + figure.period_rad * np.arange(float(figure.count))
        if not allowed(self.region.approach_rad, headings_rad).all():
            return False
        return all(figure.holds(heading_rad) for heading_rad in headings_rad.tolist())


def figure_target(
    region: MergedRegion, camera: CameraSensor, height_m: float, around: Surroundings
) -> FigureTarget:
    """The figure that a region's pattern names.

    Raises
    ------
    InfeasibleError
        ``"look"``: the region is wider than an image from every direction.
    """
    survey = Survey(region.area, region.area, camera, height_m)
    figure: Figure
    if region.pattern == "spiral":
        figure = spiral(region.area, camera, height_m, around.radius_m)
    elif region.pattern == "orbit" and camera.tilt_rad == 0.0:
        figure = rings(region.area, camera, height_m, around.radius_m)
    else:
        figure = Looks(region.area, camera, height_m, LOOKS if region.pattern == "orbit" else 1)
        every_rad = np.radians(np.arange(0.0, 360.0, 5.0))
        held = [figure.holds(angle_rad) for angle_rad in every_rad.tolist()]
        if not (all(held) if region.pattern == "orbit" else any(held)):
            raise InfeasibleError(
                "look",
                region.label,
                f"is wider than what an image of camera {camera.name} sees from {height_m:.0f} m",
                "fly higher, divide it, or take the pattern lanes",
                region.centroid,
            )
    return FigureTarget(region, survey, figure, around)
