"""What flying between two poses truly costs: the transit stage's own line, found when asked and kept."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from planner.airspace.airspace import Airspace, Level
from planner.airspace.prices import risk_m, soft_prices, way_weight
from planner.airspace.zones import TRANSIT_MARGIN_M, keep_out
from planner.dubins.kernels import dubins_lengths
from planner.dubins.path import MIN_TURN_RAD, Path
from planner.dubins.run_kernels import NO_DISCS, run_costs
from planner.errors import InfeasibleError
from planner.progress import Stop
from planner.route import Anchor, CollectPass, Terminal
from planner.transit import tangent
from planner.transit.refine import Risk, connect_by_cost
from planner.vehicle.model import FlightModel
from planner.wishes import Objective

Floats = NDArray[np.float64]

#: Lines are looked at every so many metres for what of them lies in soft threats.
SAMPLE_M = 20.0
#: Runs from the start that lines are sought behind, where zones make the first ones longer than they look;
#: all of them where those enter soft threats.
MOST_RUNS = 3
#: A turn costs as much as this many metres of way, where the weights are equal.
TURN_M = 100.0


class Legs:
    """True costs of transits among given zones, metres: the flyable length, through the air in a wind, and
    more inside soft threats and for turns, by the objective's weights. What was asked for once is kept.
    """

    def __init__(
        self,
        airspace: Airspace,
        level: Level,
        model: FlightModel,
        objective: Objective,
        ends: tuple[Terminal, Terminal],
        stop: Stop,
    ) -> None:
        self._zones = keep_out(airspace, level, TRANSIT_MARGIN_M)
        self._model = model
        self._from, self._end = ends[0], anchor(ends[1])
        self._stop = stop
        self._soft = soft_prices(airspace, level, objective)
        self._objective = objective
        self._risk = Risk.of(airspace.threats, objective, level.height_m)
        self._known: dict[tuple[Anchor, Anchor], float] = {}
        #: Ends of lines that enter soft threats.
        self._inside: set[tuple[Anchor, Anchor]] = set()

    def cost_m(self, start: Anchor, goal: Anchor) -> float:
        """From one anchor to another; inf where there is no line."""
        key = (start, goal)
        if key not in self._known:
            self._known[key] = self._find(start, goal)
        return self._known[key]

    def between_m(self, leaving: Floats | None, arriving: Floats | None) -> float:
        """The same between poses (3,); None is the start, or the end, of the tour."""
        goal = self._end if arriving is None else _pose(arriving)
        return self._first_m(goal) if leaving is None else self.cost_m(_pose(leaving), goal)

    def _first_m(self, goal: Anchor) -> float:
        """From the start, by its run in the best of its directions where it has one."""
        start, model = self._from, self._model
        if start.run_m <= 0.0 or goal.angle_rad is None:
            return self.cost_m(anchor(start), goal)
        pose = np.array([[goal.east_m, goal.north_m, goal.angle_rad]])
        runs_rad = np.array(start.runs_rad)
        _, best_rad = run_costs(*start.position, start.run_m, runs_rad, pose, model.turn_radius_m, NO_DISCS)
        begins = np.array([start.after_run(angle_rad) for angle_rad in (*best_rad, *start.runs_rad)])
        goals = np.broadcast_to(pose, begins.shape)
        fastest = model.airspeed_m_s / (model.airspeed_m_s + model.wind.speed_m_s)
        least_m = fastest * dubins_lengths(begins, np.ascontiguousarray(goals), model.turn_radius_m)
        run_m = start.run_m * np.asarray(model.air_factor(begins[:, 2]), dtype=np.float64)
        best_m, clear = math.inf, False
        for tried, k in enumerate(np.argsort(run_m + least_m, kind="stable")):
            if run_m[k] + least_m[k] >= best_m or (tried >= MOST_RUNS and clear):
                break
            begin = _pose(begins[k])
            found_m = float(run_m[k]) + self.cost_m(begin, goal)
            if found_m < best_m:
                best_m, clear = found_m, (begin, goal) not in self._inside
        return best_m

    def inner_m(self, passes: Sequence[CollectPass]) -> float:
        """Passes flown one after the other, with the settling before the first and between them."""
        cost_m = math.fsum(self.pass_m(collect) for collect in passes)
        for one, other in itertools.pairwise(passes):
            cost_m += self.cost_m(leaves(one), self.arrives(other))
        return cost_m

    def pass_m(self, collect: CollectPass) -> float:
        """One pass, the settling before it, and the stops at its corners."""
        cost_m = collect.length_m + (0.0 if collect.goes_on else self._model.settle_m)
        if self._model.wind.speed_m_s > 0.0:
            cost_m *= float(self._model.air_factor(collect.angle_rad))
        if len(self._soft):
            line = np.array([collect.settling(self._model.settle_m).position, collect.end])
            cost_m += risk_m(line, self._soft)
        return cost_m + self._model.stops_m

    def tour_m(self, passes: Sequence[CollectPass]) -> float:
        """From the start through all passes to the end."""
        ahead = [self.arrives(collect) for collect in passes]
        behind = [leaves(collect) for collect in passes]
        legs_m = [self.cost_m(one, other) for one, other in zip(behind, [*ahead[1:], self._end], strict=True)]
        return (
            self._first_m(ahead[0])
            + math.fsum(legs_m)
            + math.fsum(self.pass_m(collect) for collect in passes)
        )

    def arrives(self, collect: CollectPass) -> Anchor:
        """Where a transit to a pass ends: before its settling run."""
        pose = collect.settling(self._model.settle_m)
        return Anchor(*pose.position, pose.angle_rad)

    def _find(self, start: Anchor, goal: Anchor) -> float:
        try:
            if self._risk.yielding:
                path = connect_by_cost(
                    start, goal, self._zones, self._model.turn_radius_m, self._risk, self._stop
                )
            else:
                path = tangent.connect(start, goal, self._zones, self._model.turn_radius_m, self._stop)
        except InfeasibleError:
            return math.inf
        cost_m = path.length_m
        if self._model.wind.speed_m_s > 0.0:
            cost_m = self._model.airspeed_m_s * self._model.duration_s(path)
        if len(self._soft) and not self._zones.clear(path):
            inside_m = risk_m(path.sample(SAMPLE_M)[:, :2].copy(), self._soft)
            if inside_m > 0.0:
                self._inside.add((start, goal))
            cost_m += inside_m
        return cost_m + turns_m([path], self._objective)


def turns_m(paths: Iterable[Path], objective: Objective) -> float:
    """What the turns along lines cost."""
    if objective.turns == 0.0:
        return 0.0
    turns = sum(abs(segment.turn_rad) > MIN_TURN_RAD for path in paths for segment in path.segments)
    return TURN_M * objective.turns / way_weight(objective) * turns


def leaves(collect: CollectPass) -> Anchor:
    """Where the transit after a pass begins."""
    return Anchor(*collect.end, collect.angle_rad)


def anchor(terminal: Terminal) -> Anchor:
    """A terminal as one end of a transit."""
    return Anchor(*terminal.position, terminal.angle_rad)


def _pose(values: Floats) -> Anchor:
    return Anchor(float(values[0]), float(values[1]), float(values[2]))
