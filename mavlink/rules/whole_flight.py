"""Rules on the ends of a flight and its heights: climbs, descents, returns, and what hovering counts on.

Sources: ArduPlane and ArduCopter 4.6, PX4 1.16 parameter references. What plans count on of multirotors are
the autopilots' own defaults, as ``planner.vehicle.manners`` has them.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Final

from mavlink.rules.base import OTHER_NAMES, Needs, ParameterFinding, Rule, Values, check
from mavlink.rules.heights import HeightNeeds

#: A rate may be so much of the plan's, and height differ so much from a return's.
_RATE_PART: Final = 0.95
_SAME_HEIGHT_M: Final = 10.0
#: Circles are climbed and descended in at the vehicle's own rate: so much more than planned is steeper.
_FASTER_PART: Final = 1.25
#: A circle this much wider than the plan's is another one.
_WIDER_PART, _WIDER_M = 1.05, 5.0
#: What multirotors count on may differ by a quarter either way.
_COUNTED: Final = (0.8, 1.25)
#: ArduCopter keeps centimetres.
_CENTI: Final = 100.0
_ASKED: Final = "m/s, which a DO_CHANGE_SPEED item asks for"


def _tenths(rate_m_s: float) -> float:
    return math.ceil(10.0 * rate_m_s) / 10.0


def _flying(needs: Needs) -> str:
    """At what speed, and in what wind."""
    wind_m_s = needs.heights.wind_m_s
    behind = f" with up to {wind_m_s:g} m/s of wind behind" if wind_m_s else ""
    return f"at {needs.airspeed_m_s:g} m/s{behind}"


def climbs(name: str) -> Rule:
    """The vehicle climbs as fast as the plan does: lower than planned it comes nearer to what lies below."""
    return check(
        name,
        lambda value, needs: value >= _RATE_PART * needs.heights.climb_m_s,
        lambda needs: (
            f"the plan climbs at up to {needs.heights.climb_m_s:.1f} m/s {_flying(needs)}:"
            " slower, the vehicle stays below the planned line; or plan with a smaller max_climb_deg"
        ),
        lambda needs: _tenths(needs.heights.climb_m_s),
        "error",
    )


def sinks(name: str) -> Rule:
    """It comes down as fast as planned, so that it is low enough where its landing begins."""
    return check(
        name,
        lambda value, needs: value >= _RATE_PART * needs.heights.sink_m_s,
        lambda needs: (
            f"the plan descends at up to {needs.heights.sink_m_s:.1f} m/s {_flying(needs)}:"
            " slower, the vehicle comes in high; or plan with a smaller max_climb_deg"
        ),
        lambda needs: _tenths(needs.heights.sink_m_s),
    )


def turns_up(name: str) -> Rule:
    """In circles it climbs no steeper than the plan, which keeps ``max_climb_deg``."""
    return _in_circles(name, "climbed", lambda heights: (heights.turning_up_m_s, heights.climb_m_s))


def turns_down(name: str) -> Rule:
    """In circles it comes down no steeper than the plan."""
    return _in_circles(name, "descended", lambda heights: (heights.turning_down_m_s, heights.sink_m_s))


def _in_circles(name: str, flown: str, rates_m_s: Callable[[HeightNeeds], tuple[float, float]]) -> Rule:
    """A rate that circles are flown at; of the plan's rates those in circles, and at most.

    Straight legs with the wind behind need what they need: a rate no faster is none too fast in circles.
    """
    return check(
        name,
        lambda value, needs: (
            value <= max(_FASTER_PART * rates_m_s(needs.heights)[0], _tenths(rates_m_s(needs.heights)[1]))
        ),
        lambda needs: (
            f"circles are {flown} in at this rate, in the plan at {rates_m_s(needs.heights)[0]:.1f} m/s:"
            " steeper than its max_climb_deg, and done earlier than planned"
        ),
        lambda needs: _tenths(rates_m_s(needs.heights)[1]),
        applies=lambda needs: rates_m_s(needs.heights)[0] > 0.0,
    )


def _judge_plane_return(values: Values, needs: Needs) -> ParameterFinding | None:
    """ArduPlane flies to home at this height, down from where it is as well; below 0 it keeps its height."""
    name, unit = "RTL_ALTITUDE", 1.0
    if name not in values:
        name, unit = OTHER_NAMES[name]
    if name not in values:
        return None
    value, heights = values[name], needs.heights
    height_m = value / unit
    top_m, zone = heights.flown_over
    clear_m = float(math.ceil(top_m + _SAME_HEIGHT_M)) if zone else 0.0
    if 0.0 <= height_m <= top_m:
        reason = f"a return is flown at {height_m:.0f} m over home, and {zone} reaches up to {top_m:.0f} m"
        advised_m = max(clear_m, heights.return_m or 0.0)
        return ParameterFinding(name, value, advised_m * unit, reason, "error")
    if heights.return_m is not None:
        wanted_m = max(heights.return_m, clear_m)
        if abs(height_m - wanted_m) <= _SAME_HEIGHT_M:
            return None
        there = "where it is" if height_m < 0.0 else f"at {height_m:.0f} m over home"
        reason = f"the return circles {there}, the plan's comes down to {heights.return_m:.0f} m"
        return ParameterFinding(name, value, wanted_m * unit, reason, "warning")
    if heights.ground_rises and 0.0 <= height_m < heights.lowest_m:
        reason = (
            f"a return is flown at {height_m:.0f} m over home, the plan's passes at {heights.lowest_m:.0f} m"
            " and more, clear of ground that the vehicle does not know"
        )
        return ParameterFinding(name, value, math.ceil(heights.lowest_m) * unit, reason, "warning")
    return None


PLANE_RETURN: Final = Rule(lambda needs: ("RTL_ALTITUDE",), _judge_plane_return)


def _judge_circle(values: Values, needs: Needs) -> ParameterFinding | None:
    """The circle that a return ends in is no wider than the plan's, which is clear."""
    if needs.heights.circle_m is None or "RTL_RADIUS" not in values:
        return None
    name = "RTL_RADIUS" if values["RTL_RADIUS"] else "WP_LOITER_RAD"
    value = values.get(name)
    if value is None or abs(value) <= max(
        _WIDER_PART * needs.heights.circle_m, needs.heights.circle_m + _WIDER_M
    ):
        return None
    reason = (
        f"the return circles {abs(value):.0f} m about home, the plan {needs.heights.circle_m:.0f} m: the"
        " wider circle is not known to be clear"
    )
    return ParameterFinding(
        name, value, math.copysign(round(needs.heights.circle_m), value), reason, "warning"
    )


PLANE_CIRCLE: Final = Rule(lambda needs: ("RTL_RADIUS", "WP_LOITER_RAD"), _judge_circle)


def returns_under(name: str, unit: float = 1.0) -> Rule:
    """A return that climbs first stays below what the plan has looked at."""
    return check(
        name,
        lambda value, needs: value / unit <= max(needs.highest_m, 0.0) + _SAME_HEIGHT_M,
        lambda needs: (
            "a return climbs to this height first, where nothing is known to be clear: the plan goes up to"
            f" {needs.highest_m:.0f} m over home"
        ),
        lambda needs: math.floor(needs.highest_m) * unit,
        applies=lambda needs: needs.highest_m > 0.0,
    )


def counted(name: str, planned: float | Callable[[Needs], float], words: str, unit: float = 1.0) -> Rule:
    """Something that the plan's times and energy count on."""

    def wanted(needs: Needs) -> float:
        return planned(needs) if callable(planned) else planned

    return check(
        name,
        lambda value, needs: _COUNTED[0] * wanted(needs) <= value / unit <= _COUNTED[1] * wanted(needs),
        lambda needs: f"the plan's times and energy count on {wanted(needs):g} {words}",
        lambda needs: wanted(needs) * unit,
    )


def fast_enough(name: str) -> Rule:
    """No limit below the plan's speed."""
    return check(
        name,
        lambda value, needs: value >= needs.airspeed_m_s,
        lambda needs: f"the vehicle flies no faster than this, the plan is for {needs.airspeed_m_s:g} m/s",
        lambda needs: float(math.ceil(needs.airspeed_m_s)),
        "error",
    )


PLANE: Final = (
    climbs("TECS_CLMB_MAX"),
    turns_up("TECS_CLMB_MAX"),
    sinks("TECS_SINK_MAX"),
    turns_down("TECS_SINK_MAX"),
    PLANE_RETURN,
    PLANE_CIRCLE,
)
COPTER: Final = (
    counted("WPNAV_SPEED", lambda needs: needs.airspeed_m_s, _ASKED, _CENTI),
    counted("WPNAV_SPEED_UP", 2.5, "m/s up", _CENTI),
    counted("WPNAV_SPEED_DN", 1.5, "m/s down", _CENTI),
    counted("WPNAV_ACCEL", 2.5, "m/s² along and across", _CENTI),
    counted("WPNAV_JERK", 1.0, "m/s³"),
    counted("LAND_SPEED", 0.5, "m/s near the ground", _CENTI),
    returns_under("RTL_ALT", _CENTI),
)
PX4_WINGS: Final = (
    climbs("FW_T_CLMB_R_SP"),
    turns_up("FW_T_CLMB_R_SP"),
    climbs("FW_T_CLMB_MAX"),
    sinks("FW_T_SINK_R_SP"),
    turns_down("FW_T_SINK_R_SP"),
    sinks("FW_T_SINK_MAX"),
    returns_under("RTL_RETURN_ALT"),
)
PX4_MULTIROTOR: Final = (
    fast_enough("MPC_XY_VEL_MAX"),
    counted("MPC_XY_CRUISE", lambda needs: needs.airspeed_m_s, _ASKED),
    counted("MPC_Z_V_AUTO_UP", 3.0, "m/s up"),
    counted("MPC_Z_V_AUTO_DN", 1.5, "m/s down"),
    counted("MPC_TKO_SPEED", 1.5, "m/s off the ground"),
    counted("MPC_LAND_SPEED", 0.7, "m/s near the ground"),
    counted("MPC_ACC_HOR", 3.0, "m/s² along and across"),
    counted("MPC_JERK_AUTO", 4.0, "m/s³"),
    counted("NAV_ACC_RAD", 2.0, "m before a waypoint to the next one"),
    returns_under("RTL_RETURN_ALT"),
)
