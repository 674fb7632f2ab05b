"""Heights of zones that states publish: used where they count from the sea, else forbidden all the way."""

from __future__ import annotations

import json
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.imports import import_regions

SQUARE = {"type": "Polygon", "coordinates": [[[8.5, 47.3], [8.6, 47.3], [8.6, 47.4], [8.5, 47.3]]]}


def older(**limits: Any) -> bytes:
    """A zone of ED-269."""
    zone = {"identifier": "A1", "name": "Prison", "restriction": "PROHIBITED"}
    volume = {"horizontalProjection": SQUARE, **limits}
    return json.dumps({"title": "Zones", "features": [zone | {"geometry": [volume]}]}).encode()


def newer(**layer: Any) -> bytes:
    """The same in ED-318."""
    properties = {"name": [{"text": "Prison"}], "type": "PROHIBITED"}
    feature = {"type": "Feature", "properties": properties, "geometry": SQUARE | {"layer": layer}}
    return json.dumps({"type": "FeatureCollection", "features": [feature]}).encode()


def band(data: bytes) -> tuple[float | None, float | None, bool]:
    """Floor, ceiling, and whether it is told that heights were left out."""
    found = import_regions(data)
    (feature,) = found.collection["features"]
    assert feature["properties"]["role"] == "no_fly"
    told = any("count from the ground" in note for note in found.notes)
    return feature["properties"].get("floor_m"), feature["properties"].get("ceiling_m"), told


def in_both(lower: Any, low_from: Any, upper: Any, high_from: Any, unit: Any) -> set[tuple[Any, ...]]:
    """What the same limits come to in both forms."""
    first = older(
        lowerLimit=lower,
        lowerVerticalReference=low_from,
        upperLimit=upper,
        upperVerticalReference=high_from,
        uomDimensions=unit,
    )
    second = newer(lower=lower, lowerReference=low_from, upper=upper, upperReference=high_from, uom=unit)
    return {band(first), band(second)}


def test_heights_over_the_sea_are_used() -> None:
    """In metres and in feet; a floor of 0 over the ground is none."""
    assert in_both(300, "AMSL", 900, "AMSL", "M") == {(300.0, 900.0, False)}
    assert in_both(1000, "AMSL", 3000, "AMSL", "FT") == {(1000 * 0.3048, 3000 * 0.3048, False)}
    assert in_both(0, "AGL", 900, "AMSL", "m") == {(None, 900.0, False)}


@given(
    st.one_of(
        st.none(), st.booleans(), st.text(max_size=3), st.floats(-9e3, 9e3), st.integers(), st.just(10**400)
    ),
    st.sampled_from(["AGL", "WGS84", "amsl?", None, 3, []]),
    st.sampled_from(["M", "FT", "NM", None, 5]),
)
def test_what_is_not_known_to_count_from_the_sea_is_no_limit(value: Any, reference: Any, unit: Any) -> None:
    """Whatever stands there, the zone forbids all the way to that side."""
    for found in in_both(value, reference, value, reference, unit):
        assert found[:2] == (None, None)


def test_a_floor_above_the_ceiling_is_no_band() -> None:
    """Nor is one that ends where it begins."""
    assert in_both(900, "AMSL", 300, "AMSL", "M") == {(None, None, True)}
    assert in_both(120, "AGL", 500, "AGL", "M") == {(None, None, True)}


def test_a_radius_in_feet_is_one_in_feet() -> None:
    """Of the same unit as the limits."""
    disc = {"type": "Circle", "center": [8.55, 47.35], "radius": 3000}
    found = import_regions(older(horizontalProjection=disc, uomDimensions="FT"))
    assert found.collection["features"][0]["properties"]["radius_m"] == pytest.approx(914.4)
