"""Bodies of requests and answers about vehicles and flights."""

from __future__ import annotations

import math
from dataclasses import asdict
from datetime import datetime
from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, Field, field_validator, model_validator

from app.schemas import FindingOut, Strict
from app.services.records import FlightRecord
from app.services.vehicles.forwarding import MOST_FORWARDS
from app.services.vehicles.inspection import ParameterReport
from app.services.vehicles.items import state_json
from app.services.vehicles.preflight import Preflight
from app.services.vehicles.uploads import UploadReport
from app.services.vehicles.vehicle import Vehicle
from app.services.work import finding_json
from mavlink.rules.table import ParameterFinding
from mavlink.station.forward.outlet import Outlet

Part = Literal["mission", "fence", "rally"]
CommandName = Literal["arm", "disarm", "start", "pause", "resume", "rtl", "goto_item"]


class ForwardIn(Strict):
    """An address to forward a vehicle's link to, for another ground station."""

    url: str = Field(
        min_length=1,
        max_length=300,
        description="udpout:host:port, udpin:host:port, tcpin:host:port or tcp:host:port; without a host "
        "it is 127.0.0.1.",
        examples=["udpout:127.0.0.1:14550"],
    )
    write: bool = Field(
        default=False,
        description="Whether stations there may command the vehicle; else they only watch. While a mission "
        "is exchanged from here, what they send of the mission protocol is held back.",
    )


class VehicleIn(Strict):
    """A vehicle to connect."""

    name: str = Field(
        min_length=1,
        max_length=100,
        pattern=r"^[^\x00-\x1f\x7f]*[^\s\x00-\x1f\x7f][^\x00-\x1f\x7f]*$",
        description="Something to see, and no control characters.",
        examples=["uav-1"],
    )
    url: str = Field(
        min_length=1,
        max_length=300,
        description="udpin:host:port, udpout:host:port, tcp:host:port, serial:device:baud, or sim: for a "
        "simulated aircraft, e.g. sim:?speedup=20&home=33.48,-117.75&autopilot=px4&airspeed=20"
        "&turn_radius=100&wind=8,270. sim: alone is a fixed wing, type=multirotor the other kind. Without a "
        "home it stands where the plan it gets begins. A recording "
        "(.tlog) is watched with replay:path?speedup=10&plan=<id of the plan flown>&payload=<as uploaded>.",
        examples=["sim:", "udpin:127.0.0.1:14550"],
    )
    timeout_s: float = Field(
        default=10.0, ge=0.1, le=60, description="How long to wait for its first heartbeat."
    )
    forward: list[ForwardIn] = Field(
        default=[], max_length=MOST_FORWARDS, description="Other ground stations that hear it too."
    )


GIMBAL_IS = (
    "What points the sensor to the side of each pass, tilt in degrees from straight down: manager:tilt=45, "
    "manager:tilt=45,yaw=course,device=1, mount:tilt=45; none, or null, where it is bolted on."
)


class MissionIn(Strict):
    """What to upload."""

    plan_id: str = Field(max_length=36)
    parts: Annotated[list[Part], Field(min_length=1, max_length=3)] = Field(
        default=["mission"], description="Uploaded in this order; the first refusal ends it."
    )
    vehicle: str | None = Field(default=None, max_length=200, description="Vehicle of the plan; its first.")
    payload: str | None = Field(
        default=None, max_length=200, description="How the sensor is switched, e.g. relay:0."
    )
    gimbal: str | None = Field(default=None, max_length=200, description=GIMBAL_IS)
    override: bool = Field(
        default=False, description="Upload although a hard constraint is broken; needs a reason."
    )
    reason: str | None = Field(
        default=None, min_length=3, max_length=500, description="Why to override; logged with the upload."
    )

    @field_validator("parts")
    @classmethod
    def _each_once(cls, parts: list[Part]) -> list[Part]:
        return list(dict.fromkeys(parts))

    @model_validator(mode="after")
    def _say_why(self) -> Self:
        if self.override and self.reason is None:
            raise ValueError("an override needs a reason")
        return self


class PartOut(BaseModel):
    """What became of one part."""

    outcome: Literal["accepted", "different", "refused", "unknown", "not_attempted"]
    reason: str
    verified: bool = Field(description="Read back, and equal to what was meant, roundings aside.")
    meant: int = Field(description="Items sent.")
    differences: list[dict[str, Any]] | None = Field(description="None when it could not be read back.")
    held: list[dict[str, Any]] | None = Field(description="Items the vehicle holds now; None: not known.")


class CheckOut(BaseModel):
    """One question of the pre-flight check."""

    name: str
    status: Literal["ok", "warning", "failed"]
    detail: str


class ParameterFindingOut(BaseModel):
    """A parameter that is not as the mission needs it; it is reported, never changed."""

    name: str
    value: float | None
    advised: float | None = Field(description="What would do; None where it depends on the wiring.")
    reason: str
    severity: Literal["error", "warning"]

    @classmethod
    def of(cls, finding: ParameterFinding) -> Self:
        """The answer for a finding."""
        value = finding.value if math.isfinite(finding.value) else None
        return cls(**asdict(finding) | {"value": value})


class PreflightOut(BaseModel):
    """Whether a vehicle is ready to fly a plan."""

    plan_id: str
    ready: bool = Field(description="No check has failed; warnings are for the pilot to weigh.")
    checks: list[CheckOut]
    parameters: list[ParameterFindingOut]

    @classmethod
    def of(cls, report: Preflight) -> Self:
        """The answer for a report."""
        return cls(
            plan_id=report.plan_id,
            ready=report.ready,
            checks=[CheckOut(**asdict(check)) for check in report.checks],
            parameters=[ParameterFindingOut.of(finding) for finding in report.parameters],
        )


class PreflightIn(Strict):
    """Which plan is to be flown."""

    plan_id: str = Field(max_length=36)
    vehicle: str | None = Field(default=None, max_length=200, description="Vehicle of the plan; its first.")
    payload: str | None = Field(
        default=None, max_length=200, description="How the sensor is switched, e.g. relay:0."
    )
    gimbal: str | None = Field(default=None, max_length=200, description=GIMBAL_IS)


class ParameterOut(BaseModel):
    """A parameter as the vehicle holds it."""

    name: str
    value: float | None = Field(description="None for what is no number.")
    type: int = Field(description="MAV_PARAM_TYPE.")


class ParametersOut(BaseModel):
    """Parameters of a vehicle."""

    vehicle_id: str
    parameters: list[ParameterOut]
    missing: list[str] = Field(description="Asked for and not answered: the firmware has none of the name.")
    findings: list[ParameterFindingOut]

    @classmethod
    def of(cls, vehicle_id: str, report: ParameterReport) -> Self:
        """The answer for what was read."""
        return cls(
            vehicle_id=vehicle_id,
            parameters=[
                ParameterOut(name=p.name, value=p.value if math.isfinite(p.value) else None, type=p.type)
                for p in report.values
            ],
            missing=list(report.missing),
            findings=[ParameterFindingOut.of(finding) for finding in report.findings],
        )


class UploadOut(BaseModel):
    """An upload: what was meant and what the vehicle now holds."""

    number: int
    plan_id: str
    plan_vehicle: str
    outcome: Literal["accepted", "different", "refused", "unknown", "not_attempted"] = Field(
        description="unknown: nobody here can tell what the vehicle holds; when it comes back this becomes "
        "accepted or different."
    )
    verified: bool
    parts: dict[str, PartOut]
    findings: list[FindingOut]
    notes: list[str]
    override_reason: str | None
    preflight: PreflightOut | None = Field(description="Made behind an accepted upload; None otherwise.")

    @classmethod
    def of(cls, report: UploadReport, items: bool = True) -> Self:
        """The answer for a report, with the items held or without."""
        return cls(
            number=report.number,
            plan_id=report.plan_id,
            plan_vehicle=report.plan_vehicle,
            outcome=report.outcome,
            verified=report.verified,
            parts={
                name: PartOut(
                    outcome=part.outcome,
                    reason=part.reason,
                    verified=part.verified,
                    meant=part.meant,
                    differences=part.differences,
                    held=part.held if items else None,
                )
                for name, part in report.parts.items()
            },
            findings=[FindingOut.model_validate(finding_json(finding)) for finding in report.findings],
            notes=list(report.notes),
            override_reason=report.override_reason,
            preflight=None if report.preflight is None else PreflightOut.of(report.preflight),
        )


class SentOut(BaseModel):
    """The mission last sent to a vehicle from here, over restarts of the service, and what became of it."""

    plan_id: str
    list_id: int | None = Field(description="The id the vehicle gave it; null: it gives none (ArduPilot).")
    standing: Literal["held", "differs", "unknown"] = Field(
        description="Whether the vehicle still holds it. unknown: it is silent, or was not read back since "
        "it came back and gives no ids."
    )
    shown_by: Literal["read_back", "id"] | None = Field(
        description="read_back: compared item by item. id: the vehicle's id of its list, a first sign."
    )
    read_back_at: datetime | None = Field(description="When it was compared, in this run of the service.")

    @classmethod
    def of(cls, vehicle: Vehicle) -> Self | None:
        """The answer for a vehicle; None when nothing was sent."""
        if vehicle.sent is None:
            return None
        standing, shown_by = vehicle.standing()
        return cls(
            plan_id=vehicle.sent.plan_id,
            list_id=vehicle.sent.list_id,
            standing=standing,
            shown_by=shown_by,
            read_back_at=vehicle.read_back_at,
        )


class ForwardFigures(BaseModel):
    """Frames counted since the address was first forwarded to."""

    sent: int = Field(description="From the vehicle to stations.")
    dropped: int = Field(description="Meant for a station that did not keep up; the oldest go first.")
    passed: int = Field(description="From stations on to the vehicle.")
    refused: int = Field(description="From stations that only watch, or meant for another vehicle.")
    held_back: int = Field(description="From stations while a mission was exchanged from here.")
    lost: int = Field(description="From stations: unreadable, or too many for the link to the vehicle.")


class ForwardOut(BaseModel):
    """An address a vehicle's link is forwarded to, and how it goes."""

    url: str
    address: str = Field(description="The same with the port really used.")
    write: bool = Field(description="Stations there may command the vehicle.")
    failure: str | None = Field(description="Why it is not open; it is tried again and again.")
    peers: int = Field(description="How many it is sent to; one that is called counts, there or not.")
    stations: list[int] = Field(description="System ids heard from there.")
    frames: ForwardFigures

    @classmethod
    def of(cls, outlet: Outlet) -> Self:
        """The answer for an address at work."""
        return cls(
            url=outlet.address.url,
            address=outlet.url,
            write=outlet.address.write,
            failure=outlet.failure,
            peers=outlet.peers,
            stations=outlet.stations,
            frames=ForwardFigures(**outlet.figures.as_dict()),
        )


class ForwardsIn(Strict):
    """Where to forward a vehicle's link to: these addresses and no others."""

    forward: list[ForwardIn] = Field(max_length=MOST_FORWARDS)


class ForwardsOut(BaseModel):
    """Where a vehicle's link is forwarded to."""

    vehicle_id: str
    forward: list[ForwardOut]

    @classmethod
    def of(cls, vehicle: Vehicle) -> Self:
        """The answer for a vehicle."""
        return cls(vehicle_id=vehicle.id, forward=[ForwardOut.of(o) for o in vehicle.forwards.outlets])


class VehicleOut(BaseModel):
    """A vehicle and how it is."""

    id: str
    name: str
    url: str
    connected: bool
    system_id: int | None = Field(description="Its MAVLink system; null: not heard yet.")
    other_system: int | None = Field(
        description="Another autopilot that answers in its place while it is silent: a swapped aircraft. It "
        "is not talked to until it is acknowledged, or let go and connected as another vehicle."
    )
    link_failure: str | None = Field(description="Why its link is not open; it is tried again and again.")
    simulated: bool
    replay: bool = Field(description="It is a recording: it takes no transfers and no commands.")
    created_at: datetime
    operation: str | None = Field(description="What is at work on it now.")
    transfer: dict[str, Any] | None = Field(description="Of an upload at work: part, done, total.")
    pending: bool = Field(description="An upload's outcome is unknown; it is read back on reconnection.")
    plan_id: str | None = Field(description="The plan it holds, read back and compared.")
    sent: SentOut | None = Field(description="The mission last sent from here; null: none, or cleared.")
    flight_id: str | None = Field(description="The flight being recorded.")
    forward: list[ForwardOut] = Field(description="Other ground stations its link is forwarded to.")
    upload: UploadOut | None = Field(description="The last upload, without its items.")
    state: dict[str, Any] = Field(description="Position, attitude, mode, mission, battery …; null: not said.")

    @classmethod
    def of(cls, vehicle: Vehicle) -> Self:
        """The answer for a vehicle."""
        return cls(
            id=vehicle.id,
            name=vehicle.name,
            url=vehicle.url,
            connected=vehicle.state.connected,
            system_id=vehicle.state.system_id or vehicle.system_id or None,
            other_system=vehicle.state.other_system,
            link_failure=vehicle.link_failure,
            simulated=vehicle.simulated is not None,
            replay=vehicle.replay,
            created_at=vehicle.created_at,
            operation=vehicle.turns.operation,
            transfer=vehicle.turns.progress,
            pending=vehicle.pending,
            plan_id=vehicle.held.plan_id if vehicle.held else None,
            sent=SentOut.of(vehicle),
            flight_id=vehicle.flight_id,
            forward=ForwardsOut.of(vehicle).forward,
            upload=UploadOut.of(vehicle.upload, items=False) if vehicle.upload else None,
            state=state_json(vehicle.state),
        )


class VehicleList(BaseModel):
    """Vehicles, oldest first."""

    vehicles: list[VehicleOut]


class LogOut(BaseModel):
    """One recording of a vehicle's link."""

    name: str
    size_bytes: int
    ended_at: datetime = Field(description="When it was last written to.")
    url: str = Field(description="Where to download it; play it with the vehicle address replay:<file>.")


class LogList(BaseModel):
    """Recordings of a vehicle's link, oldest first."""

    vehicle_id: str
    failure: str | None = Field(description="Why the link is no longer recorded, e.g. a full disk.")
    logs: list[LogOut]


class IdentityIn(Strict):
    """The aircraft that is the vehicle from now on."""

    system_id: int = Field(ge=1, le=255, description="As other_system says.")


class HeldOut(BaseModel):
    """What a vehicle holds."""

    vehicle_id: str
    parts: dict[str, list[dict[str, Any]]]


class ClearedOut(BaseModel):
    """How clearing went, part by part."""

    vehicle_id: str
    parts: dict[str, Literal["accepted", "refused", "unknown"]]


class CommandIn(Strict):
    """An explicit flight command."""

    command: CommandName
    seq: int | None = Field(default=None, ge=0, le=65535, description="Item, for goto_item.")


class CommandOut(BaseModel):
    """What became of a command; a refusal is a 409 problem."""

    vehicle_id: str
    command: CommandName
    outcome: Literal["accepted", "unknown"]
    detail: str


class FlightOut(BaseModel):
    """One flight."""

    id: str
    vehicle_id: str
    vehicle_name: str
    plan_id: str | None
    plan_vehicle: str | None
    state: Literal["flying", "ended", "interrupted"]
    started_at: datetime
    ended_at: datetime | None
    points: int
    payload: str | None = Field(description="How the sensor was switched; null for the default.")
    photos: int = Field(description="Reported by cameras.")
    links: dict[str, str]

    @classmethod
    def of(cls, record: FlightRecord) -> Self:
        """The answer for a record."""
        base = f"/api/v1/flights/{record.id}"
        links = {"self": base} | {
            name: f"{base}/{name}"
            for name in ("track.geojson", "track.gpx", "coverage.geojson", "report.html")
        }
        return cls(**asdict(record), links=links)


class FlightList(BaseModel):
    """Flights, newest first."""

    flights: list[FlightOut]
