"""Elevation files for tests, written by rasterio."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.cbook import get_sample_data
from numpy.typing import NDArray
from rasterio.io import MemoryFile
from rasterio.transform import from_bounds, from_origin

#: West, south, east, north of the elevation model of the Jacksboro fault that matplotlib carries.
JACKSBORO_DEG = (-84.41375, 36.44625, -84.07791666666667, 36.73291666666667)


def written(heights: NDArray[Any], driver: str = "GTiff", ext: str = ".tif", **profile: Any) -> bytes:
    """A raster as a file's bytes."""
    rows, columns = heights.shape[-2:]
    count = 1 if heights.ndim == 2 else len(heights)
    with MemoryFile(ext=ext) as memory:
        with memory.open(
            driver=driver, width=columns, height=rows, count=count, dtype=heights.dtype, **profile
        ) as dataset:
            dataset.write(heights if heights.ndim == 3 else heights[None])
        return bytes(memory.read())


def ramp(rows: int = 61, columns: int = 61, dtype: str = "float32", **profile: Any) -> bytes:
    """A GeoTIFF of a plane round 0° N 0° E: 100 m + 1 m a column + 2 m a row."""
    heights = (100 + np.arange(columns)[None, :] + 2 * np.arange(rows)[:, None]).astype(dtype)
    given = {"crs": "EPSG:4326", "transform": from_origin(-0.05, 0.07, 0.002, 0.002)} | profile
    return written(heights, **given)


def jacksboro() -> bytes:
    """The Jacksboro fault, real heights of Tennessee every three seconds, as a GeoTIFF."""
    path = get_sample_data("jacksboro_fault_dem.npz", asfileobj=False)
    heights = np.load(Path(str(path)))["elevation"]
    rows, columns = heights.shape
    transform = from_bounds(*JACKSBORO_DEG, columns, rows)
    return written(heights, crs="EPSG:4326", transform=transform)
