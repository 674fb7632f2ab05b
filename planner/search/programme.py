"""Passes in flight order: what they see of the worth of ground, what they cost, and cut to a budget."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from planner.dubins.kernels import dubins_lengths
from planner.route import Look
from planner.search.kernels import mark_seen, take_looks
from planner.search.room import LEAST_PASS_M
from planner.search.values import Swath, Worth
from planner.vehicle.model import FlightModel

Floats = NDArray[np.float64]
Place = tuple[float, float]
#: Lengths that a last pass is cut to.
PARTS = 129


@dataclass(frozen=True, slots=True)
class Sweep:
    """One pass as the choice sees it: a line, the side looked to, and the swath on its course."""

    start: Place
    end: Place
    look: Look
    swath: Swath

    @property
    def length_m(self) -> float:
        """Of the line."""
        return math.dist(self.start, self.end)

    @property
    def along(self) -> Floats:
        """Unit vector of its course."""
        return np.subtract(self.end, self.start) / self.length_m

    @property
    def course_rad(self) -> float:
        """Flight direction."""
        return math.atan2(self.end[1] - self.start[1], self.end[0] - self.start[0])

    @property
    def row(self) -> tuple[float, ...]:
        """For ``kernels.mark_seen``."""
        swath = self.swath
        reach_m = (swath.run_in_m, self.length_m - swath.run_out_m)
        return (*self.start, *self.along.tolist(), *reach_m, swath.right_m, swath.left_m)

    @property
    def nominal(self) -> Sweep:
        """The same by what it sees where none of its margins are used up, as the judge has it."""
        return self if self.swath.nominal is None else replace(self, swath=self.swath.nominal)

    def shortened(self, length_m: float) -> Sweep:
        """Its beginning."""
        end = np.asarray(self.start) + length_m * self.along
        return replace(self, end=(float(end[0]), float(end[1])))

    def sees(self, centres_m: Floats) -> NDArray[np.bool_]:
        """Which places (..., 2) it sees."""
        along = self.along
        off = centres_m - np.asarray(self.start)
        ahead = off @ along
        aside = off @ np.array([-along[1], along[0]])
        swath = self.swath
        return np.asarray(
            (ahead >= swath.run_in_m)
            & (ahead <= self.length_m - swath.run_out_m)
            & (aside >= swath.right_m)
            & (aside <= swath.left_m)
        )


@dataclass(frozen=True, slots=True)
class Programme:
    """Passes in flight order, by the family that laid them.

    Parameters
    ----------
    worth
        Of the ground they see, each place once.
    cost_m
        Metres through the air from start to end, about.
    whole
        All passes of its pattern.
    thinned
        Whether it was cut by leaving out what is worth least, not what comes last.
    strips, look
        What it was laid of: middle lines of ground, (N, 2, 2), seen to one side.
    """

    family: str
    sweeps: tuple[Sweep, ...]
    worth: float
    cost_m: float
    whole: tuple[Sweep, ...]
    thinned: bool
    strips: Floats = field(compare=False)
    look: Look


@dataclass(frozen=True, slots=True, eq=False)
class Pricing:
    """What flying passes costs one aircraft from a start to an end, in metres through the air.

    Parameters
    ----------
    start, end
        Places; directions are free.
    """

    model: FlightModel
    start: Place
    end: Place

    def own_m(self, sweeps: Sequence[Sweep]) -> Floats:
        """Of the passes themselves, settling included, (N,)."""
        courses = np.array([sweep.course_rad for sweep in sweeps])
        lengths_m = np.array([sweep.length_m for sweep in sweeps]) + self.model.settle_m
        return np.asarray(lengths_m * self.model.air_factor(courses))

    def poses(self, sweeps: Sequence[Sweep]) -> tuple[Floats, Floats]:
        """Where passes are arrived at, before their settling run, and where they are left, (N, 3) each."""
        courses = np.array([sweep.course_rad for sweep in sweeps])
        starts = np.array([sweep.start for sweep in sweeps])
        starts = starts - self.model.settle_m * np.stack([np.cos(courses), np.sin(courses)], axis=1)
        ends = np.array([sweep.end for sweep in sweeps])
        return np.column_stack([starts, courses]), np.column_stack([ends, courses])

    def between_m(self, exits: Floats, entries: Floats) -> Floats:
        """From exits to entries, row by row."""
        lengths_m = dubins_lengths(exits, entries, self.model.turn_radius_m)
        return np.asarray(self.model.air_costs_m(lengths_m, exits, entries))

    def outward_m(self, entry: Floats) -> float:
        """From the start to a pose, whatever the direction of the take-off."""
        away_rad = math.atan2(entry[1] - self.start[1], entry[0] - self.start[0])
        return float(self.between_m(np.array([[*self.start, away_rad]]), entry[None])[0])

    def homeward_m(self, exits: Floats) -> Floats:
        """From poses (N, 3) to the end, arriving as they point to it."""
        home_rad = np.arctan2(self.end[1] - exits[:, 1], self.end[0] - exits[:, 0])
        goals = np.column_stack([np.tile(self.end, (len(exits), 1)), home_rad])
        return self.between_m(exits, goals)

    def arrivals_m(self, sweeps: Sequence[Sweep], entries: Floats, exits: Floats) -> Floats:
        """Metres through the air before each pass with its settling run, (N,)."""
        own_m = self.own_m(sweeps)
        between_m = self.between_m(exits[:-1], entries[1:]) if len(sweeps) > 1 else np.zeros(0)
        reached_m = np.concatenate([[self.outward_m(entries[0])], between_m]).cumsum()
        return np.asarray(reached_m + np.concatenate([[0.0], own_m[:-1].cumsum()]))

    def cost_m(self, sweeps: Sequence[Sweep]) -> float:
        """Of the whole."""
        if not sweeps:
            return math.dist(self.start, self.end)
        entries, exits = self.poses(sweeps)
        between_m = self.between_m(exits[:-1], entries[1:]) if len(sweeps) > 1 else np.zeros(0)
        ends_m = self.outward_m(entries[0]) + float(self.homeward_m(exits[-1:])[0])
        return float(self.own_m(sweeps).sum() + between_m.sum() + ends_m)


def seen_worth(sweeps: Sequence[Sweep], worth: Worth, detection: float = 1.0) -> float:
    """What passes find together: the k-th look at a place finds a part of what those before have missed."""
    if not sweeps:
        return 0.0
    rows = np.array([sweep.row for sweep in sweeps])
    if detection >= 1.0:
        seen = np.zeros(worth.scores.shape, dtype=np.bool_)
        mark_seen(seen, worth.west_m, worth.south_m, worth.cell_m, rows)
        return float(worth.scores[seen].sum()) * worth.cell_m**2
    left = np.ones(worth.scores.shape)
    take_looks(left, worth.west_m, worth.south_m, worth.cell_m, rows, 1.0 - detection)
    return float((worth.scores * (1.0 - left)).sum()) * worth.cell_m**2


def cut_to(sweeps: Sequence[Sweep], pricing: Pricing, budget_m: float) -> tuple[Sweep, ...]:
    """As many passes from the first on as a budget allows, the last one in part."""
    if not sweeps:
        return ()
    entries, exits = pricing.poses(sweeps)
    own_m, reached_m = pricing.own_m(sweeps), pricing.arrivals_m(sweeps, entries, exits)
    fits = np.flatnonzero(reached_m + own_m + pricing.homeward_m(exits) <= budget_m)
    count = int(fits[-1]) + 1 if len(fits) else 0
    kept = tuple(sweeps[:count])
    if count == len(sweeps):
        return kept
    last = sweeps[count]
    parts = np.linspace(0.0, 1.0, PARTS)
    ends = np.asarray(last.start) + parts[:, None] * last.length_m * last.along
    ends_m = pricing.homeward_m(np.column_stack([ends, np.full(PARTS, last.course_rad)]))
    settled_m = own_m[count] * pricing.model.settle_m / (last.length_m + pricing.model.settle_m)
    costs_m = reached_m[count] + settled_m + parts * (own_m[count] - settled_m) + ends_m
    fitting = np.flatnonzero(costs_m <= budget_m)
    length_m = float(parts[fitting[-1]]) * last.length_m if len(fitting) else 0.0
    least_m = max(0.0, last.swath.run_in_m + last.swath.run_out_m) + LEAST_PASS_M
    return (*kept, last.shortened(length_m)) if length_m >= least_m else kept


def thinned_to(
    sweeps: Sequence[Sweep], pricing: Pricing, budget_m: float, values: Floats
) -> tuple[Sweep, ...]:
    """The passes without those worth least for the way they take, until the rest is in the budget.

    Parameters
    ----------
    values
        What each pass finds alone, (N,).
    """
    own_m = pricing.own_m(sweeps)
    entries, exits = pricing.poses(sweeps)
    kept = np.arange(len(sweeps), dtype=np.int64)
    while len(kept):
        first, last = entries[kept], exits[kept]
        between_m = pricing.between_m(last[:-1], first[1:]) if len(kept) > 1 else np.zeros(0)
        # From the start, between, and to the end: what lies before each pass, and behind the last.
        out_m = np.array([pricing.outward_m(entry) for entry in first[:2]])
        back_m = pricing.homeward_m(last[-2:])
        cost_m = out_m[0] + between_m.sum() + back_m[-1] + own_m[kept].sum()
        if cost_m <= budget_m:
            break
        ways_m = np.concatenate([out_m[:1], between_m, back_m[-1:]])
        straight_m = np.zeros(len(kept))
        if len(kept) > 1:
            straight_m[0], straight_m[-1] = out_m[1], back_m[0]
        if len(kept) > 2:
            straight_m[1:-1] = pricing.between_m(last[:-2], first[2:])
        saved_m = own_m[kept] + ways_m[:-1] + ways_m[1:] - straight_m
        kept = np.delete(kept, int(np.argmin(values[kept] / np.maximum(saved_m, 1e-6))))
    return tuple(sweeps[k] for k in kept.tolist())
