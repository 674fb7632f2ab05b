"""Flights: what was flown and what was seen."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, Query, Request, Response
from fastapi.responses import HTMLResponse

from app.deps import FlightsDep, PlanningDep, WhereaboutsDep
from app.problems import responses
from app.routers.answers import (
    GEOJSON,
    GEOJSON_ANSWER,
    GEOTIFF,
    GEOTIFF_ANSWER,
    PageLimit,
    PageOffset,
    PostedDep,
    RegionName,
)
from app.routers.streams import page_answer
from app.schemas.flights import FilledOut, FlightList, FlightOut
from app.schemas.plans import PlanOut
from app.services.documents import write_json

router = APIRouter(prefix="/api/v1/flights", tags=["flights"])

LOG_BODY: dict[str, Any] = {
    "required": True,
    "description": "The file itself, e.g. `curl --data-binary @00000042.BIN`.",
    "content": {"application/octet-stream": {"schema": {"type": "string", "format": "binary"}}},
}


@router.get("", summary="List flights", responses=responses(422))
async def list_flights(
    flights: FlightsDep,
    limit: PageLimit = 50,
    offset: PageOffset = 0,
    vehicle_id: Annotated[str | None, Query(max_length=36)] = None,
) -> FlightList:
    """Flights, newest first."""
    records = await flights.newest(limit, offset, vehicle_id)
    return FlightList(flights=[FlightOut.of(record) for record in records])


@router.get("/{flight_id}", summary="Read a flight", responses=responses(404))
async def get_flight(flight_id: str, flights: FlightsDep) -> FlightOut:
    """Which vehicle flew which plan, and when."""
    return FlightOut.of(await flights.get(flight_id))


@router.get(
    "/{flight_id}/track.geojson",
    summary="The track",
    response_class=Response,
    responses=responses(404) | GEOJSON_ANSWER,
)
async def track(flight_id: str, flights: FlightsDep) -> Response:
    """The line flown (role `track`), where the sensor was on (`sensor_on`), photos (`photo`), `switches`."""
    return Response(write_json(await flights.track(flight_id)), media_type=GEOJSON)


@router.get(
    "/{flight_id}/track.gpx",
    summary="The track as GPX",
    response_class=Response,
    responses=responses(404) | {200: {"content": {"application/gpx+xml": {"schema": {"type": "string"}}}}},
)
async def track_gpx(flight_id: str, flights: FlightsDep) -> Response:
    """The line flown with heights over the sea and times, as GPX 1.1."""
    return Response(await flights.track_gpx(flight_id), media_type="application/gpx+xml")


@router.get(
    "/{flight_id}/coverage.geojson",
    summary="The ground seen",
    response_class=Response,
    responses=responses(404, 409) | GEOJSON_ANSWER,
)
async def coverage(flight_id: str, flights: FlightsDep) -> Response:
    """Ground of each region seen and not seen as flown, the fractions, and the cross-track errors."""
    return Response(write_json(await flights.coverage(flight_id)), media_type=GEOJSON)


@router.get(
    "/{flight_id}/overlap.tif",
    summary="How many photos saw the ground",
    response_class=Response,
    responses=responses(404, 409) | GEOTIFF_ANSWER,
)
async def overlap_raster(flight_id: str, flights: FlightsDep, roi: RegionName = None) -> Response:
    """GeoTIFF over the regions that a camera was to see: photos that see each cell, 0 for none."""
    return Response(await flights.raster(flight_id, "overlap", roi), media_type=GEOTIFF)


@router.get(
    "/{flight_id}/gsd.tif",
    summary="How finely photos saw the ground",
    response_class=Response,
    responses=responses(404, 409) | GEOTIFF_ANSWER,
)
async def gsd_raster(flight_id: str, flights: FlightsDep, roi: RegionName = None) -> Response:
    """GeoTIFF: the least ground sampled distance of each cell in metres, NaN where no photo sees it."""
    return Response(await flights.raster(flight_id, "gsd", roi), media_type=GEOTIFF)


@router.get(
    "/{flight_id}/report.html",
    summary="A printable report",
    response_class=HTMLResponse,
    responses=responses(404, 409),
)
async def report(flight_id: str, flights: FlightsDep) -> HTMLResponse:
    """What was flown and seen: regions, missed triggers, cross-track errors, one page without scripts."""
    return page_answer(await flights.report(flight_id))


@router.post(
    "/{flight_id}/log",
    summary="Fill gaps from a log",
    responses=responses(404, 409, 422, 429),
    openapi_extra={"requestBody": LOG_BODY},
)
async def post_log(
    flight_id: str,
    request: Request,
    flights: FlightsDep,
    name: Annotated[str, Query(max_length=200, description="What to call it.")] = "log",
) -> FilledOut:
    """A log that the vehicle kept of this flight (`.bin`, `.ulg`), or another recording of it (`.tlog`).

    Matched by time and place; it fills what was not recorded (`gaps` of the coverage), and what it does not
    tell stays unknown. Sent again, it fills nothing more.
    """
    return FilledOut(**await flights.fill(flight_id, name, await request.body()))


@router.post(
    "/{flight_id}/refly", status_code=202, summary="Plan the gaps", responses=responses(404, 409, 422, 429)
)
async def refly(
    flight_id: str,
    flights: FlightsDep,
    whereabouts: WhereaboutsDep,
    planning: PlanningDep,
    posted: PostedDep,
) -> PlanOut:
    """Plan what the flight did not see, from where the aircraft is while it flies, else from the start.

    A new scenario, named `<name>-refly`: the unseen parts of the regions, slivers left out, among the same
    threats and zones. 409 when nothing is left to fly again for.
    """
    scenario = await flights.refly(flight_id, await whereabouts.place_in_flight(flight_id))
    return await posted.of(await planning.submit(scenario))
