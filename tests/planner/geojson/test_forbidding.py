"""What forbids does so however badly it is drawn; outlines of many corners lose nothing."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.geometry import LineString, Polygon

from planner.errors import ScenarioError
from planner.geojson import read_scenario
from planner.geojson.outlines import MOST
from planner.scenario import Scenario
from planner.validate import findings
from tests.planner.scenarios import feature, small, square

#: Far enough from the regions, the start and the area's edge.
WEST, SOUTH = 0.01, 0.03

places = st.tuples(st.integers(0, 40), st.integers(0, 40))
rings = st.lists(places, min_size=2, max_size=9)


def degrees(ring: list[Any]) -> list[list[float]]:
    return [[WEST + 1e-4 * x, SOUTH + 1e-4 * y] for x, y in ring]


def forbidden(scenario: Scenario, name: str = "Z") -> shapely.geometry.base.BaseGeometry:
    """All that a zone forbids, grown by a centimetre."""
    areas = [zone.area for zone in scenario.no_fly if zone.name == name and zone.area is not None]
    return shapely.union_all(areas).buffer(0.01)


@settings(deadline=None, max_examples=120)
@given(rings, st.booleans())
def test_whatever_a_ring_encloses_is_forbidden(ring: list[tuple[int, int]], closed: bool) -> None:
    """By shapely's own faces of the ring's edges: nothing within the outermost is left free."""
    drawn = [*ring, ring[0]] if closed else ring
    document = small(feature("Z", "no_fly", "Polygon", [degrees(drawn)]), clearance_m=0.0)
    scenario = read_scenario(document)
    line = LineString(scenario.frame.to_local(degrees([*ring, ring[0]])))
    faces = shapely.union_all(shapely.get_parts(shapely.polygonize([shapely.node(line)])))
    filled = [Polygon(part.exterior) for part in shapely.get_parts(faces) if isinstance(part, Polygon)]
    found = forbidden(scenario)
    assert all(found.covers(part) for part in filled)
    assert found.covers(line)
    hull = line.convex_hull.buffer(1.2)
    assert hull.covers(found)


@pytest.mark.parametrize("coordinates", [[], [[]], [[[math.nan, 0.0]]], None])
def test_a_zone_without_a_place_refuses_nothing(coordinates: Any) -> None:
    """It is told by name; the other zones stay."""
    bad = feature("bad", "no_fly", "Polygon", coordinates)
    good = feature("Z", "no_fly", "Polygon", square(WEST, SOUTH, 0.003))
    scenario = read_scenario(small(bad, good))
    assert [zone.name for zone in scenario.no_fly] == ["Z"]
    assert ("bad", "zone-without-place") in {(f.feature, f.rule) for f in scenario.warnings}


def test_places_that_are_none_are_left_out_of_a_ring() -> None:
    """The rest forbids."""
    ring = degrees([(0, 0), (30, 0), (30, 30), (0, 30), (0, 0)])
    ring.insert(2, [math.nan, 1.0])
    scenario = read_scenario(small(feature("Z", "no_fly", "Polygon", [ring])))
    assert forbidden(scenario).area == pytest.approx(334.0 * 332.0, rel=0.02)
    assert ("Z", "zone-mended") in {(f.feature, f.rule) for f in scenario.warnings}


def test_what_is_to_be_seen_or_stayed_in_is_still_refused() -> None:
    """A crossed region, a crossed area; and a zone that is not on Earth."""
    bow = degrees([(0, 0), (30, 30), (30, 0), (0, 30), (0, 0)])
    for role, name in (("roi", "X"), ("area", "area")):
        document = small()
        document["features"] = [f for f in document["features"] if f["id"] != name]
        document["features"].append(feature(name, role, "Polygon", [bow]))
        with pytest.raises(ScenarioError, match="ring-self-intersects"):
            read_scenario(document)
    with pytest.raises(ScenarioError, match="latitude-out-of-range"):
        read_scenario(small(feature("Z", "no_fly", "Polygon", [[[0, 95], [1, 95], [1, 96], [0, 95]]])))


def circle(corners: int) -> list[list[list[float]]]:
    angles = np.linspace(0.0, math.tau, corners, endpoint=False)
    ring = [[0.01 + 0.003 * math.cos(a), 0.03 + 0.003 * math.sin(a)] for a in angles]
    return [[*ring, ring[0]]]


@pytest.mark.parametrize("role", ["roi", "no_fly", "area"])
def test_a_circle_of_many_corners_is_read_with_few(role: str) -> None:
    """Round what is to be seen and what forbids, within what is stayed in."""
    document = small(feature("X", role, "Polygon", circle(4_900)))
    if role == "area":
        start = feature("start", "start", "Point", [0.01, 0.03])
        document["features"] = [feature("R", "roi", "Point", [0.01, 0.03]), start, document["features"][-1]]
    scenario = read_scenario(document)
    area = {"roi": scenario.regions[-1].area, "area": scenario.area}.get(role) or scenario.no_fly[0].area
    drawn = Polygon(scenario.frame.to_local(circle(4_900)[0]))
    assert area is not None
    assert shapely.get_num_coordinates(area) < 1000
    assert (drawn if role == "area" else area).covers(area if role == "area" else drawn)
    assert area.exterior.hausdorff_distance(drawn.exterior) < 1.0
    assert drawn.exterior.buffer(0.07).covers(area.exterior)
    assert "outline-thinned" in {finding.rule for finding in scenario.warnings}


def comb(teeth: int) -> list[list[list[float]]]:
    """A comb: nothing of its outline can be left out."""
    ring, step = [[0.01, 0.03]], 0.02 / teeth
    for k in range(teeth):
        tooth = ((k, 0.04), (k + 0.5, 0.04), (k + 0.5, 0.031), (k + 1.0, 0.031))
        ring += [[0.01 + x * step, y] for x, y in tooth]
    return [[*ring, [0.03, 0.03], [0.01, 0.03]]]


def test_a_comb_is_refused_as_a_region_and_forbidden_whole_as_a_zone() -> None:
    """By name and count, before anything is computed of its corners."""
    assert MOST < 4 * 2000
    (refused,) = findings(small(feature("X", "roi", "Polygon", comb(2000))))
    assert (refused.feature, refused.rule) == ("X", "too-many-corners")
    scenario = read_scenario(small(feature("Z", "no_fly", "Polygon", comb(2000))))
    assert forbidden(scenario).covers(Polygon(scenario.frame.to_local(comb(2000)[0])))
    assert shapely.get_num_coordinates(forbidden(scenario)) < MOST
