"""From which version of the firmware on commands are taken in missions.

Between the versions that are known here (ArduPilot 4.5 to 4.7, PX4 1.15 to 1.17) hardly anything differs; an
older one refuses more. What is not listed was taken longer than anybody flies.

Sources: the version on the master branch when ``AP_Mission::mavlink_int_to_mission_cmd`` of ArduPilot, and
``MavlinkMissionManager::parse_mavlink_mission_item`` of PX4, were given each command.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Final

from mavlink.dialects.base import Autopilot, DialectFinding
from mavlink.wire.items import Command, MissionItem

Version = tuple[int, int]

_RETURN_PATH_START, _COMPONENT_ARM_DISARM, _SET_CAMERA_SOURCE, _NAV_SCRIPT_TIME = 188, 400, 534, 42702

SINCE: Final[Mapping[Autopilot, Mapping[int, Version]]] = {
    "ardupilot": {
        Command.DO_PAUSE_CONTINUE: (4, 2),
        _NAV_SCRIPT_TIME: (4, 2),
        Command.DO_GIMBAL_MANAGER_PITCHYAW: (4, 3),
        Command.IMAGE_START_CAPTURE: (4, 4),
        Command.VIDEO_START_CAPTURE: (4, 4),
        Command.VIDEO_STOP_CAPTURE: (4, 4),
        Command.SET_CAMERA_ZOOM: (4, 4),
        Command.SET_CAMERA_FOCUS: (4, 4),
        Command.JUMP_TAG: (4, 4),
        Command.IMAGE_STOP_CAPTURE: (4, 5),
        _RETURN_PATH_START: (4, 6),
        _SET_CAMERA_SOURCE: (4, 6),
    },
    "px4": {
        Command.CONDITION_GATE: (1, 11),
        Command.SET_CAMERA_FOCUS: (1, 12),
        Command.DO_GIMBAL_MANAGER_PITCHYAW: (1, 12),
        Command.DO_SET_ACTUATOR: (1, 14),
        Command.DO_GRIPPER: (1, 14),
        Command.DO_WINCH: (1, 14),
        _SET_CAMERA_SOURCE: (1, 16),
        _COMPONENT_ARM_DISARM: (1, 17),
    },
}
_NEWER: Final = "bring the vehicle's firmware up to date"
_FIXES: Final[Mapping[int, str]] = {
    Command.IMAGE_START_CAPTURE: f"write payload trigger:distance, or {_NEWER}",
    Command.IMAGE_STOP_CAPTURE: f"write payload trigger:distance, or {_NEWER}",
    Command.DO_GIMBAL_MANAGER_PITCHYAW: f"write gimbal mount:tilt=…, or {_NEWER}",
}


def version_findings(
    items: tuple[MissionItem, ...], autopilot: Autopilot, version: Version | None
) -> Iterator[DialectFinding]:
    """Commands of a mission that a firmware does not know yet, each once; none of an unknown version."""
    if version is None:
        return
    told: set[int] = set()
    for item in items:
        since = SINCE[autopilot].get(item.command)
        if since is None or version >= since or item.command in told:
            continue
        told.add(item.command)
        first, own = (".".join(map(str, each)) for each in (since, version))
        yield DialectFinding(
            "firmware-too-old",
            f"command {item.command} is taken from version {first} on, the vehicle has {own}",
            item.seq,
            fix=_FIXES.get(item.command, _NEWER),
        )
