"""PX4's rules, version 1.16: fixed wings and multirotors."""

from __future__ import annotations

from typing import Final

from mavlink.items import Command
from mavlink.payload import ActuatorPayload, CameraPayload
from mavlink.rules.base import Needs, Rule, any_of, check, lands
from mavlink.rules.flight import SWITCH_DISTANCE, bank, corners, loiter, speed

_APPROACH_SLOPE_DEG: Final = 4.0


def _actuator_number(needs: Needs) -> int:
    return needs.payload.actuator if isinstance(needs.payload, ActuatorPayload) else 0


_OUTPUTS: Final = tuple(
    f"{group}_FUNC{number}"
    for group, count in (("PWM_MAIN", 8), ("PWM_AUX", 8))
    for number in range(1, count + 1)
)

_COMMON: Final = (
    check(
        "GF_ACTION",
        lambda value, needs: value > 0,
        lambda needs: "leaving the plan's fence has no consequence",
        lambda needs: 3.0,
        applies=lambda needs: needs.fence,
    ),
    check(
        "TRIG_MODE",
        lambda value, needs: round(value) == 4,
        lambda needs: "distance triggers need mode 4 (set before start-up), else nothing is taken",
        lambda needs: 4.0,
        "error",
        lambda needs: isinstance(needs.payload, CameraPayload),
    ),
    any_of(
        lambda needs: _OUTPUTS,
        lambda value, needs: round(value) == 300 + _actuator_number(needs),
        lambda needs: (
            f"no output has function {300 + _actuator_number(needs)} (actuator set "
            f"{_actuator_number(needs)}), which switches the sensor"
        ),
        lambda needs: isinstance(needs.payload, ActuatorPayload),
    ),
    check(
        "COM_DISARM_PRFLT",
        lambda value, needs: value <= 0 or value >= 5.0,
        lambda needs: "the vehicle disarms again before a start can be ordered",
        lambda needs: 10.0,
    ),
    check(
        "COM_DISARM_LAND",
        lambda value, needs: value > 0,
        lambda needs: "the vehicle stays armed after landing, and the flight's record does not end",
        lambda needs: 2.0,
        applies=lands,
    ),
)


def _landing_required(value: float, needs: Needs) -> bool:
    takes_off = bool(needs.commands & {Command.NAV_TAKEOFF, Command.NAV_VTOL_TAKEOFF})
    match round(value):
        case 1:
            return takes_off
        case 2:
            return lands(needs)
        case 3:
            return takes_off and lands(needs)
        case 4:
            return takes_off == lands(needs)
    return True


_LANDING: Final = check(
    "MIS_TKO_LAND_REQ",
    _landing_required,
    lambda needs: "the mission has not the take-off and landing items required; PX4 will not fly it",
    lambda needs: 0.0,
    "error",
)

_PERIOD: Final = check(
    "NPFG_PERIOD",
    lambda value, needs: value <= 12.0,
    lambda needs: "at 20 s lines are held within 3.3 m (p95) instead of 1.4 m at 10 s",
    lambda needs: 10.0,
)
_SLOPE: Final = check(
    "FW_LND_ANG",
    lambda value, needs: value >= _APPROACH_SLOPE_DEG,
    lambda needs: f"the approach of {_APPROACH_SLOPE_DEG:g}° is steeper; PX4 will not fly the mission",
    lambda needs: 5.0,
    "error",
    lands,
)

FIXED_WING: Final[tuple[Rule, ...]] = (
    corners("NAV_ACC_RAD"),
    SWITCH_DISTANCE,
    _PERIOD,
    speed("FW_AIRSPD_TRIM"),
    bank("FW_R_LIM"),
    loiter("NAV_LOITER_RAD"),
    _SLOPE,
    _LANDING,
    *_COMMON,
)
MULTIROTOR: Final[tuple[Rule, ...]] = (_LANDING, *_COMMON)
