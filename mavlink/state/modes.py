"""Autopilot, vehicle type and flight mode in words, from HEARTBEAT's numbers and back.

Source: MAVLink ``minimal.xml`` (MAV_AUTOPILOT, MAV_TYPE); ArduPilot ``ArduPlane/mode.h`` and
``ArduCopter/mode.h`` (Mode::Number); PX4 ``px4_custom_mode.h`` (main mode in bits 16-23, sub mode in 24-31).
"""

from __future__ import annotations

from typing import Final, Literal

Autopilot = Literal["ardupilot", "px4", "generic"]
VehicleType = Literal["fixed_wing", "multirotor", "vtol", "other"]

GROUND_STATION_TYPE: Final = 6
NO_AUTOPILOT: Final = 8

_MULTIROTOR_TYPES: Final = frozenset({2, 3, 4, 13, 14, 15, 29, 35, 43})
_VTOL_TYPES: Final = frozenset(range(19, 26))

#: The mode of an ArduPlane that is still starting.
BOOT_MODE: Final = "INITIALISING"

_ARDUPLANE: Final[dict[int, str]] = dict(
    enumerate(
        [
            "MANUAL",
            "CIRCLE",
            "STABILIZE",
            "TRAINING",
            "ACRO",
            "FBWA",
            "FBWB",
            "CRUISE",
            "AUTOTUNE",
            "-",
            "AUTO",
            "RTL",
            "LOITER",
            "TAKEOFF",
            "AVOID_ADSB",
            "GUIDED",
            BOOT_MODE,
            "QSTABILIZE",
            "QHOVER",
            "QLOITER",
            "QLAND",
            "QRTL",
            "QAUTOTUNE",
            "QACRO",
            "THERMAL",
            "LOITER_ALT_QLAND",
            "AUTOLAND",
        ]
    )
)
_ARDUCOPTER: Final[dict[int, str]] = dict(
    enumerate(
        [
            "STABILIZE",
            "ACRO",
            "ALT_HOLD",
            "AUTO",
            "GUIDED",
            "LOITER",
            "RTL",
            "CIRCLE",
            "-",
            "LAND",
            "-",
            "DRIFT",
            "-",
            "SPORT",
            "FLIP",
            "AUTOTUNE",
            "POSHOLD",
            "BRAKE",
            "THROW",
            "AVOID_ADSB",
            "GUIDED_NOGPS",
            "SMART_RTL",
            "FLOWHOLD",
            "FOLLOW",
            "ZIGZAG",
            "SYSTEMID",
            "AUTOROTATE",
            "AUTO_RTL",
            "TURTLE",
        ]
    )
)
_PX4_MAIN: Final[dict[int, str]] = dict(
    enumerate(["MANUAL", "ALTCTL", "POSCTL", "AUTO", "ACRO", "OFFBOARD", "STABILIZED", "RATTITUDE"], start=1)
)
_PX4_AUTO: Final = 4
_PX4_SUB: Final[dict[int, str]] = dict(
    enumerate(
        ["READY", "TAKEOFF", "LOITER", "MISSION", "RTL", "LAND", "-", "FOLLOW", "PRECLAND", "VTOL_TAKEOFF"],
        start=1,
    )
)


def autopilot_name(number: int) -> Autopilot:
    """MAV_AUTOPILOT in a word."""
    if number == 3:
        return "ardupilot"
    return "px4" if number == 12 else "generic"


def vehicle_type_name(number: int) -> VehicleType:
    """MAV_TYPE in a word."""
    if number == 1:
        return "fixed_wing"
    if number in _MULTIROTOR_TYPES:
        return "multirotor"
    return "vtol" if number in _VTOL_TYPES else "other"


def _ardupilot_modes(vehicle_type: VehicleType) -> dict[int, str]:
    # "-" marks numbers without a mode.
    if vehicle_type == "other":
        return {}
    return _ARDUCOPTER if vehicle_type == "multirotor" else _ARDUPLANE


def mode_name(autopilot: Autopilot, vehicle_type: VehicleType, custom_mode: int) -> str:
    """HEARTBEAT.custom_mode in a word: ``AUTO``, ``AUTO.MISSION``; ``MODE 77`` for one not known here."""
    unknown = f"MODE {custom_mode}"
    if autopilot == "ardupilot":
        name = _ardupilot_modes(vehicle_type).get(custom_mode, "-")
        return unknown if name == "-" else name
    if autopilot == "px4":
        main, sub = custom_mode >> 16 & 0xFF, custom_mode >> 24 & 0xFF
        name = _PX4_MAIN.get(main, unknown)
        return f"AUTO.{_PX4_SUB.get(sub, sub)}" if main == _PX4_AUTO and sub else name
    return unknown


def mode_parameters(autopilot: Autopilot, vehicle_type: VehicleType, name: str) -> tuple[float, float, float]:
    """The parameters of DO_SET_MODE for a mode's name, as ``mode_name`` gives it.

    Raises
    ------
    ValueError
        The autopilot has no mode of that name.
    """
    custom_mode_enabled = 1.0
    if autopilot == "ardupilot":
        for number, known in _ardupilot_modes(vehicle_type).items():
            if known == name != "-":
                return custom_mode_enabled, float(number), 0.0
    elif autopilot == "px4":
        main_name, _, sub_name = name.partition(".")
        for main, known in _PX4_MAIN.items():
            if known == main_name and not sub_name:
                return custom_mode_enabled, float(main), 0.0
        for sub, known in _PX4_SUB.items():
            if main_name == "AUTO" and known == sub_name != "-":
                return custom_mode_enabled, float(_PX4_AUTO), float(sub)
    raise ValueError(f"{autopilot} ({vehicle_type}) has no mode {name!r}")


#: Modes in which an aircraft follows its mission, comes back, comes down.
MISSION_MODES: Final = frozenset({"AUTO", "AUTO.MISSION"})
RETURN_MODES: Final = frozenset({"RTL", "QRTL", "SMART_RTL", "AUTO_RTL", "AUTO.RTL"})
LANDING_MODES: Final = frozenset({"LAND", "QLAND", "AUTOLAND", "AUTO.LAND", "AUTO.PRECLAND"})
#: Modes in which it waits where it is.
WAITING_MODES: Final = frozenset({"LOITER", "QLOITER", "CIRCLE", "BRAKE", "POSHOLD", "AUTO.LOITER"})
#: Modes in which arming is the last thing that keeps it from leaving the ground.
_TAKING_OFF: Final = MISSION_MODES | frozenset(
    {"TAKEOFF", "THROW", "AUTO_RTL", "AUTO.TAKEOFF", "AUTO.VTOL_TAKEOFF", "AUTO.FOLLOW", "OFFBOARD"}
)


def takes_off_when_armed(mode: str) -> bool:
    """Whether an aircraft armed in a mode may leave the ground by itself; so with one not known here."""
    return not mode or mode in _TAKING_OFF or mode.startswith("MODE ") or mode.rpartition(".")[2].isdigit()
