"""Plan to mission, fence and rally points, in the dialect of an autopilot.

In flight order: the home row (ArduPilot), the take-off, the speed, then the path: waypoints at the ends of
its straights, points on its arcs or turns round their centres, circles where it climbs or descends in whole
turns, and exactly both ends of each collect, the sensor switched right behind them; last, with the sensor off
once more, the return or the landing. Places and heights are the plan's, of all of its phases.
A gimbal is pointed before the path, anew right behind a collect whose next one looks elsewhere, and rests
before the landing.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial

from mavlink.dialects import Autopilot
from mavlink.dialects.base import GLOBAL_FRAMES
from mavlink.dialects.mission import Mission, home_item, numbered, placed, unplaced
from mavlink.encoding.arcs import circle_item, flown_round, turn_item
from mavlink.encoding.ends import beginning, ending
from mavlink.encoding.fence import fence_items
from mavlink.encoding.holds import hold_item, is_hold, unwound
from mavlink.encoding.options import EncodeError, EncodeOptions
from mavlink.encoding.pointing import Pointings, pointings_of
from mavlink.encoding.speeds import speeds_behind
from mavlink.encoding.stops import MERGE_M, Stop, stops_along
from mavlink.encoding.switching import Switching, switching_of
from mavlink.encoding.task import Task, task_of
from mavlink.wire.items import Command, Frame, MissionItem, MissionType
from planner.plan import LonLat, PathSegment, Plan

__all__ = ["EncodeError", "EncodeOptions", "Mission", "encode"]

_DEFAULT = EncodeOptions()
#: Arcs of multirotors this tight are corners: the plan means that they turn on the spot.
CORNER_M = 2.1
#: From where a plan was made in flight to where its mission is taken up.
TAKEN_UP_S = 3.0
#: Kept free round a waypoint that lies off the path.
_MARGIN_M = 20.0


def encode(
    plan: Plan,
    vehicle: str | None = None,
    autopilot: Autopilot | None = None,
    options: EncodeOptions = _DEFAULT,
) -> Mission:
    """The mission of one vehicle of a plan.

    Parameters
    ----------
    plan
        As checked; its violations are not looked at here.
    vehicle
        Name; None where the plan has one vehicle.
    autopilot
        Instead of the vehicle's own.
    options
        Choices that the plan leaves open.

    Returns
    -------
    Mission
        In wire units. Whether the autopilot takes it is for ``Mission.dialect.check`` to say: a mission may
        be longer than the vehicle holds.

    Raises
    ------
    EncodeError
        No such vehicle, or something the autopilot cannot be told.
    """
    task = task_of(plan, vehicle, autopilot, options)
    plan = task.plan
    if task.hovers:
        task = replace(task, path=unwound(task.path, task.local))
    switching = switching_of(task)
    pointing = pointings_of(task)
    first, last = beginning(task), ending(task)
    # Taken up in flight a mission is begun late: what lies that near is behind by then, and would be flown
    # back to, or round once more.
    behind_m = TAKEN_UP_S * task.vehicle.airspeed_m_s if task.path.phase("take_off") is None else 0.0
    turns = flown_round(task)

    def as_turn(segment: PathSegment) -> bool:
        return turns(segment) and segment.start_m >= behind_m

    stops = stops_along(
        task.path,
        task.collects,
        task.local,
        options.chord_error_m,
        task.off_delay_m,
        partial(_may_overshoot, task) if task.turns_early_m > 0.0 else None,
        as_turn,
        (task.taken_off_m, task.landing_m),
        task.near_m,
        switching.on_delay_m,
        CORNER_M if task.hovers else 0.0,
    )
    stops = tuple(s for s in stops if s.along_m >= behind_m or s.on or s.off or s.turns is not None)
    # A plan over the sea knows how high its home lies.
    known_m = task.home_altitude_m if plan.altitude_reference == "amsl" else 0.0
    home_m = options.home_altitude_m or known_m
    home = [home_item(plan.home, home_m)] if task.dialect.home_row else []
    flight = _flight(task, stops, switching, pointing)
    fence, fence_notes = fence_items(plan, (task.path,), task.dialect.fence_store)
    return Mission(
        mission=numbered([*home, *_placed([*first.items, *flight, *last.items])]),
        fence=tuple(_placed(fence)),
        rally=_rally(task),
        autopilot=task.dialect.autopilot,
        vehicle=task.vehicle.name,
        vehicle_type=task.vehicle.type,
        home=plan.home,
        notes=(
            *_arc_notes(task, sum(as_turn(segment) for segment in task.path.segments)),
            *switching.notes,
            *pointing.notes,
            *_pass_by_notes(task),
            *first.notes,
            *last.notes,
            *fence_notes,
        ),
        home_altitude_m=home_m,
        speed_m_s=task.vehicle.airspeed_m_s,
    )


def _flight(
    task: Task, stops: Sequence[Stop], switching: Switching, pointing: Pointings
) -> list[MissionItem]:
    """Waypoints along the path, the sensor switched right behind those where a collect starts or ends."""
    speeds = speeds_behind(task, stops)
    items: list[MissionItem] = [*pointing.before(0), *_told(speeds, -1)]
    collecting = begun = pointed = 0
    ended = False
    straight_in = not task.hovers and task.path.phase("return") is None
    for number, stop in enumerate(stops):
        past_m = stop.along_m - task.mission_end_m
        # The place that a landing comes from belongs to it; one that ends a collect still to the mission.
        begins = stop.turns is not None or (straight_in and not stop.off)
        if not ended and collecting == 0 and past_m > (-MERGE_M if begins else MERGE_M):
            ended = True
            items += _before_the_end(task, switching, pointing)
        if stop.turns is not None and is_hold(task.path, stop.turns):
            items += [hold_item(task, stop.turns), *_told(speeds, number)]
            continue
        if stop.turns is not None:
            if stop.turns is not task.last_turns or task.vehicle.finish != "loiter":
                items.append(circle_item(task, stop.turns, Command.NAV_LOITER_TO_ALT))
            items += _told(speeds, number)
            continue
        if stop.arc is not None:
            items.append(turn_item(task, stop.arc, stop.altitude_m))
        parameters = (0.0, _acceptance_m(task, stop), 0.0, task.any_yaw)
        items.append(placed(Command.NAV_WAYPOINT, stop.place, stop.altitude_m, task.frame, parameters))
        collecting += stop.on - stop.off
        items += switching.ended(stop.off, begins=stop.on > 0)
        begun += stop.on
        # As early as the last collect lets it; at the latest where the next one begins.
        next_up = begun if collecting == 0 else begun - 1
        while pointed < next_up:
            pointed += 1
            items += pointing.before(pointed)
        items += switching.begun(stop.on, ends=stop.off > 0)
        items += _told(speeds, number)
    if ended:
        return items
    last = [item for item in items if item.command == Command.NAV_WAYPOINT][-1:]
    approach = last if task.is_px4 and not task.hovers else []
    return [*items, *_before_the_end(task, switching, pointing), *approach]


def _told(speeds: Mapping[int, MissionItem], number: int) -> tuple[MissionItem, ...]:
    """The speed ordered behind a stop, if any."""
    return (speeds[number],) if number in speeds else ()


def _before_the_end(task: Task, switching: Switching, pointing: Pointings) -> list[MissionItem]:
    """Behind the mission, before it comes down: the sensor off in any case, the gimbal at rest.

    PX4 comes back to the landing's start on RTL; ArduPilot refuses to arm with it unless RTL_AUTOLAND is set.
    """
    items = [*switching.rest]
    items += pointing.rest
    if task.is_px4 and not task.hovers:
        items.append(unplaced(Command.DO_LAND_START))
    return items


def _acceptance_m(task: Task, stop: Stop) -> float:
    """Param 2 of a waypoint: 0 leaves it to the vehicle."""
    if task.options.acceptance_radius_m is not None:
        return float(round(task.options.acceptance_radius_m))
    # Before a turn Plane counts a waypoint as reached some metres early, and the sensor would go off there.
    return 1.0 if stop.off and task.is_plane else 0.0


def _may_overshoot(task: Task, place: LonLat) -> bool:
    """Whether a waypoint that is turned before may lie there: PX4 wants every waypoint inside its fence."""
    here = task.local.xy(place)
    return task.room.line_outside_m2([here, (here[0] + 1.0, here[1])], _MARGIN_M) <= 0.0


def _arc_notes(task: Task, turns: int) -> tuple[str, ...]:
    others = "the other arcs" if turns else "arcs"
    points = f"{others} are waypoints with a chord error of at most {task.options.chord_error_m:g} m"
    if not turns:
        return (points,)
    return (
        f"{turns} {'arc is a turn' if turns == 1 else 'arcs are turns'} round the centre (LOITER_TURNS), the"
        " radius given for sea level, as ArduPlane widens it with height while NAVL1_LIM_BANK is 0",
        points,
    )


def _pass_by_notes(task: Task) -> tuple[str, ...]:
    early_m = task.turns_early_m
    if not (early_m > 0.0 and task.collects):
        return ()
    kind = {"multirotor": "multirotors", "vtol": "VTOLs"}.get(task.vehicle.type, "fixed wings")
    if task.off_delay_m < early_m:
        return (
            f"PX4's {kind} count a waypoint as reached some {early_m:.0f} m early: the sensor goes off"
            " up to that much too soon, unless it is switched off late (off_delay_m)",
        )
    return (
        f"PX4's {kind} turn some {early_m:.0f} m before a waypoint: those that end a collect lie up to"
        f" {task.off_delay_m:.0f} m past its end",
    )


def _rally(task: Task) -> tuple[MissionItem, ...]:
    if not task.options.rally_at_home:
        return ()
    # ArduPilot keeps whole metres.
    height_m = float(max(1, math.floor(task.altitude_over_home_m)))
    home = placed(Command.NAV_RALLY_POINT, task.plan.home, height_m, Frame.GLOBAL_RELATIVE_ALT)
    return numbered(_placed([home]), MissionType.RALLY)


def _placed(items: Iterable[MissionItem]) -> list[MissionItem]:
    """The items; latitude 0 with longitude 0, "here" to autopilots, is named a centimetre beside."""
    return [
        replace(item, y=1) if item.frame in GLOBAL_FRAMES and item.x == item.y == 0 else item
        for item in items
    ]
