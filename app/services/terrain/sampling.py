"""Heights read from the rasters of a folder."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path

import numpy as np

from app.services.terrain.rasters import unpack
from planner.airspace.terrain import Terrain

#: Rasters at hand in a worker; one of the largest has 160 MB.
_AT_HAND = 2


def heights_in(folder: Path, places_deg: Sequence[tuple[float, float]]) -> list[float | None]:
    """Heights at places from the rasters of a folder; in a worker."""
    files = [(path.stat().st_mtime_ns, path) for path in folder.glob("*.npz")] if folder.is_dir() else []
    places = np.asarray(places_deg, dtype=np.float64).reshape(-1, 2)
    heights_m = np.full(len(places), np.nan)
    for changed_ns, path in sorted(files, reverse=True):
        missing = np.isnan(heights_m)
        if not missing.any():
            break
        west, south, east, north = _bounds_deg(path, changed_ns)
        lon_deg = (places[:, 0] - west) % 360.0 + west
        inside = missing & (lon_deg <= east) & (places[:, 1] >= south) & (places[:, 1] <= north)
        if inside.any():
            heights_m[inside] = _terrain(path, changed_ns).heights_at(places[inside])
    return [float(height) if np.isfinite(height) else None for height in heights_m]


@lru_cache(maxsize=256)
def _bounds_deg(path: Path, changed_ns: int) -> tuple[float, float, float, float]:
    return _terrain(path, changed_ns).bounds_deg


@lru_cache(maxsize=_AT_HAND)
def _terrain(path: Path, changed_ns: int) -> Terrain:
    return unpack(path, path.stem)
