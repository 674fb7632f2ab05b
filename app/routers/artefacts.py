"""What a plan gives."""

from __future__ import annotations

from fastapi import APIRouter, Response

from app.deps import PlanningDep
from app.problems import responses

router = APIRouter(prefix="/api/v1/plans/{plan_id}", tags=["artefacts"])

GEOJSON = "application/geo+json"


@router.get(
    "/scenario",
    summary="The scenario",
    response_class=Response,
    responses=responses(404) | {200: {"content": {GEOJSON: {"schema": {"type": "object"}}}}},
)
async def scenario(plan_id: str, planning: PlanningDep) -> Response:
    """The scenario as it was sent."""
    return Response(await planning.scenario_text(plan_id), media_type=GEOJSON)


@router.get(
    "/plan.geojson",
    summary="The plan",
    response_class=Response,
    responses=responses(404, 409) | {200: {"content": {GEOJSON: {"schema": {"type": "object"}}}}},
)
async def plan(plan_id: str, planning: PlanningDep) -> Response:
    """The plan as a GeoJSON FeatureCollection; 409 while there is none."""
    return Response(await planning.plan_text(plan_id), media_type=GEOJSON)
