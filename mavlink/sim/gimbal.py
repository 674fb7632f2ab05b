"""A gimbal of the simulated aircraft: the autopilot is its manager, the device a component of its own.

It is stabilised: pitch counts from the horizon, yaw from the nose, or from north where it is locked to it.

Source: MAVLink gimbal protocol v2 (GIMBAL_MANAGER_STATUS, GIMBAL_DEVICE_ATTITUDE_STATUS,
DO_GIMBAL_MANAGER_PITCHYAW, DO_GIMBAL_MANAGER_CONFIGURE) and v1 (DO_MOUNT_CONTROL).
"""

from __future__ import annotations

import math

from mavlink.sim.component import Component
from mavlink.sim.dynamics import AircraftState
from mavlink.sim.geodesy import Place, offset_m
from mavlink.sim.shutter import quaternion
from mavlink.wire.items import Command, MissionItem
from mavlink.wire.messages import Message

COMPONENT = 154
MOST_PITCH_DEG, LEAST_PITCH_DEG, MOST_YAW_DEG = 20.0, -90.0, 180.0
#: GIMBAL_MANAGER_FLAGS and GIMBAL_DEVICE_FLAGS, the same bits.
_NEUTRAL, _ROLL_LOCK, _PITCH_LOCK, _YAW_LOCK, _IN_VEHICLE, _IN_EARTH = 2, 4, 8, 16, 32, 64
#: GIMBAL_MANAGER_CAP_FLAGS: neutral, roll, pitch and yaw axes with lock and follow, points at places.
_CAN = 0x2 | 0xFFC | 0x10000
_SLEW_DEG_S = 60.0
#: MAV_TYPE.
_GIMBAL = 26
_MAVLINK_TARGETING = 2.0
_REPORT_S = 1.0


class Gimbal(Component):
    """Where it points, and who points it."""

    def __init__(self, system_id: int) -> None:
        super().__init__(system_id, COMPONENT, _GIMBAL)
        self._pitch_deg = self._yaw_deg = 0.0
        self._aim: tuple[float, float] | Place = (0.0, 0.0)
        self._lock = False
        self._control = (0, 0)
        self._time_s: float | None = None
        self._report_s = 0.0

    def handle(self, item: MissionItem, sender: tuple[int, int]) -> bool:
        """Carry out an order or a mission's item; False when it is none for a gimbal.

        Parameters
        ----------
        item
            An order as an item: its ``x`` and ``z`` are params 5 and 7.
        sender
            System and component that ordered it.
        """
        match item.command:
            case Command.DO_GIMBAL_MANAGER_PITCHYAW:
                flags = max(item.x, 0)
                self._lock = bool(flags & _YAW_LOCK)
                self._aim = (0.0, 0.0) if flags & _NEUTRAL else self._angles(item.param1, item.param2)
            case Command.DO_GIMBAL_MANAGER_CONFIGURE:
                # -1 leaves it as it is, -2 is the sender itself, -3 gives it up.
                for_self = item.param1 == -2.0
                if for_self or item.param1 >= 0.0:
                    self._control = sender if for_self else (int(item.param1), int(max(item.param2, 0.0)))
                elif item.param1 == -3.0:
                    self._control = (0, 0)
            case Command.DO_MOUNT_CONTROL:
                if item.z == _MAVLINK_TARGETING:
                    self._lock, self._aim = False, self._angles(item.param1, item.param3)
            case Command.DO_SET_ROI_LOCATION | Command.DO_SET_ROI | Command.NAV_ROI if item.x or item.y:
                self._aim = Place(item.x / 1e7, item.y / 1e7, item.z)
            case Command.DO_SET_ROI_NONE | Command.DO_SET_ROI | Command.NAV_ROI:
                self._lock, self._aim = False, (0.0, 0.0)
            case _:
                return False
        return True

    def told(self, command: int, number: float, state: AircraftState) -> Message | None:
        """A message asked of the device itself; None for those it has not."""
        if command != Command.REQUEST_MESSAGE:
            return None
        match int(number):
            case 283:
                limits = {
                    "pitch_min": math.radians(LEAST_PITCH_DEG),
                    "pitch_max": math.radians(MOST_PITCH_DEG),
                    "yaw_min": -math.radians(MOST_YAW_DEG),
                    "yaw_max": math.radians(MOST_YAW_DEG),
                }
                names = {"vendor_name": "Swathplan", "model_name": "simulated gimbal"}
                return self.own(
                    "GIMBAL_DEVICE_INFORMATION",
                    {"time_boot_ms": _ms(state), "cap_flags": _CAN & 0xFFF, **names, **limits},
                )
            case 285:
                return self.attitude(state)
        return None

    def step(self, state: AircraftState) -> list[Message]:
        """Turn towards the aim; what the device says by itself."""
        elapsed_s = state.time_s - self._time_s if self._time_s is not None else 0.0
        self._time_s = state.time_s
        pitch_deg, yaw_deg = self._wanted(state)
        most_deg = _SLEW_DEG_S * elapsed_s
        self._pitch_deg += min(max(pitch_deg - self._pitch_deg, -most_deg), most_deg)
        self._yaw_deg += min(max(_within(yaw_deg - self._yaw_deg), -most_deg), most_deg)
        self._yaw_deg = _within(self._yaw_deg)
        out = self.heartbeats(state)
        if state.time_s >= self._report_s:
            self._report_s = state.time_s + _REPORT_S
            out.append(self.attitude(state))
        return out

    def attitude(self, state: AircraftState) -> Message:
        """GIMBAL_DEVICE_ATTITUDE_STATUS: yaw from the nose, or from north when locked."""
        yaw_deg = self._yaw_deg
        if self._lock:
            yaw_deg = _within(yaw_deg + math.degrees(state.heading_rad))
        flags = _ROLL_LOCK | _PITCH_LOCK | (_YAW_LOCK | _IN_EARTH if self._lock else _IN_VEHICLE)
        return self.own(
            "GIMBAL_DEVICE_ATTITUDE_STATUS",
            {
                "time_boot_ms": _ms(state),
                "flags": flags,
                "q": quaternion(0.0, math.radians(self._pitch_deg), math.radians(yaw_deg)),
                "delta_yaw": math.radians(_within(math.degrees(state.heading_rad))),
            },
        )

    def reports(self, name: str, state: AircraftState) -> list[Message]:
        """The manager's messages, which come from the autopilot; none for other names."""
        if name == "GIMBAL_MANAGER_STATUS":
            system, component = self._control
            flags = _ROLL_LOCK | _PITCH_LOCK | (_YAW_LOCK if self._lock else 0)
            fields: dict[str, int | float] = {
                "time_boot_ms": _ms(state),
                "flags": flags,
                "gimbal_device_id": COMPONENT,
                "primary_control_sysid": system,
                "primary_control_compid": component,
            }
            return [Message(name, fields)]
        if name == "GIMBAL_MANAGER_INFORMATION":
            fields = {
                "time_boot_ms": _ms(state),
                "cap_flags": _CAN,
                "gimbal_device_id": COMPONENT,
                "pitch_min": math.radians(LEAST_PITCH_DEG),
                "pitch_max": math.radians(MOST_PITCH_DEG),
                "yaw_min": -math.radians(MOST_YAW_DEG),
                "yaw_max": math.radians(MOST_YAW_DEG),
            }
            return [Message(name, fields)]
        return []

    def _angles(self, pitch_deg: float, yaw_deg: float) -> tuple[float, float]:
        """An aim; NaN leaves an axis as it is."""
        old = self._aim if isinstance(self._aim, tuple) else (self._pitch_deg, self._yaw_deg)
        return (
            min(max(pitch_deg, LEAST_PITCH_DEG), MOST_PITCH_DEG) if math.isfinite(pitch_deg) else old[0],
            _within(yaw_deg) if math.isfinite(yaw_deg) else old[1],
        )

    def _wanted(self, state: AircraftState) -> tuple[float, float]:
        """Pitch, and yaw from the nose, to turn to."""
        heading_deg = math.degrees(state.heading_rad)
        if isinstance(self._aim, tuple):
            pitch_deg, yaw_deg = self._aim
            return pitch_deg, _within(yaw_deg - heading_deg) if self._lock else yaw_deg
        north_m, east_m = offset_m(state.lat_deg, state.lon_deg, self._aim.lat_deg, self._aim.lon_deg)
        down_deg = math.degrees(
            math.atan2(self._aim.altitude_m - state.altitude_m, math.hypot(north_m, east_m))
        )
        bearing_deg = math.degrees(math.atan2(east_m, north_m))
        return min(max(down_deg, LEAST_PITCH_DEG), MOST_PITCH_DEG), _within(bearing_deg - heading_deg)


def _within(angle_deg: float) -> float:
    """The same direction within half a turn of 0."""
    return (angle_deg + 180.0) % 360.0 - 180.0


def _ms(state: AircraftState) -> int:
    return round(state.time_s * 1000.0)
