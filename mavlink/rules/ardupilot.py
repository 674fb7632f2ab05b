"""ArduPilot's rules: ArduPlane 4.6 and ArduCopter; the names of 4.4 and before are known too."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Final

from mavlink.encoding.payload import RelayPayload, ServoPayload
from mavlink.rules import whole_flight
from mavlink.rules.base import Needs, ParameterFinding, Rule, Values, any_of, check, lands, part_of
from mavlink.rules.camera import ARDUPILOT as CAMERA
from mavlink.rules.flight import bank, corners, l1_period, loiter, speed
from mavlink.rules.gimbal import ARDUPILOT as GIMBAL
from mavlink.wire.items import Command


def _relay_names(needs: Needs) -> tuple[str, ...]:
    relay = part_of(needs, RelayPayload)
    return () if relay is None else (f"RELAY{relay.relay + 1}_FUNCTION",)


def _servo_names(needs: Needs) -> tuple[str, ...]:
    servo = part_of(needs, ServoPayload)
    return () if servo is None else (f"SERVO{servo.servo}_FUNCTION",)


#: FENCE_TYPE's bits: a greatest height, a circle round home, the fences uploaded; 8 is a least height.
_HEIGHT_FENCE: Final = 1
_HOME_FENCE: Final = 2
_DRAWN_FENCES: Final = 4
#: Fences that are the vehicle's own lie at least this far outside the mission, or it turns back on its way.
_FENCE_ROOM_M: Final = 20.0

_PAYLOAD: Final = (
    any_of(
        _servo_names,
        lambda value, needs: round(value) in (0, 1) or 51 <= value <= 66,
        lambda needs: "an output with a function of its own does not obey DO_SET_SERVO; 0 does",
        lambda needs: part_of(needs, ServoPayload) is not None,
    ),
    any_of(
        _relay_names,
        lambda value, needs: round(value) == 1,
        lambda needs: "the relay that switches the sensor is no relay; 1 makes it one, RELAYx_PIN says where",
        lambda needs: part_of(needs, RelayPayload) is not None,
    ),
)


def _judge_fence_type(values: Values, needs: Needs) -> ParameterFinding | None:
    """Advises the kinds in force and the plan's: a height or a circle nobody set would end the flight."""
    kinds = round(values.get("FENCE_TYPE", _DRAWN_FENCES))
    if kinds & _DRAWN_FENCES:
        return None
    reason = f"polygons and circles ({_DRAWN_FENCES}) are not among the fences in force"
    return ParameterFinding("FENCE_TYPE", float(kinds), float(kinds | _DRAWN_FENCES), reason, "warning")


def _own_fence(name: str, kind: int, reach_m: Callable[[Needs], float], words: str) -> Rule:
    """A fence of the vehicle's own that the mission would breach, where its kind is in force."""

    def judge(values: Values, needs: Needs) -> ParameterFinding | None:
        limit_m, kinds = values.get(name), values.get("FENCE_TYPE")
        if limit_m is None or kinds is None or not round(kinds) & kind:
            return None
        wanted_m = reach_m(needs) + _FENCE_ROOM_M
        if limit_m >= wanted_m:
            return None
        reason = (
            f"the mission goes {reach_m(needs):.0f} m {words}; FENCE_TYPE {kinds:g} has this limit in force"
        )
        enabled = values.get("FENCE_ENABLE", 0.0) > 0.0
        return ParameterFinding(
            name, limit_m, float(math.ceil(wanted_m)), reason, "error" if enabled else "warning"
        )

    return Rule(lambda needs: (name, "FENCE_TYPE", "FENCE_ENABLE"), judge)


#: The approach is 1.5 times as long as it takes to stop at 2 m/s²; 0.75 of that distance are wanted.
_LEAST_BRAKING_M_S2: Final = 0.75 * 2.0 / 1.5

_FENCE: Final = (
    _own_fence("FENCE_ALT_MAX", _HEIGHT_FENCE, lambda needs: needs.highest_m, "above home"),
    _own_fence("FENCE_RADIUS", _HOME_FENCE, lambda needs: needs.farthest_m, "from home"),
    check(
        "FENCE_ENABLE",
        lambda value, needs: value > 0,
        lambda needs: "the plan's fence is stored, but it is not in force",
        lambda needs: 1.0,
        applies=lambda needs: needs.fence,
    ),
    Rule(lambda needs: ("FENCE_TYPE",), _judge_fence_type, lambda needs: needs.fence),
    check(
        "FENCE_ACTION",
        lambda value, needs: value > 0,
        lambda needs: "leaving the fence is only reported",
        lambda needs: 1.0,
        applies=lambda needs: needs.fence,
    ),
)

_AUTOLAND: Final = check(
    "RTL_AUTOLAND",
    lambda value, needs: value > 0,
    lambda needs: "with DO_LAND_START in the mission the vehicle refuses to arm",
    lambda needs: 2.0,
    "error",
    lambda needs: Command.DO_LAND_START in needs.commands,
)

PLANE: Final[tuple[Rule, ...]] = (
    corners("WP_RADIUS"),
    l1_period("NAVL1_PERIOD"),
    speed("AIRSPEED_CRUISE"),
    bank("ROLL_LIMIT_DEG"),
    loiter("WP_LOITER_RAD"),
    *whole_flight.PLANE,
    _AUTOLAND,
    *_FENCE,
    *_PAYLOAD,
    *CAMERA,
    *GIMBAL,
)
VTOL: Final[tuple[Rule, ...]] = (
    *PLANE,
    check(
        "Q_ENABLE",
        lambda value, needs: value > 0,
        lambda needs: "it has no rotors to take off with: what hovers in the mission is not flown",
        lambda needs: 1.0,
        "error",
    ),
    check(
        "Q_TRANS_DECEL",
        lambda value, needs: value >= _LEAST_BRAKING_M_S2,
        lambda needs: "the approach is under 0.75 of its stopping distance, and the vehicle refuses to arm",
        lambda needs: 2.0,
        "error",
        lands,
    ),
)
COPTER: Final[tuple[Rule, ...]] = (*whole_flight.COPTER, *_FENCE, *_PAYLOAD, *CAMERA, *GIMBAL)
