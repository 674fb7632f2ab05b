"""Orienteering on files of others: the most reward within a budget.

``swathplan bench orienteering FILE [--budget B] [--seconds S] [--paths DIR] --json`` takes OPLib's files and
polygons with targets as JSON (``benchmarks.orienteering_files``). A row has the reward and length found, the
seconds from the file to the path, and what was published, where the file or the ``.sol`` beside it says so.
"""

from __future__ import annotations

import itertools
import json
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from shapely.geometry import Polygon

from benchmarks.orienteering_files import OplibProblem, PolygonProblem, budget_name, read
from planner.fleet.prizes.bound import reward_bound
from planner.fleet.prizes.flyable import Field, dense_points, most_reward
from planner.fleet.prizes.problem import Prizes
from planner.fleet.prizes.route import best_route

#: Of the time allowed, the part for what is done once the search was told to stop.
LAST = 0.15
#: Points of a path are no further apart.
STEP = 1.0
#: Where the file names no turn radius.
TURN_RADIUS = 60.0


def run(
    file: str | Path,
    budget: float | None = None,
    seconds: float = 10.0,
    paths: str | Path | None = None,
    threads: int = 2,
    seed: int = 1,
    turn_radius: float | None = None,
    bound: bool = False,
) -> Iterator[dict[str, Any]]:
    """A row for each budget of the file, or for the one asked for.

    Parameters
    ----------
    seconds
        For each budget, at most.
    paths
        Folder for ``<stem of the file>-<budget>.json``: [x, y] at most 1 apart, from start to end.
    threads
        That search side by side.
    turn_radius
        Among polygons; the widest that the file has figures for where not given, 0 for straight flight.
    bound
        OPLib's files: also what no route brings more than, by ``planner.fleet.prizes.bound``; its time is not
        among the seconds.
    """
    path = Path(file)
    problem = read(path)
    folder = None if paths is None else Path(paths)
    if folder is not None:
        folder.mkdir(parents=True, exist_ok=True)
    if isinstance(problem, OplibProblem):
        # Kernels are loaded first, so that no problem's time is that of a compiler.
        best_route(Prizes(1.0 - np.eye(4), np.arange(4.0), 2.0), 0)
        row, points = _oplib_row(problem, budget, seconds, threads, seed, bound)
        yield _told(path, row, points, folder)
        return
    if turn_radius is None:
        turn_radius = max((row.turn_radius for row in problem.published), default=TURN_RADIUS)
    most_reward(_small(turn_radius), 10.0 * max(turn_radius, 1.0), 0)
    budgets = sorted({row.budget for row in problem.published if row.turn_radius == turn_radius})
    for each in budgets if budget is None else [budget]:
        row, points = _polygons_row(problem, each, turn_radius, seconds, threads, seed)
        yield _told(path, row, points, folder)


def _told(path: Path, row: dict[str, Any], points: list[list[float]], folder: Path | None) -> dict[str, Any]:
    if folder is not None and points:
        name = f"{path.stem}-{budget_name(row['budget'])}.json"
        (folder / name).write_text(json.dumps(points), encoding="utf-8")
    return {"bench": "orienteering", "file": path.name} | row


def _oplib_row(
    problem: OplibProblem, budget: float | None, seconds: float, threads: int, seed: int, bound: bool
) -> tuple[dict[str, Any], list[list[float]]]:
    began = time.perf_counter()
    limit = problem.limit if budget is None else budget
    count = len(problem.scores)
    # The depot is the start and, once more, the end.
    places = np.array([problem.depot, *(k for k in range(count) if k != problem.depot), problem.depot])
    rewards = problem.scores[places]
    rewards[-1] = 0.0
    prizes = Prizes(problem.distances[np.ix_(places, places)], rewards, limit)
    until = began + (1.0 - LAST) * seconds
    found = best_route(prizes, seed, pools=None, threads=threads, stop=lambda: time.perf_counter() >= until)
    route = [int(places[k]) for k in found.order]
    points = [] if problem.points is None else _dense(problem.points[route])
    row = {
        "model": "matrix",
        "turn_radius": 0.0,
        "budget": limit,
        "reward": found.reward,
        "cost": found.cost,
        "length": found.cost,
        "seconds": round(time.perf_counter() - began, 3),
        "published_best": problem.published if limit == problem.limit else None,
        "published_mean": None,
        "published_seconds": None,
        "visited": len(set(route)),
        "route": [node + 1 for node in route],
    }
    if bound:
        row["bound"] = reward_bound(prizes)
    return row, points


def _polygons_row(
    problem: PolygonProblem, budget: float, turn_radius: float, seconds: float, threads: int, seed: int
) -> tuple[dict[str, Any], list[list[float]]]:
    began = time.perf_counter()
    until = began + (1.0 - LAST) * seconds
    field = field_of(problem, turn_radius)
    known = [row for row in problem.published if row.budget == budget and row.turn_radius == turn_radius]
    row: dict[str, Any] = {
        "model": "dubins" if turn_radius > 0.0 else "straight",
        "turn_radius": turn_radius,
        "budget": budget,
    }
    try:
        found = most_reward(
            field, budget, seed, pools=None, threads=threads, stop=lambda: time.perf_counter() >= until
        )
    except ValueError as error:
        gained, points, route = {"reward": 0.0, "length": None, "why": str(error)}, [], []
    else:
        route = list(found.targets)
        ends = [*(field.targets[k] for k in route), field.end]
        points = dense_points(found, ends, STEP)
        gained = {"reward": found.reward, "length": found.length}
    return row | gained | {
        "seconds": round(time.perf_counter() - began, 3),
        "published_best": known[0].best if known else None,
        "published_mean": known[0].mean if known else None,
        "published_seconds": known[0].seconds if known else None,
        "visited": len(route),
        "route": [k + 1 for k in route],
    }, points


def field_of(problem: PolygonProblem, turn_radius: float) -> Field:
    """The problem as the planner takes it."""
    return Field(
        problem.start,
        problem.end,
        tuple((float(x), float(y)) for x, y in problem.targets),
        tuple(float(reward) for reward in problem.rewards),
        tuple(Polygon(ring) for ring in problem.obstacles),
        Polygon(problem.border) if problem.border else None,
        turn_radius,
    )


def _small(radius: float) -> Field:
    """Enough to load every kernel."""
    far = max(radius, 1.0)
    box = Polygon([(far, -0.5 * far), (2.0 * far, -0.5 * far), (2.0 * far, 0.5 * far), (far, 0.5 * far)])
    return Field((0.0, 0.0), (4.0 * far, 0.0), ((3.0 * far, 1.0),), (1.0,), (box,), None, radius)


def _dense(points: NDArray[np.float64]) -> list[list[float]]:
    """The same line with points at most a step apart."""
    dense = [points[0].tolist()]
    for a, b in itertools.pairwise(points):
        parts = max(int(np.ceil(np.hypot(*(b - a)) / STEP)), 1)
        dense += [(a + (b - a) * (k / parts)).tolist() for k in range(1, parts + 1)]
    return dense
