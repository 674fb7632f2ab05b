"""Reading scenarios: what is right comes through in local metres, what is wrong is named."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pyproj import Geod

from planner.errors import ScenarioError
from planner.geojson import read_scenario
from planner.validate import findings
from tests.planner.scenarios import case, feature, small, square

GEOD = Geod(ellps="WGS84")


def refused(document: Any) -> dict[str, tuple[str, ...]]:
    with pytest.raises(ScenarioError) as caught:
        read_scenario(document)
    found: dict[str, tuple[str, ...]] = {}
    for finding in caught.value.findings:
        assert finding.message
        assert finding.fix
        found[finding.feature] = (*found.get(finding.feature, ()), finding.rule)
    return found


@pytest.mark.parametrize("number", [1, 2, 3, 4])
def test_shared_cases_are_read_with_geodesic_areas(number: int) -> None:
    """Each region's area in the local frame is its geodesic area to a few parts in a million."""
    document = case(number)
    scenario = read_scenario(document)
    assert [r.name for r in scenario.regions] == ["R1", "R2", "R3", "R4", "R5", "R6"]
    assert len(scenario.threats) == 9
    rings = {f["id"]: f["geometry"]["coordinates"][0] for f in document["features"]}
    for region in scenario.regions:
        lons, lats = zip(*rings[region.name], strict=True)
        area_m2 = abs(GEOD.polygon_area_perimeter(lons, lats)[0])
        assert region.area.area == pytest.approx(area_m2, rel=2e-5)


def bend(change: Callable[[dict[str, Any]], object]) -> dict[str, Any]:
    document = small()
    change(document)
    return document


BAD: dict[str, tuple[dict[str, Any], str, str]] = {
    "a plan": (small() | {"metrics": {}, "scenario_hash": "0"}, "scenario", "is-a-plan"),
    "a mission of QGroundControl": ({"fileType": "Plan", "mission": {}}, "scenario", "is-a-mission"),
    "self-intersecting ring": (
        small(feature("X", "roi", "Polygon", [[[0, 0], [0.01, 0.01], [0.01, 0], [0, 0.01], [0, 0]]])),
        "X",
        "ring-self-intersects",
    ),
    "hole outside its ring": (
        small(
            feature(
                "X",
                "roi",
                "Polygon",
                [
                    [[0, 0], [0.01, 0], [0.01, 0.01], [0, 0]],
                    [[0.02, 0.02], [0.03, 0.02], [0.03, 0.03], [0.02, 0.02]],
                ],
            )
        ),
        "X",
        "hole-misplaced",
    ),
    "empty ring": (small(feature("X", "roi", "Polygon", [[]])), "X", "ring-empty"),
    "no ring": (small(feature("X", "roi", "Polygon", [])), "X", "ring-empty"),
    "open ring": (
        small(feature("X", "roi", "Polygon", [[[0, 0], [0.01, 0], [0.01, 0.01], [0, 0.01]]])),
        "X",
        "ring-not-closed",
    ),
    "ring on a line": (
        small(feature("X", "roi", "Polygon", [[[0, 0], [0.01, 0], [0.02, 0], [0, 0]]])),
        "X",
        "ring-self-intersects",
    ),
    "two points": (
        small(feature("X", "roi", "Polygon", [[[0, 0], [0.01, 0], [0, 0]]])),
        "X",
        "ring-too-short",
    ),
    "wrong axis order": (
        small(feature("X", "threat", "Point", [33.5, -117.7], model="missile", radius_m=10)),
        "X",
        "latitude-out-of-range",
    ),
    "longitude": (
        small(feature("X", "threat", "Point", [361, 0], model="missile", radius_m=10)),
        "X",
        "longitude-out-of-range",
    ),
    "NaN place": (
        small(feature("X", "threat", "Point", [math.nan, 0], model="missile", radius_m=10)),
        "X",
        "not-finite",
    ),
    "NaN number": (small(altitude_m=math.nan), "scenario", "not-finite"),
    "text for a number": (small(altitude_m="500"), "scenario", "bad-value"),
    "true for a number": (small(altitude_m=True), "scenario", "bad-value"),
    "region outside the area": (
        small(feature("X", "roi", "Polygon", square(0.2, 0.0, 0.003))),
        "X",
        "roi-outside-area",
    ),
    "unknown role": (small(feature("X", "target", "Point", [0, 0])), "X", "unknown-role"),
    "no role": (
        small({"type": "Feature", "id": "X", "properties": {}, "geometry": None}),
        "X",
        "unknown-role",
    ),
    "unknown property": (
        small(feature("X", "roi", "Polygon", square(0.01, 0, 0.002), prio=2)),
        "X",
        "unknown-property",
    ),
    "unknown member": (small(altitude=3), "scenario", "unknown-property"),
    "wrong geometry": (small(feature("X", "threat", "LineString", [[0, 0], [1, 1]])), "X", "wrong-geometry"),
    "start in a hard threat": (
        small(feature("X", "threat", "Point", [-0.02, -0.02], model="missile", radius_m=500, hard=True)),
        "start",
        "start-in-hard-zone",
    ),
    "start in a no-fly zone": (
        small(feature("X", "no_fly", "Polygon", square(-0.021, -0.021, 0.002))),
        "start",
        "start-in-hard-zone",
    ),
    "start outside the area": (
        bend(lambda d: d["features"][3]["geometry"].update(coordinates=[-0.06, 0])),
        "start",
        "outside-area",
    ),
    "two starts": (small(feature("X", "start", "Point", [0, 0])), "X", "several-starts"),
    "same name twice": (small(feature("A", "roi", "Polygon", square(0.01, 0, 0.002))), "A", "duplicate-id"),
    "turn radius larger than the area": (
        small(vehicles=[{"name": "uav", "airspeed_m_s": 200.0, "min_turn_radius_m": 9000.0}]),
        "vehicle uav",
        "turn-radius-exceeds-area",
    ),
    "no turn limit": (
        small(vehicles=[{"name": "uav", "airspeed_m_s": 20.0}]),
        "vehicle uav",
        "missing-property",
    ),
    "no vehicle": (small(vehicles=[]), "scenario", "missing-member"),
    "swath not positive": (
        bend(lambda d: d["sensors"][0].update(elevation_beamwidth_deg=120.0)),
        "sensor sar",
        "swath-not-positive",
    ),
    "zero beam": (
        bend(lambda d: d["sensors"][0].update(elevation_beamwidth_deg=0.0)),
        "sensor sar",
        "out-of-range",
    ),
    "unknown sensor": (
        small(feature("X", "roi", "Polygon", square(0.01, 0, 0.002), sensor="eye")),
        "X",
        "unknown-sensor",
    ),
    "unknown method": (small(method={"routing": "magic"}), "method", "unknown-value"),
    "too many directions": (small(method={"directions": 99}), "method", "out-of-range"),
    "one direction": (small(method={"directions": 1}), "method", "out-of-range"),
    "far apart": (
        small(feature("X", "roi", "Point", [60, 50])),
        "X",
        "extent-too-large",
    ),
    "wide by itself": (
        small(feature("X", "roi", "Polygon", [[[0, 0], [5, 0], [0, 5], [0, 0]]])),
        "X",
        "extent-too-large",
    ),
    "number beyond all": (small(altitude_m=10**400), "scenario", "not-finite"),
    "place beyond all": (
        small(feature("X", "threat", "Point", [10**400, 0], model="missile", radius_m=10)),
        "X",
        "not-finite",
    ),
    "endless seed": (small(seed=math.inf), "scenario", "bad-value"),
    "other crs": (
        small(crs={"type": "name", "properties": {"name": "EPSG:3857"}}),
        "scenario",
        "unknown-crs",
    ),
    "no region": (bend(lambda d: d.update(features=d["features"][2:])), "scenario", "no-region"),
    "no start": (bend(lambda d: d.update(features=d["features"][:3])), "scenario", "no-start"),
    "below ground": (
        bend(
            lambda d: (
                d.update(altitude_reference="amsl"),
                d["features"][3]["geometry"].update(coordinates=[-0.02, -0.02, 700.0]),
            )
        ),
        "scenario",
        "altitude-below-ground",
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_what_is_wrong_is_named(name: str) -> None:
    """Each bad input is refused with the feature and the rule that it breaks."""
    document, where, rule = BAD[name]
    assert rule in refused(document).get(where, ()), refused(document)


def test_all_findings_are_reported_at_once() -> None:
    """Three mistakes in three features give three findings, not the first alone."""
    document = small(
        feature("X", "target", "Point", [0, 0]),
        feature("Y", "threat", "Point", [0, 0], model="laser", radius_m=-1),
    )
    found = refused(document)
    assert set(found) == {"X", "Y"}
    assert set(found["Y"]) == {"unknown-value", "out-of-range"}


@pytest.mark.parametrize(
    "document", [None, [], 3, "x", {}, {"type": "Feature"}, {"type": "FeatureCollection"}]
)
def test_what_is_no_collection_is_refused(document: Any) -> None:
    """Anything but a FeatureCollection with features is refused, not crashed upon."""
    assert refused(document)["scenario"]


JSON = st.recursive(
    st.none() | st.booleans() | st.floats() | st.integers(-1000, 1000) | st.text(max_size=4),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=4), inner, max_size=3),
    max_leaves=8,
)


def whole() -> dict[str, Any]:
    """A scenario with something of every kind."""
    return small(
        feature("T", "threat", "Point", [0.012, 0.004], model="radar", radius_m=300.0, intensity_m=90.0),
        feature("N", "no_fly", "Polygon", square(0.02, 0.02, 0.001), floor_m=0.0, ceiling_m=90.0),
        feature("O", "obstacle", "Polygon", square(0.02, 0.03, 0.001), height_m=80.0),
        feature("E", "end", "Point", [-0.004, -0.004], heading_deg=20.0),
        wind={"speed_m_s": 3.0, "from_deg": 20.0},
        objective={"length": 1.0},
        method={"routing": "auto"},
        seed=1,
        time_budget_s=20.0,
        clearance_m=10.0,
    )


def spots(value: Any, path: tuple[str | int, ...] = ()) -> Iterator[tuple[str | int, ...]]:
    """The way to everything in a document."""
    inner = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, child in inner:
        yield (*path, key)
        yield from spots(child, (*path, key))


SPOTS = tuple(spots(whole()))


@given(spot=st.sampled_from(SPOTS), junk=JSON)
@settings(max_examples=300)
def test_junk_anywhere_is_a_finding_or_fine(spot: tuple[str | int, ...], junk: Any) -> None:
    """Whatever JSON stands in any place, reading ends with a scenario or a ScenarioError."""
    document = whole()
    *path, last = spot
    target: Any = document
    for key in path:
        target = target[key]
    target[last] = junk
    found = findings(document)
    assert all(f.message and f.fix for f in found)


def test_hash_ignores_the_order_of_keys() -> None:
    """The same document written with its keys the other way round has the same hash."""
    document = small()
    turned = json.loads(json.dumps(dict(reversed(list(document.items())))))
    assert read_scenario(document).scenario_hash == read_scenario(turned).scenario_hash
    assert read_scenario(small(seed=1)).scenario_hash != read_scenario(document).scenario_hash


def test_corridor_and_target_become_areas() -> None:
    """A LineString with a width and a Point with a radius are areas of that width and radius."""
    scenario = read_scenario(
        small(
            feature("C", "roi", "LineString", [[0.01, 0.0], [0.02, 0.0]], width_m=50.0),
            feature("T", "roi", "Point", [0.01, 0.01], radius_m=40.0),
        )
    )
    corridor, target = scenario.regions[2:]
    length_m = GEOD.inv(0.01, 0.0, 0.02, 0.0)[2]
    assert corridor.area.area == pytest.approx(50.0 * length_m, rel=1e-4)
    assert target.area.area == pytest.approx(math.pi * 40.0**2, rel=1e-2)


def test_headings_are_true() -> None:
    """An approach heading is that angle from the frame's axes, as the frame lies, convergence included."""
    scenario = read_scenario(small(feature("T", "roi", "Point", [0.01, 0.01], approach_deg=[90.0, 0.0])))
    approach = scenario.regions[2].approach_rad
    assert approach is not None
    turned_rad = scenario.frame.turned_rad
    assert math.remainder(approach[0] + turned_rad, math.tau) == pytest.approx(0.0, abs=1e-5)
    assert math.remainder(approach[1] + turned_rad, math.tau) == pytest.approx(math.pi / 2, abs=1e-5)


def test_region_no_pass_can_see_is_found_without_planning() -> None:
    """More than two swaths for the paper's coverage, or no room in the area: an error, else a warning."""
    paper = {"coverage": "li2018"}
    big = feature("X", "roi", "Polygon", square(0.01, -0.04, 0.03))
    assert [f.rule for f in findings(small(big, method=paper)) if f.feature == "X"] == ["not-seen-swath"]
    assert [f for f in findings(small(big)) if f.feature == "X"] == []
    from_afar = findings(small(altitude_m=20_000.0))
    assert [f.rule for f in from_afar if f.feature == "A"] == ["not-seen-area"]
    big["properties"]["required"] = False
    assert [f.severity for f in findings(small(big, method=paper)) if f.feature == "X"] == ["warning"]


def test_revisits_are_read_for_the_methods_that_plan_them() -> None:
    """A number of visits is kept; the paper's routing refuses more than one, and 51 are a slip of the pen."""
    document = small()
    document["features"][0]["properties"]["revisits"] = 3
    assert read_scenario(document).regions[0].revisits == 3
    with pytest.raises(ScenarioError, match="visits"):
        read_scenario(document | {"method": {"routing": "li2018"}})
    document["features"][0]["properties"]["revisits"] = 51
    with pytest.raises(ScenarioError, match="51"):
        read_scenario(document)


def test_region_behind_a_hard_zone_and_too_much_wind_are_found_without_planning() -> None:
    """What zones or the wind forbid is an error of validation, not of the plan."""
    wall = feature("Z", "no_fly", "Polygon", square(-0.013, -0.013, 0.029))
    assert [f.feature for f in findings(small(wall)) if f.severity == "error"] == ["A"]
    storm = small(wind={"speed_m_s": 25.0, "from_deg": 0.0})
    assert [f.rule for f in findings(storm) if f.severity == "error"] == ["wind-too-strong"]


@pytest.mark.parametrize("name", ["method", "wind", "objective"])
@pytest.mark.parametrize("value", ["auto", 8, [1], True])
def test_members_that_are_no_objects_are_refused(name: str, value: object) -> None:
    """What is meant by them is unknown, and without them another plan would be made than was asked for."""
    found = [f for f in findings(small(**{name: value})) if f.severity == "error"]
    assert "bad-value" in [f.rule for f in found]
    assert f"{name} is not an object" in found[0].message


def test_passes_without_number_are_a_slip_of_height() -> None:
    """Too low, a pass sees a few metres: told with their number; refused where no plan could hold them."""
    assert findings(small()) == ()
    (warned,) = findings(small(altitude_m=2.0))
    assert (warned.rule, warned.severity) == ("many-passes", "warning")
    narrow = small(altitude_m=1.0)
    narrow["sensors"][0]["elevation_beamwidth_deg"] = 1.0
    assert {f.rule for f in findings(narrow)} == {"too-many-passes", "flight-long"}
    assert {f.rule for f in findings(small(altitude_m=0.001))} == {"out-of-range"}


@pytest.mark.parametrize("wrong", [["R1"], {"name": "R1"}, True, False, []])
def test_ids_that_are_neither_text_nor_number_are_refused(wrong: object) -> None:
    """By the place of their feature, which nobody could name otherwise."""
    document = small()
    document["features"][0]["id"] = wrong
    with pytest.raises(ScenarioError) as caught:
        read_scenario(document)
    assert [(finding.feature, finding.rule) for finding in caught.value.findings] == [
        ("features[0]", "feature-id")
    ]
