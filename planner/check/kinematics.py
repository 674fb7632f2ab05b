"""What the aircraft can fly: turns, times, and the limits of range, time and energy."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from planner.check.places import lonlat
from planner.plan import FlownPath, Violation
from planner.scenario import Scenario
from planner.vehicle.aircraft import Aircraft
from planner.vehicle.limits import raised

#: Arcs have vertices at most this far apart, so a longer edge is straight.
MAX_ARC_EDGE_M = 10.0
RADIUS_TOLERANCE = 1e-4
LENGTH_TOLERANCE = 1e-3
ROTOR_TIME_TOLERANCE = 2e-2
ROTOR_SLOWER = 4.0
#: Planning reckons by its pieces, the judge by vertices: by a thousandth or so another way.
SPARED = 1.003
#: What rounding to 11 decimals of a degree may move both ends of an edge against each other.
DIRECTION_NOISE_M = 2e-6


def turn_violations(
    scenario: Scenario, aircraft: Aircraft, path: FlownPath, radius_m: float, where: NDArray[np.float64]
) -> Iterator[Violation]:
    """The tightest turn of a path, where it is tighter than the aircraft may fly over the ground."""
    limit_m = aircraft.ground_turn_radius_m
    if radius_m < limit_m * (1.0 - RADIUS_TOLERANCE):
        yield Violation(
            "turn-radius",
            path.vehicle,
            f"a turn of {radius_m:.2f} m radius, the limit is {limit_m:g} m",
            limit_m - radius_m,
            "m",
            lonlat(scenario, where),
        )


def duration_violations(path: FlownPath, time_s: float, *, hovers: bool) -> Iterator[Violation]:
    """What a path says of its duration, against the time its line takes."""
    # What hovers is no faster than the line allows; how much slower is for its autopilot's corners to say.
    least_s = time_s - (ROTOR_TIME_TOLERANCE if hovers else LENGTH_TOLERANCE) * max(time_s, 1.0)
    most_s = time_s * (ROTOR_SLOWER if hovers else 1.0 + LENGTH_TOLERANCE) + LENGTH_TOLERANCE
    if not least_s <= path.duration_s <= most_s:
        yield Violation(
            "duration",
            path.vehicle,
            f"the path says {path.duration_s:.1f} s, its line takes {time_s:.1f} s",
            abs(time_s - path.duration_s),
            "s",
        )


def limit_violations(
    aircraft: Aircraft, path: FlownPath, length_m: float, time_s: float, energy_wh: float | None
) -> Iterator[Violation]:
    """Range, flight time and energy, where the path needs more than the aircraft has."""
    for constraint, used, limit, unit in (
        ("range", length_m, aircraft.max_range_m, "m"),
        ("flight-time", time_s, aircraft.max_flight_time_s, "s"),
        ("energy", energy_wh, aircraft.usable_wh, "Wh"),
    ):
        if used is not None and limit is not None and used > limit:
            yield Violation(
                constraint,
                path.vehicle,
                f"needs {used:.0f} {unit} but has {limit:.0f} {unit}. "
                f"{raised(aircraft, constraint, used * SPARED)}",
                used - limit,
                unit,
            )


def turn_radius_m(line_m: NDArray[np.float64]) -> tuple[float, NDArray[np.float64]]:
    """Tightest turn of a polyline whose arcs have vertices at most 10 m apart, and where it is.

    At each vertex the direction changes by δ over half of either edge; an edge counts for no more than an arc
    may have, so that a kink between two long straights is as tight as it looks.
    """
    edges = np.diff(line_m, axis=0)
    keep = np.hypot(edges[:, 0], edges[:, 1]) > 1e-6
    points = np.vstack([line_m[:1], line_m[1:][keep]])
    edges = np.diff(points, axis=0)
    if len(edges) < 2:
        return math.inf, points[0]
    lengths_m = np.minimum(np.hypot(edges[:, 0], edges[:, 1]), MAX_ARC_EDGE_M)
    directions = np.arctan2(edges[:, 1], edges[:, 0])
    delta = np.abs(np.mod(np.diff(directions) + np.pi, 2.0 * np.pi) - np.pi)
    # Directions of edges are known no better than the coordinates' last digit allows.
    noise = DIRECTION_NOISE_M / np.minimum(lengths_m[:-1], lengths_m[1:])
    with np.errstate(divide="ignore"):
        radii = (lengths_m[:-1] + lengths_m[1:]) / 4.0 / np.sin(np.maximum(delta - noise, 0.0) / 2.0)
    worst = int(np.argmin(radii))
    return float(radii[worst]), points[worst + 1]
