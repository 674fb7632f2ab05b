"""Which messages the simulated aircraft sends by itself, and when each is due.

Source: MAVLink ``common.xml``; ArduPilot's groups of streams (``GCS_MAVLINK_Plane.cpp``).
"""

from __future__ import annotations

import math

from mavlink.sim.modes import Flavour

#: Message number and default rate in hertz of simulated time; 0: only on request.
STREAMS: dict[str, tuple[int, float]] = {
    "HEARTBEAT": (0, 1.0),
    "SYS_STATUS": (1, 1.0),
    "SYSTEM_TIME": (2, 1.0),
    "GPS_RAW_INT": (24, 2.0),
    "ATTITUDE": (30, 4.0),
    "ATTITUDE_QUATERNION": (31, 0.0),
    "GLOBAL_POSITION_INT": (33, 5.0),
    "SERVO_OUTPUT_RAW": (36, 0.0),
    "MISSION_CURRENT": (42, 1.0),
    "VFR_HUD": (74, 2.0),
    "ALTITUDE": (141, 0.0),
    "BATTERY_STATUS": (147, 0.5),
    "AUTOPILOT_VERSION": (148, 0.0),
    "WIND": (168, 0.5),
    "HOME_POSITION": (242, 0.1),
    "EXTENDED_SYS_STATE": (245, 1.0),
    "NAMED_VALUE_INT": (252, 2.0),
    "CAMERA_CAPTURE_STATUS": (262, 0.0),
    "GIMBAL_MANAGER_INFORMATION": (280, 0.0),
    "GIMBAL_MANAGER_STATUS": (281, 0.2),
    "RELAY_STATUS": (376, 0.5),
}
#: PX4 sends these unasked, too.
_PX4_RATES_HZ = {"ATTITUDE_QUATERNION": 4.0, "ALTITUDE": 1.0}
#: Those that tell of the payload, and come from it.
OF_THE_PAYLOAD = frozenset({"NAMED_VALUE_INT", "RELAY_STATUS", "SERVO_OUTPUT_RAW", "CAMERA_CAPTURE_STATUS"})
OF_THE_GIMBAL = frozenset({"GIMBAL_MANAGER_INFORMATION", "GIMBAL_MANAGER_STATUS"})
NAMES = {number: name for name, (number, _) in STREAMS.items()}


#: MAV_DATA_STREAM: the messages of ArduPilot's groups of them, as far as they are sent here.
_GROUPS: dict[int, tuple[str, ...]] = {
    1: ("ATTITUDE",),
    2: ("SYS_STATUS", "GPS_RAW_INT", "MISSION_CURRENT"),
    3: ("SERVO_OUTPUT_RAW",),
    6: ("GLOBAL_POSITION_INT",),
    10: ("ATTITUDE",),
    11: ("VFR_HUD",),
    12: ("SYSTEM_TIME", "WIND", "BATTERY_STATUS", "EXTENDED_SYS_STATE", "RELAY_STATUS"),
}
_ALL_GROUPS = 0


class Streams:
    """Which message is due when; rates count simulated time."""

    def __init__(self, flavour: Flavour) -> None:
        self._rates_hz = {name: rate for name, (_, rate) in STREAMS.items()}
        if flavour is Flavour.PX4:
            self._rates_hz |= _PX4_RATES_HZ
        self._period_s = {name: 1.0 / rate for name, rate in self._rates_hz.items() if rate > 0.0}
        self._due_s = dict.fromkeys(self._period_s, 0.0)
        self._next_s = 0.0

    def set_interval(self, name: str, interval_us: float) -> None:
        """SET_MESSAGE_INTERVAL: -1 stops a message, 0 restores its default rate."""
        rate = self._rates_hz[name]
        if interval_us < 0.0 or (interval_us == 0.0 and rate <= 0.0):
            self._period_s.pop(name, None)
            self._due_s.pop(name, None)
            return
        self._period_s[name] = 1.0 / rate if interval_us == 0.0 else max(interval_us / 1e6, 0.02)
        self._due_s[name] = 0.0
        self._next_s = 0.0

    def set_group(self, group: int, rate_hz: float) -> None:
        """REQUEST_DATA_STREAM: a rate for all messages of a group, 0 to stop them."""
        chosen = _GROUPS.values() if group == _ALL_GROUPS else [_GROUPS.get(group, ())]
        for name in (name for names in chosen for name in names):
            self.set_interval(name, 1e6 / rate_hz if rate_hz > 0.0 else -1.0)

    def interval_us(self, name: str) -> int:
        """MESSAGE_INTERVAL of a message: -1 where it is not sent."""
        period_s = self._period_s.get(name)
        return -1 if period_s is None else round(period_s * 1e6)

    def due(self, time_s: float) -> list[str]:
        """Names due at a simulated time."""
        if time_s + 1e-9 < self._next_s:
            return []
        names = [name for name, due_s in self._due_s.items() if time_s + 1e-9 >= due_s]
        for name in names:
            period_s = self._period_s[name]
            later_s = self._due_s[name] + period_s
            self._due_s[name] = later_s if later_s > time_s else time_s + period_s
        self._next_s = min(self._due_s.values(), default=math.inf)
        return names
