"""Flights: what was flown and what was seen."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, Query, Response

from app.deps import FlightsDep
from app.problems import responses
from app.schemas_vehicles import FlightList, FlightOut
from app.services.documents import write_json

router = APIRouter(prefix="/api/v1/flights", tags=["flights"])

GEOJSON = "application/geo+json"
GEOJSON_ANSWER: dict[int | str, dict[str, Any]] = {
    200: {"content": {GEOJSON: {"schema": {"type": "object"}}}}
}


@router.get("", summary="List flights", responses=responses(422))
async def list_flights(
    flights: FlightsDep,
    limit: Annotated[int, Query(ge=1, le=1000)] = 50,
    offset: Annotated[int, Query(ge=0, le=2**31)] = 0,
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
    """The line flown (role `track`) and where the sensor was on (role `sensor_on`)."""
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
