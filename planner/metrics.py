"""What a plan costs: lengths, risks, turns, time, energy."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from planner.airspace.airspace import Airspace, Level
from planner.airspace.threats import curve_risk
from planner.airspace.values import Threat
from planner.dubins.path import MIN_TURN_RAD, Path
from planner.plan import Metrics
from planner.profile.energy import flight_wh
from planner.profile.flight import Flight
from planner.profile.lines import cut
from planner.route import CollectPass
from planner.vehicle.limits import Use
from planner.vehicle.model import FlightModel

Floats = NDArray[np.float64]

#: Distance between dividing points when risk is summed along the line (section 5.2, Li et al. 2018).
DIVIDING_M = 100.0
#: Points of a curve are this far apart.
SAMPLE_M = 5.0


def measure(
    flight: Flight,
    passes: tuple[CollectPass, ...],
    model: FlightModel,
    airspace: Airspace,
    level: Level,
    direct_m: float,
) -> Metrics:
    """Measure the flight of one aircraft; the judge adds what is covered, the caller what planning took.

    Length, duration, duty cycle (its fraction with the sensor on), turns and the path length ratio (eq 10 of
    Li et al. 2018) are those of the mission phase; the risks (eqs 12 and 14, with dividing points every
    100 m), the flight's length and duration and the energy those of all phases, in the model's wind.

    Parameters
    ----------
    direct_m
        From the start to the end.
    """
    from_m, until_m = flight.mission_m
    path = cut(flight.path, from_m, until_m)
    (start_m, start_s), (end_m, end_s) = flight.along(from_m), flight.along(until_m)
    length_m = end_m - start_m
    collection_m = math.fsum(collect.length_m for collect in passes)
    missile, radar = risks(flight, 0.0, flight.path.length_m, airspace.threats, level)
    return Metrics(
        length_m=length_m,
        collection_length_m=collection_m,
        duty_cycle=collection_m / length_m,
        path_length_ratio=length_m / direct_m if direct_m > 0.0 else None,
        risk_missile=missile,
        risk_radar=radar,
        turns=turns(path),
        duration_s=end_s - start_s,
        energy_wh=flight_wh(flight, model, level.amsl_m - level.altitude_m),
        coverage={},
        planning_time_s={},
        flight_length_m=flight.length_m,
        flight_duration_s=flight.duration_s,
        route_length_m=flight.path.length_m - flight.inserted_m,
    )


def risks(
    flight: Flight, from_m: float, until_m: float, threats: Sequence[Threat], level: Level
) -> tuple[float, float]:
    """Risk of kill and of detection between two distances over the ground.

    A threat that ends at some height counts where the line is not above it.
    """
    sampled = cut(flight.path, from_m, until_m).sample(SAMPLE_M)
    over_home_m = flight.heights.at(from_m + sampled[:, 3]) - (level.altitude_m - level.height_m)
    return risks_along(sampled[:, :2], over_home_m, threats)


def risks_along(points: Floats, over_home_m: Floats, threats: Sequence[Threat]) -> tuple[float, float]:
    """The same of a densely sampled curve, by its heights over home."""
    missile, radar = curve_risk(points, threats, DIVIDING_M, float(over_home_m.max()))
    for threat in threats:
        if not over_home_m.min() <= threat.height_m < over_home_m.max():
            continue
        under = np.flatnonzero(over_home_m <= threat.height_m)
        for run in np.split(under, np.flatnonzero(np.diff(under) > 1) + 1):
            more_missile, more_radar = curve_risk(points[run], [threat], DIVIDING_M)
            missile, radar = missile + more_missile, radar + more_radar
    return missile, radar


def used(flight: Flight, model: FlightModel, level: Level) -> Use:
    """What of its range, time and energy an aircraft uses for a flight, all phases together."""
    energy_wh = flight_wh(flight, model, level.amsl_m - level.altitude_m)
    return Use(flight.length_m, flight.duration_s, energy_wh)


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
