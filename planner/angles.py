"""The one place that converts between headings and mathematical angles.

Inside, an *angle* is in radians, counter-clockwise from east. At the edges, a *heading* is in degrees,
clockwise from true north, in [0, 360).
"""

from __future__ import annotations

import math

TWO_PI = 2.0 * math.pi


def angle_from_heading(heading_deg: float) -> float:
    """Angle in radians, counter-clockwise from east, in (-π, π], of a heading in degrees from north."""
    return wrap_pi(math.radians(90.0 - heading_deg))


def heading_from_angle(angle_rad: float) -> float:
    """Heading in degrees, clockwise from north, in [0, 360), of an angle in radians from east."""
    heading_deg = math.fmod(90.0 - math.degrees(angle_rad), 360.0)
    if heading_deg < 0.0:
        heading_deg += 360.0
    return 0.0 if heading_deg >= 360.0 else heading_deg


def wrap_pi(angle_rad: float) -> float:
    """The same angle in (-π, π]."""
    wrapped_rad = math.remainder(angle_rad, TWO_PI)
    return math.pi if wrapped_rad == -math.pi else wrapped_rad


def wrap_two_pi(angle_rad: float) -> float:
    """The same angle in [0, 2π)."""
    wrapped_rad = math.fmod(angle_rad, TWO_PI)
    if wrapped_rad < 0.0:
        wrapped_rad += TWO_PI
    return 0.0 if wrapped_rad >= TWO_PI else wrapped_rad
