"""Where a gimbal points the sensor, and the items that say so.

Source: MAVLink ``common.xml`` (DO_GIMBAL_MANAGER_PITCHYAW, DO_GIMBAL_MANAGER_CONFIGURE, DO_MOUNT_CONTROL,
GIMBAL_MANAGER_FLAGS, MAV_MOUNT_MODE). Pitch is positive up from the horizon, yaw positive to the right. The
sensor's tilt counts from straight down, as a SAR's incidence does, towards the side the pass looks to: a tilt
of t is a pitch of t - 90 with the yaw abeam. A camera is tilted forwards or backwards: its yaw is ahead or
behind.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntFlag
from itertools import pairwise
from typing import Literal

from mavlink.dialects import Autopilot
from mavlink.wire.items import Command, Frame, MissionItem
from planner.plan import Collect

Protocol = Literal["manager", "mount"]
Hold = Literal["vehicle", "course"]

#: What people write when the sensor is bolted on.
NO_GIMBAL = "none"
#: Servo and serial gimbals of ArduPilot: parameters MNT1_… and MNT2_….
ARDUPILOT_GIMBALS = 2
#: PX4 obeys whoever is in control of the gimbal: -2 makes it the autopilot itself, -1 changes nothing.
_ITSELF, _AS_IT_IS = -2.0, -1.0


class Flags(IntFlag):
    """GIMBAL_MANAGER_FLAGS."""

    RETRACT = 1
    NEUTRAL = 2
    ROLL_LOCK = 4
    PITCH_LOCK = 8
    YAW_LOCK = 16
    YAW_IN_VEHICLE_FRAME = 32
    YAW_IN_EARTH_FRAME = 64


_LEVEL = Flags.ROLL_LOCK | Flags.PITCH_LOCK
_FLAGS: dict[Hold, Flags] = {
    "vehicle": _LEVEL | Flags.YAW_IN_VEHICLE_FRAME,
    "course": _LEVEL | Flags.YAW_LOCK | Flags.YAW_IN_EARTH_FRAME,
}
#: Faster than most gimbals turn.
_FAST_DEG_S = 30.0
#: MAV_MOUNT_MODE.
_NEUTRAL, _TARGETING = 1.0, 2.0


class GimbalError(ValueError):
    """A gimbal that cannot be pointed as asked."""


@dataclass(frozen=True, slots=True)
class Gimbal:
    """A gimbal that carries the sensor.

    Parameters
    ----------
    protocol
        ``manager``: DO_GIMBAL_MANAGER_PITCHYAW; ``mount``: DO_MOUNT_CONTROL, for firmware without the former.
    tilt_deg
        Of the sensor from straight down towards the side a pass looks to, 0 to 90.
    hold
        ``vehicle``: the yaw turns with the nose; ``course``: it is held abeam of the pass whatever the crab.
    device
        Gimbal device id; 0 for the first, or the only one.
    """

    protocol: Protocol
    tilt_deg: float
    hold: Hold = "vehicle"
    device: int = 0

    def __post_init__(self) -> None:
        if not 0.0 <= self.tilt_deg <= 90.0:
            raise GimbalError(
                f"tilt {self.tilt_deg:g}°: it counts from straight down (0) to the horizon (90); the side is"
                " the one each pass looks to"
            )
        if not 0 <= self.device <= 255:
            raise GimbalError(f"device {self.device}: gimbal device ids are 0 to 255")
        if self.protocol == "mount" and self.hold == "course":
            raise GimbalError("DO_MOUNT_CONTROL turns with the nose: yaw=course needs manager")
        if self.protocol == "mount" and self.device != 0:
            raise GimbalError("DO_MOUNT_CONTROL names no gimbal: device goes with manager")


@dataclass(frozen=True, slots=True)
class Pointing:
    """Where a gimbal points: degrees, pitch up from the horizon, yaw to the right from the nose or north."""

    pitch_deg: float
    yaw_deg: float


def parse_gimbal(text: str) -> Gimbal | None:
    """The gimbal of a specification; None for ``none``.

    ``manager:tilt=45`` · ``manager:tilt=45,yaw=course,device=2`` · ``mount:tilt=0``; tilt in degrees from
    straight down, yaw ``vehicle`` where it is left out.

    Raises
    ------
    GimbalError
        Naming what is not understood.
    """
    name, _, rest = text.strip().partition(":")
    if name == NO_GIMBAL and not rest:
        return None
    if name not in ("manager", "mount"):
        raise GimbalError(f"gimbal {text!r}: begins with none of none, manager, mount")
    words: dict[str, str] = {}
    for part in rest.split(",") if rest else ():
        key, equals, value = part.partition("=")
        if key not in ("tilt", "yaw", "device") or not equals or key in words:
            raise GimbalError(f"gimbal {text!r}: {part!r} is none of tilt=…, yaw=…, device=…, each once")
        words[key] = value
    if "tilt" not in words:
        raise GimbalError(
            f"gimbal {text!r}: no tilt is given; write e.g. {name}:tilt=45, degrees from straight down"
        )
    hold = words.get("yaw", "vehicle")
    if hold not in ("vehicle", "course"):
        raise GimbalError(f"gimbal {text!r}: yaw is {hold!r}, vehicle or course is meant")
    try:
        tilt_deg, device = float(words["tilt"]), int(words.get("device", "0"))
    except ValueError as error:
        raise GimbalError(f"gimbal {text!r}: {error}") from error
    return Gimbal(
        "manager" if name == "manager" else "mount",
        tilt_deg,
        "course" if hold == "course" else "vehicle",
        device,
    )


def pointing_at(
    gimbal: Gimbal, collect: Collect, autopilot: Autopilot, *, backwards: bool = False
) -> Pointing:
    """Where the gimbal must point during a collect, in the numbers the autopilot keeps.

    ``backwards`` for a camera that is tilted against the direction of flight.
    """
    down = gimbal.tilt_deg == 0.0 or collect.look == "down"
    side_deg = 0.0 if down else 90.0 if collect.look == "right" else -90.0
    if backwards and collect.look == "down" and gimbal.tilt_deg > 0.0:
        side_deg = 180.0
    pitch_deg, yaw_deg = gimbal.tilt_deg - 90.0, side_deg
    if gimbal.hold == "course":
        yaw_deg = _half_turn_deg(collect.heading_deg + side_deg)
    if keeps_whole_degrees(gimbal, autopilot):
        # Cut towards zero on board: rounded here, they are kept as they are.
        return Pointing(float(round(pitch_deg)), float(round(yaw_deg)))
    return Pointing(pitch_deg, yaw_deg)


def keeps_whole_degrees(gimbal: Gimbal, autopilot: Autopilot) -> bool:
    """Whether angles come back whole: ArduPilot stores them in one byte for pitch, in two for yaw."""
    return autopilot == "ardupilot" and gimbal.protocol == "manager"


def turning_notes(gimbal: Gimbal, collects: Sequence[Collect]) -> tuple[str, ...]:
    """Where the gimbal has little time to turn from one side to the other, collects in flight order.

    Raises
    ------
    GimbalError
        One collect begins before another, that looks elsewhere, has ended.
    """
    notes: list[str] = []
    for one, other in pairwise(collects):
        sides_differ = gimbal.tilt_deg > 0.0 and one.look != other.look
        elsewhere = gimbal.hold == "course" and one.heading_deg != other.heading_deg
        if (sides_differ or elsewhere) and other.start_m < one.end_m:
            raise GimbalError(
                f"collect {other.seq} begins before collect {one.seq} has ended, and looks elsewhere"
            )
        time_s = other.start_s - one.end_s
        if sides_differ and time_s * _FAST_DEG_S < 180.0:
            notes.append(
                f"the gimbal turns from side to side between collects {one.seq} and {other.seq}, and has"
                f" {max(0.0, time_s):.1f} s for it"
            )
    return tuple(notes)


def control_items(gimbal: Gimbal, autopilot: Autopilot) -> tuple[MissionItem, ...]:
    """What must stand before the first pointing.

    PX4 denies DO_GIMBAL_MANAGER_PITCHYAW in a mission until the autopilot has taken control of the gimbal; it
    takes it by itself for DO_MOUNT_CONTROL alone. ArduPilot has no such item and no such need.
    """
    if autopilot == "px4" and gimbal.protocol == "manager":
        return (_item(Command.DO_GIMBAL_MANAGER_CONFIGURE, _ITSELF, _ITSELF, (_AS_IT_IS, _AS_IT_IS), 0, 0.0),)
    return ()


def pointing_item(gimbal: Gimbal, pointing: Pointing, autopilot: Autopilot) -> MissionItem:
    """The item that points the gimbal, not yet numbered."""
    pitch_deg, yaw_deg = pointing.pitch_deg, pointing.yaw_deg
    if gimbal.protocol == "mount":
        return _item(Command.DO_MOUNT_CONTROL, pitch_deg, 0.0, (yaw_deg, 0.0), 0, _TARGETING)
    return _manager_item(gimbal, pitch_deg, yaw_deg, _FLAGS[gimbal.hold], autopilot)


def neutral_item(gimbal: Gimbal, autopilot: Autopilot) -> MissionItem:
    """The item that brings the gimbal to its neutral position, for the landing; not yet numbered.

    ArduPilot loses the mode of DO_MOUNT_CONTROL: there it is level and ahead.
    """
    if gimbal.protocol == "mount":
        return _item(Command.DO_MOUNT_CONTROL, 0.0, 0.0, (0.0, 0.0), 0, _NEUTRAL)
    return _manager_item(gimbal, 0.0, 0.0, Flags.NEUTRAL, autopilot)


def hold_of(item: MissionItem) -> Hold:
    """What an item that points a gimbal at a pass holds its yaw by."""
    managed = item.command == Command.DO_GIMBAL_MANAGER_PITCHYAW
    return "course" if managed and item.x & Flags.YAW_LOCK else "vehicle"


def protocol_of(item: MissionItem) -> Protocol | None:
    """How an item points a gimbal at a pass; None where it does not, or brings it to rest."""
    if item.command == Command.DO_GIMBAL_MANAGER_PITCHYAW:
        return None if item.x & (Flags.NEUTRAL | Flags.RETRACT) else "manager"
    if item.command == Command.DO_MOUNT_CONTROL:
        return "mount" if item.z == _TARGETING else None
    return None


def _manager_item(
    gimbal: Gimbal, pitch_deg: float, yaw_deg: float, flags: Flags, autopilot: Autopilot
) -> MissionItem:
    # NaN means no rate; ArduPilot refuses it, and looks at rates only where there are no angles.
    rate = math.nan if autopilot == "px4" else 0.0
    return _item(
        Command.DO_GIMBAL_MANAGER_PITCHYAW, pitch_deg, yaw_deg, (rate, rate), int(flags), float(gimbal.device)
    )


def _item(
    command: int, param1: float, param2: float, others: tuple[float, float], x: int, z: float
) -> MissionItem:
    return MissionItem(
        0,
        Frame.MISSION,
        command,
        param1=param1,
        param2=param2,
        param3=others[0],
        param4=others[1],
        x=x,
        z=z,
    )


def _half_turn_deg(angle_deg: float) -> float:
    """The same direction from -180 to 180."""
    return math.remainder(angle_deg, 360.0)
