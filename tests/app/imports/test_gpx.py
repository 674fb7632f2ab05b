"""GPX as corridors and threats."""

from __future__ import annotations

import pytest

from app.imports import ImportOptions, RegionFileError, import_regions, read_choices
from tests.app.imports.samples import GPX

LINES = read_choices(("river=roi", "power line=roi"))


def test_tracks_and_routes_are_corridors() -> None:
    """Lines get the width, points the radius; places that add nothing to the line are left out."""
    found = import_regions(GPX, ImportOptions("threat", 100.0, 50.0, roles=LINES))
    assert found.format == "gpx"
    river, power, mast = found.collection["features"]
    assert (river["id"], river["properties"]["role"], river["properties"]["width_m"]) == (
        "river",
        "roi",
        100.0,
    )
    assert river["geometry"]["coordinates"] == [[8.5, 47.3], [8.500000001, 47.32], [8.52, 47.32]]
    assert power["geometry"]["coordinates"] == [[8.5, 47.3], [8.52, 47.31]]
    assert (mast["properties"]["role"], mast["properties"]["radius_m"]) == ("threat", 50.0)


def test_a_point_without_a_place_is_named() -> None:
    """A missing attribute is a fault of the file."""
    with pytest.raises(RegionFileError, match="lat None") as caught:
        import_regions(GPX.replace(b'lat="47.31" lon="8.50"', b'lon="8.50"'))
    assert caught.value.findings[0].rule == "gpx-point"
