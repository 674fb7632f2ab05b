"""The few parameters a ground station asks a vehicle for; those that the flight goes by can be set.

Source: MAVLink parameter protocol; names of ArduPlane and ArduCopter 4.6 and PX4 1.16.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

from mavlink.sim.modes import Flavour
from mavlink.sim.settings import SimSettings
from mavlink.wire.messages import Message

_REAL32 = 9
#: Parameters that the flight goes by: the setting, and how many of its units one of theirs is.
_FLOWN_BY: dict[str, tuple[str, float]] = {
    "RTL_ALTITUDE": ("rtl_altitude_m", 1.0),
    "RTL_ALT": ("rtl_altitude_m", 0.01),
    "RTL_RETURN_ALT": ("rtl_altitude_m", 1.0),
    "AIRSPEED_CRUISE": ("airspeed_m_s", 1.0),
    "FW_AIRSPD_TRIM": ("airspeed_m_s", 1.0),
    "WPNAV_SPEED": ("airspeed_m_s", 0.01),
    "MPC_XY_CRUISE": ("airspeed_m_s", 1.0),
    "WP_LOITER_RAD": ("turn_radius_m", 1.0),
    "NAV_LOITER_RAD": ("turn_radius_m", 1.0),
    "TECS_CLMB_MAX": ("climb_m_s", 1.0),
    "TECS_SINK_MAX": ("sink_m_s", 1.0),
    "FW_T_CLMB_R_SP": ("climb_m_s", 1.0),
    "FW_T_SINK_R_SP": ("sink_m_s", 1.0),
    "WPNAV_SPEED_UP": ("climb_m_s", 0.01),
    "WPNAV_SPEED_DN": ("sink_m_s", 0.01),
    "MPC_Z_V_AUTO_UP": ("climb_m_s", 1.0),
    "MPC_Z_V_AUTO_DN": ("sink_m_s", 1.0),
    "MIS_TAKEOFF_ALT": ("take_off_height_m", 1.0),
}


class Parameters:
    """Answers PARAM_REQUEST_READ, PARAM_REQUEST_LIST and PARAM_SET.

    Attributes
    ----------
    settings
        Those started from, with what was set since; a value that the aircraft cannot fly by is not kept.
    """

    def __init__(self, settings: SimSettings) -> None:
        self.settings = settings
        ardupilot = settings.autopilot is Flavour.ARDUPILOT
        of_the_kind = (
            (_copter if settings.hovers else _plane)
            if ardupilot
            else (_px4_multirotor if settings.hovers else _px4_plane)
        )
        self._values = (_ardupilot if ardupilot else _px4)(settings) | of_the_kind(settings)

    def receive(self, message: Message) -> list[Message]:
        """Answers to one message of the parameter protocol; none for others, and none for unknown names."""
        names = list(self._values)
        if message.name == "PARAM_REQUEST_LIST":
            return [self._value(index) for index in range(len(names))]
        if message.name == "PARAM_REQUEST_READ":
            index = message.integer("param_index")
            if index < 0:
                index = self._index(message.text("param_id"))
            return [self._value(index)] if 0 <= index < len(names) else []
        if message.name == "PARAM_SET":
            index = self._index(message.text("param_id"))
            if index >= 0:
                self._set(names[index], message.number("param_value"))
            return [self._value(index)] if index >= 0 else []
        return []

    def _set(self, name: str, value: float) -> None:
        """Keep a value, and fly by it where it says how."""
        if not math.isfinite(value):
            return
        field, unit = _FLOWN_BY.get(name, ("", 1.0))
        if field:
            try:
                changes: dict[str, Any] = {field: value * unit}
                self.settings = replace(self.settings, **changes)
            except ValueError:
                # Refused, as the old value in the answer says.
                return
        self._values[name] = value

    def _index(self, name: str) -> int:
        names = list(self._values)
        return names.index(name) if name in names else -1

    def _value(self, index: int) -> Message:
        name = list(self._values)[index]
        return Message(
            "PARAM_VALUE",
            {
                "param_id": name,
                "param_value": self._values[name],
                "param_type": _REAL32,
                "param_count": len(self._values),
                "param_index": index,
            },
        )


def _ardupilot(settings: SimSettings) -> dict[str, float]:
    return (
        {
            ("MAV_SYSID" if settings.version >= (4, 7) else "SYSID_THISMAV"): float(settings.system_id),
            "FENCE_ENABLE": 1.0,
            # The fences uploaded alone are in force, as ArduPlane has it at first.
            "FENCE_TYPE": 4.0,
            "FENCE_ALT_MAX": 100.0,
            "FENCE_RADIUS": 300.0,
            "FENCE_ACTION": 1.0,
            "CAM1_TYPE": 1.0,
            "CAM1_INTRVAL_MIN": settings.camera_interval_s,
            "CAM1_TRIGG_DIST": 0.0,
            "CAM_AUTO_ONLY": 0.0,
            "CAM_MAX_ROLL": 0.0,
            # A servo gimbal that reaches all round and straight down.
            "MNT1_TYPE": 1.0,
            "MNT1_PITCH_MIN": -90.0,
            "MNT1_PITCH_MAX": 20.0,
            "MNT1_YAW_MIN": -180.0,
            "MNT1_YAW_MAX": 180.0,
        }
        | {f"RELAY{number}_FUNCTION": 1.0 for number in range(1, 7)}
        | {f"SERVO{n}_FUNCTION": 10.0 if n == 9 else 0.0 for n in range(1, 17)}
    )


def _plane(settings: SimSettings) -> dict[str, float]:
    return {
        "AIRSPEED_CRUISE": settings.airspeed_m_s,
        "NAVL1_PERIOD": settings.tuning.l1_period_s,
        "ROLL_LIMIT_DEG": math.degrees(settings.bank_limit_rad),
        "RTL_ALTITUDE": settings.rtl_altitude_m,
        "RTL_AUTOLAND": 0.0,
        "RTL_RADIUS": 0.0,
        "TECS_CLMB_MAX": settings.climb_m_s,
        "TECS_SINK_MAX": settings.sink_m_s,
        "WP_LOITER_RAD": settings.turn_radius_m,
        "WP_RADIUS": settings.acceptance_m,
    }


def _copter(settings: SimSettings) -> dict[str, float]:
    if settings.version >= (4, 7):
        return {
            "ATC_ANGLE_MAX": math.degrees(settings.bank_limit_rad),
            "LAND_SPD_MS": 0.5,
            "RTL_ALT_M": settings.rtl_altitude_m,
            "WP_ACC": 2.5,
            "WP_JERK": 1.0,
            "WP_RADIUS_M": settings.waypoint_radius_m,
            "WP_SPD": settings.airspeed_m_s,
            "WP_SPD_DN": settings.sink_m_s,
            "WP_SPD_UP": settings.climb_m_s,
        }
    # Centimetres and centidegrees.
    return {
        "ANGLE_MAX": 100.0 * math.degrees(settings.bank_limit_rad),
        "LAND_SPEED": 50.0,
        "RTL_ALT": 100.0 * settings.rtl_altitude_m,
        "WPNAV_ACCEL": 250.0,
        "WPNAV_JERK": 1.0,
        "WPNAV_RADIUS": 100.0 * settings.waypoint_radius_m,
        "WPNAV_SPEED": 100.0 * settings.airspeed_m_s,
        "WPNAV_SPEED_DN": 100.0 * settings.sink_m_s,
        "WPNAV_SPEED_UP": 100.0 * settings.climb_m_s,
    }


def _px4(settings: SimSettings) -> dict[str, float]:
    outputs = [(group, output) for group in ("MAIN", "AUX") for output in range(1, 9)]
    return (
        {
            "MAV_SYS_ID": float(settings.system_id),
            "NAV_LOITER_RAD": settings.turn_radius_m,
            "RTL_RETURN_ALT": settings.rtl_altitude_m,
            "MIS_TAKEOFF_ALT": settings.take_off_height_m,
            "GF_ACTION": 3.0,
            "TRIG_MODE": 4.0,
            "TRIG_INTERFACE": 3.0,
            "TRIG_MIN_INTERVA": max(1.0, 1000.0 * settings.camera_interval_s),
            "CAM_CAP_FBACK": 0.0,
            "MNT_MODE_IN": 4.0,
            "MNT_MODE_OUT": 2.0,
            "MNT_RANGE_PITCH": 180.0,
            "MNT_RANGE_YAW": 360.0,
            "COM_DISARM_PRFLT": 10.0,
            "COM_DISARM_LAND": 2.0,
            "PWM_MAIN_REV": 0.0,
            "PWM_AUX_REV": 0.0,
        }
        | {
            f"PWM_{group}_FUNC{output}": 296.0 + output if group == "MAIN" and output > 4 else 0.0
            for group, output in outputs
        }
        | {f"PWM_{group}_MIN{output}": 1000.0 for group, output in outputs}
        | {f"PWM_{group}_MAX{output}": 2000.0 for group, output in outputs}
    )


def _px4_plane(settings: SimSettings) -> dict[str, float]:
    return {
        "FW_AIRSPD_TRIM": settings.airspeed_m_s,
        "NPFG_PERIOD": settings.tuning.l1_period_s,
        "NPFG_DAMPING": 0.7,
        "NPFG_SW_DST_MLT": 0.32,
        "FW_R_LIM": math.degrees(settings.bank_limit_rad),
        "FW_T_CLMB_MAX": settings.climb_m_s,
        "FW_T_CLMB_R_SP": settings.climb_m_s,
        "FW_T_SINK_MAX": settings.sink_m_s,
        "FW_T_SINK_R_SP": settings.sink_m_s,
        "MIS_TKO_LAND_REQ": 2.0,
        "NAV_ACC_RAD": settings.acceptance_m,
        "FW_LND_ANG": 5.0,
    }


def _px4_multirotor(settings: SimSettings) -> dict[str, float]:
    return {
        "MIS_TKO_LAND_REQ": 0.0,
        "MPC_ACC_HOR": 3.0,
        "MPC_JERK_AUTO": 4.0,
        "MPC_LAND_SPEED": 0.7,
        "MPC_TILTMAX_AIR": math.degrees(settings.bank_limit_rad),
        "MPC_TKO_SPEED": 1.5,
        "MPC_XY_CRUISE": settings.airspeed_m_s,
        "MPC_XY_VEL_MAX": max(12.0, settings.airspeed_m_s),
        "MPC_Z_V_AUTO_DN": settings.sink_m_s,
        "MPC_Z_V_AUTO_UP": settings.climb_m_s,
        "MPC_Z_VEL_MAX_DN": settings.sink_m_s,
        "MPC_Z_VEL_MAX_UP": settings.climb_m_s,
        "NAV_ACC_RAD": settings.waypoint_radius_m,
    }
