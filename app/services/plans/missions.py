"""A stored plan as a mission and in the formats other programs read."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from typing import Literal

from app.services.documents import read_object
from app.services.errors import NotFoundError, RefusedError
from app.services.records import HeldMission
from mavlink.dialects import DialectFinding, VehicleType
from mavlink.dialects.mission import Mission
from mavlink.dialects.versions import version_findings
from mavlink.encoding.encode import EncodeError, EncodeOptions, encode
from mavlink.encoding.gimbal import GimbalError, parse_gimbal
from mavlink.encoding.options import Arcs
from mavlink.encoding.payload import PayloadError, parse_payload
from mavlink.rules.firmware import version_of
from mavlink.wire.items import MissionType
from planner.errors import Finding
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
    vehicle_type
        Of the vehicle that is there, for a mission file that does not say for whom it is.
    arcs
        How arcs are said: ``points``, ``loiter``, or ``auto``; None for that.
    chord_error_m
        Largest distance between an arc and the lines between its points; None for the encoder's own.
    sortie
        Which of the vehicle's flights.
    """

    vehicle: str | None = None
    autopilot: AutopilotName | None = None
    payload: str | None = None
    gimbal: str | None = None
    vehicle_type: VehicleType | None = None
    arcs: Arcs | None = None
    chord_error_m: float | None = None
    sortie: int = 1

    def held(self, plan_id: str, plan_vehicle: str) -> HeldMission:
        """What a vehicle of a plan holds, once it holds what is chosen."""
        own = (self.payload, self.gimbal, self.arcs, self.chord_error_m, self.sortie)
        return HeldMission(plan_id, plan_vehicle, *own)

    @classmethod
    def of_held(cls, held: HeldMission) -> MissionChoice:
        """What was chosen for a mission that is held."""
        return cls(
            held.plan_vehicle or None,
            None,
            held.payload,
            held.gimbal,
            arcs=held.arcs,
            chord_error_m=held.chord_error_m,
            sortie=held.sortie,
        )


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
    if plan.is_fleet:
        _check_sortie(plan, vehicle, choice.sortie)
    try:
        gimbal = None if choice.gimbal is None else parse_gimbal(choice.gimbal)
        options = EncodeOptions(gimbal=gimbal, sortie=choice.sortie)
        if choice.payload is not None:
            options = replace(options, payload=parse_payload(choice.payload))
        if choice.arcs is not None:
            options = replace(options, arcs=choice.arcs)
        if choice.chord_error_m is not None:
            options = replace(options, chord_error_m=choice.chord_error_m)
        return encode(plan, vehicle=vehicle, autopilot=choice.autopilot, options=options)
    except PayloadError as error:
        fix = "write e.g. relay:0, servo:9:1900:1100, aux:1, camera:distance=25 or trigger:time"
        raise RefusedError(str(error), (Finding("payload", "payload", str(error), fix),)) from error
    except GimbalError as error:
        fix = "write e.g. manager:tilt=45, manager:tilt=45,yaw=course, mount:tilt=45 or none"
        raise RefusedError(str(error), (Finding("gimbal", "gimbal", str(error), fix),)) from error
    except EncodeError as error:
        fix = "plan for another autopilot, finish, payload or gimbal"
        raise RefusedError(str(error), (Finding("plan", "cannot-be-encoded", str(error), fix),)) from error


def mission_of(text: str, choice: MissionChoice) -> Mission:
    """The mission of a plan document's text: its mission file's own items, else the plan encoded.

    Raises
    ------
    NotFoundError, RefusedError
        As :func:`encode_plan`.
    """
    from app.services.plans.filed_mission import filed_mission

    mission = filed_mission(read_object(text), choice.autopilot, choice.vehicle_type)
    if mission is None:
        return encode_plan(plan_of(text), choice)
    if choice.vehicle not in (None, mission.vehicle):
        raise NotFoundError("vehicle in the plan called", str(choice.vehicle))
    return mission


def sent(mission: Mission) -> Mission:
    """A mission as it goes up: that of a file fitted to its vehicle, and told what will be held otherwise."""
    if mission.declared is None:
        return mission
    from mavlink.dialects.fit import fitted
    from mavlink.formats import lost_on_board

    fit = fitted(mission)
    return replace(fit, notes=(*fit.notes, *lost_on_board(fit)))


@lru_cache(maxsize=8)
def plan_of(text: str) -> Plan:
    """The plan of a plan document's text."""
    # Here: it brings all the planner with it, and who only puts missions into vehicles reads no plan.
    from planner.geojson import read_plan

    return read_plan(read_object(text))


def flight_of(text: str, choice: MissionChoice) -> Plan:
    """The one flight of a plan document's text that is chosen, as a plan of its own.

    Raises
    ------
    NotFoundError
        The plan knows no such vehicle, or no such sortie of it.
    """
    plan = plan_of(text)
    if not plan.is_fleet:
        return plan
    vehicle = _vehicle_of(plan, choice.vehicle)
    _check_sortie(plan, vehicle, choice.sortie)
    return plan.of(vehicle, choice.sortie)


def _check_sortie(plan: Plan, vehicle: str, sortie: int) -> None:
    if sortie not in plan.sorties_of(vehicle):
        raise NotFoundError(f"sortie of {vehicle} in the plan numbered", str(sortie))


def exported(text: str, choice: MissionChoice, form: str) -> bytes:
    """The mission of a plan document's text in a format.

    ``plan`` (QGroundControl), ``waypoints`` (QGC WPL 110), ``kml`` or ``kmz``.
    """
    from mavlink.formats import kml, kmz, qgc_plan, waypoints

    match form:
        case "plan":
            return qgc_plan.write_plan(mission_of(text, choice)).encode()
        case "waypoints":
            return waypoints.write_waypoints(mission_of(text, choice)).encode()
        case "kml":
            return kml.write_kml(plan_of(text), _vehicle_of(plan_of(text), choice.vehicle)).encode()
        case "kmz":
            return kmz.write_kmz(plan_of(text), _vehicle_of(plan_of(text), choice.vehicle))
    raise ValueError(f"unknown format {form}")


def _vehicle_of(plan: Plan, name: str | None) -> str:
    if name is None:
        return plan.vehicles[0].name
    if name not in {vehicle.name for vehicle in plan.vehicles}:
        raise NotFoundError("vehicle in the plan called", name)
    return name


def mission_findings(
    mission: Mission, kinds: Sequence[MissionType], firmware: str | None = None
) -> tuple[Finding, ...]:
    """What the autopilot, of a firmware's version, would refuse, lose or fly otherwise than meant."""
    return tuple(
        Finding(
            feature=f"{PART_NAMES[kind]}" if found.seq is None else f"{PART_NAMES[kind]} item {found.seq}",
            rule=found.rule,
            message=found.message,
            fix=found.fix or "plan for this autopilot, or choose another payload or autopilot",
            severity=found.severity,
        )
        for kind in kinds
        for found in (
            *map(partial(_of_a_file, mission), mission.dialect.check(mission.items_of(kind))),
            *version_findings(mission.items_of(kind), mission.autopilot, version_of(firmware)),
        )
    ) + (_places_lost(mission) if MissionType.MISSION in kinds else ())


def _of_a_file(mission: Mission, found: DialectFinding) -> DialectFinding:
    """A finding about a mission file: there a place of 0, 0 is ArduPilot's own word for where it is then."""
    if mission.declared is None or mission.autopilot != "ardupilot" or found.rule != "place-zero":
        return found
    words = "latitude 0, longitude 0 stand for where the vehicle is then"
    return replace(found, message=words, severity="warning")


def _places_lost(mission: Mission) -> tuple[Finding, ...]:
    """Items of a mission file that say a place where their frame has none for it."""
    from mavlink.encoding.trace import holds_place
    from mavlink.formats.columns import lost_digits

    found = []
    for item in mission.mission:
        lost = lost_digits(item)
        if lost is not None:
            fatal = holds_place(item, mission.autopilot) and not any(map(math.isnan, item.written or ()))
            severity: Literal["error", "warning"] = "error" if fatal else "warning"
            fix = "write it in a global frame (3: over home), or leave the place out"
            found.append(Finding(f"mission item {item.seq}", "place-lost", lost, fix, severity))
    return tuple(found)
