"""Bodies of requests and answers about the pre-flight check and parameters."""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import Literal, Self

from pydantic import BaseModel, Field

from app.schemas.base import Strict
from app.services.vehicles.inspection import ParameterReport
from app.services.vehicles.preflight import Preflight
from mavlink.encoding.options import Arcs
from mavlink.rules.table import ParameterFinding

GIMBAL_IS = (
    "What points the sensor to the side of each pass, tilt in degrees from straight down: manager:tilt=45, "
    "manager:tilt=45,yaw=course,device=1, mount:tilt=45; none, or null, where it is bolted on."
)
ARCS_IS = "How arcs are said: points along them, loiter turns (ArduPlane alone), or auto; null: auto."
CHORD_ERROR_IS = "Largest distance between an arc and the lines between its points; null: 2 m."


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
    sortie: int = Field(default=1, ge=1, le=10_000, description="Which of the vehicle's flights in the plan.")
    payload: str | None = Field(
        default=None,
        max_length=200,
        description="How the sensor is switched, e.g. relay:0; left out, a plan's cameras by their triggers.",
    )
    gimbal: str | None = Field(default=None, max_length=200, description=GIMBAL_IS)
    arcs: Arcs | None = Field(default=None, description=ARCS_IS)
    chord_error_m: float | None = Field(default=None, ge=0.1, le=100.0, description=CHORD_ERROR_IS)


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
