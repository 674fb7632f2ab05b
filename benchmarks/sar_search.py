"""Search and rescue: how likely a missing person at sea is found, by ours and by the manuals' patterns.

Twenty pinned cases: a last known point with its error, drift with its own, one to four aircraft. Plans are
judged by places drawn with another seed, many more than they were planned by. Rows: one a case, with the
probability of success at each quarter of the flight of ours and of the best pattern then, and of each pattern
in the end; then one over all. ``ahead`` is by how much ours is above every pattern at the quarter where that
is least.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from planner.search.belief.auto import auto
from planner.search.belief.patterns import PATTERNS, Searcher, Shape, pattern_lines
from planner.search.belief.success import success
from planner.search.belief.target import Belief, Target

#: Places and seed that plans are judged by.
JUDGED, JUDGE_SEED = 20_000, 9_999
QUARTERS = np.array([0.25, 0.5, 0.75, 1.0])


@dataclass(frozen=True, slots=True)
class Case:
    """One missing person, and who searches."""

    name: str
    target: Target
    searchers: tuple[Searcher, ...]


def cases() -> Iterator[Case]:
    """The twenty."""
    generator = np.random.default_rng(1979)
    for index in range(20):
        count = 1 + index % 4
        drift_rad, speed_m_s = generator.uniform(0.0, math.tau), generator.uniform(0.0, 1.0)
        target = Target(
            last_known_m=(0.0, 0.0),
            spread_m=generator.uniform(300.0, 1200.0),
            drift_m_s=(speed_m_s * math.cos(drift_rad), speed_m_s * math.sin(drift_rad)),
            drift_spread_m_s=generator.uniform(0.05, 0.3),
            elapsed_s=generator.uniform(0.0, 3600.0),
        )
        until_s = generator.uniform(1500.0, 3000.0)
        east, north = target.datum_m(0.5 * until_s)
        away_m, away_rad = generator.uniform(500.0, 3000.0), generator.uniform(0.0, math.tau)
        half_m = generator.uniform(60.0, 150.0)
        speed = generator.uniform(15.0, 25.0)
        detection = float(generator.choice([0.6, 0.75, 0.9]))
        searchers = tuple(
            Searcher(
                (
                    east + away_m * math.cos(away_rad) + 100.0 * k,
                    north + away_m * math.sin(away_rad),
                ),
                speed,
                min(0.9 * half_m, 80.0),
                until_s,
                half_m,
                detection,
            )
            for k in range(count)
        )
        yield Case(f"{index:02d}-{count}-aircraft", target, searchers)


def run(cases_up_to: int = 20, first: int = 0) -> Iterator[dict[str, Any]]:
    """Search for all."""
    rows = []
    for case in list(cases())[first:cases_up_to]:
        rows.append(_row(case))
        yield rows[-1]
    if rows:
        yield {
            "case": "all",
            "cases": len(rows),
            "ahead_at_every_quarter": sum(row["ahead"] > 0.0 for row in rows),
            "least_ahead": min(row["ahead"] for row in rows),
            "mean_ours": [float(np.mean([row["ours"][k] for row in rows])) for k in range(4)],
            "mean_best_pattern": [float(np.mean([row["best_pattern"][k] for row in rows])) for k in range(4)],
            "slowest_s": max(row["seconds"] for row in rows),
            "slowest_cpu_s": max(row["cpu_s"] for row in rows),
        }


def _row(case: Case) -> dict[str, Any]:
    began, began_cpu = time.perf_counter(), time.process_time()
    found = auto(case.target, case.searchers)
    seconds, cpu_s = time.perf_counter() - began, time.process_time() - began_cpu
    belief = Belief.drawn(case.target, JUDGED, JUDGE_SEED)
    times = QUARTERS * max(one.until_s for one in case.searchers)
    ours = success(found.lines, case.searchers, belief, times)
    # Legs creep along with the drift.
    east, north = case.target.drift_m_s
    shape = Shape(course_rad=math.atan2(north, east) - 0.5 * math.pi)
    theirs = {
        name: success(pattern_lines(name, case.target, case.searchers, shape), case.searchers, belief, times)
        for name in PATTERNS
    }
    best = np.max(list(theirs.values()), axis=0)
    return {
        "case": case.name,
        "ours": np.round(ours, 4).tolist(),
        "best_pattern": np.round(best, 4).tolist(),
        "ahead": round(float((ours - best).min()), 4),
        **{name: round(float(by_time[-1]), 4) for name, by_time in theirs.items()},
        "seconds": round(seconds, 2),
        "cpu_s": round(cpu_s, 2),
    }
