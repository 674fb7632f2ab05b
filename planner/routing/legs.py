"""What flying between two poses truly costs: the transit stage's own line, found when asked and kept."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from planner.airspace.zones import keep_out
from planner.errors import InfeasibleError
from planner.progress import Stop
from planner.route import Anchor, CollectPass, Terminal
from planner.routing.joint.prices import risk_m, soft_prices, turns_m
from planner.scenario import Scenario
from planner.transit import tangent
from planner.transit.refine import Risk, connect_by_cost
from planner.vehicle.aircraft import Aircraft
from planner.vehicle.wind import duration_s, still_air_factor

Floats = NDArray[np.float64]

#: Transits keep this far from zones and the area's edge, more than the chords of arcs can cut.
TRANSIT_MARGIN_M = 2.0
#: Lines are looked at every so many metres for what of them lies in soft threats.
SAMPLE_M = 20.0


class Legs:
    """True costs of transits in one scenario, metres: the flyable length, through the air in a wind, and more
    inside soft threats and for turns, by the objective's weights. What was asked for once is kept.
    """

    def __init__(self, scenario: Scenario, aircraft: Aircraft, stop: Stop) -> None:
        self._zones = keep_out(scenario.airspace, scenario.level, TRANSIT_MARGIN_M)
        self._radius_m = aircraft.planned_turn_radius_m
        self._settle_m = aircraft.settle_m
        self._start, self._end = anchor(scenario.start), anchor(scenario.end)
        self._stop = stop
        self._airspeed_m_s, self._wind = aircraft.airspeed_m_s, scenario.wind
        self._soft = soft_prices(scenario)
        self._objective = scenario.objective
        self._risk = Risk.of(scenario.threats, scenario.objective, scenario.height_m)
        self._known: dict[tuple[Anchor, Anchor], float] = {}

    def cost_m(self, start: Anchor, goal: Anchor) -> float:
        """From one anchor to another; inf where there is no line."""
        key = (start, goal)
        if key not in self._known:
            self._known[key] = self._find(start, goal)
        return self._known[key]

    def between_m(self, leaving: Floats | None, arriving: Floats | None) -> float:
        """The same between poses (3,); None is the start, or the end, of the scenario."""
        start = self._start if leaving is None else _pose(leaving)
        return self.cost_m(start, self._end if arriving is None else _pose(arriving))

    def inner_m(self, passes: Sequence[CollectPass]) -> float:
        """Passes flown one after the other, with the settling before the first and between them."""
        cost_m = math.fsum(self.pass_m(collect) for collect in passes)
        for one, other in itertools.pairwise(passes):
            cost_m += self.cost_m(leaves(one), self.arrives(other))
        return cost_m

    def pass_m(self, collect: CollectPass) -> float:
        """One pass and the settling before it."""
        cost_m = collect.length_m + self._settle_m
        if self._wind.speed_m_s > 0.0:
            cost_m *= float(still_air_factor(collect.angle_rad, self._airspeed_m_s, self._wind))
        if len(self._soft):
            line = np.array([collect.settling(self._settle_m).position, collect.end])
            cost_m += risk_m(line, self._soft)
        return cost_m

    def tour_m(self, passes: Sequence[CollectPass]) -> float:
        """From the start through all passes to the end."""
        ahead = [self.arrives(collect) for collect in passes]
        behind = [leaves(collect) for collect in passes]
        legs_m = [
            self.cost_m(start, goal)
            for start, goal in zip([self._start, *behind], [*ahead, self._end], strict=True)
        ]
        return math.fsum(legs_m) + math.fsum(self.pass_m(collect) for collect in passes)

    def arrives(self, collect: CollectPass) -> Anchor:
        """Where a transit to a pass ends: before its settling run."""
        pose = collect.settling(self._settle_m)
        return Anchor(*pose.position, pose.angle_rad)

    def _find(self, start: Anchor, goal: Anchor) -> float:
        try:
            if self._risk.yielding:
                path = connect_by_cost(start, goal, self._zones, self._radius_m, self._risk, self._stop)
            else:
                path = tangent.connect(start, goal, self._zones, self._radius_m, self._stop)
        except InfeasibleError:
            return math.inf
        cost_m = path.length_m
        if self._wind.speed_m_s > 0.0:
            cost_m = self._airspeed_m_s * duration_s(path, self._airspeed_m_s, self._wind)
        if len(self._soft) and not self._zones.clear(path):
            cost_m += risk_m(path.sample(SAMPLE_M)[:, :2].copy(), self._soft)
        return cost_m + turns_m([path], self._objective)


def leaves(collect: CollectPass) -> Anchor:
    """Where the transit after a pass begins."""
    return Anchor(*collect.end, collect.angle_rad)


def anchor(terminal: Terminal) -> Anchor:
    """A terminal as one end of a transit."""
    return Anchor(*terminal.position, terminal.angle_rad)


def _pose(values: Floats) -> Anchor:
    return Anchor(float(values[0]), float(values[1]), float(values[2]))
