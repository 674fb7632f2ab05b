"""Strips of one flight, or of several at once, annealed for more of the worth that all find together.

All is done in a frame of the ground's own, by numbers rounded in it, so that the same ground turned,
mirrored, moved, or drawn a tenth of a millimetre off is searched by the same lines but for chance.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import MultiPolygon, Polygon
from shapely.geometry.base import BaseGeometry

from planner.progress import Stop, raise_if
from planner.route import Look
from planner.search.moving.anneal_kernels import annealed
from planner.search.moving.strip_kernels import COLUMNS, FLIGHT, SWATH, cost_m, passed
from planner.search.programme import Pricing, Sweep, seen_worth
from planner.search.room import Room
from planner.search.swaths import Looking
from planner.search.upright import frames
from planner.search.values import Worth
from planner.vehicle.wind import CIRCLE_RAD

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
#: Strips (N, 2, 2) of each flier, in the ground's own frame.
Strips = list[Floats]

#: Swaths are told for so many courses, and between them on lines.
COURSES = 120
#: Looks at one place that are told apart where a look misses.
LOOKS = 8
#: A flight has room for so many strips, and for so many times as many as it begins with.
ROOM, TIMES = 16, 2
#: Cells of worth to the longer side of what is round the ground; as many again tell flights apart that were
#: flown.
CELLS, TOLD = 160, 2
#: Cells do not lie along the ground, as lanes do: gaps between these would fall between their middles.
ASKEW_RAD = math.atan(0.5 * (math.sqrt(5.0) - 1.0))
#: Of two that find as much, which is shorter: a thousand kilometres count as this part of all worth.
SHORTER = 1e-3
#: What is worth a step at first, of all worth.
WARM, COOL = 6e-3, 2e-3
#: So many beginnings, each annealed by so many steps; the best of them again, cooler, and the best of those.
BEGUN, FIRST, AGAIN, SECOND = 5, 40_000, 3, 30_000
#: Whether to end is asked after so many steps.
ASKED = 2_000
#: Turns on the spot are lines of this radius at least.
LEAST_RADIUS_M = 1e-3
#: Places are rounded to this, and the angle of the wind; what is nearer to an edge than this is on it.
ROUND_M, ROUND_RAD, STRAIGHT_M = 1.0, math.radians(0.5), 0.1
#: Budgets are rounded down by a part of this at most: flights of the same lines tell of them within less.
BUDGET = 1e-3


@dataclass(frozen=True, slots=True, eq=False)
class Flier:
    """Who flies some of the strips: how it sees, where it may be, and what its ways cost."""

    looking: Looking
    look: Look
    room: Room
    pricing: Pricing

    def table(self, axes: Floats) -> Floats:
        """Swaths by course in axes, (COURSES, SWATH)."""
        # All that courses differ in is the wind, which comes from a rounded angle to the axes.
        toward_rad = self.pricing.model.wind.toward_rad
        wind = axes @ np.array([math.cos(toward_rad), math.sin(toward_rad)])
        from_rad = math.atan2(wind[1], wind[0])
        more_rad = from_rad - ROUND_RAD * round(from_rad / ROUND_RAD)
        angles = 2.0 * math.pi * np.arange(COURSES) / COURSES + more_rad
        ahead = np.stack([np.cos(angles), np.sin(angles)], axis=1) @ axes
        courses = np.arctan2(ahead[:, 1], ahead[:, 0])
        factors = self.pricing.model.air_factor(courses)
        found = np.empty((COURSES, SWATH))
        for k, course_rad in enumerate(courses.tolist()):
            swath = self.looking.swath(course_rad, self.look)
            right_m, left_m, in_m, out_m = self.looking.footprint(course_rad, self.look)
            laid = (swath.run_in_m, swath.run_out_m, swath.middle_m, factors[k])
            found[k] = (*laid, in_m, out_m, right_m, left_m)
        if np.linalg.det(axes) < 0.0:
            # Right is left.
            found[:, 2] *= -1.0
            found[:, 6:] = -found[:, :5:-1]
        return np.round(found, 3)

    def numbers(self) -> Floats:
        """Of the flight, as kernels have them, (FLIGHT,): its ends and its budget left open."""
        model = self.pricing.model
        found = np.zeros(FLIGHT)
        found[4:7] = (
            max(model.turn_radius_m, LEAST_RADIUS_M), model.settle_m, model.air_factor(CIRCLE_RAD).mean(),
        )  # fmt: skip
        return np.round(found, 3)


class Together:
    """Fliers over ground.

    Parameters
    ----------
    scores_at
        What seeing a square metre of the ground is worth at places (N, M, 2), by cells of so many metres.
    detection
        Part of what is there that a look finds; the next one finds that part of the rest.
    """

    def __init__(
        self,
        ground: Polygon | MultiPolygon,
        scores_at: Callable[[Floats, float], Floats],
        detection: float,
        fliers: Sequence[Flier],
    ) -> None:
        ends = np.array([[flier.pricing.start, flier.pricing.end] for flier in fliers])
        self._axes, self._origin = _frame(ground, ends)
        self._flights = np.array([flier.numbers() for flier in fliers])
        self._flights[:, :4] = self._rounded(ends).reshape(-1, 4)
        #: Fliers as they lie in the frame, whatever the order that they are given in.
        self._order = np.lexsort(self._flights.T[::-1])
        self._flights = self._flights[self._order]
        own = [fliers[k] for k in self._order]
        self._tables = np.array([flier.table(self._axes) for flier in own])
        self._widths_m = np.round((self._tables[..., 7] - self._tables[..., 6]).min(axis=1), 2)
        self._free = _joined([self._edges(flier.room.free) for flier in own])
        self._turning = _joined([self._edges(flier.room.turning) for flier in own])
        self._detection = detection
        worth = self._worth_of(ground, scores_at, CELLS)
        self._told = self._worth_of(ground, scores_at, TOLD * CELLS)
        self._scores = worth.scores
        self._corner = np.array([worth.west_m, worth.south_m, worth.cell_m])
        looks = 1 if detection >= 1.0 else LOOKS
        self._pays = np.array([detection * (1.0 - detection) ** k for k in range(looks)])

    def found(
        self, budgets_m: Sequence[float], part: float, seed: int, stop: Stop, enough: Stop
    ) -> list[Strips]:
        """Strips of each flier that find much, from nothing, several times, those that find most first.

        Parameters
        ----------
        budgets_m
            Metres through the air of each; inf where nothing limits them.
        part
            Of the work.
        """
        empty = [np.zeros((0, 2, 2)) for _ in budgets_m]

        def moved(begun: Strips, steps: int, number: int, heat: float) -> tuple[float, Strips]:
            return self.moved(begun, budgets_m, int(part * steps), 1_000 * seed + number, heat, stop, enough)

        first = [moved(empty, FIRST, k, WARM) for k in range(max(1, round(part * BEGUN)))]
        first.sort(key=lambda each: -each[0])
        again = [moved(each[1], SECOND, 100 + k, COOL) for k, each in enumerate(first[:AGAIN])]
        again.sort(key=lambda each: -each[0])
        return [strips for _, strips in again]

    def moved(
        self,
        begun: Strips,
        budgets_m: Sequence[float],
        steps: int,
        seed: int,
        heat: float,
        stop: Stop,
        enough: Stop,
    ) -> tuple[float, Strips]:
        """What the best found from strips of each flier finds, and its strips.

        Parameters
        ----------
        heat
            What a step may lose at first, of all worth.
        enough
            Asked between steps: ends them with the best found.
        """
        many = len(begun)
        room = max(ROOM, *(TIMES * len(strips) for strips in begun))
        strips, counts = np.zeros((many, room, 2, 2)), np.zeros(many, dtype=np.int64)
        for place, f in enumerate(self._order.tolist()):
            counts[place] = len(begun[f])
            strips[place, : len(begun[f])] = begun[f]
        flights = self._flights.copy()
        flights[:, 7] = [_rounded_down(budgets_m[f]) for f in self._order]
        best, best_counts = strips.copy(), counts.copy()
        figures = np.array([-np.inf, 0.0])
        state = np.random.default_rng(seed).integers(1, 2**63, 1, dtype=np.uint64)
        total = float(self._scores.sum()) * float(self._corner[2]) ** 2
        for first in range(0, max(steps, 1), ASKED):
            raise_if(stop)
            if first and enough():
                break
            annealed(
                self._scores, self._pays, self._corner, self._tables, flights, self._widths_m, *self._free,
                *self._turning, strips, counts, best, best_counts, figures, state, first,
                min(first + ASKED, steps), steps, heat * total, SHORTER * total / 1e6,
            )  # fmt: skip
        found = [np.zeros((0, 2, 2))] * many
        for place, f in enumerate(self._order.tolist()):
            found[f] = best[place, : best_counts[place]].copy()
        return float(figures[1]), found

    def costs_m(self, strips: Strips) -> list[float]:
        """Metres through the air that the flights over strips take, about."""
        found = [0.0] * len(strips)
        for place, f in enumerate(self._order.tolist()):
            rows = np.empty((max(len(strips[f]), 1), COLUMNS))
            flight, table = self._flights[place], self._tables[place]
            count = 0
            for strip in strips[f]:
                count += int(passed(strip, table, flight[5], rows[count]))
            found[f] = float(cost_m(rows, count, flight, table))
        return found

    def lines(self, strips: Strips) -> Strips:
        """The same where they lie."""
        return [own @ self._axes + self._origin for own in strips]

    def told(self, sweeps: Sequence[Sweep]) -> float:
        """What passes of flights find by what the sensor sees with no margin used up, as the judge has it."""
        own = []
        for sweep in (each.nominal for each in sweeps):
            swath = sweep.swath
            if np.linalg.det(self._axes) < 0.0:
                swath = replace(swath, right_m=-swath.left_m, left_m=-swath.right_m)
            start, end = self._placed(np.array([sweep.start, sweep.end])).tolist()
            own.append(replace(sweep, start=tuple(start), end=tuple(end), swath=swath))
        return seen_worth(own, self._told, self._detection)

    @property
    def total(self) -> float:
        """All that there is to be found, as it is told."""
        return self._told.total

    def placed(self, lines: Strips) -> Strips:
        """Strips that lie there in the ground's own frame."""
        return [self._placed(each) for each in lines]

    def _worth_of(
        self, ground: Polygon | MultiPolygon, scores_at: Callable[[Floats, float], Floats], cells: int
    ) -> Worth:
        """Of the ground by so many cells to a side, in the frame."""
        corners = self._placed(shapely.get_coordinates(ground))
        west_m, south_m = np.floor(corners.min(axis=0) + 0.5 * ROUND_M).tolist()
        wide_m, high_m = (corners.max(axis=0) - (west_m, south_m)).tolist()
        cell_m = max(math.ceil(10.0 * max(wide_m, high_m) / cells - 1e-3) / 10.0, 0.1)
        shape = (max(1, round(high_m / cell_m + 0.49)), max(1, round(wide_m / cell_m + 0.49)))
        plain = Worth(np.zeros(shape), west_m, south_m, cell_m)
        places = plain.centres_m @ self._axes + self._origin
        shapely.prepare(ground)
        inside = shapely.contains_xy(ground, places[..., 0], places[..., 1])
        return replace(plain, scores=np.where(inside, scores_at(places, cell_m), 0.0))

    def _placed(self, points: Floats) -> Floats:
        return np.asarray((points - self._origin) @ self._axes.T)

    def _rounded(self, points: Floats) -> Floats:
        return np.asarray(ROUND_M * np.round(self._placed(points) / ROUND_M))

    def _edges(self, shape: BaseGeometry) -> Floats:
        """Edges (N, 4) of the rings of polygons, rounded inwards about."""
        found = [np.zeros((0, 4))]
        for ring in shapely.get_rings(shapely.get_parts(shape.buffer(-0.85 * ROUND_M, join_style="mitre"))):
            corners = self._rounded(_cornered(shapely.get_coordinates(ring)))
            found.append(np.hstack([corners[:-1], corners[1:]]))
        edges = np.concatenate(found)
        turned = (edges[:, 0] > edges[:, 2]) | ((edges[:, 0] == edges[:, 2]) & (edges[:, 1] > edges[:, 3]))
        edges[turned] = edges[turned][:, [2, 3, 0, 1]]
        # Wherever rings begin.
        return edges[np.lexsort(edges.T[::-1])]


def _frame(ground: Polygon | MultiPolygon, ends: Floats) -> tuple[Floats, Floats]:
    """Axes askew to the ground, as long as can be along the first, and origin near the ends (F, 2, 2)."""
    corners = shapely.get_coordinates(shapely.minimum_rotated_rectangle(ground))[:4]

    def place(frame: tuple[Floats, Floats]) -> tuple[object, ...]:
        axes, origin = frame
        long_m = float(np.ptp(corners @ axes.T, axis=0)[0])
        where = np.round((ends - origin) @ axes.T).reshape(-1, 4)
        return (-round(long_m), where.sum(axis=0).tolist(), sorted(where.tolist()))

    along, origin = min(
        frames(corners), key=place, default=(np.eye(2), np.asarray(ground.centroid.coords[0]))
    )
    cos, sin = math.cos(ASKEW_RAD), math.sin(ASKEW_RAD)
    return np.array([[cos, sin], [-sin, cos]]) @ along, origin


def _cornered(ring: Floats) -> Floats:
    """A closed ring (N, 2) from its sharpest corner on, without vertices on its edges: it may have any."""
    open_ = ring[:-1]
    before, after = np.roll(open_, 1, axis=0), np.roll(open_, -1, axis=0)
    chord, off = after - before, open_ - before
    highs_m = np.abs(chord[:, 0] * off[:, 1] - chord[:, 1] * off[:, 0]) / np.maximum(np.hypot(*chord.T), 1e-9)
    first = np.roll(open_, -int(np.argmax(np.round(highs_m))), axis=0)
    closed = shapely.linestrings(np.concatenate([first, first[:1]]))
    return np.asarray(shapely.get_coordinates(shapely.simplify(closed, STRAIGHT_M)))


def _rounded_down(budget_m: float) -> float:
    """A budget, but for little."""
    if not 0.0 < budget_m < math.inf:
        return budget_m
    step_m = BUDGET * 2.0 ** math.floor(math.log2(budget_m))
    return step_m * math.floor(budget_m / step_m)


def _joined(edges: Sequence[Floats]) -> tuple[Floats, Ints]:
    """Edges of several one after the other, and where each one's begin and end."""
    ends = np.cumsum([0, *(len(each) for each in edges)])
    return np.concatenate(edges), ends.astype(np.int64)
