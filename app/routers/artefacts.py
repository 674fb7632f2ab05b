"""What a plan gives."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query, Response

from app.deps import DeskDep, PlanningDep
from app.problems import responses
from app.routers.answers import GEOJSON, GEOJSON_ANSWER
from app.routers.streams import page_answer
from app.schemas.plans import ProfileOut
from app.schemas.preflight import ARCS_IS, CHORD_ERROR_IS
from app.services.plans.missions import AutopilotName, MissionChoice, exported
from app.services.plans.network import network_text
from app.services.plans.profile import profile_of
from app.services.reports.report import write_report
from mavlink.encoding.options import Arcs

router = APIRouter(prefix="/api/v1/plans/{plan_id}", tags=["artefacts"])


@router.get(
    "/scenario",
    summary="The scenario",
    response_class=Response,
    responses=responses(404) | GEOJSON_ANSWER,
)
async def scenario(plan_id: str, planning: PlanningDep) -> Response:
    """The scenario as it was sent."""
    return Response(await planning.scenario_text(plan_id), media_type=GEOJSON)


@router.get(
    "/plan.geojson",
    summary="The plan",
    response_class=Response,
    responses=responses(404, 409) | GEOJSON_ANSWER,
)
async def plan(plan_id: str, planning: PlanningDep) -> Response:
    """The plan as a GeoJSON FeatureCollection; 409 while there is none."""
    return Response(await planning.plan_text(plan_id), media_type=GEOJSON)


@router.get("/profile", summary="Heights along the flight", responses=responses(404, 409, 422))
async def profile(plan_id: str, planning: PlanningDep, desk: DeskDep) -> ProfileOut:
    """Heights along each path, of the aircraft and of the ground below, and of the ground under each photo.

    Over an elevation raster a path is told at places half as far apart as the raster's posts, 3,000 at most.
    """
    plan_text, scenario_text = await planning.plan_text(plan_id), await planning.scenario_text(plan_id)
    made = await desk.run("plan", profile_of, plan_text, scenario_text, planning.terrain_folder)
    return ProfileOut.model_validate(made)


@router.get(
    "/network.geojson",
    summary="Segments round the targets",
    response_class=Response,
    responses=responses(404, 409, 422) | GEOJSON_ANSWER,
)
async def network(
    plan_id: str,
    planning: PlanningDep,
    desk: DeskDep,
    target: Annotated[
        list[str] | None, Query(description="Names of regions; all when left out.", max_length=200)
    ] = None,
) -> Response:
    """The recognition segments round each target: those chosen, those that could be, those ruled out and why.

    Features of role `segment` say target, sensor, look, heading, stand-off, part of the target seen (line of
    sight over terrain counted), quality, exposure to threats, who can fly it, and by how much the flight
    would be longer with it; `ingress` and `egress` are where it begins and ends, `target` says which sensors
    meet the quality that is asked.
    """
    plan_text, scenario_text = await planning.plan_text(plan_id), await planning.scenario_text(plan_id)
    told = (plan_text, scenario_text, planning.terrain_folder, tuple(target or ()))
    return Response(await desk.run("plan", network_text, *told), media_type=GEOJSON)


VehicleQuery = Annotated[
    str | None, Query(description="Vehicle of the plan; its first when left out.", max_length=200)
]
AutopilotQuery = Annotated[
    AutopilotName | None, Query(description="Encode for this autopilot instead of the plan's.")
]
PayloadQuery = Annotated[
    str | None,
    Query(
        description="How the sensor is switched: relay:0, servo:9:1900:1100, actuator:1:1:-1, "
        "aux:1 or main:9 (an output of PX4's), "
        "camera:distance=25, image:interval=2, command:…, trigger:distance, trigger:time or trigger:video "
        "(the plan's cameras). Left out: the plan's cameras by their own triggers, all else by relay:0.",
        max_length=200,
    ),
]
GimbalQuery = Annotated[
    str | None,
    Query(
        description="What points the sensor to the side of each pass, tilt in degrees from straight down: "
        "manager:tilt=45, manager:tilt=45,yaw=course,device=1, mount:tilt=45; none where it is bolted on.",
        max_length=200,
    ),
]
SortieQuery = Annotated[
    int, Query(ge=1, le=10_000, description="Which of the vehicle's flights in the plan.")
]
ArcsQuery = Annotated[Arcs | None, Query(description=ARCS_IS)]
ChordErrorQuery = Annotated[float | None, Query(ge=0.1, le=100.0, description=CHORD_ERROR_IS)]


def _mission_route(form: str, name: str, media_type: str, summary: str, kind: str = "string") -> None:
    @router.get(
        f"/{name}",
        summary=summary,
        operation_id=f"mission_{form}",
        response_class=Response,
        responses=responses(404, 409, 422) | {200: {"content": {media_type: {"schema": {"type": kind}}}}},
    )
    async def mission(
        plan_id: str,
        planning: PlanningDep,
        desk: DeskDep,
        vehicle: VehicleQuery = None,
        autopilot: AutopilotQuery = None,
        payload: PayloadQuery = None,
        gimbal: GimbalQuery = None,
        arcs: ArcsQuery = None,
        chord_error_m: ChordErrorQuery = None,
        sortie: SortieQuery = 1,
    ) -> Response:
        """The mission of one vehicle, as a file to save."""
        text = await planning.plan_text(plan_id)
        own = (vehicle, autopilot, payload, gimbal)
        choice = MissionChoice(*own, arcs=arcs, chord_error_m=chord_error_m, sortie=sortie)
        body = await desk.run("plan", exported, text, choice, form)
        return Response(
            body,
            media_type=media_type,
            headers={"Content-Disposition": f'attachment; filename="{plan_id[:8]}-{name}"'},
        )


_mission_route("plan", "mission.plan", "application/json", "QGroundControl plan", "object")
_mission_route("waypoints", "mission.waypoints", "text/plain", "Waypoint file (QGC WPL 110)")
_mission_route("kml", "mission.kml", "application/vnd.google-earth.kml+xml", "KML")
_mission_route("kmz", "mission.kmz", "application/vnd.google-earth.kmz", "KMZ")


@router.get(
    "/report.html",
    summary="Printable report",
    response_class=Response,
    responses=responses(404, 409) | {200: {"content": {"text/html": {"schema": {"type": "string"}}}}},
)
async def report(
    plan_id: str,
    planning: PlanningDep,
    desk: DeskDep,
    vehicle: Annotated[
        str | None, Query(description="Leave out what other vehicles fly.", max_length=200)
    ] = None,
) -> Response:
    """Metrics, violations, collects and methods on one page without scripts."""
    record = await planning.get(plan_id)
    plan_text, scenario_text = await planning.plan_text(plan_id), await planning.scenario_text(plan_id)
    page = await desk.run("plan", write_report, record, plan_text, scenario_text, vehicle)
    return page_answer(page)
