"""Both ends of a mission as the plan has them: the take-off; the landing, the return or the last circle."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import takewhile

from mavlink.dialects.mission import placed, unplaced
from mavlink.encoding.arcs import circle_item
from mavlink.encoding.options import EncodeError
from mavlink.encoding.speeds import speed_item
from mavlink.encoding.task import Task
from mavlink.wire.geometry import distance_m
from mavlink.wire.items import Command, Frame, MissionItem
from planner.plan import LonLat

#: A flight that ends further from home than this ends on ground whose height is not known.
_ELSEWHERE_M = 200.0


@dataclass(frozen=True, slots=True)
class End:
    """The items of one end, and notes for people."""

    items: tuple[MissionItem, ...]
    notes: tuple[str, ...] = ()


def beginning(task: Task) -> End:
    """Take-off, and cruise speed; the speed alone where the plan begins in the air."""
    speed = speed_item(task, task.vehicle.airspeed_m_s)
    if task.path.phase("take_off") is None:
        return End((speed,))
    return End((_takeoff(task), speed))


def _takeoff(task: Task) -> MissionItem:
    """What takes it to where the plan's take-off ends; straight up as far as the plan goes straight up."""
    lifted = list(takewhile(lambda segment: segment.kind == "vertical", task.path.segments))
    up_m = max((segment.end_altitude_m for segment in lifted), default=task.path.line[0][2])
    parameters = (0.0, 0.0, 0.0, task.any_yaw)
    relative = Frame.GLOBAL_RELATIVE_ALT
    if task.hovers:
        return placed(Command.NAV_TAKEOFF, task.plan.home, task.over_home_m(up_m), relative, parameters)
    vtol = task.vehicle.type == "vtol"
    if vtol and not task.is_px4:
        return placed(Command.NAV_VTOL_TAKEOFF, task.plan.home, task.over_home_m(up_m), relative, parameters)
    # PX4's VTOLs hover up where they stand, turn to the take-off's place, and speed up towards it.
    command = Command.NAV_VTOL_TAKEOFF if vtol else Command.NAV_TAKEOFF
    place, altitude_m = _take_off_end(task)
    return placed(command, place, task.over_home_m(altitude_m), relative, parameters)


def _take_off_end(task: Task) -> tuple[LonLat, float]:
    end_m = task.phase_end_m("take_off")
    last = next(s for s in task.path.segments if s.start_m + s.length_m >= end_m - 1e-6)
    return last.end, last.end_altitude_m


def ending(task: Task) -> End:
    """Landing, return or circling, as the plan has it."""
    finish = task.vehicle.finish
    if task.is_px4 and not task.hovers and finish != "land":
        raise EncodeError(
            f"{task.dialect.name} takes no mission without a landing (MIS_TKO_LAND_REQ), the plan's finish is"
            f" {finish!r}: plan again with finish 'land' of vehicle {task.vehicle.name}"
        )
    if finish == "return":
        return End((unplaced(Command.NAV_RETURN_TO_LAUNCH),), _return_notes(task))
    if finish == "loiter":
        return End((_circling(task),))
    notes: tuple[str, ...] = ()
    if distance_m(task.plan.home, task.plan.end) > _ELSEWHERE_M and task.plan.altitude_reference != "amsl":
        notes = ("the ground at the end is taken to be as high as home",)
    return End((_land(task),), notes)


def _circling(task: Task) -> MissionItem:
    turns = task.last_turns
    if turns is None:
        parameters = (0.0, 0.0, 0.0, task.any_yaw)
        return placed(Command.NAV_LOITER_UNLIM, task.plan.end, task.path.line[-1][2], task.frame, parameters)
    return circle_item(task, turns, Command.NAV_LOITER_UNLIM)


def _return_notes(task: Task) -> tuple[str, ...]:
    """What becomes of an aircraft whose mission ends in a return."""
    if not task.is_plane:
        return ()
    if task.vehicle.type == "vtol":
        return (
            "the return circles over home unless Q_RTL_MODE has it land there: else the landing is left to"
            " the pilot; plan with finish 'land' to land at the plan's end",
        )
    return (
        "the return circles over home: the landing is left to the pilot; plan with finish 'land' to land at"
        " the plan's end",
    )


def _land(task: Task) -> MissionItem:
    if task.vehicle.type == "vtol":
        command, yaw = Command.NAV_VTOL_LAND, task.any_yaw
    else:
        # ArduPilot stores the sign of LAND's param 4 alone; 1 is what it gives back for none.
        command, yaw = Command.NAV_LAND, math.nan if task.is_px4 else 1.0
    # Counted from where the approach before it is: PX4 wants both alike.
    height_m = round(float(task.path.line[-1][2]), 3)
    return placed(command, task.plan.end, height_m, task.frame, (0.0, 0.0, 0.0, yaw))
