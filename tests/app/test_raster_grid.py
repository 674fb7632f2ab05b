"""A raster's values on a coarse grid, to be drawn: against GDAL's averages, in bounds, or refused."""

from __future__ import annotations

import httpx
import numpy as np
import pytest
from rasterio.io import MemoryFile
from rasterio.transform import from_bounds, from_origin
from rasterio.warp import Resampling, reproject

from tests.app.rasters import JACKSBORO_DEG, jacksboro, ramp

TERRAIN = "/api/v1/terrain"


async def sent(client: httpx.AsyncClient, content: bytes, **params: str) -> str:
    """Id of a raster that the service took."""
    return str((await client.post(TERRAIN, content=content, params=params)).json()["id"])


@pytest.mark.parametrize("bounds", [None, (-84.35, 36.5, -84.2, 36.68)])
async def test_cells_have_the_mean_of_what_lies_in_them(
    client: httpx.AsyncClient, bounds: tuple[float, float, float, float] | None
) -> None:
    """On real hills a grid differs from GDAL's averages over the same cells by little of their relief."""
    content = jacksboro()
    raster = await sent(client, content, vertical_datum="EGM96")
    params = {"cells": "24"} | ({} if bounds is None else {"bounds": ",".join(map(str, bounds))})
    grid = (await client.get(f"{TERRAIN}/{raster}/grid", params=params)).json()
    assert grid["bounds_deg"] == pytest.approx(bounds or JACKSBORO_DEG, abs=1e-3)
    assert max(grid["rows"], grid["columns"]) == 24
    means = np.array(grid["values"], dtype=np.float64).reshape(grid["rows"], grid["columns"])
    twin = np.empty_like(means)
    with MemoryFile(content) as memory, memory.open() as dataset:
        reproject(
            dataset.read(1).astype(np.float64),
            twin,
            src_transform=dataset.transform,
            src_crs="EPSG:4326",
            dst_crs="EPSG:4326",
            dst_transform=from_bounds(*grid["bounds_deg"], grid["columns"], grid["rows"]),
            resampling=Resampling.average,
        )
    known = np.isfinite(means)
    assert known.mean() > 0.9
    assert np.abs(means - twin)[known].max() < 0.1 * np.ptp(twin)
    assert np.abs(means - twin)[known].mean() < 0.01 * np.ptp(twin)


async def test_bounds_in_another_turn_of_longitudes_are_the_same_place(client: httpx.AsyncClient) -> None:
    """A raster at the 180th meridian is found from either side of it."""
    raster = await sent(client, ramp(transform=from_origin(179.95, 0.07, 0.002, 0.002)))
    there = [
        (await client.get(f"{TERRAIN}/{raster}/grid", params={"bounds": bounds, "cells": "8"})).json()
        for bounds in ("179.97,-0.04,180.05,0.05", "-180.03,-0.04,-179.95,0.05")
    ]
    assert there[0]["values"] == there[1]["values"]
    assert None not in there[0]["values"]


@pytest.mark.parametrize(
    ("params", "rule"),
    [
        ({"bounds": "1,2,3"}, "bad-value"),
        ({"bounds": "a,b,c,d"}, "bad-value"),
        ({"bounds": "3,2,1,4"}, "bad-value"),
        ({"bounds": "nan,2,3,4"}, "bad-value"),
        ({"bounds": "10,50,11,51"}, "raster-elsewhere"),
        ({"cells": "0"}, None),
        ({"cells": "100000"}, None),
    ],
)
async def test_what_is_no_place_of_the_raster_is_refused(
    client: httpx.AsyncClient, params: dict[str, str], rule: str | None
) -> None:
    """Bounds that are none, that lie elsewhere, and more cells than are drawn: 422 with the rule."""
    raster = await sent(client, ramp())
    answer = await client.get(f"{TERRAIN}/{raster}/grid", params=params)
    assert answer.status_code == 422
    assert answer.headers["content-type"] == "application/problem+json"
    if rule is not None:
        assert answer.json()["errors"][0]["rule"] == rule


async def test_an_unknown_raster_has_no_grid(client: httpx.AsyncClient) -> None:
    """404, as of its record."""
    assert (await client.get(f"{TERRAIN}/nowhere/grid")).status_code == 404
