"""Bodies of the call that sends all vehicles of a plan their missions."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import BaseModel, Field, model_validator

from app.schemas.base import FindingOut, Strict
from app.schemas.missions import Part, UploadOut
from app.services.errors import RefusedError
from app.services.plans.work import finding_json
from app.services.vehicles.together import FleetReport, Told


class FleetMissionIn(Strict):
    """What to upload, and to whom."""

    plan_id: str = Field(max_length=36)
    vehicles: Annotated[dict[str, str], Field(min_length=1, max_length=100)] = Field(
        description="Ids of connected vehicles by the names of the plan's vehicles: every one of them.",
        examples=[{"north": "5f0c…", "south": "a71b…"}],
    )
    sorties: Annotated[dict[str, Annotated[int, Field(ge=1, le=10_000)]], Field(max_length=100)] = Field(
        default={}, description="Which flight of a vehicle, by its name; the first when left out."
    )
    parts: Annotated[list[Part], Field(min_length=1, max_length=3)] = Field(
        default=["mission"], description="Uploaded in this order to each vehicle."
    )
    payload: str | None = Field(default=None, max_length=200, description="As of one vehicle, for all.")
    gimbal: str | None = Field(default=None, max_length=200, description="As of one vehicle, for all.")
    override: bool = Field(default=False, description="As of one vehicle; needs a reason.")
    reason: str | None = Field(default=None, min_length=3, max_length=500)

    @model_validator(mode="after")
    def _say_why(self) -> Self:
        if self.override and self.reason is None:
            raise ValueError("an override needs a reason")
        return self


class ToldOut(BaseModel):
    """What became of one vehicle."""

    vehicle_id: str
    outcome: Literal["accepted", "different", "refused", "unknown", "not_attempted"]
    upload: UploadOut | None = Field(description="None where nothing was sent.")
    reason: str | None = Field(description="Why nothing was sent; None where something was.")
    findings: list[FindingOut]

    @classmethod
    def of(cls, told: Told) -> Self:
        """The answer for one."""
        found = told.failure.findings if isinstance(told.failure, RefusedError) else ()
        return cls.model_validate(
            {
                "vehicle_id": told.vehicle_id,
                "outcome": told.outcome,
                "upload": None if told.report is None else UploadOut.of(told.report, items=False),
                "reason": None if told.failure is None else str(told.failure),
                "findings": [finding_json(finding) for finding in found],
            }
        )


class FleetUploadOut(BaseModel):
    """One verdict of all vehicles of a plan, and what became of each."""

    plan_id: str
    outcome: Literal["accepted", "different", "refused", "unknown", "not_attempted"] = Field(
        description="The worst of all vehicles: accepted when each holds what was meant."
    )
    verified: bool = Field(description="Every vehicle was read back and holds what was meant.")
    vehicles: dict[str, ToldOut]

    @classmethod
    def of(cls, report: FleetReport) -> Self:
        """The answer for a report."""
        return cls.model_validate(
            {
                "plan_id": report.plan_id,
                "outcome": report.outcome,
                "verified": report.verified,
                "vehicles": {name: ToldOut.of(told) for name, told in report.vehicles.items()},
            }
        )
