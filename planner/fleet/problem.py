"""The assignment problem: what is to be done, by whom, and what everything costs them.

Nodes number everything a flight touches: the bases first, then the alternatives, target after target, in
order (``Problem.node``). A travel matrix holds, for one aircraft, what it takes from the *exit* of the row's
node to the *entry* of the column's; infinity where it cannot be flown. Nothing else is known of places, so
that wind, threats and turns are whatever the caller made of them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Service:
    """What an alternative asks of one aircraft, from its entry to its exit."""

    service_s: float
    length_m: float = 0.0
    energy_wh: float = 0.0
    risk: float = 0.0


@dataclass(frozen=True, slots=True)
class Alternative:
    """One way to do a target; of all its ways exactly one is taken at each visit.

    Parameters
    ----------
    name
        Names it in the answer.
    services
        One for each aircraft, in their order; None where that aircraft cannot fly it.
    """

    name: str
    services: tuple[Service | None, ...]


@dataclass(frozen=True, slots=True)
class Target:
    """What is to be done.

    Parameters
    ----------
    name
        Names it in the answer.
    alternatives
        Ways to do it, at least one.
    priority
        What doing it is worth; each of several visits is worth its share.
    required
        Whether the answer is infeasible without it.
    window_s
        Earliest start and latest end of its service after the mission's start; None for any time.
    visits
        How often it is to be done.
    revisit_after_s
        From the end of one visit to the start of the next at least this long.
    """

    name: str
    alternatives: tuple[Alternative, ...]
    priority: float = 1.0
    required: bool = True
    window_s: tuple[float, float] | None = None
    visits: int = 1
    revisit_after_s: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class Travel:
    """What one aircraft takes between nodes: float64, shape (nodes, nodes) each, asymmetric.

    ``length_m``, ``energy_wh`` and ``risk`` may be None where no limit and no objective counts them.
    """

    seconds: FloatArray
    length_m: FloatArray | None = None
    energy_wh: FloatArray | None = None
    risk: FloatArray | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Member:
    """One aircraft of the fleet.

    Parameters
    ----------
    name
        Names it in the answer.
    travel
        What it takes between nodes.
    start_base
        Number of the base it takes off from.
    end_bases
        Numbers of the bases it may land at; a further trip starts where the last one landed.
    ready_s
        Earliest take-off.
    shift_s
        From ``ready_s`` to the last landing at most this long.
    max_flight_s, range_m, energy_wh
        What one trip may take at most, waiting in the air included.
    waiting_w
        Power while waiting in the air, W; waiting at the base costs nothing.
    trips
        At most this many, one battery each.
    turnaround_s
        From a landing to the next take-off at least this long.
    must_fly
        Whether it has to take off at all (constraint (23) of the printed model).
    """

    name: str
    travel: Travel
    start_base: int = 0
    end_bases: tuple[int, ...] = (0,)
    ready_s: float = 0.0
    shift_s: float = math.inf
    max_flight_s: float = math.inf
    range_m: float = math.inf
    energy_wh: float = math.inf
    waiting_w: float = 0.0
    trips: int = 1
    turnaround_s: float = 0.0
    must_fly: bool = False


@dataclass(frozen=True, slots=True)
class Objective:
    """Weights of what is minimised; priority collected counts against the rest.

    ``last_landing``, ``total_time`` (in the air, waiting included) and ``travel_time`` (travel and service,
    as in equation (19) of Stecz and Gromada 2020) per second, ``risk`` per unit of risk, ``priority`` per
    unit of priority collected. A required target is worth more than all of them together.
    """

    last_landing: float = 0.0
    total_time: float = 1.0
    travel_time: float = 0.0
    risk: float = 0.0
    priority: float = 0.0


@dataclass(frozen=True, slots=True)
class Problem:
    """Targets, aircraft and bases; see the module for how nodes are numbered."""

    bases: tuple[str, ...]
    targets: tuple[Target, ...]
    members: tuple[Member, ...]
    objective: Objective = Objective()

    def node(self, target: int, alternative: int) -> int:
        """Number of an alternative's node."""
        before = sum(len(each.alternatives) for each in self.targets[:target])
        return len(self.bases) + before + alternative

    @property
    def node_count(self) -> int:
        """Bases and alternatives."""
        return len(self.bases) + sum(len(each.alternatives) for each in self.targets)

    def __post_init__(self) -> None:
        for member in self.members:
            _check_member(self, member)
        for target in self.targets:
            _check_target(self, target)
        for kind, named in (("aircraft", self.members), ("target", self.targets)):
            names = [each.name for each in named]
            if len(set(names)) < len(names):
                raise ValueError(f"two of one name among {kind} names {sorted(names)}")


def _check_member(problem: Problem, member: Member) -> None:
    for base in (member.start_base, *member.end_bases):
        if not 0 <= base < len(problem.bases):
            raise ValueError(f"{member.name}: there is no base {base}")
    if not member.end_bases or member.trips < 1:
        raise ValueError(f"{member.name}: one base to land at and one trip are the least")
    shape = (problem.node_count, problem.node_count)
    travel = member.travel
    for name, values in (
        ("seconds", travel.seconds),
        ("length_m", travel.length_m),
        ("energy_wh", travel.energy_wh),
        ("risk", travel.risk),
    ):
        if values is None:
            continue
        if values.shape != shape:
            raise ValueError(f"{member.name}: travel {name} has shape {values.shape}, not {shape}")
        if not (values >= 0.0).all():
            raise ValueError(f"{member.name}: travel {name} has values below zero or none at all")
    if math.isfinite(member.range_m) and travel.length_m is None:
        raise ValueError(f"{member.name}: a range is given, but no length of travel")
    if math.isfinite(member.energy_wh) and travel.energy_wh is None:
        raise ValueError(f"{member.name}: an energy is given, but no energy of travel")


def _check_target(problem: Problem, target: Target) -> None:
    if not target.alternatives or target.visits < 1:
        raise ValueError(f"{target.name}: one alternative and one visit are the least")
    if target.window_s is not None and not target.window_s[0] <= target.window_s[1]:
        raise ValueError(f"{target.name}: window {target.window_s} closes before it opens")
    for alternative in target.alternatives:
        if len(alternative.services) != len(problem.members):
            raise ValueError(f"{target.name}: {alternative.name} needs one service, or None, per aircraft")
