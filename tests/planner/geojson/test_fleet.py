"""What a scenario says of several aircraft: read into values, and what is wrong named with its fix."""

from __future__ import annotations

import copy
from typing import Any

import pytest

from planner.geojson import fleet
from planner.geojson.fields import Findings
from planner.validate import findings
from planner.wishes import DEFAULT_SEPARATION
from tests.planner.scenarios import feature, small, square

Document = dict[str, Any]


def of_two(*more: Document, second: Document | None = None, **members: Any) -> Document:
    """Two aircraft over the small scenario."""
    document = small(*more, **members)
    (one,) = document["vehicles"]
    document["vehicles"] = [one, one | {"name": "second"} | (second or {})]
    return document


def of_region(**properties: Any) -> Document:
    document = copy.deepcopy(small())
    document["features"][0]["properties"] |= properties
    return document


BASE = feature("pier", "base", "Point", [0.02, -0.02])
INSIDE = {"lon_deg": 0.02, "lat_deg": -0.02, "height_m": 100.0, "heading_deg": 0.0}
ZONE = feature("N", "no_fly", "Polygon", square(0.015, -0.025, 0.01))


@pytest.mark.parametrize(
    ("document", "where", "rule"),
    [
        (of_region(time_window_s=[900.0, 300.0]), "A", "window-empty"),
        (of_region(time_window_s=[300.0, 300.0]), "A", "window-empty"),
        (of_region(time_window_s=[300.0]), "A", "bad-value"),
        (of_region(time_window_s=[-1.0, 300.0]), "A", "bad-value"),
        (of_region(revisits=3, revisit_after_s=200.0, time_window_s=[0.0, 400.0]), "A", "window-too-short"),
        (of_region(revisit_after_s=-1.0, revisits=2), "A", "out-of-range"),
        (of_two(second={"base": "quay"}), "vehicle second", "unknown-base"),
        (of_two(ZONE, second={"in_flight": INSIDE}), "vehicle second", "in-flight-in-hard-zone"),
        (of_two(BASE, ZONE, second={"in_flight": INSIDE}), "vehicle second", "in-flight-in-hard-zone"),
        (of_two(BASE, ZONE, second={"base": "pier"}), "pier", "base-in-hard-zone"),
        (of_two(second={"name": "uav"}), "vehicle uav", "duplicate-id"),
        (of_two(separation={"horizontal_m": -1.0}), "separation", "out-of-range"),
        (of_two(separation={"horizontal_m": 100.0, "sideways_m": 3.0}), "separation", "unknown-property"),
        (of_two(separation=50.0), "scenario", "bad-value"),
        (of_two(second={"sensors": ["eye"]}), "vehicle second", "unknown-sensor"),
        (of_two(second={"sensors": []}), "vehicle second", "bad-value"),
        (of_two(second={"finish": "return"}), "vehicle second", "finish-not-apart"),
        (of_two(second={"batteries": 0}), "vehicle second", "out-of-range"),
    ],
)
def test_what_is_wrong_with_a_fleet_is_named(document: Document, where: str, rule: str) -> None:
    """Each is refused with the feature, the rule and a fix."""
    said = [f for f in findings(document) if (f.feature, f.rule) == (where, rule)]
    assert said, findings(document)
    assert said[0].fix
    assert said[0].severity == "error"


def test_a_target_that_no_aircraft_can_meet_is_named() -> None:
    """A region whose sensor nobody has on board is refused; with one that has it, it is not."""
    document = of_two(second={"sensors": ["eye"]})
    document["vehicles"][0]["sensors"] = ["eye"]
    document["sensors"].append({**document["sensors"][0], "name": "eye"})
    assert ("A", "sensor-not-on-board") in {(f.feature, f.rule) for f in findings(document)}
    document["vehicles"][1]["sensors"] = ["eye", "sar"]
    assert "sensor-not-on-board" not in {f.rule for f in findings(document)}


def test_separation_has_defaults_for_what_is_not_said() -> None:
    """One distance alone is enough; none is none."""
    found = Findings()
    said = fleet.read_separation({"vertical_m": 50.0}, found)
    assert said is not None
    assert (said.horizontal_m, said.vertical_m) == (DEFAULT_SEPARATION.horizontal_m, 50.0)
    assert fleet.read_separation(None, found) is None
    assert not found.all()
