"""Changes of speed whose acceleration rises and falls by a jerk, and the chords that arcs are flown by."""

from __future__ import annotations

import math

from planner.vehicle.manners import CHORD_ERROR_M, LARGEST_STEP_RAD

#: Speeds are found to a part in a million.
HALVINGS = 40


def change_s(from_m_s: float, to_m_s: float, accel_m_s2: float, jerk_m_s3: float) -> float:
    """Seconds that a change of speed takes."""
    change = abs(to_m_s - from_m_s)
    if change < accel_m_s2**2 / jerk_m_s3:
        return 2.0 * math.sqrt(change / jerk_m_s3)
    return change / accel_m_s2 + accel_m_s2 / jerk_m_s3


def change_m(from_m_s: float, to_m_s: float, accel_m_s2: float, jerk_m_s3: float) -> float:
    """Distance that a change of speed takes."""
    return 0.5 * (from_m_s + to_m_s) * change_s(from_m_s, to_m_s, accel_m_s2, jerk_m_s3)


def chords_of(turn_rad: float, radius_m: float) -> int:
    """How many chords a mission leaves of an arc."""
    step_rad = 2.0 * math.acos(max(1.0 - CHORD_ERROR_M / radius_m, math.cos(0.5 * LARGEST_STEP_RAD)))
    return max(1, math.ceil(turn_rad / step_rad - 1e-9))
