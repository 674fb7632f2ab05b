"""Sweeps that cannot be flown where they were laid, moved to where they can.

Sweeps are laid without a look at the turns between them, and some are so short that a camera could not take
two photos on them. What such a sweep alone sees is looked for from lines at other headings and places: they
have room for a full turn at both ends, and are long enough for their photos.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import Point
from shapely.geometry.base import BaseGeometry

from planner.airspace.airspace import Airspace, Level
from planner.airspace.built import bare_ground
from planner.airspace.zones import TRANSIT_MARGIN_M
from planner.coverage.survey.frame import lengthened_m
from planner.coverage.urban.frontier import turned
from planner.coverage.urban.measures import Sweep
from planner.coverage.urban.regions import LEAST_PASS_M, open_ground, pass_of
from planner.route import CollectPass
from planner.sensors.camera import CameraSensor
from planner.sensors.camera_view import seen_on_flat
from planner.vehicle.model import FlightModel
from planner.wishes import Region

Floats = NDArray[np.float64]

#: Headings looked at are so far apart; lines at each of them, and places on each line.
STEP_RAD, LINES, PLACES = math.radians(15.0), 9, 9
#: Lines keep this much more than the margin of transits.
SPARE_M = 0.02
#: Less ground is none.
LEAST_M2 = 1e-2
#: Shorter stretches of a line are none.
LEAST_LINE_M = 0.1


@dataclass(frozen=True, slots=True)
class Moves:
    """What sweeps over one region may be moved among.

    Parameters
    ----------
    room
        Where lines may be flown.
    turns
        Where the middles of full turns may lie.
    wanted
        The ground to be seen.
    edge
        Of all that is looked at for lines.
    """

    region: Region
    camera: CameraSensor
    height_m: float
    room: BaseGeometry
    turns: BaseGeometry
    wanted: BaseGeometry
    radius_m: float
    settle_m: float
    edge: BaseGeometry

    @classmethod
    def over(
        cls,
        region: Region,
        camera: CameraSensor,
        height_m: float,
        airspace: Airspace,
        level: Level,
        model: FlightModel,
    ) -> Moves:
        """Over a region and as far beyond its edges as sweeps for it may reach."""
        reach_m = 2.0 * height_m + model.turn_radius_m + model.settle_m
        beside: BaseGeometry = region.area.convex_hull.buffer(reach_m, join_style="mitre")
        if airspace.area is not None:
            beside = shapely.intersection(
                beside, airspace.area.buffer(-TRANSIT_MARGIN_M - SPARE_M), grid_size=1e-6
            )
        margin_m = airspace.clearance_m + TRANSIT_MARGIN_M + SPARE_M
        room = open_ground(beside, airspace, level, margin_m)
        turns = _largest(room.buffer(-model.turn_radius_m - SPARE_M))
        shapely.prepare(room)
        shapely.prepare(turns)
        wanted = bare_ground(region.area, airspace, level)
        across_m = (model.turn_radius_m, model.settle_m)
        return cls(region, camera, height_m, room, turns, wanted, *across_m, shapely.boundary(beside))

    @property
    def overlap_m(self) -> float:
        """How far inside the frame's edge what is to overlap as asked lies."""
        wide_m = self.height_m * math.tan(self.camera.optics.half_width_rad)
        return max(self.camera.side_overlap, self.camera.forward_overlap) * wide_m

    @property
    def frame_m2(self) -> float:
        """How much ground one photo sees."""
        optics = self.camera.optics
        return 4.0 * self.height_m**2 * math.tan(optics.half_width_rad) * math.tan(optics.half_height_rad)

    def reached(self, places: Sequence[Sequence[float]]) -> Moves:
        """Among what is reached from places, or from beside the region: not what obstacles shut in."""
        here = shapely.union(shapely.multipoints(places), self.edge.buffer(SPARE_M))
        kept = [part for part in shapely.get_parts(self.room) if part.intersects(here)]
        room = shapely.multipolygons(kept)
        shapely.prepare(room)
        return replace(self, room=room)

    def turns_at(self, place: Sequence[float], angle_rad: float) -> bool:
        """Whether a full turn fits beside a place, to one side or the other of a heading."""
        return bool(self._fits(np.array([place]), angle_rad)[0])

    def enters(self, collect: CollectPass) -> bool:
        """Whether a full turn fits before a pass and its settling."""
        return self.turns_at(collect.settling(self.settle_m).position, collect.angle_rad)

    def leaves(self, collect: CollectPass) -> bool:
        """Whether one fits behind it."""
        return self.turns_at(collect.end, collect.angle_rad)

    def moved(self, passes: Sequence[CollectPass], index: int) -> tuple[CollectPass, ...] | None:
        """What a pass is replaced by: one that sees what no other does, none where there is no such ground.

        None where there is no such line.
        """
        own = passes[index]
        others = [each.footprint for k, each in enumerate(passes) if k != index]
        alone = shapely.intersection(own.footprint, self.wanted)
        near = [each for each in others if each.intersects(alone)]
        alone = shapely.difference(alone, shapely.union_all(near), grid_size=1e-6)
        if alone.area < LEAST_M2:
            return ()
        around = (
            passes[index - 1].end if index else own.start,
            passes[index + 1].start if index + 1 < len(passes) else own.end,
        )
        best: tuple[float, CollectPass] | None = None
        headings_rad = own.angle_rad + np.arange(0.0, math.pi, STEP_RAD)
        for angle_rad in headings_rad.tolist():
            for line in self._lines(alone, angle_rad):
                for one, other in (line, line[::-1]):
                    cost_m = math.dist(around[0], one) + math.dist(one, other) + math.dist(other, around[1])
                    if best is not None and cost_m >= best[0]:
                        continue
                    laid = self._pass(Sweep((one[0], one[1]), (other[0], other[1])))
                    if shapely.difference(alone, laid.footprint).area < LEAST_M2 and self._flyable(laid):
                        best = (cost_m, laid)
        return None if best is None else (best[1],)

    def seeing(
        self, ground: BaseGeometry, ends: Floats, starts: Floats, *, roomy: bool = True
    ) -> Iterator[tuple[list[int], CollectPass]]:
        """Passes that see all of some ground, the nearest first, each with where it is put in, as near first.

        Parameters
        ----------
        ends, starts
            What a pass may be put in between: the end of one and the start of the next, (N, 2) each.
        roomy
            Whether they have room for full turns; without, transits tell whether they can be flown.
        """
        lines: list[Floats] = []
        for angle_rad in np.arange(0.0, math.pi, STEP_RAD).tolist():
            found = np.array(self._lines(ground, angle_rad, roomy=roomy))
            lines += [found, found[:, ::-1]] if len(found) else []
        if not lines:
            return
        laid_m = np.concatenate(lines)
        gaps_m = np.hypot(*(starts - ends).T)
        costs_m = np.hypot(*(laid_m[:, 1] - laid_m[:, 0]).T)[:, None] - gaps_m
        costs_m += np.hypot(*np.moveaxis(laid_m[:, None, 0] - ends, -1, 0))
        costs_m += np.hypot(*np.moveaxis(starts - laid_m[:, None, 1], -1, 0))
        # By the millimetre: lines that cost as much come in their order.
        for k in np.argsort(np.round(costs_m.min(axis=1), 3), kind="stable").tolist():
            one, other = laid_m[k].tolist()
            laid = self._pass(Sweep((one[0], one[1]), (other[0], other[1])))
            seen = shapely.difference(ground, laid.footprint).area < LEAST_M2
            if seen and (self._flyable(laid) if roomy else self._free(laid)):
                yield np.argsort(np.round(costs_m[k], 3), kind="stable").tolist(), laid

    def _pass(self, sweep: Sweep) -> CollectPass:
        """Its pass, no longer than it is."""
        return pass_of(self.region, self.camera, self.height_m, sweep, Point(sweep.start))

    def _flyable(self, laid: CollectPass) -> bool:
        """Whether it begins and ends with room, flown this way."""
        return self._free(laid) and self.enters(laid) and self.leaves(laid)

    def _free(self, laid: CollectPass) -> bool:
        """Whether it and its settling are clear."""
        begun = laid.settling(self.settle_m).position
        return bool(self.room.covers(shapely.linestrings([begun, laid.end])))

    def _lines(
        self, ground: BaseGeometry, angle_rad: float, *, roomy: bool = True
    ) -> list[list[list[float]]]:
        """Lines at a heading from which ground is seen about, each from end to end."""
        frame_m = self._frame(angle_rad)
        corners = turned(shapely.get_coordinates(ground.convex_hull), -angle_rad)
        (west, south), (east, north) = corners.min(axis=0), corners.max(axis=0)
        # Photos from begin to end see from begin + back to end + ahead, and from low to high beside them.
        back_m, ahead_m, low_m, high_m = frame_m
        lowest_m, highest_m = north - high_m, south - low_m
        if highest_m < lowest_m:
            return []
        found = []
        reach_m = self.height_m + east - west + ahead_m - back_m
        for across_m in np.linspace(lowest_m, highest_m, LINES).tolist():
            line = np.array([[west - back_m - reach_m, across_m], [east - ahead_m + reach_m, across_m]])
            whole = shapely.intersection(shapely.linestrings(turned(line, angle_rad)), self.room)
            for part in shapely.get_parts(whole):
                if part.length < LEAST_LINE_M:
                    continue
                along = turned(shapely.get_coordinates(part), -angle_rad)[:, 0]
                found += self._placed(
                    (float(along.min()), float(along.max())),
                    (west - back_m, east - ahead_m),
                    across_m,
                    angle_rad,
                    roomy=roomy,
                )
        return found

    def _placed(
        self,
        free_m: tuple[float, float],
        needed_m: tuple[float, float],
        across_m: float,
        angle_rad: float,
        *,
        roomy: bool,
    ) -> list[list[list[float]]]:
        """Parts of a line's free stretch that reach over what is needed and have room for turns.

        Parameters
        ----------
        free_m
            From where to where it is free, along the heading.
        needed_m
            Where it has to have begun, and may end at the earliest.
        """
        last_begin, first_end = min(needed_m[0], free_m[1]), max(needed_m[1], free_m[0])
        if last_begin < free_m[0] or first_end > free_m[1]:
            return []
        begins = np.linspace(free_m[0], last_begin, PLACES)
        ends = np.linspace(first_end, free_m[1], PLACES)
        begin, end = (each.ravel() for each in np.meshgrid(begins, ends, indexing="ij"))
        # From where it begins on, no longer than its photos ask for, too.
        least = begins + self._least_m(np.maximum(first_end - begins, LEAST_PASS_M), angle_rad)
        begin, end = np.concatenate([begin, begins]), np.concatenate([end, least])
        length_m = end - begin
        spacing_m = self.camera.photo_spacing_m(self.height_m, angle_rad)
        interval_m = self._interval_m(angle_rad)
        more_m = lengthened_m(length_m, np.full(1, spacing_m), np.full(1, interval_m))
        good = (length_m >= LEAST_PASS_M - 1e-9) & (more_m <= 1e-9)
        good &= (end >= first_end - 1e-9) & (end <= free_m[1] + 1e-9)
        begin, end = begin[good], end[good]
        places = [
            turned(np.column_stack([along, np.full(len(along), across_m)]), angle_rad)
            for along in (begin, end)
        ]
        good = np.full(len(begin), not roomy)
        good |= self._fits(places[0], angle_rad) & self._fits(places[1], angle_rad)
        lines: list[list[list[float]]] = np.stack([each[good] for each in places], axis=1).tolist()
        return lines

    def _least_m(self, lengths_m: Floats, angle_rad: float) -> Floats:
        """Lengths, longer where photos would come too soon, by a little more than that takes."""
        spacing_m = self.camera.photo_spacing_m(self.height_m, angle_rad)
        more_m = lengthened_m(lengths_m, np.full(1, spacing_m), np.full(1, self._interval_m(angle_rad)))
        return lengths_m + more_m + 1e-6

    def _interval_m(self, angle_rad: float) -> float:
        """The least way between photos, there or back."""
        ways = (angle_rad, angle_rad + math.pi)
        return max(self.camera.least_spacing_m(way_rad) for way_rad in ways)

    def _frame(self, angle_rad: float) -> tuple[float, float, float, float]:
        """How far what a line's photos see begins after its start and ends after its end, and how wide it is.

        As of the narrower of both ways.
        """
        frames = []
        for way_rad in (angle_rad, angle_rad + math.pi):
            ahead = (math.cos(way_rad), math.sin(way_rad))
            seen = seen_on_flat(self.camera, ((0.0, 0.0), ahead), self.height_m)
            corners = turned(shapely.get_coordinates(seen), -angle_rad)
            sign = 1.0 if way_rad == angle_rad else -1.0
            along = corners[:, 0]
            first, last = min(0.0, sign), max(0.0, sign)
            frames.append((along.min() - first, along.max() - last, corners[:, 1].min(), corners[:, 1].max()))
        (back, ahead_m, low, high), (back2, ahead2, low2, high2) = frames
        along_m = (float(max(back, back2)), float(min(ahead_m, ahead2)))
        return (*along_m, float(max(low, low2)), float(min(high, high2)))

    def _fits(self, places: Floats, angle_rad: float) -> NDArray[np.bool_]:
        """Whether a full turn fits beside places, to one side or the other."""
        left = self.radius_m * np.array([-math.sin(angle_rad), math.cos(angle_rad)])
        sides = [shapely.contains_xy(self.turns, *(places + side * left).T) for side in (1.0, -1.0)]
        return np.asarray(sides[0] | sides[1], dtype=np.bool_)


def _largest(shape: BaseGeometry) -> BaseGeometry:
    parts = shapely.get_parts(shape)
    return max(parts, key=lambda part: float(part.area)) if len(parts) else shape
