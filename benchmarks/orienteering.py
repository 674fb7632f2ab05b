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

from benchmarks.orienteering_files import FileError, OplibProblem, budget_name, read
from planner.fleet.prizes.problem import Prizes
from planner.fleet.prizes.route import best_route

#: Of the time allowed, what writing the answer may take.
LAST_S = 0.1
#: Points of a path are no further apart.
STEP = 1.0


def run(
    file: str | Path,
    budget: float | None = None,
    seconds: float = 10.0,
    paths: str | Path | None = None,
    threads: int = 2,
    seed: int = 1,
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
    """
    path = Path(file)
    problem = read(path)
    _compiled()
    folder = None if paths is None else Path(paths)
    if folder is not None:
        folder.mkdir(parents=True, exist_ok=True)
    if isinstance(problem, OplibProblem):
        yield _oplib_row(path, problem, budget, seconds, folder, threads, seed)
        return
    raise FileError(f"{path.name}: polygons")


def _compiled() -> None:
    """Load the kernels, so that no problem's time is that of a compiler."""
    best_route(Prizes(1.0 - np.eye(4), np.arange(4.0), 2.0), 0)


def _oplib_row(
    path: Path,
    problem: OplibProblem,
    budget: float | None,
    seconds: float,
    folder: Path | None,
    threads: int,
    seed: int,
) -> dict[str, Any]:
    began = time.perf_counter()
    limit = problem.limit if budget is None else budget
    count = len(problem.scores)
    # The depot is the start and, once more, the end.
    places = np.array([problem.depot, *(k for k in range(count) if k != problem.depot), problem.depot])
    rewards = problem.scores[places]
    rewards[-1] = 0.0
    prizes = Prizes(problem.distances[np.ix_(places, places)], rewards, limit)
    until = began + seconds - LAST_S
    found = best_route(prizes, seed, pools=None, threads=threads, stop=lambda: time.perf_counter() >= until)
    taken_s = time.perf_counter() - began
    route = [int(places[k]) for k in found.order]
    if folder is not None:
        points = [] if problem.points is None else _dense(problem.points[route])
        (folder / f"{path.stem}-{budget_name(limit)}.json").write_text(json.dumps(points), encoding="utf-8")
    return {
        "bench": "orienteering",
        "file": path.name,
        "model": "matrix",
        "turn_radius": 0.0,
        "budget": limit,
        "reward": found.reward,
        "cost": found.cost,
        "length": found.cost,
        "seconds": round(taken_s, 3),
        "published_best": problem.published if limit == problem.limit else None,
        "published_mean": None,
        "published_seconds": None,
        "visited": len(route) - 1,
        "route": [node + 1 for node in route],
    }


def _dense(points: np.ndarray[Any, np.dtype[np.float64]]) -> list[list[float]]:
    """The same line with points at most a step apart."""
    dense = [points[0].tolist()]
    for a, b in itertools.pairwise(points):
        parts = max(int(np.ceil(np.hypot(*(b - a)) / STEP)), 1)
        dense += [(a + (b - a) * (k / parts)).tolist() for k in range(1, parts + 1)]
    return dense
