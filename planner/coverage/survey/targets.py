"""Ground that is seen lane by lane, as a stop of the tour."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from shapely.geometry import Polygon

from planner.airspace.surroundings import Surroundings
from planner.coverage.lines import roomy
from planner.coverage.merge import MergedRegion
from planner.coverage.survey.headings import MOST_TELLING, headings
from planner.coverage.survey.lacking import lacking_m
from planner.coverage.survey.lanes import Survey
from planner.coverage.survey.options import MOST_LAID, LaneOptions, collect_passes, lane_options
from planner.coverage.ways import Between
from planner.errors import InfeasibleError
from planner.route import CollectPass
from planner.sensors.camera import CameraSensor

Floats = NDArray[np.float64]

#: Finer options: this many headings and offsets to either side.
NEAR_ANGLES, NEAR_ETAS = 3, 1
#: Lanes laid for finer ones.
MOST_NEAR = MOST_LAID // 6
#: Headings tried where a coarse grid leaves nothing, or no room for turns.
FINE_STEP_RAD = math.radians(2.5)
FINE_ETAS = np.linspace(0.0, 1.0, 5)


@dataclass(frozen=True, slots=True)
class LaneTarget:
    """One piece of ground, seen lane by lane."""

    region: MergedRegion
    survey: Survey
    around: Surroundings
    _laid: dict[bytes, tuple[CollectPass, ...]] = field(default_factory=dict, compare=False, repr=False)

    def options(self, angles_rad: Floats, etas: Floats) -> LaneOptions | None:
        """Options at these headings and offsets; None where there are none."""
        return lane_options(self.region, self.survey, angles_rad, etas, self.around)

    def coarse(self, step_rad: float, etas: Floats, telling: int = MOST_TELLING) -> LaneOptions:
        """The options to choose an order by.

        Raises
        ------
        InfeasibleError
            Where no option keeps the hard constraints.
        """
        options = self.options(self._headings(step_rad, telling), etas)
        if options is not None and self._with_room(options).any():
            return options
        finer = self.options(self._headings(FINE_STEP_RAD, telling), FINE_ETAS)
        if finer is None:
            if options is None:
                raise refusal(self.region, self.around, self.survey)
            return options
        kept = np.flatnonzero(self._with_room(finer))
        return finer.rows(kept) if len(kept) else options or finer

    def key(self, picked: LaneOptions) -> tuple[float, ...]:
        """What those near an option are found by."""
        return (float(picked.angles_rad[0]), float(picked.etas[0]))

    def near(
        self, picked: LaneOptions, step_rad: float, step_eta: float, between: Between | None = None
    ) -> LaneOptions:
        """Options round a single one; that one where there are none."""
        angles_rad = picked.angles_rad[0] + step_rad * np.arange(-NEAR_ANGLES, NEAR_ANGLES + 1.0)
        if self.region.approach_rad is not None:
            angles_rad = self._headings(step_rad, 0)
        etas = np.unique(
            np.clip(picked.etas[0] + step_eta * np.arange(-NEAR_ETAS, NEAR_ETAS + 1.0), 0.0, 1.0)
        )
        found = lane_options(self.region, self.survey, angles_rad, etas, self.around, between, MOST_NEAR)
        return picked if found is None else found

    def passes(self, options: LaneOptions, index: int) -> tuple[CollectPass, ...]:
        """The passes of one option; true costs ask for the same ones again and again."""
        row = (options.angles_rad[index], options.etas[index], options.orders[index])
        key = b"".join(each.tobytes() for each in row)
        if key not in self._laid:
            self._laid[key] = collect_passes(self.region, self.survey, options, index, self.around)
        return self._laid[key]

    def hidden_m(self, passes: Sequence[CollectPass]) -> float:
        """Nothing: what terrain hides from above hardly depends on the choice."""
        return 0.0

    def plain(self) -> LaneTarget:
        """Itself: there are no simpler ways."""
        return self

    def _headings(self, step_rad: float, telling: int) -> Floats:
        return headings(self.region, self.survey, step_rad, math.pi * self.around.radius_m, telling)

    def _with_room(self, options: LaneOptions) -> NDArray[np.bool_]:
        """Which options have room for a full turn at both ends."""
        return roomy(options.entries, self.around) & roomy(options.exits, self.around)


def surveyed(region: MergedRegion, camera: CameraSensor, height_m: float) -> Survey:
    """A region as one survey, whatever cuts it."""
    ground = region.area.convex_hull
    assert isinstance(ground, Polygon), "regions have an extent"
    return Survey(ground, ground, camera, height_m)


def refusal(region: MergedRegion, around: Surroundings, survey: Survey | None = None) -> InfeasibleError:
    """What to say where every way is forbidden; of lanes, by how much."""
    out_m = 0.0 if survey is None else lacking_m(survey, around)
    message = "no lanes that see it may be flown: they leave the operating area"
    if len(around.hard) + len(around.hard_polygons) > 0:
        message += " or enter a hard zone"
    fix = "enlarge the area round it"
    if 0.0 < out_m < math.inf:
        message += f", by {out_m:.0f} m at the best heading"
        if around.settle_m > 0.0:
            message += f" with the {around.settle_m:.0f} m flown straight before each (settle_m)"
        fix += f" by {math.ceil(out_m)} m and room for turns"
        fix += ", lower settle_m" if around.settle_m > 0.0 else ""
    return InfeasibleError(
        "area",
        region.label,
        message,
        f"{fix}, or cut out of it what may not be flown over",
        region.centroid,
    )
