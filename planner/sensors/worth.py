"""What a pass's images are worth: the worst and the mean ground sampled distance and NIIRS in what it sees.

Of a camera by GIQE 4 over the image's ground; of a radar by slant range and depression (equation 9 of Stecz
and Gromada 2020), which asks for no figures that a scenario does not give.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from planner.sensors.base import Sensor
from planner.sensors.camera import CameraSensor
from planner.sensors.sar import SarSensor
from planner.sensors.sar_quality import niirs_by_range

#: Means are Gauss-Legendre sums over so many nodes.
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(24)


@dataclass(frozen=True, slots=True)
class Worth:
    """Of the ground that one pass sees; None where unknown."""

    gsd_m: float | None = None
    gsd_mean_m: float | None = None
    niirs: float | None = None
    niirs_mean: float | None = None


def worth_of(sensor: Sensor, height_m: float, low_m: float, high_m: float) -> Worth:
    """Over ground between two heights: the worst of all of it, the mean over the mean ground.

    Parameters
    ----------
    height_m
        Over the mean ground.
    low_m, high_m
        Of the lowest and the highest ground, over the mean: not positive and not negative. Where heights are
        unknown (NaN) nothing is.
    """
    if math.isnan(height_m):
        return Worth()
    if isinstance(sensor, CameraSensor):
        return _of_camera(sensor, height_m, low_m)
    if isinstance(sensor, SarSensor):
        return _of_radar(sensor, height_m, low_m, high_m)
    return Worth()


def radar_niirs(sensor: SarSensor, height_m: float, look_rad: float) -> float:
    """NIIRS at a look angle from the vertical."""
    return niirs_by_range(height_m / math.cos(look_rad) / 1000.0, math.pi / 2.0 - look_rad)


def _of_camera(sensor: CameraSensor, height_m: float, low_m: float) -> Worth:
    worst_m = sensor.worst_gsd * (height_m - low_m)
    high = math.tan(sensor.optics.half_height_rad)
    down = math.cos(sensor.tilt_rad) - high * _NODES * math.sin(sensor.tilt_rad)
    # Ground of the image point v up: the area of a pixel goes with 1 / D³.
    share = _WEIGHTS / down**3
    each_m = sensor.optics.gsd_m(height_m) * (1.0 / down + 1.0 / down**2) / 2.0
    mean_m = float((share * each_m).sum() / share.sum())
    if sensor.quality is None:
        return Worth(worst_m, mean_m)
    niirs = np.array([sensor.quality.niirs(float(gsd_m)) for gsd_m in each_m])
    mean = float((share * niirs).sum() / share.sum())
    return Worth(worst_m, mean_m, sensor.quality.niirs(worst_m), mean)


def _of_radar(sensor: SarSensor, height_m: float, low_m: float, high_m: float) -> Worth:
    half_rad = sensor.elevation_beamwidth_rad / 2.0
    near_rad, far_rad = sensor.incidence_rad - half_rad, sensor.incidence_rad + half_rad
    # Concave in the depression, falling with the range: the worst is at an edge, seen from farthest.
    worst = min(radar_niirs(sensor, height_m - low_m, look) for look in (near_rad, far_rad))
    looks = sensor.incidence_rad + half_rad * _NODES
    share = _WEIGHTS / np.cos(looks) ** 2
    each = np.array([radar_niirs(sensor, height_m, float(look)) for look in looks])
    return Worth(niirs=worst, niirs_mean=float((share * each).sum() / share.sum()))
