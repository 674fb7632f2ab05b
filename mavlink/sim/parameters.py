"""The few parameters a ground station asks a vehicle for; read only.

Source: MAVLink parameter protocol; names of ArduPlane 4.6 and PX4 1.16.
"""

from __future__ import annotations

import math

from mavlink.messages import Message
from mavlink.sim.modes import Flavour
from mavlink.sim.settings import SimSettings

_REAL32 = 9


class Parameters:
    """Answers PARAM_REQUEST_READ, PARAM_REQUEST_LIST and PARAM_SET (which changes nothing and says so)."""

    def __init__(self, settings: SimSettings) -> None:
        bank_deg = math.degrees(settings.bank_limit_rad)
        if settings.autopilot is Flavour.ARDUPILOT:
            self._values = {
                "SYSID_THISMAV": float(settings.system_id),
                "AIRSPEED_CRUISE": settings.airspeed_m_s,
                "NAVL1_PERIOD": settings.tuning.l1_period_s,
                "ROLL_LIMIT_DEG": bank_deg,
                "RTL_ALTITUDE": settings.rtl_altitude_m,
                "RTL_AUTOLAND": 0.0,
                "WP_LOITER_RAD": settings.turn_radius_m,
                "WP_RADIUS": settings.acceptance_m,
                "FENCE_ENABLE": 1.0,
                "FENCE_TYPE": 7.0,
                "FENCE_ACTION": 1.0,
                "CAM1_TYPE": 1.0,
            }
            self._values |= {f"RELAY{number}_FUNCTION": 1.0 for number in range(1, 7)}
            self._values |= {f"SERVO{n}_FUNCTION": 10.0 if n == 9 else 0.0 for n in range(1, 17)}
        else:
            self._values = {
                "MAV_SYS_ID": float(settings.system_id),
                "FW_AIRSPD_TRIM": settings.airspeed_m_s,
                "NPFG_PERIOD": settings.tuning.l1_period_s,
                "NPFG_DAMPING": 0.7,
                "NPFG_SW_DST_MLT": 0.32,
                "FW_R_LIM": bank_deg,
                "MIS_TKO_LAND_REQ": 2.0,
                "NAV_ACC_RAD": settings.acceptance_m,
                "NAV_LOITER_RAD": settings.turn_radius_m,
                "RTL_RETURN_ALT": settings.rtl_altitude_m,
                "FW_LND_ANG": 5.0,
                "GF_ACTION": 3.0,
                "TRIG_MODE": 4.0,
                "COM_DISARM_PRFLT": 10.0,
                "COM_DISARM_LAND": 2.0,
            } | {
                f"PWM_{group}_FUNC{output}": 296.0 + output if group == "MAIN" and output > 4 else 0.0
                for group in ("MAIN", "AUX")
                for output in range(1, 9)
            }

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
            return [self._value(index)] if index >= 0 else []
        return []

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
