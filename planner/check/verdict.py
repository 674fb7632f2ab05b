"""The judge: every check over every path, and the verdict."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from shapely.geometry import LineString, MultiPolygon, Polygon

from planner.check.clearance import clearance_violations, place_violations
from planner.check.continuity import collect_violations, terminal_violations
from planner.check.coverage import covered
from planner.check.kinematics import (
    LENGTH_TOLERANCE,
    duration_violations,
    flown_s,
    limit_violations,
    turn_radius_m,
    turn_violations,
)
from planner.plan import Plan, Violation
from planner.scenario import Scenario


@dataclass(frozen=True, slots=True)
class Verdict:
    """What the judge measured.

    Parameters
    ----------
    violations
        Empty for a sound plan.
    length_m
        Of all paths, along their vertices.
    min_turn_radius_m
        Tightest turn found, inf without any.
    coverage
        Fraction of each region inside the footprints, as often as it is to be visited.
    unseen
        What is left of each region that is not covered whole, in the local frame.
    """

    violations: tuple[Violation, ...]
    length_m: float
    min_turn_radius_m: float
    coverage: dict[str, float]
    unseen: dict[str, Polygon | MultiPolygon]


def judge(scenario: Scenario, plan: Plan) -> Verdict:
    """Judge a plan against the scenario it answers; see :class:`Verdict`."""
    violations: list[Violation] = []
    lengths_m: list[float] = []
    tightest_m = math.inf
    for path in plan.paths:
        aircraft = next(a for a in scenario.aircraft if a.name == path.vehicle).in_wind(
            scenario.wind.speed_m_s
        )
        line_m = scenario.frame.to_local([place[:2] for place in path.line])
        line = LineString(line_m)
        lengths_m.append(float(np.hypot(*np.diff(line_m, axis=0).T).sum()))
        radius_m, where = turn_radius_m(line_m)
        tightest_m = min(tightest_m, radius_m)
        time_s = flown_s(line_m, aircraft.airspeed_m_s, scenario.wind)
        violations += turn_violations(scenario, aircraft, path, radius_m, where)
        violations += place_violations(scenario, path, line)
        violations += clearance_violations(scenario, plan, path, line_m)
        violations += terminal_violations(scenario, path, line_m, aircraft.ground_turn_radius_m)
        violations += duration_violations(path, time_s)
        violations += limit_violations(aircraft, path, lengths_m[-1], time_s)
        violations += collect_violations(scenario, plan, path, line, aircraft.settle_m)
    coverage, unseen, missed = covered(scenario, plan)
    violations += missed
    length_m = math.fsum(lengths_m)
    if abs(length_m - plan.metrics.length_m) > LENGTH_TOLERANCE * max(length_m, 1.0):
        violations.append(
            Violation(
                "length",
                "metrics",
                f"metrics say {plan.metrics.length_m:.1f} m, the line measures {length_m:.1f} m",
                abs(length_m - plan.metrics.length_m),
                "m",
            )
        )
    return Verdict(tuple(violations), length_m, tightest_m, coverage, unseen)
