"""What the services hand out: frozen records, without any web or database type."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime
from typing import Any, Literal

from mavlink.encoding.options import Arcs
from mavlink.state.energy import EnergySource
from mavlink.state.photos import PhotoSource
from mavlink.station.forward.address import ForwardAddress

PlanState = Literal["queued", "running", "done", "failed", "cancelled"]
ENDED: frozenset[PlanState] = frozenset({"done", "failed", "cancelled"})

AuditKind = Literal["order", "upload", "clear", "override", "acknowledgement", "signing"]

FlightState = Literal["flying", "ended", "interrupted"]


@dataclass(frozen=True, slots=True)
class TrackSample:
    """One recorded place of a flight; ``time_s`` is the vehicle's time since boot.

    ``sensor_on`` is None where nothing told of it.
    ``mount_…``: of the gimbal that holds the sensor, yaw from true north; None where it told nothing.
    ``from_log``: the vehicle's own log told of it afterwards, where the link had not.
    """

    time_s: float
    lon_deg: float
    lat_deg: float
    altitude_amsl_m: float | None
    altitude_home_m: float | None
    heading_deg: float | None
    roll_deg: float | None
    ground_speed_m_s: float | None
    mission_seq: int | None
    sensor_on: bool | None
    pitch_deg: float | None = None
    from_log: bool = False
    mount_roll_deg: float | None = None
    mount_pitch_deg: float | None = None
    mount_yaw_deg: float | None = None


@dataclass(frozen=True, slots=True)
class FlightEvent:
    """A photo, or a switch of the sensor, in the vehicle's time since boot; angles as a camera tells them.

    ``attitude_of`` a photo: the ``autopilot``'s airframe, or the ``camera`` itself; None of what is no photo.
    """

    time_s: float
    kind: Literal["on", "off", "photo"]
    source: Literal["camera", "payload", "relay", "servo"]
    index: int | None = None
    lon_deg: float | None = None
    lat_deg: float | None = None
    altitude_amsl_m: float | None = None
    altitude_home_m: float | None = None
    heading_deg: float | None = None
    roll_deg: float | None = None
    pitch_deg: float | None = None
    attitude_of: PhotoSource | None = None


@dataclass(frozen=True, slots=True)
class SensorAction:
    """Something the service did by itself to a sensor; ``time_s`` is the vehicle's time since boot.

    Parameters
    ----------
    reason
        Why, in words.
    outcome
        What the vehicle answered, in words.
    """

    at: datetime
    time_s: float | None
    action: Literal["sensor_off"]
    reason: str
    outcome: str
    lon_deg: float | None
    lat_deg: float | None


@dataclass(frozen=True, slots=True)
class LeftUpload:
    """An upload whose outcome nobody noted: the service ended while it was at work."""

    number: int
    vehicle_id: str
    parts: tuple[str, ...]
    meant: HeldMission
    override_reason: str | None


@dataclass(frozen=True, slots=True)
class AuditEntry:
    """What somebody ordered of a vehicle, and what became of it.

    Parameters
    ----------
    actor
        Who; ``local`` as long as the service knows no users, ``service`` for what it did by itself.
    what
        The command, the plan, the parts, the reason of an override.
    outcome
        ``pending`` until it is settled.
    """

    number: int
    at: datetime
    actor: str
    kind: AuditKind
    vehicle_id: str
    vehicle_name: str
    what: Mapping[str, Any]
    outcome: str
    reason: str
    ended_at: datetime | None


@dataclass(frozen=True, slots=True)
class TerrainRecord:
    """One uploaded elevation raster; ``bounds_deg`` is west, south, east, north."""

    id: str
    name: str
    bounds_deg: tuple[float, float, float, float]
    resolution_m: float
    rows: int
    columns: int
    min_m: float
    max_m: float
    known_fraction: float
    datum: str
    sha256: str
    created_at: datetime


@dataclass(frozen=True, slots=True)
class LinkEvent:
    """The link of a flying vehicle was lost, when it was last heard, or came back; ``time_s`` since boot."""

    kind: Literal["lost", "back"]
    at: datetime
    time_s: float | None


@dataclass(frozen=True, slots=True)
class FlownEnergy:
    """What a flight drew, as its batteries told; see ``mavlink.state.energy``."""

    used_wh: float
    source: EnergySource
    complete: bool


@dataclass(frozen=True, slots=True)
class FlightRecord:
    """One flight, from the first movement of an armed vehicle to its landing or disarming.

    Parameters
    ----------
    plan_id, plan_vehicle
        The plan last uploaded to the vehicle and its name there; None when none was.
    plan_sortie
        Which of its flights there.
    state
        ``interrupted``: the service ended, or the vehicle vanished, before the flight did.
    payload
        How the sensor was switched, as the upload said it; None for the default, or when no plan was held.
    photos
        Reported by cameras.
    actions
        What the service did by itself meanwhile.
    energy
        What its batteries told.
    logs
        Onboard logs that filled gaps of its track, by name.
    link
        When the link was lost and came back.
    """

    id: str
    vehicle_id: str
    vehicle_name: str
    plan_id: str | None
    plan_vehicle: str | None
    state: FlightState
    started_at: datetime
    ended_at: datetime | None
    points: int
    payload: str | None = None
    photos: int = 0
    actions: tuple[SensorAction, ...] = ()
    energy: FlownEnergy | None = None
    logs: tuple[str, ...] = ()
    link: tuple[LinkEvent, ...] = ()
    plan_sortie: int = 1


@dataclass(frozen=True, slots=True)
class HeldMission:
    """The plan whose mission a vehicle was seen to hold, and how it was encoded."""

    plan_id: str
    plan_vehicle: str
    payload: str | None
    gimbal: str | None = None
    arcs: Arcs | None = None
    chord_error_m: float | None = None
    sortie: int = 1


@dataclass(frozen=True, slots=True)
class SentMission:
    """The plan last sent to a vehicle, and the id the vehicle gave its mission; None where it gives none."""

    plan_id: str
    list_id: int | None


@dataclass(frozen=True, slots=True)
class VehicleRecord:
    """One vehicle as it was added; ``held`` is None where no plan was seen in it.

    ``forward``: where its link is forwarded to; ``system_id``: 0 while it was not heard.
    """

    id: str
    name: str
    url: str
    created_at: datetime
    held: HeldMission | None = None
    sent: SentMission | None = None
    forward: tuple[ForwardAddress, ...] = ()
    system_id: int = 0


@dataclass(frozen=True, slots=True)
class KeptScenario:
    """A scenario people are at work on, without its text.

    Parameters
    ----------
    revision
        Counts the changes, from 1.
    scenario_hash
        As plans tell of the scenario they were made of.
    """

    id: str
    name: str
    revision: int
    scenario_hash: str
    created_at: datetime
    changed_at: datetime


@dataclass(frozen=True, slots=True)
class PlanRecord:
    """One request to plan and what became of it.

    Parameters
    ----------
    progress
        0 to 1 over the whole plan.
    summary
        Of a done plan: ``metrics``, ``violations``, ``methods``, ``scenario_hash``, ``planner_version``,
        ``seed``.
    error
        Of a failed one: ``type``, ``title``, ``detail`` and ``errors``, as in a problem document.
    scenario_id
        The kept scenario it was made of; None when it was made of none.
    scenario_hash
        Of the scenario that was posted; None for plans older than kept scenarios.
    kept_hash
        The kept scenario's hash at present; None when it is deleted.
    """

    id: str
    name: str
    state: PlanState
    stage: str | None
    progress: float
    created_at: datetime
    started_at: datetime | None
    ended_at: datetime | None
    warnings: tuple[dict[str, Any], ...]
    summary: dict[str, Any] | None
    error: dict[str, Any] | None
    scenario_id: str | None = None
    scenario_hash: str | None = None
    kept_hash: str | None = None

    @property
    def ended(self) -> bool:
        """Whether nothing more will happen to it."""
        return self.state in ENDED

    @property
    def stale(self) -> bool | None:
        """Whether its scenario is another one by now; None where nobody can tell."""
        return None if self.scenario_id is None else self.kept_hash != self.scenario_hash

    @property
    def stale_reason(self) -> str | None:
        """Why it is stale; None when it is not."""
        if not self.stale:
            return None
        if self.kept_hash is None:
            return "the scenario it was made of has been deleted"
        return "the scenario is another than the one it was made of: it has been changed since"

    @property
    def bounded(self) -> bool:
        """Whether it tells what no plan is shorter than."""
        return (self.summary or {}).get("metrics", {}).get("lower_bound_m") is not None
