"""A radar in a gimbal: its own attitude in place of the airframe's, where the gimbal told it.

A gimbal that holds a side-looking antenna points abeam, its pitch down from the horizon by what the beam's
incidence leaves of a right angle. What it is off is to the antenna what a roll of the airframe would be.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from planner.as_flown.passes import PlannedPass
from planner.as_flown.track import Line
from planner.sensors.sar import SarSensor
from planner.sensors.suite import Suite


def in_gimbal(line: Line) -> NDArray[np.bool_]:
    """Places at which a gimbal told its attitude, (N,)."""
    return np.asarray(np.isfinite(line.mount_rad).all(axis=1))


def turned(line: Line, in_pass: NDArray[np.int64], passes: Sequence[PlannedPass], suite: Suite) -> Line:
    """The line with roll, pitch and heading those of a radar's antenna wherever a gimbal told them.

    Where the gimbal's own roll, which turns the beam about itself, is the most that is off, it stands for it.
    """
    told = in_gimbal(line)
    if not told.any():
        return line
    roll, pitch, heading = line.roll_rad.copy(), line.pitch_rad.copy(), line.heading_rad.copy()
    for row, planned in enumerate(passes):
        sensor = suite.named(planned.collect.sensor)
        if not isinstance(sensor, SarSensor):
            continue
        here = told & (in_pass == row)
        sign = -1.0 if planned.collect.look == "left" else 1.0
        mount_roll, mount_pitch, mount_yaw = line.mount_rad[here].T
        off = sensor.incidence_rad - (math.pi / 2.0 + mount_pitch)
        roll[here] = sign * np.where(np.abs(mount_roll) > np.abs(off), np.abs(mount_roll), off)
        pitch[here] = 0.0
        heading[here] = mount_yaw - sign * math.pi / 2.0
    return replace(line, roll_rad=roll, pitch_rad=pitch, heading_rad=heading)
