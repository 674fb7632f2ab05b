"""Elevation rasters: send one, name it in a scenario."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, Query, Request, Response

from app.deps import TerrainDep
from app.problems import responses
from app.routers.answers import PageLimit, PageOffset
from app.schemas.terrain import TerrainList, TerrainOut
from app.services.pages import total_of
from app.services.terrain.rasters import VerticalDatum

router = APIRouter(prefix="/api/v1/terrain", tags=["terrain"])

_FILE: dict[str, Any] = {"schema": {"type": "string", "format": "binary"}}
RASTER_BODY: dict[str, Any] = {
    "required": True,
    "description": "The file itself, e.g. `curl --data-binary @dem.tif`.",
    "content": {"application/octet-stream": _FILE, "image/tiff": _FILE},
}


@router.post(
    "",
    status_code=201,
    summary="Send an elevation raster",
    responses=responses(422) | {200: {"model": TerrainOut, "description": "This file is here already."}},
    openapi_extra={"requestBody": RASTER_BODY},
)
async def post_terrain(
    request: Request,
    response: Response,
    terrain: TerrainDep,
    filename: Annotated[
        str,
        Query(max_length=255, description="The file's name; SRTM HGT files tell their place by it."),
    ] = "",
    name: Annotated[str | None, Query(min_length=1, max_length=200, description="What to call it.")] = None,
    vertical_datum: Annotated[
        VerticalDatum | None,
        Query(
            description="Of the heights, where the file does not say or says it wrongly; `none` for values "
            "that are no heights: importance, in any unit, of any size."
        ),
    ] = None,
) -> TerrainOut:
    """GeoTIFF, DTED or SRTM HGT in any horizontal reference system; heights in metres.

    Scenarios name it by the `id` of the answer, in their member `terrain`, or `importance_raster`.
    """
    record, new = await terrain.add(await request.body(), filename, name, vertical_datum)
    response.headers["Location"] = f"/api/v1/terrain/{record.id}"
    if not new:
        response.status_code = 200
    return TerrainOut.of(record)


@router.get("", summary="List elevation rasters", responses=responses(422))
async def list_terrain(
    terrain: TerrainDep,
    limit: PageLimit = 50,
    offset: PageOffset = 0,
) -> TerrainList:
    """Rasters, newest first."""
    records = await terrain.newest(limit, offset)
    total = await total_of(len(records), limit, offset, terrain.count)
    return TerrainList(terrain=[TerrainOut.of(record) for record in records], total=total)


@router.get("/{terrain_id}", summary="Read a raster's record", responses=responses(404))
async def get_terrain(terrain_id: str, terrain: TerrainDep) -> TerrainOut:
    """Where it lies, how fine it is, what its heights count from."""
    return TerrainOut.of(await terrain.get(terrain_id))


@router.delete("/{terrain_id}", status_code=204, summary="Delete a raster", responses=responses(404))
async def delete_terrain(terrain_id: str, terrain: TerrainDep) -> None:
    """Scenarios can name it no more; plans made on it stay."""
    await terrain.remove(terrain_id)
