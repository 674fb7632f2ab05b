"""Sensors known by name: what scenarios may say instead of figures."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query

from app.problems import responses
from app.schemas.sensors import RadarOut, SensorList, SensorOut
from planner.sensors.cameras import CAMERAS
from planner.sensors.radars import RADARS

router = APIRouter(prefix="/api/v1/sensors", tags=["sensors"])


@router.get("", summary="List cameras and radars", responses=responses(422))
async def list_sensors(
    search: Annotated[
        str, Query(max_length=100, description="Words that name or kind hold, all of them, case aside.")
    ] = "",
) -> SensorList:
    """Cameras in use, and radars, by the figures published of them; `swathplan sensors` lists the same."""
    words = search.casefold().split()
    found = [
        camera
        for camera in CAMERAS.values()
        if all(word in f"{camera.name} {camera.kind}".casefold() for word in words)
    ]
    radars = [
        radar
        for radar in RADARS.values()
        if all(word in f"{radar.name} sar {radar.mode}".casefold() for word in words)
    ]
    return SensorList(
        sensors=[SensorOut.of(camera) for camera in found], radars=[RadarOut.of(radar) for radar in radars]
    )
