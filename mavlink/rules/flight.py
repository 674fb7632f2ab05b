"""Rules on how lines and turns are flown, alike on both autopilots but for the parameters' names.

Sources: ArduPlane 4.6 and PX4 1.16 parameter references; the tracking figures were measured on ArduPlane's
and PX4's simulators (docs/link.md).
"""

from __future__ import annotations

import math
from typing import Final

from mavlink.rules.base import Needs, ParameterFinding, Rule, Values, check

_G_M_S2: Final = 9.80665
#: An arc's points pass unseen when waypoints count as reached from farther than this part of its radius.
_RADIUS_PART: Final = 0.5
#: ArduPlane at 22.4 m/s on arcs of 100 m: period 10 s keeps lines within 2.2 m (p95), 15 s within 10.9 m.
_L1_TURNS: Final = 10.0 / (100.0 / 22.4)
_L1_BEST_S: Final = (8.0, 20.0)
#: The same flights at period 15 s: within 5 m of the line 130 m behind a turn.
_SETTLE_M_A_SECOND: Final = 130.0 / 15.0 / 22.4
_MARGIN: Final = 1.25
_SWITCH: Final = ("NPFG_SW_DST_MLT", "NPFG_PERIOD", "NPFG_DAMPING")
#: The least PX4 takes for NPFG_SW_DST_MLT.
_LEAST_SWITCH: Final = 0.1


def _corner_m(needs: Needs) -> float:
    return math.floor(_RADIUS_PART * needs.turn_radius_m)


def _l1_period_s(needs: Needs) -> float:
    """A period that follows arcs of the plan's radius, and settles in the straight it leaves."""
    period_s = min(max(_L1_TURNS * needs.turn_radius_m / needs.airspeed_m_s, _L1_BEST_S[0]), _L1_BEST_S[1])
    if needs.settle_m:
        period_s = min(period_s, needs.settle_m / (_SETTLE_M_A_SECOND * needs.airspeed_m_s))
    return float(max(math.floor(period_s), _L1_BEST_S[0]))


def _l1_reason(needs: Needs) -> str:
    straight = f" with {needs.settle_m:g} m of straight before each pass" if needs.settle_m else ""
    return (
        f"the longer the period, the wider turns of {needs.turn_radius_m:.0f} m at"
        f" {needs.airspeed_m_s:g} m/s{straight} are flown, and the later lines are held"
    )


def _bank_deg(needs: Needs) -> float:
    """Bank of the plan's tightest turn, tan φ = v² / (g r)."""
    return math.degrees(math.atan(needs.airspeed_m_s**2 / (_G_M_S2 * needs.turn_radius_m)))


def _bank_reason(needs: Needs) -> str:
    return f"turns of {needs.turn_radius_m:.0f} m at {needs.airspeed_m_s:g} m/s need {_bank_deg(needs):.0f}°"


def _corner_reason(needs: Needs) -> str:
    return (
        "waypoints count as reached from so far away that corners and arcs of"
        f" {needs.turn_radius_m:.0f} m are cut"
    )


def corners(name: str) -> Rule:
    """Waypoints are not passed too early."""
    return check(name, lambda value, needs: value <= _corner_m(needs) * _MARGIN, _corner_reason, _corner_m)


def _judge_switch(values: Values, needs: Needs) -> ParameterFinding | None:
    if not values.keys() >= set(_SWITCH):
        return None
    multiplier, period_s, damping = (values[name] for name in _SWITCH)
    each_m = needs.airspeed_m_s * period_s * damping
    if multiplier * each_m <= _corner_m(needs) * _MARGIN:
        return None
    advised = max(math.floor(100.0 * _corner_m(needs) / each_m) / 100.0, _LEAST_SWITCH)
    reason = (
        f"with NPFG_PERIOD {period_s:g} s and NPFG_DAMPING {damping:g} waypoints count as reached from"
        f" {multiplier * each_m:.0f} m away, so that corners and arcs of {needs.turn_radius_m:.0f} m are cut"
    )
    return ParameterFinding(_SWITCH[0], multiplier, advised, reason, "warning")


#: PX4's fixed wings pass waypoints from the greater of NAV_ACC_RAD and multiplier · speed · period · damping.
SWITCH_DISTANCE: Final = Rule(lambda needs: _SWITCH, _judge_switch)


def l1_period(name: str) -> Rule:
    """ArduPlane's guidance is tight enough for the turns and the straights of the plan."""
    return check(name, lambda value, needs: value <= _l1_period_s(needs) * _MARGIN, _l1_reason, _l1_period_s)


def speed(name: str) -> Rule:
    """The vehicle cruises as planned."""
    return check(
        name,
        lambda value, needs: abs(value - needs.airspeed_m_s) <= 0.1 * needs.airspeed_m_s,
        lambda needs: f"the plan is for {needs.airspeed_m_s:g} m/s, which a DO_CHANGE_SPEED item asks for",
        lambda needs: needs.airspeed_m_s,
    )


def bank(name: str) -> Rule:
    """The vehicle may bank as far as the plan's tightest turn needs."""
    return check(
        name,
        lambda value, needs: value >= _bank_deg(needs),
        _bank_reason,
        lambda needs: float(math.ceil(_bank_deg(needs) + 5.0)),
        "error",
    )


def loiter(name: str) -> Rule:
    """Holding and returning is not asked for in tighter circles than the plan flies; a sign is the side."""
    return check(
        name,
        lambda value, needs: abs(value) * _MARGIN >= needs.turn_radius_m,
        lambda needs: (
            f"holding and returning circle tighter than the plan's turns of {needs.turn_radius_m:.0f} m,"
            " and the aircraft will drift outside"
        ),
        lambda needs: float(math.ceil(needs.turn_radius_m)),
    )
