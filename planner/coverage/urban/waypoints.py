"""The sparse waypoint graph: sweeps joined end to end past obstacles (Majeed and Lee 2019, section 3.6)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import LineString
from shapely.geometry.base import BaseGeometry

from planner.coverage.urban.area import Place, UrbanArea
from planner.coverage.urban.free import MITRE_LIMIT, FreeSpace
from planner.coverage.urban.measures import Flown, Sweep, line_m
from planner.coverage.urban.visibility import Ways
from planner.dubins.path import Path
from planner.dubins.words import candidates_between
from planner.errors import InfeasibleError
from planner.route import Anchor

Floats = NDArray[np.float64]

#: How a join goes: straight; round obstacles to their left or right; over them.
Avoidance = Literal["straight", "left", "right", "top"]

#: A line that touches an obstacle's outline is clear of it.
TOUCH_M = 2e-3
#: Chords of curves.
CHORD_M = 1.0


@dataclass(frozen=True, slots=True)
class Join:
    """An edge of the graph from one sweep to the next: how it goes, and its line, (K, 3)."""

    avoidance: Avoidance
    line: Floats
    turns: int | None = None

    @property
    def length_m(self) -> float:
        """In three dimensions."""
        return line_m(self.line)


@dataclass(frozen=True, slots=True)
class WaypointGraph:
    """Γ = {W, E}: the nodes are ends of sweeps, the edges sweeps and joins, in the order flown.

    Parameters
    ----------
    sweeps
        In the order and direction of the visiting sequence.
    joins
        One more than sweeps: from the start to the first, between neighbours, from the last to the end.
    """

    sweeps: tuple[Sweep, ...]
    joins: tuple[Join, ...]

    def flown(self) -> Flown:
        """The coverage path: the order followed from p to q (section 3.7)."""
        line = np.vstack([join.line for join in self.joins])
        apart = np.append(True, np.abs(np.diff(line, axis=0)).max(axis=1) > 1e-9)
        turns = None
        if all(join.turns is not None for join in self.joins):
            turns = sum(join.turns or 0 for join in self.joins)
        return Flown(self.sweeps, line[apart], turns)


@dataclass(frozen=True, slots=True)
class Joiner:
    """What joins are made among.

    Parameters
    ----------
    urban, free
        The area, and its free ground.
    ways
        Through the free ground.
    inner
        The area without what is too near its edge.
    tree
        The clusters' outlines.
    """

    urban: UrbanArea
    free: FreeSpace
    ways: Ways
    inner: BaseGeometry
    tree: shapely.STRtree

    @classmethod
    def among(cls, urban: UrbanArea, free: FreeSpace, bend_m: float = 0.0) -> Joiner:
        """A joiner for one free ground; each bend counts ``bend_m`` besides the length."""
        edge_m = urban.span_m / 2.0 - TOUCH_M
        inner = urban.area.buffer(-edge_m, join_style="mitre", mitre_limit=MITRE_LIMIT)
        shapely.prepare(inner)
        outlines = [
            cluster.outline.buffer(-TOUCH_M, join_style="mitre", mitre_limit=MITRE_LIMIT)
            for cluster in free.clusters
        ]
        return cls(urban, free, Ways.through(free.ground, bend_m), inner, shapely.STRtree(outlines))

    def graph(self, sweeps: Sequence[Sweep]) -> WaypointGraph:
        """The graph of sweeps in their order (algorithm 1).

        Raises
        ------
        InfeasibleError
            Where two sweeps are joined by no line, or by none that the aircraft can turn along.
        """
        ahead = [math.atan2(s.end[1] - s.start[1], s.end[0] - s.start[0]) for s in sweeps]
        exits = [Anchor(*self.urban.start, None)]
        exits += [Anchor(*sweep.end, angle) for sweep, angle in zip(sweeps, ahead, strict=True)]
        entries = [Anchor(*sweep.start, angle) for sweep, angle in zip(sweeps, ahead, strict=True)]
        entries.append(Anchor(*self.urban.end, None))
        join = self._on_the_spot if self.urban.turn_radius_m == 0.0 else self._curved
        joins = tuple(join(leave, enter) for leave, enter in zip(exits, entries, strict=True))
        return WaypointGraph(tuple(sweeps), joins)

    def join(self, start: Place, end: Place) -> Join:
        """The least of d_left, d_right and d_top between places (eq. 7); straight where nothing is between.

        Eq. 8 gives each as three pieces over two points beside one obstacle. Clusters have more corners than
        its boxes, and others stand in the way round them: here the way round is the shortest line through
        free ground, which for one box is the lesser of the two sums of eq. 8.
        """
        height_m = self.urban.height_m
        if self.ways.is_clear(start, end):
            return Join("straight", np.array([(*start, height_m), (*end, height_m)]))
        found: list[Join] = []
        around = self.ways.way(start, end)
        if around is not None:
            side = _side(around)
            found.append(Join(side, np.column_stack([around, np.full(len(around), height_m)])))
        over = self._over(LineString([start, end]))
        if over is not None:
            found.append(over)
        if not found:
            raise self._unjoined(start, end)
        return min(found, key=lambda each: each.length_m + self.ways.bend_m * (len(each.line) - 2))

    def _over(self, line: LineString) -> Join | None:
        """d_top: up before the first obstacle crossed, level, down behind the last."""
        if not self.inner.covers(line):
            return None
        crossed = self.tree.query(line, predicate="intersects")
        top_m = max((self.free.clusters[k].top_m for k in crossed), default=-math.inf)
        if len(crossed) == 0 or not self.urban.may_climb_over(top_m):
            return None
        over_m = top_m + self.urban.clearance_m
        hits = [line.intersection(self.free.clusters[k].outline).bounds for k in crossed]
        places = [shapely.Point(x, y) for w, s, e, n in hits for x, y in ((w, s), (w, n), (e, s), (e, n))]
        along = sorted(line.project(place) for place in places if line.distance(place) < 10.0 * TOUCH_M)
        first_m, last_m = max(along[0] - TOUCH_M, 0.0), min(along[-1] + TOUCH_M, line.length)
        rise_m = over_m - self.urban.height_m
        if math.tan(self.urban.max_climb_rad) * min(first_m, line.length - last_m) < rise_m and (
            self.urban.max_climb_rad < math.pi / 2.0 - 1e-9
        ):
            return None
        up, down = line.interpolate(first_m), line.interpolate(last_m)
        low_m = self.urban.height_m
        rows = [(*line.coords[0], low_m), (up.x, up.y, over_m), (down.x, down.y, over_m)]
        return Join("top", np.array([*rows, (*line.coords[-1], low_m)]))

    def _on_the_spot(self, leave: Anchor, enter: Anchor) -> Join:
        return self.join((leave.east_m, leave.north_m), (enter.east_m, enter.north_m))

    def _curved(self, leave: Anchor, enter: Anchor) -> Join:
        """The shortest Dubins line that enters no obstacle; it may leave the area of interest to turn."""
        for path in candidates_between(leave, enter, self.urban.turn_radius_m):
            places = path.sample(CHORD_M)[:, :2]
            if len(places) < 2 or len(self.tree.query(LineString(places), predicate="intersects")) == 0:
                line = np.column_stack([places, np.full(len(places), self.urban.height_m)])
                return Join("straight", line, _arcs(path))
        raise self._unjoined((leave.east_m, leave.north_m), (enter.east_m, enter.north_m))

    def _unjoined(self, start: Place, end: Place) -> InfeasibleError:
        if self.urban.turn_radius_m == 0.0:
            constraint, what, relaxation = "hard-zone", "no way", "raise the highest height"
        else:
            constraint, what = "turn-radius", f"no turn of {self.urban.turn_radius_m:g} m radius"
            relaxation = "a smaller turn radius, a greater height, or an aircraft that turns on the spot"
        return InfeasibleError(
            constraint,
            "area",
            f"{what} leads past obstacles from {_words(start)} to {_words(end)}",
            relaxation,
            start,
        )


def _words(place: Place) -> str:
    return f"{place[0]:.0f}, {place[1]:.0f} m"


def _side(way: Floats) -> Avoidance:
    """On which side of the way its obstacles lie: it passes to the left of them where it bends right."""
    steps = np.diff(way, axis=0)
    bends = steps[:-1, 0] * steps[1:, 1] - steps[:-1, 1] * steps[1:, 0]
    return "left" if bends.sum() < 0.0 else "right"


def _arcs(path: Path) -> int:
    return sum(abs(segment.turn_rad) > math.radians(1.0) for segment in path.segments)
