"""The four shared cases: our planners, the paper's own stages and the zigzags, beside the paper's figures.

Rows of ``bench: sar`` are Table 5 of Li, Chen, Wang, Li (2018): route length RL, collection length CL, duty
cycle DC. The paper's UAV flies level from start to end, so RL is the line over the ground, without the turns
flown for height, and DC is CL in it. Rows of ``bench: sar-subroute`` have the shape of its Table 7: cost and
time of SSAS for the first and the fourth sub-route of case 1. Lengths are of flyable lines for our planners
and the paper's stages, of straight corners for the zigzags, as in the paper.
"""

from __future__ import annotations

import json
import statistics
import time
from collections.abc import Iterator
from importlib import resources
from pathlib import Path
from typing import Any

from planner.airspace.zones import TRANSIT_MARGIN_M, keep_out
from planner.check import judge
from planner.coverage.strips.zigzag import zigzag
from planner.geojson import read_scenario
from planner.pipeline import make_plan, with_bound
from planner.plan import Plan
from planner.progress import never, silent
from planner.route import Anchor
from planner.routing.greedy.route import li2018_route
from planner.scenario import Scenario
from planner.sensors.sar import SarSensor
from planner.tasks.collect import paper_choices
from planner.tasks.setting import Setting, seeing
from planner.transit import ssas_connector
from planner.transit.tangent import forget_searches
from planner.warm import warm_up

#: Table 5: RL and CL in metres, DC in percent.
PAPER_TABLE_5 = {
    "ours": {
        1: (31523.5, 6206.2, 19.69),
        2: (27172.0, 6058.6, 22.30),
        3: (28486.0, 6546.6, 22.98),
        4: (33372.1, 6392.7, 19.16),
    },
    "vertical": {
        1: (51084.7, 7879.1, 15.42),
        2: (56896.8, 7879.1, 13.85),
        3: (57059.8, 7879.1, 13.81),
        4: (53488.5, 7879.1, 14.73),
    },
    "horizontal": {
        1: (47319.4, 7803.4, 16.49),
        2: (41444.2, 8008.9, 19.32),
        3: (41942.5, 8149.5, 19.43),
        4: (46505.0, 8008.9, 17.22),
    },
}

#: Table 7, SSAS rows: cost and seconds.
PAPER_TABLE_7 = {1: (1.0474, 1.5076), 4: (1.5892, 5.6617)}

#: Table 4: seconds for one whole plan.
PAPER_TABLE_4_S = {1: 72.825, 2: 53.548, 3: 49.646, 4: 148.619}

METHODS: dict[str, dict[str, str]] = {
    "li2018": {"coverage": "li2018", "routing": "li2018", "transit": "ssas"},
    "auto": {},
}


def scenario_document(case: int) -> dict[str, Any]:
    """One of the shared cases, from ``examples/`` or from the installed package."""
    name = f"sar-case-{case}.geojson"
    beside = Path(__file__).parent.parent / "examples" / name
    text = beside.read_text() if beside.exists() else (resources.files("benchmarks") / name).read_text()
    document: dict[str, Any] = json.loads(text)
    return document


def run(cases: tuple[int, ...] = (1, 2, 3, 4), repeats: int = 5) -> Iterator[dict[str, Any]]:
    """Rows, one a case and planner; planning times are medians of ``repeats`` warm runs."""
    warm_up()
    for case in cases:
        document = scenario_document(case)
        rows = {name: _plan_row(case, name, document | {"method": m}, repeats) for name, m in METHODS.items()}
        zigzags = {d: _zigzag_row(case, d, read_scenario(document)) for d in ("vertical", "horizontal")}
        for row in rows.values():
            for direction, other in zigzags.items():
                row[f"shorter_than_{direction}"] = 1.0 - row["rl_m"] / other["rl_m"]
            row["length_ratio_to_li2018"] = row["rl_m"] / rows["li2018"]["rl_m"]
        yield from rows.values()
        yield from zigzags.values()
    yield from _subroutes(max(repeats, 5))


def _plan_row(case: int, name: str, document: dict[str, Any], repeats: int) -> dict[str, Any]:
    scenario = read_scenario(document)
    seconds = []
    for _ in range(repeats):
        forget_searches()
        began = time.perf_counter()
        plan = make_plan(scenario)
        seconds.append(time.perf_counter() - began)
    plan = with_bound(scenario, plan, clock=time.perf_counter)
    verdict = judge(scenario, plan)
    route_m, flight_m = plan.metrics.route_length_m, plan.metrics.flight_length_m
    assert route_m is not None
    assert flight_m is not None
    rl_m, cl_m, dc = PAPER_TABLE_5["ours"][case]
    return {
        "bench": "sar",
        "case": case,
        "planner": name,
        "rl_m": route_m,
        "lower_bound_m": plan.metrics.lower_bound_m,
        "gap": plan.metrics.gap,
        "cl_m": plan.metrics.collection_length_m,
        "dc_percent": 100.0 * plan.metrics.collection_length_m / route_m,
        "risk_missile": plan.metrics.risk_missile,
        "risk_radar": plan.metrics.risk_radar,
        "metres_in_threats": _metres_in_threats(plan),
        "least_coverage": min(plan.metrics.coverage.values()),
        "min_turn_radius_m": verdict.min_turn_radius_m,
        "checker_length_ratio": verdict.length_m / flight_m,
        "hard_violations": len(plan.hard_violations),
        "planning_s": statistics.median(seconds),
        "bound_s": plan.metrics.planning_time_s["bound"],
        "paper_rl_m": rl_m,
        "paper_cl_m": cl_m,
        "paper_dc_percent": dc,
        "paper_planning_s": PAPER_TABLE_4_S[case],
    }


def _metres_in_threats(plan: Plan) -> float:
    return sum(v.amount for v in plan.violations if v.constraint in ("soft-threat", "hard-zone"))


def _zigzag_row(case: int, direction: Any, scenario: Scenario) -> dict[str, Any]:
    areas = [region.area for region in scenario.regions]
    (sensor,) = scenario.sensors
    assert isinstance(sensor, SarSensor)
    found = zigzag(areas, sensor, scenario.height_m, (scenario.start, scenario.end), direction)
    rl_m, cl_m, dc = PAPER_TABLE_5[direction][case]
    return {
        "bench": "sar",
        "case": case,
        "planner": f"zigzag-{direction}",
        "rl_m": found.length_m,
        "cl_m": found.collection_length_m,
        "dc_percent": 100.0 * found.duty_cycle,
        "turns": found.turns,
        "paper_rl_m": rl_m,
        "paper_cl_m": cl_m,
        "paper_dc_percent": dc,
    }


def _subroutes(repeats: int) -> Iterator[dict[str, Any]]:
    scenario = read_scenario(scenario_document(1))
    setting = Setting.of(scenario)
    choices = paper_choices(seeing(scenario, setting), silent, never, threat_aware=False).choices
    where = (scenario.threats, scenario.objective, setting.ends, scenario.seed)
    passes = li2018_route(choices, *where)[0].passes
    starts = [Anchor(*scenario.start.position), *(Anchor(*p.end, p.angle_rad) for p in passes)]
    goals = [*(Anchor(*p.start, p.angle_rad) for p in passes), Anchor(*scenario.end.position)]
    asked: dict[str, Any] = {
        "threats": scenario.threats,
        "objective": scenario.objective,
        "height_m": scenario.height_m,
        "keep_out": keep_out(scenario.airspace, scenario.level, TRANSIT_MARGIN_M),
        "radius_m": setting.model.turn_radius_m,
    }
    for number, (start, goal) in enumerate(zip(starts, goals, strict=True), start=1):
        seconds = []
        for _ in range(repeats):
            began = time.perf_counter()
            path, found = ssas_connector.connect(start, goal, **asked)
            seconds.append(time.perf_counter() - began)
        paper = PAPER_TABLE_7.get(number)
        yield {
            "bench": "sar-subroute",
            "case": 1,
            "subroute": number,
            "cost": found.cost,
            "nodes": found.nodes,
            "flyable_m": path.length_m,
            "runtime_s": statistics.median(seconds),
            "runtime_max_s": max(seconds),
            "paper_cost": None if paper is None else paper[0],
            "paper_runtime_s": None if paper is None else paper[1],
        }


if __name__ == "__main__":
    for row in run():
        print(json.dumps(row))
