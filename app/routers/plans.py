"""Plans: post a scenario, watch it being planned, cancel it."""

from __future__ import annotations

from collections.abc import AsyncGenerator
from contextlib import aclosing
from functools import partial
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Header, Query, Request, Response
from sse_starlette import EventSourceResponse, ServerSentEvent

from app.deps import FilingDep, PlanningDep, ScenariosDep
from app.problems import responses
from app.routers.answers import PageLimit, PageOffset, PostedDep
from app.routers.bodies import MISSION_BODY, SCENARIO_BODY
from app.routers.streams import event_stream
from app.schemas.plans import PlanList, PlanOut, PlanStateName
from app.services.pages import total_of
from app.services.plans.mission_scene import FileChoice

router = APIRouter(prefix="/api/v1/plans", tags=["plans"])

EVENT_STREAM: dict[int | str, dict[str, Any]] = {
    200: {
        "description": "Events `progress` while it is queued or running, then one of `done`, `failed`, "
        "`cancelled`; after `done`, once it is known, `bound`: the plan's `metrics` have `lower_bound_m` and "
        "`gap` then. The data of each is the plan's record.",
        "content": {"text/event-stream": {"schema": {"type": "string"}}},
    }
}


@router.post(
    "",
    status_code=202,
    summary="Plan a scenario",
    responses=responses(404, 409, 422, 429),
    openapi_extra={"requestBody": SCENARIO_BODY},
)
async def post_plan(
    request: Request,
    planning: PlanningDep,
    scenarios: ScenariosDep,
    posted: PostedDep,
    scenario_id: Annotated[
        str | None,
        Query(
            max_length=36,
            description="The kept scenario the body is of: the plan is `stale` once that one is another, or "
            "deleted.",
        ),
    ] = None,
    idempotency_key: Annotated[
        str | None,
        Header(
            max_length=200,
            description="Posting the same scenario again with the same key answers with the plan made the "
            "first time; another scenario with that key is a 409. Without a key each post is a new plan.",
        ),
    ] = None,
) -> PlanOut:
    """Judge the scenario and queue it; planning runs in the worker pool.

    The answer is 202 with the plan's record and its place in `Location`, also when `wait` saw its end.
    """
    if scenario_id is not None:
        await scenarios.get(scenario_id)
    return await posted.of(await planning.submit(await request.body(), idempotency_key, scenario_id))


@router.post(
    "/import",
    status_code=201,
    summary="Take in a mission file",
    responses=responses(404, 422),
    openapi_extra={"requestBody": MISSION_BODY},
)
async def import_mission(
    request: Request,
    response: Response,
    filing: FilingDep,
    name: Annotated[str, Query(max_length=200, description="What the plan is called.")] = "mission",
    autopilot: Annotated[
        Literal["ardupilot", "px4"] | None,
        Query(description="Whose mission it is, where the file does not say."),
    ] = None,
    vehicle_type: Annotated[
        Literal["fixed_wing", "multirotor", "vtol"] | None,
        Query(alias="type", description="Of the vehicle, where the file does not say."),
    ] = None,
    scenario_id: Annotated[
        str | None,
        Query(
            max_length=36,
            description="The kept scenario by whose zones, area, ground and aircraft it is judged; none: by "
            "its own fence alone.",
        ),
    ] = None,
    vehicle: Annotated[
        str | None,
        Query(max_length=200, description="The scenario's vehicle that flies it; the first alike."),
    ] = None,
    terrain: Annotated[
        str | None,
        Query(max_length=36, description="Id of an uploaded raster to judge it over, without a scenario."),
    ] = None,
    airspeed_m_s: Annotated[float | None, Query(gt=0, le=400, description="[what the file says]")] = None,
    min_turn_radius_m: Annotated[
        float | None, Query(gt=0, le=1e5, description="[by its speed and its autopilot's default bank]")
    ] = None,
) -> PlanOut:
    """A `.plan`, `.mission` or `.waypoints` as a plan that is done: listed, shown, exported, uploaded so.

    Its own items go to vehicles. `violations` are what the line they are flown on breaks: the file's own
    fence, the scenario's zones and area, the ground, turns too tight for wings. `warnings` tell what was
    mended and assumed. The features of `plan.geojson` with role `fence` and `rally` are the file's fence and
    rally points.
    """
    choice = FileChoice(name, autopilot, vehicle_type, vehicle, airspeed_m_s, min_turn_radius_m, terrain)
    record = await filing.take(await request.body(), choice, scenario_id)
    response.headers["Location"] = f"/api/v1/plans/{record.id}"
    return PlanOut.of(record)


@router.get("", summary="List plans", responses=responses(422))
async def list_plans(
    planning: PlanningDep,
    limit: PageLimit = 50,
    offset: PageOffset = 0,
    state: PlanStateName | None = None,
) -> PlanList:
    """Plans, newest first."""
    records = await planning.newest(limit, offset, state)
    total = await total_of(len(records), limit, offset, partial(planning.count, state))
    return PlanList(plans=[PlanOut.of(record) for record in records], total=total)


@router.get("/{plan_id}", summary="Read a plan's record", responses=responses(404))
async def get_plan(plan_id: str, planning: PlanningDep) -> PlanOut:
    """State, stage, progress; metrics and violations once it is done; the reason when it failed."""
    return PlanOut.of(await planning.get(plan_id))


@router.get(
    "/{plan_id}/events",
    summary="Watch a plan",
    response_class=EventSourceResponse,
    responses=EVENT_STREAM | responses(404),
)
async def plan_events(plan_id: str, planning: PlanningDep) -> EventSourceResponse:
    """Server-sent events from now to the plan's end and its bound; of an ended plan, its end state."""
    await planning.get(plan_id)

    async def stream() -> AsyncGenerator[ServerSentEvent, None]:
        async with aclosing(planning.events(plan_id)) as records:
            async for name, record in records:
                yield ServerSentEvent(PlanOut.of(record).model_dump_json(), event=name)

    return event_stream(stream())


@router.delete(
    "/{plan_id}",
    summary="Cancel or delete a plan",
    response_model=PlanOut,
    responses=responses(404) | {204: {"description": "It had ended and is deleted."}},
)
async def delete_plan(plan_id: str, planning: PlanningDep) -> Any:
    """Cancel a queued or running plan (200, its record), delete an ended one (204)."""
    record = await planning.remove(plan_id)
    return Response(status_code=204) if record is None else PlanOut.of(record)
