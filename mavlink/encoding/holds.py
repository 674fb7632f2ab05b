"""Waiting in the air as a plan has it: whole level circles back to where they began.

ArduPlane counts turns (LOITER_TURNS), PX4's wings count time (LOITER_TIME: they know no turns). What hovers
has no item for circles of a speed: it flies them point by point.
"""

from __future__ import annotations

import math
from dataclasses import replace

from mavlink.dialects.mission import placed
from mavlink.encoding.arcs import circle_item, widened
from mavlink.encoding.stops import is_whole_turns
from mavlink.encoding.task import Task
from mavlink.wire.geometry import LocalMap
from mavlink.wire.items import Command, Frame, MissionItem
from planner.plan import FlownPath, PathSegment, PlanWind

#: Circles that rise or fall by less are level.
_LEVEL_M = 0.5
#: Of one turn so much is counted; what is left of it is flown until the next place lies ahead.
_COUNTED_OF_ONE = 0.75
#: Courses over which the time of a circle in a wind is summed.
_COURSES = 72


def is_hold(path: FlownPath, segment: PathSegment) -> bool:
    """Whether a segment of a path is waited in: whole turns of the mission that are level."""
    mission = path.phase("mission")
    if mission is None or not is_whole_turns(segment):
        return False
    middle_m = segment.start_m + segment.length_m / 2.0
    rise_m = abs(segment.end_altitude_m - segment.start_altitude_m)
    return rise_m < _LEVEL_M and mission.start_m < middle_m < mission.end_m


def hold_item(task: Task, turns: PathSegment) -> MissionItem:
    """What is waited, as the autopilot counts it; left towards the place behind it."""
    if turns.turn_deg is None or turns.centre is None:
        raise ValueError(f"the segment at {turns.start_m:g} m is no turn")
    item = circle_item(task, turns, Command.NAV_LOITER_UNLIM)
    if task.is_plane:
        count = max(1.0, float(round(turns.turn_deg / 360.0)))
        # Counted once it is on the circle: a whole turn may end past where the next place lies ahead, and is
        # then followed by another. More than one turn is stored as a whole number.
        count = _COUNTED_OF_ONE if count == 1.0 else count
        return replace(item, command=Command.NAV_LOITER_TURNS, param1=count, param4=1.0)
    above_sea_m = turns.end_altitude_m + (0.0 if task.frame == Frame.GLOBAL else task.options.home_altitude_m)
    speed_m_s = task.vehicle.airspeed_m_s * math.sqrt(widened(above_sea_m))
    time_s = float(round(circling_s(turns.length_m, speed_m_s, task.plan.wind), 1))
    parameters = (time_s, 1.0, item.param3, 1.0)
    return placed(Command.NAV_LOITER_TIME, turns.centre, turns.end_altitude_m, task.frame, parameters)


def circling_s(length_m: float, speed_m_s: float, wind: PlanWind) -> float:
    """How long whole circles over the ground take in a wind."""
    slowness = 0.0
    for number in range(_COURSES):
        off_rad = math.tau * number / _COURSES
        across = wind.speed_m_s * math.sin(off_rad)
        slowness += 1.0 / (wind.speed_m_s * math.cos(off_rad) + math.sqrt(speed_m_s**2 - across**2))
    return length_m * slowness / _COURSES


def unwound(path: FlownPath, local: LocalMap) -> FlownPath:
    """A path whose holds are half circles, each an arc like any other."""
    segments: list[PathSegment] = []
    for segment in path.segments:
        if segment.centre is None or segment.turn_deg is None or not is_hold(path, segment):
            segments.append(segment)
            continue
        (east, north), (middle_east, middle_north) = local.xy(segment.start), local.xy(segment.centre)
        across = local.lonlat((2.0 * middle_east - east, 2.0 * middle_north - north))
        ends = (segment.start, across)
        count = max(2, 2 * round(segment.turn_deg / 360.0))
        part_m = segment.length_m / count
        segments += [
            replace(
                segment,
                start=ends[k % 2],
                end=ends[(k + 1) % 2],
                start_m=segment.start_m + k * part_m,
                length_m=part_m,
                turn_deg=segment.turn_deg / count,
            )
            for k in range(count)
        ]
    return replace(path, segments=tuple(segments))
