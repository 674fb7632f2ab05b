"""Energy of a published line, by the judge's own reckoning: of each edge, as its ends say how it is flown."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from planner.airspace.values import Wind
from planner.check.kinematics import MAX_ARC_EDGE_M
from planner.check.times import SPOT_M, edges_s
from planner.vehicle.aircraft import Aircraft
from planner.vehicle.atmosphere import true_over_equivalent
from planner.vehicle.energy import STANDARD_GRAVITY_M_S2, FlightState

Floats = NDArray[np.float64]


def line_wh(
    line_m: Floats,
    altitudes_m: Floats,
    aircraft: Aircraft,
    wind: Wind,
    datum_amsl_m: float,
    whole_s: float | None = None,
    most_m_s: Floats | None = None,
) -> float | None:
    """Energy from the battery for a line; None without a power model.

    Parameters
    ----------
    line_m, altitudes_m
        Shapes (N, 2) and (N,): east and north, and altitude over a datum ``datum_amsl_m`` above the sea.
    whole_s
        What the whole takes where that is longer than the line's own reckoning: edges take their share.
    most_m_s
        What edges are flown no faster than, where that is told.
    """
    power = aircraft.power
    if power is None:
        return None
    times_s = edges_s(line_m, altitudes_m, aircraft, wind, datum_amsl_m, most_m_s)
    if not np.isfinite(times_s).all():
        return float("inf")
    if whole_s is not None and whole_s > times_s.sum() > 0.0:
        times_s = times_s * (whole_s / times_s.sum())
    edges = np.diff(line_m, axis=0)
    over_m = np.hypot(*edges.T)
    ground_m_s = np.where(over_m > SPOT_M, over_m / np.maximum(times_s, 1e-9), 0.0)
    air = edges / np.maximum(over_m, 1e-9)[:, None] * ground_m_s[:, None]
    toward = wind.speed_m_s * np.array([np.cos(wind.toward_rad), np.sin(wind.toward_rad)])
    aside_m_s2 = ground_m_s**2 * _curvature(edges, over_m)
    loads = np.hypot(1.0, aside_m_s2 / STANDARD_GRAVITY_M_S2)
    middles_m = datum_amsl_m + 0.5 * (altitudes_m[1:] + altitudes_m[:-1])
    rises_m = np.diff(altitudes_m)
    joules = 0.0
    for k, time_s in enumerate(times_s):
        if time_s <= 0.0:
            continue
        airspeed_m_s = 0.0
        if over_m[k] > SPOT_M or aircraft.type == "fixed_wing":
            airspeed_m_s = aircraft.airspeed_m_s * true_over_equivalent(float(middles_m[k]))
            airspeed_m_s = float(np.hypot(*(air[k] - toward))) if aircraft.hovers else airspeed_m_s
        climb_m_s = float(rises_m[k] / time_s)
        state = FlightState(airspeed_m_s, climb_m_s, float(loads[k]), float(middles_m[k]))
        joules += float(time_s) * power.power_w(state)
    return joules / 3600.0


def _curvature(edges: Floats, over_m: Floats) -> Floats:
    """Of each edge, by its neighbours' directions; none for edges too long for an arc."""
    angles = np.arctan2(edges[:, 1], edges[:, 0])
    turned = np.abs(np.mod(np.diff(angles) + np.pi, 2.0 * np.pi) - np.pi)
    short = (over_m > SPOT_M) & (over_m <= MAX_ARC_EDGE_M)
    bent = np.where(
        short[1:] & short[:-1], turned / np.maximum(0.5 * (over_m[1:] + over_m[:-1]), 1e-9), np.nan
    )
    sides = np.stack([np.append(bent, np.nan), np.insert(bent, 0, np.nan)])
    counted = np.isfinite(sides).sum(axis=0)
    return np.asarray(np.nansum(sides, axis=0) / np.maximum(counted, 1))
