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
    """A missing attribute is a fault of its track, and of the file where that is all there is."""
    data = GPX.replace(b'lat="47.31" lon="8.50"', b'lon="8.50"')
    found = import_regions(data, ImportOptions(width_m=10.0))
    assert [(fault.feature, fault.rule) for fault in found.left_out] == [("river", "gpx-point")]
    with pytest.raises(RegionFileError, match="lat None") as caught:
        import_regions(b'<gpx><wpt lon="8"><name>x</name></wpt></gpx>')
    assert caught.value.findings[0].rule == "gpx-point"
