"""One upload: judged before, sent part by part, compared, and told as it is."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, Final, Literal

from app.services.errors import RefusedError, UnsafeError
from app.services.plans.missions import PARTS, MissionChoice, PartName, mission_findings
from app.services.plans.work import finding_json
from app.services.vehicles.audit import Entry
from app.services.vehicles.items import difference_json, item_json
from app.services.vehicles.preflight import Preflight
from app.services.vehicles.recorder import is_flying
from app.services.vehicles.replaced import Replaced
from mavlink.dialects import Dialect
from mavlink.dialects.compare import Difference, differences
from mavlink.dialects.mission import Mission
from mavlink.state.telemetry import VehicleState
from mavlink.station.client import VehicleClient
from mavlink.station.verify import Pending, VerifiedUpload, resolve
from mavlink.transfer.machine import Progress
from mavlink.transfer.outcome import Unknown
from mavlink.wire.items import MissionItem
from planner.errors import Finding
from planner.plan import Plan

OutcomeName = Literal["accepted", "different", "refused", "unknown", "not_attempted"]
STATUSES: tuple[OutcomeName, ...] = ("accepted", "not_attempted", "different", "refused", "unknown")


#: What to do about a plan that breaks a hard constraint.
_AGAIN: Final = "change the scenario so that the constraint holds and plan again, or override"
#: And about one whose scenario is another by now.
_STALE: Final = "plan the scenario as it is now and upload that plan, or override"
#: What to do about a vehicle that does not hold what was meant.
_REFUSED: Final = "see what it says, change the plan or the vehicle's settings, and upload again"
_DIFFERS: Final = "upload again; do not fly it meanwhile"


@dataclass(slots=True)
class PartResult:
    """What became of one part.

    Parameters
    ----------
    outcome
        ``accepted``: the vehicle said so, or what it holds shows it. ``different``: what was read back is
        something else than was meant.
    reason
        In words, from the vehicle's answer or its absence.
    differences
        Between what was meant and what is held, roundings of the autopilot aside; None when not read back.
    held
        What the vehicle holds now; None when not known.
    """

    meant: int
    outcome: OutcomeName = "not_attempted"
    reason: str = ""
    differences: list[dict[str, Any]] | None = None
    held: list[dict[str, Any]] | None = None

    @property
    def verified(self) -> bool:
        """Whether the vehicle holds what was meant."""
        return self.outcome == "accepted" and self.differences == []

    def failing(self, name: str) -> Finding | None:
        """Why the vehicle does not hold what was meant; None where it does, or nobody can tell."""
        if self.outcome == "refused":
            return Finding(name, "upload-refused", f"the vehicle refused it: {self.reason}", _REFUSED)
        if self.differences or self.outcome == "different":
            found = self.differences or []
            told = f": {found[0]['message']}; {len(found)} in all" if found else ""
            return Finding(name, "upload-differs", f"the vehicle holds something else{told}", _DIFFERS)
        return None

    def take(self, result: VerifiedUpload) -> None:
        """Fill in from an upload."""
        self.outcome = result.outcome.kind
        self.reason = str(result.outcome)
        if result.held is not None:
            self.held = [item_json(item) for item in result.held]
            self.differences = [difference_json(difference) for difference in result.differences]
            if self.outcome == "unknown" or (self.outcome == "accepted" and self.differences):
                self.outcome = "different"
        if result.objections:
            # PX4 acknowledges and holds what it then will not fly.
            self.outcome = "refused"
            self.reason = "; ".join(result.objections)


@dataclass(slots=True)
class UploadReport:
    """One upload and how it stands; ``entries`` are those of it in the audit."""

    number: int
    plan_id: str
    plan_vehicle: str
    override_reason: str | None
    notes: tuple[str, ...]
    findings: tuple[Finding, ...]
    mission: Mission
    parts: dict[PartName, PartResult] = field(default_factory=dict)
    preflight: Preflight | None = None
    replaced: Replaced | None = None
    choice: MissionChoice = field(default_factory=MissionChoice)
    entries: tuple[Entry, ...] = ()

    @property
    def outcome(self) -> OutcomeName:
        """The worst of the parts attempted."""
        return max((part.outcome for part in self.parts.values()), key=STATUSES.index)

    @property
    def failings(self) -> tuple[Finding, ...]:
        """Parts that the vehicle refused, or of which it holds something else."""
        return tuple(finding for name, part in self.parts.items() if (finding := part.failing(name)))

    @property
    def verified(self) -> bool:
        """Whether every part is held as meant."""
        return all(part.verified for part in self.parts.values())


def new_report(
    number: int,
    plan_id: str,
    mission: Mission,
    parts: Sequence[PartName],
    override: str | None,
    findings: tuple[Finding, ...],
) -> UploadReport:
    """A report on parts that have not been sent yet."""
    return UploadReport(
        number,
        plan_id,
        mission.vehicle,
        override,
        mission.notes,
        findings,
        mission,
        {name: PartResult(len(mission.items_of(PARTS[name]))) for name in parts},
    )


def report_json(report: UploadReport) -> dict[str, Any]:
    """A report as plain values, without the items held."""
    return {
        "outcome": report.outcome,
        "verified": report.verified,
        "plan_vehicle": report.plan_vehicle,
        "override_reason": report.override_reason,
        "notes": list(report.notes),
        "findings": [finding_json(finding) for finding in report.findings],
        "parts": {
            name: {
                "outcome": part.outcome,
                "reason": part.reason,
                "verified": part.verified,
                "meant": part.meant,
                "held": None if part.held is None else len(part.held),
                "differences": part.differences,
            }
            for name, part in report.parts.items()
        },
    }


def judge_upload(
    plan: Plan,
    mission: Mission,
    parts: Sequence[PartName],
    state: VehicleState,
    override: str | None,
    stale: str | None = None,
) -> tuple[Finding, ...]:
    """Refuse what must not go up; returns what is worth knowing.

    Parameters
    ----------
    stale
        Why the plan is no longer that of its scenario; None while it is, or where nobody can tell.

    Raises
    ------
    RefusedError
        The autopilot would refuse or lose part of it: no override helps.
    UnsafeError
        A hard violation, a plan whose scenario is another by now, another kind of vehicle, or one in flight;
        an override with a reason passes. A vehicle that is still starting; then no override helps.
    """
    if state.booting:
        message = f"the vehicle is still starting ({state.mode or 'boot'}) and stores nothing yet"
        finding = Finding("vehicle", "vehicle-booting", message, "send it again in some seconds")
        raise UnsafeError(f"not uploaded: {message}; no override helps, send it again", (finding,))
    found = mission_findings(mission, [PARTS[name] for name in parts], state.firmware)
    errors = tuple(finding for finding in found if finding.severity == "error")
    if errors:
        raise RefusedError(f"the autopilot would not hold this mission: {errors[0].message}", errors)
    dangers = [
        Finding(violation.feature, violation.constraint, violation.message, _AGAIN)
        for violation in plan.violations
        # Turns of a file for nobody's vehicle forbid what has wings.
        if violation.hard or (violation.constraint == "turn-radius" and state.type != "multirotor")
    ]
    for part in parts:
        if PARTS[part] in mission.unread:
            message = f"the file's {part} could not be read whole, and not all of it would go up"
            dangers.append(Finding(part, f"{part}-unread", message, f"mend the file's {part}, or override"))
    if stale is not None:
        dangers.append(Finding("plan", "plan-stale", f"the plan is stale: {stale}", _STALE))
    if "mission" in parts and state.type not in ("other", mission.vehicle_type):
        message = f"the plan is for a {mission.vehicle_type}, the vehicle is a {state.type}"
        dangers.append(Finding("vehicle", "vehicle-type", message, "plan for this vehicle, or override"))
    aloft = any(v.name == mission.vehicle and v.home_altitude_m is not None for v in plan.vehicles)
    if aloft and "mission" in parts and not is_flying(state):
        message = "the plan begins in the air, and the vehicle is on the ground: it has no take-off"
        dangers.append(Finding("vehicle", "vehicle-on-ground", message, "plan from the ground, or override"))
    # A plan made to begin in the air is meant to be taken up in flight.
    if is_flying(state) and aloft and set(parts) != {"mission"}:
        message = "the vehicle is in flight, and a fence or rally points are not replaced under it"
        dangers.append(Finding("vehicle", "vehicle-flying", message, "send the mission alone, or override"))
    elif is_flying(state) and not aloft:
        message = "the vehicle is in flight and would follow the new mission at once"
        dangers.append(Finding("vehicle", "vehicle-flying", message, "wait until it has landed, or override"))
    if dangers and override is None:
        raise UnsafeError(
            f"not uploaded: {dangers[0].message}; to upload all the same, override it and say why "
            "(--override REASON; over HTTP override and reason)",
            tuple(dangers),
        )
    return found + tuple(dangers)


def comparing(
    dialect: Dialect,
) -> Callable[[tuple[MissionItem, ...], tuple[MissionItem, ...]], tuple[Difference, ...]]:
    """The comparison of what is meant with what is held, in a dialect."""
    return lambda meant, held: differences(meant, held, dialect)


async def read_back(client: VehicleClient, report: UploadReport) -> None:
    """Find out what the parts whose outcome is unknown have left in the vehicle."""
    compare = comparing(report.mission.dialect)
    for name, part in report.parts.items():
        if part.outcome == "unknown":
            kind = PARTS[name]
            meant = report.mission.items_of(kind)
            part.take(await resolve(client, Pending(meant, kind, compare, Unknown("link-lost"))))


async def send_parts(
    client: VehicleClient, report: UploadReport, progress: Callable[[PartName, Progress], None]
) -> None:
    """Upload the parts of a report in turn, up to the first that is not accepted."""
    mission = report.mission
    compare = comparing(mission.dialect)
    for name, part in report.parts.items():
        kind = PARTS[name]

        def tell(made: Progress, name: PartName = name) -> None:
            progress(name, made)

        part.take(await client.upload_verified(mission.items_of(kind), kind, compare, tell))
        if part.outcome != "accepted":
            return
