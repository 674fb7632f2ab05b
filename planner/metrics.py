"""What a plan costs: lengths, risks, turns, time, energy."""

from __future__ import annotations

import math

from planner.airspace.airspace import Airspace, Level
from planner.airspace.threats import curve_risk
from planner.dubins.path import MIN_TURN_RAD, Path
from planner.plan import Metrics
from planner.route import CollectPass
from planner.vehicle.limits import Use
from planner.vehicle.model import FlightModel

#: Distance between dividing points when risk is summed along the line (section 5.2, Li et al. 2018).
DIVIDING_M = 100.0


def measure(
    path: Path,
    passes: tuple[CollectPass, ...],
    model: FlightModel,
    airspace: Airspace,
    level: Level,
    direct_m: float,
) -> Metrics:
    """Measure the path of one aircraft; the judge adds what is covered, the caller what planning took.

    The path length ratio is eq 10, the risks are eqs 12 and 14 of Li et al. (2018) with dividing points every
    100 m along the flown line, the duty cycle is the fraction of the line with the sensor on. The duration
    and the energy are those in the model's wind.

    Parameters
    ----------
    direct_m
        From the start to the end.
    """
    length_m = path.length_m
    collection_m = math.fsum(collect.length_m for collect in passes)
    missile, radar = curve_risk(path.sample(5.0)[:, :2], airspace.threats, DIVIDING_M, level.height_m)
    flown_s = model.duration_s(path)
    return Metrics(
        length_m=length_m,
        collection_length_m=collection_m,
        duty_cycle=collection_m / length_m,
        path_length_ratio=length_m / direct_m if direct_m > 0.0 else None,
        risk_missile=missile,
        risk_radar=radar,
        turns=turns(path),
        duration_s=flown_s,
        energy_wh=model.energy_wh(flown_s),
        coverage={},
        planning_time_s={},
    )


def used(path: Path, model: FlightModel) -> Use:
    """What of its range, time and energy an aircraft uses for a path, in the wind of the model."""
    flown_s = model.duration_s(path)
    return Use(path.length_m, flown_s, model.energy_wh(flown_s))


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
