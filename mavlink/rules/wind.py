"""How fast a piece of a plan is flown over the ground in the plan's wind."""

from __future__ import annotations

import math
from typing import Final

from mavlink.wire.geometry import course_deg
from planner.plan import PathSegment, PlanWind

#: From so much on an arc is whole turns; rounding may have taken a little.
_WHOLE_TURN_DEG: Final = 359.9


def is_whole_turn(segment: PathSegment) -> bool:
    """Whether an arc is flown all round, on each course for as long as on the others."""
    return (segment.turn_deg or 0.0) >= _WHOLE_TURN_DEG


def fastest_m_s(segment: PathSegment, airspeed_m_s: float, wind: PlanWind) -> float:
    """Fastest over the ground on a piece of a line, by wings that keep its course and their airspeed.

    Whole turns are flown at the vehicle's own rate of climb, not along a slope: they count as in still air.
    """
    if wind.speed_m_s == 0.0 or is_whole_turn(segment):
        return airspeed_m_s
    toward_deg = wind.from_deg + 180.0
    if segment.centre is None:
        return _over_ground_m_s(course_deg(segment.start, segment.end) - toward_deg, airspeed_m_s, wind)
    side, turn_deg = (1.0 if segment.kind == "right" else -1.0), segment.turn_deg or 0.0
    begin_deg = course_deg(segment.centre, segment.start) + side * 90.0
    if side * (toward_deg - begin_deg) % 360.0 <= turn_deg:
        return airspeed_m_s + wind.speed_m_s
    return max(
        _over_ground_m_s(course - toward_deg, airspeed_m_s, wind)
        for course in (begin_deg, begin_deg + side * turn_deg)
    )


def _over_ground_m_s(off_deg: float, airspeed_m_s: float, wind: PlanWind) -> float:
    """By the wind triangle, so far off from where the wind blows to."""
    off_rad = math.radians(off_deg)
    across_m_s = min(wind.speed_m_s * abs(math.sin(off_rad)), airspeed_m_s)
    return wind.speed_m_s * math.cos(off_rad) + math.sqrt(airspeed_m_s**2 - across_m_s**2)
