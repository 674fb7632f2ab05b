"""Vehicle routing with time windows: our search on public files, against the published cost."""

from __future__ import annotations

import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from benchmarks.vrplib import published, read, solution, tables
from planner.fleet.auto.search import Found, search
from planner.progress import never

#: What a process takes beside the search: to begin, to measure, to hand over.
OVERHEAD_S = 1.0
#: What the command may have taken until then, to be counted: longer ago a compiler was at work.
LOADING_S = 3.0
#: Searched at least, s, however late a busy machine let the process begin.
LEAST_S = 0.5


def run(
    file: Path | str, seconds: float = 60.0, seeds: int = 2, seed: int = 0, peer: bool = False
) -> Iterator[dict[str, Any]]:
    """The best of ``seeds`` searches at once, and with ``peer`` PyVRP in the same way.

    Parameters
    ----------
    file
        In VRPLIB form; its published solution is read from the ``.sol`` beside it.
    seconds
        From the command's begin to the answer, but for a compiler's time; the search has half of it at least.
    """
    path = Path(file)
    data, rounding = read(path)
    best, _ = published(path)
    search(tables(data), 0, lambda done: float(done > 0), never, _quiet)
    loading = min(LOADING_S, time.process_time())
    for solver in ("swathplan", "pyvrp") if peer else ("swathplan",):
        begin = time.time()
        # The peer begins as late as ours did.
        deadline = begin + max(seconds / 2.0, seconds - OVERHEAD_S - loading)
        work = [(str(path), solver, seed + k, deadline) for k in range(seeds)]
        if seeds == 1:
            answers = [_solve(*work[0])]
        else:
            with ProcessPoolExecutor(seeds, mp_context=get_context("spawn")) as pool:
                answers = list(pool.map(_solve, *zip(*work, strict=True)))
        cost, length, feasible, _ = min(answers, key=lambda answer: (not answer[2], answer[0]))
        yield {
            "file": path.name,
            "solver": solver,
            "cost": cost,
            "length": length,
            "feasible": feasible,
            "seconds": round(time.time() - begin + loading, 2),
            "published": best,
            "gap_percent": None if best is None else round(100.0 * (cost / best - 1.0), 3),
            "clients": data.num_clients,
            "depots": data.num_depots,
            "rounding": rounding,
            "iterations": sum(answer[3] for answer in answers),
        }


def _quiet(part: float) -> None:
    """Drop the report."""


def _solve(file: str, solver: str, seed: int, deadline: float) -> tuple[float, float, bool, int]:
    """Cost, length, whether all limits are kept, as PyVRP measures them, and iterations."""
    data, _ = read(Path(file))
    if solver == "pyvrp":
        return _pyvrp(data, seed, deadline)
    begin = time.time()
    span = max(LEAST_S, deadline - begin)
    found: Found = search(tables(data), seed, lambda done: (time.time() - begin) / span, never, _quiet)
    measured = solution(data, found)
    cost = measured.distance_cost() + measured.duration_cost() + measured.uncollected_prizes()
    return float(cost), float(measured.distance()), bool(measured.is_feasible()), found.iterations


def _pyvrp(data: Any, seed: int, deadline: float) -> tuple[float, float, bool, int]:
    import pyvrp
    from pyvrp.stop import MaxRuntime

    result = pyvrp.solve(data, MaxRuntime(max(LEAST_S, deadline - time.time())), seed=seed, display=False)
    measured = result.best
    return (
        float(result.cost()),
        float(measured.distance()),
        bool(measured.is_feasible()),
        result.num_iterations,
    )
