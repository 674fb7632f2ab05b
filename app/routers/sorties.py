"""What the flights of a plan saw together: a flight that was split is one sortie."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Header, Response

from app.deps import FlightsDep, PlanningDep
from app.problems import responses
from app.routers.answers import GEOJSON, GEOJSON_ANSWER, GEOTIFF, GEOTIFF_ANSWER, PostedDep, RegionName
from app.schemas.plans import PlanOut
from app.schemas.replans import ReplanIn
from app.services.documents import write_json

router = APIRouter(prefix="/api/v1/plans/{plan_id}", tags=["flights"])


@router.get(
    "/coverage",
    summary="The ground that all flights of a plan saw",
    response_class=Response,
    responses=responses(404, 409) | GEOJSON_ANSWER,
)
async def coverage(plan_id: str, flights: FlightsDep) -> Response:
    """As `coverage.geojson` of a flight, of all flights of the plan together.

    A flight that a restart of the service, a change of battery or an upload split is one sortie. What lay
    between two of its parts is `unknown`, neither seen nor missed, until an onboard log tells.
    """
    return Response(write_json(await flights.plan_coverage(plan_id)), media_type=GEOJSON)


@router.get(
    "/overlap.tif",
    summary="How many photos of all flights saw the ground",
    response_class=Response,
    responses=responses(404, 409) | GEOTIFF_ANSWER,
)
async def overlap_raster(plan_id: str, flights: FlightsDep, roi: RegionName = None) -> Response:
    """As `overlap.tif` of a flight, of all flights of the plan together."""
    return Response(await flights.plan_raster(plan_id, "overlap", roi), media_type=GEOTIFF)


@router.get(
    "/gsd.tif",
    summary="How finely photos of all flights saw the ground",
    response_class=Response,
    responses=responses(404, 409) | GEOTIFF_ANSWER,
)
async def gsd_raster(plan_id: str, flights: FlightsDep, roi: RegionName = None) -> Response:
    """As `gsd.tif` of a flight, of all flights of the plan together."""
    return Response(await flights.plan_raster(plan_id, "gsd", roi), media_type=GEOTIFF)


@router.post(
    "/refly", status_code=202, summary="Plan what no flight saw", responses=responses(404, 409, 422, 429)
)
async def refly(
    plan_id: str,
    flights: FlightsDep,
    planning: PlanningDep,
    posted: PostedDep,
) -> PlanOut:
    """Plan what none of the plan's flights is known to have seen, from the start.

    Ground of which nobody knows is planned, too: send the onboard logs first. 409 when nothing is left.
    """
    return await posted.of(await planning.submit(await flights.plan_refly(plan_id)))


@router.post(
    "/replan", status_code=202, summary="Plan anew in flight", responses=responses(404, 409, 422, 429)
)
async def replan(
    plan_id: str,
    body: ReplanIn,
    flights: FlightsDep,
    planning: PlanningDep,
    posted: PostedDep,
    idempotency_key: Annotated[
        str | None,
        Header(
            max_length=200,
            description="As of posting a scenario. From records of flights the same call asks for another "
            "plan a second later: say where the aircraft are to have the same one again.",
        ),
    ] = None,
) -> PlanOut:
    """A new plan from where the aircraft are: what is left, with what came in, moved or is gone.

    Where they are and what has been seen comes from the body, else from their flights of this plan as they
    are recorded, else from the plan at `at_s`. Aircraft on the ground start from there. The new plan's
    flights begin in the air (`in_flight` of its scenario's vehicles), without a take-off; limits count what
    has been used. Nothing is sent to a vehicle: upload it like any plan, in flight the items are replaced in
    place and read back.
    """
    record = await planning.submit(await flights.replan(plan_id, body.asked()), idempotency_key)
    return await posted.of(record)
