"""Coverage among obstacles: methods by name on twenty pinned maps.

``swathplan bench urban --json``; ``--option maps=["table-1"]`` and ``--option methods=["majeed2019"]`` for
some of them; ``--option maps=["real-bubenec"]`` for real houses (see ``urban_real``).
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from typing import Any

from benchmarks.urban_maps import NAMES, UrbanMap, named
from benchmarks.urban_real import NAME as REAL
from benchmarks.urban_real import real
from planner.coverage.urban.free import free_space
from planner.coverage.urban.measures import measure
from planner.coverage.urban.methods import METHODS

#: Compared unless asked for otherwise; the paper's order by HiGHS takes some seconds a map.
COMPARED = tuple(name for name in METHODS if name != "majeed2019-highs")


def run(
    maps: Sequence[str] | str = NAMES, methods: Sequence[str] | str = COMPARED, repeats: int = 3
) -> Iterator[dict[str, Any]]:
    """A row for each map and method: the least times of so many runs, after one on a small map to compile.

    ``cpu_s`` is what the planning thread computed, whatever else the machine does.
    """
    asked = (methods,) if isinstance(methods, str) else tuple(methods)
    small = named("table-1")
    for method in asked:
        METHODS[method](small.urban)
    for name in (maps,) if isinstance(maps, str) else maps:
        found = real() if name == REAL else named(name)
        for method in asked:
            yield _row(found, method, repeats)


def _row(found: UrbanMap, method: str, repeats: int) -> dict[str, Any]:
    urban = found.urban
    taken_s, cpu_s = [], []
    for _ in range(max(repeats, 1)):
        began, began_cpu = time.perf_counter(), time.thread_time()
        flown = METHODS[method](urban)
        cpu_s.append(time.thread_time() - began_cpu)
        taken_s.append(time.perf_counter() - began)
    free = free_space(urban)
    got = measure(urban, free, flown)
    west, south, east, north = urban.area.bounds
    return {
        "bench": "urban",
        "map": found.name,
        "shape": found.shape,
        "density": found.density,
        "size_m": f"{east - west:.0f} x {north - south:.0f}",
        "free": round(free.ground.area / urban.area.area, 3),
        "method": method,
        "length_m": round(got.length_m, 1),
        "sweep_m": round(got.sweep_m, 1),
        "sweeps": got.sweeps,
        "turns": got.turns,
        "overlap_m": round(got.overlap_m, 1),
        "coverage": round(got.coverage, 6),
        "duration_s": round(got.duration_s, 1),
        "planning_s": round(min(taken_s), 3),
        "cpu_s": round(min(cpu_s), 4),
        "paper_length_m": found.paper_m,
    }
