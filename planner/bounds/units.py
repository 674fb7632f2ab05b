"""What of a scenario no plan can do without seeing, piece by piece, and which pieces passes may share.

A *unit* is a connected part of a region, on each visit asked for. Nothing is merged: that one pass may see
several units at once is for the bound to allow. Passes of two units that lie further apart than
``apart_m`` have nothing to share: where they are parts of one straight pass they are two passes as well, with
a straight line between.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import LineString, Point, Polygon
from shapely.ops import substring

from planner.bounds.nodes import HEADINGS_RAD, PLACE_M
from planner.coverage.merge import MergedRegion, split_region
from planner.coverage.strips.classify import fits, hull_points, spans_at
from planner.coverage.strips.segments import Neighbourhood
from planner.coverage.strips.sweeps import Side, sweeps
from planner.sensors.sar import SarSensor
from planner.sensors.strip import strip_on, swaths_m
from planner.wishes import Region

Sides = tuple[Side, ...]
#: The sensor and the height over the ground that see a region.
Sensing = Callable[[MergedRegion], tuple[SarSensor, float]]
Flags = NDArray[np.bool_]

#: Headings are looked at this closely for one at which a pass sees all of a region; a region that misses it
#: by less than its width changes between two of them is taken for one that a pass sees.
STEP_RAD = math.radians(0.25)
#: Of a leg so much is left out at either end.
TRIMMED = 0.1
#: Places along the outline of a unit to choose from; places nearer to each other than this are one.
PLACES, LEAST_APART_M = 48, 1.0
#: Places this near to a region are in it, roundings aside.
LEAST_OFF_M = 1e-6


@dataclass(frozen=True, slots=True)
class Unit:
    """A connected part of a region.

    Parameters
    ----------
    visits
        How often it is to be seen.
    whole
        Whether one pass sees all of it, at some heading.
    leg
        Whether it is the middle of one leg of a corridor.
    """

    region: MergedRegion
    sensor: SarSensor
    height_m: float
    whole: bool
    leg: bool = False

    @property
    def visits(self) -> int:
        """How often it is to be seen."""
        return self.region.revisits

    @property
    def sides(self) -> Sides:
        """The ways to see all of it: in one pass, or strip by strip."""
        return in_one(self.region, self.sensor, self.height_m) if self.whole else self.swept

    @property
    def swept(self) -> Sides:
        """Strip by strip, however it is divided."""
        return sweeps(self.region, self.sensor, self.height_m)

    @property
    def place(self) -> Sides:
        """The ways to see one place of it, whatever else is seen or not."""
        return self.seeing(self.region.area.representative_point())

    def seeing(self, place: Point) -> Sides:
        """The ways to see a place of it."""
        there = place.buffer(PLACE_M, quad_segs=1)
        return in_one(alone(self.region, there), self.sensor, self.height_m)

    @property
    def flown_m(self) -> float:
        """About what seeing it takes."""
        swath_m = float(swaths_m(self.sensor, self.height_m, HEADINGS_RAD).max())
        return self.region.area.area / swath_m + self.sensor.aperture_m(self.height_m)

    @property
    def reach_m(self) -> tuple[float, float]:
        """How wide its passes see at most, and how long they are before and after the ground they see."""
        strip = strip_on(self.sensor, self.height_m, HEADINGS_RAD, self.sensor.looks[0])
        around_m = np.abs(strip.run_in_m) + np.abs(strip.run_out_m)
        return float(strip.swath_m.max()), float(around_m.max())


def units(regions: Sequence[Region], sensing: Sensing, left_out: Collection[str]) -> list[Unit]:
    """Of the regions that are not left out; their plans may leave out others."""
    found = []
    for region in regions:
        if region.name in left_out:
            continue
        for part in split_region(region):
            sensor, height_m = sensing(part)
            if sensor.swath_m(height_m) > 0.0:
                unit = Unit(part, sensor, height_m, seen_at_once(part, sensor, height_m))
                found += [unit] if unit.whole or part.axis is None else _legs(unit, part.axis)
    return found


def _legs(unit: Unit, axis: LineString) -> list[Unit]:
    """The middle of each leg of a corridor, where one pass sees it; else the corridor.

    What of the axis lies nearer to a straight line than half a swath is one leg. Where passes meet at bends
    is theirs to choose.
    """
    corners = shapely.get_coordinates(axis.simplify(0.5 * unit.reach_m[0]))
    along_m = [axis.project(Point(corner)) for corner in corners]
    found = []
    for begin_m, end_m in itertools.pairwise(along_m):
        trim_m = TRIMMED * (end_m - begin_m)
        # Strips are convex: who sees a line sees its hull.
        line = substring(axis, begin_m + trim_m, end_m - trim_m)
        region = alone(unit.region, line.convex_hull.buffer(PLACE_M, quad_segs=1))
        if seen_at_once(region, unit.sensor, unit.height_m):
            found.append(replace(unit, region=region, whole=True, leg=True))
    return found or [unit]


def alone(region: MergedRegion, area: Polygon) -> MergedRegion:
    """A piece of a region that has to be seen as the region has."""
    return replace(region, area=area, originals=(area,), owners=region.names[:1], axes=())


def hull_of(areas: Sequence[Polygon]) -> Polygon:
    """The convex hull of regions."""
    hull = shapely.union_all(areas).convex_hull
    assert isinstance(hull, Polygon)
    return hull


def in_one(region: MergedRegion, sensor: SarSensor, height_m: float) -> Sides:
    """The ways to see a region in one pass."""
    angles_rad = np.zeros(1)
    spans = spans_at(hull_points(region.area), angles_rad)
    return tuple(Neighbourhood(region, sensor, height_m, look, 0, angles_rad, spans) for look in sensor.looks)


def seen_at_once(region: MergedRegion, sensor: SarSensor, height_m: float) -> bool:
    """Whether one pass may see all of a region."""
    if sensor.mode == "spotlight":
        return True
    points_m = hull_points(region.area)
    angles_rad = np.arange(0.0, math.pi, STEP_RAD)
    slack_m = STEP_RAD * float(shapely.minimum_bounding_radius(region.area))
    if region.approach_rad is not None:
        angles_rad, slack_m = np.asarray(region.approach_rad, dtype=np.float64), 0.0
    across_m = spans_at(points_m, angles_rad).across_m - slack_m
    return bool(fits(across_m, swaths_m(sensor, height_m, angles_rad), 0).any())


def near(found: Sequence[Unit], settle_m: float) -> Flags:
    """Which units may share passes: bool (U, U), none with itself."""
    areas = np.array([unit.region.area for unit in found], dtype=object)
    reach = np.array([unit.reach_m for unit in found])
    swath_m = np.minimum(reach[:, None, 0], reach[None, :, 0])
    around_m = np.maximum(reach[:, None, 1], reach[None, :, 1]) + settle_m
    out = shapely.distance(areas[:, None], areas[None, :]) < np.hypot(swath_m, around_m)
    np.fill_diagonal(out, False)
    return np.asarray(out, dtype=np.bool_)


def groups(linked: Flags) -> list[list[int]]:
    """Units that are near each other, one to the next."""
    rest, found = set(range(len(linked))), []
    while rest:
        group, front = [], [min(rest)]
        rest.discard(front[0])
        while front:
            here = front.pop()
            group.append(here)
            beside = [k for k in np.flatnonzero(linked[here]).tolist() if k in rest]
            rest.difference_update(beside)
            front += beside
        found.append(sorted(group))
    return found


def pieces(found: Sequence[Unit], in_parts: Collection[int], most: int) -> list[tuple[int, Sides]]:
    """Of each unit, by its index, what has to be seen of it: all, or places of it.

    Those come first that are longest and furthest from the others before them.
    """
    owners: list[int] = []
    places: list[Point | None] = []
    for k, unit in enumerate(found):
        own: list[Point | None] = [None]
        if not unit.whole:
            own = list(outline(unit))
        elif k in in_parts:
            own = [unit.region.area.representative_point()]
        owners += [k] * len(own)
        places += own
    middles = [place or found[k].region.area.centroid for k, place in zip(owners, places, strict=True)]
    at_m = np.array([(middle.x, middle.y) for middle in middles])
    long_m = np.array(
        [
            2.0 * float(shapely.minimum_bounding_radius(found[k].region.area)) if place is None else 0.0
            for k, place in zip(owners, places, strict=True)
        ]
    )
    off_m = np.hypot(*(at_m - at_m.mean(axis=0)).T)
    chosen: list[tuple[int, Sides]] = []
    rest = np.ones(len(places), dtype=np.bool_)
    while rest.any() and len(chosen) < most:
        best = int(np.argmax(np.where(rest, off_m + long_m, -1.0)))
        if chosen and off_m[best] + long_m[best] <= LEAST_APART_M:
            break
        away_m = np.hypot(*(at_m - at_m[best]).T)
        off_m = np.minimum(off_m, away_m) if chosen else away_m
        rest[best] = False
        place, unit = places[best], found[owners[best]]
        chosen += [(owners[best], unit.sides if place is None else unit.seeing(place))] * unit.visits
    return chosen


def outline(unit: Unit) -> list[Point]:
    """Places along the outline of a unit, all of them in it."""
    ring = unit.region.area.exterior.simplify(unit.reach_m[0] / 10.0)
    at = [Point(place) for place in shapely.get_coordinates(ring.segmentize(ring.length / PLACES))]
    # Where the outline bends inwards its chords lie outside.
    return [point for point in at if unit.region.area.distance(point) <= LEAST_OFF_M]


def apart(found: Sequence[Unit], linked: Flags) -> list[int]:
    """Units none of which is near another, those that take most first."""
    chosen: list[int] = []
    for k in sorted(range(len(found)), key=lambda k: -found[k].flown_m * found[k].visits):
        if not linked[k, chosen].any():
            chosen.append(k)
    return sorted(chosen)
