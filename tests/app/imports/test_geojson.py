"""GeoJSON of other writers: reference systems said in it, and encodings of its text."""

from __future__ import annotations

import json
from typing import Any

import pytest
from pyproj import CRS, Transformer
from shapely.geometry import Polygon, shape

from app.imports import ImportOptions, import_regions


@pytest.mark.parametrize(
    "name",
    [
        "urn:ogc:def:crs:EPSG::32632",
        "EPSG:32632",
        "http://www.opengis.net/def/crs/EPSG/0/32632",
        "WGS 84 / UTM zone 32N",
        CRS.from_epsg(32632).to_wkt(),
        "link",
    ],
)
def test_reference_systems_of_geojson_are_followed(name: str) -> None:
    """The member crs of a collection, a feature or a geometry moves it, --crs goes before it."""
    ring = [(461987.0, 5205285.0), (462747.0, 5205280.0), (462754.0, 5206391.0), (461987.0, 5205285.0)]
    back = Transformer.from_crs("EPSG:32632", "EPSG:4326", always_xy=True)
    wanted = Polygon([back.transform(*place) for place in ring])
    crs = {"type": "name", "properties": {"name": name}}
    if name == "link":
        crs = {"type": "link", "properties": {"href": "https://spatialreference.org/ref/epsg/32632/proj4/"}}
    geometry: dict[str, Any] = {"type": "Polygon", "coordinates": [ring]}
    feature: dict[str, Any] = {"type": "Feature", "properties": {}, "geometry": geometry}
    collection: dict[str, Any] = {"type": "FeatureCollection", "features": [feature]}
    documents = [
        collection | {"crs": crs},
        collection | {"features": [feature | {"crs": crs}]},
        collection | {"features": [feature | {"geometry": geometry | {"crs": crs}}]},
    ]
    for document in documents:
        (made,) = import_regions(json.dumps(document).encode()).collection["features"]
        assert shape(made["geometry"]).symmetric_difference(wanted).area < 1e-4 * wanted.area
    wrong = collection | {"crs": {"type": "name", "properties": {"name": "EPSG:4326"}}}
    (made,) = import_regions(json.dumps(wrong).encode(), ImportOptions(crs="EPSG:32632")).collection[
        "features"
    ]
    assert shape(made["geometry"]).symmetric_difference(wanted).area < 1e-4 * wanted.area


@pytest.mark.parametrize("codec", ["utf-16", "utf-8-sig"])
def test_geojson_of_windows_is_read(codec: str) -> None:
    """As PowerShell and editors write it: with a mark ahead, in UTF-16 or UTF-8."""
    drawn = {"type": "Polygon", "coordinates": [[[8, 47], [8, 48], [9, 48], [8, 47]]]}
    text = json.dumps(
        {"type": "Feature", "properties": {"name": "запрет"}, "geometry": drawn}, ensure_ascii=False
    )
    (feature,) = import_regions(text.encode(codec)).collection["features"]
    assert (feature["id"], feature["properties"]["role"]) == ("запрет", "no_fly")
