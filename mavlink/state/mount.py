"""Where a gimbal points what hangs in it, as the device or the autopilot tells.

Source: MAVLink ``common.xml`` and ``ardupilotmega.xml``: GIMBAL_DEVICE_ATTITUDE_STATUS (285) with its
GIMBAL_DEVICE_FLAGS, MOUNT_ORIENTATION (265), MOUNT_STATUS (158).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

from mavlink.state.telemetry import VehicleState, finite
from mavlink.wire.messages import Message

GIMBAL_DEVICE_ATTITUDE_STATUS: Final = 285
#: How often a second it is asked for.
ATTITUDE_HZ: Final = 4.0
#: Told by the gimbal, which may be a component of its own, or by the autopilot.
MOUNT_MESSAGES: Final = frozenset({"GIMBAL_DEVICE_ATTITUDE_STATUS", "MOUNT_ORIENTATION", "MOUNT_STATUS"})

_YAW_LOCK, _IN_VEHICLE, _IN_EARTH = 16, 32, 64
#: Older than this it is no longer known where it points.
_FRESH_S: Final = 1.0


@dataclass(frozen=True, slots=True)
class MountAttitude:
    """Roll, pitch up from the horizon, and yaw clockwise from true north, in degrees."""

    roll_deg: float
    pitch_deg: float
    yaw_deg: float


class MountWatch:
    """Keeps what a gimbal told last."""

    def __init__(self) -> None:
        self._told: tuple[float, MountAttitude] | None = None

    def take(self, message: Message, state: VehicleState) -> None:
        """Take one message, and the state at that time; those that tell no attitude change nothing."""
        attitude = attitude_of(message, state.heading_deg)
        if attitude is not None and state.time_s is not None:
            self._told = state.time_s, attitude

    def at(self, time_s: float | None) -> MountAttitude | None:
        """Where it pointed at a time of the vehicle's; None where it did not tell shortly before."""
        if self._told is None or time_s is None or abs(time_s - self._told[0]) > _FRESH_S:
            return None
        return self._told[1]


def attitude_of(message: Message, heading_deg: float | None) -> MountAttitude | None:
    """What a message tells; None where it tells none, or counts yaw from a nose whose heading is unknown."""
    match message.name:
        case "GIMBAL_DEVICE_ATTITUDE_STATUS":
            angles = angles_deg(message.fields.get("q"))
            if angles is None:
                return None
            roll_deg, pitch_deg, yaw_deg = angles
            flags = message.integer("flags")
            # Devices of before those two flags: yaw is from north where it is locked.
            from_north = bool(flags & _IN_EARTH) or bool(flags & _YAW_LOCK and not flags & _IN_VEHICLE)
        case "MOUNT_ORIENTATION":
            told = tuple(finite(message, name) for name in ("roll", "pitch", "yaw"))
            if None in told:
                return None
            roll_deg, pitch_deg, yaw_deg = (angle or 0.0 for angle in told)
            from_north = False
        case "MOUNT_STATUS":
            # Centidegrees: pitch, roll, yaw.
            pitch_deg, roll_deg, yaw_deg = (message.integer(f"pointing_{axis}") / 100.0 for axis in "abc")
            from_north = False
        case _:
            return None
    if not from_north:
        if heading_deg is None:
            return None
        yaw_deg += heading_deg
    return MountAttitude(roll_deg, pitch_deg, yaw_deg % 360.0)


def angles_deg(quaternion: object) -> tuple[float, float, float] | None:
    """Roll, pitch and yaw of a quaternion (w, x, y, z); None for one that is none.

    Straight up and down, where only yaw with roll is determined, roll is nothing.
    """
    if not isinstance(quaternion, tuple) or len(quaternion) != 4:
        return None
    norm = math.sqrt(sum(part * part for part in quaternion))
    if not (math.isfinite(norm) and norm > 0.5):
        return None
    w, x, y, z = (part / norm for part in quaternion)
    sine = max(-1.0, min(1.0, 2.0 * (w * y - z * x)))
    pitch_deg = math.degrees(math.asin(sine))
    if abs(sine) > 1.0 - 1e-9:
        return 0.0, pitch_deg, math.degrees(-math.copysign(2.0, sine) * math.atan2(x, w))
    roll = math.atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y))
    yaw = math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
    return math.degrees(roll), pitch_deg, math.degrees(yaw)
