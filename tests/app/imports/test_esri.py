"""Shapefiles, written by pyshp, as features of a scenario."""

from __future__ import annotations

import struct

import pytest
import shapely
from pyproj import Geod, Transformer
from shapely.geometry import Polygon, shape

from app.imports import ImportOptions, RegionFileError, import_regions
from tests.app.imports.samples import HOLE, RING, archive_of, shapefiles

WGS84 = Geod(ellps="WGS84")
FILES = shapefiles([[RING[::-1], HOLE[::-1]], [RING[::-1]]], ["north field", "south field"])


def rule_of(data: bytes, **options: str) -> str:
    with pytest.raises(RegionFileError) as caught:
        import_regions(data, ImportOptions(crs=options.get("crs")))
    return caught.value.findings[0].rule


def test_an_archive_gives_named_regions_with_holes() -> None:
    """Names come from the table; holes stay with their polygon."""
    found = import_regions(archive_of(FILES))
    first, second = found.collection["features"]
    assert (found.format, first["id"], second["id"]) == ("shapefile", "north field", "south field")
    assert shape(first["geometry"]).symmetric_difference(Polygon(RING, [HOLE])).area < 1e-12
    assert shapely.get_num_interior_rings(shape(second["geometry"])) == 0


def test_the_layer_is_a_folder_and_the_table_has_values() -> None:
    """A layer called buildings makes obstacles, of the height in the table."""
    found = import_regions(archive_of(FILES, "gis/buildings"))
    properties = found.collection["features"][0]["properties"]
    assert (properties["role"], properties["height_m"]) == ("obstacle", 12.5)


@pytest.mark.parametrize("crs", ["EPSG:32632", "EPSG:2056", "EPSG:3857"])
def test_projected_places_are_brought_to_wgs84(crs: str) -> None:
    """UTM, the Swiss grid and web Mercator come back within a metre, edges within a decimetre of pyproj's."""
    move = Transformer.from_crs("EPSG:4326", crs, always_xy=True)
    ring = [move.transform(lon, lat) for lon, lat in RING[::-1]]
    (feature,) = import_regions(archive_of(shapefiles([[ring]], ["x"], crs))).collection["features"]
    got = Polygon(shape(feature["geometry"])).exterior
    for lon, lat in RING:
        assert min(WGS84.inv(lon, lat, x, y)[2] for x, y in got.coords) < 1.0
    back = Transformer.from_crs(crs, "EPSG:4326", always_xy=True)
    (ax, ay), (bx, by) = ring[0], ring[1]
    for part in (0.123, 0.5, 0.877):
        lon, lat = back.transform(ax + part * (bx - ax), ay + part * (by - ay))
        nearest = got.interpolate(got.project(Polygon([(lon, lat)] * 3).centroid))
        assert WGS84.inv(lon, lat, nearest.x, nearest.y)[2] < 0.15


def test_without_a_prj_the_reference_system_must_be_given() -> None:
    """A missing .prj is refused; a code given goes before the file's own."""
    bare = {ending: content for ending, content in FILES.items() if ending != ".prj"}
    assert rule_of(archive_of(bare)) == "crs-missing"
    assert rule_of(FILES[".shp"]) == "crs-missing"
    assert len(import_regions(archive_of(bare), ImportOptions(crs="EPSG:4326")).collection["features"]) == 2
    assert len(import_regions(FILES[".shp"], ImportOptions(crs="epsg:4326")).collection["features"]) == 2


@pytest.mark.parametrize(
    "crs", ["EPSG:99999", "/etc/passwd", "+init=/etc/passwd:x", "EPSG:4978", "EPSG:5773"]
)
def test_strange_reference_systems_are_refused(crs: str) -> None:
    """Unknown codes, paths, and systems that are no map's."""
    assert rule_of(FILES[".shp"], crs=crs) == "crs"


def test_a_senseless_prj_is_refused() -> None:
    """What is no well-known text is no reference system."""
    assert rule_of(archive_of(FILES | {".prj": b"GEOGCS[oops"})) == "crs"


def test_records_that_do_not_fit_are_refused() -> None:
    """Cut files, lengths beyond the file and lengths below zero are named, and never followed."""
    shp = FILES[".shp"]
    for words in (2**30, -4, 0):
        broken = shp[:104] + struct.pack(">i", words) + shp[108:]
        assert rule_of(broken, crs="EPSG:4326") == "shapefile-damaged"
    assert rule_of(shp[:-6], crs="EPSG:4326") == "shapefile-damaged"
    assert rule_of(shp[:50], crs="EPSG:4326") == "not-shapefile"


def test_a_table_of_another_length_is_refused() -> None:
    """Names would go to the wrong shapes."""
    other = shapefiles([[RING[::-1]]], ["one"])
    assert rule_of(archive_of(FILES | {".dbf": other[".dbf"]})) == "shapefile-damaged"
