"""Flight modes of the simulated aircraft and the numbers each autopilot has for them.

Source: ArduPlane and ArduCopter ``Mode::Number``; PX4 ``px4_custom_mode.h`` (main mode in bits 16-23, sub
mode in 24-31).
"""

from __future__ import annotations

from enum import Enum, StrEnum


class Flavour(StrEnum):
    """Whose manners the vehicle side has."""

    ARDUPILOT = "ardupilot"
    PX4 = "px4"


class Mode(Enum):
    """What the aircraft is doing. ``MANUAL`` flies nothing by itself: on the ground it stays there."""

    MANUAL = "MANUAL"
    AUTO = "AUTO"
    LOITER = "LOITER"
    RTL = "RTL"
    GUIDED = "GUIDED"
    BRAKE = "BRAKE"
    LAND = "LAND"
    TAKEOFF = "TAKEOFF"


_PX4_MANUAL = 1
_PX4_AUTO = 4
_PX4_SUB_TAKEOFF = 2
_PX4_SUB_LOITER = 3
_PX4_SUB_MISSION = 4
_PX4_SUB_RTL = 5
_PX4_SUB_LAND = 6

_ARDUPLANE = {Mode.MANUAL: 0, Mode.AUTO: 10, Mode.RTL: 11, Mode.LOITER: 12, Mode.GUIDED: 15}
_ARDUCOPTER = {
    # Stabilize: what it starts in.
    Mode.MANUAL: 0,
    Mode.AUTO: 3,
    Mode.GUIDED: 4,
    Mode.LOITER: 5,
    Mode.RTL: 6,
    Mode.LAND: 9,
    Mode.BRAKE: 17,
}
_PX4 = {
    Mode.MANUAL: (_PX4_MANUAL, 0),
    Mode.AUTO: (_PX4_AUTO, _PX4_SUB_MISSION),
    Mode.LOITER: (_PX4_AUTO, _PX4_SUB_LOITER),
    Mode.RTL: (_PX4_AUTO, _PX4_SUB_RTL),
    # PX4 flies DO_REPOSITION in its Hold mode.
    Mode.GUIDED: (_PX4_AUTO, _PX4_SUB_LOITER),
    Mode.TAKEOFF: (_PX4_AUTO, _PX4_SUB_TAKEOFF),
    Mode.LAND: (_PX4_AUTO, _PX4_SUB_LAND),
}


def custom_mode(flavour: Flavour, mode: Mode, *, hovers: bool = False) -> int:
    """``custom_mode`` of HEARTBEAT for a mode; KeyError for one this aircraft has not."""
    if flavour is Flavour.ARDUPILOT:
        return (_ARDUCOPTER if hovers else _ARDUPLANE)[mode]
    main, sub = _PX4[mode]
    return main << 16 | sub << 24


def mode_of(flavour: Flavour, custom: int, *, hovers: bool = False) -> Mode | None:
    """Mode of SET_MODE's ``custom_mode``; None for modes that are not simulated."""
    if flavour is Flavour.ARDUPILOT:
        known = _ARDUCOPTER if hovers else _ARDUPLANE
        return next((mode for mode, number in known.items() if number == custom), None)
    numbers = {main << 16 | sub << 24: mode for mode, (main, sub) in reversed(_PX4.items())}
    return numbers.get(custom)


def mode_of_command(flavour: Flavour, param2: float, param3: float, *, hovers: bool = False) -> Mode | None:
    """Mode of DO_SET_MODE: ArduPilot's number in param 2; PX4's main and sub mode in params 2 and 3."""
    if flavour is Flavour.ARDUPILOT:
        return mode_of(flavour, int(param2), hovers=hovers)
    return mode_of(flavour, int(param2) << 16 | int(param3) << 24, hovers=hovers)
