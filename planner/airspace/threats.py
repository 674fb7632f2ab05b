"""Threat models: risk of kill and risk of radar detection (Li et al. 2018, eqs 11-14).

A threat is a cylinder: flown over above its ``height_m`` it does not act. The altitude given here is measured
over the same datum as that height; without one every threat acts.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from planner.airspace import kernels
from planner.airspace.kernels import MIN_RADAR_RANGE_M as MIN_RADAR_RANGE_M
from planner.airspace.values import Threat

Array = NDArray[np.float64]

#: Distance between dividing points in the paper's experiments (section 5.2).
DIVIDING_M = 100.0


def acting(threats: Iterable[Threat], altitude_m: float | None = None) -> tuple[Threat, ...]:
    """The threats that reach up to a flight altitude: those with ``height_m`` not below it."""
    return tuple(t for t in threats if altitude_m is None or t.height_m >= altitude_m)


def threat_arrays(threats: Iterable[Threat], altitude_m: float | None = None) -> tuple[Array, Array]:
    """Threats as arrays for the kernels.

    Parameters
    ----------
    threats
        Missile sites and radars, hard ones included.
    altitude_m
        Flight altitude over the datum of the threats' heights; None to let every threat act.

    Returns
    -------
    missiles : ndarray
        float64, shape (K, 3): east_m, north_m, radius_m.
    radars : ndarray
        float64, shape (M, 4): east_m, north_m, radius_m, intensity_m.
    """
    acts = acting(threats, altitude_m)
    missiles = [(*t.centre, t.radius_m) for t in acts if t.model == "missile"]
    radars = [(*t.centre, t.radius_m, t.intensity_m) for t in acts if t.model == "radar"]
    return (
        np.array(missiles, dtype=np.float64).reshape(-1, 3),
        np.array(radars, dtype=np.float64).reshape(-1, 4),
    )


def threat_discs(threats: Iterable[Threat], altitude_m: float | None = None) -> Array:
    """Discs of all acting threats, float64, shape (K, 3): east_m, north_m, radius_m."""
    discs = [(*t.centre, t.radius_m) for t in acting(threats, altitude_m)]
    return np.array(discs, dtype=np.float64).reshape(-1, 3)


def risk_of_kill(distance_m: float, radius_m: float) -> float:
    """Risk of kill at a distance from a missile of effective distance ``radius_m`` (eq 11), 0 to 1."""
    if distance_m > radius_m or radius_m <= 0.0:
        return 0.0
    return radius_m**4 / (radius_m**4 + distance_m**4)


def risk_of_detection(distance_m: float, radius_m: float, intensity_m: float) -> float:
    """Risk of radar detection at a distance from a radar (eq 13).

    Eq 13 has a pole at distance 0; the distance is not let under ``MIN_RADAR_RANGE_M`` (1 m), so a line over
    the radar itself costs (intensity / 1 m)⁴, beyond any detour, and sums stay finite and comparable.
    """
    if distance_m > radius_m:
        return 0.0
    return (intensity_m / max(distance_m, MIN_RADAR_RANGE_M)) ** 4


def line_risk(
    points: ArrayLike,
    threats: Iterable[Threat],
    spacing_m: float = DIVIDING_M,
    altitude_m: float | None = None,
) -> tuple[float, float]:
    """Risk of kill and of detection of a line of waypoints (eqs 12 and 14).

    The sums run over the waypoints and over dividing points, ``spacing_m`` apart, counted from each
    waypoint towards the next. They therefore grow with the number of waypoints: give it waypoints, and
    a densely sampled curve to ``curve_risk``.

    Parameters
    ----------
    points
        Shape (N, 2): east_m, north_m of the waypoints, N >= 1.

    Returns
    -------
    tuple
        ``risk_missile`` (J2), ``risk_radar`` (J3).
    """
    kill, detection = kernels.line_risk(
        _line(points), *threat_arrays(threats, altitude_m), _spacing(spacing_m)
    )
    return float(kill), float(detection)


def curve_risk(
    points: ArrayLike,
    threats: Iterable[Threat],
    spacing_m: float = DIVIDING_M,
    altitude_m: float | None = None,
) -> tuple[float, float]:
    """Risk of kill and of detection of a flown curve, the same however densely it is stored.

    The curve is sampled at its start, every ``spacing_m`` of its length, and at its end; eqs 12 and 14 are
    summed over these points.

    Parameters
    ----------
    points
        Shape (N, 2): east_m, north_m along the curve, N >= 1.

    Returns
    -------
    tuple
        ``risk_missile``, ``risk_radar``.
    """
    kill, detection = kernels.curve_risk(
        _line(points), *threat_arrays(threats, altitude_m), _spacing(spacing_m)
    )
    return float(kill), float(detection)


def metres_inside(points: ArrayLike, threats: Iterable[Threat], altitude_m: float | None = None) -> float:
    """Length of a polyline, shape (N, 2), inside threat discs; where discs overlap it counts once."""
    return float(kernels.length_in_discs(_line(points), threat_discs(threats, altitude_m)))


def _line(points: ArrayLike) -> Array:
    array = np.ascontiguousarray(points, dtype=np.float64)
    if array.ndim != 2 or array.shape[1] != 2 or array.shape[0] == 0:
        raise ValueError(f"points must have shape (N, 2) with N >= 1, not {array.shape}")
    return array


def _spacing(spacing_m: float) -> float:
    if not spacing_m > 0.0:
        raise ValueError(f"spacing_m must be positive, not {spacing_m}")
    return spacing_m
