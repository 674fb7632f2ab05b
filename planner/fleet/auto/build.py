"""From a problem to the tables of the search."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from planner.fleet.auto.search import Tables
from planner.fleet.auto.tables import Costs, Crew, Floats, Ints, Jobs, Weights
from planner.fleet.problem import Problem

#: What leaving out a required target costs, times the greatest weight.
REQUIRED = 1e9
#: Stands for no limit where sums and differences are formed, s.
ENDLESS = 1e12


@dataclass(frozen=True, slots=True)
class Doing:
    """What a node of the tables is: an alternative at one of its target's visits; ``node`` in the problem."""

    target: int
    alternative: int
    number: int
    node: int


def doings(problem: Problem) -> tuple[Doing, ...]:
    """What the nodes after the bases are, job after job."""
    node = len(problem.bases)
    found: list[Doing] = []
    for number, target in enumerate(problem.targets):
        for visit in range(target.visits):
            found += [Doing(number, way, visit, node + way) for way in range(len(target.alternatives))]
        node += len(target.alternatives)
    return tuple(found)


def tables(problem: Problem) -> Tables:
    """What the search knows of a problem."""
    nodes = doings(problem)
    bases = len(problem.bases)
    where = np.array([*range(bases), *(doing.node for doing in nodes)], dtype=np.int64)
    jobs = _jobs(problem, nodes)
    service = _of_services(problem, nodes, "service_s", math.inf)
    weights = problem.objective
    seconds = _of_travel(problem, where, "seconds")
    moving = seconds + np.where(np.isfinite(service), service, 0.0)[:, None, :]
    price = weights.travel_time * np.where(np.isfinite(moving), moving, 0.0)
    if weights.risk:
        price += weights.risk * (
            _of_travel(problem, where, "risk") + _of_services(problem, nodes, "risk", 0.0)[:, None, :]
        )
    costs = Costs(
        np.ascontiguousarray(seconds),
        np.ascontiguousarray(seconds.transpose(0, 2, 1)),
        service,
        np.ascontiguousarray(price),
        np.ascontiguousarray(price.transpose(0, 2, 1)),
        _limited(problem, nodes, where, "length_m", "range_m"),
        _limited(problem, nodes, where, "energy_wh", "energy_wh"),
    )
    crew = _crew(problem)
    jobs = jobs._replace(
        near=np.ascontiguousarray(_near(jobs, seconds, bases)),
        keys=np.ascontiguousarray(_keys(jobs, seconds, bases)),
    )
    return Tables(jobs, costs, crew, Weights(float(weights.total_time), float(weights.last_landing)))


def _jobs(problem: Problem, nodes: tuple[Doing, ...]) -> Jobs:
    bases = len(problem.bases)
    weights = problem.objective
    costs = (weights.last_landing, weights.total_time, weights.travel_time, weights.risk, weights.priority)
    top = max(1.0, *costs)
    first, of, early, late = [bases], [-1] * bases, [0.0] * bases, [ENDLESS] * bases
    prize: list[float] = []
    after: list[int] = []
    apart: list[float] = []
    for target in problem.targets:
        window = target.window_s or (0.0, ENDLESS)
        for visit in range(target.visits):
            count = len(target.alternatives)
            first.append(first[-1] + count)
            of += [len(prize)] * count
            early += [window[0]] * count
            late += [min(window[1], ENDLESS)] * count
            prize.append(
                weights.priority * target.priority / target.visits + REQUIRED * top * target.required
            )
            after.append(len(prize) - 2 if visit else -1)
            apart.append(target.revisit_after_s if visit else 0.0)
    none = np.zeros((0, 0))
    return Jobs(
        np.array(first, dtype=np.int64),
        np.array(of, dtype=np.int64),
        np.array(early),
        np.array(late),
        np.array(prize),
        np.zeros(len(prize)),
        none.astype(np.int64),
        none,
        np.array(after, dtype=np.int64),
        np.array(apart),
    )


def _of_travel(problem: Problem, where: Ints, name: str) -> Floats:
    every = []
    for member in problem.members:
        values = getattr(member.travel, name)
        every.append(np.zeros((len(where), len(where))) if values is None else values[np.ix_(where, where)])
    return np.array(every)


def _of_services(problem: Problem, nodes: tuple[Doing, ...], name: str, otherwise: float) -> Floats:
    values = np.zeros((len(problem.members), len(problem.bases) + len(nodes)))
    for at, doing in enumerate(nodes, start=len(problem.bases)):
        for member, service in enumerate(
            problem.targets[doing.target].alternatives[doing.alternative].services
        ):
            values[member, at] = otherwise if service is None else getattr(service, name)
    return values


def _limited(problem: Problem, nodes: tuple[Doing, ...], where: Ints, name: str, limit: str) -> Floats:
    """Travel and service together where some member has the limit."""
    if all(math.isinf(getattr(member, limit)) for member in problem.members):
        return np.zeros((1, 1, 1))
    both = _of_travel(problem, where, name) + _of_services(problem, nodes, name, 0.0)[:, None, :]
    return np.ascontiguousarray(both)


def _crew(problem: Problem) -> Crew:
    members = problem.members
    limits = np.array(
        [
            (
                member.ready_s,
                min(ENDLESS, member.ready_s + member.shift_s),
                member.max_flight_s,
                member.range_m,
                member.energy_wh,
                member.waiting_w,
                member.turnaround_s,
                math.inf,
                REQUIRED * member.must_fly,
            )
            for member in members
        ]
    ).reshape(-1, 9)
    return Crew(
        np.arange(len(members)),
        np.array([member.start_base for member in members], dtype=np.int64),
        np.cumsum([0, *(member.trips for member in members)]),
        np.cumsum([0, *(len(member.end_bases) for member in members)]),
        np.array([base for member in members for base in member.end_bases], dtype=np.int64),
        np.arange(len(members)),
        limits,
    )


def _near(jobs: Jobs, seconds: Floats, bases: int) -> Ints:
    """Jobs by the least time between any of their nodes, either way, for any aircraft."""
    least = seconds.min(axis=0)[bases:, bases:] if len(seconds) else np.zeros((0, 0))
    least = np.minimum(least, least.T)
    starts = jobs.first[:-1] - bases
    if not len(starts):
        return np.zeros((0, 0), dtype=np.int64)
    between = np.minimum.reduceat(np.minimum.reduceat(least, starts, axis=0), starts, axis=1)
    np.fill_diagonal(between, -1.0)
    return np.argsort(between, axis=1, kind="stable").astype(np.int64)


def _keys(jobs: Jobs, seconds: Floats, bases: int) -> Floats:
    """Orders to put jobs back in: prize, near and far from the bases, windows short, early and late."""
    at = jobs.first[:-1]
    if not len(at):
        return np.zeros((1, 0))
    lead = seconds[:, :bases, :].min(axis=(0, 1))[at]
    early, late = jobs.early[at], jobs.late[at]
    return np.array([-jobs.prize, -lead, lead, late - early, early, late])
