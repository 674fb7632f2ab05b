"""Which items each autopilot takes: the vehicle's side of the dialects.

Measured on ArduPlane 4.6 and PX4 1.16 simulators; kept apart from ``mavlink.dialects`` on purpose, so that a
wrong belief there is not confirmed here.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from mavlink.sim.modes import Flavour
from mavlink.wire.items import Command, Frame, MissionItem, MissionResult, MissionType

#: Commands that ArduPilot keeps a place of.
PLACED = frozenset(
    {
        Command.NAV_WAYPOINT,
        Command.NAV_SPLINE_WAYPOINT,
        Command.NAV_LOITER_UNLIM,
        Command.NAV_LOITER_TURNS,
        Command.NAV_LOITER_TIME,
        Command.NAV_LAND,
        Command.NAV_TAKEOFF,
        Command.NAV_LOITER_TO_ALT,
        Command.NAV_VTOL_TAKEOFF,
        Command.NAV_VTOL_LAND,
        Command.DO_SET_HOME,
        Command.DO_LAND_START,
        Command.DO_SET_ROI,
    }
)

_COPTER = PLACED | {
    Command.NAV_RETURN_TO_LAUNCH,
    Command.NAV_DELAY,
    Command.CONDITION_DELAY,
    Command.CONDITION_DISTANCE,
    Command.CONDITION_YAW,
    Command.DO_JUMP,
    Command.DO_CHANGE_SPEED,
    Command.DO_SET_RELAY,
    Command.DO_SET_SERVO,
    Command.DO_FENCE_ENABLE,
    Command.DO_DIGICAM_CONTROL,
    Command.DO_SET_CAM_TRIGG_DIST,
    Command.DO_PARACHUTE,
    Command.DO_GRIPPER,
    Command.DO_WINCH,
    Command.DO_PAUSE_CONTINUE,
    Command.JUMP_TAG,
    Command.SET_CAMERA_ZOOM,
    Command.SET_CAMERA_FOCUS,
    Command.IMAGE_START_CAPTURE,
    Command.IMAGE_STOP_CAPTURE,
    Command.VIDEO_START_CAPTURE,
    Command.VIDEO_STOP_CAPTURE,
    Command.DO_MOUNT_CONTROL,
    Command.DO_GIMBAL_MANAGER_PITCHYAW,
}
_PLANE = _COPTER - {Command.NAV_SPLINE_WAYPOINT}

_PX4_PLACED = frozenset(
    {
        Command.NAV_WAYPOINT,
        Command.NAV_LOITER_UNLIM,
        Command.NAV_LOITER_TIME,
        Command.NAV_LOITER_TO_ALT,
        Command.NAV_TAKEOFF,
        Command.NAV_LAND,
        Command.NAV_VTOL_TAKEOFF,
        Command.NAV_VTOL_LAND,
        Command.CONDITION_GATE,
        Command.DO_SET_ROI_LOCATION,
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
        Command.SET_CAMERA_MODE,
        Command.SET_CAMERA_FOCUS,
        Command.IMAGE_START_CAPTURE,
        Command.IMAGE_STOP_CAPTURE,
        Command.VIDEO_START_CAPTURE,
        Command.VIDEO_STOP_CAPTURE,
        Command.DO_DIGICAM_CONTROL,
        Command.DO_SET_ACTUATOR,
        Command.DO_GRIPPER,
        Command.DO_WINCH,
        Command.DO_SET_ROI_NONE,
        Command.DO_MOUNT_CONTROL,
        Command.DO_GIMBAL_MANAGER_PITCHYAW,
        Command.DO_GIMBAL_MANAGER_CONFIGURE,
    }
)
_TAKEOFFS = frozenset({Command.NAV_TAKEOFF, Command.NAV_VTOL_TAKEOFF})
_LANDINGS = frozenset({Command.NAV_LAND, Command.NAV_VTOL_LAND})
_ROI = frozenset({Command.NAV_ROI, Command.DO_SET_ROI})
#: Param 1 of those, MAV_ROI: 3 is a place, 0 none.
_ROI_WITH_PLACE, _ROI_WITHOUT = (0.0, 3.0), (0.0, 1.0, 2.0)

_ARDUPILOT_FRAMES = frozenset({0, 2, 3, 5, 6, 10, 11})
_PX4_FRAMES = frozenset({0, 3, 5, 6})
_NAN_TAKEN: dict[int, set[int]] = {
    Command.NAV_WAYPOINT: {4},
    Command.NAV_TAKEOFF: {4},
    Command.NAV_LAND: {4},
    Command.NAV_VTOL_TAKEOFF: {4},
    Command.NAV_VTOL_LAND: {3, 4},
}
_FENCE_POLYGONS = frozenset(
    {Command.NAV_FENCE_POLYGON_VERTEX_INCLUSION, Command.NAV_FENCE_POLYGON_VERTEX_EXCLUSION}
)
_FENCE_CIRCLES = frozenset({Command.NAV_FENCE_CIRCLE_INCLUSION, Command.NAV_FENCE_CIRCLE_EXCLUSION})
_FENCE = _FENCE_POLYGONS | _FENCE_CIRCLES | {Command.NAV_FENCE_RETURN_POINT}
_FIRST_INVALID_PARAM = int(MissionResult.INVALID_PARAM1)


def refusal(
    flavour: Flavour, item: MissionItem, count: int, sensor_command: int = 0, *, hovers: bool = False
) -> MissionResult | None:
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
        return _ardupilot_refusal(item, count, sensor_command, _COPTER if hovers else _PLANE)
    return _px4_refusal(item, sensor_command)


def _ardupilot_refusal(
    item: MissionItem, count: int, sensor_command: int, known: frozenset[int]
) -> MissionResult | None:
    if item.seq == 0:
        return None
    if item.command not in known and item.command != sensor_command:
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
    if item.command in _ROI and (item.frame == Frame.MISSION or item.frame in _PX4_FRAMES):
        taken = _ROI_WITHOUT if item.frame == Frame.MISSION else _ROI_WITH_PLACE
        return None if item.param1 in taken else MissionResult.INVALID_PARAM1
    if item.frame == Frame.MISSION:
        known = item.command in _PX4_UNPLACED or item.command == sensor_command
        return None if known else MissionResult.UNSUPPORTED
    if item.frame in _PX4_FRAMES:
        return None if item.command in _PX4_PLACED else MissionResult.UNSUPPORTED
    return MissionResult.UNSUPPORTED_FRAME


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

    PX4 asks what has wings for a landing, a multirotor for nothing (MIS_TKO_LAND_REQ 2 and 0); a take-off,
    where there is one, is to be the first item with a place (``FeasibilityChecker::checkTakeoff``). Whether
    an aircraft on the ground has one is for the caller to ask.
    """
    flown = items[1:] if flavour is Flavour.ARDUPILOT else items
    if not flown:
        return "no mission"
    if flavour is Flavour.ARDUPILOT:
        return ""
    placed = [item for item in flown if item.command in _PX4_PLACED]
    if any(item.command in _TAKEOFFS for item in placed[1:]) and placed[0].command not in _TAKEOFFS:
        return "first item is no takeoff"
    if not hovers and not any(item.command in _LANDINGS for item in placed):
        return "landing required"
    if any(item.command in (Command.CONDITION_DELAY, Command.CONDITION_DISTANCE) for item in flown):
        return "condition items are not flown"
    return ""
