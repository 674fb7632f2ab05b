"""Vehicle routing problems of files in VRPLIB form as tables of the search."""

from __future__ import annotations

import itertools
import math
from pathlib import Path

import numpy as np
import pyvrp

from benchmarks.files import FileError
from planner.fleet.auto.build import ENDLESS, REQUIRED
from planner.fleet.auto.search import Found, Tables
from planner.fleet.auto.tables import Costs, Crew, Jobs, Weights

#: Ways to round distances, as instances of different collections are published; the first when nothing tells.
ROUNDINGS = ("exact", "round", "dimacs", "trunc", "none")


def published(file: Path) -> tuple[float | None, list[list[int]]]:
    """Cost and routes of the solution beside a file, as far as there is one."""
    beside = file.with_suffix(".sol")
    if not beside.exists():
        return None, []
    cost: float | None = None
    routes: list[list[int]] = []
    for line in beside.read_text().splitlines():
        name, _, rest = line.replace("Cost ", "Cost: ").partition(":")
        if name.strip().lower() == "cost":
            cost = float(rest)
        elif name.strip().lower().startswith("route"):
            routes.append([int(node) for node in rest.split()])
    return cost, [route for route in routes if route]


def read(file: Path) -> tuple[pyvrp.ProblemData, str]:
    """A file's problem, distances rounded as its published cost has them.

    Raises
    ------
    FileError
        Where it is none.
    """
    try:
        return _read(file)
    except (RuntimeError, LookupError, ValueError, TypeError, AttributeError, ArithmeticError) as error:
        raise FileError(f"{file.name}: no routing problem in VRPLIB form: {error!r}") from error


def _read(file: Path) -> tuple[pyvrp.ProblemData, str]:
    cost, routes = published(file)
    best: tuple[float, pyvrp.ProblemData, str] | None = None
    for rounding in ROUNDINGS:
        data = pyvrp.read(file, round_func=rounding)
        if cost is None or not routes:
            return data, rounding
        off = abs(_length(data, routes) / cost - 1.0)
        if best is None or off < best[0]:
            best = (off, data, rounding)
    assert best is not None
    return best[1], best[2]


def _length(data: pyvrp.ProblemData, routes: list[list[int]]) -> float:
    """Length of published routes of locations, each from the depot where it is shortest."""
    depots = [depot.location for depot in data.depots()]
    between = data.distance_matrix(0)
    total = 0.0
    for line in routes:
        inner = sum(float(between[a, b]) for a, b in itertools.pairwise(line))
        total += inner + min(float(between[d, line[0]] + between[line[-1], d]) for d in depots)
    return total


def tables(data: pyvrp.ProblemData) -> Tables:
    """What the search knows of it.

    Raises
    ------
    FileError
        Where the file asks for what the tables have no words for.
    """
    clients, depots, types = data.clients(), data.depots(), data.vehicle_types()
    _check(data)
    bases, total = len(depots), len(clients)
    where = [*(depot.location for depot in depots), *(client.location for client in clients)]
    profiles = sorted({kind.profile for kind in types})
    length = np.array([data.distance_matrix(p)[np.ix_(where, where)] for p in profiles], dtype=float)
    seconds = np.array([data.duration_matrix(p)[np.ix_(where, where)] for p in profiles], dtype=float)
    early = np.array([0.0] * bases + [max(c.tw_early, c.release_time) for c in clients], dtype=float)
    spans = np.array([0.0] * bases + [c.service_duration for c in clients], dtype=float)
    late = np.array([ENDLESS] * bases + [min(float(c.tw_late), ENDLESS) for c in clients]) + spans
    load = np.array([c.delivery[0] if c.delivery else 0.0 for c in clients], dtype=float)
    inner = length[:, bases:, bases:].min(axis=0)
    near = np.argsort(inner + inner.T - np.eye(total) * ENDLESS, axis=1, kind="stable")
    lead = length[:, :bases, bases:].min(axis=(0, 1))
    width = (late - early)[bases:]
    keys = np.array([-load, -load, -lead, lead, width, early[bases:], -late[bases:]])
    prizes = [REQUIRED * c.required + c.prize for c in clients]
    jobs = Jobs(
        np.arange(bases, bases + total + 1),
        np.array([-1] * bases + list(range(total))),
        early,
        late,
        np.array(prizes, dtype=float),
        load,
        near.astype(np.int64),
        keys,
        np.full(total, -1),
        np.zeros(total),
    )
    price = types[0].unit_distance_cost * length
    costs = Costs(
        seconds,
        np.ascontiguousarray(seconds.transpose(0, 2, 1)),
        np.repeat(spans[None], len(profiles), axis=0),
        price,
        np.ascontiguousarray(price.transpose(0, 2, 1)),
        length if any(kind.max_distance < ENDLESS for kind in types) else np.zeros((1, 1, 1)),
        np.zeros((1, 1, 1)),
    )
    return Tables(jobs, costs, _crew(data, profiles), Weights(float(types[0].unit_duration_cost), 0.0))


def _check(data: pyvrp.ProblemData) -> None:
    types, clients = data.vehicle_types(), data.clients()
    unknown = {
        "shipments": data.num_shipments > 0,
        "pickups": any(any(client.pickup) for client in clients),
        "several kinds of load": data.num_load_dimensions > 1,
        "groups": data.num_groups > 0,
        "reloading": any(kind.reload_depots for kind in types),
        "fixed costs": any(kind.fixed_cost for kind in types),
        "costs by type": len({(kind.unit_distance_cost, kind.unit_duration_cost) for kind in types}) > 1,
    }
    asked = [name for name, there in unknown.items() if there]
    if asked:
        raise FileError(f"the file asks for {', '.join(asked)}, which the search does not know")


def _crew(data: pyvrp.ProblemData, profiles: list[int]) -> Crew:
    depots = data.depots()
    rows = []
    for number, kind in enumerate(data.vehicle_types()):
        start, end = depots[kind.start_depot], depots[kind.end_depot]
        limits = (
            max(kind.tw_early, start.tw_early),
            min(float(kind.tw_late), float(end.tw_late), ENDLESS),
            min(float(kind.shift_duration), ENDLESS),
            float(kind.max_distance) if kind.max_distance < ENDLESS else math.inf,
            math.inf,
            0.0,
            0.0,
            float(kind.capacity[0]) if kind.capacity else math.inf,
            0.0,
        )
        row = (profiles.index(kind.profile), kind.start_depot, kind.end_depot, number, limits)
        rows += [row] * min(kind.num_available, data.num_clients)
    count = np.arange(len(rows) + 1)
    return Crew(
        np.array([row[0] for row in rows]),
        np.array([row[1] for row in rows]),
        count,
        count,
        np.array([row[2] for row in rows]),
        np.array([row[3] for row in rows]),
        np.array([row[4] for row in rows], dtype=float),
    )


def solution(data: pyvrp.ProblemData, found: Found) -> pyvrp.Solution:
    """What was found, measured by PyVRP."""
    bases = data.num_depots
    kinds = [
        number
        for number, kind in enumerate(data.vehicle_types())
        for _ in range(min(kind.num_available, data.num_clients))
    ]
    routes = [
        pyvrp.Route(data, [node - bases for node in order[1:-1]], kinds[member])
        for member, order in zip(found.members, found.routes, strict=True)
        if len(order) > 2
    ]
    return pyvrp.Solution(data, routes)
