"""The network S of the model: waypoints, bases, route segments, and one network made of a problem.

Vertices are numbered: waypoints V, then for each aircraft the vertex it starts from, then for each aircraft
those it may land at. "The start and end landing sites always describe a different network vertex" (after
(22)).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from planner.fleet.problem import FloatArray, Problem


class UnsuitedError(ValueError):
    """The model has no words for the problem, or no solution whatever is left out."""


@dataclass(frozen=True, slots=True)
class Waypoint:
    """w_i: earliest and latest arrival e and d, priority p_i, time of recognition T_i^ISR at it."""

    window_s: tuple[float, float] = (0.0, math.inf)
    priority: float = 0.0
    isr_s: float = 0.0


@dataclass(frozen=True, slots=True)
class Segment:
    """A route segment {k, m} on which a target is recognised, flown either way where both arcs exist.

    ``target`` and ``alternative`` say of what; ``priority`` is p_ij of its arcs; ``sensor`` the predefined
    one.
    """

    target: int
    alternative: int
    k: int
    m: int
    priority: float = 0.0
    sensor: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class Flyer:
    """One aircraft: its vertices, T between vertices (infinite where there is no arc) and its limits.

    ``length_m`` and ``energy_wh`` are of arcs like ``seconds``, None where nothing limits them.
    """

    start: int
    ends: tuple[int, ...]
    seconds: FloatArray
    length_m: FloatArray | None = None
    energy_wh: FloatArray | None = None
    risk: FloatArray | None = None
    ready_s: float = 0.0
    land_by_s: float = math.inf
    max_flight_s: float = math.inf
    range_m: float = math.inf
    budget_wh: float = math.inf
    waiting_w: float = 0.0
    must_fly: bool = True


@dataclass(frozen=True, slots=True)
class Goal:
    """ρ of equation (19); the other three are no part of the paper, nought there."""

    rho: float = 1.0
    in_air: float = 0.0
    last_landing: float = 0.0
    risk: float = 0.0


@dataclass(frozen=True, slots=True)
class Network:
    """S = (W, E). ``required`` lists targets that have to be recognised."""

    waypoints: tuple[Waypoint, ...]
    segments: tuple[Segment, ...]
    flyers: tuple[Flyer, ...]
    goal: Goal = Goal()
    required: frozenset[int] = frozenset()

    @property
    def size(self) -> int:
        """How many vertices there are, bases included."""
        return len(self.flyers[0].seconds)


def network_of(problem: Problem) -> Network:
    """Each alternative as a segment from its entry, 2a, to its exit, 2a + 1: flown one way, for that is what
    it is.

    Raises
    ------
    UnsuitedError
        Where the model has no words for the problem: revisits, or several trips of one aircraft.
    """
    for target in problem.targets:
        if target.visits > 1:
            raise UnsuitedError(
                f"{target.name}: the model knows one visit of each target, not {target.visits}"
            )
    for member in problem.members:
        if member.trips > 1:
            raise UnsuitedError(
                f"{member.name}: the model knows one trip of each aircraft, not {member.trips}"
            )
    waypoints: list[Waypoint] = []
    segments: list[Segment] = []
    for number, target in enumerate(problem.targets):
        worth = problem.objective.priority * target.priority
        for way in range(len(target.alternatives)):
            k = len(waypoints)
            waypoints += [Waypoint(target.window_s or (0.0, math.inf))] * 2
            segments.append(Segment(number, way, k, k + 1, worth, str(way)))
    goal = problem.objective
    return Network(
        tuple(waypoints),
        tuple(segments),
        tuple(_flyer(problem, member, len(waypoints)) for member in range(len(problem.members))),
        Goal(goal.travel_time, goal.total_time, goal.last_landing, goal.risk),
        frozenset(number for number, target in enumerate(problem.targets) if target.required),
    )


def _flyer(problem: Problem, number: int, waypoints: int) -> Flyer:
    member = problem.members[number]
    fleet = problem.members
    start = waypoints + number
    ends_from = waypoints + len(fleet) + sum(len(each.end_bases) for each in fleet[:number])
    ends = tuple(range(ends_from, ends_from + len(member.end_bases)))
    size = waypoints + len(fleet) + sum(len(each.end_bases) for each in fleet)

    def spread(values: FloatArray | None, field: str, missing: float) -> FloatArray | None:
        if values is None:
            return None
        ways = np.arange(waypoints // 2)
        nodes = len(problem.bases) + ways
        wide = np.full((size, size), missing)
        wide[np.ix_(2 * ways + 1, 2 * ways)] = values[np.ix_(nodes, nodes)]
        wide[start, 2 * ways] = values[member.start_base, nodes]
        for end, base in zip(ends, member.end_bases, strict=True):
            wide[2 * ways + 1, end] = values[nodes, base]
        at = 0
        for target in problem.targets:
            for way in target.alternatives:
                service = way.services[number]
                wide[2 * at, 2 * at + 1] = missing if service is None else getattr(service, field)
                wide[2 * at + 1, 2 * at] = missing
                at += 1
        return wide

    seconds = spread(member.travel.seconds, "service_s", math.inf)
    assert seconds is not None
    return Flyer(
        start,
        ends,
        seconds,
        spread(member.travel.length_m, "length_m", 0.0),
        spread(member.travel.energy_wh, "energy_wh", 0.0),
        spread(member.travel.risk, "risk", 0.0),
        member.ready_s,
        member.ready_s + member.shift_s,
        member.max_flight_s,
        member.range_m,
        member.energy_wh,
        member.waiting_w,
        member.must_fly,
    )
