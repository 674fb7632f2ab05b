"""What a plan costs: lengths, risks, turns, time, energy."""

from __future__ import annotations

import math

from planner.airspace.threats import curve_risk
from planner.dubins.path import Path
from planner.plan import Metrics
from planner.route import CollectPass
from planner.scenario import Scenario
from planner.vehicle.aircraft import Aircraft
from planner.vehicle.limits import Use
from planner.vehicle.wind import duration_s

#: Distance between dividing points when risk is summed along the line (section 5.2, Li et al. 2018).
DIVIDING_M = 100.0
#: Arcs that turn less than this are no turns.
MIN_TURN_RAD = math.radians(1.0)


def measure(
    scenario: Scenario,
    aircraft: Aircraft,
    path: Path,
    passes: tuple[CollectPass, ...],
    coverage: dict[str, float],
    planning_time_s: dict[str, float],
) -> Metrics:
    """Measure the path of one aircraft.

    The path length ratio is eq 10, the risks are eqs 12 and 14 of Li et al. (2018) with dividing points every
    100 m along the flown line, the duty cycle is the fraction of the line with the sensor on. The duration
    and the energy are those in the scenario's wind.
    """
    length_m = path.length_m
    collection_m = math.fsum(collect.length_m for collect in passes)
    direct_m = math.dist(scenario.start.position, scenario.end.position)
    missile, radar = curve_risk(path.sample(5.0)[:, :2], scenario.threats, DIVIDING_M, scenario.height_m)
    flown_s = duration_s(path, aircraft.airspeed_m_s, scenario.wind)
    return Metrics(
        length_m=length_m,
        collection_length_m=collection_m,
        duty_cycle=collection_m / length_m,
        path_length_ratio=length_m / direct_m if direct_m > 0.0 else None,
        risk_missile=missile,
        risk_radar=radar,
        turns=turns(path),
        duration_s=flown_s,
        energy_wh=energy_wh(aircraft, flown_s),
        coverage=coverage,
        planning_time_s=planning_time_s,
    )


def used(scenario: Scenario, aircraft: Aircraft, path: Path) -> Use:
    """What of its range, time and energy an aircraft uses for a path, in the scenario's wind."""
    flown_s = duration_s(path, aircraft.airspeed_m_s, scenario.wind)
    return Use(path.length_m, flown_s, energy_wh(aircraft, flown_s))


def turns(path: Path) -> int:
    """Number of turns: arcs that follow each other to the same side are one."""
    count = 0
    side, turned_rad = "straight", 0.0
    for segment in path.segments:
        if segment.kind != side:
            count += abs(turned_rad) >= MIN_TURN_RAD
            side, turned_rad = segment.kind, 0.0
        turned_rad += segment.turn_rad
    return count + (abs(turned_rad) >= MIN_TURN_RAD)


def energy_wh(aircraft: Aircraft, duration_s: float) -> float | None:
    """Energy for a time in cruise; None without a power model."""
    return None if aircraft.cruise_power_w is None else aircraft.cruise_power_w * duration_s / 3600.0
