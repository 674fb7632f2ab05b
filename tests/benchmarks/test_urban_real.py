"""Real houses for the urban benchmark: read from a GeoPackage as it is specified, in metres."""

from __future__ import annotations

import importlib.util
import sqlite3
import struct
from pathlib import Path

import pytest
from pyproj import Geod, Transformer
from shapely import to_wkb
from shapely.geometry import MultiPolygon, Polygon

from benchmarks.urban_real import outlines, packaged, real

MERCATOR = Transformer.from_crs(4326, 3857, always_xy=True)
#: Three houses in degrees, two of them one multipolygon.
HOUSES = [
    [(14.4 + x, 50.1 + y), (14.4004 + x, 50.1 + y), (14.4004 + x, 50.1003 + y), (14.4 + x, 50.1003 + y)]
    for x, y in ((0.0, 0.0), (0.001, 0.0), (0.0, 0.001))
]


def package(path: Path) -> Path:
    """A GeoPackage of these, with and without an envelope before the geometry (OGC 12-128, 2.1.3)."""
    first, *others = [Polygon([MERCATOR.transform(*corner) for corner in house]) for house in HOUSES]
    with sqlite3.connect(path) as base:
        base.execute("create table gpkg_contents (table_name text, srs_id integer)")
        base.execute("create table gpkg_geometry_columns (table_name text, column_name text)")
        base.execute("create table buildings (fid integer primary key, geom blob)")
        base.execute("insert into gpkg_contents values ('buildings', 3857)")
        base.execute("insert into gpkg_geometry_columns values ('buildings', 'geom')")
        bare = struct.pack("<2sBBi", b"GP", 0, 0b001, 3857)
        boxed = struct.pack("<2sBBi4d", b"GP", 0, 0b011, 3857, *(first.bounds[k] for k in (0, 2, 1, 3)))
        for head, shape in ((boxed, first), (bare, MultiPolygon(others))):
            base.execute("insert into buildings (geom) values (?)", (head + to_wkb(shape),))
    base.close()
    return path


def test_houses_are_as_large_as_on_the_ellipsoid(tmp_path: Path) -> None:
    """By geodesics, not by the metres of a web map, half as long again here."""
    found = list(outlines(package(tmp_path / "t.gpkg")))
    assert len(found) == 3
    for house, outline in zip(HOUSES, found, strict=True):
        area_m2, _ = Geod(ellps="WGS84").polygon_area_perimeter(*zip(*house, strict=True))
        assert outline.area == pytest.approx(abs(area_m2), rel=1e-4)


def test_the_map_of_them_is_the_same_each_time(tmp_path: Path) -> None:
    """All houses, three to eight storeys high, with the start on free ground."""
    path = package(tmp_path / "t.gpkg")
    first, again = real(path), real(path)
    assert first.urban == again.urban
    assert len(first.urban.buildings) == 3
    assert {each.height_m for each in first.urban.buildings} <= {9.0, 12.0, 15.0, 18.0, 21.0, 24.0}


def test_without_the_sample_it_is_told_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing is downloaded by itself."""
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    with pytest.raises(ValueError, match="pip install --no-deps momepy"):
        packaged()
