"""The strip a pass sees, on each course: with an antenna fixed to the aircraft it changes with the crab.

The antenna's axis is the aircraft's, turned by ψ off the course (``SarSensor.yaw_rad``). A ray at the look
angle θ to ground a drop d below has, along that axis and away from it::

    y_b = d tan θ        x_b = d tan θ_sq / cos θ

so that in the course's axes the ground lies y = y_b cos ψ − x_b sin ψ beside the track and
x = y_b sin ψ + x_b cos ψ ahead of the aircraft. The strip is narrower by about cos ψ, nearer, and slanted:
its far edge is seen farther ahead, or behind, than its near one. Passes begin and end where all is seen.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from planner.route import Look
from planner.sensors import sar_modes
from planner.sensors.sar import SarSensor

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Strip:
    """What passes see, one entry a course; float64 (M,).

    Parameters
    ----------
    near_m, swath_m
        From the track to the strip's near edge, and the strip's width.
    run_in_m, run_out_m
        How far before and beyond the ground the sensor must be on.
    """

    near_m: Floats
    swath_m: Floats
    run_in_m: Floats
    run_out_m: Floats


def strip_on(sensor: SarSensor, height_m: float, courses_rad: ArrayLike, look: Look) -> Strip:
    """The strip planned with on each course, margins left out.

    Its edges are the same to either side and on a course's opposite.
    """
    courses = np.atleast_1d(np.asarray(courses_rad, dtype=np.float64))
    if not sensor.crabs:
        ones = np.ones(courses.shape)
        return Strip(
            sensor.near_m(height_m) * ones,
            sensor.swath_m(height_m) * ones,
            sensor.run_in_m(height_m) * ones,
            sensor.run_out_m(height_m) * ones,
        )
    yaw = sensor.yaw_rad(courses, look)
    margin_rad = sensor.pointing_margin_rad
    high_m, low_m = height_m - sensor.relief_m, height_m + sensor.relief_m
    turned = np.abs(yaw)[None, :] + np.array([-margin_rad, margin_rad])[:, None]
    turned = np.concatenate([turned, -turned])
    near_m = low_m * edge_tan(sensor, sensor.steepest_rad, turned).max(axis=0) + sensor.position_margin_m
    far_m = high_m * edge_tan(sensor, sensor.flattest_rad, turned).min(axis=0) - sensor.position_margin_m
    # One row for each squint and drop: planning asks for so many strips that calls would cost more than sums.
    squints_rad = sensor.squint_rad + np.array([[-margin_rad], [-margin_rad], [margin_rad], [margin_rad]])
    drops_m = np.array([[high_m], [low_m], [high_m], [low_m]])
    turning_m = _turning_m(squints_rad, yaw, drops_m, near_m, far_m)
    outs_m = np.stack(
        [np.broadcast_to(near_m, turning_m.shape), np.broadcast_to(far_m, turning_m.shape), turning_m]
    )
    leads = lead_m(squints_rad, yaw, outs_m, drops_m)
    half_m = aperture_m(sensor, low_m, yaw) / 2.0 + sensor.position_margin_m
    return Strip(near_m, far_m - near_m, half_m + leads.max(axis=(0, 1)), half_m - leads.min(axis=(0, 1)))


def swaths_m(sensor: SarSensor, height_m: float, courses_rad: ArrayLike) -> Floats:
    """The strip's width on each course, the same to either side."""
    return strip_on(sensor, height_m, courses_rad, "right").swath_m


def edge_tan(sensor: SarSensor, look_rad: float, yaw_rad: ArrayLike) -> Floats:
    """How far beside the track a ray at a look angle meets the ground, for each metre it drops."""
    ahead = math.tan(sensor.squint_rad) / math.cos(look_rad)
    return np.asarray(math.tan(look_rad) * np.cos(yaw_rad) - ahead * np.sin(yaw_rad), dtype=np.float64)


def aperture_m(sensor: SarSensor, drop_m: ArrayLike, yaw_rad: ArrayLike) -> Floats:
    """Synthetic aperture over ground a drop below: eq 5, with squint and crab."""
    one_m = sar_modes.crabbed_aperture_m(
        1.0, sensor.azimuth_beamwidth_rad, sensor.squint_rad, sensor.incidence_rad, yaw_rad
    )
    return np.asarray(np.asarray(drop_m) / math.cos(sensor.incidence_rad) * one_m, dtype=np.float64)


def lead_m(squint_rad: ArrayLike, yaw_rad: ArrayLike, out_m: ArrayLike, drop_m: ArrayLike) -> Floats:
    """How far ahead of the aircraft ground is seen that lies beside the track and below it."""
    tan, out, drop = np.tan(squint_rad), np.asarray(out_m), np.asarray(drop_m)
    cos, sin = np.cos(yaw_rad), np.sin(yaw_rad)
    # Of y = y_b cos ψ − x_b sin ψ with x_b = √(y_b² + d²) tan θ_sq, the root y_b.
    side = tan * sin
    rest = cos * cos - side * side
    beside = (cos * out + side * np.sqrt(out * out + rest * drop * drop)) / rest
    return np.asarray(beside * sin + np.hypot(beside, drop) * tan * cos, dtype=np.float64)


def _turning_m(squint_rad: Floats, yaw: Floats, drop_m: Floats, near_m: Floats, far_m: Floats) -> Floats:
    """Where in the strip the lead is greatest or least, squint and crab against each other; else an edge."""
    tan = np.tan(squint_rad)
    squinted = np.abs(tan) >= 1e-9
    # dx/dy_b = sin ψ + tan θ_sq cos ψ sin θ vanishes at this look angle.
    sine = -np.tan(yaw) / np.where(squinted, tan, 1.0)
    look = np.arcsin(np.minimum(np.maximum(sine, -1.0 + 1e-9), 1.0 - 1e-9))
    out_m = drop_m * (np.tan(look) * np.cos(yaw) - tan / np.cos(look) * np.sin(yaw))
    within_m = np.minimum(np.maximum(out_m, near_m), np.maximum(near_m, far_m))
    return np.asarray(np.where(squinted, within_m, near_m), dtype=np.float64)
