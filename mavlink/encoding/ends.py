"""Both ends of a mission: take-off and climb, return or landing."""

from __future__ import annotations

import math
from dataclasses import dataclass

from mavlink.dialects.mission import placed, unplaced
from mavlink.encoding.manoeuvres import climb_orbit, landing, takeoff_place
from mavlink.encoding.options import EncodeError
from mavlink.encoding.stops import MERGE_M
from mavlink.encoding.task import Task
from mavlink.wire.geometry import Xy, distance_m
from mavlink.wire.items import Command, Frame, MissionItem

_HOME: Xy = (0.0, 0.0)
_AIRSPEED = 0.0
_GROUND_SPEED = 1.0
_KEEP_THROTTLE = -1.0
#: VTOLs hover down from the end of their approach: it need not be flat, only long enough to stop in.
_VTOL_SLOPE_DEG = 45.0
#: Q_TRANS_DECEL of ArduPlane and VT_B_DEC_MSS of PX4, by default.
_VTOL_BRAKING_M_S2 = 2.0
#: PX4's VTOLs speed up towards their take-off's place, for VT_TRANS_TIMEOUT at most; half of that is usual.
_VTOL_SPEED_UP_S = 7.5
#: ArduPlane refuses to arm with an approach under 0.75 of the stopping distance.
_VTOL_STOPS = 1.5


@dataclass(frozen=True, slots=True)
class End:
    """The items of one end, and notes for people.

    Parameters
    ----------
    skipped_m
        Up to where the path is flown by these items already; -inf where it is flown whole.
    """

    items: tuple[MissionItem, ...]
    notes: tuple[str, ...] = ()
    skipped_m: float = -math.inf


def beginning(task: Task) -> End:
    """Take-off, climb to the plan's altitude, cruise speed."""
    kind = _GROUND_SPEED if task.hovers else _AIRSPEED
    speed_m_s = round(task.vehicle.airspeed_m_s, 3)
    speed = unplaced(Command.DO_CHANGE_SPEED, (kind, speed_m_s, _KEEP_THROTTLE, 0.0))
    if task.hovers:
        parameters = (0.0, 0.0, 0.0, task.any_yaw)
        takeoff = placed(Command.NAV_TAKEOFF, task.plan.home, task.plan.altitude_m, task.frame, parameters)
        return End((takeoff, speed))
    angle_rad = task.direction_rad(task.path.segments[0], at_start=True)
    start = task.local.xy(task.path.segments[0].start)
    orbit = climb_orbit(start, angle_rad, task.orbit_radius_m, task.free_straight_m, task.room)
    climb = _loiter_to(task, orbit.centre, orbit.radius_m, task.plan.altitude_m, task.frame)
    notes = []
    if orbit.outside_m2 > 0.0:
        notes.append(f"the climb circle leaves the fence: {orbit.outside_m2:.0f} m² lie outside")
    skipped_m = -math.inf
    if orbit.leave_m is not None and orbit.leave_m >= 0.0:
        # The circle is left on the path itself; the start lies behind, where no tangent leads to.
        skipped_m = orbit.leave_m + MERGE_M
        notes.append(f"the path is joined {orbit.leave_m:.0f} m past its start, where the climb has room")
    return End((_takeoff(task, angle_rad), climb, speed), tuple(notes), skipped_m)


def _takeoff(task: Task, angle_rad: float) -> MissionItem:
    height_m = min(task.options.takeoff_altitude_m, task.altitude_over_home_m)
    parameters = (0.0, 0.0, 0.0, task.any_yaw)
    vtol = task.vehicle.type == "vtol"
    if vtol and not task.is_px4:
        return placed(
            Command.NAV_VTOL_TAKEOFF, task.plan.home, height_m, Frame.GLOBAL_RELATIVE_ALT, parameters
        )
    # PX4 hovers up where it stands, turns to the take-off's place, and speeds up towards it.
    command = Command.NAV_VTOL_TAKEOFF if vtol else Command.NAV_TAKEOFF
    run_m = (
        _VTOL_SPEED_UP_S * task.vehicle.airspeed_m_s
        if vtol
        else height_m / math.tan(math.radians(max(1.0, task.vehicle.max_climb_deg)))
    )
    place = task.local.lonlat(takeoff_place(_HOME, angle_rad, run_m, task.room))
    return placed(command, place, height_m, Frame.GLOBAL_RELATIVE_ALT, parameters)


def _loiter_to(task: Task, centre: Xy, radius_m: float, altitude_m: float, frame: int) -> MissionItem:
    # ArduPilot always waits for the heading and stores no flag for it; PX4 must be told. The 1 in the end
    # makes both fly the line from where they leave the circle, not from its centre.
    wait = 1.0 if task.is_px4 else 0.0
    return placed(
        Command.NAV_LOITER_TO_ALT,
        task.local.lonlat(centre),
        altitude_m,
        frame,
        (wait, radius_m, 0.0, 1.0),
    )


def ending(task: Task) -> End:
    """Return, landing or circling, as the options and the autopilot have it."""
    away_m = distance_m(task.plan.home, task.plan.end)
    must_land = task.is_px4 and not task.hovers
    finish = task.options.finish
    if finish == "auto":
        finish = "rtl" if away_m <= task.options.near_home_m and not must_land else "land"
    if must_land and finish != "land":
        raise EncodeError(
            f"{task.dialect.name} takes no mission without a landing (MIS_TKO_LAND_REQ), finish is {finish!r}"
        )
    if finish == "rtl":
        return End((unplaced(Command.NAV_RETURN_TO_LAUNCH),), _return_notes(task))
    if finish == "loiter":
        radius_m = 0.0 if task.hovers else task.orbit_radius_m
        parameters = (0.0, 0.0, radius_m, task.any_yaw)
        return End(
            (placed(Command.NAV_LOITER_UNLIM, task.plan.end, task.plan.altitude_m, task.frame, parameters),)
        )
    notes: tuple[str, ...] = ()
    if away_m > task.options.near_home_m:
        notes = ("the ground at the end is taken to be as high as home",)
    landed = _land(task) if task.hovers else _approach_and_land(task)
    return End(landed.items, notes + landed.notes)


def _return_notes(task: Task) -> tuple[str, ...]:
    """What becomes of an aircraft whose mission ends in a return."""
    if not task.is_plane:
        return ()
    if task.vehicle.type == "vtol":
        return (
            "the return circles over home unless Q_RTL_MODE has it land there: else the landing is left to"
            " the pilot; finish 'land' lands at the plan's end",
        )
    return (
        "the return circles over home: the landing is left to the pilot; finish 'land' lands at the plan's"
        " end",
    )


def _land(task: Task) -> End:
    if task.vehicle.type == "vtol":
        command, yaw = Command.NAV_VTOL_LAND, task.any_yaw
    else:
        # ArduPilot stores the sign of LAND's param 4 alone; 1 is what it gives back for none.
        command, yaw = Command.NAV_LAND, math.nan if task.is_px4 else 1.0
    return End((placed(command, task.plan.end, 0.0, Frame.GLOBAL_RELATIVE_ALT, (0.0, 0.0, 0.0, yaw)),))


def _approach_and_land(task: Task) -> End:
    """Circle down, approach, and land: with wings on the ground, else hovering from over the place."""
    vtol = task.vehicle.type == "vtol"
    stop_m = task.vehicle.airspeed_m_s**2 / (2.0 * _VTOL_BRAKING_M_S2)
    way = landing(
        task.local.xy(task.plan.end),
        task.direction_rad(task.path.segments[-1], at_start=False),
        task.orbit_radius_m,
        min(task.options.approach_altitude_m, task.altitude_over_home_m),
        _VTOL_SLOPE_DEG if vtol else task.options.approach_slope_deg,
        task.room,
        _VTOL_STOPS * stop_m if vtol else 0.0,
    )
    relative = Frame.GLOBAL_RELATIVE_ALT
    approach = placed(
        Command.NAV_WAYPOINT,
        task.local.lonlat(way.approach),
        way.approach_altitude_m,
        relative,
        (0.0, 0.0, 0.0, task.any_yaw),
    )
    down = _loiter_to(task, way.orbit.centre, way.orbit.radius_m, way.approach_altitude_m, relative)
    items = (down, approach, *_land(task).items)
    notes: tuple[str, ...] = ()
    if way.outside_m2 > 0.0:
        notes = (f"the approach leaves the fence: {way.outside_m2:.0f} m² lie outside",)
    # PX4 comes back to this point on RTL; ArduPilot refuses to arm with it unless RTL_AUTOLAND is set.
    return End((unplaced(Command.DO_LAND_START), *items) if task.is_px4 else items, notes)
