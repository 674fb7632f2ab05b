"""The judge: every check over every path, and the verdict."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from shapely.geometry import MultiPolygon, Polygon

from planner.check.clearance import begun_violations, clearance_violations, place_violations
from planner.check.continuity import collect_violations, terminal_violations
from planner.check.coverage import covered
from planner.check.energy import line_wh
from planner.check.fleet import fleet_violations, window_violations
from planner.check.followed import ceiling_violations, followed_violations
from planner.check.footprint_quality import footprint_violations
from planner.check.heights import (
    altitude_violations,
    ground_violations,
    level_violations,
    phase_violations,
    slope_violations,
    transit_violations,
)
from planner.check.kinematics import (
    LENGTH_TOLERANCE,
    duration_violations,
    limit_violations,
    turn_radius_m,
    turn_violations,
)
from planner.check.photo_quality import surveyed
from planner.check.searched import Found, searched
from planner.check.stretches import Measured
from planner.check.times import line_s, speeds_told
from planner.plan import FlownPath, Plan, Surveyed, Violation
from planner.route import Terminal
from planner.scenario import Scenario
from planner.vehicle.aircraft import Aircraft


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
    surveys
        What photos give of each region that a camera sees.
    area_seen_m2, importance_collected, importance_total
        Of a search: the ground seen, and what it and all that is asked are worth where that is given.
    """

    violations: tuple[Violation, ...]
    length_m: float
    min_turn_radius_m: float
    coverage: dict[str, float]
    unseen: dict[str, Polygon | MultiPolygon]
    surveys: dict[str, Surveyed]
    area_seen_m2: float | None = None
    importance_collected: float | None = None
    importance_total: float | None = None


def judge(scenario: Scenario, plan: Plan) -> Verdict:
    """Judge a plan against the scenario it answers; see :class:`Verdict`."""
    violations: list[Violation] = []
    lengths_m: list[float] = []
    tightest_m = math.inf
    # Zones, threats and obstacles count from the scenario's home, whichever an aircraft takes off from.
    home_ground_m = scenario.level.altitude_m - scenario.level.height_m
    # Each flight by itself first, as its own aircraft was asked.
    asked, published = scenario, plan
    for flown in published.paths:
        aircraft = next(a for a in asked.aircraft if a.name == flown.vehicle)
        before = [p for p in published.paths if (p.vehicle, p.sortie) == (flown.vehicle, flown.sortie - 1)]
        scenario = _asked_of(asked, aircraft, flown, before[0] if before else None)
        plan = published.of(flown.vehicle, flown.sortie)
        (path,), aircraft = plan.paths, aircraft.in_wind(asked.wind.speed_m_s)
        vehicle = next(v for v in plan.vehicles if v.name == path.vehicle)
        line_m = scenario.frame.to_local([place[:2] for place in path.line])
        altitudes_m = np.array([place[2] for place in path.line])
        over_m = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line_m, axis=0).T))])
        reached_m = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(over_m), np.diff(altitudes_m)))])
        lengths_m.append(float(reached_m[-1]))
        radius_m, where = turn_radius_m(line_m)
        tightest_m = min(tightest_m, radius_m)
        datum_amsl_m = scenario.level.amsl_m - scenario.level.altitude_m
        told_m_s = speeds_told(plan.collects, path, line_m, altitudes_m)
        time_s = line_s(line_m, altitudes_m, aircraft, scenario.wind, datum_amsl_m, told_m_s)
        hovers = vehicle.type == "multirotor"
        circling = (vehicle.name,) if vehicle.finish != "land" and not hovers else ()
        returning = (vehicle.name,) if vehicle.finish == "return" and hovers else ()
        violations += turn_violations(scenario, aircraft, path, radius_m, where)
        violations += place_violations(asked, path, line_m, altitudes_m - home_ground_m)
        violations += clearance_violations(scenario, plan, path, line_m)
        violations += slope_violations(path, vehicle, line_m, altitudes_m)
        violations += ground_violations(path, vehicle, altitudes_m, _begins_m(scenario, home_ground_m))
        violations += level_violations(scenario, plan.collects_of(vehicle.name))
        violations += altitude_violations(scenario, plan.collects_of(vehicle.name))
        own = plan.collects_of(vehicle.name)
        violations += transit_violations(scenario, path, own, line_m, altitudes_m)
        violations += phase_violations(path)
        violations += terminal_violations(
            scenario, path, line_m, aircraft.ground_turn_radius_m, circling, returning
        )
        violations += duration_violations(path, time_s, hovers=hovers)
        # What hovers takes as long as its autopilot's corners make it: no less than its path says.
        whole_s = max(time_s, path.duration_s) if hovers else time_s
        energy_wh = line_wh(line_m, altitudes_m, aircraft, scenario.wind, datum_amsl_m, whole_s, told_m_s)
        violations += limit_violations(aircraft, path, lengths_m[-1], whole_s, energy_wh)
        over_ground_m = partial(np.interp, xp=reached_m, fp=over_m)
        measured = Measured(line_m)
        violations += collect_violations(
            scenario,
            plan,
            path,
            measured,
            over_ground_m,
            aircraft.settle_m,
            aircraft.ground_turn_radius_m,
        )
        violations += followed_violations(scenario, plan, path)
        violations += ceiling_violations(scenario, plan, path)
    scenario, plan = asked, published
    violations += begun_violations(scenario)
    violations += window_violations(scenario, plan)
    violations += fleet_violations(scenario, plan, scenario.kept_apart)
    coverage, unseen, missed = covered(scenario, plan)
    violations += missed
    found: Found | None = None
    surveys: dict[str, Surveyed] = {}
    if scenario.task == "search":
        # A search leaves ground unseen where it has to, and its lanes overlap as they come.
        violations = [violation for violation in violations if violation.constraint != "coverage"]
        found = searched(scenario, plan)
    else:
        surveys, short = surveyed(scenario, plan)
        violations += short
    violations += footprint_violations(scenario, plan)
    length_m = math.fsum(lengths_m)
    mission_m = math.fsum(
        phase.end_m - phase.start_m for path in plan.paths for phase in path.phases if phase.kind == "mission"
    )
    for said_m, measured_m, what in (
        (plan.metrics.flight_length_m, length_m, "the flight"),
        (plan.metrics.length_m, mission_m, "the mission"),
    ):
        off_m = math.inf if said_m is None else abs(measured_m - said_m)
        if off_m > LENGTH_TOLERANCE * max(measured_m, 1.0):
            message = f"metrics say {said_m} m of {what}, the line measures {measured_m:.1f} m"
            violations.append(Violation("length", "metrics", message, off_m, "m"))
    seen = (None, None, None) if found is None else (found.area_m2, found.importance, found.total)
    return Verdict(tuple(violations), length_m, tightest_m, coverage, unseen, surveys, *seen)


def _asked_of(asked: Scenario, aircraft: Aircraft, flown: FlownPath, before: FlownPath | None) -> Scenario:
    """What an aircraft was asked, had it been to land at the one of its landings where it came down.

    A further flight starts where the one before has landed.
    """
    landings = asked.landings_of(aircraft)

    def landed(path: FlownPath) -> Terminal:
        place_m = asked.frame.to_local([path.line[-1][:2]])[0]
        return min(landings, key=lambda end: math.dist(end.position, place_m))

    moved = before is not None and landed(before).position != asked.ends_of(aircraft)[0].position
    if aircraft.end_bases is None and not moved:
        return asked.of_one(aircraft)
    alone = asked.landing_at(aircraft, landed(flown))
    if before is None or not moved:
        return alone
    start = landed(before)
    return replace(alone, start=start).home_from(start)


def _begins_m(scenario: Scenario, home_ground_m: float) -> tuple[float, float]:
    """Altitudes that the path begins and ends at: of the ground, or of an aircraft that is in the air."""
    first_m, last_m = _grounds_m(scenario, home_ground_m)
    return first_m + (scenario.start.over_home_m or 0.0), last_m


def _grounds_m(scenario: Scenario, home_ground_m: float) -> tuple[float, float]:
    """Altitude of the ground where it took off and where it ends over the plan's datum.

    Home's where there is no terrain.
    """
    if scenario.terrain is None:
        return home_ground_m, home_ground_m
    ends_m = scenario.terrain.at(np.array([scenario.start.ground, scenario.end.position]))
    datum_amsl_m = scenario.level.amsl_m - scenario.level.altitude_m
    first_m, last_m = np.where(np.isnan(ends_m), home_ground_m, ends_m - datum_amsl_m).tolist()
    return first_m, last_m
