"""The ground's height: an elevation raster in degrees, and its piece on the scenario's local grid.

Files are read at the edges (``app.services.terrain``); what arrives here is a plain value. Everything that
needs a height asks one surface, the bilinear one between the posts of ``Ground``, so that the planner and
the judge cannot differ about it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray
from scipy.ndimage import map_coordinates, maximum_filter, minimum_filter
from shapely.geometry.base import BaseGeometry

from planner.airspace.terrain_kernels import grounds_at
from planner.frames import LocalFrame

Floats = NDArray[np.float64]
Bounds = tuple[float, float, float, float]

#: A local grid has at most this many posts (32 MB); a finer raster is thinned to that.
MAX_POSTS = 4_000_000
#: Posts are no closer together than this: finer relief changes no plan.
MIN_STEP_M = 1.0
#: Datum of rasters whose values are no heights.
NO_DATUM = "none"


@dataclass(frozen=True, slots=True, eq=False)
class Terrain:
    """An elevation raster.

    Parameters
    ----------
    name
        How scenarios name it.
    heights_m
        float32, shape (rows, columns), metres over mean sea level.
    affine
        (a, b, c, d, e, f): the centre of post (row i, column j) has longitude a·j + b·i + c and latitude
        d·j + e·i + f, in WGS 84 degrees.
    nodata
        What stands where there is no height, besides NaN; None for nothing.
    datum
        Of the heights, e.g. ``"EGM96"``; ``NO_DATUM`` where values are none.
    """

    name: str
    heights_m: NDArray[np.float32]
    affine: tuple[float, float, float, float, float, float]
    nodata: float | None = None
    datum: str = "EGM96"

    def __post_init__(self) -> None:
        if self.heights_m.ndim != 2 or min(self.heights_m.shape) < 2:
            raise ValueError(f"a raster has two rows and columns at least, not shape {self.heights_m.shape}")
        a, b, _, d, e, _ = self.affine
        if a * e - b * d == 0.0 or not all(map(math.isfinite, self.affine)):
            raise ValueError("the affine cannot be inverted")

    @property
    def bounds_deg(self) -> Bounds:
        """West, south, east, north of the posts' centres."""
        rows, columns = self.heights_m.shape
        a, b, c, d, e, f = self.affine
        corners = [(j, i) for i in (0, rows - 1) for j in (0, columns - 1)]
        lons = [a * j + b * i + c for j, i in corners]
        lats = [d * j + e * i + f for j, i in corners]
        return (min(lons), min(lats), max(lons), max(lats))

    @property
    def resolution_deg(self) -> tuple[float, float]:
        """Distance between columns and between rows, in degrees."""
        a, b, _, d, e, _ = self.affine
        return (math.hypot(a, d), math.hypot(b, e))

    @property
    def resolution_m(self) -> float:
        """The finer of the two distances between posts, in the middle of the raster."""
        west, south, east, north = self.bounds_deg
        frame = LocalFrame((west + east) / 2.0, (south + north) / 2.0)
        a, b, _, d, e, _ = self.affine
        steps = frame.to_local(
            [(frame.lon_deg + a, frame.lat_deg + d), (frame.lon_deg + b, frame.lat_deg + e)]
        )
        return float(np.hypot(steps[:, 0], steps[:, 1]).min())

    def known(self) -> NDArray[np.bool_]:
        """Where there is a height, shape (rows, columns)."""
        known = np.isfinite(self.heights_m)
        if self.nodata is not None and math.isfinite(self.nodata):
            known &= self.heights_m != np.float32(self.nodata)
        return known

    def heights_at(self, lonlat_deg: ArrayLike) -> Floats:
        """Heights at WGS 84 positions (..., 2), bilinear; NaN outside and beside a missing post."""
        return self._interpolated(np.asarray(lonlat_deg, dtype=np.float64), self._clear())

    def _clear(self) -> NDArray[np.float32]:
        """The heights with NaN wherever there is none."""
        return np.where(self.known(), self.heights_m, np.float32(np.nan)).astype(np.float32)

    def _interpolated(self, places: Floats, heights: NDArray[np.float32]) -> Floats:
        a, b, c, d, e, f = self.affine
        determinant = a * e - b * d
        west, _, east, _ = self.bounds_deg
        turns = np.round(((west + east) / 2.0 - places[..., 0]) / 360.0)
        lon, lat = places[..., 0] + 360.0 * turns - c, places[..., 1] - f
        column, row = (e * lon - b * lat) / determinant, (a * lat - d * lon) / determinant
        # A place on the last post must not fall off it by rounding.
        rows, columns = heights.shape
        row = np.where(np.abs(row - np.clip(row, 0, rows - 1)) < 1e-9, np.clip(row, 0, rows - 1), row)
        column = np.where(
            np.abs(column - np.clip(column, 0, columns - 1)) < 1e-9, np.clip(column, 0, columns - 1), column
        )
        found: Floats = map_coordinates(
            heights, [row.ravel(), column.ravel()], order=1, mode="constant", cval=np.nan, output=np.float64
        )
        return found.reshape(row.shape)


@dataclass(frozen=True, slots=True, eq=False)
class Ground:
    """A piece of terrain on the local grid.

    Parameters
    ----------
    name, datum
        Of the terrain.
    heights_m
        float64, shape (rows, columns), northward, then eastward; NaN where nothing is known.
    west_m, south_m, step_m
        Place of ``heights_m[0, 0]`` and the distance between posts.
    """

    name: str
    datum: str
    heights_m: Floats
    west_m: float
    south_m: float
    step_m: float

    def at(self, places_m: ArrayLike) -> Floats:
        """Heights at local places (..., 2); NaN off the grid and beside a missing post."""
        places = np.ascontiguousarray(places_m, dtype=np.float64)
        flat = np.ascontiguousarray(places.reshape(-1, 2))
        found: Floats = grounds_at(self.heights_m, self.west_m, self.south_m, self.step_m, flat)
        return found.reshape(places.shape[:-1])

    def range_over(self, area: BaseGeometry) -> tuple[float, float]:
        """Lowest and highest ground of an area: NaN where some of it is unknown.

        Bounds, not samples: of a bilinear surface no place is beyond the posts round it.
        """
        heights_m = self.posts_of(area)[:, 2]
        if len(heights_m) == 0 or not self.covers(area):
            return (math.nan, math.nan)
        return (float(heights_m.min()), float(heights_m.max()))

    def posts_of(self, area: BaseGeometry) -> Floats:
        """The posts round an area, (N, 3): place and height, NaN where that is not known."""
        reach = area.buffer(self.step_m * math.sqrt(2.0))
        rows, columns = self.heights_m.shape
        west, south, east, north = reach.bounds
        j = np.arange(
            max(0, math.floor((west - self.west_m) / self.step_m)),
            min(columns, math.ceil((east - self.west_m) / self.step_m) + 1),
        )
        i = np.arange(
            max(0, math.floor((south - self.south_m) / self.step_m)),
            min(rows, math.ceil((north - self.south_m) / self.step_m) + 1),
        )
        if len(i) == 0 or len(j) == 0:
            return np.empty((0, 3))
        east_m, north_m = np.meshgrid(self.west_m + self.step_m * j, self.south_m + self.step_m * i)
        shapely.prepare(reach)
        inside = shapely.contains_xy(reach, east_m, north_m)
        return np.column_stack([east_m[inside], north_m[inside], self.heights_m[np.ix_(i, j)][inside]])

    def within(self, area: BaseGeometry) -> Ground:
        """The same with the posts round an area alone; of others nothing is known."""
        rows, columns = self.heights_m.shape
        east_m, north_m = np.meshgrid(
            self.west_m + self.step_m * np.arange(columns), self.south_m + self.step_m * np.arange(rows)
        )
        reach = area.buffer(self.step_m * math.sqrt(2.0))
        shapely.prepare(reach)
        inside = shapely.contains_xy(reach, east_m, north_m)
        return replace(self, heights_m=np.where(inside, self.heights_m, np.nan))

    def relief_beside_m(self, area: BaseGeometry, reach_m: float) -> float:
        """How much higher or lower than at a place of an area the ground is within a reach of it.

        Within a square that holds the reach: at most that much more than there is. Unknown ground is none.
        """
        rows, columns = self.heights_m.shape
        beside = math.ceil(reach_m / self.step_m) + 1
        west, south, east, north = area.bounds
        first = max(0, math.floor((west - self.west_m) / self.step_m) - beside)
        last = min(columns, math.ceil((east - self.west_m) / self.step_m) + beside + 1)
        low = max(0, math.floor((south - self.south_m) / self.step_m) - beside)
        high = min(rows, math.ceil((north - self.south_m) / self.step_m) + beside + 1)
        piece = self.heights_m[low:high, first:last]
        known = np.isfinite(piece)
        size = 2 * beside + 1
        most = maximum_filter(np.where(known, piece, -np.inf), size) - piece
        least = piece - minimum_filter(np.where(known, piece, np.inf), size)
        east_m, north_m = np.meshgrid(
            self.west_m + self.step_m * np.arange(first, last),
            self.south_m + self.step_m * np.arange(low, high),
        )
        over = area.buffer(self.step_m * math.sqrt(2.0))
        shapely.prepare(over)
        inside = known & shapely.contains_xy(over, east_m, north_m)
        return float(max(most[inside].max(initial=0.0), least[inside].max(initial=0.0)))

    def covers(self, area: BaseGeometry) -> bool:
        """Whether an area lies wholly on the grid."""
        rows, columns = self.heights_m.shape
        west, south, east, north = area.bounds
        return (
            west >= self.west_m
            and south >= self.south_m
            and east <= self.west_m + (columns - 1) * self.step_m
            and north <= self.south_m + (rows - 1) * self.step_m
        )

    def above(self, height_m: float, within: BaseGeometry) -> tuple[shapely.Polygon, ...]:
        """Where ground may be higher than a height, or is unknown: whole cells, and one more all round."""
        high = ~(self.heights_m <= height_m)
        cells = high[:-1, :-1] | high[1:, :-1] | high[:-1, 1:] | high[1:, 1:]
        west, south, east, north = within.bounds
        boxes: list[shapely.Polygon] = []
        for i, row in enumerate(cells):
            y_m = self.south_m + i * self.step_m
            if not row.any() or y_m + self.step_m < south or y_m > north:
                continue
            edges = np.flatnonzero(np.diff(np.concatenate([[False], row, [False]]).astype(np.int8)))
            first_m = self.west_m + self.step_m * edges[::2]
            last_m = self.west_m + self.step_m * edges[1::2]
            near = (last_m > west) & (first_m < east)
            boxes.extend(
                shapely.box(left_m, y_m, right_m, y_m + self.step_m)
                for left_m, right_m in zip(first_m[near].tolist(), last_m[near].tolist(), strict=True)
            )
        merged = shapely.union_all(boxes).buffer(self.step_m, join_style="mitre").simplify(self.step_m / 2.0)
        found = merged.intersection(within.buffer(self.step_m))
        return tuple(p for p in shapely.get_parts(found) if isinstance(p, shapely.Polygon) and p.area > 0.0)


#: Rasters by the name scenarios use, or a function that finds one; None for an unknown name.
Terrains = Mapping[str, Terrain] | Callable[[str], Terrain | None]


def find_terrain(terrains: Terrains | None, name: str) -> Terrain | None:
    """The raster of a name."""
    if terrains is None:
        return None
    return terrains(name) if callable(terrains) else terrains.get(name)


def local_ground(terrain: Terrain, frame: LocalFrame, bounds_m: Bounds) -> Ground:
    """The piece of a raster inside bounds (west, south, east, north in local metres).

    Posts stand as close as the raster's own, unless that gives more than ``MAX_POSTS``.
    """
    west_m, south_m, east_m, north_m = bounds_m
    width_m, depth_m = east_m - west_m, north_m - south_m
    step_m = max(terrain.resolution_m, MIN_STEP_M, math.sqrt(width_m * depth_m / MAX_POSTS))
    columns = max(2, math.ceil(width_m / step_m) + 1)
    rows = max(2, math.ceil(depth_m / step_m) + 1)
    heights = np.empty((rows, columns))
    clear = terrain._clear()
    east = west_m + step_m * np.arange(columns)
    # Band by band: the whole grid's positions would take several times the grid's memory.
    band = max(1, 250_000 // columns)
    for first in range(0, rows, band):
        north = south_m + step_m * np.arange(first, min(first + band, rows))
        places = np.stack(np.meshgrid(east, north), axis=-1)
        heights[first : first + band] = terrain._interpolated(frame.to_wgs84(places), clear)
    return Ground(terrain.name, terrain.datum, heights, west_m, south_m, step_m)
