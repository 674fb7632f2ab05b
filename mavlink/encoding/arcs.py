"""Arcs of the path that the autopilot flies better round their centre than along points.

ArduPlane alone: PX4 refuses NAV_LOITER_TURNS, and ArduCopter holds lines to within a metre. What was measured
stands in docs/ardupilot.md. Source: MAV_CMD_NAV_LOITER_TURNS of common.xml; ``verify_loiter_turns`` and
``ModeLoiter::isHeadingLinedUp`` of ArduPlane, ``loiter_radius`` of its AP_L1_Control.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise

from mavlink.dialects.mission import Mission, placed
from mavlink.encoding.options import EncodeError
from mavlink.encoding.stops import WHOLE_TURN_DEG, is_whole_turns
from mavlink.encoding.task import Task
from mavlink.wire.items import Command, Frame, MissionItem
from planner.plan import PathSegment

#: A turn is left as soon as the course is within 10° of the bearing of the next waypoint, the arc's end. On
#: the circle that is seen along a chord: 20° before it. A shorter arc would be left where it begins.
_LEFT_BEFORE_DEG = 20.0
#: From here on the line behind is met sooner than behind points, with room to spare for being left too late:
#: that would be another whole circle.
_WORTH_IT_DEG = 60.0
#: Stored in whole metres; larger ones in tens, and a large circle widens by more metres with height.
_LARGEST_M = 250.0
#: An item has one height.
_LEVEL_M = 1.0
#: How much of an arc must be flown before it may be left: without any, a nearly full circle would be left at
#: once. Not much, for what is flown before the circle is met does not count, and an arc whose end is passed
#: before enough was counted is flown for another whole circle.
_COUNTED_PART = 0.25
#: Places inside a circle are left for within 10° of the course abeam of them, later than those on it: the
#: line behind is met sooner. So circles are up to this much wider than their arcs, in whole metres.
_WIDER_M = 2.0
#: Turns below one are stored in such parts.
_TURN_STEPS = 256.0


def flown_round(task: Task) -> Callable[[PathSegment], bool]:
    """Whether an arc becomes a turn round its centre.

    Not right behind whole turns: those are left towards the next item, which must not be a centre.
    """
    arcs = task.options.arcs
    if arcs == "loiter" and not task.is_plane:
        raise EncodeError(
            f"arcs are to be loiter turns, which {task.dialect.name} does not fly in missions: ask for points"
        )
    if arcs == "points" or not task.is_plane:
        return lambda _: False
    least_deg = _WORTH_IT_DEG if arcs == "auto" else _LEFT_BEFORE_DEG

    behind_turns = {behind for before, behind in pairwise(task.path.segments) if is_whole_turns(before)}

    def suits(segment: PathSegment) -> bool:
        if segment.turn_deg is None or segment.radius_m is None or segment.centre is None:
            return False
        rise_m = abs(segment.end_altitude_m - segment.start_altitude_m)
        return (
            least_deg < segment.turn_deg < WHOLE_TURN_DEG
            and segment.radius_m <= _LARGEST_M
            and rise_m <= _LEVEL_M
            and segment not in behind_turns
        )

    return suits


def turn_item(task: Task, arc: PathSegment, altitude_m: float) -> MissionItem:
    """An arc as NAV_LOITER_TURNS, left towards the waypoint behind it; ``altitude_m`` in the path's frame."""
    if arc.centre is None or arc.turn_deg is None:
        raise ValueError(f"the segment at {arc.start_m:g} m is no arc")
    above_sea_m = altitude_m + (0.0 if task.frame == Frame.GLOBAL else task.options.home_altitude_m)
    radius_m = math.floor(arc.length_m / math.radians(arc.turn_deg) / widened(above_sea_m)) + _WIDER_M
    turns = math.floor(_COUNTED_PART * arc.turn_deg / 360.0 * _TURN_STEPS) / _TURN_STEPS
    # Param 4: the line that follows counts from where the circle is left, not from its centre.
    parameters = (turns, 0.0, radius_m if arc.kind == "right" else -radius_m, 1.0)
    return placed(Command.NAV_LOITER_TURNS, arc.centre, altitude_m, task.frame, parameters)


def circle_item(task: Task, turns: PathSegment, command: int) -> MissionItem:
    """Whole turns as a circle that is flown to its end altitude (LOITER_TO_ALT), or on and on (LOITER_UNLIM).

    The item's radius is positive clockwise.
    """
    if turns.centre is None or turns.turn_deg is None or turns.radius_m is None:
        raise ValueError(f"the segment at {turns.start_m:g} m is no turn")
    radius_m = turns.radius_m
    if task.is_plane:
        middle_m = 0.5 * (turns.start_altitude_m + turns.end_altitude_m)
        above_sea_m = middle_m + (0.0 if task.frame == Frame.GLOBAL else task.options.home_altitude_m)
        radius_m = float(round(radius_m / widened(above_sea_m)))
    signed_m = radius_m if turns.kind == "right" else -radius_m
    if command == Command.NAV_LOITER_TO_ALT:
        # ArduPilot always waits for the heading and stores no flag for it; PX4 must be told. The 1 in the end
        # makes both fly the line from where they leave the circle, not from its centre.
        parameters = (1.0 if task.is_px4 else 0.0, signed_m, 0.0, 1.0)
    else:
        parameters = (0.0, 0.0, signed_m, task.any_yaw)
    return placed(command, turns.centre, turns.end_altitude_m, task.frame, parameters)


def circles_widen_m(mission: Mission, home_altitude_m: float) -> float:
    """By how much, at most, ArduPlane circles wider from a home at this height than was encoded for."""
    return max(
        (
            abs(item.param3) * (widened(home_altitude_m + item.z) - widened(mission.home_altitude_m + item.z))
            for item in mission.mission
            if item.command == Command.NAV_LOITER_TURNS and item.frame == Frame.GLOBAL_RELATIVE_ALT
        ),
        default=0.0,
    )


def widened(above_sea_m: float) -> float:
    """How much wider than asked ArduPlane circles: the square of true over equivalent airspeed.

    That is the inverse of the air's density over that at sea level, in the standard atmosphere below 11 km.
    """
    return float((1.0 - 2.25577e-5 * min(max(above_sea_m, 0.0), 11_000.0)) ** -4.25588)
