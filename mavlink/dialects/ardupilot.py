"""ArduPilot: Plane and Copter, measured on 4.6-dev.

A parameter table says, command by command, what is stored of each of the four parameters: ArduPilot keeps
missions in a few bytes an item, so most numbers come back whole, limited or as 0.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Literal

from mavlink.dialects.base import (
    PARAMETERS,
    Autopilot,
    DialectFinding,
    fence_findings,
    jump_findings,
    list_findings,
    mission_type_of,
    place_findings,
    unlisted_finding,
)
from mavlink.dialects.stores import ARDUCOPTER_STORE, ARDUPLANE_STORE, FenceStore
from mavlink.wire.items import Command, Frame, MissionItem, MissionResult, MissionType

Keep = Callable[[float], float]


def _zero(_: float) -> float:
    return 0.0


def _same(value: float) -> float:
    return value


def _whole(value: float) -> float:
    return float(math.trunc(value)) if math.isfinite(value) else value


def _byte(value: float) -> float:
    return float(min(255, max(0, math.trunc(value)))) if math.isfinite(value) else value


def _sign(value: float) -> float:
    return -1.0 if value < 0.0 else 1.0


def _flag(value: float) -> float:
    return 1.0 if value > 0.0 else 0.0


def _turns(value: float) -> float:
    # A part of a turn is stored in 1/256.
    return math.floor(value * 256.0) / 256.0 if 0.0 < value < 1.0 else _byte(value)


def _radius_byte(value: float) -> float:
    if math.isnan(value):
        return value  # refused, but the comparison after a refusal must still be possible
    size = min(abs(value), 2550.0)
    return math.copysign(math.trunc(size) if size <= 255.0 else math.trunc(size / 10.0) * 10.0, value)


#: Altitudes from here on draw INVALID_PARAM7.
_HIGHEST_M = 83_000.0

_Row = tuple[Keep, Keep, Keep, Keep]
_NOTHING: _Row = (_zero, _zero, _zero, _zero)
_FIRST: _Row = (_same, _zero, _zero, _zero)
_ALL: _Row = (_same, _same, _same, _same)

#: What is stored of the parameters, on both vehicles.
_COMMON: Mapping[int, _Row] = {
    Command.NAV_LOITER_UNLIM: (_zero, _zero, _whole, _zero),
    Command.NAV_LOITER_TURNS: (_turns, _zero, _radius_byte, _flag),
    Command.NAV_LOITER_TIME: (_whole, _zero, _sign, _flag),
    Command.NAV_RETURN_TO_LAUNCH: _NOTHING,
    Command.NAV_LAND: (_whole, _zero, _zero, _sign),
    Command.NAV_TAKEOFF: (_whole, _zero, _zero, _zero),
    Command.NAV_LOITER_TO_ALT: (_zero, _whole, _zero, _flag),
    Command.NAV_VTOL_TAKEOFF: _NOTHING,
    Command.NAV_VTOL_LAND: (_whole, _zero, _zero, _zero),
    Command.NAV_DELAY: (_same, _whole, _whole, _whole),
    Command.CONDITION_DELAY: _FIRST,
    Command.CONDITION_DISTANCE: _FIRST,
    Command.CONDITION_YAW: (_same, _same, _whole, _whole),
    Command.DO_JUMP: (_whole, _whole, _zero, _zero),
    Command.DO_CHANGE_SPEED: (_whole, _same, _same, _zero),
    Command.DO_SET_HOME: (_whole, _zero, _zero, _zero),
    Command.DO_SET_RELAY: (_whole, _whole, _zero, _zero),
    Command.DO_SET_SERVO: (_whole, _whole, _zero, _zero),
    Command.DO_LAND_START: _NOTHING,
    Command.DO_SET_ROI: (_whole, _zero, _zero, _zero),
    Command.DO_DIGICAM_CONTROL: (_whole, _whole, _whole, _whole),
    Command.DO_MOUNT_CONTROL: (_same, _same, _same, _zero),
    Command.DO_SET_CAM_TRIGG_DIST: (_same, _zero, _whole, _zero),
    Command.DO_FENCE_ENABLE: (_whole, _zero, _zero, _zero),
    Command.DO_PARACHUTE: (_whole, _zero, _zero, _zero),
    Command.DO_GRIPPER: (_whole, _whole, _zero, _zero),
    Command.DO_WINCH: (_whole, _whole, _same, _same),
    Command.DO_PAUSE_CONTINUE: (_whole, _zero, _zero, _zero),
    Command.JUMP_TAG: (_whole, _zero, _zero, _zero),
    Command.DO_GIMBAL_MANAGER_PITCHYAW: (_whole, _whole, _whole, _whole),
    Command.IMAGE_START_CAPTURE: (_whole, _same, _whole, _whole),
    Command.IMAGE_STOP_CAPTURE: (_whole, _zero, _zero, _zero),
    Command.SET_CAMERA_ZOOM: (_whole, _same, _zero, _zero),
    Command.SET_CAMERA_FOCUS: (_whole, _same, _zero, _zero),
    Command.VIDEO_START_CAPTURE: (_whole, _zero, _zero, _zero),
    Command.VIDEO_STOP_CAPTURE: (_whole, _zero, _zero, _zero),
}
#: Passing a waypoint: Plane stores acceptance radius and pass-by distance, Copter the delay.
_PLANE: Mapping[int, _Row] = MappingProxyType({**_COMMON, Command.NAV_WAYPOINT: (_zero, _byte, _byte, _zero)})
_COPTER: Mapping[int, _Row] = MappingProxyType(
    {
        **_COMMON,
        Command.NAV_WAYPOINT: (_whole, _zero, _zero, _zero),
        Command.NAV_SPLINE_WAYPOINT: (_whole, _zero, _zero, _zero),
    }
)

#: Drew UNSUPPORTED, on both vehicles; Plane refuses splines too.
_REFUSED = frozenset(
    {
        Command.NAV_ROI,
        Command.CONDITION_GATE,
        Command.DO_SET_MODE,
        Command.DO_SET_ACTUATOR,
        Command.DO_REPOSITION,
        Command.DO_SET_ROI_LOCATION,
        Command.DO_SET_ROI_WPNEXT_OFFSET,
        Command.DO_SET_ROI_NONE,
        Command.SET_CAMERA_MODE,
        Command.DO_SET_CAM_TRIGG_INTERVAL,
        Command.DO_TRIGGER_CONTROL,
        Command.DO_GIMBAL_MANAGER_CONFIGURE,
    }
)

#: Commands stored with a place; all others come back in frame 0 without one.
_PLACED = frozenset(
    {
        Command.NAV_WAYPOINT,
        Command.NAV_LOITER_UNLIM,
        Command.NAV_LOITER_TURNS,
        Command.NAV_LOITER_TIME,
        Command.NAV_LAND,
        Command.NAV_TAKEOFF,
        Command.NAV_LOITER_TO_ALT,
        Command.NAV_SPLINE_WAYPOINT,
        Command.NAV_VTOL_TAKEOFF,
        Command.NAV_VTOL_LAND,
        Command.DO_SET_HOME,
        Command.DO_LAND_START,
        Command.DO_SET_ROI,
    }
)
#: Commands whose x, y, z survive although they are no place.
_RAW_XY = frozenset({Command.DO_DIGICAM_CONTROL})
_RAW_XYZ = frozenset({Command.DO_GIMBAL_MANAGER_PITCHYAW})
#: 0, 0 means "where it is" for these, and DO items need no place.
_HERE = frozenset({Command.NAV_TAKEOFF, Command.NAV_VTOL_TAKEOFF, Command.DO_LAND_START, Command.DO_SET_HOME})

_FRAMES: Mapping[int, Frame] = {
    Frame.GLOBAL: Frame.GLOBAL,
    Frame.MISSION: Frame.GLOBAL,
    Frame.GLOBAL_INT: Frame.GLOBAL,
    Frame.GLOBAL_RELATIVE_ALT: Frame.GLOBAL_RELATIVE_ALT,
    Frame.GLOBAL_RELATIVE_ALT_INT: Frame.GLOBAL_RELATIVE_ALT,
    Frame.GLOBAL_TERRAIN_ALT: Frame.GLOBAL_TERRAIN_ALT,
    Frame.GLOBAL_TERRAIN_ALT_INT: Frame.GLOBAL_TERRAIN_ALT,
}
#: Parameters that may be NaN, by command.
_NAN_TAKEN: Mapping[int, frozenset[str]] = {
    Command.NAV_WAYPOINT: frozenset({"param4"}),
    Command.NAV_TAKEOFF: frozenset({"param4"}),
    Command.NAV_LAND: frozenset({"param4"}),
    Command.NAV_VTOL_TAKEOFF: frozenset({"param4"}),
    Command.NAV_VTOL_LAND: frozenset({"param3", "param4"}),
}
_NAN_ANSWER = {
    "param1": MissionResult.INVALID_PARAM1,
    "param2": MissionResult.INVALID_PARAM2,
    "param3": MissionResult.INVALID_PARAM3,
    "param4": MissionResult.INVALID_PARAM4,
}


@dataclass(frozen=True, slots=True)
class ArduPilotDialect:
    """ArduPilot on one type of vehicle."""

    name: str
    vehicle_type: Literal["fixed_wing", "multirotor", "vtol"]
    mav_type: int
    limits: Mapping[MissionType, int]
    table: Mapping[int, _Row] = field(repr=False)
    refused: frozenset[int] = field(repr=False)
    autopilot: Autopilot = "ardupilot"
    firmware_type: int = 3
    home_row: bool = True

    @property
    def fence_store(self) -> FenceStore:
        """Room for a fence on the boards that are common."""
        return ARDUCOPTER_STORE if self.vehicle_type == "multirotor" else ARDUPLANE_STORE

    def knows(self, command: int) -> bool:
        """Whether a table says if the command is taken in missions."""
        return command in self.table or command in self.refused

    def answer(self, item: MissionItem) -> MissionResult:
        """What the autopilot answers to one item, looked at by itself; ACCEPTED to commands in no table."""
        if item.mission_type != MissionType.MISSION or item.seq == 0:
            return MissionResult.ACCEPTED
        if item.command in self.refused:
            return MissionResult.UNSUPPORTED
        taken = _NAN_TAKEN.get(item.command, frozenset())
        for name in PARAMETERS:
            if math.isnan(getattr(item, name)) and name not in taken:
                return _NAN_ANSWER[name]
        if item.command in _PLACED:
            if abs(item.x) > 900_000_000:
                return MissionResult.INVALID_PARAM5_X
            if abs(item.y) > 1_800_000_000:
                return MissionResult.INVALID_PARAM6_Y
            if not abs(item.z) < _HIGHEST_M:
                return MissionResult.INVALID_PARAM7
            if item.frame not in _FRAMES:
                return MissionResult.UNSUPPORTED_FRAME
        return MissionResult.ACCEPTED

    def check(self, items: tuple[MissionItem, ...]) -> tuple[DialectFinding, ...]:
        """Everything wrong with a list; empty when it may be uploaded. No items mean "clear"."""
        return tuple(self._findings(items))

    def _findings(self, items: tuple[MissionItem, ...]) -> Iterator[DialectFinding]:
        yield from list_findings(items, self.limits)
        kind = mission_type_of(items)
        if kind == MissionType.FENCE:
            yield from fence_findings(items, self.fence_store)
        elif kind == MissionType.RALLY:
            yield from _rally_findings(items)
        elif items:
            yield from self._mission_findings(items)

    def _mission_findings(self, items: tuple[MissionItem, ...]) -> Iterator[DialectFinding]:
        home = items[0]
        if home.command != Command.NAV_WAYPOINT or home.frame not in (Frame.GLOBAL, Frame.GLOBAL_INT):
            yield DialectFinding(
                "home-row-missing", f"item 0 is home and would be dropped, here command {home.command}", 0
            )
        for item in items[1:]:
            result = self.answer(item)
            if not self.knows(item.command):
                yield unlisted_finding(self.name, item)
            if result == MissionResult.UNSUPPORTED:
                yield DialectFinding(
                    "unsupported-command", f"{self.name} has no command {item.command}", item.seq
                )
            elif result == MissionResult.UNSUPPORTED_FRAME:
                yield DialectFinding(
                    "unsupported-frame", f"frame {item.frame} on command {item.command}", item.seq
                )
            elif result in _NAN_ANSWER.values():
                yield DialectFinding(
                    "nan-parameter", f"NaN draws {result.name} on command {item.command}", item.seq
                )
            if item.command in _PLACED:
                yield from place_findings(item, zero_means_here=item.command in _HERE)
            if item.command == Command.NAV_VTOL_LAND and self.vehicle_type == "fixed_wing":
                yield DialectFinding("skipped-command", "a fixed wing skips VTOL_LAND silently", item.seq)
        yield from jump_findings(items, first=1)
        yield from _landing_findings(items)

    def expected_readback(self, items: tuple[MissionItem, ...]) -> tuple[MissionItem, ...]:
        """The items as they come back after an upload, without the home row."""
        kind = mission_type_of(items)
        if kind == MissionType.FENCE:
            return tuple(self._fence_back(item) for item in items)
        if kind == MissionType.RALLY:
            return tuple(_rally_back(item) for item in items)
        return tuple(self._mission_back(item) for item in items if item.seq != 0)

    def _mission_back(self, item: MissionItem) -> MissionItem:
        row = self.table.get(item.command, _ALL)
        param1, param2, param3, param4 = (
            keep(getattr(item, name)) for keep, name in zip(row, PARAMETERS, strict=True)
        )
        back = replace(
            item,
            param1=param1,
            param2=param2,
            param3=param3,
            param4=param4,
            current=False,
            autocontinue=True,
        )
        if item.command in _PLACED:
            return replace(back, frame=_FRAMES.get(item.frame, item.frame), z=_centimetres(item.z))
        if item.command in _RAW_XYZ:
            return replace(back, frame=Frame.GLOBAL)
        if item.command in _RAW_XY:
            return replace(back, frame=Frame.GLOBAL, z=0.0)
        return replace(back, frame=Frame.GLOBAL, x=0, y=0, z=0.0)

    def _fence_back(self, item: MissionItem) -> MissionItem:
        return replace(
            item,
            frame=Frame.GLOBAL,
            param2=0.0,
            param3=0.0,
            param4=0.0,
            z=0.0,
            current=False,
            autocontinue=True,
        )


def _centimetres(altitude_m: float) -> float:
    if not math.isfinite(altitude_m):
        return altitude_m  # refused, like every NaN
    # A hair is added first: 0.29 is a little less than 29 hundredths in binary.
    return math.copysign(math.trunc(abs(altitude_m) * 100.0 + 1e-3) / 100.0, altitude_m)


def _rally_back(item: MissionItem) -> MissionItem:
    return replace(
        item,
        frame=Frame.GLOBAL_RELATIVE_ALT,
        param1=0.0,
        param2=0.0,
        param3=0.0,
        param4=0.0,
        z=_whole(item.z),
        current=False,
        autocontinue=True,
    )


def _rally_findings(items: tuple[MissionItem, ...]) -> Iterator[DialectFinding]:
    for item in items:
        if item.command != Command.NAV_RALLY_POINT:
            yield DialectFinding("unsupported-command", f"command {item.command} in a rally list", item.seq)
        if item.frame not in (Frame.GLOBAL_RELATIVE_ALT, Frame.GLOBAL_RELATIVE_ALT_INT):
            yield DialectFinding(
                "rally-frame", f"frame {item.frame}: rally heights count from home", item.seq
            )
        yield from place_findings(item, zero_means_here=False)


def _landing_findings(items: tuple[MissionItem, ...]) -> Iterator[DialectFinding]:
    starts = [item for item in items[1:] if item.command == Command.DO_LAND_START]
    if starts:
        yield DialectFinding(
            "land-start-arming",
            "DO_LAND_START with RTL_AUTOLAND 0 is accepted, and arming is then refused",
            starts[0].seq,
            severity="warning",
        )


def ardupilot_dialect(
    vehicle_type: Literal["fixed_wing", "multirotor", "vtol"],
) -> ArduPilotDialect:
    """ArduPlane for fixed wings and VTOL, ArduCopter for multirotors."""
    if vehicle_type == "multirotor":
        return ArduPilotDialect("ArduCopter", vehicle_type, 2, {MissionType.MISSION: 650}, _COPTER, _REFUSED)
    mav_type = 1 if vehicle_type == "fixed_wing" else 20
    refused = _REFUSED | {Command.NAV_SPLINE_WAYPOINT}
    return ArduPilotDialect("ArduPlane", vehicle_type, mav_type, {MissionType.MISSION: 655}, _PLANE, refused)
