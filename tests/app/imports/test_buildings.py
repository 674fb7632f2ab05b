"""Buildings of OpenStreetMap: obstacles as high as tags say; of unknown height they forbid all the way."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from shapely.geometry import LineString, Polygon

from app.imports import ImportOptions, import_regions
from app.imports.buildings import metres
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.validate import read_valid
from tests.planner.scenarios import small

RING = [[8.0, 47.0], [8.001, 47.0], [8.001, 47.001], [8.0, 47.001], [8.0, 47.0]]


def became(tags: dict[str, Any], kind: str = "Polygon", **options: Any) -> tuple[dict[str, Any], str]:
    """Properties of the feature that a tagged outline became, and what says so."""
    coordinates: Any = {"Polygon": [RING], "LineString": RING, "Point": RING[0]}[kind]
    document = {
        "type": "FeatureCollection",
        "features": [
            {"type": "Feature", "geometry": {"type": kind, "coordinates": coordinates}, "properties": tags}
        ],
    }
    imported = import_regions(json.dumps(document).encode(), ImportOptions(**options))
    (account,) = imported.shapes
    (feature,) = imported.collection["features"]
    return feature["properties"], account.why


@pytest.mark.parametrize(
    ("tags", "height_m", "base_m"),
    [
        ({"height": "12"}, 12.0, None),
        ({"height": "12 m"}, 12.0, None),
        ({"height": 12.5}, 12.5, None),
        ({"height": "40'"}, 12.192, None),
        ({"height": "40 ft"}, 12.192, None),
        ({"height": "5'10\""}, 1.778, None),
        ({"height_m": 9, "height": "30"}, 9.0, None),
        ({"building:levels": "4"}, 12.0, None),
        ({"building:levels": 4, "roof:levels": "1"}, 15.0, None),
        ({"building:levels": "4", "height": "20"}, 20.0, None),
        ({"height": "20", "min_height": "6 m"}, 20.0, 6.0),
        ({"building:levels": "5", "building:min_level": "2"}, 15.0, 6.0),
        ({"height": "20", "min_height": "25"}, 20.0, None),
        ({"height": "20", "min_height": "some"}, 20.0, None),
    ],
)
def test_a_building_is_an_obstacle_as_high_as_its_tags_say(
    tags: dict[str, Any], height_m: float, base_m: float | None
) -> None:
    """Metres, feet and inches, or 3 m a level; what can be passed below it only where that is plain."""
    properties, why = became({"building": "yes", **tags})
    assert properties["role"] == "obstacle"
    assert properties["height_m"] == pytest.approx(height_m)
    assert properties.get("base_m") == base_m
    assert "building" in why


@pytest.mark.parametrize(
    "tags",
    [
        {},
        {"height": "high"},
        {"height": "~12"},
        {"height": "12;15"},
        {"height": "1,200"},
        {"height": "-5"},
        {"height": "0"},
        {"height": "1e9"},
        {"height": "nan"},
        {"height": "tall", "building:levels": "3"},
        {"building:levels": "2;3"},
        {"building:levels": "0"},
        {"building:levels": "-1"},
    ],
)
def test_a_building_of_unknown_height_forbids_at_every_height(tags: dict[str, Any]) -> None:
    """It is said so, and no limit of height is on it; a height given with the import is taken."""
    properties, why = became({"building": "apartments", **tags})
    assert properties["role"] == "no_fly"
    assert not {"floor_m", "ceiling_m"} & properties.keys()
    assert "every height" in why
    given, _ = became({"building": "apartments", **tags}, height_m=25.0)
    assert (given["role"], given["height_m"]) == ("obstacle", 25.0)


@pytest.mark.parametrize("tags", [{"building": "no"}, {"building": ""}, {"name": "field", "height": "12"}])
def test_what_is_no_building_stays_a_region(tags: dict[str, Any]) -> None:
    """A tag that denies it, or none."""
    assert became(tags)[0]["role"] == "roi"


@pytest.mark.parametrize(
    "tags",
    [
        {"building:part": "yes", "height": "9"},
        {"tags": {"building": "yes", "height": "9"}},
        {"building": "yes", "other_tags": '"height"=>"9","name"=>"Mill"'},
        {"other_tags": '"building:levels"=>"3","building"=>"house"'},
    ],
)
def test_tags_are_found_where_programs_keep_them(tags: dict[str, Any]) -> None:
    """Parts of buildings; tags within one value, as JSON or as GDAL's pairs."""
    properties, _ = became(tags)
    assert (properties["role"], properties["height_m"]) == ("obstacle", 9.0)


def test_what_forbids_goes_before_a_building() -> None:
    """A name that restricts: a zone at every height."""
    assert became({"building": "yes", "height": "9", "name": "NFZ hospital"})[0]["role"] == "no_fly"


def test_a_role_of_its_own_goes_before_its_tags() -> None:
    """A roof to be seen is a region."""
    assert became({"building": "yes", "height": "9", "role": "roi"})[0]["role"] == "roi"


def test_an_obstacle_of_another_word_has_its_height_by_tags_too() -> None:
    """A shape called so takes the same heights; a closed way is an outline."""
    assert became({"name": "Obstacle 3", "height": "40 ft"})[0]["height_m"] == pytest.approx(12.192)
    assert became({"building": "yes", "height": "9"}, "LineString")[0]["role"] == "obstacle"


@pytest.mark.parametrize("text", ["", "m", "12 km", "12 m high", "12 14", "٣", "0x10", "1e3", "inf", "'"])
def test_heights_are_read_only_where_they_are_plain(text: str) -> None:
    """Everything else is not known."""
    assert metres(text) is None


def test_a_town_of_such_buildings_is_a_scenario() -> None:
    """Obstacles and zones as imported are read by the planner."""
    document = small()
    place = [[0.05, 0.05], [0.051, 0.05], [0.051, 0.051], [0.05, 0.051], [0.05, 0.05]]
    for name, tags in (("mill", {"height": "30 m"}), ("barn", {})):
        properties, _ = became({"building": "yes", "name": name, **tags})
        document["features"].append(
            {
                "type": "Feature",
                "id": name,
                "geometry": {"type": "Polygon", "coordinates": [place]},
                "properties": properties,
            }
        )
    scenario = read_scenario(document)
    assert [obstacle.height_m for obstacle in scenario.airspace.obstacles] == [30.0]
    assert [zone.ceiling_m for zone in scenario.airspace.no_fly if zone.name == "barn"] == [float("inf")]


def test_the_packaged_extract_is_what_stands_in_the_example() -> None:
    """Buildings of the extract, of unknown height: zones; with one, obstacles where the example has them."""
    examples = Path(__file__).parents[3] / "examples"
    extract = (examples / "kaltern-osm.geojson").read_bytes()
    assert "ODbL" in json.loads(extract)["copyright"]
    unknown = import_regions(extract, ImportOptions())
    assert {each["properties"]["role"] for each in unknown.collection["features"]} == {"no_fly"}
    given = import_regions(extract, ImportOptions(height_m=15.0))
    scenario = json.loads((examples / "city-block.geojson").read_text())
    assert "ODbL" in scenario["name"]
    standing = [each for each in scenario["features"] if each["properties"]["role"] == "obstacle"]
    assert [each["geometry"] for each in standing] == [
        each["geometry"] for each in given.collection["features"]
    ]


def test_the_example_is_planned_whole_and_clear() -> None:
    """Everything is seen, the judge finds nothing, and the line keeps clear of the church."""
    path = Path(__file__).parents[3] / "examples" / "city-block.geojson"
    document = json.loads(path.read_text())
    scenario = read_valid(document)
    plan = make_plan(scenario)
    assert plan.violations == ()
    assert plan.metrics.coverage == {"old-town": 1.0}
    line = LineString(scenario.frame.to_local([place[:2] for place in plan.paths[0].line]))
    church = next(each for each in document["features"] if each["properties"].get("height_m") == 40.0)
    outline = Polygon(scenario.frame.to_local(church["geometry"]["coordinates"][0]))
    assert line.distance(outline) > 4.0 - 0.02
