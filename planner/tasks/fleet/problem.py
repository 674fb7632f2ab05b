"""A scenario's jobs and crews as the assignment's problem, and what flights have taught of its figures."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from planner.fleet.assignment import Assignment, Trip
from planner.fleet.problem import Alternative, Member, Objective, Problem, Service, Target
from planner.route import Terminal
from planner.tasks.fleet.crews import Crew
from planner.tasks.fleet.jobs import Job
from planner.tasks.fleet.placing import LateError
from planner.tasks.fleet.ways import Ways
from planner.vehicle.aircraft import Aircraft
from planner.wishes import Objective as Weights

Floats = NDArray[np.float64]
WaysOf = Mapping[tuple[str, int], Ways]

#: A target that need not be seen is worth this many seconds for a priority of one: it is left out where it
#: does not fit, and not for its cost.
WORTH_S = 1e5
#: Flights of an aircraft whose battery lasts for ever.
MOST_TRIPS = 20


@dataclass(slots=True)
class Lessons:
    """What flights took against what was thought, by the number of a crew.

    ``besides_s`` is what each flight takes more, ``power`` the mean power by that at cruise, ``factors`` are
    of all times in the air once one was late, ``spare`` of what one flight may take. ``most_s`` is how long
    one may last so that its mission has no more items than its autopilot holds, and ``flights`` how many that
    makes of what was one. ``closes_s`` is when jobs, by
    their names, are to be over by so that others in their way do not make them late.
    """

    besides_s: dict[int, float] = field(default_factory=dict)
    power: dict[int, float] = field(default_factory=dict)
    factors: dict[int, float] = field(default_factory=dict)
    spare: dict[int, float] = field(default_factory=dict)
    most_s: dict[int, float] = field(default_factory=dict)
    flights: dict[int, int] = field(default_factory=dict)
    closes_s: dict[str, float] = field(default_factory=dict)

    def learn(self, told_s: Mapping[int, Sequence[float]], crews: Sequence[Crew]) -> None:
        """By how much flights took longer than was thought, for all crews of a kind: they are alike."""
        for number, crew in enumerate(crews):
            more_s = [s for other, own in told_s.items() if crews[other].kind == crew.kind for s in own]
            if more_s:
                self.besides_s[number] = self.besides_s.get(number, 0.0) + sum(more_s) / len(more_s)

    def hurry(self, crew: int, part: float) -> None:
        """A flight was late: the next ones are thought to take longer."""
        self.factors[crew] = self.factor(crew) * part

    def late(self, late: LateError, jobs: Sequence[Job], assigned: Assignment, tighter: float) -> None:
        """A window was missed: the job is to be over earlier, or its crew thought to take longer."""
        name = late.job.region.name
        if late.crowded and late.job.visits == 1:
            # Its flight waits for others, and takes as long as was thought.
            ends_s = [
                visit.end_s
                for trip in assigned.trips
                for visit in trip.visits
                if jobs[visit.target].region.name == name
            ]
            self.closes_s[name] = min(ends_s) - late.late_s
            return
        closes_s = (late.job.region.time_window_s or (0.0, math.inf))[1]
        more = late.late_s / max(closes_s, late.late_s) if math.isfinite(closes_s) else 0.0
        self.hurry(late.crew, (1.0 + more) / tighter)

    def tighten(self, crew: int, part: float) -> None:
        """A flight was over a limit: the next ones are planned with less."""
        self.spare[crew] = self.spare.get(crew, 1.0) * part

    def shorten(self, crew: int, flown_s: float, part: float) -> None:
        """A flight of so long had too many items: the next ones last this part of it at most."""
        self.most_s[crew] = min(self.most_s.get(crew, math.inf), part * flown_s)
        self.flights[crew] = max(self.flights.get(crew, 1) + 1, math.ceil(1.0 / part))

    def factor(self, crew: int) -> float:
        """Of times in the air."""
        return self.factors.get(crew, 1.0)


@dataclass(frozen=True, slots=True)
class Node:
    """One way to do one job: numbers of the job and of its alternative, and the ways they are of."""

    job: int
    ways: Ways
    row: int


def problem_of(
    crews: Sequence[Crew],
    jobs: Sequence[Job],
    ways: WaysOf,
    weights: Weights,
    lessons: Lessons,
) -> Problem:
    """The problem of who does which jobs when.

    Parameters
    ----------
    ways
        By a job's name and the number of a crew.
    """
    bases, starts, ends = _bases(crews)
    nodes, targets = _targets(crews, jobs, ways, lessons)
    members = tuple(
        _member(crew, number, len(bases), (starts[number], ends[number]), nodes, ways, jobs, lessons)
        for number, crew in enumerate(crews)
    )
    return Problem(
        bases,
        targets,
        members,
        Objective(
            last_landing=weights.last_landing,
            total_time=weights.total_time,
            priority=weights.priority * WORTH_S,
        ),
    )


def _bases(crews: Sequence[Crew]) -> tuple[tuple[str, ...], list[int], list[tuple[int, ...]]]:
    """Names of all places where flights start and end, and which of them is whose."""
    known: dict[tuple[float, float], int] = {}
    names: list[str] = []

    def number(terminal: Terminal) -> int:
        if terminal.position not in known:
            known[terminal.position] = len(names)
            names.append(terminal.name)
        return known[terminal.position]

    starts: list[int] = []
    ends: list[tuple[int, ...]] = []
    for crew in crews:
        starts.append(number(crew.ends[0]))
        ends.append(tuple(number(landing) for landing in crew.landings))
    return tuple(names), starts, ends


def ends_of(crews: Sequence[Crew], trip: Trip) -> tuple[Terminal, Terminal]:
    """Where a flight that was assigned starts, and where it ends."""
    _, starts, ends = _bases(crews)
    crew, own = crews[trip.member], ends[trip.member]
    start = crew.setting.ends[0]
    if trip.start_base != starts[trip.member]:
        start = crew.landings[own.index(trip.start_base)]
    return start, crew.landings[own.index(trip.end_base)]


def _targets(
    crews: Sequence[Crew], jobs: Sequence[Job], ways: WaysOf, lessons: Lessons
) -> tuple[list[Node], tuple[Target, ...]]:
    nodes: list[Node] = []
    targets = []
    for number, job in enumerate(jobs):
        alternatives: list[Alternative] = []
        distinct: dict[int, tuple[Ways, list[int]]] = {}
        for crew in range(len(crews)):
            found = ways.get((job.region.name, crew))
            if found is not None:
                distinct.setdefault(id(found), (found, []))[1].append(crew)
        for found, able in distinct.values():
            for row, inner_m in enumerate(found.inner_m.tolist()):
                services = tuple(
                    _service(crews[crew], crew, inner_m, lessons) if crew in able else None
                    for crew in range(len(crews))
                )
                alternatives.append(Alternative(f"{job.region.name} way {len(alternatives) + 1}", services))
                nodes.append(Node(number, found, row))
        region = job.region
        targets.append(
            Target(
                region.name,
                tuple(alternatives),
                region.priority * job.share,
                region.required,
                _window(region.time_window_s, lessons.closes_s.get(region.name, math.inf)),
                job.visits,
                region.revisit_after_s,
            )
        )
    return nodes, tuple(targets)


def _window(asked_s: tuple[float, float] | None, closes_s: float) -> tuple[float, float] | None:
    """A window that closes no later than was learnt."""
    if not math.isfinite(closes_s):
        return asked_s
    opens_s, until_s = asked_s or (0.0, math.inf)
    return opens_s, max(min(until_s, closes_s), opens_s)


def _service(crew: Crew, number: int, inner_m: float, lessons: Lessons) -> Service:
    seconds = inner_m / crew.setting.model.airspeed_m_s * lessons.factor(number)
    energy_wh = (
        0.0 if crew.power_w is None else seconds * crew.power_w * lessons.power.get(number, 1.0) / 3600.0
    )
    return Service(seconds, seconds * crew.setting.model.airspeed_m_s, energy_wh)


def _member(
    crew: Crew,
    number: int,
    base_count: int,
    own: tuple[int, tuple[int, ...]],
    nodes: Sequence[Node],
    ways: WaysOf,
    jobs: Sequence[Job],
    lessons: Lessons,
) -> Member:
    seconds = np.full((base_count + len(nodes),) * 2, math.inf)
    mine = [k for k, node in enumerate(nodes) if ways.get((jobs[node.job].region.name, number)) is node.ways]
    if mine:
        entries = np.array([nodes[k].ways.entries[nodes[k].row] for k in mine])
        exits = np.array([nodes[k].ways.exits[nodes[k].row] for k in mine])
        between, out, home = crew.seconds(entries, exits)
        rows = base_count + np.array(mine)
        seconds[np.ix_(rows, rows)] = between
        half_s = (crew.besides_s + lessons.besides_s.get(number, 0.0)) / 2.0
        # From where it has landed with one battery it starts with the next.
        for start, out_s in reversed(list(zip((own[0], *own[1]), out, strict=True))):
            seconds[start, rows] = np.maximum(out_s + half_s, 0.0)
        for end, home_s in zip(own[1], home, strict=True):
            seconds[rows, end] = np.maximum(home_s + half_s, 0.0)
    seconds[np.ix_([own[0], *own[1]], list(own[1]))] = 0.0
    np.fill_diagonal(seconds, 0.0)
    seconds = seconds * lessons.factor(number)
    aircraft, spare = crew.setting.model.aircraft, lessons.spare.get(number, 1.0)
    split = number in lessons.flights
    shift_s = math.inf
    if split and aircraft.batteries == 1:
        # One battery is for all of its flights: each has an even share where it may wait for a window to take
        # off, else all are over by when one flight would be.
        if any(job.region.time_window_s is not None or job.visits > 1 for job in jobs):
            spare /= lessons.flights[number]
        else:
            shift_s = spare * _lasts_s(crew, lessons.power.get(number, 1.0))
    return Member(
        aircraft.name,
        crew.travel(seconds, lessons.power.get(number, 1.0)),
        own[0],
        own[1],
        max_flight_s=min(_limit(aircraft.max_flight_time_s, spare), lessons.most_s.get(number, math.inf)),
        range_m=_limit(aircraft.max_range_m, spare),
        energy_wh=_limit(aircraft.usable_wh, spare) if crew.power_w is not None else math.inf,
        waiting_w=crew.power_w or 0.0,
        shift_s=shift_s,
        trips=trips_of(aircraft) if split else aircraft.batteries,
        turnaround_s=aircraft.turnaround_s,
    )


def trips_of(aircraft: Aircraft) -> int:
    """How many flights an aircraft may make of what its autopilot does not hold as one mission.

    As many as it has batteries; of one, as many as it takes: what it has is for all of them together.
    """
    if aircraft.batteries > 1 or aircraft.aloft is not None:
        return aircraft.batteries
    return MOST_TRIPS


def _lasts_s(crew: Crew, power: float) -> float:
    """How long one battery lasts for flights without a pause, at a mean power by that at cruise."""
    aircraft = crew.setting.model.aircraft
    limits_s = [math.inf if aircraft.max_flight_time_s is None else aircraft.max_flight_time_s]
    if aircraft.max_range_m is not None:
        limits_s.append(aircraft.max_range_m / crew.setting.model.airspeed_m_s)
    if aircraft.usable_wh is not None and crew.power_w:
        limits_s.append(3600.0 * aircraft.usable_wh / (power * crew.power_w))
    return min(limits_s)


def _limit(value: float | None, spare: float) -> float:
    return math.inf if value is None else value * spare
