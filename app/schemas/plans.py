"""Bodies of answers about scenarios and plans."""

from __future__ import annotations

from datetime import datetime
from typing import Any, Literal, Self

from pydantic import BaseModel, Field

from app.schemas.base import FindingOut
from app.services.records import PlanRecord

PlanStateName = Literal["queued", "running", "done", "failed", "cancelled"]


class ValidationOut(BaseModel):
    """The verdict on a scenario that may be planned."""

    valid: bool = True
    findings: list[FindingOut] = Field(description="Warnings; a scenario with errors is answered with 422.")


class PlanOut(BaseModel):
    """A plan's record."""

    id: str
    name: str
    state: PlanStateName
    stage: str | None = Field(description="The stage at work, or at which it ended.")
    progress: float = Field(ge=0, le=1, description="Fraction of the whole plan.")
    created_at: datetime
    started_at: datetime | None
    ended_at: datetime | None
    warnings: list[FindingOut]
    metrics: dict[str, Any] | None = Field(description="Of a done plan; see plan.geojson.")
    violations: list[dict[str, Any]] | None = Field(description="Of a done plan; empty when none.")
    methods: dict[str, Any] | None = Field(description="The algorithm used in each stage.")
    scenario_hash: str | None
    scenario_id: str | None = Field(description="The kept scenario it was made of.")
    stale: bool | None = Field(
        description="Whether that scenario is another one by now; null for a plan made of none."
    )
    stale_reason: str | None = Field(description="Why it is stale.")
    planner_version: str | None
    seed: int | None
    error: dict[str, Any] | None = Field(description="Of a failed plan: type, title, detail, errors.")
    links: dict[str, str]

    @classmethod
    def of(cls, record: PlanRecord) -> Self:
        """The answer for a record."""
        summary = record.summary or {}
        base = f"/api/v1/plans/{record.id}"
        links = {"self": base, "events": f"{base}/events", "scenario": f"{base}/scenario"}
        if record.state == "done":
            artefacts = (
                "plan.geojson",
                "network.geojson",
                "mission.plan",
                "mission.waypoints",
                "mission.kml",
                "mission.kmz",
                "report.html",
            )
            links |= {name: f"{base}/{name}" for name in artefacts}
        return cls(
            id=record.id,
            name=record.name,
            state=record.state,
            stage=record.stage,
            progress=record.progress,
            created_at=record.created_at,
            started_at=record.started_at,
            ended_at=record.ended_at,
            warnings=[FindingOut(**warning) for warning in record.warnings],
            metrics=summary.get("metrics"),
            violations=summary.get("violations"),
            methods=summary.get("methods"),
            scenario_hash=summary.get("scenario_hash", record.scenario_hash),
            scenario_id=record.scenario_id,
            stale=record.stale,
            stale_reason=record.stale_reason,
            planner_version=summary.get("planner_version"),
            seed=summary.get("seed"),
            error=record.error,
            links=links,
        )


class PlanList(BaseModel):
    """Plans, newest first."""

    plans: list[PlanOut]
    total: int


class PathProfileOut(BaseModel):
    """Heights along one path; the lists are of the same length."""

    vehicle: str
    sortie: int
    at_m: list[float] = Field(description="Along the path, in three dimensions, as its phases count.")
    altitude_m: list[float] = Field(description="Of the aircraft, over altitude_reference.")
    ground_m: list[float | None] = Field(description="Of the ground below it, over the same; null: unknown.")


class PhotosProfileOut(BaseModel):
    """The ground under the photos of one collect, in their order."""

    vehicle: str
    seq: int
    ground_m: list[float | None] = Field(description="Over altitude_reference; null: unknown.")


class ProfileOut(BaseModel):
    """Heights along a plan's lines, of the aircraft and of the ground."""

    altitude_reference: Literal["amsl", "home", "terrain"]
    ground: Literal["flat", "raster"] | None = Field(
        description="What is known of the ground: flat at the height of home, or an elevation raster. null: "
        "nothing, of a mission file or where the scenario's raster is gone."
    )
    paths: list[PathProfileOut]
    photos: list[PhotosProfileOut]
