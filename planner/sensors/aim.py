"""Where a spotlight's beam is kept, and how much of the ground it holds there."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from planner.airspace.terrain import Ground
from planner.sensors import sar_modes, strip
from planner.sensors.sar import SarSensor

Floats = NDArray[np.float64]

#: Rays to the ground from a spotlight's line are followed this often.
AIM_STEPS = 6


def spot_half_m(sensor: SarSensor, drop_m: float) -> float:
    """Half the length of a spot along the track: what the beam holds of its near edge."""
    return sar_modes.spot_m(drop_m / math.cos(sensor.steepest_rad), sensor.azimuth_beamwidth_rad) / 2.0


def spot_ahead_m(sensor: SarSensor, drop_m: float) -> float:
    """How far ahead of the line's middle a spotlight's spot has its own, the mean of its edges'."""
    edges_m = [drop_m * math.tan(edge) for edge in (sensor.steepest_rad, sensor.flattest_rad)]
    return float(strip.lead_m(sensor.squint_rad, 0.0, edges_m, drop_m).mean())


def aim_drop_m(
    sensor: SarSensor,
    places: Callable[[Floats, Floats], Floats],
    length_m: float,
    level_m: float,
    ground: Ground,
) -> float:
    """How far below the flight the ground is on which a spotlight's beam is kept.

    Parameters
    ----------
    places
        Local places of ways along the line and away from it.
    """
    unknown_m = float(np.nanmean(ground.heights_m)) if np.isfinite(ground.heights_m).any() else 0.0
    drop_m = level_m - unknown_m
    # Where the ray meets the ground depends on the ground: a few steps settle it.
    for _ in range(AIM_STEPS):
        at_m = length_m / 2.0 + spot_ahead_m(sensor, drop_m)
        out_m = drop_m * math.tan(sensor.incidence_rad)
        found_m = float(ground.at(places(np.array([at_m]), np.array([out_m])))[0])
        drop_m = level_m - (unknown_m if math.isnan(found_m) else found_m)
    return drop_m
