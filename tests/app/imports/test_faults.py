"""Region files that once were read wrongly."""

from __future__ import annotations

from pathlib import Path

import pytest
from shapely.geometry import Polygon, shape

from app.imports import import_regions

FAULTS = Path(__file__).parents[2] / "faults"
SQUARE = Polygon([(8.5, 47.0), (8.51, 47.0), (8.51, 47.01), (8.5, 47.01)])


@pytest.mark.parametrize(
    ("name", "shapes"),
    [
        ("02-nofly-closed-line.kml", [("mast", "no_fly")]),
        (
            "02-nofly-role-value.geojson",
            [(x, "no_fly") for x in ("a", "b", "NFZ north", "No fly zone airport", "Restricted area R-5")],
        ),
        ("14-geojson-crs-utm.geojson", [("f", "roi")]),
        ("15-dbf-cp1252-ldid.zip", [("Grünfläche Süd", "roi")]),
        ("16-gbk.kml", [("农田", "roi")]),
        ("17-link-to-inner-document.kmz", [("inside", "roi")]),
    ],
)
def test_squares_are_read(name: str, shapes: list[tuple[str, str]]) -> None:
    """Each is the square that it was drawn as, by its name, in the role that its words give it."""
    found = import_regions((FAULTS / name).read_bytes())
    assert [(account.name, account.role) for account in found.shapes] == shapes
    for feature in found.collection["features"]:
        assert shape(feature["geometry"]).symmetric_difference(SQUARE).area < 1e-3 * SQUARE.area


def test_reversed_rings_are_outer_rings_and_holes() -> None:
    """Rings of a shapefile that all run the wrong way are as many polygons and holes as they were."""
    (feature,) = import_regions((FAULTS / "12-all-rings-reversed.zip").read_bytes()).collection["features"]
    drawn = shape(feature["geometry"])
    assert drawn.is_valid
    parts = getattr(drawn, "geoms", [drawn])
    assert sum(len(part.interiors) for part in parts) == 1
