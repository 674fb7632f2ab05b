"""Missions under test: the vehicles, and what of a mission tests look at."""

from __future__ import annotations

from hypothesis import strategies as st
from shapely.geometry import LineString, Polygon

from mavlink.dialects import Autopilot, VehicleType
from mavlink.encoding.encode import Mission
from mavlink.wire.items import Command, MissionItem
from planner.plan import Plan
from planner.route import Pose
from tests.mavlink.plans import FRAME, START, Leg, flown

KINDS: list[tuple[Autopilot, VehicleType]] = [
    ("ardupilot", "fixed_wing"),
    ("ardupilot", "multirotor"),
    ("ardupilot", "vtol"),
    ("px4", "fixed_wing"),
    ("px4", "multirotor"),
    ("px4", "vtol"),
]


A, W, R, L = (
    Command.DO_SET_ACTUATOR,
    Command.NAV_WAYPOINT,
    Command.DO_SET_RELAY,
    Command.NAV_LOITER_TO_ALT,
)


LANDINGS = (Command.NAV_LAND, Command.NAV_VTOL_LAND)


def commands(mission: Mission) -> list[int]:
    return [int(item.command) for item in mission.mission]


def local(item: MissionItem) -> tuple[float, float]:
    east_m, north_m = FRAME.to_local((item.y / 1e7, item.x / 1e7))
    return float(east_m), float(north_m)


def flight(mission: Mission) -> list[MissionItem]:
    """Of the mission phase alone: behind the climb, up to where it comes down, without the last off."""
    items = list(mission.mission)
    first = commands(mission).index(Command.DO_CHANGE_SPEED) + 1
    ends = {*LANDINGS, Command.NAV_RETURN_TO_LAUNCH, Command.NAV_LOITER_UNLIM, Command.DO_LAND_START, L}
    first += items[first].command == L
    last = next(index for index in range(first, len(items)) if items[index].command in ends)
    return items[first : last - (items[last - 1].command not in (W, Command.NAV_LOITER_TURNS))]


def path_line(legs: tuple[Leg, ...], start: Pose = START) -> LineString:
    """The exact line, points a metre apart."""
    return LineString(flown(legs, start).sample(0.5, 5.0)[:, :2])


arcs = st.builds(
    Leg,
    turn_deg=st.floats(5.0, 350.0).flatmap(lambda a: st.sampled_from([a, -a])),
    radius_m=st.floats(60.0, 900.0),
)


straights = st.builds(Leg, length_m=st.floats(50.0, 3000.0))


leg_lists = st.lists(st.tuples(straights, arcs), min_size=1, max_size=4).map(
    lambda pairs: tuple(leg for pair in pairs for leg in pair)
)


def room_of(plan: Plan) -> Polygon:
    return Polygon(FRAME.to_local(plan.fence.inclusion[0].ring))


def commands_after(items: tuple[MissionItem, ...], command: int) -> list[int]:
    numbers = [int(item.command) for item in items]
    return numbers[numbers.index(command) + 1 :]
