"""Flight modes of the simulated aircraft and the numbers each autopilot has for them.

Source: ArduPlane ``Plane::Mode::Number``; PX4 ``px4_custom_mode.h`` (main mode in bits 16-23, sub mode in
24-31).
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


_PX4_MANUAL = 1
_PX4_AUTO = 4
_PX4_SUB_LOITER = 3
_PX4_SUB_MISSION = 4
_PX4_SUB_RTL = 5

_ARDUPLANE = {Mode.MANUAL: 0, Mode.AUTO: 10, Mode.RTL: 11, Mode.LOITER: 12, Mode.GUIDED: 15}
_PX4 = {
    Mode.MANUAL: (_PX4_MANUAL, 0),
    Mode.AUTO: (_PX4_AUTO, _PX4_SUB_MISSION),
    Mode.LOITER: (_PX4_AUTO, _PX4_SUB_LOITER),
    Mode.RTL: (_PX4_AUTO, _PX4_SUB_RTL),
    # PX4 flies DO_REPOSITION in its Hold mode.
    Mode.GUIDED: (_PX4_AUTO, _PX4_SUB_LOITER),
}


def custom_mode(flavour: Flavour, mode: Mode) -> int:
    """``custom_mode`` of HEARTBEAT for a mode."""
    if flavour is Flavour.ARDUPILOT:
        return _ARDUPLANE[mode]
    main, sub = _PX4[mode]
    return main << 16 | sub << 24


def mode_of(flavour: Flavour, custom: int) -> Mode | None:
    """Mode of SET_MODE's ``custom_mode``; None for modes that are not simulated."""
    for mode in (Mode.MANUAL, Mode.AUTO, Mode.LOITER, Mode.RTL, Mode.GUIDED):
        if custom_mode(flavour, mode) == custom:
            return mode
    return None


def mode_of_command(flavour: Flavour, param2: float, param3: float) -> Mode | None:
    """Mode of DO_SET_MODE: ArduPilot's number in param 2; PX4's main and sub mode in params 2 and 3."""
    if flavour is Flavour.ARDUPILOT:
        return mode_of(flavour, int(param2))
    return mode_of(flavour, int(param2) << 16 | int(param3) << 24)
