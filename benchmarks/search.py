"""Search on stored energy: ours, the published receding horizon and its variants on the paper's case.

``swathplan bench search --json``. The paper flies its variants at several turn durations; each has a row
here, and one with the means of all. Times are those of one processor.
``--option turns_s=[6]`` for some of them.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from typing import Any

from planner.search.horizon import VARIANTS, energy_horizon
from planner.search.paper_case import HEADING_RAD, SIDE_M, paper_case
from planner.search.refine import auto, families

TURNS_S = (2.0, 4.0, 6.0, 8.0)


def run(turns_s: Sequence[float] = TURNS_S, seed: int = 0) -> Iterator[dict[str, Any]]:
    """A row for ``auto``, one for each variant and turn duration, and one with each variant's means."""
    case = paper_case()
    # Kernels are compiled before anything is timed.
    case.seen(case.line(next(families(case))[1])[0])
    began = time.process_time()
    found = auto(case, seed)
    taken_s = time.process_time() - began
    off_m = float(abs(found.points[-1] - case.end).max())
    yield _row(
        "auto", found.family, None, case.seen_m2(found.points), off_m, found.energy_j, None, None, taken_s
    )
    for name, variant in VARIANTS.items():
        rows = []
        for turn_s in turns_s:
            began = time.process_time()
            flown = energy_horizon(case, HEADING_RAD, variant, turn_s)
            taken_s = time.process_time() - began
            times = (flown.duration_s, flown.meant_s)
            rows.append(
                _row(name, None, turn_s, flown.seen_m2, flown.exit_off_m, flown.energy_j, *times, taken_s)
            )
            yield rows[-1]
        yield {
            **rows[0],
            "turn_s": "mean",
            **{
                column: round(sum(row[column] for row in rows) / len(rows), 4)
                for column in ("seen", "exit_off_m", "energy_left", "duration_s", "meant_s", "cpu_s")
            },
        }


def _row(
    method: str,
    family: str | None,
    turn_s: float | None,
    seen_m2: float,
    off_m: float,
    energy_j: float,
    duration_s: float | None,
    meant_s: float | None,
    cpu_s: float,
) -> dict[str, Any]:
    case = paper_case()
    return {
        "bench": "search",
        "case": "navion-square",
        "method": method,
        "family": family,
        "turn_s": turn_s,
        "seen": round(seen_m2 / SIDE_M**2, 4),
        "exit_off_m": round(off_m, 2),
        "energy_left": round(1.0 - energy_j / case.glider.energy_j, 5),
        "duration_s": None if duration_s is None else round(duration_s, 1),
        "meant_s": None if meant_s is None else round(meant_s, 1),
        "cpu_s": round(cpu_s, 3),
    }
