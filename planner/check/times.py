"""How long a published line takes, by the judge's own reckoning.

Wings: every edge at the true airspeed of its height, as the wind lets it go over the ground. What hovers: as
fast as the wind, the bends of the line and its acceleration allow, at rest where it climbs on the spot.
"""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from planner.airspace.values import Wind
from planner.check.kinematics import MAX_ARC_EDGE_M
from planner.plan import Collect, FlownPath
from planner.vehicle.aircraft import Aircraft
from planner.vehicle.manners import Manners, manners_of

Floats = NDArray[np.float64]

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(12)

#: Edges shorter than this over the ground are flown on the spot.
SPOT_M = 0.01


def line_s(
    line_m: Floats,
    altitudes_m: Floats,
    aircraft: Aircraft,
    wind: Wind,
    datum_amsl_m: float,
    most_m_s: Floats | None = None,
) -> float:
    """Time to fly a line; see ``edges_s``."""
    return float(edges_s(line_m, altitudes_m, aircraft, wind, datum_amsl_m, most_m_s).sum())


def speeds_told(collects: Iterable[Collect], path: FlownPath, line_m: Floats, altitudes_m: Floats) -> Floats:
    """What each edge of a flight's line is flown no faster than, for the collects along it that say so."""
    edges_m = np.hypot(np.hypot(*np.diff(line_m, axis=0).T), np.diff(altitudes_m))
    middles_m = np.cumsum(edges_m) - 0.5 * edges_m
    middles_m *= path.length_m / max(float(edges_m.sum()), 1e-9)
    found = np.full(len(edges_m), np.inf)
    for collect in collects:
        if collect.speed_m_s is not None and (collect.vehicle, collect.sortie) == (path.vehicle, path.sortie):
            of_it = (middles_m > collect.start_m) & (middles_m < collect.end_m)
            found[of_it] = np.minimum(found[of_it], collect.speed_m_s)
    return found


def edges_s(
    line_m: Floats,
    altitudes_m: Floats,
    aircraft: Aircraft,
    wind: Wind,
    datum_amsl_m: float,
    most_m_s: Floats | None = None,
) -> Floats:
    """Time to fly each edge of a line, (N - 1,); infinite where the wind is not slower than the aircraft.

    Parameters
    ----------
    line_m, altitudes_m
        Shapes (N, 2) and (N,): east and north, and altitude over a datum ``datum_amsl_m`` above the sea.
    most_m_s
        What hovers flies each edge no faster than, (N - 1,); see ``speeds_told``.
    """
    manners = manners_of(aircraft)
    over_m = np.hypot(*np.diff(line_m, axis=0).T)
    rises_m = np.diff(altitudes_m)
    spot = over_m <= SPOT_M
    if wind.speed_m_s >= aircraft.airspeed_m_s:
        return np.full(len(over_m), math.inf)
    found = _spot_s(rises_m, spot, manners)
    flown = ~spot
    if aircraft.hovers:
        told_m_s = np.full(len(over_m), np.inf) if most_m_s is None else most_m_s
        found[flown] = _rotor_s(
            line_m[np.concatenate([[True], flown])], rises_m[flown], told_m_s[flown], aircraft, wind, manners
        )
        return found
    starts_m, climbs_m = altitudes_m[:-1][flown], rises_m[flown]
    # ICAO standard atmosphere: density falls with the 4.2559th power of temperature. Along an edge it is
    # taken at Gauss's places: what a wind near the airspeed leaves changes with it many times over.
    at_m = datum_amsl_m + starts_m[:, None] + (0.5 + 0.5 * _NODES) * climbs_m[:, None]
    density = ((288.15 - 0.0065 * np.clip(at_m, -1_000.0, 11_000.0)) / 288.15) ** 4.25588
    air_m_s = aircraft.airspeed_m_s / np.sqrt(density)
    if (air_m_s <= wind.speed_m_s).any():
        # In air that dense it is not faster than the wind.
        return np.full(len(found), math.inf)
    toward = np.array([math.cos(wind.toward_rad), math.sin(wind.toward_rad)])
    along_m_s = wind.speed_m_s * (np.diff(line_m, axis=0)[flown] @ toward) / over_m[flown]
    # In a time t, how far it is through the air: (d - w t)² + (W² - w²) t² + h² = V² t². So
    # (V² - W²) t² + 2 d w t = d² + h², w the wind along the edge.
    spare = air_m_s**2 - wind.speed_m_s**2
    with_it = (over_m[flown] * along_m_s)[:, None]
    reach = (over_m[flown] ** 2 + climbs_m**2)[:, None]
    root = np.sqrt(with_it**2 + spare * reach)
    times_s = np.where(with_it > 0.0, reach / (root + np.maximum(with_it, 0.0)), (root - with_it) / spare)
    found[flown] = 0.5 * (times_s @ _WEIGHTS)
    return found


def _spot_s(rises_m: Floats, spot: NDArray[np.bool_], manners: Manners) -> Floats:
    """Climbs on the spot, those that follow each other as one; the last metres down at landing speed.

    Each edge has its share by height, those over the ground none.
    """
    found, k = np.zeros(len(rises_m)), 0
    while k < len(rises_m):
        if not spot[k]:
            k += 1
            continue
        height_m, first = 0.0, k
        while k < len(rises_m) and spot[k]:
            height_m += float(rises_m[k])
            k += 1
        if abs(height_m) < SPOT_M:
            continue
        slow_m = min(manners.land_below_m, -height_m) if height_m < 0.0 else 0.0
        rate = manners.climb_m_s if height_m > 0.0 else manners.sink_m_s
        total_s = slow_m / manners.land_m_s if slow_m > 0.0 else 0.0
        total_s += _rest_to_rest_s(abs(height_m) - slow_m, rate, manners.vertical_accel_m_s2)
        shares = np.abs(rises_m[first:k])
        found[first:k] = total_s * shares / shares.sum()
    return found


def _rest_to_rest_s(distance_m: float, speed_m_s: float, accel_m_s2: float) -> float:
    peak = min(speed_m_s, math.sqrt(max(distance_m, 0.0) * accel_m_s2))
    return 0.0 if peak <= 0.0 else distance_m / peak + peak / accel_m_s2


def _against_m_s(edges: Floats, over_m: Floats, airspeed_m_s: float, wind: Wind, sharing: float) -> Floats:
    """Speed over the ground of what hovers: that of still air, or what its airspeed leaves in this wind."""
    ahead = edges / over_m[:, None]
    toward_m_s = wind.speed_m_s * np.array([math.cos(wind.toward_rad), math.sin(wind.toward_rad)])
    along_m_s = ahead @ toward_m_s
    beside_m_s = np.abs(ahead @ np.array([-toward_m_s[1], toward_m_s[0]]))
    left_m_s = along_m_s + (airspeed_m_s**sharing - beside_m_s**sharing) ** (1.0 / sharing)
    return np.asarray(np.minimum(left_m_s, airspeed_m_s), dtype=np.float64)


def _rotor_s(
    line_m: Floats, rises_m: Floats, told_m_s: Floats, aircraft: Aircraft, wind: Wind, manners: Manners
) -> Floats:
    """Of edges over the ground, from rest to rest."""
    edges = np.diff(line_m, axis=0)
    over_m = np.hypot(edges[:, 0], edges[:, 1])
    if len(over_m) == 0:
        return over_m
    lengths_m = np.hypot(over_m, rises_m)
    rate = np.where(rises_m > 0.0, manners.climb_m_s, manners.sink_m_s)
    with np.errstate(divide="ignore"):
        limits = np.minimum(
            _against_m_s(edges, over_m, aircraft.airspeed_m_s, wind, manners.sharing),
            np.where(rises_m == 0.0, np.inf, rate * lengths_m / np.abs(rises_m)),
        )
        limits = np.minimum(limits, told_m_s)
    turned = np.abs(np.mod(np.diff(np.arctan2(edges[:, 1], edges[:, 0])) + np.pi, 2.0 * np.pi) - np.pi)
    capped_m = np.minimum(over_m, MAX_ARC_EDGE_M)
    with np.errstate(divide="ignore"):
        radii_m = (capped_m[:-1] + capped_m[1:]) / 4.0 / np.sin(np.maximum(turned, 1e-9) / 2.0)
    corners = np.concatenate([[0.0], np.sqrt(manners.accel_m_s2 * radii_m), [0.0]])
    corners[1:-1] = np.minimum(corners[1:-1], np.minimum(limits[1:], limits[:-1]))
    for k, length_m in enumerate(lengths_m):
        corners[k + 1] = min(corners[k + 1], math.sqrt(corners[k] ** 2 + 2.0 * manners.accel_m_s2 * length_m))
    for k in range(len(lengths_m) - 1, -1, -1):
        reach = math.sqrt(corners[k + 1] ** 2 + 2.0 * manners.accel_m_s2 * lengths_m[k])
        corners[k] = min(corners[k], reach)
    peaks = np.minimum(
        limits, np.sqrt(manners.accel_m_s2 * lengths_m + 0.5 * (corners[:-1] ** 2 + corners[1:] ** 2))
    )
    peaks = np.maximum(peaks, np.maximum(corners[:-1], corners[1:]))
    speeding_m = (2.0 * peaks**2 - corners[:-1] ** 2 - corners[1:] ** 2) / (2.0 * manners.accel_m_s2)
    changing_s = (2.0 * peaks - corners[:-1] - corners[1:]) / manners.accel_m_s2
    return np.asarray(changing_s + np.maximum(lengths_m - speeding_m, 0.0) / peaks)
