"""Elevation rasters: send one, name it in a scenario."""

from __future__ import annotations

import math
from typing import Annotated, Any

from fastapi import APIRouter, Query, Request, Response

from app.deps import TerrainDep
from app.problems import responses
from app.routers.answers import PageLimit, PageOffset
from app.schemas.terrain import RasterGridOut, TerrainList, TerrainOut
from app.services.errors import RefusedError
from app.services.pages import total_of
from app.services.terrain.picture import Bounds
from app.services.terrain.rasters import VerticalDatum
from planner.errors import Finding

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


@router.get(
    "/{terrain_id}/grid", summary="Read a raster's values on a coarse grid", responses=responses(404, 422)
)
async def get_grid(
    terrain_id: str,
    terrain: TerrainDep,
    bounds: Annotated[
        str | None,
        Query(
            max_length=200,
            description="West, south, east, north in degrees, with commas between; without it, all there is.",
            examples=["9.1,47.0,9.2,47.1"],
        ),
    ] = None,
    cells: Annotated[int, Query(ge=1, le=256, description="Of the longer side.")] = 96,
) -> RasterGridOut:
    """To be drawn: the mean of each cell, heights in metres over mean sea level, or importance as it is."""
    grid = await terrain.grid(terrain_id, None if bounds is None else _bounds_deg(bounds), cells)
    return RasterGridOut(**grid._asdict())


def _bounds_deg(text: str) -> Bounds:
    try:
        west, south, east, north = (float(word) for word in text.split(","))
    except ValueError:
        west = south = east = north = math.nan
    if not (-540.0 <= west < east <= 540.0 and east - west <= 360.0 and -90.0 <= south < north <= 90.0):
        finding = Finding(
            "bounds",
            "bad-value",
            "is no west, south, east, north in degrees",
            "Give four numbers with commas between; west less than east, south less than north.",
        )
        raise RefusedError("the bounds are refused", (finding,))
    return west, south, east, north


@router.delete("/{terrain_id}", status_code=204, summary="Delete a raster", responses=responses(404))
async def delete_terrain(terrain_id: str, terrain: TerrainDep) -> None:
    """Scenarios can name it no more; plans made on it stay."""
    await terrain.remove(terrain_id)
