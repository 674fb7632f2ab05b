"""Zones that forbid: of the states, drawn as open lines, crossing themselves, or lacking something."""

from __future__ import annotations

import itertools
import json
import random

import pytest
from shapely.geometry import LineString, Point, Polygon, shape

from planner.errors import ScenarioError
from planner.geojson import read_scenario
from tests.app.imports.samples import (
    RING,
    folder,
    kml,
    line,
    placemark,
    point,
    polygon,
)
from tests.app.imports.test_roles import SQUARE, became, geojson
from tests.planner.scenarios import small

ZONE = {"identifier": "A1", "name": "Prison", "restriction": "PROHIBITED", "type": "COMMON"}


@pytest.mark.parametrize("restriction", ["PROHIBITED", "REQ_AUTHORISATION", "CONDITIONAL", "NO_RESTRICTION"])
def test_zones_of_the_states_forbid_or_are_asked_about(restriction: str) -> None:
    """EUROCAE ED-269 and ED-318: polygons and circles, none of them a region to fly over."""
    ring = {"horizontalProjection": SQUARE, "uomDimensions": "M"}
    disc = {"horizontalProjection": {"type": "Circle", "center": [8.55, 47.35], "radius": 900}}
    zones = {"title": "Zones", "features": [ZONE | {"restriction": restriction, "geometry": [ring, disc]}]}
    found = became(json.dumps(zones).encode())
    assert [account.role for account in found.shapes] == ["no_fly", "no_fly"]
    doubtful = restriction in ("CONDITIONAL", "NO_RESTRICTION")
    assert [account.in_doubt for account in found.shapes] == [doubtful, doubtful]
    assert found.collection["features"][1]["properties"]["radius_m"] == 900.0
    circle = {"type": "Point", "coordinates": [8.5, 47.3], "extent": {"subType": "Circle", "radius": 3500}}
    name = [{"text": "Castle", "lang": "en-GB"}]
    newer = geojson("", circle, {}, {"name": name, "type": restriction.replace("IS", "IZ")})
    (feature,) = became(newer).collection["features"]
    assert feature["id"] == "Castle"
    assert (feature["properties"]["role"], feature["properties"]["radius_m"]) == ("no_fly", 3500.0)


def test_an_open_no_fly_line_forbids_what_it_may_mean() -> None:
    """It covers the line, what it encloses when closed, and the strip of a width, by shapely."""
    dice = random.Random(5)
    for _ in range(40):
        places = [
            (8.5 + dice.uniform(0, 0.1), 47.3 + dice.uniform(0, 0.1)) for _ in range(dice.randint(3, 8))
        ]
        for width_m in (None, 500.0):
            data = kml(folder("no fly", placemark("wire", line(places))))
            (feature,) = became(data, width_m=width_m).collection["features"]
            area = shape(feature["geometry"])
            assert area.is_valid
            grown = area.buffer(1e-9)
            assert grown.covers(LineString(places))
            ring = Polygon(places)
            assert grown.covers(ring if ring.is_valid else LineString([*places, places[0]]))
            if width_m is not None:
                # half of 500 m is 0.0022 degrees of latitude, and more of longitude
                assert grown.covers(LineString(places).buffer(0.0018))


def test_a_zone_that_crosses_itself_forbids_all_it_encloses() -> None:
    """Random closed lines in a no-fly folder become valid polygons over every place they run round."""
    dice = random.Random(6)
    for _ in range(60):
        ring = [(8.5 + dice.uniform(0, 0.1), 47.3 + dice.uniform(0, 0.1)) for _ in range(dice.randint(4, 9))]
        ring.append(ring[0])
        found = became(kml(folder("no fly", placemark("z", polygon(ring)))))
        area = shape(found.collection["features"][0]["geometry"])
        assert area.is_valid
        for _ in range(20):
            lon, lat = 8.5 + dice.uniform(0, 0.1), 47.3 + dice.uniform(0, 0.1)
            if _winding(ring, lon, lat) != 0 or _crossings(ring, lon, lat) % 2:
                assert area.buffer(1e-9).covers(Point(lon, lat))


def _crossings(ring: list[tuple[float, float]], lon: float, lat: float) -> int:
    return sum(
        (ay > lat) != (by > lat) and lon < ax + (lat - ay) / (by - ay) * (bx - ax)
        for (ax, ay), (bx, by) in itertools.pairwise(ring)
    )


def _winding(ring: list[tuple[float, float]], lon: float, lat: float) -> int:
    return sum(
        (1 if by > ay else -1)
        for (ax, ay), (bx, by) in itertools.pairwise(ring)
        if (ay > lat) != (by > lat) and lon < ax + (lat - ay) / (by - ay) * (bx - ax)
    )


def test_no_fly_shapes_that_lack_something_stay_and_refuse_the_scenario() -> None:
    """A no-fly point without a radius is not dropped: the rest is taken, and the scenario names it."""
    data = kml(folder("NFZ", placemark("mast", point(8.9, 47.3)), placemark("z", polygon(RING))))
    found = became(data)
    assert [feature["id"] for feature in found.collection["features"]] == ["mast", "z"]
    assert [(finding.feature, finding.rule) for finding in found.left_out] == [("mast", "radius_m-missing")]
    with pytest.raises(ScenarioError) as caught:
        read_scenario(small(features=found.collection["features"]))
    assert any(finding.feature == "mast" for finding in caught.value.findings)
