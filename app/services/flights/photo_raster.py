"""How often and how finely photos saw the regions of a plan, as GeoTIFF."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from shapely import union_all

from app.services.errors import ConflictError
from app.services.flights.seen import Sortie, asked_of, records_of
from planner.as_flown.photo_ground import PhotoGrid
from planner.tasks.flown import sortie_photos

RasterKind = Literal["overlap", "gsd"]


def raster_of(sortie: Sortie, kind: RasterKind, roi: str | None) -> bytes:
    """A raster over one region, or all that a camera was to see: photos a cell, or metres a pixel.

    ``overlap``: how many photos see each cell, 16 bits, 0 for none. ``gsd``: the least ground sampled
    distance of them in metres, 32-bit floats, NaN where none sees it. Each in a transverse Mercator
    projection about the scenario's middle; cells are a fortieth of a photo's shorter side, larger where the
    area is.

    Raises
    ------
    ConflictError
        No camera was planned, or none sees that region.
    """
    scenario, plan = asked_of(sortie)
    cameras = sortie_photos(scenario, plan, records_of(sortie))
    wanted = [
        region
        for region in scenario.regions
        if cameras.sees(scenario.suite.of(region).name) and roi in (None, region.name)
    ]
    if not wanted:
        raise ConflictError("no photos were to be taken" + ("" if roi is None else f" of region {roi!r}"))
    sensor = scenario.suite.of(wanted[0]).name
    area = union_all([r.area for r in wanted if scenario.suite.of(r).name == sensor])
    grid = cameras.grid(area, sensor)
    local = scenario.frame
    crs = (
        f"+proj=tmerc +lat_0={local.lat_deg!r} +lon_0={local.lon_deg!r} +k_0=1 +datum=WGS84 +units=m +no_defs"
    )
    return _written(grid, kind, crs)


def _written(grid: PhotoGrid, kind: RasterKind, crs: str) -> bytes:
    from rasterio.io import MemoryFile
    from rasterio.transform import from_origin

    rows, columns = grid.counts.shape
    north_m = grid.south_m + rows * grid.step_m
    gsd_m = np.where(grid.counts > 0, grid.finest_m, np.nan).astype(np.float32)
    values: Any = grid.counts if kind == "overlap" else gsd_m
    profile = {
        "driver": "GTiff",
        "width": columns,
        "height": rows,
        "count": 1,
        "dtype": values.dtype.name,
        "crs": crs,
        "transform": from_origin(grid.west_m, north_m, grid.step_m, grid.step_m),
        "nodata": 0 if kind == "overlap" else float("nan"),
        "compress": "deflate",
        "tiled": rows > 256 and columns > 256,
    }
    with MemoryFile() as file:
        with file.open(**profile) as raster:
            raster.write(values[::-1], 1)
            raster.set_band_description(1, "photos" if kind == "overlap" else "ground sampled distance, m")
        return bytes(file.read())
