"""Scenarios judged without planning them."""

from __future__ import annotations

from fastapi import APIRouter, Request

from app.deps import PlanningDep
from app.problems import responses
from app.routers.bodies import SCENARIO_BODY
from app.schemas import FindingOut, ValidationOut
from app.services.documents import read_object
from app.services.errors import RefusedError
from app.services.work import finding_json

router = APIRouter(prefix="/api/v1/scenarios", tags=["scenarios"])


@router.post(
    "/validate",
    summary="Validate a scenario",
    responses=responses(422),
    openapi_extra={"requestBody": SCENARIO_BODY},
)
async def validate(request: Request, planning: PlanningDep) -> ValidationOut:
    """200 with warnings, or 422 with every rule the scenario breaks; plans nothing."""
    document = read_object(await request.body())
    verdict = await planning.validate(document)
    if verdict.errors:
        raise RefusedError("the scenario is refused", verdict.errors + verdict.warnings)
    return ValidationOut(
        findings=[FindingOut.model_validate(finding_json(finding)) for finding in verdict.warnings]
    )
