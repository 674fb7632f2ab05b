"""Receding horizon on stored energy, after a published strategy for search and coverage by a small UAV.

The paper ("A path planning strategy for a search and coverage mission for a small UAV that maximizes the
area covered based on stored energy and maneuverability constraints") flies a point mass at a constant speed.
For each turn duration τ it takes the turn rate u, |u| ≤ g √(n² − 1) / V, of least

    J(u) = (1 − p) C(u) + p Φ(u).

- C, the cost with its decision: the inverse of the newly covered area; where u covers none, the distance to
  the centroid of what is uncovered. The area is the exact union of polygons. Without the decision only the
  area counts: turn rates that cover nothing are all the same, and the first of them is flown.
- p, the priority: which part of the energy left (or of the time, in the variant) the way to the exit takes.
- Φ, the terminal cost: what the way from the state reached to the exit takes of what is left then.

The text at hand has lost its formulas. What is chosen here: C counts by what straight flight covers in τ, and
distances by V τ, so that the terms compare; p is to the fourth power, so that the exit hardly matters until
there is little to spare; the way to the exit is the shortest line of bounded curvature, its arcs at the power
of the tightest turn; the last turn is cut where that way takes just what is left, and then it is flown.

The variants: ``discrete`` knows the tightest turns and straight flight alone; ``no-decision`` as said;
``time`` knows no energy: its mission lasts as long as the stored energy would in straight flight, and ends
where that energy really does.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar
from shapely.geometry import LineString
from shapely.geometry.base import BaseGeometry

from planner.dubins.words import candidates_to_point
from planner.progress import Stop, never, raise_if
from planner.route import Pose
from planner.search.course import DiscSearch

Floats = NDArray[np.float64]

#: τ, seconds; and turn rates looked at before the best is refined.
TURN_S, RATES = 6.0, 11
#: Power of the priority.
SHARP = 4.0
#: Places of a turn, and sides of a quarter of the disc.
PLACES, QUADRANT = 7, 8
#: New area less than this part of the disc's is none.
NOTHING = 1e-4
_HALVINGS = 30


@dataclass(frozen=True, slots=True)
class Variant:
    """Which of the paper's features are used."""

    continuous: bool = True
    decision: bool = True
    energy: bool = True


VARIANTS = {
    "energy-horizon": Variant(),
    "energy-horizon-discrete": Variant(continuous=False),
    "energy-horizon-no-decision": Variant(decision=False),
    "energy-horizon-time": Variant(energy=False),
}


@dataclass(frozen=True, slots=True)
class Flown:
    """What a variant flies until its energy is used or it is at the exit.

    Parameters
    ----------
    points
        Vertices, (N, 2).
    seen_m2
        Of the ground, by the union of polygons.
    exit_off_m
        From its last place to the exit.
    energy_j, duration_s
        Used, and taken.
    meant_s
        How long it meant to fly.
    """

    points: Floats
    seen_m2: float
    exit_off_m: float
    energy_j: float
    duration_s: float
    meant_s: float


@dataclass(slots=True)
class _State:
    heading_rad: float
    pose: Pose
    left: float
    rates: list[tuple[float, float]]


def energy_horizon(
    search: DiscSearch, heading_rad: float, variant: Variant, turn_s: float = TURN_S, stop: Stop = never
) -> Flown:
    """Fly a variant from the start, at a heading, for the exit.

    Parameters
    ----------
    turn_s
        τ: how long each turn rate is kept.
    """
    return _Flight(search, variant, turn_s).fly(heading_rad, stop)


@dataclass(slots=True)
class _Flight:
    """One flight; the budget is in joules, or in seconds for the variant by time."""

    search: DiscSearch
    variant: Variant
    turn_s: float

    def fly(self, heading_rad: float, stop: Stop) -> Flown:
        glider = self.search.glider
        budget = glider.energy_j if self.variant.energy else glider.straight_m / glider.airspeed_m_s
        pose = Pose(*self.search.start, heading_rad)
        state = _State(heading_rad, pose, budget, [])
        uncovered: BaseGeometry = self.search.ground
        while True:
            raise_if(stop)
            rate = self._best(state, uncovered)
            place, used = self._after(state.pose, rate, self.turn_s), self._used(rate) * self.turn_s
            if self._home(place)[0] > state.left - used:
                break
            uncovered = shapely.difference(uncovered, self._seen(state.pose, rate, self.turn_s))
            self._go(state, rate, self.turn_s)
        # The last turn lasts until the way to the exit takes just what is left.
        low_s, high_s = 0.0, self.turn_s
        for _ in range(_HALVINGS):
            part_s = 0.5 * (low_s + high_s)
            there = self._after(state.pose, rate, part_s)
            fits = self._home(there)[0] <= state.left - self._used(rate) * part_s
            low_s, high_s = (part_s, high_s) if fits else (low_s, part_s)
        self._go(state, rate, low_s)
        for segment_rate, time_s in self._home(state.pose)[1]:
            self._go(state, segment_rate, time_s)
        return self._measured(state)

    def _best(self, state: _State, uncovered: BaseGeometry) -> float:
        """The turn rate of least J."""
        most = self.search.glider.max_turn_rad_s
        if not self.variant.continuous:
            return min((0.0, most, -most), key=lambda rate: self._cost(state, uncovered, rate))
        rates = np.linspace(-most, most, RATES)
        costs = [self._cost(state, uncovered, float(rate)) for rate in rates]
        best = int(np.argmin(costs))
        bounds = (float(rates[max(best - 1, 0)]), float(rates[min(best + 1, RATES - 1)]))
        found = minimize_scalar(
            lambda rate: self._cost(state, uncovered, float(rate)),
            bounds=bounds,
            method="bounded",
            options={"maxiter": 8},
        )
        return float(found.x) if found.fun < costs[best] else float(rates[best])

    def _cost(self, state: _State, uncovered: BaseGeometry, rate: float) -> float:
        """J."""
        left = state.left - self._used(rate) * self.turn_s
        place = self._after(state.pose, rate, self.turn_s)
        home = self._home(place)[0]
        if left <= 0.0:
            return math.inf
        priority: float = min(1.0, self._home(state.pose)[0] / state.left) ** SHARP
        covering = self._coverage(state.pose, place, rate, uncovered)
        return (1.0 - priority) * covering + priority * home / left

    def _coverage(self, pose: Pose, place: Pose, rate: float, uncovered: BaseGeometry) -> float:
        """C."""
        flown_m = self.search.glider.airspeed_m_s * self.turn_s
        strip_m2 = 2.0 * self.search.reach_m * flown_m
        new_m2 = float(shapely.intersection(self._seen(pose, rate, self.turn_s), uncovered).area)
        if new_m2 > NOTHING * math.pi * self.search.reach_m**2:
            return strip_m2 / new_m2
        none = 1.0 / NOTHING
        if not self.variant.decision or uncovered.is_empty:
            return none
        middle = uncovered.centroid
        return none + math.dist(place.position, (middle.x, middle.y)) / flown_m

    def _used(self, rate: float) -> float:
        """Of the budget, a second."""
        return self.search.glider.power_w(rate) if self.variant.energy else 1.0

    def _home(self, pose: Pose) -> tuple[float, list[tuple[float, float]]]:
        """What the way to the exit takes of the budget, and its turn rates with their times."""
        glider = self.search.glider
        path = min(
            candidates_to_point(pose, *self.search.end, glider.radius_m), key=lambda each: each.length_m
        )
        rates = {"straight": 0.0, "left": glider.max_turn_rad_s, "right": -glider.max_turn_rad_s}
        turns = [(rates[each.kind], each.length_m / glider.airspeed_m_s) for each in path.segments]
        return sum(self._used(rate) * time_s for rate, time_s in turns), turns

    def _after(self, pose: Pose, rate: float, time_s: float) -> Pose:
        """Where a turn rate leads to in a time: a point mass at constant speed."""
        speed, angle = self.search.glider.airspeed_m_s, pose.angle_rad + rate * time_s
        if abs(rate) < 1e-9:
            return Pose(
                pose.east_m + speed * time_s * math.cos(pose.angle_rad),
                pose.north_m + speed * time_s * math.sin(pose.angle_rad),
                angle,
            )
        radius = speed / rate
        return Pose(
            pose.east_m + radius * (math.sin(angle) - math.sin(pose.angle_rad)),
            pose.north_m - radius * (math.cos(angle) - math.cos(pose.angle_rad)),
            angle,
        )

    def _line(self, pose: Pose, rate: float, time_s: float, places: int) -> list[tuple[float, float]]:
        times_s = np.linspace(0.0, time_s, places)
        return [self._after(pose, rate, float(each)).position for each in times_s]

    def _seen(self, pose: Pose, rate: float, time_s: float) -> BaseGeometry:
        line = LineString(self._line(pose, rate, time_s, PLACES))
        shape: BaseGeometry = shapely.buffer(line, self.search.reach_m, quad_segs=QUADRANT)
        return shape

    def _go(self, state: _State, rate: float, time_s: float) -> None:
        if time_s <= 0.0:
            return
        state.rates.append((rate, time_s))
        state.left -= self._used(rate) * time_s
        state.pose = self._after(state.pose, rate, time_s)

    def _measured(self, state: _State) -> Flown:
        """As it is really flown: no farther than the stored energy reaches."""
        glider = self.search.glider
        left_j, time_s = glider.energy_j, 0.0
        pose = Pose(*self.search.start, state.heading_rad)
        points = [pose.position]
        for rate, wanted_s in state.rates:
            flown_s = min(wanted_s, max(left_j, 0.0) / glider.power_w(rate))
            points += self._line(pose, rate, flown_s, 2 * PLACES)[1:]
            pose = self._after(pose, rate, flown_s)
            left_j -= glider.power_w(rate) * flown_s
            time_s += flown_s
        line = np.array(points)
        off_m = math.dist(points[-1], self.search.end)
        meant_s = sum(wanted_s for _, wanted_s in state.rates)
        return Flown(line, self.search.seen_m2(line), off_m, glider.energy_j - left_j, time_s, meant_s)
