"""Compiled risk sums, disc lengths and leg tests: plain arrays in, numbers out.

Arrays: ``missiles`` float64 (K, 3): east_m, north_m, radius_m; ``radars`` float64 (M, 4): the same and
intensity_m; ``points`` float64 (N, 2): east_m, north_m.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from planner.jit import njit

Array = NDArray[np.float64]

#: The range of eq 13 is not let under this: its pole at distance 0 would make a sum infinite.
MIN_RADAR_RANGE_M = 1.0
#: A dividing point nearer than this part of the spacing to the next waypoint is that waypoint.
DIVISION_SLACK = 1e-6

# What ``leg_verdict`` says.
CLEAR = 0
OUTSIDE = 1
FORBIDDEN = 2


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
def _threat_at(threat: Array, distance_m: float, reach_m: float) -> float:
    if threat.shape[0] == 4:
        return detection_risk(distance_m, threat[3], reach_m)
    return kill_risk(distance_m, threat[2], reach_m)


@njit(cache=True)
def nearest_part(e0: float, n0: float, e1: float, n1: float, east: float, north: float) -> float:
    """Where on a leg, from 0 to 1, it comes nearest to a point."""
    delta_e = e1 - e0
    delta_n = n1 - n0
    square = delta_e * delta_e + delta_n * delta_n
    if square == 0.0:
        return 0.0
    return min(1.0, max(0.0, ((east - e0) * delta_e + (north - n0) * delta_n) / square))


@njit(cache=True)
def threat_on_leg(
    e0: float,
    n0: float,
    e1: float,
    n1: float,
    threat: Array,
    spacing_m: float,
    margin_m: float,
    clipping: bool,
    backwards: bool,
) -> float:
    """Risk one threat adds on a leg: its dividing points and its far end (terms of eqs 12 and 14).

    Parameters
    ----------
    threat
        A row of ``missiles`` (3 numbers) or of ``radars`` (4).
    margin_m
        Widens the range tests of eqs 11 and 13; the formulas keep their radii.
    clipping
        Let a disc crossed between two samples count the point nearest to its centre once.
    backwards
        Count dividing points from the far end: the leg will be flown the other way.
    """
    east, north = threat[0], threat[1]
    reach_m = threat[2] + margin_m
    part = nearest_part(e0, n0, e1, n1, east, north)
    nearest_m = math.hypot(e0 + part * (e1 - e0) - east, n0 + part * (n1 - n0) - north)
    if nearest_m > reach_m:
        return 0.0
    total = 0.0
    hit = math.hypot(e0 - east, n0 - north) <= reach_m
    length_m = math.hypot(e1 - e0, n1 - n0)
    count = dividing_points(length_m, spacing_m)
    for j in range(1, count + 2):
        at = 1.0 if j > count else j * spacing_m / length_m
        if backwards and j <= count:
            at = 1.0 - at
        distance_m = math.hypot(e0 + at * (e1 - e0) - east, n0 + at * (n1 - n0) - north)
        if distance_m <= reach_m:
            hit = True
            total += _threat_at(threat, distance_m, reach_m)
    if clipping and not hit:
        total += _threat_at(threat, nearest_m, reach_m)
    return total


@njit(cache=True)
def leg_risk(
    e0: float,
    n0: float,
    e1: float,
    n1: float,
    missiles: Array,
    radars: Array,
    spacing_m: float,
    margin_m: float,
    clipping: bool,
    backwards: bool,
) -> tuple[float, float]:
    """Risk of kill and of detection added by a leg, summed over the threats; see ``threat_on_leg``."""
    kill = 0.0
    for k in range(missiles.shape[0]):
        kill += threat_on_leg(e0, n0, e1, n1, missiles[k], spacing_m, margin_m, clipping, backwards)
    detection = 0.0
    for k in range(radars.shape[0]):
        detection += threat_on_leg(e0, n0, e1, n1, radars[k], spacing_m, margin_m, clipping, backwards)
    return kill, detection


@njit(cache=True)
def line_risk(points: Array, missiles: Array, radars: Array, spacing_m: float) -> tuple[float, float]:
    """Eqs 12 and 14 of a polyline: waypoints, and dividing points every ``spacing_m`` between them."""
    kill, detection = point_risk(points[0, 0], points[0, 1], missiles, radars, 0.0)
    for i in range(points.shape[0] - 1):
        rk, rd = leg_risk(
            points[i, 0],
            points[i, 1],
            points[i + 1, 0],
            points[i + 1, 1],
            missiles,
            radars,
            spacing_m,
            0.0,
            False,
            False,
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


@njit(cache=True)
def _side(e0: float, n0: float, e1: float, n1: float, east: float, north: float) -> float:
    return (e1 - e0) * (north - n0) - (n1 - n0) * (east - e0)


@njit(cache=True)
def _crosses(e0: float, n0: float, e1: float, n1: float, edges: Array) -> bool:
    for k in range(edges.shape[0]):
        a_e, a_n, b_e, b_n = edges[k, 0], edges[k, 1], edges[k, 2], edges[k, 3]
        if max(a_e, b_e) < min(e0, e1) or min(a_e, b_e) > max(e0, e1):
            continue
        if max(a_n, b_n) < min(n0, n1) or min(a_n, b_n) > max(n0, n1):
            continue
        ends = _side(e0, n0, e1, n1, a_e, a_n) * _side(e0, n0, e1, n1, b_e, b_n)
        if ends < 0.0 and _side(a_e, a_n, b_e, b_n, e0, n0) * _side(a_e, a_n, b_e, b_n, e1, n1) < 0.0:
            return True
    return False


@njit(cache=True)
def _inside(east: float, north: float, edges: Array, first: int, last: int) -> bool:
    inside = False
    for k in range(first, last):
        a_e, a_n, b_e, b_n = edges[k, 0], edges[k, 1], edges[k, 2], edges[k, 3]
        if (a_n > north) != (b_n > north) and east < a_e + (north - a_n) / (b_n - a_n) * (b_e - a_e):
            inside = not inside
    return inside


@njit(cache=True)
def leg_verdict(
    e0: float,
    n0: float,
    e1: float,
    n1: float,
    discs: Array,
    edges: Array,
    offsets: NDArray[np.int64],
    area: Array,
) -> int:
    """CLEAR, OUTSIDE the area, or through a FORBIDDEN zone: exact for discs and polygons.

    ``discs`` (D, 3) and polygons (``edges`` (E, 4: e0, n0, e1, n1), ``offsets`` (P + 1)) are never entered,
    ``area`` (A, 4) is never left; no rows, no limit. Middle and far end are tested for being inside as well
    as the edges for being crossed, so that a leg through a corner is seen; the near end is the far end of
    the leg before.
    """
    mid_e, mid_n = 0.5 * (e0 + e1), 0.5 * (n0 + n1)
    rows = area.shape[0]
    if rows > 0 and (
        _crosses(e0, n0, e1, n1, area)
        or not _inside(e1, n1, area, 0, rows)
        or not _inside(mid_e, mid_n, area, 0, rows)
    ):
        return OUTSIDE
    for k in range(discs.shape[0]):
        part = nearest_part(e0, n0, e1, n1, discs[k, 0], discs[k, 1])
        delta_e = e0 + part * (e1 - e0) - discs[k, 0]
        delta_n = n0 + part * (n1 - n0) - discs[k, 1]
        if math.hypot(delta_e, delta_n) < discs[k, 2]:
            return FORBIDDEN
    if _crosses(e0, n0, e1, n1, edges):
        return FORBIDDEN
    for p in range(offsets.shape[0] - 1):
        first, last = offsets[p], offsets[p + 1]
        if _inside(e1, n1, edges, first, last) or _inside(mid_e, mid_n, edges, first, last):
            return FORBIDDEN
    return CLEAR
