"""Rules on the gimbal: that there is one, that it listens, that it reaches where it is to point.

Sources: ArduPilot's MNT1_ and MNT2_ parameters; PX4 1.16's MNT_ parameters and ``modules/gimbal``, which
holds the angles of servos and of gimbals of protocol v1 within half of each range.
"""

from __future__ import annotations

import math
from typing import Final

from mavlink.rules.base import OTHER_NAMES, Needs, ParameterFinding, Rule, Values

#: MNT_MODE_IN: no driver, both, remote control, and protocol v1's regions of interest and mounts; then v2.
_PX4_MANAGER_IN: Final = (0, 4)
_PX4_MOUNT_IN: Final = (0, 3, 4)
#: MNT_MODE_OUT from here on leaves the limits to the gimbal itself.
_PX4_OWN_LIMITS: Final = 2


def _applies(needs: Needs) -> bool:
    return needs.gimbal is not None


def _prefix(needs: Needs) -> str:
    assert needs.gimbal is not None
    return f"MNT{max(1, needs.gimbal.device)}"


def _judge_type(values: Values, needs: Needs) -> ParameterFinding | None:
    name = f"{_prefix(needs)}_TYPE"
    if name not in values and name in OTHER_NAMES:
        name = OTHER_NAMES[name][0]
    if values.get(name, 1.0) > 0:
        return None
    reason = "no gimbal is set up: the items that point it are accepted and nothing turns"
    return ParameterFinding(name, values[name], None, reason, "error")


def _ardupilot_limit(suffix: str) -> Rule:
    """One end of the pitch's or yaw's range, against all that is to be pointed at."""

    def names(needs: Needs) -> tuple[str, ...]:
        return (f"{_prefix(needs)}_{suffix}",)

    def judge(values: Values, needs: Needs) -> ParameterFinding | None:
        assert needs.gimbal is not None
        (name,) = names(needs)
        if name not in values:
            return None
        yaw, highest = suffix.startswith("YAW"), suffix.endswith("MAX")
        angles = needs.gimbal.yaws_deg if yaw else (needs.gimbal.pitch_deg,)
        wanted_deg = max(angles) if highest else min(angles)
        limit_deg = values[name]
        if limit_deg >= wanted_deg if highest else limit_deg <= wanted_deg:
            return None
        advised = math.ceil(wanted_deg) if highest else math.floor(wanted_deg)
        reason = f"a pass needs the gimbal at a {'yaw' if yaw else 'pitch'} of {wanted_deg:g}°"
        return ParameterFinding(name, limit_deg, float(advised), reason, "error")

    return Rule(names, judge, _applies)


def _judge_input(values: Values, needs: Needs) -> ParameterFinding | None:
    assert needs.gimbal is not None
    value = values.get("MNT_MODE_IN")
    listened = _PX4_MOUNT_IN if needs.gimbal.protocol == "mount" else _PX4_MANAGER_IN
    if value is None or round(value) in listened:
        return None
    reason = (
        "no gimbal driver runs" if value < 0 else "the gimbal's driver does not listen to the mission's items"
    )
    return ParameterFinding("MNT_MODE_IN", value, 4.0, f"{reason} (set before start-up)", "error")


def _px4_range(name: str, words: str) -> Rule:
    """A servo's range, half of it to either side, where PX4 itself turns the gimbal."""

    def judge(values: Values, needs: Needs) -> ParameterFinding | None:
        assert needs.gimbal is not None
        range_deg, output = values.get(name), values.get("MNT_MODE_OUT")
        if range_deg is None or output is None or round(output) >= _PX4_OWN_LIMITS:
            return None
        angles = (needs.gimbal.pitch_deg,) if name.endswith("PITCH") else needs.gimbal.yaws_deg
        wanted_deg = 2.0 * max(abs(angle) for angle in angles)
        if range_deg >= wanted_deg:
            return None
        reason = (
            f"the gimbal turns {range_deg / 2.0:g}° {words} at most, {wanted_deg / 2.0:g}° are needed"
            f" (MNT_MODE_OUT {output:g})"
        )
        return ParameterFinding(name, range_deg, float(math.ceil(wanted_deg)), reason, "error")

    return Rule(lambda needs: (name, "MNT_MODE_OUT"), judge, _applies)


ARDUPILOT: Final = (
    Rule(lambda needs: (f"{_prefix(needs)}_TYPE",), _judge_type, _applies),
    _ardupilot_limit("PITCH_MIN"),
    _ardupilot_limit("PITCH_MAX"),
    _ardupilot_limit("YAW_MIN"),
    _ardupilot_limit("YAW_MAX"),
)
PX4: Final = (
    Rule(lambda needs: ("MNT_MODE_IN",), _judge_input, _applies),
    _px4_range("MNT_RANGE_PITCH", "up and down"),
    _px4_range("MNT_RANGE_YAW", "to either side"),
)
