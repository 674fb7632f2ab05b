"""What each autopilot keeps of an item and reads back: missions lie in a few bytes an item.

Measured on ArduPilot 4.6 and PX4 1.16 simulators; kept apart from ``mavlink.dialects`` on purpose, so that a
wrong belief there is not confirmed here.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

from mavlink.sim.acceptance import PLACED
from mavlink.sim.geodesy import Place
from mavlink.sim.modes import Flavour
from mavlink.wire.items import Command, Frame, MissionItem, MissionType


def as_stored(flavour: Flavour, item: MissionItem, home: Place, *, hovers: bool = False) -> MissionItem:
    """The item as the autopilot keeps it and reads it back; ArduCopter's waypoints keep a delay alone."""
    if item.mission_type is MissionType.FENCE:
        frame = Frame.GLOBAL if flavour is Flavour.ARDUPILOT else Frame.GLOBAL_INT
        return replace(item, frame=frame, z=0.0)
    if item.mission_type is MissionType.RALLY:
        if flavour is Flavour.ARDUPILOT:
            return replace(item, frame=Frame.GLOBAL_RELATIVE_ALT, z=float(math.trunc(item.z)))
        return item
    if flavour is Flavour.PX4:
        return _px4(item)
    return home_item(home) if item.seq == 0 else _ardupilot(item, hovers=hovers)


def home_item(home: Place) -> MissionItem:
    """ArduPilot's row 0."""
    return MissionItem(
        seq=0,
        frame=Frame.GLOBAL,
        command=Command.NAV_WAYPOINT,
        x=round(home.lat_deg * 1e7),
        y=round(home.lon_deg * 1e7),
        z=_centimetres(home.altitude_m),
    )


def _byte(value: float) -> float:
    return float(min(max(math.trunc(value), 0), 255))


def _turns(value: float) -> float:
    # A part of a turn is kept in 1/256.
    return math.floor(256.0 * value) / 256.0 if 0.0 < value < 1.0 else _byte(value)


def _loiter_radius(radius_m: float) -> float:
    size_m = math.trunc(abs(radius_m))
    if size_m > 255:
        size_m = min(size_m // 10 * 10, 2550)
    return math.copysign(float(size_m), radius_m)


#: What a letter of the table makes of a parameter.
_KEPT: dict[str, Callable[[float], float]] = {
    ".": lambda value: 0.0,
    "s": lambda value: value,
    "w": lambda value: float(math.trunc(value)),
    "b": _byte,
    "i": lambda value: -1.0 if value < 0.0 else 1.0,
    "f": lambda value: 1.0 if value > 0.0 else 0.0,
    "t": _turns,
    "r": _loiter_radius,
}
#: ArduPilot, command by command: a letter for each of the four parameters.
_ARDUPILOT: dict[int, str] = {
    Command.NAV_WAYPOINT: ".bb.",
    Command.NAV_SPLINE_WAYPOINT: "w...",
    Command.NAV_LOITER_UNLIM: "..w.",
    Command.NAV_LOITER_TURNS: "t.rf",
    Command.NAV_LOITER_TIME: "w.if",
    Command.NAV_LOITER_TO_ALT: ".w.f",
    Command.NAV_RETURN_TO_LAUNCH: "....",
    Command.NAV_LAND: "w..i",
    Command.NAV_TAKEOFF: "w...",
    Command.NAV_VTOL_TAKEOFF: "....",
    Command.NAV_VTOL_LAND: "w...",
    Command.NAV_DELAY: "swww",
    Command.CONDITION_DELAY: "s...",
    Command.CONDITION_DISTANCE: "s...",
    Command.CONDITION_YAW: "ssww",
    Command.DO_JUMP: "ww..",
    Command.DO_CHANGE_SPEED: "wss.",
    Command.DO_SET_HOME: "w...",
    Command.DO_LAND_START: "....",
    Command.DO_SET_RELAY: "ww..",
    Command.DO_SET_SERVO: "ww..",
    Command.DO_SET_ROI: "w...",
    Command.DO_DIGICAM_CONTROL: "wwww",
    Command.DO_MOUNT_CONTROL: "sss.",
    Command.DO_SET_CAM_TRIGG_DIST: "s.w.",
    Command.DO_FENCE_ENABLE: "w...",
    Command.DO_PARACHUTE: "w...",
    Command.DO_GRIPPER: "ww..",
    Command.DO_WINCH: "wwss",
    Command.DO_PAUSE_CONTINUE: "w...",
    Command.JUMP_TAG: "w...",
    Command.DO_GIMBAL_MANAGER_PITCHYAW: "wwww",
    Command.SET_CAMERA_ZOOM: "ws..",
    Command.SET_CAMERA_FOCUS: "ws..",
    Command.IMAGE_START_CAPTURE: "wsww",
    Command.IMAGE_STOP_CAPTURE: "w...",
    Command.VIDEO_START_CAPTURE: "w...",
    Command.VIDEO_STOP_CAPTURE: "w...",
}
_COPTER_WAYPOINT = "w..."
#: No places, yet these of x, y and z come back.
_ROOM_FOR_XY = frozenset({Command.DO_DIGICAM_CONTROL, Command.DO_GIMBAL_MANAGER_PITCHYAW})
_ROOM_FOR_Z = frozenset({Command.DO_GIMBAL_MANAGER_PITCHYAW})


def _ardupilot(item: MissionItem, *, hovers: bool) -> MissionItem:
    letters = _ARDUPILOT.get(item.command, "ssss")
    if hovers and item.command == Command.NAV_WAYPOINT:
        letters = _COPTER_WAYPOINT
    parameters = (item.param1, item.param2, item.param3, item.param4)
    p1, p2, p3, p4 = (_KEPT[letter](value) for letter, value in zip(letters, parameters, strict=True))
    placed = item.command in PLACED
    frame = {2: 0, 5: 0, 6: 3, 11: 10}.get(item.frame, item.frame) if placed else 0
    with_xy = placed or item.command in _ROOM_FOR_XY or item.command not in _ARDUPILOT
    return MissionItem(
        seq=item.seq,
        frame=frame,
        command=item.command,
        param1=p1,
        param2=p2,
        param3=p3,
        param4=p4,
        x=item.x if with_xy else 0,
        y=item.y if with_xy else 0,
        z=_centimetres(item.z) if placed else item.z if item.command in _ROOM_FOR_Z else 0.0,
    )


#: PX4, in frames with a place: a letter for each parameter, "y" for a yaw.
_PX4: dict[int, str] = {
    Command.NAV_WAYPOINT: "ss.y",
    Command.NAV_LOITER_UNLIM: "..sy",
    Command.NAV_LOITER_TIME: "sfsf",
    Command.NAV_LOITER_TO_ALT: "fs.f",
    Command.NAV_LAND: ".s.y",
    Command.NAV_TAKEOFF: "...y",
    Command.NAV_VTOL_TAKEOFF: "...y",
    Command.NAV_VTOL_LAND: "...y",
    Command.CONDITION_GATE: "....",
    Command.DO_SET_ROI_LOCATION: "....",
}
_PX4_FOR_EVER = 65535.0


def _yaw(yaw_deg: float) -> float:
    # A hair below 0 gives 360 itself in binary.
    return yaw_deg % 360.0 % 360.0 if math.isfinite(yaw_deg) else yaw_deg


def _px4(item: MissionItem) -> MissionItem:
    command = int(Command.DO_SET_ROI) if item.command == Command.NAV_ROI else item.command
    stored = replace(item, command=command, frame={0: 5, 3: 6}.get(item.frame, item.frame), current=False)
    if item.frame == Frame.MISSION:
        for_ever = item.command == Command.DO_JUMP and item.param2 == -1.0
        return replace(stored, param2=_PX4_FOR_EVER) if for_ever else stored
    letters = _PX4.get(item.command, "s...")
    kept = {**_KEPT, "y": _yaw}
    parameters = (item.param1, item.param2, item.param3, item.param4)
    p1, p2, p3, p4 = (kept[letter](value) for letter, value in zip(letters, parameters, strict=True))
    return replace(stored, param1=p1, param2=p2, param3=p3, param4=p4)


def _centimetres(metres: float) -> float:
    # The nudge keeps 0.29 from becoming 0.28 because 0.29 * 100 is 28.999… in binary.
    return math.trunc(metres * 100.0 + math.copysign(1e-6, metres)) / 100.0
