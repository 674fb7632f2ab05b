"""What a rule on parameters is, what it is judged by, and what it finds."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Final, Literal, TypeVar

from mavlink.dialects.mission import Mission
from mavlink.encoding.gimbal import Hold, Protocol, hold_of, protocol_of
from mavlink.encoding.payload import OutputPayload, Payload, TriggerPayload, parts_of
from mavlink.encoding.trigger import interval_s
from mavlink.rules.heights import HeightNeeds, heights_of
from mavlink.state.outputs import switched_by
from mavlink.wire.geometry import distance_m
from mavlink.wire.items import Command, Frame
from planner.plan import Collect, Plan

Values = Mapping[str, float]
Part = TypeVar("Part")

#: Items that are flown to.
_FLOWN_TO: Final = frozenset(
    {
        Command.NAV_WAYPOINT,
        Command.NAV_LOITER_UNLIM,
        Command.NAV_LOITER_TURNS,
        Command.NAV_LOITER_TIME,
        Command.NAV_LOITER_TO_ALT,
        Command.NAV_TAKEOFF,
        Command.NAV_LAND,
        Command.NAV_SPLINE_WAYPOINT,
        Command.NAV_VTOL_TAKEOFF,
        Command.NAV_VTOL_LAND,
    }
)
_ABOVE_HOME: Final = frozenset({Frame.GLOBAL_RELATIVE_ALT, Frame.GLOBAL_RELATIVE_ALT_INT})
_ABOVE_SEA: Final = frozenset({Frame.GLOBAL, Frame.GLOBAL_INT})

#: What else firmware calls a parameter, and how many of that one's units make one of this one's.
OTHER_NAMES: Final[dict[str, tuple[str, float]]] = {
    "ROLL_LIMIT_DEG": ("LIM_ROLL_CD", 100.0),  # ArduPlane before 4.5
    "AIRSPEED_CRUISE": ("TRIM_ARSPD_CM", 100.0),
    "RTL_ALTITUDE": ("ALT_HOLD_RTL", 100.0),
    "MNT1_TYPE": ("MNT_TYPE", 1.0),  # ArduPilot before 4.3
    # ArduCopter from 4.7 on
    "ANGLE_MAX": ("ATC_ANGLE_MAX", 0.01),
    "LAND_SPEED": ("LAND_SPD_MS", 0.01),
    "RTL_ALT": ("RTL_ALT_M", 0.01),
    "WPNAV_ACCEL": ("WP_ACC", 0.01),
    "WPNAV_JERK": ("WP_JERK", 1.0),
    "WPNAV_RADIUS": ("WP_RADIUS_M", 0.01),
    "WPNAV_SPEED": ("WP_SPD", 0.01),
    "WPNAV_SPEED_DN": ("WP_SPD_DN", 0.01),
    "WPNAV_SPEED_UP": ("WP_SPD_UP", 0.01),
    "SYSID_THISMAV": ("MAV_SYSID", 1.0),
}


@dataclass(frozen=True, slots=True)
class ParameterFinding:
    """One parameter that is not as the plan needs it.

    Parameters
    ----------
    value
        As the vehicle holds it.
    advised
        What would do; None where it depends on the wiring.
    reason
        Why, with the plan's figures.
    severity
        ``"error"``: the mission cannot be flown, or sees nothing. ``"warning"``: it is flown less well.
    """

    name: str
    value: float
    advised: float | None
    reason: str
    severity: Literal["error", "warning"]

    def __str__(self) -> str:
        advice = "" if self.advised is None else f"; {self.advised:g} is advised"
        return f"{self.name} is {self.value:g}: {self.reason}{advice}"


@dataclass(frozen=True, slots=True)
class GimbalNeeds:
    """Where a mission points its gimbal.

    Parameters
    ----------
    pitch_deg
        Up from the horizon; the same at every pass.
    yaws_deg
        To the right from the nose, one for each side looked to, 0 or 180 for cameras that look along their
        passes; in wind a yaw held abeam of the course is off these by the crab.
    """

    protocol: Protocol
    hold: Hold
    device: int
    pitch_deg: float
    yaws_deg: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class Needs:
    """What a mission needs of its vehicle.

    Parameters
    ----------
    settle_m
        Straight flight the plan leaves before each collect; None when not known.
    payload
        How the sensor is switched, as the autopilot switches it; None for a mission that switches none.
    commands
        Of the mission's items.
    highest_m, farthest_m
        Of the mission's places, above home and from it; 0 where it has none.
    gimbal
        None where the sensor is bolted on.
    photo_s
        Shortest time between two photos; None where there are none.
    """

    airspeed_m_s: float
    turn_radius_m: float
    settle_m: float | None
    payload: Payload | None
    commands: frozenset[int]
    fence: bool
    highest_m: float = 0.0
    farthest_m: float = 0.0
    gimbal: GimbalNeeds | None = None
    heights: HeightNeeds = field(default_factory=HeightNeeds)
    photo_s: float | None = None


def needs_of(plan: Plan, mission: Mission, payload: Payload | None, settle_m: float | None = None) -> Needs:
    """What a plan's mission needs."""
    vehicle = next(vehicle for vehicle in plan.vehicles if vehicle.name == mission.vehicle)
    if payload is not None:
        payload = switched_by(payload, mission.autopilot)
    highest_m, farthest_m = _reach(mission)
    return Needs(
        vehicle.airspeed_m_s,
        vehicle.min_turn_radius_m,
        settle_m,
        payload,
        frozenset(item.command for item in mission.mission),
        bool(mission.fence),
        highest_m,
        farthest_m,
        _gimbal(plan, mission),
        heights_of(plan, mission.vehicle),
        _photo_s(plan, mission.vehicle),
    )


def _photo_s(plan: Plan, vehicle: str) -> float | None:
    """The shortest time between two photos as planned; None where there are none."""
    collects = {collect.seq: collect for collect in plan.collects_of(vehicle)}
    photos = [p for p in plan.photos_of(vehicle) if p.seq in collects and len(p.places) > 1]
    return min((interval_s(p, collects[p.seq]) for p in photos), default=None)


def _gimbal(plan: Plan, mission: Mission) -> GimbalNeeds | None:
    """What a mission's items ask of the gimbal; the yaws by the sides the passes look to, if any do."""
    if not plan.collects_of(mission.vehicle):
        return None
    for item in mission.mission:
        protocol = protocol_of(item)
        if protocol is None:
            continue
        yaws_deg = tuple(sorted({_yaw_deg(plan, collect) for collect in plan.collects_of(mission.vehicle)}))
        device = round(item.z) if protocol == "manager" else 0
        if item.param1 == -90.0:
            yaws_deg = (0.0,)
        return GimbalNeeds(protocol, hold_of(item), device, item.param1, yaws_deg)
    return None


def _yaw_deg(plan: Plan, collect: Collect) -> float:
    if collect.look != "down":
        return 90.0 if collect.look == "right" else -90.0
    camera = plan.camera(collect.sensor)
    return 180.0 if camera is not None and camera.tilt_deg < 0.0 else 0.0


def _reach(mission: Mission) -> tuple[float, float]:
    """How high above home and how far from it the mission goes, by its items."""
    highest_m, farthest_m = 0.0, 0.0
    for item in mission.mission:
        if item.command not in _FLOWN_TO:
            continue
        if item.frame in _ABOVE_HOME:
            highest_m = max(highest_m, item.z)
        elif item.frame in _ABOVE_SEA:
            highest_m = max(highest_m, item.z - mission.home_altitude_m)
        if item.x or item.y:
            farthest_m = max(farthest_m, distance_m(mission.home, (item.y / 1e7, item.x / 1e7)))
    return highest_m, farthest_m


@dataclass(frozen=True, slots=True)
class Rule:
    """Parameters to read, and what to say of them.

    Parameters
    ----------
    names
        To read; those a firmware does not have are simply not there when it is judged.
    judge
        The finding, None when all is well or the values do not tell.
    applies
        Whether the mission needs it at all.
    """

    names: Callable[[Needs], tuple[str, ...]]
    judge: Callable[[Values, Needs], ParameterFinding | None]
    applies: Callable[[Needs], bool] = lambda needs: True


def check(
    name: str,
    good: Callable[[float, Needs], bool],
    reason: Callable[[Needs], str],
    advised: Callable[[Needs], float] | None = None,
    severity: Literal["error", "warning"] = "warning",
    applies: Callable[[Needs], bool] = lambda needs: True,
) -> Rule:
    """A rule about one parameter, by whichever name the firmware has it."""

    def judge(values: Values, needs: Needs) -> ParameterFinding | None:
        found, unit = name, 1.0
        if name not in values and name in OTHER_NAMES:
            found, unit = OTHER_NAMES[name]
        value = values.get(found)
        if value is None or good(value / unit, needs):
            return None
        advice = None if advised is None else advised(needs) * unit
        return ParameterFinding(found, value, advice, reason(needs), severity)

    return Rule(lambda needs: (name,), judge, applies)


def any_of(
    names: Callable[[Needs], tuple[str, ...]],
    good: Callable[[float, Needs], bool],
    reason: Callable[[Needs], str],
    applies: Callable[[Needs], bool],
) -> Rule:
    """A rule that one of several parameters must meet; it speaks only when some were read."""

    def judge(values: Values, needs: Needs) -> ParameterFinding | None:
        found = [(name, values[name]) for name in names(needs) if name in values]
        if not found or any(good(value, needs) for _, value in found):
            return None
        name, value = found[0]
        return ParameterFinding(name, value, None, reason(needs), "error")

    return Rule(names, judge, applies)


def parts(needs: Needs) -> tuple[OutputPayload | TriggerPayload, ...]:
    """How the sensors are switched, one by one."""
    return () if needs.payload is None else parts_of(needs.payload)


def part_of(needs: Needs, kind: type[Part]) -> Part | None:
    """The payload of a kind; None where no sensor is switched so."""
    return next((part for part in parts(needs) if isinstance(part, kind)), None)


def lands(needs: Needs) -> bool:
    """Whether the mission ends on the ground."""
    return bool(needs.commands & {Command.NAV_LAND, Command.NAV_VTOL_LAND})
