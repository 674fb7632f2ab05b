"""Airframes known by name: what scenarios may say instead of figures."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query

from app.problems import responses
from app.schemas.aircraft import AircraftList, AircraftOut
from planner.vehicle.airframes import AIRFRAMES

router = APIRouter(prefix="/api/v1/aircraft", tags=["aircraft"])


@router.get("", summary="List airframes", responses=responses(422))
async def list_aircraft(
    search: Annotated[
        str, Query(max_length=100, description="Words that name or type hold, all of them, case aside.")
    ] = "",
) -> AircraftList:
    """Airframes in use, by the figures published of them; `swathplan aircraft` lists the same."""
    words = search.casefold().split()
    found = [
        airframe
        for airframe in AIRFRAMES.values()
        if all(word in f"{airframe.name} {airframe.members['type']}".casefold() for word in words)
    ]
    return AircraftList(aircraft=[AircraftOut.of(airframe) for airframe in found])
