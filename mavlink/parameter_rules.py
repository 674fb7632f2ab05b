"""Parameters that must be right for a mission to be flown as planned. Read and reported; never set.

Each rule names the parameters it reads, says when it applies, and judges their values by what the plan needs.
``RULES`` is the table, by autopilot and type of vehicle.

Sources: ArduPlane 4.6 and PX4 1.16 parameter references; the tracking figures were measured on ArduPlane's
and PX4's simulators (docs/link.md).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Final, Literal

from mavlink.dialects import Autopilot, VehicleType
from mavlink.items import Command
from mavlink.mission import Mission
from mavlink.payload import (
    ActuatorPayload,
    CameraPayload,
    ImagePayload,
    Payload,
    RelayPayload,
    ServoPayload,
)
from planner.plan import Plan

Values = Mapping[str, float]

_G_M_S2: Final = 9.80665
#: An arc's points pass unseen when waypoints count as reached from farther than this part of its radius.
_RADIUS_PART: Final = 0.5
#: ArduPlane at 22.4 m/s on arcs of 100 m: period 10 s keeps lines within 2.2 m (p95), 15 s within 10.9 m.
_L1_TURNS: Final = 10.0 / (100.0 / 22.4)
_L1_BEST_S: Final = (8.0, 20.0)
#: The same flights at period 15 s: within 5 m of the line 130 m behind a turn.
_SETTLE_M_A_SECOND: Final = 130.0 / 15.0 / 22.4
_MARGIN: Final = 1.25
_APPROACH_SLOPE_DEG: Final = 4.0


@dataclass(frozen=True, slots=True)
class ParameterFinding:
    """One parameter that is not as the plan needs it.

    Parameters
    ----------
    value
        As the vehicle holds it.
    advised
        What would do; None where it depends on the wiring.
    reason
        Why, with the plan's figures.
    severity
        ``"error"``: the mission cannot be flown, or sees nothing. ``"warning"``: it is flown less well.
    """

    name: str
    value: float
    advised: float | None
    reason: str
    severity: Literal["error", "warning"]

    def __str__(self) -> str:
        advice = "" if self.advised is None else f"; {self.advised:g} is advised"
        return f"{self.name} is {self.value:g}: {self.reason}{advice}"


@dataclass(frozen=True, slots=True)
class Needs:
    """What a mission needs of its vehicle.

    Parameters
    ----------
    settle_m
        Straight flight the plan leaves before each collect; None when not known.
    payload
        How the sensor is switched, as the autopilot switches it.
    commands
        Of the mission's items.
    """

    airspeed_m_s: float
    turn_radius_m: float
    settle_m: float | None
    payload: Payload
    commands: frozenset[int]
    fence: bool


def needs_of(plan: Plan, mission: Mission, payload: Payload, settle_m: float | None = None) -> Needs:
    """What a plan's mission needs."""
    vehicle = next(vehicle for vehicle in plan.vehicles if vehicle.name == mission.vehicle)
    if mission.autopilot == "px4" and isinstance(payload, RelayPayload):
        payload = ActuatorPayload(payload.relay + 1)  # as the encoder says it
    return Needs(
        vehicle.airspeed_m_s,
        vehicle.min_turn_radius_m,
        settle_m,
        payload,
        frozenset(item.command for item in mission.mission),
        bool(mission.fence),
    )


@dataclass(frozen=True, slots=True)
class Rule:
    """Parameters to read, and what to say of them.

    Parameters
    ----------
    names
        To read; those a firmware does not have are simply not there when it is judged.
    judge
        The finding, None when all is well or the values do not tell.
    applies
        Whether the mission needs it at all.
    """

    names: Callable[[Needs], tuple[str, ...]]
    judge: Callable[[Values, Needs], ParameterFinding | None]
    applies: Callable[[Needs], bool] = lambda needs: True


def names_to_read(autopilot: Autopilot, vehicle_type: VehicleType, needs: Needs) -> tuple[str, ...]:
    """Parameters to ask a vehicle for, in the order of the table."""
    names = (name for rule in _rules(autopilot, vehicle_type, needs) for name in rule.names(needs))
    return tuple(dict.fromkeys(names))


def judge_parameters(
    autopilot: Autopilot, vehicle_type: VehicleType, needs: Needs, values: Values
) -> tuple[ParameterFinding, ...]:
    """What is not as the mission needs it; parameters that were not read are not judged."""
    findings = (rule.judge(values, needs) for rule in _rules(autopilot, vehicle_type, needs))
    return tuple(finding for finding in findings if finding is not None)


def _rules(autopilot: Autopilot, vehicle_type: VehicleType, needs: Needs) -> tuple[Rule, ...]:
    rules = RULES[autopilot, "multirotor" if vehicle_type == "multirotor" else "fixed_wing"]
    return tuple(rule for rule in rules if rule.applies(needs))


def _check(
    name: str,
    good: Callable[[float, Needs], bool],
    reason: Callable[[Needs], str],
    advised: Callable[[Needs], float] | None = None,
    severity: Literal["error", "warning"] = "warning",
    applies: Callable[[Needs], bool] = lambda needs: True,
) -> Rule:
    """A rule about one parameter."""

    def judge(values: Values, needs: Needs) -> ParameterFinding | None:
        value = values.get(name)
        if value is None or good(value, needs):
            return None
        advice = None if advised is None else advised(needs)
        return ParameterFinding(name, value, advice, reason(needs), severity)

    return Rule(lambda needs: (name,), judge, applies)


def _any(
    names: Callable[[Needs], tuple[str, ...]],
    good: Callable[[float, Needs], bool],
    reason: Callable[[Needs], str],
    applies: Callable[[Needs], bool],
) -> Rule:
    """A rule that one of several parameters must meet; it speaks only when some were read."""

    def judge(values: Values, needs: Needs) -> ParameterFinding | None:
        found = [(name, values[name]) for name in names(needs) if name in values]
        if not found or any(good(value, needs) for _, value in found):
            return None
        name, value = found[0]
        return ParameterFinding(name, value, None, reason(needs), "error")

    return Rule(names, judge, applies)


def _camera(needs: Needs) -> bool:
    return isinstance(needs.payload, (CameraPayload, ImagePayload))


def _lands(needs: Needs) -> bool:
    return bool(needs.commands & {Command.NAV_LAND, Command.NAV_VTOL_LAND})


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


def _speed(name: str) -> Rule:
    return _check(
        name,
        lambda value, needs: abs(value - needs.airspeed_m_s) <= 0.1 * needs.airspeed_m_s,
        lambda needs: f"the plan is for {needs.airspeed_m_s:g} m/s, which a DO_CHANGE_SPEED item asks for",
        lambda needs: needs.airspeed_m_s,
    )


def _bank(name: str) -> Rule:
    return _check(
        name,
        lambda value, needs: value >= _bank_deg(needs),
        _bank_reason,
        lambda needs: float(math.ceil(_bank_deg(needs) + 5.0)),
        "error",
    )


def _relay_names(needs: Needs) -> tuple[str, ...]:
    assert isinstance(needs.payload, RelayPayload)
    number = needs.payload.relay + 1
    return (f"RELAY{number}_FUNCTION",)


def _servo_names(needs: Needs) -> tuple[str, ...]:
    assert isinstance(needs.payload, ServoPayload)
    return (f"SERVO{needs.payload.servo}_FUNCTION",)


def _actuator_number(needs: Needs) -> int:
    return needs.payload.actuator if isinstance(needs.payload, ActuatorPayload) else 0


_SHUTTERS: Final = tuple(f"SERVO{number}_FUNCTION" for number in range(1, 17))
_PX4_OUTPUTS: Final = tuple(
    f"{group}_FUNC{number}"
    for group, count in (("PWM_MAIN", 8), ("PWM_AUX", 8))
    for number in range(1, count + 1)
)

_ARDUPILOT_PAYLOAD: Final = (
    _check(
        "CAM1_TYPE",
        lambda value, needs: value > 0,
        lambda needs: "without a camera driver the trigger items are accepted and nothing is taken",
        lambda needs: 1.0,
        "error",
        _camera,
    ),
    _any(
        lambda needs: _SHUTTERS,
        lambda value, needs: round(value) == 10,
        lambda needs: "no output has function 10 (camera trigger), which CAM1_TYPE 1 (servo) needs",
        _camera,
    ),
    _any(
        _servo_names,
        lambda value, needs: round(value) in (0, 1) or 51 <= value <= 66,
        lambda needs: "an output with a function of its own does not obey DO_SET_SERVO; 0 does",
        lambda needs: isinstance(needs.payload, ServoPayload),
    ),
    _any(
        _relay_names,
        lambda value, needs: round(value) == 1,
        lambda needs: "the relay that switches the sensor is no relay; 1 makes it one, RELAYx_PIN says where",
        lambda needs: isinstance(needs.payload, RelayPayload),
    ),
)

_ARDUPILOT_FENCE: Final = (
    _check(
        "FENCE_ENABLE",
        lambda value, needs: value > 0,
        lambda needs: "the plan's fence is stored, but it is not in force",
        lambda needs: 1.0,
        applies=lambda needs: needs.fence,
    ),
    _check(
        "FENCE_TYPE",
        lambda value, needs: bool(round(value) & 4),
        lambda needs: "polygons and circles (4) are not among the fences in force",
        lambda needs: 7.0,
        applies=lambda needs: needs.fence,
    ),
    _check(
        "FENCE_ACTION",
        lambda value, needs: value > 0,
        lambda needs: "leaving the fence is only reported",
        lambda needs: 1.0,
        applies=lambda needs: needs.fence,
    ),
)

_PX4_COMMON: Final = (
    _check(
        "GF_ACTION",
        lambda value, needs: value > 0,
        lambda needs: "leaving the plan's fence has no consequence",
        lambda needs: 3.0,
        applies=lambda needs: needs.fence,
    ),
    _check(
        "TRIG_MODE",
        lambda value, needs: round(value) == 4,
        lambda needs: "distance triggers need mode 4 (set before start-up), else nothing is taken",
        lambda needs: 4.0,
        "error",
        lambda needs: isinstance(needs.payload, CameraPayload),
    ),
    _any(
        lambda needs: _PX4_OUTPUTS,
        lambda value, needs: round(value) == 300 + _actuator_number(needs),
        lambda needs: (
            f"no output has function {300 + _actuator_number(needs)} (actuator set "
            f"{_actuator_number(needs)}), which switches the sensor"
        ),
        lambda needs: isinstance(needs.payload, ActuatorPayload),
    ),
    _check(
        "COM_DISARM_PRFLT",
        lambda value, needs: value <= 0 or value >= 5.0,
        lambda needs: "the vehicle disarms again before a start can be ordered",
        lambda needs: 10.0,
    ),
    _check(
        "COM_DISARM_LAND",
        lambda value, needs: value > 0,
        lambda needs: "the vehicle stays armed after landing, and the flight's record does not end",
        lambda needs: 2.0,
        applies=_lands,
    ),
)


def _landing_required(value: float, needs: Needs) -> bool:
    takes_off = bool(needs.commands & {Command.NAV_TAKEOFF, Command.NAV_VTOL_TAKEOFF})
    match round(value):
        case 1:
            return takes_off
        case 2:
            return _lands(needs)
        case 3:
            return takes_off and _lands(needs)
        case 4:
            return takes_off == _lands(needs)
    return True


_PX4_LANDING: Final = _check(
    "MIS_TKO_LAND_REQ",
    _landing_required,
    lambda needs: "the mission has not the take-off and landing items required; PX4 will not fly it",
    lambda needs: 0.0,
    "error",
)

#: Rules by autopilot and type of vehicle; a VTOL is judged as the fixed wing it is between the regions.
RULES: Final[dict[tuple[Autopilot, VehicleType], tuple[Rule, ...]]] = {
    ("ardupilot", "fixed_wing"): (
        _check(
            "WP_RADIUS",
            lambda value, needs: value <= _corner_m(needs) * _MARGIN,
            lambda needs: (
                "waypoints count as reached from so far away that corners and arcs of"
                f" {needs.turn_radius_m:.0f} m are cut"
            ),
            _corner_m,
        ),
        _check(
            "NAVL1_PERIOD",
            lambda value, needs: value <= _l1_period_s(needs) * _MARGIN,
            _l1_reason,
            _l1_period_s,
        ),
        _speed("AIRSPEED_CRUISE"),
        _bank("ROLL_LIMIT_DEG"),
        _check(
            "RTL_AUTOLAND",
            lambda value, needs: value > 0,
            lambda needs: "with DO_LAND_START in the mission the vehicle refuses to arm",
            lambda needs: 2.0,
            "error",
            lambda needs: Command.DO_LAND_START in needs.commands,
        ),
        *_ARDUPILOT_FENCE,
        *_ARDUPILOT_PAYLOAD,
    ),
    ("ardupilot", "multirotor"): (*_ARDUPILOT_FENCE, *_ARDUPILOT_PAYLOAD),
    ("px4", "fixed_wing"): (
        _check(
            "NAV_ACC_RAD",
            lambda value, needs: value <= _corner_m(needs) * _MARGIN,
            lambda needs: (
                "waypoints count as reached from so far away that corners and arcs of"
                f" {needs.turn_radius_m:.0f} m are cut"
            ),
            _corner_m,
        ),
        _check(
            "NPFG_PERIOD",
            lambda value, needs: value <= 12.0,
            lambda needs: "at 20 s lines are held within 3.3 m (p95) instead of 1.4 m at 10 s",
            lambda needs: 10.0,
        ),
        _speed("FW_AIRSPD_TRIM"),
        _bank("FW_R_LIM"),
        _check(
            "FW_LND_ANG",
            lambda value, needs: value >= _APPROACH_SLOPE_DEG,
            lambda needs: (
                f"the approach of {_APPROACH_SLOPE_DEG:g}° is steeper; PX4 will not fly the mission"
            ),
            lambda needs: 5.0,
            "error",
            _lands,
        ),
        _PX4_LANDING,
        *_PX4_COMMON,
    ),
    ("px4", "multirotor"): (_PX4_LANDING, *_PX4_COMMON),
}
