"""Which regions one strip may hold together, whatever lies between them.

Items are what one pass sees: regions, parts of them, and each of those that the close filter has joined. For
headings all round, the items whose spans across fit into one swath may be seen together; of these, runs that
follow each other along the heading, and pairs, are groups.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import Polygon

from planner.airspace.surroundings import Surroundings
from planner.coverage.merge import MergedRegion
from planner.coverage.strips.classify import fits, hull_points, spans_at
from planner.coverage.strips.segments import Neighbourhood
from planner.coverage.strips.targets import StripTarget
from planner.coverage.ways import Group, Over
from planner.errors import InfeasibleError
from planner.sensors.sar import SarSensor
from planner.sensors.strip import swaths_m

Floats = NDArray[np.float64]

#: Headings that groups are looked for at, and those their passes are tried at.
STEP_RAD, ANGLE_RAD = math.radians(5.0), math.radians(1.0)
#: Groups to try.
MOST_GROUPS = 300
#: Headings asked for are the same within this.
SAME_RAD = math.radians(0.01)


@dataclass(frozen=True, slots=True)
class _Item:
    """What one pass sees, and which of the targets it is of."""

    region: MergedRegion
    sensor: SarSensor
    height_m: float
    owner: int


class StripSharing:
    """See ``planner.coverage.ways.Sharing``: groups of targets' items, and what sees them."""

    def __init__(self, targets: Sequence[StripTarget], over: Over, around: Surroundings) -> None:
        self._over = over
        self._around = around
        self._items = list(_items(targets))
        self._groups: list[Group] | None = None
        self._gaps_m = [_gap_m(item, around.radius_m) for item in self._items]
        self._known: dict[Group, StripTarget | None] = {}

    @property
    def owners(self) -> tuple[int, ...]:
        """Of each item which target it is of."""
        return tuple(item.owner for item in self._items)

    def groups(self) -> list[Group]:
        """Groups of two items and more, those of most items first."""
        if self._groups is None:
            self._groups = self._found()
        return self._groups

    def _found(self) -> list[Group]:
        found: set[Group] = set()
        angles_rad = np.arange(0.0, math.pi - 1e-9, STEP_RAD)
        spans = [spans_at(hull_points(item.region.area), angles_rad) for item in self._items]
        swaths = [swaths_m(item.sensor, item.height_m, angles_rad) for item in self._items]
        for k in range(len(angles_rad)):
            across = [(float(span.y_min_m[k]), float(span.y_max_m[k])) for span in spans]
            along = [(float(span.x_min_m[k]), float(span.x_max_m[k])) for span in spans]
            found.update(self._at(np.array(across), np.array(along), [float(one[k]) for one in swaths]))
        areas = np.array([item.region.area for item in self._items], dtype=object)
        gaps_m = shapely.distance(areas[:, None], areas[None, :])
        for k, j in itertools.combinations(range(len(self._items)), 2):
            if gaps_m[k, j] <= self._gaps_m[k]:
                found.add(frozenset((k, j)))
        kept = [group for group in found if self._agree(group)]
        kept.sort(key=lambda group: (-len(group), sorted(group)))
        return [group for group in kept[:MOST_GROUPS] if self.target(group) is not None]

    def target(self, group: Group) -> StripTarget | None:
        """What sees a group in one pass; None where none does."""
        if group not in self._known:
            self._known[group] = self._in_one(self._region(group))
        return self._known[group]

    def _region(self, group: Group) -> MergedRegion:
        """All items of a group as one region."""
        parts = [self._items[k].region for k in sorted(group)]
        if len(parts) == 1:
            return parts[0]
        hull = shapely.union_all([part.area for part in parts]).convex_hull
        assert isinstance(hull, Polygon)
        return replace(
            parts[0],
            names=tuple(dict.fromkeys(name for part in parts for name in part.names)),
            area=hull,
            originals=tuple(area for part in parts for area in part.originals),
            owners=tuple(owner for part in parts for owner in part.owners),
            approach_rad=_common([part.approach_rad for part in parts]),
            required=any(part.required for part in parts),
            axes=(),
        )

    def _in_one(self, region: MergedRegion) -> StripTarget | None:
        try:
            sensor, height_m = self._over(region.sensor, region.area)
        except InfeasibleError:
            return None
        assert isinstance(sensor, SarSensor)
        if 2.0 * float(shapely.minimum_bounding_radius(region.area)) > sensor.spot_m(height_m):
            return None
        points_m, angles_rad = hull_points(region.area), _headings(region)
        good = fits(spans_at(points_m, angles_rad).across_m, swaths_m(sensor, height_m, angles_rad), 0)
        if not good.any():
            return None
        angles_rad, spans = angles_rad[good], spans_at(points_m, angles_rad[good])
        sides = tuple(
            Neighbourhood(region, sensor, height_m, look, 0, angles_rad, spans) for look in sensor.looks
        )
        return StripTarget(region, sides, self._around)

    def _at(self, across_m: Floats, along_m: Floats, swaths: Sequence[float]) -> Iterator[Group]:
        """Groups at one heading: of items that one swath holds, runs without room for a turn in between.

        Spans are (N, 2), across and along.
        """
        for k, swath_m in enumerate(swaths):
            low_m = across_m[k, 0]
            inside = np.flatnonzero((across_m[:, 0] >= low_m) & (across_m[:, 1] <= low_m + swath_m))
            run: list[int] = []
            end_m = -math.inf
            for j in inside[np.argsort(along_m[inside, 0], kind="stable")].tolist():
                if along_m[j, 0] > end_m + self._gaps_m[k]:
                    yield from _runs(run, k)
                    run = []
                run.append(j)
                end_m = max(end_m, float(along_m[j, 1]))
            yield from _runs(run, k)

    def _agree(self, group: Group) -> bool:
        """Whether the items of a group agree on a sensor and a heading."""
        members = [self._items[k] for k in sorted(group)]
        first = replace(members[0].sensor, name="", relief_m=0.0)
        if any(replace(item.sensor, name="", relief_m=0.0) != first for item in members[1:]):
            return False
        return _common([item.region.approach_rad for item in members]) != ()


def _gap_m(item: _Item, radius_m: float) -> float:
    """Items further apart along the heading have nothing to share: a line joins their passes as well."""
    return item.sensor.collection_m(item.height_m, 0.0) + math.tau * radius_m


def _items(targets: Sequence[StripTarget]) -> Iterator[_Item]:
    for owner, target in enumerate(targets):
        side, region = target.sides[0], target.region
        if isinstance(side, Neighbourhood) and side.turns == 0 and region.revisits == 1:
            for piece in region.split() if len(region.originals) > 1 else (region,):
                yield _Item(piece, side.sensor, side.height_m, owner)


def _runs(run: list[int], first: int) -> Iterator[Group]:
    """A run, and the shorter ones in it, with the item it was found by."""
    if first not in run:
        return
    at = run.index(first)
    for begin in range(at + 1):
        for end in range(max(at + 1, begin + 2), len(run) + 1):
            yield frozenset(run[begin:end])


def _headings(region: MergedRegion) -> Floats:
    """Headings to try: those allowed; else all round, and along the edges of the hull."""
    if region.approach_rad is not None:
        return np.unique(np.mod(np.asarray(region.approach_rad, dtype=np.float64), math.tau))
    east, north = np.diff(shapely.get_coordinates(region.area.convex_hull), axis=0).T
    edges = np.mod(np.arctan2(north, east), math.pi)
    even = np.arange(0.0, math.tau - 1e-9, ANGLE_RAD)
    return np.unique(np.concatenate([even, edges, edges + math.pi]))


def _common(asked: Sequence[tuple[float, ...] | None]) -> tuple[float, ...] | None:
    """The headings that all allow; None where all allow any."""
    limits = [each for each in asked if each is not None]
    if not limits:
        return None
    return tuple(
        angle
        for angle in limits[0]
        if all(
            any(abs(math.remainder(angle - other, math.tau)) <= SAME_RAD for other in each) for each in limits
        )
    )
