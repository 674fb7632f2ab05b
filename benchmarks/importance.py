"""Importance on grids: ours, the published algorithm, baselines, the optimum where a model closes, a bound.

Rows: one a map and measure, then one a measure over all maps, then a map of 200 × 200 cells. ``measure`` is
``reward``, that of the paper's figure 7 (importance less 100 for each look again and 1 for each move left),
or ``importance`` alone; ours is told of it. ``gain`` is how much more ours is than the published algorithm's,
by the sums over all maps. ``seconds`` are of the clock, ``cpu_s`` of the processor.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from typing import Any

from benchmarks.importance_baselines import greedy, spiral
from benchmarks.importance_exact import optimum
from benchmarks.importance_maps import ImportanceMap, large, maps
from planner.search.importance.auto import Pay, auto
from planner.search.importance.bound import bounded
from planner.search.importance.snyder2021 import snyder2021
from planner.search.importance.walk import Walk, measured

#: Penalties by measure: of a look again, of a move left.
MEASURES = {"reward": (100.0, 1.0), "importance": (0.0, 0.0)}


def run(maps_up_to: int = 20, exact_s: float = 120.0, large_side: int = 200) -> Iterator[dict[str, Any]]:
    """Plan the maps."""
    _warm()
    by_measure: dict[str, list[dict[str, Any]]] = {name: [] for name in MEASURES}
    for one in list(maps())[:maps_up_to]:
        for measure, rows in by_measure.items():
            rows.append(_row(one, measure, exact_s))
            yield rows[-1]
    for measure, rows in by_measure.items():
        yield _summary(measure, rows)
    if large_side:
        yield _row(large(large_side), "importance", 0.0)


def _warm() -> None:
    first = next(maps())
    auto(first.grid, first.base, 6)
    optimum(first.grid, first.base, 6, 0.0, 0.0, 0.0, 1.0)


def _row(one: ImportanceMap, measure: str, exact_s: float) -> dict[str, Any]:
    revisit, unspent = MEASURES[measure]

    def of(walk: Walk) -> float:
        return measured(one.grid, walk).total_reward(revisit, unspent)

    began, began_cpu = time.perf_counter(), time.process_time()
    ours = of(auto(one.grid, one.base, one.battery, Pay(1.0, revisit, unspent)))
    seconds, cpu_s = time.perf_counter() - began, time.process_time() - began_cpu
    began = time.perf_counter()
    faithful = of(snyder2021(one.grid, one.base, one.battery))
    faithful_s = time.perf_counter() - began
    began = time.perf_counter()
    bound = bounded(one.grid, one.base, one.battery, revisit, unspent).total
    bound_s = time.perf_counter() - began
    best = optimum(one.grid, one.base, one.battery, revisit, unspent, ours, exact_s) if exact_s else None
    return {
        "map": one.name,
        "base": list(divmod(one.base, one.grid.shape[1]))[::-1],
        "battery": one.battery,
        "measure": measure,
        "ours": ours,
        "snyder2021": faithful,
        "snyder2021_next": of(snyder2021(one.grid, one.base, one.battery, refused="next")),
        "greedy": of(greedy(one.grid, one.base, one.battery)),
        "spiral": of(spiral(one.grid, one.base, one.battery)),
        "optimum": best.value if best else None,
        "bound": min(bound, best.bound) if best else bound,
        "of_optimum": ours / best.value if best and best.value else None,
        "of_bound": ours / bound,
        "seconds": seconds,
        "cpu_s": cpu_s,
        "snyder2021_s": faithful_s,
        "bound_s": bound_s,
        "exact_s": best.seconds if best else None,
    }


def _summary(measure: str, rows: list[dict[str, Any]]) -> dict[str, Any]:
    closed = [row for row in rows if row["optimum"] is not None]
    ours, faithful = (math.fsum(row[name] for row in rows) for name in ("ours", "snyder2021"))
    return {
        "map": "all",
        "measure": measure,
        "maps": len(rows),
        "gain": ours / faithful - 1.0,
        "closed": len(closed),
        "worst_of_optimum": min((row["of_optimum"] for row in closed if row["optimum"]), default=None),
        "worst_of_bound": min(row["of_bound"] for row in rows),
        "slowest_s": max(row["seconds"] for row in rows),
        "slowest_cpu_s": max(row["cpu_s"] for row in rows),
    }
