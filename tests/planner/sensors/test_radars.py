"""Radars by published figures are what a scenario may say."""

from __future__ import annotations

import pytest

from planner.geojson import read_scenario
from planner.sensors.radars import RADARS
from tests.planner.scenarios import small


@pytest.mark.parametrize("name", RADARS)
def test_each_is_read_as_it_stands(name: str) -> None:
    """Its entry is a sensor without findings, and has a source."""
    scenario = read_scenario(small(sensors=[RADARS[name].properties], altitude_m=3000.0))
    assert scenario.sensors[0].name == name
    assert scenario.sensors[0].resolution_m == RADARS[name].resolution_m
    assert [w for w in scenario.warnings if w.feature.startswith("sensor")] == []
    assert RADARS[name].source
