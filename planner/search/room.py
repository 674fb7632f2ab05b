"""Where a search's passes may lie: in the area, out of zones, with room for a turn at either end."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import LineString, MultiPolygon, Point, Polygon, box
from shapely.geometry.base import BaseGeometry

from planner.airspace.airspace import Airspace, Level
from planner.airspace.surroundings import MARGIN_M, surroundings
from planner.airspace.zones import AREA, TRANSIT_MARGIN_M, keep_out
from planner.search.reached import ALL_OF_IT, Reached
from planner.vehicle.model import FlightModel
from planner.wishes import Objective

Floats = NDArray[np.float64]
Place = tuple[float, float]

#: Places at which room for a turn is looked for: so many to a radius, but no closer than this.
STEPS, LEAST_STEP_M = 4.0, 2.0
#: Where there is no area, lines stay this many radii round the ground, and this far at least.
ROUND, LEAST_ROUND_M = 8.0, 500.0
#: A pass is no shorter than this.
LEAST_PASS_M = 2.0
EMPTY = Polygon()


@dataclass(frozen=True, slots=True, eq=False)
class Room:
    """Where one aircraft may fly straight, and turn.

    Parameters
    ----------
    free
        Where lines may be, margins taken off.
    turning
        Where the centre of a turn may be.
    radius_m, settle_m
        Of its turns, and straight flight before each pass.
    zones
        What is kept out of by name, margins included, the area's outside among it.
    barred
        What of the ground may never be flown over, whatever that costs.
    reached
        What hangs together with the start, and what of the ground does not.
    """

    free: BaseGeometry
    turning: BaseGeometry
    radius_m: float
    settle_m: float
    zones: tuple[tuple[str, BaseGeometry], ...] = ()
    barred: BaseGeometry = EMPTY
    reached: Reached = ALL_OF_IT

    @classmethod
    def of(
        cls,
        airspace: Airspace,
        level: Level,
        model: FlightModel,
        objective: Objective,
        ground: Polygon | MultiPolygon,
        reached: Reached = ALL_OF_IT,
    ) -> Room:
        """The room at a level over ground and round it; threats that cost anything are kept out of."""
        around = surroundings(airspace, level, model, objective)
        free: BaseGeometry = around.area if around.area is not None else Polygon()
        if around.area is None:
            reach_m = max(LEAST_ROUND_M, ROUND * model.turn_radius_m)
            west_m, south_m, east_m, north_m = ground.bounds
            free = box(west_m - reach_m, south_m - reach_m, east_m + reach_m, north_m + reach_m)
        soft = around.soft if around.prices is None else around.soft[around.prices > 0.0]
        discs = [Point(e, n).buffer(r, quad_segs=32) for e, n, r in np.vstack([around.hard, soft]).tolist()]
        free = shapely.difference(free, shapely.union_all([*around.hard_polygons, *discs]))
        if reached.free is not None:
            free = shapely.intersection(free, reached.free)
        turning = free.buffer(-model.turn_radius_m)
        for place in (free, turning):
            shapely.prepare(place)
        kept = keep_out(airspace, level, MARGIN_M, edge_m=TRANSIT_MARGIN_M)
        shapes: list[tuple[str, BaseGeometry, bool]] = [
            (disc.name, Point(disc.east_m, disc.north_m).buffer(disc.radius_m), disc.hard)
            for disc in kept.discs
        ]
        shapes += [(zone.name, zone.polygon, zone.hard) for zone in kept.polygons]
        if kept.area is not None:
            outside = ground.envelope.buffer(2.0 * model.turn_radius_m).difference(kept.area)
            shapes.append((AREA, outside, True))
        zones = tuple((name, shape) for name, shape, _ in shapes)
        barred = ground.intersection(shapely.union_all([shape for _, shape, hard in shapes if hard]))
        return cls(free, turning, model.turn_radius_m, model.settle_m, zones, barred, reached)

    def blocking(self, ground: BaseGeometry) -> tuple[str, ...]:
        """Names of what leaves no pass over ground, or no turn beside it: most of it first."""
        found: dict[str, float] = {}
        for name, zone in self.zones:
            share_m2 = zone.buffer(self.radius_m).intersection(ground).area
            if share_m2 > 0.0:
                found[name] = found.get(name, 0.0) + share_m2
        return tuple(sorted(found, key=lambda name: (-found[name], name)))

    def flyable(self, lines: Floats) -> list[list[tuple[Place, Place]]]:
        """Of each of several lines (N, 2, 2) the parts that may be flown as passes, in flight order."""
        lengths_m = np.hypot(*(lines[:, 1] - lines[:, 0]).T)
        along = (lines[:, 1] - lines[:, 0]) / np.maximum(lengths_m, 1e-9)[:, None]
        before = lines[:, 0] - self.settle_m * along
        clear = shapely.covers(self.free, shapely.linestrings(np.stack([before, lines[:, 1]], axis=1)))
        turns = self._turns(before, along) & self._turns(lines[:, 1], along)
        whole = np.logical_and(clear, turns)
        found: list[list[tuple[Place, Place]]] = []
        for k, (start, end) in enumerate(lines.tolist()):
            if lengths_m[k] < LEAST_PASS_M:
                found.append([])
            elif whole[k]:
                found.append([(tuple(start), tuple(end))])
            else:
                found.append(self._parts(before[k], lines[k, 1], along[k]))
        return found

    def _turns(self, places: Floats, along: Floats) -> NDArray[np.bool_]:
        """Where there is room for a turn to either side, flying along."""
        aside = self.radius_m * np.stack([-along[..., 1], along[..., 0]], axis=-1)
        left, right = places + aside, places - aside
        return np.asarray(
            shapely.contains_xy(self.turning, left[..., 0], left[..., 1])
            | shapely.contains_xy(self.turning, right[..., 0], right[..., 1])
        )

    def _parts(self, before: Floats, end: Floats, along: Floats) -> list[tuple[Place, Place]]:
        """What of a line is clear and has its turns, from the beginning of its settling run on."""
        clear = shapely.intersection(LineString([tuple(before), tuple(end)]), self.free)
        found = []
        for part in shapely.get_parts(clear):
            if isinstance(part, LineString) and part.length >= LEAST_PASS_M:
                ends = np.asarray(part.coords)[[0, -1]] @ along
                low, high = sorted((ends - before @ along).tolist())
                found += self._with_turns(before, along, low, high)
        return sorted(found, key=lambda each: float(np.dot(each[0], along)))

    def _with_turns(
        self, before: Floats, along: Floats, low_m: float, high_m: float
    ) -> list[tuple[Place, Place]]:
        """What of a clear stretch has a turn before its settling run and one behind its end."""
        step_m = max(self.radius_m / STEPS, LEAST_STEP_M)
        at_m = np.linspace(low_m, high_m, max(2, math.ceil((high_m - low_m) / step_m) + 1))
        good = np.flatnonzero(self._turns(before + at_m[:, None] * along, along))
        if not len(good):
            return []
        first_m, last_m = at_m[good[0]] + self.settle_m, at_m[good[-1]]
        if last_m - first_m < LEAST_PASS_M:
            return []
        start, end = before + first_m * along, before + last_m * along
        return [((float(start[0]), float(start[1])), (float(end[0]), float(end[1])))]
