"""How cameras that look down see regions: the family of lanes."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from planner.airspace.surroundings import Surroundings
from planner.coverage.lines import cramped_m, judge_lines, poses_of
from planner.coverage.merge import MergedRegion
from planner.coverage.sharing import Apart
from planner.coverage.survey.lanes import check_camera, fewest_lanes, lanes_at
from planner.coverage.ways import Between, Division
from planner.dubins.estimate_kernels import transit_costs
from planner.errors import InfeasibleError
from planner.progress import Stop
from planner.route import CollectPass
from planner.sensors.camera import CameraSensor
from planner.sensors.camera_view import seen_on_flat
from planner.wishes import Region

Floats = NDArray[np.float64]

STEP_RAD = math.radians(10.0)
#: Finer headings to either side of one picked.
NEAR_ANGLES = 3


@dataclass(frozen=True, slots=True)
class LaneOptions:
    """Lanes there and back at one heading each, from one side or the other."""

    lines: tuple[Floats, ...]
    entries: Floats
    exits: Floats
    inner_m: Floats

    def rows(self, kept: Any) -> LaneOptions:
        """Some of them."""
        lines = tuple(self.lines[k] for k in np.asarray(kept).tolist())
        return LaneOptions(lines, self.entries[kept], self.exits[kept], self.inner_m[kept])


@dataclass(frozen=True, slots=True)
class LaneTarget:
    """A region seen lane by lane."""

    region: MergedRegion
    sensor: CameraSensor
    height_m: float
    around: Surroundings

    def options(self, angles_rad: Floats, etas: Floats) -> LaneOptions | None:
        """Options at these headings, or those the region allows; None where none may be flown."""
        allowed = self.region.approach_rad
        angles = angles_rad if allowed is None else np.asarray(allowed, dtype=np.float64)
        rows = [row for angle in angles.tolist() for row in self._sweeps(angle)]
        if not rows:
            return None
        lines, entries, exits, costs_m = zip(*rows, strict=True)
        return LaneOptions(lines, np.array(entries), np.array(exits), np.array(costs_m))

    def coarse(self, step_rad: float, etas: Floats) -> LaneOptions:
        """Options about a step apart."""
        angles_rad = np.arange(0.0, math.tau - 1e-9, max(step_rad, STEP_RAD))
        found = self.options(np.union1d(angles_rad, self._edges_rad()), etas)
        if found is None:
            raise InfeasibleError(
                "area", self.region.label, "no lanes over it may be flown", "enlarge the area"
            )
        return found

    def near(
        self, picked: LaneOptions, step_rad: float, step_eta: float, between: Between | None = None
    ) -> LaneOptions:
        """Options at finer headings round one."""
        angle_rad = float(picked.entries[0, 2])
        steps: Floats = step_rad * np.arange(-NEAR_ANGLES, NEAR_ANGLES + 1, dtype=np.float64)
        return self.options(angle_rad + steps, np.array([0.5])) or picked

    def passes(self, options: LaneOptions, index: int) -> tuple[CollectPass, ...]:
        """One pass a lane."""
        found = []
        for line in options.lines[index]:
            start, end = ((float(east), float(north)) for east, north in line)
            seen = seen_on_flat(self.sensor, line, self.height_m)
            angle_rad = math.atan2(end[1] - start[1], end[0] - start[0])
            apart_m = self.sensor.photo_spacing_m(self.height_m, angle_rad)
            laid = CollectPass(self.region.names, self.sensor.name, "down", start, end, 0.5, seen, apart_m)
            found.append(laid)
        return tuple(found)

    def hidden_m(self, passes: Sequence[CollectPass]) -> float:
        """Nothing: what terrain hides from above does not depend on the choice of lanes."""
        return 0.0

    def plain(self) -> LaneTarget:
        """There are none but plain ways."""
        return self

    def _edges_rad(self) -> Floats:
        corners = shapely.get_coordinates(self.region.area.convex_hull.simplify(1.0))
        edges = np.diff(corners, axis=0)
        angles = np.arctan2(edges[:, 1], edges[:, 0])
        found: Floats = np.mod(np.concatenate([angles, angles + math.pi]), math.tau)
        return found

    def _sweeps(self, angle_rad: float) -> list[tuple[Floats, Floats, Floats, float]]:
        lanes = lanes_at(self.region.area, self.sensor, self.height_m, angle_rad)
        if len(lanes) == 0:
            return []
        found = []
        for order in (lanes, lanes[::-1]) if len(lanes) > 1 else (lanes,):
            flown = order.copy()
            flown[1::2] = flown[1::2, ::-1]
            good, cost_m = judge_lines(flown[:, None], self.around)
            if not good.all():
                return []
            angles: Floats = angle_rad + math.pi * (np.arange(len(flown), dtype=np.float64) % 2.0)
            if self.region.approach_rad is not None and not _all_allowed(angles, self.region.approach_rad):
                return []
            entries, exits = poses_of(flown, angles, self.around.settle_m)
            turns_m = sum(
                float(transit_costs(exits[k : k + 1], entries[k + 1 : k + 2], self.around.radius_m,
                                    self.around.discs)[0, 0])
                for k in range(len(flown) - 1)
            )  # fmt: skip
            total_m = float(cost_m.sum()) + turns_m
            total_m += float(cramped_m(entries[:1], exits[-1:], self.around)[0])
            found.append((flown, entries[0], exits[-1], total_m))
        return found


def _all_allowed(angles_rad: Floats, allowed_rad: Sequence[float]) -> bool:
    return all(
        any(abs(math.remainder(angle - each, math.tau)) < math.radians(1.0) for each in allowed_rad)
        for angle in angles_rad.tolist()
    )


@dataclass(frozen=True, slots=True)
class Lanes:
    """See ``planner.coverage.ways.Family``."""

    def check(self, region: Region, sensor: CameraSensor, height_m: float) -> None:
        """Refuse a height that keeps no overlap."""
        check_camera(region.name, sensor, height_m)

    def check_seen(
        self, region: Region, sensor: CameraSensor, height_m: float, area: Any, settle_m: float, *, wide: bool
    ) -> None:
        """Refuse the same; whether lanes have room is seen when they are laid."""
        check_camera(region.name, sensor, height_m)

    def fewest_passes(self, region: Region, sensor: CameraSensor, height_m: float) -> tuple[int, float]:
        """How many lanes a region takes at least, and the widest distance between them."""
        return fewest_lanes(region.area, sensor, height_m, np.arange(0.0, math.pi, STEP_RAD))

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
    ) -> tuple[LaneTarget, ...]:
        """One stop for each part and visit."""
        return tuple(
            LaneTarget(visit, sensor, height_m, around) for part in region.split() for visit in _visits(part)
        )

    def can_be_flown(
        self, region: MergedRegion, sensor: CameraSensor, height_m: float, around: Surroundings, *, wide: bool
    ) -> bool:
        """Whether lanes at some heading may be flown over every part."""
        angles_rad = np.arange(0.0, math.tau, STEP_RAD)
        return all(
            LaneTarget(part, sensor, height_m, around).options(angles_rad, np.array([0.5])) is not None
            for part in region.split()
        )

    def sharing(self, *_: Any) -> Apart:
        """Nothing is shared."""
        return Apart()

    def undivided(
        self, region: MergedRegion, sensor: CameraSensor, height_m: float, around: Surroundings
    ) -> Iterator[LaneTarget]:
        """The region as one target."""
        yield LaneTarget(region, sensor, height_m, around)


def _visits(part: MergedRegion) -> tuple[MergedRegion, ...]:
    if part.revisits == 1:
        return (part,)
    return tuple(replace(part, visit=(k, part.revisits)) for k in range(1, part.revisits + 1))
