"""Longitude and latitude in the wrong order: blamed where they are, said once."""

from __future__ import annotations

import json
import re
from typing import Any

from planner.validate import findings
from tests.planner.geojson.test_scenario_reader import BAD, refused
from tests.planner.scenarios import feature, small, square


def at(lon: float, lat: float, *more: dict[str, Any]) -> dict[str, Any]:
    """The small scenario moved there, and more features as they are."""
    document = small()

    def moved(value: Any) -> Any:
        if isinstance(value[0], list):
            return [moved(item) for item in value]
        return [value[0] + lon, value[1] + lat]

    for each in document["features"]:
        each["geometry"]["coordinates"] = moved(each["geometry"]["coordinates"])
    document["features"] += more
    return document


def test_swapped_axes_are_blamed_on_the_feature_that_has_them() -> None:
    """Under 90 degrees too: the feature whose place is beside the rest once its axes are exchanged."""
    wrong = feature("X", "roi", "Polygon", square(47.31, 8.52, 0.003))
    far = feature("Y", "roi", "Point", [60.0, 50.0])
    found = [f for f in findings(at(8.5, 47.3, wrong, far)) if f.severity == "error"]
    assert [(f.feature, f.rule) for f in found] == [("X", "axes-swapped"), ("Y", "extent-too-large")]
    assert "looks like latitude, longitude order" in found[0].fix
    # Between two features with one place each nobody can tell.
    two = at(8.5, 47.3)
    two["features"] = [two["features"][3], feature("B", "roi", "Point", [47.3, 8.5])]
    assert "extent-too-large" in refused(two)["scenario"]


def test_a_zone_with_swapped_axes_is_not_taken_for_one_far_off() -> None:
    """A far zone is left out; one that lies beside the rest with its axes exchanged refuses the scenario."""
    away = feature("away", "no_fly", "Polygon", square(12.0, 50.0, 0.003))
    wrong = feature("X", "no_fly", "Polygon", square(47.31, 8.52, 0.003))
    assert not [f for f in findings(at(8.5, 47.3, away)) if f.severity == "error"]
    found = [f for f in findings(at(8.5, 47.3, away, wrong)) if f.severity == "error"]
    assert [(f.feature, f.rule) for f in found] == [("X", "axes-swapped")]


def test_a_ring_of_swapped_axes_is_one_finding() -> None:
    """Every vertex breaks the same rule: it is said once, with the first of them and how many they are."""
    ring = [[lat, lon] for lon, lat in square(-117.7, 33.5, 0.003)[0]]
    found = [
        f for f in findings(at(-117.7, 33.5, feature("X", "roi", "Polygon", [ring]))) if f.feature == "X"
    ]
    assert [f.rule for f in found] == ["latitude-out-of-range"]
    assert "position 1, the first of 5 of 5" in found[0].message
    assert "looks like latitude, longitude order" in found[0].fix
    mixed = [[0, 0], [0, 91], [361, 0], [0, 92], ["x", 0], [0, 0]]
    found = [f for f in findings(small(feature("X", "roi", "Polygon", [mixed]))) if f.feature == "X"]
    assert [f.rule for f in found] == ["latitude-out-of-range", "longitude-out-of-range", "bad-position"]
    assert "has latitude 91" in found[0].message
    assert "position 2, the first of 2 of 6" in found[0].message


def test_no_finding_is_said_twice() -> None:
    """None of the bad inputs gives the same feature, rule and message more than once."""
    for document, _, _ in BAD.values():
        said = [(f.feature, f.rule, f.message) for f in findings(document)]
        assert len(said) == len(set(said)), said


def test_axes_exchanged_everywhere_are_said_so() -> None:
    """Without one valid position nothing can be placed; the cause is told where exchanging would mend it."""
    document = at(-117.7, 33.5)
    for each in document["features"]:
        text = json.dumps(each["geometry"]["coordinates"])
        pairs = re.sub(r"\[([-0-9.e]+), ([-0-9.e]+)\]", r"[\2, \1]", text)
        each["geometry"]["coordinates"] = json.loads(pairs)
    assert [(f.feature, f.rule) for f in findings(document)] == [("scenario", "axes-swapped")]
    for each in document["features"]:
        each["geometry"]["coordinates"] = [500.0, 500.0]
    assert [(f.feature, f.rule) for f in findings(document)] == [("scenario", "no-positions")]
