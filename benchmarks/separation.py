"""Whether aircraft of one plan ever come nearer than is to be kept: random fleets, planned and judged.

A line a fleet: the least distance of any two while they are nearer in height than is kept, what is kept, what
the judge found, how long planning took. The last line counts them. With ``band`` the planner chooses heights:
the same fleet is planned without a band as well, and when the last is down is told of both.
"""

from __future__ import annotations

import itertools
import time
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from benchmarks.fleets import fleet_scenario
from planner.check.fleet import nearest, trace_of
from planner.errors import InfeasibleError
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.plan import Plan
from planner.scenario import Scenario
from planner.wishes import Separation

#: How near flights come is looked for up to so many times the distance that is kept.
FAR = 20.0


def least_m(scenario: Scenario, plan: Plan) -> float | None:
    """The least horizontal distance of any two within the height that is kept; None where none is near."""
    kept = scenario.kept_apart
    far = Separation(FAR * kept.horizontal_m, kept.vertical_m)
    traces = [trace_of(scenario, plan, path) for path in plan.paths]
    found = [nearest(one.rows, other.rows, far) for one, other in itertools.combinations(traces, 2)]
    return min((far.horizontal_m - short[0] for short in found if short is not None), default=None)


def row_of(seed: int, band: bool = False) -> dict[str, Any]:
    """One fleet, planned and judged."""
    scenario = read_scenario(fleet_scenario(seed, band))
    row: dict[str, Any] = {
        "bench": "separation",
        "seed": seed,
        "aircraft": len(scenario.aircraft),
        "regions": len(scenario.regions),
        "kept_m": scenario.kept_apart.horizontal_m,
        "kept_up_m": scenario.kept_apart.vertical_m,
    }
    begun_s = time.perf_counter()
    try:
        plan = make_plan(scenario)
    except InfeasibleError as error:
        return row | {
            "flights": 0,
            "least_m": None,
            "violations": [f"infeasible: {error}"],
            "planning_s": None,
        }
    took_s = round(time.perf_counter() - begun_s, 2)
    made = [plan]
    if band:
        made.append(make_plan(replace(scenario, band=None)))
        row |= {"last_landing_s": last_landing_s(plan), "without_heights_s": last_landing_s(made[1])}
    found = [near_m for each in made if (near_m := least_m(scenario, each)) is not None]
    return row | {
        "flights": len(plan.paths),
        "least_m": round(min(found), 2) if found else None,
        "violations": sorted({v.constraint for each in made for v in each.violations if v.hard}),
        "planning_s": took_s,
    }


def last_landing_s(plan: Plan) -> float:
    """When the last is down."""
    return round(max(path.end_s for path in plan.paths), 1)


def run(plans: int = 500, seed: int = 0, band: bool = False) -> Iterator[dict[str, Any]]:
    """So many random fleets from a seed on; with a band, where the planner chooses their heights."""
    rows = []
    for number in range(seed, seed + plans):
        rows.append(row_of(number, band))
        yield rows[-1]
    planned = [row for row in rows if row["planning_s"] is not None]
    times_s = sorted(row["planning_s"] for row in planned)
    flown = [row for row in planned if row["least_m"] is not None]
    sooner = [1.0 - row["last_landing_s"] / row["without_heights_s"] for row in planned] if band else []
    heights = {
        "sooner_by_heights": sum(part > 0.0 for part in sooner),
        "later_by_heights": sum(part < 0.0 for part in sooner),
        "mean_part_sooner": sum(sooner) / max(len(sooner), 1),
        "most_part_sooner": max(sooner, default=0.0),
    }
    yield {
        "bench": "separation-total",
        "plans": len(planned),
        "infeasible": len(rows) - len(planned),
        "too_near": sum("separation" in row["violations"] for row in planned),
        "other_violations": sum(bool(set(row["violations"]) - {"separation"}) for row in planned),
        "least_part_of_kept": min((row["least_m"] / row["kept_m"] for row in flown), default=None),
        "median_planning_s": times_s[len(times_s) // 2] if times_s else None,
    } | (heights if band else {})
