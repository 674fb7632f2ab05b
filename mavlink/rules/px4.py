"""PX4's rules, version 1.16: fixed wings, VTOLs and multirotors."""

from __future__ import annotations

import math
from typing import Final

from mavlink.encoding.payload import ActuatorPayload
from mavlink.rules import whole_flight
from mavlink.rules.base import Needs, ParameterFinding, Rule, Values, check, lands, part_of
from mavlink.rules.camera import PX4 as CAMERA
from mavlink.rules.flight import SWITCH_DISTANCE, bank, corners, loiter, speed
from mavlink.rules.gimbal import PX4 as GIMBAL
from mavlink.state.outputs import px4_outputs
from mavlink.wire.items import Command

_APPROACH_SLOPE_DEG: Final = 4.0
_APPROACH_M: Final = 40.0
#: A VTOL's approach is 1.5 times as long as it takes to stop at 2 m/s².
_BRAKING_M_S2: Final = 2.0 / 1.5
#: Functions of outputs that missions can set: Peripheral via Actuator Set 1 to 4.
_ACTUATORS: Final = range(301, 305)


def _judge_output(values: Values, needs: Needs) -> ParameterFinding | None:
    """Whether an output follows the actuator that switches the sensor; the named one, where one is."""
    payload = part_of(needs, ActuatorPayload)
    if payload is None:
        return None
    found = [
        (output.function_parameter, values[output.function_parameter])
        for output in px4_outputs(payload)
        if output.function_parameter in values
    ]
    if not found or any(round(value) == payload.function for _, value in found):
        return None
    name, value = found[0]
    actuator = f"actuator set {payload.actuator}, which switches the sensor"
    if payload.output is None:
        reason = f"no output has function {payload.function} ({actuator})"
        return ParameterFinding(name, value, None, reason, "error")
    reason = f"output {payload.output} does not follow {actuator}"
    if round(value) in _ACTUATORS:
        group, number, other = payload.output.group, payload.output.number, round(value) - _ACTUATORS[0] + 1
        reason += f", but set {other}: plan with {group}:{number}:{other}, or change the vehicle"
    elif round(value):
        reason += ": it is in use for something else"
    return ParameterFinding(name, value, float(payload.function), reason, "error")


def _outputs(needs: Needs) -> tuple[str, ...]:
    payload = part_of(needs, ActuatorPayload)
    return () if payload is None else tuple(output.function_parameter for output in px4_outputs(payload))


_COMMON: Final = (
    check(
        "GF_ACTION",
        lambda value, needs: value > 0,
        lambda needs: "leaving the plan's fence has no consequence",
        lambda needs: 3.0,
        applies=lambda needs: needs.fence,
    ),
    Rule(_outputs, _judge_output, lambda needs: part_of(needs, ActuatorPayload) is not None),
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
    *CAMERA,
    *GIMBAL,
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

_WINGS: Final = (
    corners("NAV_ACC_RAD"),
    SWITCH_DISTANCE,
    _PERIOD,
    speed("FW_AIRSPD_TRIM"),
    bank("FW_R_LIM"),
    loiter("NAV_LOITER_RAD"),
    *whole_flight.PX4_WINGS,
    _LANDING,
)
_TRANSITION: Final = (
    check(
        "VT_ARSP_TRANS",
        lambda value, needs: value <= needs.airspeed_m_s,
        lambda needs: (
            "the transition to flight on wings ends at this airspeed, above the plan's"
            f" {needs.airspeed_m_s:g} m/s"
        ),
        lambda needs: float(math.floor(needs.airspeed_m_s)),
    ),
    check(
        "VT_FW_MIN_ALT",
        lambda value, needs: value < _APPROACH_M,
        lambda needs: f"it would fall back to hovering on its approach, {_APPROACH_M:g} m over the ground",
        lambda needs: 0.0,
        "error",
        lands,
    ),
    check(
        "VT_B_DEC_MSS",
        lambda value, needs: value >= _BRAKING_M_S2,
        lambda needs: "the approach is too short for it to stop in, and it overshoots the landing's place",
        lambda needs: 2.0,
        applies=lands,
    ),
)

FIXED_WING: Final[tuple[Rule, ...]] = (*_WINGS, _SLOPE, *_COMMON)
VTOL: Final[tuple[Rule, ...]] = (*_WINGS, *_TRANSITION, *_COMMON)
MULTIROTOR: Final[tuple[Rule, ...]] = (*whole_flight.PX4_MULTIROTOR, _LANDING, *_COMMON)
