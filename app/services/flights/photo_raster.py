"""How often and how finely photos saw the regions of a plan, as GeoTIFF."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from shapely import union_all

from app.services.errors import ConflictError
from app.services.flights.seen import Sortie, asked_of, records_of
from planner.as_flown.photo_ground import PhotoGrid
from planner.frames import LocalFrame
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
    return _written(_north_up(grid, local), kind, crs)


def _north_up(grid: PhotoGrid, local: LocalFrame) -> PhotoGrid:
    """Cells from west to east and south to north, as every reader of rasters has them, by the nearest."""
    rows, columns = grid.counts.shape
    step_m, west_m, south_m = grid.step_m, grid.west_m, grid.south_m
    east_m, north_m = west_m + columns * step_m, south_m + rows * step_m
    corners = np.array([[west_m, south_m], [east_m, south_m], [east_m, north_m], [west_m, north_m]])
    upright = local.north_up(corners)
    first, last = upright.min(axis=0), upright.max(axis=0)
    # Grids hardly turned keep their cells.
    count = np.maximum(1, np.ceil((last - first) / step_m - 1e-6)).astype(np.int64)
    middles = [first[k] + (np.arange(count[k]) + 0.5) * step_m for k in range(2)]
    places = local.from_north_up(np.stack(np.meshgrid(*middles), axis=-1))
    column, row = np.moveaxis(np.floor((places - (west_m, south_m)) / step_m).astype(np.int64), -1, 0)
    inside = (column >= 0) & (column < columns) & (row >= 0) & (row < rows)
    counts = np.zeros(inside.shape, dtype=grid.counts.dtype)
    finest_m = np.full(inside.shape, np.inf, dtype=grid.finest_m.dtype)
    counts[inside] = grid.counts[row[inside], column[inside]]
    finest_m[inside] = grid.finest_m[row[inside], column[inside]]
    return PhotoGrid(float(first[0]), float(first[1]), step_m, counts, finest_m)


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
