"""Which items each autopilot takes, and what it makes of them: the vehicle's side of the dialects.

Measured on ArduPlane 4.6 and PX4 1.16 simulators; kept apart from ``mavlink.dialects`` on purpose, so that a
wrong belief there is not confirmed here.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from mavlink.sim.geodesy import Place
from mavlink.sim.modes import Flavour
from mavlink.wire.items import Command, Frame, MissionItem, MissionResult, MissionType

DO_SET_ACTUATOR = 187
_VTOL_TAKEOFF, _VTOL_LAND = 84, 85
_DO_MOUNT_CONTROL, _GIMBAL_PITCHYAW, _GIMBAL_CONFIGURE = 205, 1000, 1001
_ROI_LOCATION, _ROI_NONE, _ROI = 195, 197, 201

#: Commands with a place in x, y, z.
PLACED = frozenset(
    {
        Command.NAV_WAYPOINT,
        Command.NAV_LOITER_UNLIM,
        Command.NAV_LOITER_TURNS,
        Command.NAV_LOITER_TIME,
        Command.NAV_LAND,
        Command.NAV_TAKEOFF,
        Command.NAV_LOITER_TO_ALT,
        Command.DO_SET_HOME,
        Command.DO_LAND_START,
        _VTOL_TAKEOFF,
        _VTOL_LAND,
        _ROI,
        _ROI_LOCATION,
    }
)

_ARDUPILOT = PLACED - {_ROI_LOCATION} | {
    Command.NAV_RETURN_TO_LAUNCH,
    Command.NAV_DELAY,
    Command.CONDITION_DELAY,
    Command.CONDITION_DISTANCE,
    Command.DO_JUMP,
    Command.DO_CHANGE_SPEED,
    Command.DO_SET_RELAY,
    Command.DO_SET_SERVO,
    Command.DO_FENCE_ENABLE,
    Command.DO_DIGICAM_CONTROL,
    Command.DO_SET_CAM_TRIGG_DIST,
    Command.IMAGE_START_CAPTURE,
    Command.IMAGE_STOP_CAPTURE,
    Command.VIDEO_START_CAPTURE,
    Command.VIDEO_STOP_CAPTURE,
    _DO_MOUNT_CONTROL,
    _GIMBAL_PITCHYAW,
}

_PX4_PLACED = frozenset(
    {
        Command.NAV_WAYPOINT,
        Command.NAV_LOITER_UNLIM,
        Command.NAV_LOITER_TIME,
        Command.NAV_LOITER_TO_ALT,
        Command.NAV_TAKEOFF,
        Command.NAV_LAND,
        _ROI_LOCATION,
        _ROI,
    }
)
_PX4_UNPLACED = frozenset(
    {
        Command.NAV_DELAY,
        Command.NAV_RETURN_TO_LAUNCH,
        Command.DO_JUMP,
        Command.DO_CHANGE_SPEED,
        Command.DO_SET_HOME,
        Command.DO_LAND_START,
        Command.CONDITION_DELAY,
        Command.CONDITION_DISTANCE,
        Command.DO_SET_CAM_TRIGG_DIST,
        Command.DO_SET_CAM_TRIGG_INTERVAL,
        Command.DO_TRIGGER_CONTROL,
        Command.IMAGE_START_CAPTURE,
        Command.IMAGE_STOP_CAPTURE,
        Command.VIDEO_START_CAPTURE,
        Command.VIDEO_STOP_CAPTURE,
        Command.DO_DIGICAM_CONTROL,
        Command.DO_SET_ACTUATOR,
        _ROI_NONE,
        _DO_MOUNT_CONTROL,
        _GIMBAL_PITCHYAW,
        _GIMBAL_CONFIGURE,
    }
)

_ARDUPILOT_FRAMES = frozenset({0, 2, 3, 5, 6, 10, 11})
_NAN_TAKEN = {
    Command.NAV_WAYPOINT: {4},
    Command.NAV_TAKEOFF: {4},
    Command.NAV_LAND: {4},
    _VTOL_TAKEOFF: {4},
    _VTOL_LAND: {3, 4},
}
_FENCE_POLYGONS = frozenset(
    {Command.NAV_FENCE_POLYGON_VERTEX_INCLUSION, Command.NAV_FENCE_POLYGON_VERTEX_EXCLUSION}
)
_FENCE_CIRCLES = frozenset({Command.NAV_FENCE_CIRCLE_INCLUSION, Command.NAV_FENCE_CIRCLE_EXCLUSION})
_FENCE = _FENCE_POLYGONS | _FENCE_CIRCLES | {Command.NAV_FENCE_RETURN_POINT}
_FIRST_INVALID_PARAM = int(MissionResult.INVALID_PARAM1)


def refusal(flavour: Flavour, item: MissionItem, count: int, sensor_command: int = 0) -> MissionResult | None:
    """Why an item is refused as it arrives; None when it is taken.

    Parameters
    ----------
    count
        Number of items of the list being uploaded.
    sensor_command
        The user command that the payload answers to, taken without a place.
    """
    if item.mission_type is MissionType.FENCE:
        return None if item.command in _FENCE else MissionResult.UNSUPPORTED
    if item.mission_type is MissionType.RALLY:
        return None if item.command == Command.NAV_RALLY_POINT else MissionResult.UNSUPPORTED
    if flavour is Flavour.ARDUPILOT:
        return _ardupilot_refusal(item, count, sensor_command)
    return _px4_refusal(item, sensor_command)


def _ardupilot_refusal(item: MissionItem, count: int, sensor_command: int) -> MissionResult | None:
    if item.seq == 0:
        return None
    if item.command not in _ARDUPILOT and item.command != sensor_command:
        return MissionResult.UNSUPPORTED
    if item.command in PLACED and item.frame not in _ARDUPILOT_FRAMES:
        return MissionResult.UNSUPPORTED_FRAME
    taken = _NAN_TAKEN.get(item.command, set())
    for number, value in enumerate((item.param1, item.param2, item.param3, item.param4), start=1):
        if math.isnan(value) and number not in taken:
            return MissionResult(_FIRST_INVALID_PARAM + number - 1)
    if math.isnan(item.z):
        return MissionResult.INVALID_PARAM7
    if item.command in PLACED and not (abs(item.x) <= 900_000_000 and abs(item.y) <= 1_800_000_000):
        return MissionResult.INVALID_PARAM5_X
    if item.command == Command.DO_JUMP and not 0 < item.param1 < count:
        return MissionResult.ERROR
    return None


def _px4_refusal(item: MissionItem, sensor_command: int) -> MissionResult | None:
    if item.frame == Frame.MISSION:
        known = item.command in _PX4_UNPLACED or item.command == sensor_command
        return None if known else MissionResult.UNSUPPORTED
    if item.frame in (0, 3, 5, 6):
        return None if item.command in _PX4_PLACED else MissionResult.UNSUPPORTED
    return MissionResult.UNSUPPORTED_FRAME


def as_stored(flavour: Flavour, item: MissionItem, home: Place, *, hovers: bool = False) -> MissionItem:
    """The item as the autopilot keeps it and reads it back; ArduCopter's waypoints keep a delay alone."""
    if item.mission_type is MissionType.FENCE:
        frame = Frame.GLOBAL if flavour is Flavour.ARDUPILOT else Frame.GLOBAL_INT
        return replace(item, frame=frame, z=0.0)
    if item.mission_type is MissionType.RALLY:
        if flavour is Flavour.ARDUPILOT:
            return replace(item, frame=Frame.GLOBAL_RELATIVE_ALT, z=float(math.trunc(item.z)))
        return item
    if flavour is Flavour.ARDUPILOT:
        stored = _ardupilot_stored(item, home)
        if hovers and item.seq > 0 and item.command == Command.NAV_WAYPOINT:
            return replace(stored, param1=float(math.trunc(item.param1)), param2=0.0, param3=0.0)
        return stored
    return _px4_stored(item)


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


def _ardupilot_stored(item: MissionItem, home: Place) -> MissionItem:
    if item.seq == 0:
        return home_item(home)
    p1, p2, p3, p4 = item.param1, item.param2, item.param3, item.param4
    x, y, z = item.x, item.y, _centimetres(item.z)
    frame = {2: 0, 5: 0, 6: 3, 11: 10}.get(item.frame, item.frame) if item.command in PLACED else 0
    match item.command:
        case Command.NAV_WAYPOINT:
            p1, p2, p3, p4 = 0.0, _byte(p2), _byte(p3), 0.0
        case Command.NAV_TAKEOFF:
            p1, p4 = float(math.trunc(p1)), 0.0
        case Command.NAV_LOITER_TURNS:
            # A part of a turn is kept in 1/256.
            p1 = math.floor(256.0 * p1) / 256.0 if 0.0 < p1 < 1.0 else _byte(p1)
            p3 = _loiter_radius(p3)
        case Command.NAV_LOITER_TIME:
            p1, p3 = float(math.trunc(p1)), -1.0 if p3 < 0.0 else 1.0
        case Command.NAV_LOITER_TO_ALT:
            p2 = float(math.trunc(p2))
        case Command.NAV_LOITER_UNLIM:
            p3 = float(math.trunc(p3))
        case Command.NAV_LAND:
            p1, p4 = float(math.trunc(p1)), -1.0 if p4 < 0.0 else 1.0
        case Command.NAV_RETURN_TO_LAUNCH:
            x, y, z = 0, 0, 0.0
        case Command.DO_CHANGE_SPEED:
            p4 = 0.0
        case Command.DO_SET_SERVO:
            p2 = float(math.trunc(p2))
        case Command.DO_SET_CAM_TRIGG_DIST:
            p2 = 0.0
        case Command.DO_DIGICAM_CONTROL | 205:
            z = 0.0
        case 1000:
            p1, p2 = float(math.trunc(p1)), float(math.trunc(p2))
        case _:
            pass
    return replace(
        item,
        frame=frame,
        param1=p1,
        param2=p2,
        param3=p3,
        param4=p4,
        x=x,
        y=y,
        z=z,
        current=False,
        autocontinue=True,
    )


def _px4_stored(item: MissionItem) -> MissionItem:
    item = replace(item, frame={0: 5, 3: 6}.get(item.frame, item.frame), current=False)
    match item.command:
        case Command.NAV_TAKEOFF | Command.NAV_LAND:
            return replace(item, param1=0.0, param4=_yaw(item.param4))
        case Command.NAV_WAYPOINT:
            return replace(item, param3=0.0, param4=_yaw(item.param4))
        case Command.DO_JUMP:
            return replace(item, param2=65535.0) if item.param2 == -1.0 else item
        case 80:
            return replace(item, command=_ROI)
        case _:
            return item


def finished_list(
    flavour: Flavour, items: Sequence[MissionItem], old: Sequence[MissionItem]
) -> tuple[list[MissionItem], str]:
    """A complete fence or rally list as it ends up in the store, and why it is refused (empty: it is not).

    Circles uploaded to ArduPilot over a stored polygon leave an empty fence although they are accepted.
    """
    vertices = 0
    for item in items:
        if item.command in _FENCE_POLYGONS:
            if not (math.isfinite(item.param1) and item.param1 >= 3):
                return [], "Fence: polygon of fewer than 3 points"
            vertices = (vertices or int(item.param1)) - 1
        elif item.command in _FENCE_CIRCLES and not (math.isfinite(item.param1) and item.param1 > 0.0):
            return [], "Fence: bad circle radius"
    if vertices != 0 and flavour is Flavour.ARDUPILOT:
        return [], "Fence: incorrect vertex count"
    had_polygon = any(item.command in _FENCE_POLYGONS for item in old)
    only_circles = bool(items) and all(item.command in _FENCE_CIRCLES for item in items)
    if flavour is Flavour.ARDUPILOT and had_polygon and only_circles:
        return [], ""
    return list(items), ""


def infeasible(flavour: Flavour, items: Sequence[MissionItem], *, hovers: bool = False) -> str:
    """Why a stored mission cannot be started; empty when it can.

    PX4 asks a multirotor for neither take-off nor landing (MIS_TKO_LAND_REQ 0).
    """
    flown = items[1:] if flavour is Flavour.ARDUPILOT else items
    if not flown:
        return "no mission"
    if flavour is Flavour.ARDUPILOT:
        return ""
    placed = [item for item in flown if item.command in _PX4_PLACED]
    takes_off = any(item.command == Command.NAV_TAKEOFF for item in placed) or not hovers
    if takes_off and (not placed or placed[0].command != Command.NAV_TAKEOFF):
        return "first item is no takeoff"
    if not hovers and not any(item.command == Command.NAV_LAND for item in placed):
        return "landing required"
    if any(item.command in (Command.CONDITION_DELAY, Command.CONDITION_DISTANCE) for item in flown):
        return "condition items are not flown"
    return ""


def _centimetres(metres: float) -> float:
    # The nudge keeps 0.29 from becoming 0.28 because 0.29 * 100 is 28.999… in binary.
    return math.trunc(metres * 100.0 + math.copysign(1e-6, metres)) / 100.0


def _byte(value: float) -> float:
    return float(min(max(math.trunc(value), 0), 255))


def _loiter_radius(radius_m: float) -> float:
    size_m = math.trunc(abs(radius_m))
    if size_m > 255:
        size_m = min(size_m // 10 * 10, 2550)
    return math.copysign(float(size_m), radius_m)


def _yaw(yaw_deg: float) -> float:
    return yaw_deg if math.isnan(yaw_deg) else yaw_deg % 360.0
