"""How often photos saw the ground of an area and how finely, on a grid over it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray
from shapely import box, union_all
from shapely.geometry import MultiPolygon, Polygon
from shapely.geometry.base import BaseGeometry

from planner.airspace.terrain import Ground
from planner.as_flown.limits import FLATTEST_RAD
from planner.as_flown.photo import Shots, half_tangents
from planner.as_flown.photo_kernels import lay_photos
from planner.plan import PlanCamera

Floats = NDArray[np.float64]

#: Cells are at most this part of a photo's shorter side, of what a region is wide, and no smaller than this,
#: but for regions that are smaller themselves.
PHOTO_PART, WIDTH_PART, LEAST_M = 1.0 / 40.0, 1.0 / 12.0, 0.25
#: So many cells a grid has at most: they grow where an area is larger.
MOST_CELLS = 4_000_000
#: Photos are laid so many at a time, between which whoever waits may be told.
CHUNK = 2_000


@dataclass(frozen=True, slots=True)
class PhotoGrid:
    """Cells over an area.

    Parameters
    ----------
    west_m, south_m, step_m
        Its corner and the cells' size, in the local frame.
    counts
        How many photos see each cell's middle, uint16 (rows, columns), northward.
    finest_m
        The least ground sampled distance of them: the mean of along and across the line of sight, on level
        ground; float32, infinite where there is none.
    """

    west_m: float
    south_m: float
    step_m: float
    counts: NDArray[np.uint16]
    finest_m: NDArray[np.float32]

    @classmethod
    def over(cls, area: BaseGeometry, short_m: float) -> Self:
        """An empty grid over an area for photos that are this wide on their shorter side."""
        west, south, east, north = area.bounds
        width_m = 2.0 * area.area / max(area.length, 1e-9)
        finest_m = min(LEAST_M, width_m * WIDTH_PART)
        step_m = max(min(short_m * PHOTO_PART, width_m * WIDTH_PART), finest_m)
        step_m = max(step_m, math.sqrt((east - west) * (north - south) / MOST_CELLS))
        rows, columns = (max(1, math.ceil(size / step_m)) for size in (north - south, east - west))
        return cls(
            west,
            south,
            step_m,
            np.zeros((rows, columns), dtype=np.uint16),
            np.full((rows, columns), np.inf, dtype=np.float32),
        )

    @property
    def middles(self) -> Floats:
        """Of the cells, east and north, (rows, columns, 2)."""
        rows, columns = self.counts.shape
        east = self.west_m + (np.arange(columns) + 0.5) * self.step_m
        north = self.south_m + (np.arange(rows) + 0.5) * self.step_m
        return np.stack(np.meshgrid(east, north), axis=-1)

    def lay(self, shots: Shots, camera: PlanCamera, ground: Ground | None, level_m: float) -> None:
        """Add photos to it; over level ground at a height where there is no terrain."""
        none = np.zeros((0, 0))
        if ground is None:
            cells_m = np.full(self.counts.shape, level_m)
            terrain = (none, 0.0, 0.0, 1.0)
        else:
            cells_m = ground.at(self.middles)
            terrain = (ground.heights_m, ground.west_m, ground.south_m, ground.step_m)
        half = np.array(half_tangents(camera))
        pixel = camera.pixel_pitch_m / camera.focal_length_m
        rows = shots.rows
        for first in range(0, len(rows), CHUNK):
            lay_photos(
                self.counts, self.finest_m, self.west_m, self.south_m, self.step_m, cells_m,
                rows[first : first + CHUNK], half, pixel, math.tan(FLATTEST_RAD), *terrain,
            )  # fmt: skip

    def shape_of(self, held: NDArray[np.bool_]) -> Polygon | MultiPolygon:
        """The cells that hold, as polygons; each reaches half a cell about its middle."""
        rows, columns = held.shape
        east = self.west_m + np.arange(columns + 1) * self.step_m
        north = self.south_m + np.arange(rows + 1) * self.step_m
        boxes = []
        for r in np.flatnonzero(held.any(axis=1)).tolist():
            turns = np.flatnonzero(np.diff(np.concatenate([[0], held[r].astype(np.int8), [0]])))
            boxes.append(box(east[turns[::2]], north[r], east[turns[1::2]], north[r + 1]))
        found: BaseGeometry = union_all(np.concatenate(boxes)) if boxes else Polygon()
        assert isinstance(found, (Polygon, MultiPolygon))
        return found

    def seen(self, limit_m: float) -> NDArray[np.bool_]:
        """Which cells at least one photo sees at no more than a ground sampled distance."""
        found: NDArray[np.bool_] = (self.counts > 0) & (self.finest_m <= limit_m)
        return found
