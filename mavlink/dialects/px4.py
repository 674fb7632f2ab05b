"""PX4: fixed wing, multirotor and VTOL, measured on v1.16.0."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace

from mavlink.dialects.base import (
    Autopilot,
    DialectFinding,
    VehicleType,
    fence_findings,
    finite,
    jump_findings,
    list_findings,
    mission_type_of,
    place_findings,
    unlisted_finding,
)
from mavlink.dialects.px4_feasibility import feasibility_findings
from mavlink.dialects.stores import PX4_STORE, FenceStore
from mavlink.wire.items import Command, Frame, MissionItem, MissionResult, MissionType

#: Items of a mission on boards of unknown size; SITL holds 10000, v6x, v6c and Cube 1000.
DEFAULT_MISSION_LIMIT = 500
FENCE_LIMIT = 64
RALLY_LIMIT = 32

#: Taken in global frames only; the parameters that are stored, in order.
_PLACED: Mapping[int, tuple[str, ...]] = {
    Command.NAV_WAYPOINT: ("param1", "param2", "param4"),
    Command.NAV_LOITER_UNLIM: ("param3", "param4"),
    Command.NAV_LOITER_TIME: ("param1", "param2", "param3", "param4"),
    Command.NAV_LAND: ("param2", "param4"),
    Command.NAV_TAKEOFF: ("param4",),
    Command.NAV_LOITER_TO_ALT: ("param1", "param2", "param4"),
    Command.NAV_VTOL_TAKEOFF: ("param4",),
    Command.NAV_VTOL_LAND: ("param4",),
    Command.CONDITION_GATE: (),
    Command.DO_SET_ROI_LOCATION: (),
}
#: Their param 4 is a yaw, which comes back in 0 to 360 degrees.
_YAW = frozenset(
    {
        Command.NAV_WAYPOINT,
        Command.NAV_LOITER_UNLIM,
        Command.NAV_LAND,
        Command.NAV_TAKEOFF,
        Command.NAV_VTOL_TAKEOFF,
        Command.NAV_VTOL_LAND,
    }
)
#: Stored as yes or no.
_FLAGS: Mapping[int, tuple[str, ...]] = {
    Command.NAV_LOITER_TO_ALT: ("param1", "param4"),
    Command.NAV_LOITER_TIME: ("param2", "param4"),
}
#: Taken in frame 2 (MISSION) only, parameters kept.
_PLACELESS = frozenset(
    {
        Command.NAV_DELAY,
        Command.NAV_RETURN_TO_LAUNCH,
        Command.DO_JUMP,
        Command.DO_CHANGE_SPEED,
        Command.DO_SET_HOME,
        Command.DO_LAND_START,
        Command.DO_SET_CAM_TRIGG_DIST,
        Command.DO_SET_CAM_TRIGG_INTERVAL,
        Command.DO_TRIGGER_CONTROL,
        Command.IMAGE_START_CAPTURE,
        Command.IMAGE_STOP_CAPTURE,
        Command.VIDEO_START_CAPTURE,
        Command.VIDEO_STOP_CAPTURE,
        Command.SET_CAMERA_MODE,
        Command.SET_CAMERA_FOCUS,
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
#: Drew UNSUPPORTED in every frame.
_REFUSED = frozenset(
    {
        Command.NAV_LOITER_TURNS,
        Command.NAV_SPLINE_WAYPOINT,
        Command.CONDITION_YAW,
        Command.DO_SET_RELAY,
        Command.DO_SET_SERVO,
        Command.DO_FENCE_ENABLE,
        Command.DO_PARACHUTE,
        Command.SET_CAMERA_ZOOM,
        Command.JUMP_TAG,
    }
)
#: Accepted by the protocol; the mission is then invalid.
_ACCEPTED_YET_INVALID = frozenset({Command.CONDITION_DELAY, Command.CONDITION_DISTANCE})
#: With a place (param 1 is 3) in a global frame, without one in frame 2.
_ROI = frozenset({Command.NAV_ROI, Command.DO_SET_ROI})
_ROI_LOCATION = 3
_ROI_WITHOUT_PLACE = frozenset({0, 1, 2})

_FRAMES: Mapping[int, Frame] = {
    Frame.GLOBAL: Frame.GLOBAL_INT,
    Frame.GLOBAL_INT: Frame.GLOBAL_INT,
    Frame.GLOBAL_RELATIVE_ALT: Frame.GLOBAL_RELATIVE_ALT_INT,
    Frame.GLOBAL_RELATIVE_ALT_INT: Frame.GLOBAL_RELATIVE_ALT_INT,
}


def _limits() -> dict[MissionType, int]:
    return {
        MissionType.MISSION: DEFAULT_MISSION_LIMIT,
        MissionType.FENCE: FENCE_LIMIT,
        MissionType.RALLY: RALLY_LIMIT,
    }


@dataclass(frozen=True, slots=True)
class Px4Dialect:
    """PX4 on one type of vehicle.

    Parameters
    ----------
    limits
        Items by type; ``replace`` it for a board that holds more items.
    landing_required
        MIS_TKO_LAND_REQ of 2 and more: missions must end in a landing, and RTL does not count.
    max_landing_slope_deg
        FW_LND_ANG.
    acceptance_radius_m
        NAV_ACC_RAD: a take-off must climb a metre higher than this.
    """

    name: str
    vehicle_type: VehicleType
    mav_type: int
    landing_required: bool
    limits: Mapping[MissionType, int] = field(default_factory=_limits)
    max_landing_slope_deg: float = 5.0
    acceptance_radius_m: float = 10.0
    autopilot: Autopilot = "px4"
    firmware_type: int = 12
    home_row: bool = False

    @property
    def fence_store(self) -> FenceStore:
        """Room for a fence."""
        return PX4_STORE

    def knows(self, command: int) -> bool:
        """Whether a table says if the command is taken in missions."""
        return any(
            command in commands for commands in (_PLACED, _PLACELESS, _REFUSED, _ACCEPTED_YET_INVALID, _ROI)
        )

    def answer(self, item: MissionItem) -> MissionResult:
        """What the autopilot answers to one item, looked at by itself; ACCEPTED to commands in no table."""
        if item.mission_type != MissionType.MISSION:
            return MissionResult.ACCEPTED if item.frame in _FRAMES else MissionResult.UNSUPPORTED_FRAME
        if item.frame not in _FRAMES and item.frame != Frame.MISSION:
            return MissionResult.UNSUPPORTED_FRAME
        placed = item.frame != Frame.MISSION
        if item.command in _ROI:
            taken = (
                item.param1 == _ROI_LOCATION or item.param1 == 0
                if placed
                else item.param1 in _ROI_WITHOUT_PLACE
            )
            return MissionResult.ACCEPTED if taken else MissionResult.INVALID_PARAM1
        if not self.knows(item.command):
            return MissionResult.ACCEPTED
        if placed:
            known = item.command in _PLACED
        else:
            known = item.command in _PLACELESS or item.command in _ACCEPTED_YET_INVALID
        return MissionResult.ACCEPTED if known else MissionResult.UNSUPPORTED

    def check(self, items: tuple[MissionItem, ...]) -> tuple[DialectFinding, ...]:
        """Everything wrong with a list; empty when it may be uploaded. No items mean "clear"."""
        return tuple(self._findings(items))

    def _findings(self, items: tuple[MissionItem, ...]) -> Iterator[DialectFinding]:
        yield from list_findings(items, self.limits)
        kind = mission_type_of(items)
        for item in items:
            if self.answer(item) == MissionResult.UNSUPPORTED_FRAME:
                yield DialectFinding(
                    "unsupported-frame", f"frame {item.frame} on command {item.command}", item.seq
                )
        if kind == MissionType.FENCE:
            yield from fence_findings(items, self.fence_store)
        elif kind == MissionType.RALLY:
            yield from _rally_findings(items)
        elif items:
            yield from self._mission_findings(items)

    def _mission_findings(self, items: tuple[MissionItem, ...]) -> Iterator[DialectFinding]:
        if not items[0].current:
            yield DialectFinding("current-not-first", "item 0 must be marked current", 0)
        for item in items[1:]:
            if item.current:
                yield DialectFinding("current-repeated", "PX4 would begin the mission here", item.seq)
        for item in items:
            result = self.answer(item)
            if not self.knows(item.command):
                yield unlisted_finding(self.name, item)
            if result == MissionResult.UNSUPPORTED:
                where = "frame 2" if item.frame == Frame.MISSION else "a global frame"
                yield DialectFinding(
                    "unsupported-command", f"{self.name} has no command {item.command} in {where}", item.seq
                )
            elif result == MissionResult.INVALID_PARAM1:
                yield DialectFinding("parameter", f"region of interest of kind {item.param1:g}", item.seq)
            elif item.command in _ACCEPTED_YET_INVALID:
                yield DialectFinding(
                    "invalidates-mission", f"command {item.command} makes the mission invalid", item.seq
                )
            if item.frame in _FRAMES:
                yield from place_findings(item, zero_means_here=False)
                if not finite(replace(item, param4=0.0)):
                    yield DialectFinding("nan-parameter", "only a yaw (param 4) may be NaN", item.seq)
        yield from jump_findings(items, first=0)
        yield from feasibility_findings(
            items,
            vehicle_type=self.vehicle_type,
            landing_required=self.landing_required,
            max_landing_slope_deg=self.max_landing_slope_deg,
            acceptance_radius_m=self.acceptance_radius_m,
        )

    def expected_readback(self, items: tuple[MissionItem, ...]) -> tuple[MissionItem, ...]:
        """The items as they come back after an upload."""
        return tuple(_back(item) for item in items)


def _back(item: MissionItem) -> MissionItem:
    frame = _FRAMES.get(item.frame, item.frame)
    if item.mission_type != MissionType.MISSION:
        keeps_first = item.mission_type == MissionType.FENCE
        return replace(
            item,
            # Fences are horizontal: their heights are not stored as relative ones.
            frame=Frame.GLOBAL_INT if keeps_first else frame,
            param1=item.param1 if keeps_first else 0.0,
            param2=0.0,
            param3=0.0,
            param4=0.0,
            z=0.0 if keeps_first else item.z,
        )
    command = int(Command.DO_SET_ROI) if item.command == Command.NAV_ROI else item.command
    if item.frame == Frame.MISSION:
        if item.command == Command.DO_JUMP and item.param2 == -1.0:
            return replace(item, param2=65535.0)
        return replace(item, command=command)
    kept = _PLACED.get(item.command, ("param1",))
    flags = _FLAGS.get(item.command, ())

    def stored(name: str) -> float:
        value = float(getattr(item, name))
        if name not in kept:
            return 0.0
        if name in flags:
            return 1.0 if value > 0.0 else 0.0
        if name == "param4" and item.command in _YAW and math.isfinite(value):
            # A hair below 0 gives 360 itself in binary.
            return value % 360.0 % 360.0
        return value

    return replace(
        item,
        command=command,
        frame=frame,
        param1=stored("param1"),
        param2=stored("param2"),
        param3=stored("param3"),
        param4=stored("param4"),
    )


def _rally_findings(items: tuple[MissionItem, ...]) -> Iterator[DialectFinding]:
    for item in items:
        if item.command != Command.NAV_RALLY_POINT:
            yield DialectFinding("unsupported-command", f"command {item.command} in a rally list", item.seq)
        if item.frame not in (Frame.GLOBAL, Frame.GLOBAL_RELATIVE_ALT):
            yield DialectFinding("rally-frame", f"frame {item.frame} is accepted, then unusable", item.seq)
        yield from place_findings(item, zero_means_here=False)


def px4_dialect(vehicle_type: VehicleType) -> Px4Dialect:
    """PX4 on a fixed wing, a multirotor or a VTOL, with default parameters."""
    if vehicle_type == "multirotor":
        return Px4Dialect("PX4 multirotor", vehicle_type, 2, landing_required=False)
    if vehicle_type == "vtol":
        return Px4Dialect("PX4 VTOL", vehicle_type, 22, landing_required=True)
    return Px4Dialect("PX4 fixed wing", vehicle_type, 1, landing_required=True)
