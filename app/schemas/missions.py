"""Bodies of requests and answers about missions on a vehicle: sent, held, cleared."""

from __future__ import annotations

from datetime import datetime
from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, Field, field_validator, model_validator

from app.schemas.base import FindingOut, Strict
from app.schemas.preflight import ARCS_IS, CHORD_ERROR_IS, GIMBAL_IS, PreflightOut
from app.services.plans.work import finding_json
from app.services.vehicles.replaced import Replaced
from app.services.vehicles.uploads import UploadReport
from app.services.vehicles.vehicle import Vehicle
from mavlink.encoding.options import Arcs

Part = Literal["mission", "fence", "rally"]


class MissionIn(Strict):
    """What to upload."""

    plan_id: str = Field(max_length=36)
    parts: Annotated[list[Part], Field(min_length=1, max_length=3)] = Field(
        default=["mission"], description="Uploaded in this order; the first refusal ends it."
    )
    vehicle: str | None = Field(default=None, max_length=200, description="Vehicle of the plan; its first.")
    sortie: int = Field(default=1, ge=1, le=10_000, description="Which of the vehicle's flights in the plan.")
    payload: str | None = Field(
        default=None,
        max_length=200,
        description="How the sensor is switched, e.g. relay:0; left out, a plan's cameras by their triggers.",
    )
    gimbal: str | None = Field(default=None, max_length=200, description=GIMBAL_IS)
    arcs: Arcs | None = Field(default=None, description=ARCS_IS)
    chord_error_m: float | None = Field(default=None, ge=0.1, le=100.0, description=CHORD_ERROR_IS)
    override: bool = Field(
        default=False,
        description="Upload although a hard constraint is broken, or the plan is stale; needs a reason.",
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


class PassOut(BaseModel):
    """A pass of the plan."""

    seq: int
    roi: str


class InFlightOut(BaseModel):
    """What a flying aircraft makes of a mission that took the place of its own."""

    message: str
    mode: str
    item: int | None = Field(description="It flies to this item next; null where it does not say.")
    skipped: list[PassOut] = Field(description="Passes of the new mission that lie behind that item.")
    cut: PassOut | None = Field(description="The pass it goes on in the middle of, its sensor off.")

    @classmethod
    def of(cls, replaced: Replaced) -> Self:
        """The answer for it."""
        cut = None if replaced.cut is None else PassOut(seq=replaced.cut[0], roi=replaced.cut[1])
        skipped = [PassOut(seq=seq, roi=roi) for seq, roi in replaced.skipped]
        return cls(message=str(replaced), mode=replaced.mode, item=replaced.item, skipped=skipped, cut=cut)


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
    in_flight: InFlightOut | None = Field(description="Of a mission replaced in flight; null otherwise.")

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
            in_flight=None if report.replaced is None else InFlightOut.of(report.replaced),
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


class HeldOut(BaseModel):
    """What a vehicle holds."""

    vehicle_id: str
    parts: dict[str, list[dict[str, Any]]]


class ClearedOut(BaseModel):
    """How clearing went, part by part."""

    vehicle_id: str
    parts: dict[str, Literal["accepted", "refused", "unknown"]]
