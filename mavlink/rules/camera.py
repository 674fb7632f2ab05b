"""What cameras need of their autopilot: a driver, an output, and to be quick enough.

Source: ArduPilot ``AP_Camera_Params.cpp`` and ``AP_Camera.cpp``, PX4 ``camera_trigger_params.c``,
``camera_capture_params.c`` and ``output_functions.yaml``.
"""

from __future__ import annotations

from typing import Final

from mavlink.encoding.payload import PX4_OUTPUTS, CameraPayload, ImagePayload, TriggerPayload
from mavlink.rules.base import Needs, ParameterFinding, Rule, Values, check, parts

#: CAM1_TYPE 1: a servo, and the function of its output.
_SERVO, _SHUTTER = 1, 10
_SHUTTERS: Final = tuple(f"SERVO{number}_FUNCTION" for number in range(1, 17))
#: Types whose driver only closes a contact.
_CONTACTS: Final = (1, 2)
#: On a pass it rolls less than this; what is held level keeps photos waiting below.
_LEAST_ROLL_DEG: Final = 15.0
#: TRIG_INTERFACE 3 tells a camera by MAVLink; all others need an output with this function.
_BY_MAVLINK, _TRIGGER, _CAPTURE = 3, 2000.0, 2032.0
_PX4_OUTPUTS: Final = tuple(
    f"PWM_{group.upper()}_FUNC{number}"
    for group, count in PX4_OUTPUTS.items()
    for number in range(1, count + 1)
)


def by_distance(needs: Needs) -> bool:
    """Whether the autopilot releases a shutter by distance."""
    return any(
        isinstance(part, CameraPayload) or (isinstance(part, TriggerPayload) and part.by == "distance")
        for part in parts(needs)
    )


def triggered(needs: Needs) -> bool:
    """Whether the sensor is triggered as a camera."""
    return any(isinstance(part, (CameraPayload, ImagePayload, TriggerPayload)) for part in parts(needs))


def _video(needs: Needs) -> bool:
    return any(isinstance(part, TriggerPayload) and part.by == "video" for part in parts(needs))


def _photos(needs: Needs) -> bool:
    return triggered(needs) and needs.photo_s is not None


def _photo_s(needs: Needs) -> float:
    return needs.photo_s or 0.0


def _judge_shutter(values: Values, needs: Needs) -> ParameterFinding | None:
    """An output that moves the shutter, for a camera on a servo."""
    found = [(name, values[name]) for name in _SHUTTERS if name in values]
    kind = round(values.get("CAM1_TYPE", _SERVO))
    if kind != _SERVO or not found or any(round(value) == _SHUTTER for _, value in found):
        return None
    name, value = found[0]
    reason = f"no output has function {_SHUTTER} (camera trigger), which CAM1_TYPE {_SERVO} (servo) needs"
    return ParameterFinding(name, value, None, reason, "error")


ARDUPILOT: Final = (
    check(
        "CAM1_TYPE",
        lambda value, needs: value > 0,
        lambda needs: "without a camera driver the trigger items are accepted and nothing is taken",
        lambda needs: 1.0,
        "error",
        triggered,
    ),
    check(
        "CAM1_TYPE",
        lambda value, needs: round(value) not in _CONTACTS,
        lambda needs: "a contact on a servo or relay takes photos and no video",
        lambda needs: 6.0,
        "error",
        _video,
    ),
    Rule(lambda needs: ("CAM1_TYPE", *_SHUTTERS), _judge_shutter, triggered),
    check(
        "CAM1_INTRVAL_MIN",
        lambda value, needs: value <= _photo_s(needs),
        lambda needs: f"photos are ordered {_photo_s(needs):.2f} s apart: they come late, and too far apart",
        lambda needs: 0.0,
        "error",
        _photos,
    ),
    check(
        "CAM1_TRIGG_DIST",
        lambda value, needs: value <= 0.0,
        lambda needs: "photos are taken from the start on, on the way to the first pass too",
        lambda needs: 0.0,
        applies=triggered,
    ),
    check(
        "CAM_AUTO_ONLY",
        lambda value, needs: value > 0,
        lambda needs: "a return in a pass takes photos all the way, until the sensor is ordered off",
        lambda needs: 1.0,
        applies=by_distance,
    ),
    check(
        "CAM_MAX_ROLL",
        lambda value, needs: value <= 0.0 or value >= _LEAST_ROLL_DEG,
        lambda needs: "photos by distance wait while it rolls more than this",
        lambda needs: 0.0,
        applies=by_distance,
    ),
)


def _judge_trigger_output(values: Values, needs: Needs) -> ParameterFinding | None:
    kind = values.get("TRIG_INTERFACE")
    found = [values[name] for name in _PX4_OUTPUTS if name in values]
    if kind is None or round(kind) == _BY_MAVLINK or not found or _TRIGGER in found:
        return None
    reason = (
        f"no output has function {_TRIGGER:.0f} (camera trigger): nothing releases the camera;"
        f" {_BY_MAVLINK} releases one that listens to MAVLink"
    )
    return ParameterFinding("TRIG_INTERFACE", kind, None, reason, "error")


def _judge_capture_input(values: Values, needs: Needs) -> ParameterFinding | None:
    told = values.get("CAM_CAP_FBACK")
    found = [values[name] for name in _PX4_OUTPUTS if name in values]
    if told is None or told < 1 or not found or _CAPTURE in found:
        return None
    reason = (
        f"photos count by the camera's contact alone, and nothing has function {_CAPTURE:.0f} (camera"
        " capture): no photo would be told of"
    )
    return ParameterFinding("CAM_CAP_FBACK", told, 0.0, reason, "error")


PX4: Final = (
    check(
        "TRIG_MODE",
        lambda value, needs: round(value) == 4,
        lambda needs: "distance triggers need mode 4 (set before start-up), else nothing is taken",
        lambda needs: 4.0,
        "error",
        by_distance,
    ),
    check(
        "TRIG_MIN_INTERVA",
        lambda value, needs: value <= 1000.0 * _photo_s(needs),
        lambda needs: (
            f"photos are ordered {_photo_s(needs):.2f} s apart: those that come sooner are left out"
        ),
        lambda needs: 1.0,
        "error",
        lambda needs: by_distance(needs) and _photos(needs),
    ),
    Rule(lambda needs: ("TRIG_INTERFACE", *_PX4_OUTPUTS), _judge_trigger_output, by_distance),
    Rule(lambda needs: ("CAM_CAP_FBACK", *_PX4_OUTPUTS), _judge_capture_input, by_distance),
)
