"""A stored plan as a mission and in the formats other programs read."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Literal

from app.services.documents import read_object
from app.services.errors import NotFoundError, RefusedError
from mavlink.dialects.mission import Mission
from mavlink.encoding.encode import EncodeError, EncodeOptions, encode
from mavlink.encoding.gimbal import GimbalError, parse_gimbal
from mavlink.encoding.payload import PayloadError, parse_payload
from mavlink.wire.items import MissionType
from planner.errors import Finding
from planner.geojson import read_plan
from planner.plan import Plan

AutopilotName = Literal["ardupilot", "px4"]
PartName = Literal["mission", "fence", "rally"]

PARTS: dict[PartName, MissionType] = {
    "mission": MissionType.MISSION,
    "fence": MissionType.FENCE,
    "rally": MissionType.RALLY,
}
PART_NAMES: dict[MissionType, PartName] = {kind: name for name, kind in PARTS.items()}


@dataclass(frozen=True, slots=True)
class MissionChoice:
    """Which mission of a plan is meant.

    Parameters
    ----------
    vehicle
        Name in the plan; None for its only, or first, vehicle.
    autopilot
        None for the one the plan names.
    payload
        How the sensor is switched, e.g. ``relay:0``; None for the autopilot's default.
    gimbal
        What points the sensor, e.g. ``manager:tilt=45``; None, or ``none``, where it is bolted on.
    """

    vehicle: str | None = None
    autopilot: AutopilotName | None = None
    payload: str | None = None
    gimbal: str | None = None


def encode_plan(plan: Plan, choice: MissionChoice) -> Mission:
    """Encode the mission of one vehicle.

    Raises
    ------
    NotFoundError
        The plan knows no vehicle of that name.
    RefusedError
        The payload, the gimbal, or the plan for that autopilot, cannot be encoded.
    """
    vehicle = _vehicle_of(plan, choice.vehicle)
    try:
        options = EncodeOptions(gimbal=None if choice.gimbal is None else parse_gimbal(choice.gimbal))
        if choice.payload is not None:
            options = replace(options, payload=parse_payload(choice.payload))
        return encode(plan, vehicle=vehicle, autopilot=choice.autopilot, options=options)
    except PayloadError as error:
        fix = "write e.g. relay:0, servo:9:1900:1100, aux:1, camera:distance=25 or image:interval=2"
        raise RefusedError(str(error), (Finding("payload", "payload", str(error), fix),)) from error
    except GimbalError as error:
        fix = "write e.g. manager:tilt=45, manager:tilt=45,yaw=course, mount:tilt=45 or none"
        raise RefusedError(str(error), (Finding("gimbal", "gimbal", str(error), fix),)) from error
    except EncodeError as error:
        fix = "plan for another autopilot, finish, payload or gimbal"
        raise RefusedError(str(error), (Finding("plan", "cannot-be-encoded", str(error), fix),)) from error


@lru_cache(maxsize=8)
def plan_of(text: str) -> Plan:
    """The plan of a plan document's text."""
    return read_plan(read_object(text))


def mission_text(plan: Plan, choice: MissionChoice, form: str) -> str:
    """A plan's mission in a format: ``plan`` (QGroundControl), ``waypoints`` (QGC WPL 110) or ``kml``."""
    from mavlink.formats import kml, qgc_plan, waypoints

    match form:
        case "plan":
            return qgc_plan.write_plan(encode_plan(plan, choice))
        case "waypoints":
            return waypoints.write_waypoints(encode_plan(plan, choice))
        case "kml":
            return kml.write_kml(plan, _vehicle_of(plan, choice.vehicle))
    raise ValueError(f"unknown format {form}")


def mission_bytes(plan: Plan, choice: MissionChoice, form: str) -> bytes:
    """A plan's mission in any format: those of :func:`mission_text`, or ``kmz``."""
    from mavlink.formats import kmz

    if form == "kmz":
        return kmz.write_kmz(plan, _vehicle_of(plan, choice.vehicle))
    return mission_text(plan, choice, form).encode()


def exported(text: str, choice: MissionChoice, form: str) -> bytes:
    """:func:`mission_bytes` of a plan document's text."""
    return mission_bytes(plan_of(text), choice, form)


def _vehicle_of(plan: Plan, name: str | None) -> str:
    if name is None:
        return plan.vehicles[0].name
    if name not in {vehicle.name for vehicle in plan.vehicles}:
        raise NotFoundError("vehicle in the plan called", name)
    return name


def mission_findings(mission: Mission, kinds: Sequence[MissionType]) -> tuple[Finding, ...]:
    """What the autopilot would refuse, lose or fly otherwise than meant."""
    return tuple(
        Finding(
            feature=f"{PART_NAMES[kind]}" if found.seq is None else f"{PART_NAMES[kind]} item {found.seq}",
            rule=found.rule,
            message=found.message,
            fix=found.fix or "plan for this autopilot, or choose another payload or autopilot",
            severity=found.severity,
        )
        for kind in kinds
        for found in mission.dialect.check(mission.items_of(kind))
    )
