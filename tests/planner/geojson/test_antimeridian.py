"""Across the antimeridian and round the poles: read as written by anyone, planned as anywhere else."""

from __future__ import annotations

import copy
import json
import math
import random
from functools import lru_cache
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from planner.check import judge
from planner.errors import ScenarioError
from planner.frames import LocalFrame
from planner.geojson import read_plan, read_scenario, write_plan
from planner.geojson.sheet import arc_deg, cut, joined
from planner.pipeline import make_plan
from planner.plan import Plan
from planner.validate import findings
from tests.planner.moved import GEOD, PLACES, Place, box, everything, put_at
from tests.planner.scenarios import feature, small, square

FAULTS = Path(__file__).parents[2] / "faults"


def planned(document: dict[str, Any]) -> Plan:
    scenario = read_scenario(document)
    return make_plan(scenario)


@lru_cache
def everything_at(origin: Place) -> Plan:
    return planned(everything(origin))


def turned(value: Any, by_deg: float) -> Any:
    """Coordinates with longitudes counted from elsewhere."""
    if isinstance(value[0], list):
        return [turned(item, by_deg) for item in value]
    return [value[0] + by_deg, *value[1:]]


@pytest.mark.parametrize("origin", PLACES[1:-1], ids=str)
def test_anywhere_on_earth_plans_alike(origin: Place) -> None:
    """The same drawing anywhere has the same length within 0.5 %, the same verdict and the same geodesics."""
    here, there = everything_at(PLACES[0]), everything_at(origin)
    assert there.metrics.length_m == pytest.approx(here.metrics.length_m, rel=5e-3)
    assert {v.constraint for v in there.violations} == {v.constraint for v in here.violations}
    assert all(share >= 0.9999 for share in there.metrics.coverage.values())
    lons, lats, altitudes_m = zip(*there.paths[0].line, strict=True)
    geodesic_m = float(np.hypot(GEOD.line_lengths(lons, lats), np.diff(altitudes_m)).sum())
    assert geodesic_m == pytest.approx(there.metrics.flight_length_m, rel=1e-3)
    assert max(abs(b - a) for a, b in pairwise(lons)) < 180.0


@pytest.mark.parametrize("origin", PLACES, ids=str)
def test_a_plan_read_back_is_judged_the_same(origin: Place) -> None:
    """Written and read again the plan is the same document, and the judge finds the same."""
    document = write_plan(everything_at(origin))
    again = read_plan(json.loads(json.dumps(document)))
    assert {v.constraint for v in judge(read_scenario(everything(origin)), again).violations} == set()
    rewritten = write_plan(again)
    for before, after in zip(document["features"], rewritten["features"], strict=True):
        assert before["properties"] == after["properties"]
        one, other = (shapely.from_geojson(json.dumps(f["geometry"])) for f in (before, after))
        assert shapely.equals_exact(shapely.normalize(one), shapely.normalize(other), 1e-9)


@pytest.mark.parametrize("origin", PLACES, ids=str)
def test_ground_is_cut_at_the_antimeridian(origin: Place) -> None:
    """No polygon of a written plan leaves ±180°, and cut ones keep their geodesic area."""
    plan = everything_at(origin)
    written = [f for f in write_plan(plan)["features"] if f["properties"]["role"] == "footprint"]
    for footprint, feature_ in zip(plan.footprints, written, strict=True):
        shape = shapely.from_geojson(json.dumps(feature_["geometry"]))
        assert shape.is_valid
        assert shape.bounds[0] >= -180.0
        assert shape.bounds[2] <= 180.0
        whole_m2 = abs(GEOD.polygon_area_perimeter(*zip(*footprint.ring, strict=True))[0])
        assert sum(abs(GEOD.geometry_area_perimeter(part)[0]) for part in shapely.get_parts(shape)) == (
            pytest.approx(whole_m2, rel=1e-3)
        )


def test_what_rfc_7946_cuts_is_one_region() -> None:
    """A region cut at the antimeridian, as RFC 7946 asks, is planned as the same region elsewhere."""
    document = json.loads((FAULTS / "antimeridian_rfc7946.geojson").read_text())
    elsewhere = copy.deepcopy(document)
    for part in elsewhere["features"][:2]:
        lon, lat = part["geometry"]["coordinates"]
        part["geometry"]["coordinates"] = [lon - math.copysign(180.0, lon), lat]
    half, _ = document["features"][2]["geometry"]["coordinates"]
    west, south, _, north = Polygon(half[0]).bounds
    corners = shapely.box(west - 180.0, south, 180.0 - west, north).exterior.coords
    elsewhere["features"][2]["geometry"] = {"type": "Polygon", "coordinates": [[list(at) for at in corners]]}
    here, there = planned(elsewhere), planned(document)
    assert there.violations == () == here.violations
    assert there.metrics.length_m == pytest.approx(here.metrics.length_m, rel=1e-4)


FORMS = ("cut", "on", "back", "jumps")


def in_form(form: str, west: float, east: float, south: float, north: float) -> dict[str, Any]:
    """A box across the antimeridian as programs write it; ``west`` and ``east`` count from there."""

    def rings(west: float, east: float) -> list[list[list[float]]]:
        return [[list(place) for place in shapely.box(west, south, east, north).exterior.coords]]

    if form == "cut":
        return {
            "type": "MultiPolygon",
            "coordinates": [rings(180.0 + west, 180.0), rings(-180.0, east - 180.0)],
        }
    if form == "jumps":
        jumping = [[lon - math.copysign(180.0, lon), lat] for lon, lat in rings(west, east)[0]]
        return {"type": "Polygon", "coordinates": [jumping]}
    return {"type": "Polygon", "coordinates": turned(rings(west, east), 180.0 if form == "on" else -180.0)}


@given(
    west=st.floats(-0.3, -1e-4),
    east=st.floats(1e-4, 0.3),
    south=st.floats(-80.0, 79.0),
    role=st.sampled_from(["roi", "area", "no_fly", "obstacle"]),
)
def test_every_way_of_writing_is_the_same_shape(west: float, east: float, south: float, role: str) -> None:
    """Cut, going on beyond 180°, beyond −180° or jumping: one shape, with the geodesic area."""
    shapes: list[BaseGeometry] = []
    first: LocalFrame | None = None
    for form in FORMS:
        geometry = in_form(form, west, east, south, south + 0.01)
        more = {"height_m": 10.0} if role == "obstacle" else {}
        document = small(
            features=[
                feature("X", role, geometry["type"], geometry["coordinates"], **more),
                feature("start", "start", "Point", [180.0 + west / 2.0, south + 0.005]),
                *(
                    []
                    if role == "roi"
                    else [feature("Y", "roi", "Point", [180.0 + west / 2.0, south + 0.004])]
                ),
            ],
            vehicles=[{"name": "uav", "airspeed_m_s": 5.0, "min_turn_radius_m": 0.001}],
        )
        if role in ("no_fly", "obstacle"):
            document["features"][1]["geometry"]["coordinates"] = [179.0, south]
        scenario = read_scenario(document)
        shape = {
            "roi": scenario.regions[0].area,
            "area": scenario.area,
            "no_fly": scenario.no_fly[0].area if scenario.no_fly else None,
            "obstacle": scenario.obstacles[0].area if scenario.obstacles else None,
        }[role]
        first = first or scenario.frame
        shapes.append(
            shapely.transform(shape, lambda at, to=first, of=scenario.frame: to.to_local(of.to_wgs84(at)))
        )
    wanted_m2 = abs(
        GEOD.geometry_area_perimeter(
            Polygon(in_form("on", west, east, south, south + 0.01)["coordinates"][0]).segmentize(0.005)
        )[0]
    )
    for shape in shapes:
        assert isinstance(shape, Polygon)
        assert shape.area == pytest.approx(wanted_m2, rel=2e-3)
        assert shape.symmetric_difference(shapes[0]).area < 1e-5 * shape.area + 0.1


@pytest.mark.parametrize("form", ["whole", "with the pole's edge", "halves"])
@pytest.mark.parametrize("pole", [1.0, -1.0])
def test_a_region_round_a_pole_is_a_cap(form: str, pole: float) -> None:
    """A ring round a pole is the ground up to the pole, with or without an edge along the map's rim."""
    lat, rim = pole * 89.99, pole * 90.0
    circle = [[float(lon), lat] for lon in range(-180, 181, 5)]
    if form == "whole":
        geometry = ("Polygon", [circle])
    elif form == "halves":
        west, east = circle[:37], circle[36:]
        geometry = (
            "MultiPolygon",
            [[[*half, [half[-1][0], rim], [half[0][0], rim], half[0]]] for half in (west, east)],
        )
    else:
        geometry = ("Polygon", [[*circle, [180.0, rim], [-180.0, rim], circle[0]]])
    start = feature("start", "start", "Point", [0.0, pole * 89.9])
    region = read_scenario(small(features=[feature("cap", "roi", *geometry), start])).regions[0].area
    radius_m = GEOD.inv(0.0, lat, 0.0, rim)[2]
    assert isinstance(region, Polygon)
    assert region.area == pytest.approx(math.pi * radius_m**2, rel=2e-3)


def test_polygons_that_do_overlap_are_refused() -> None:
    """Touching parts are joined, overlapping ones refused, on both sides of the antimeridian."""
    parts = [square(179.99, 0.0, 0.01), square(-180.005, 0.0, 0.01)]
    document = small(
        features=[feature("X", "roi", "MultiPolygon", parts), feature("s", "start", "Point", [180, 0])]
    )
    with pytest.raises(ScenarioError) as caught:
        read_scenario(document)
    assert [(f.feature, f.rule) for f in caught.value.findings] == [("X", "polygons-overlap")]


def test_a_zone_in_parts_forbids_each() -> None:
    """A zone of several polygons that do not touch is no cut one, but as many as there are, of one name."""
    parts = [square(179.98, 0.0, 0.01), square(-179.99, 0.0, 0.01)]
    document = small(
        features=[
            feature("X", "no_fly", "MultiPolygon", parts),
            feature("Y", "roi", "Point", [180, 0.05]),
            feature("s", "start", "Point", [180, 0.1]),
        ]
    )
    zones = read_scenario(document).no_fly
    assert [zone.name for zone in zones] == ["X", "X"]
    assert all(zone.area is not None and zone.area.area > 1e6 for zone in zones)


@pytest.mark.parametrize("seed", range(60))
def test_wherever_things_lie_a_finding_or_a_scenario_comes(seed: int) -> None:
    """Features anywhere on Earth, near or far from each other, are read or refused, never a crash."""
    rng = random.Random(seed)

    def coordinate(*marked: float, most: float) -> float:
        return rng.choice([rng.uniform(-most, most), *marked])

    features = []
    for number in range(rng.randint(1, 3)):
        lon, lat = coordinate(179.99, -180.0, 0.0, 90.0, most=360.0), coordinate(89.9, -90.0, 0.0, most=89.9)
        features.append(feature(f"F{number}", "roi", "Polygon", square(lon, min(lat, 89.9), 0.01)))
    features.append(
        feature("start", "start", "Point", [features[0]["geometry"]["coordinates"][0][0][0], 0.0])
    )
    document = small(features=features)
    found = [f for f in findings(document) if f.severity == "error"]
    assert all(f.feature and f.fix for f in found)
    if not found:
        assert all(region.area.area > 0.0 for region in read_scenario(document).regions)


@pytest.mark.parametrize("origin", PLACES, ids=str)
@pytest.mark.parametrize(("reach_m", "refused"), [(170e3, False), (190e3, True)])
def test_what_is_too_wide_is_so_anywhere(origin: Place, reach_m: float, refused: bool) -> None:
    """Up to 500 km from corner to corner is read anywhere, and beyond it refused."""
    put = put_at(origin)
    features = [
        feature("A", "roi", "Polygon", box(put, -reach_m, -reach_m, -reach_m + 500.0, -reach_m + 500.0)),
        feature("B", "roi", "Polygon", box(put, reach_m - 500.0, reach_m - 500.0, reach_m, reach_m)),
        feature("start", "start", "Point", put(0.0, 0.0)),
    ]
    document = small(features=features)
    if refused:
        with pytest.raises(ScenarioError) as caught:
            read_scenario(document)
        assert {f.rule for f in caught.value.findings} == {"extent-too-large"}
    else:
        assert read_scenario(document).regions[0].area.area == pytest.approx(250_000.0, rel=2e-3)


@given(st.lists(st.floats(-360.0, 360.0), min_size=1, max_size=8))
def test_the_arc_holds_all_longitudes(lons: list[float]) -> None:
    """Every longitude lies in the arc, and no shorter one holds them all."""
    west, east = arc_deg(lons)
    assert -180.0 <= west <= 180.0
    assert 0.0 <= east - west <= 360.0
    offsets = sorted((lon - west) % 360.0 for lon in lons)
    assert all(off <= east - west + 1e-9 or off >= 360.0 - 1e-9 for off in offsets)
    around = sorted(lon % 360.0 for lon in lons)
    gaps = [b - a for a, b in zip(around, [*around[1:], around[0] + 360.0], strict=True)]
    assert east - west == pytest.approx(360.0 - max(gaps), abs=1e-6) or len(set(around)) == 1


@given(west=st.floats(170.0, 179.9), width=st.floats(0.2, 30.0), south=st.floats(-80.0, 60.0))
def test_cut_and_joined_is_the_same_shape(west: float, width: float, south: float) -> None:
    """A polygon with a hole, cut and joined again, is what it was."""
    outer = shapely.box(west, south, west + width, south + 20.0)
    hole = shapely.box(west + width / 3.0, south + 5.0, west + width / 1.5, south + 10.0)
    rings = [list(outer.exterior.coords), list(hole.exterior.coords)]
    pieces = cut(rings)
    assert all(-180.0 <= lon <= 180.0 for piece in pieces for ring in piece for lon, _ in ring)
    (again,) = joined(pieces)
    whole = Polygon(again[0], again[1:])
    assert whole.symmetric_difference(Polygon(rings[0], [rings[1]])).area < 1e-9
