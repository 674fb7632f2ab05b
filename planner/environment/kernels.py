"""Compiled risk sums and disc lengths: plain arrays in, numbers out.

Arrays: ``missiles`` float64 (K, 3): east_m, north_m, radius_m; ``radars`` float64 (M, 4): the same and
intensity_m; ``points`` float64 (N, 2): east_m, north_m.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: The range of eq 13 is not let under this: its pole at distance 0 would make a sum infinite.
MIN_RADAR_RANGE_M = 1.0
#: A dividing point nearer than this part of the spacing to the next waypoint is that waypoint.
DIVISION_SLACK = 1e-6


@njit(cache=True)
def kill_risk(distance_m: float, radius_m: float, reach_m: float) -> float:
    """Eq 11 with the range test made at ``reach_m`` (``radius_m`` in the paper)."""
    if distance_m > reach_m or radius_m <= 0.0:
        return 0.0
    ratio = (distance_m / radius_m) ** 4
    return 1.0 / (1.0 + ratio)


@njit(cache=True)
def detection_risk(distance_m: float, intensity_m: float, reach_m: float) -> float:
    """Eq 13 with the range test made at ``reach_m``, its pole cut off at ``MIN_RADAR_RANGE_M``."""
    if distance_m > reach_m:
        return 0.0
    return (intensity_m / max(distance_m, MIN_RADAR_RANGE_M)) ** 4


@njit(cache=True)
def point_risk(
    east_m: float, north_m: float, missiles: Array, radars: Array, margin_m: float
) -> tuple[float, float]:
    """Risk of kill and risk of detection at one point, summed over the threats.

    ``margin_m`` widens the range tests of eqs 11 and 13; the formulas keep their radii.
    """
    kill = 0.0
    for k in range(missiles.shape[0]):
        distance_m = math.hypot(east_m - missiles[k, 0], north_m - missiles[k, 1])
        kill += kill_risk(distance_m, missiles[k, 2], missiles[k, 2] + margin_m)
    detection = 0.0
    for k in range(radars.shape[0]):
        distance_m = math.hypot(east_m - radars[k, 0], north_m - radars[k, 1])
        detection += detection_risk(distance_m, radars[k, 3], radars[k, 2] + margin_m)
    return kill, detection


@njit(cache=True)
def dividing_points(length_m: float, spacing_m: float) -> int:
    """How many dividing points, each ``spacing_m`` from the first waypoint on, lie inside a leg."""
    return max(0, math.ceil(length_m / spacing_m - DIVISION_SLACK) - 1)


@njit(cache=True)
def leg_risk(
    east0_m: float,
    north0_m: float,
    east1_m: float,
    north1_m: float,
    missiles: Array,
    radars: Array,
    spacing_m: float,
    margin_m: float,
) -> tuple[float, float]:
    """Risks at the dividing points of one leg, its ends left out (inner sums of eqs 12 and 14)."""
    length_m = math.hypot(east1_m - east0_m, north1_m - north0_m)
    kill = 0.0
    detection = 0.0
    for j in range(1, dividing_points(length_m, spacing_m) + 1):
        part = j * spacing_m / length_m
        rk, rd = point_risk(
            east0_m + part * (east1_m - east0_m),
            north0_m + part * (north1_m - north0_m),
            missiles,
            radars,
            margin_m,
        )
        kill += rk
        detection += rd
    return kill, detection


@njit(cache=True)
def line_risk(points: Array, missiles: Array, radars: Array, spacing_m: float) -> tuple[float, float]:
    """Eqs 12 and 14 of a polyline: waypoints, and dividing points every ``spacing_m`` between them."""
    kill = 0.0
    detection = 0.0
    for i in range(points.shape[0]):
        rk, rd = point_risk(points[i, 0], points[i, 1], missiles, radars, 0.0)
        kill += rk
        detection += rd
        if i + 1 < points.shape[0]:
            rk, rd = leg_risk(
                points[i, 0],
                points[i, 1],
                points[i + 1, 0],
                points[i + 1, 1],
                missiles,
                radars,
                spacing_m,
                0.0,
            )
            kill += rk
            detection += rd
    return kill, detection


@njit(cache=True)
def curve_risk(points: Array, missiles: Array, radars: Array, spacing_m: float) -> tuple[float, float]:
    """Risks at points every ``spacing_m`` along a polyline and at its end, wherever its vertices are."""
    kill, detection = point_risk(points[0, 0], points[0, 1], missiles, radars, 0.0)
    due_m = spacing_m
    travelled_m = 0.0
    for i in range(points.shape[0] - 1):
        delta_e = points[i + 1, 0] - points[i, 0]
        delta_n = points[i + 1, 1] - points[i, 1]
        length_m = math.hypot(delta_e, delta_n)
        while due_m <= travelled_m + length_m and length_m > 0.0:
            part = (due_m - travelled_m) / length_m
            rk, rd = point_risk(
                points[i, 0] + part * delta_e, points[i, 1] + part * delta_n, missiles, radars, 0.0
            )
            kill += rk
            detection += rd
            due_m += spacing_m
        travelled_m += length_m
    if travelled_m - (due_m - spacing_m) > DIVISION_SLACK * spacing_m:
        last = points.shape[0] - 1
        rk, rd = point_risk(points[last, 0], points[last, 1], missiles, radars, 0.0)
        kill += rk
        detection += rd
    return kill, detection


@njit(cache=True)
def length_in_discs(points: Array, discs: Array) -> float:
    """Length of a polyline inside the union of discs (K, 3: east_m, north_m, radius_m)."""
    total_m = 0.0
    spans = np.empty((discs.shape[0], 2))
    for i in range(points.shape[0] - 1):
        delta_e = points[i + 1, 0] - points[i, 0]
        delta_n = points[i + 1, 1] - points[i, 1]
        length_m = math.hypot(delta_e, delta_n)
        if length_m == 0.0:
            continue
        count = 0
        for k in range(discs.shape[0]):
            to_e = discs[k, 0] - points[i, 0]
            to_n = discs[k, 1] - points[i, 1]
            foot_m = (to_e * delta_e + to_n * delta_n) / length_m
            aside_m = (to_e * delta_n - to_n * delta_e) / length_m
            if abs(aside_m) >= discs[k, 2]:
                continue
            half_m = math.sqrt(discs[k, 2] * discs[k, 2] - aside_m * aside_m)
            enter_m = max(0.0, foot_m - half_m)
            leave_m = min(length_m, foot_m + half_m)
            if leave_m > enter_m:
                # kept sorted by where each span begins, so that overlaps merge in one pass
                place = count
                while place > 0 and spans[place - 1, 0] > enter_m:
                    spans[place, 0] = spans[place - 1, 0]
                    spans[place, 1] = spans[place - 1, 1]
                    place -= 1
                spans[place, 0] = enter_m
                spans[place, 1] = leave_m
                count += 1
        reached_m = 0.0
        for j in range(count):
            begin_m = max(reached_m, spans[j, 0])
            if spans[j, 1] > begin_m:
                total_m += spans[j, 1] - begin_m
                reached_m = spans[j, 1]
    return total_m
