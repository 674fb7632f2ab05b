"""Search on stored energy: ours, the published receding horizon and its variants on the paper's case.

``swathplan bench search --json``. The paper flies its variants at several turn durations; each has a row
here, and one with the means of all. Times are those of one processor.
``--option turns_s=[6]`` for some of them. ``--option random=200`` plans so many random searches whole, each a
row with what it uses of what it may, and what the judge says; ``--option mixed=100`` so many of every kind,
with several aircraft, and of each flight what is reckoned anew. ``--option picture=FILE`` draws instead, with
``--option drifting=true`` someone overboard.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from benchmarks.drift_picture import picture as drawn_drifting
from benchmarks.mixed_searches import flights_of, mixed_search
from benchmarks.search_picture import picture as drawn
from benchmarks.search_scenarios import random_search
from planner.errors import PlannerError
from planner.geojson import write_plan
from planner.pipeline import make_plan
from planner.search.horizon import VARIANTS, energy_horizon
from planner.search.paper_case import HEADING_RAD, SIDE_M, paper_case
from planner.search.refine import auto, families
from planner.validate import read_valid

TURNS_S = (2.0, 4.0, 6.0, 8.0)


def run(
    turns_s: Sequence[float] = TURNS_S,
    seed: int = 0,
    random: int = 0,
    mixed: int = 0,
    picture: str = "",
    drifting: bool = False,
) -> Iterator[dict[str, Any]]:
    """A row for ``auto``, one for each variant and turn duration, and one with each variant's means.

    Or, where so many random searches are asked for, a row for each, and one that counts them.
    """
    if picture:
        Path(picture).write_text(drawn_drifting() if drifting else drawn())
        yield {"bench": "search", "picture": picture}
        return
    if random:
        yield from _random(random, seed)
        return
    if mixed:
        yield from _mixed(mixed, seed)
        return
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


def _random(count: int, seed: int) -> Iterator[dict[str, Any]]:
    """Random searches, planned whole and judged."""
    home = 0
    for number in range(count):
        document = random_search(seed + number)
        began = time.process_time()
        row: dict[str, Any] = {"bench": "search", "case": document["name"]}
        try:
            scenario = read_valid(document)
            plan = make_plan(scenario)
        except PlannerError as error:
            yield row | {"refused": str(error)}
            continue
        metrics, usable_wh = plan.metrics, scenario.aircraft[0].usable_wh
        kept = not plan.hard_violations and (
            usable_wh is None or metrics.energy_wh is None or metrics.energy_wh <= usable_wh
        )
        home += kept
        yield row | {
            "method": plan.methods["search"],
            "seen": round(metrics.coverage["ground"], 4),
            "energy_wh": None if metrics.energy_wh is None else round(metrics.energy_wh, 2),
            "usable_wh": None if usable_wh is None else round(usable_wh, 2),
            "home": kept,
            "violations": [violation.constraint for violation in plan.violations],
            "cpu_s": round(time.process_time() - began, 2),
        }
    yield {"bench": "search", "case": "random", "searches": count, "home": home}


def _mixed(count: int, seed: int) -> Iterator[dict[str, Any]]:
    """Random searches of every kind, planned whole, judged, and their energy reckoned anew."""
    home = 0
    for number in range(seed, seed + count):
        document, rasters = mixed_search(number)
        began = time.process_time()
        row: dict[str, Any] = {"bench": "search", "case": document["name"]}
        try:
            plan = make_plan(read_valid(document, rasters))
        except PlannerError as error:
            yield row | {"refused": str(error)}
            continue
        flights = list(flights_of(document, write_plan(plan)))
        kept = not plan.hard_violations and all(
            said_wh <= usable_wh and (reckoned_wh is None or reckoned_wh <= usable_wh)
            for _, usable_wh, said_wh, reckoned_wh in flights
        )
        home += kept
        yield row | {
            "aircraft": len(document["vehicles"]),
            "flights": len(flights),
            "used": round(max(said_wh / usable_wh for _, usable_wh, said_wh, _ in flights), 4),
            "off": round(
                max((abs(each / said_wh - 1.0) for _, _, said_wh, each in flights if each), default=0.0), 5
            ),
            "home": kept,
            "violations": [violation.constraint for violation in plan.violations],
            "cpu_s": round(time.process_time() - began, 2),
        }
    yield {"bench": "search", "case": "mixed", "searches": count, "home": home}
