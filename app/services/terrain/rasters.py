"""Elevation files: GeoTIFF, DTED and SRTM HGT, read into plain rasters and kept as such.

Heights become metres over mean sea level. EGM96 and EGM2008 differ by a metre or so and count as that;
heights over the ellipsoid are converted with the geoid grid where pyproj has it. Without the grid pyproj
answers with the heights unchanged, a hundred metres wrong in places: such a file is refused instead.
"""

from __future__ import annotations

import io
import math
import re
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any, Literal, NoReturn, cast

import numpy as np
from numpy.typing import NDArray

from app.services.errors import RefusedError
from planner.airspace.terrain import NO_DATUM, Terrain
from planner.errors import Finding
from planner.geojson.sheet import MOST_LONGITUDE_DEG

Affine = tuple[float, float, float, float, float, float]
VerticalDatum = Literal["EGM96", "EGM2008", "ellipsoid", "none"]

DRIVERS = ("GTiff", "DTED", "SRTMHGT")
#: Rows times columns; an SRTM tile of one second has 13 million.
MAX_POSTS = 40_000_000
LOWEST_M, HIGHEST_M = -12_000.0, 10_000.0
UNSTATED = "an unstated datum"
_HGT_NAME = re.compile(r"[NSns]\d{2}[EWew]\d{3}\.hgt", re.IGNORECASE)
_SAFE_NAME = re.compile(r"[^A-Za-z0-9._-]")
_IN_MEMORY = re.compile(r"/vsimem/[\w./-]*\w")
_HGT_SIZES = {2 * posts * posts for posts in (1201, 3601)}


def _refuse(rule: str, message: str, fix: str) -> NoReturn:
    raise RefusedError(f"the raster is refused: {message}", (Finding("terrain", rule, message, fix),))


def read_raster(content: bytes, filename: str, name: str, datum: VerticalDatum | None = None) -> Terrain:
    """Read an elevation file.

    Parameters
    ----------
    content
        The file.
    filename
        As the sender has it: SRTM HGT files tell their place by their name alone.
    name
        Of the terrain.
    datum
        Of the heights, for files that do not say; overrides what they say. ``"none"`` for values that are no
        heights, importance for one: any finite number in any unit.

    Raises
    ------
    RefusedError
        Rules ``raster-format``, ``no-georeference``, ``raster-too-large``, ``no-heights``,
        ``implausible-heights``, ``height-unit``, ``geoid-grid-missing``, ``not-finite``.
    """
    import rasterio
    from pyproj.exceptions import ProjError
    from rasterio._err import CPLE_BaseError
    from rasterio.io import MemoryFile

    if len(content) in _HGT_SIZES and not _HGT_NAME.fullmatch(filename):
        _refuse(
            "no-georeference",
            f"{filename or 'the file'} looks like SRTM HGT, which tells its place by its name alone",
            "Keep the name it came with, e.g. ?filename=N36W085.hgt.",
        )
    safe = _SAFE_NAME.sub("_", Path(filename).name) or "terrain.tif"
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rasterio.errors.NotGeoreferencedWarning)
        try:
            with MemoryFile(content, filename=safe) as memory, _opened(memory.name) as dataset:
                heights, affine, stated = _posts(dataset, metres=datum != NO_DATUM)
        except (rasterio.errors.RasterioError, CPLE_BaseError, ProjError, ValueError) as error:
            # Broken files end in any of these: GDAL's refusals, reference systems that are none, bad text.
            _refuse(
                "raster-format",
                f"{safe} cannot be read as GeoTIFF, DTED or SRTM HGT ({_in_words(error, safe)})",
                "Send an elevation file in one of these formats, whole.",
            )
    _check_place(heights, affine)
    if datum == NO_DATUM and np.isinf(heights).any():
        _refuse("not-finite", "it has values of infinity", "Correct them, or declare them as nodata.")
    heights = np.where(np.isfinite(heights), heights, np.float32(np.nan)).astype(np.float32)
    known = np.isfinite(heights)
    if not known.any():
        what = "value" if datum == NO_DATUM else "height"
        _refuse("no-heights", f"every post is without {what}", f"Send a raster with {what}s.")
    low_m, high_m = float(np.nanmin(heights)), float(np.nanmax(heights))
    if datum == NO_DATUM:
        return Terrain(name, heights, affine, None, datum)
    if low_m < LOWEST_M or high_m > HIGHEST_M:
        _refuse(
            "implausible-heights",
            f"heights run from {low_m:g} to {high_m:g} m",
            "Send heights in metres, with the value of missing posts declared as nodata; values that are no "
            "heights with vertical_datum=none.",
        )
    chosen = datum or stated
    if chosen == "ellipsoid":
        heights, chosen = _over_sea(heights, affine), "EGM96"
    return Terrain(name, heights, affine, None, chosen)


def _in_words(error: Exception, filename: str) -> str:
    """What GDAL says, with the sender's name for the file in the place of the one it has in memory."""
    return _IN_MEMORY.sub(filename, str(error.__cause__ or error))[:200]


def _check_place(heights: NDArray[np.float32], affine: Affine) -> None:
    """Refuse a raster that does not lie on Earth, or whose posts lie on each other."""
    a, b, c, d, e, f = affine
    rows, columns = heights.shape
    reach = [(a * j + b * i + c, d * j + e * i + f) for i in (0, rows - 1) for j in (0, columns - 1)]
    on_earth = all(abs(lon) <= MOST_LONGITUDE_DEG and abs(lat) <= 90.0 for lon, lat in reach)
    if not on_earth or abs(a * e - b * d) < 1e-16:
        _refuse(
            "no-georeference",
            f"its corners are at {', '.join(f'{lon:g} {lat:g}' for lon, lat in reach)}",
            "Send a file that lies within longitudes −180 to 180 (across the antimeridian: to 360) "
            "and latitudes −90 to 90.",
        )


def _opened(path: str) -> Any:
    """The dataset, by one of the drivers for elevation; never by one that could open another file."""
    import rasterio

    for driver in DRIVERS:
        try:
            return rasterio.open(path, driver=driver)
        except rasterio.errors.RasterioIOError as error:
            failure = error
    raise failure


def _posts(dataset: Any, *, metres: bool = True) -> tuple[NDArray[np.float32], Affine, str]:
    """Heights, affine of the posts' centres in WGS 84 degrees, and the datum of the heights.

    Parameters
    ----------
    metres
        Whether values in another unit are refused.
    """
    if dataset.crs is None or dataset.transform.is_identity:
        _refuse(
            "no-georeference",
            "it does not say where on Earth it lies",
            "Send a georeferenced file, e.g. one written by gdal_translate -a_srs -a_ullr.",
        )
    if dataset.width * dataset.height > MAX_POSTS:
        _refuse(
            "raster-too-large",
            f"it has {dataset.width} × {dataset.height} posts, more than {MAX_POSTS // 10**6} million",
            "Cut it to the area of operations, or thin it out.",
        )
    if min(dataset.width, dataset.height) < 2:
        _refuse(
            "raster-format",
            "it has less than two rows or columns",
            "Send a raster of several rows and columns.",
        )
    if dataset.count != 1 or np.dtype(dataset.dtypes[0]).kind not in "iuf":
        _refuse(
            "raster-format",
            f"it has {dataset.count} bands of {dataset.dtypes[0]}: an elevation raster has one, of numbers",
            "Send elevation, not an image.",
        )
    unit = (dataset.units[0] or "").lower()
    if metres and unit not in ("", "m", "metre", "meter", "metres", "meters"):
        _refuse("height-unit", f"its heights are in {unit}", "Send heights in metres.")
    heights = dataset.read(1, masked=True).astype(np.float32).filled(np.nan)
    transform = dataset.transform
    if not _is_wgs84(dataset.crs):
        heights, transform = _warped(heights, dataset)
    centre = (transform.a + transform.b) / 2.0, (transform.d + transform.e) / 2.0
    affine: Affine = (
        transform.a, transform.b, transform.c + centre[0],
        transform.d, transform.e, transform.f + centre[1],
    )  # fmt: skip
    return heights, affine, _stated_datum(dataset)


def _is_wgs84(crs: Any) -> bool:
    from pyproj import CRS

    flat = CRS.from_wkt(crs.to_wkt()).to_2d()
    datum = flat.datum.name if flat.datum is not None else ""
    return bool(flat.is_geographic and ("World Geodetic System 1984" in datum or datum == "WGS 84"))


def _warped(heights: NDArray[np.float32], dataset: Any) -> tuple[NDArray[np.float32], Any]:
    from rasterio.warp import Resampling, calculate_default_transform, reproject

    transform, width, height = calculate_default_transform(
        dataset.crs, "EPSG:4326", dataset.width, dataset.height, *dataset.bounds
    )
    if width * height > 2 * MAX_POSTS:
        _refuse("raster-too-large", f"in degrees it has {width} × {height} posts", "Thin it out.")
    target = np.full((height, width), np.nan, dtype=np.float32)
    reproject(
        heights,
        target,
        src_transform=dataset.transform,
        src_crs=dataset.crs,
        src_nodata=np.nan,
        dst_transform=transform,
        dst_crs="EPSG:4326",
        dst_nodata=np.nan,
        resampling=Resampling.bilinear,
    )
    return target, transform


def _stated_datum(dataset: Any) -> str:
    from pyproj import CRS

    if dataset.driver in ("DTED", "SRTMHGT"):
        return "EGM96"
    crs = CRS.from_wkt(dataset.crs.to_wkt())
    if crs.is_compound:
        vertical = crs.sub_crs_list[1].name
        for known in ("EGM2008", "EGM96"):
            if known in vertical.replace(" ", ""):
                return known
        return str(vertical)
    return "ellipsoid" if len(crs.axis_info) == 3 else UNSTATED


def _over_sea(heights: NDArray[np.float32], affine: Affine) -> NDArray[np.float32]:
    """Heights over the WGS 84 ellipsoid to heights over the EGM96 geoid."""
    lift = geoid_transform()
    if lift is None:
        _refuse(
            "geoid-grid-missing",
            "its heights are over the ellipsoid, and the geoid grid to convert them is not installed",
            "Send heights over mean sea level (EGM96 or EGM2008), or install the grid us_nga_egm96_15.tif.",
        )
    a, b, c, d, e, f = affine
    rows, columns = heights.shape
    column = np.arange(columns, dtype=np.float64)
    found = np.empty_like(heights)
    for i in range(rows):
        found[i] = lift(a * column + b * i + c, d * column + e * i + f, heights[i].astype(np.float64))
    return found


Lift = Callable[[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]], NDArray[np.float64]]


def geoid_transform() -> Lift | None:
    """From ellipsoidal to EGM96 heights; None where pyproj lacks the grid and would change nothing."""
    from pyproj.transformer import TransformerGroup

    with warnings.catch_warnings():
        # It warns of the missing grid, which the test below finds by itself.
        warnings.simplefilter("ignore", UserWarning)
        group = TransformerGroup("EPSG:4979", "EPSG:9707", always_xy=True)
    if not group.best_available or not group.transformers:
        return None
    best = group.transformers[0]
    # The geoid lies 17 m over the ellipsoid at 0° N 0° E.
    if abs(float(best.transform(0.0, 0.0, 100.0)[2]) - 100.0) < 1.0:
        return None
    return lambda lon, lat, height: np.asarray(best.transform(lon, lat, height)[2])


def pack(terrain: Terrain) -> bytes:
    """A raster as the bytes of a NumPy archive."""
    buffer = io.BytesIO()
    np.savez_compressed(
        buffer,
        heights_m=terrain.heights_m,
        affine=np.array(terrain.affine),
        datum=np.array(terrain.datum),
    )
    return buffer.getvalue()


def unpack(path: Path, name: str) -> Terrain:
    """A raster from a file written by ``pack``."""
    with np.load(path, allow_pickle=False) as parts:
        affine = cast(Affine, tuple(map(float, parts["affine"])))
        return Terrain(name, parts["heights_m"], affine, None, str(parts["datum"]))


def stored_terrain(folder: str | Path, name: str) -> Terrain | None:
    """An uploaded raster by its id; None where there is none of this id."""
    # The id comes from a scenario: nothing but an id may become part of a path.
    if not re.fullmatch(r"[0-9a-f-]{36}", name):
        return None
    path = Path(folder) / f"{name}.npz"
    return unpack(path, name) if path.is_file() else None


def known_fraction(terrain: Terrain) -> float:
    """The part of the posts that have a height."""
    return math.floor(float(terrain.known().mean()) * 1e6) / 1e6
