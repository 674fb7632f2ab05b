"""A raster on a coarse grid, for those who draw it."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import NamedTuple

import numpy as np

from app.services.errors import RefusedError
from app.services.terrain.rasters import unpack
from planner.errors import Finding

Bounds = tuple[float, float, float, float]
#: Places across a cell whose values a cell is the mean of: one alone would miss what lies between.
_ACROSS = 4


class RasterGrid(NamedTuple):
    """Mean values of the cells of a grid that is even in degrees.

    Parameters
    ----------
    bounds_deg
        West, south, east, north: the outer edges of the outer cells.
    values
        Row by row from the north-west; None where the raster knows nothing.
    """

    bounds_deg: Bounds
    columns: int
    rows: int
    values: list[float | None]


def drawn(folder: Path, name: str, asked_deg: Bounds | None, cells: int) -> RasterGrid:
    """A raster, or what of it lies within bounds, as a grid of at most so many cells a side; in a worker.

    Raises
    ------
    RefusedError
        Nothing of the raster lies within the bounds.
    """
    terrain = unpack(folder / f"{name}.npz", name)
    west, south, east, north = bounds_deg = _within(terrain.bounds_deg, asked_deg)
    narrowing = np.cos(np.radians((south + north) / 2.0))
    wide, high = (east - west) * narrowing, north - south
    cell_deg = max(wide, high) / cells
    columns = min(cells, max(1, round(wide / cell_deg)))
    rows = min(cells, max(1, round(high / cell_deg)))
    lon_deg = west + (np.arange(columns * _ACROSS) + 0.5) * (east - west) / (columns * _ACROSS)
    lat_deg = north - (np.arange(rows * _ACROSS) + 0.5) * (north - south) / (rows * _ACROSS)
    found = terrain.heights_at(np.stack(np.meshgrid(lon_deg, lat_deg), axis=-1))
    parts = found.reshape(rows, _ACROSS, columns, _ACROSS)
    with warnings.catch_warnings():
        # A cell of which nothing is known has no mean.
        warnings.simplefilter("ignore", RuntimeWarning)
        means = np.nanmean(parts, axis=(1, 3)).ravel()
    values = [float(f"{value:.6g}") if np.isfinite(value) else None for value in means.tolist()]
    return RasterGrid(bounds_deg, columns, rows, values)


def _within(all_deg: Bounds, asked_deg: Bounds | None) -> Bounds:
    """What of the bounds asked for the raster has, in its own turn of longitudes."""
    if asked_deg is None:
        return all_deg
    west, south, east, north = asked_deg
    turn_deg = 360.0 * round(((all_deg[0] + all_deg[2]) - (west + east)) / 720.0)
    found = (
        max(all_deg[0], west + turn_deg),
        max(all_deg[1], south),
        min(all_deg[2], east + turn_deg),
        min(all_deg[3], north),
    )
    if found[0] >= found[2] or found[1] >= found[3]:
        where = ", ".join(f"{value:.5f}" for value in all_deg)
        finding = Finding(
            "bounds_deg", "raster-elsewhere", "meet nothing of the raster", f"It lies within {where}."
        )
        raise RefusedError("the raster lies elsewhere", (finding,))
    return found
