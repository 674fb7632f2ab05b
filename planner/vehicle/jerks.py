"""Changes of speed whose acceleration rises and falls by a jerk; what arcs are flown by: chords, corners."""

from __future__ import annotations

import math

from planner.vehicle.aircraft import CORNER_RADIUS_M, TURN_RADIUS_MARGIN
from planner.vehicle.manners import CHORD_ERROR_M, LARGEST_STEP_RAD

#: A corner turns by no more than this, a right angle and a little; what turns farther is several.
MOST_CORNER_RAD = math.radians(91.0)

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


def is_corner(radius_m: float) -> bool:
    """Whether an arc is flown as corners: by straights that meet behind it."""
    return radius_m <= CORNER_RADIUS_M * TURN_RADIUS_MARGIN


def corners_of(turn_rad: float, radius_m: float) -> tuple[int, float]:
    """How many corners such an arc is, and how far each is from where its straights touch it."""
    count = max(1, math.ceil(turn_rad / MOST_CORNER_RAD))
    return count, radius_m * math.tan(turn_rad / (2.0 * count))
