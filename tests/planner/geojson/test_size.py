"""Scenarios that are too large are refused by name, in no time, whatever shapes make them so."""

from __future__ import annotations

import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner.errors import ScenarioError
from planner.geojson import read_scenario
from planner.geojson.fields import Findings
from planner.geojson.size import MOST_CORNERS, MOST_FEATURES, MOST_OF_A_REGION, MOST_OF_ANOTHER, check_size
from tests.planner.scenarios import small


def ring(corners: int) -> list[list[float]]:
    """A circle of so many positions, closed."""
    angles = [math.tau * k / (corners - 1) for k in range(corners - 1)]
    places = [[10.0 + 0.01 * math.cos(a), 50.0 + 0.01 * math.sin(a)] for a in angles]
    return [*places, places[0]]


def feature(role: Any, corners: int, name: str = "F") -> dict[str, Any]:
    """A polygon."""
    shape = {"type": "Polygon", "coordinates": [ring(corners)]}
    return {"type": "Feature", "id": name, "properties": {"role": role}, "geometry": shape}


def rules(features: list[Any]) -> list[tuple[str, str]]:
    """Feature and rule of each finding."""
    findings = Findings()
    fits = check_size(features, findings)
    found = [(finding.feature, finding.rule) for finding in findings.all()]
    assert fits == (not found)
    return found


@pytest.mark.parametrize(
    ("role", "most"), [("roi", MOST_OF_A_REGION), ("no_fly", MOST_OF_ANOTHER), (["roi"], MOST_OF_ANOTHER)]
)
def test_a_shape_has_so_many_corners_at_most(role: Any, most: int) -> None:
    """One more is refused, with its name; regions cost more than zones."""
    assert rules([feature(role, most)]) == []
    assert rules([feature(role, most + 1)]) == [("F", "too-many-corners")]


def test_all_shapes_together_are_limited_too() -> None:
    """Many of a size that each may have, and many of none."""
    count = MOST_CORNERS // MOST_OF_ANOTHER
    full = [feature("no_fly", MOST_OF_ANOTHER, f"Z{number}") for number in range(count)]
    assert rules(full) == []
    assert rules([*full, feature("no_fly", 4)]) == [("scenario", "too-many-corners")]
    assert rules([{}] * (MOST_FEATURES + 1)) == [("scenario", "too-many-features")]


def test_a_scenario_is_refused_before_it_is_worked_on() -> None:
    """The reader says so and nothing else."""
    document = small()
    document["features"].append(feature("roi", 100_000, "circle"))
    with pytest.raises(ScenarioError) as refused:
        read_scenario(document)
    assert [(f.feature, f.rule) for f in refused.value.findings] == [("circle", "too-many-corners")]


JSON = st.recursive(
    st.none() | st.booleans() | st.floats(allow_nan=False) | st.text(max_size=3),
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.dictionaries(
            st.sampled_from(["geometry", "coordinates", "geometries", "properties", "role"]), inner
        )
    ),
    max_leaves=12,
)


@given(st.lists(JSON, max_size=4))
def test_junk_is_small(features: list[Any]) -> None:
    """Whatever stands where features are meant is counted, or not, and nothing fails of it."""
    assert rules(features) == []
