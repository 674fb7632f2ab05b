"""Real buildings as a map of the urban benchmark: blocks of Prague-Bubeneč, as packaged by momepy.

They are read from momepy's own sample data and not shipped with the house; ``pip install --no-deps momepy``
brings them. Their heights are not in it: they are drawn, by seed, as of houses of three to eight storeys.
"""

from __future__ import annotations

import importlib.util
import sqlite3
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import shapely
from pyproj import Transformer
from shapely.geometry import Polygon, box

from benchmarks.urban_maps import UrbanMap, problem
from planner.coverage.urban.area import Building
from planner.frames import LocalFrame

NAME = "real-bubenec"
#: Three to eight storeys of 3 m.
STOREYS, STOREY_M = (3, 8), 3.0
SEED, ROUND_M = 61, 30.0
#: Smaller outlines are sheds.
LEAST_M2 = 20.0
#: Bytes of an envelope in a GeoPackage's geometry, by what its flags say (OGC 12-128, 2.1.3).
ENVELOPES = {0: 0, 1: 32, 2: 48, 3: 48, 4: 64}


def packaged() -> Path:
    """Where momepy keeps its sample.

    Raises
    ------
    ValueError
        Where it is not installed.
    """
    spec = importlib.util.find_spec("momepy")
    if spec is None or not spec.submodule_search_locations:
        raise ValueError(f"{NAME} is read from momepy's sample data: pip install --no-deps momepy")
    return Path(spec.submodule_search_locations[0]) / "datasets" / "bubenec.gpkg"


def outlines(path: Path, layer: str = "buildings") -> Iterator[Polygon]:
    """Polygons of a layer of a GeoPackage, in local metres about their middle."""
    with sqlite3.connect(f"file:{path}?mode=ro", uri=True) as base:
        (srs,) = base.execute("select srs_id from gpkg_contents where table_name = ?", (layer,)).fetchone()
        column, table = base.execute(
            "select column_name, table_name from gpkg_geometry_columns where table_name = ?", (layer,)
        ).fetchone()
        blobs = [row[0] for row in base.execute(f'select "{column}" from "{table}"')]
    base.close()
    found = [shapely.from_wkb(blob[8 + ENVELOPES[blob[3] >> 1 & 7] :]) for blob in blobs]
    degrees = Transformer.from_crs(srs, 4326, always_xy=True)
    west, south, east, north = shapely.total_bounds(found)
    frame = LocalFrame(*degrees.transform((west + east) / 2.0, (south + north) / 2.0))

    def local(points: np.ndarray) -> np.ndarray:
        return np.asarray(frame.to_local(np.column_stack(degrees.transform(points[:, 0], points[:, 1]))))

    for shape in found:
        for part in shapely.get_parts(shapely.transform(shape, local)):
            if isinstance(part, Polygon):
                yield part


def real(path: Path | None = None) -> UrbanMap:
    """The map: all of its houses and a strip round them."""
    rng = np.random.default_rng(SEED)
    houses = [part for part in outlines(packaged() if path is None else path) if part.area >= LEAST_M2]
    buildings = tuple(
        Building(each, STOREY_M * int(rng.integers(STOREYS[0], STOREYS[1] + 1))) for each in houses
    )
    west, south, east, north = shapely.total_bounds(houses)
    area = box(west - ROUND_M, south - ROUND_M, east + ROUND_M, north + ROUND_M)
    return UrbanMap(NAME, "rectangle", "houses", problem(area, buildings))
