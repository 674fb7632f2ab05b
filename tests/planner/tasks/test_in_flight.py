"""Flights that begin in the air: on from place, course and height, home and limits as they were."""

from __future__ import annotations

import math
from copy import deepcopy
from typing import Any

import pyproj
import pytest

from app.routers.bodies import EXAMPLE
from mavlink.encoding.encode import encode
from mavlink.wire.items import Command
from planner.errors import ScenarioError
from planner.geojson import read_plan, read_scenario, write_plan
from planner.pipeline import make_plan
from planner.plan import Plan

GEOD = pyproj.Geod(ellps="WGS84")


def _aloft(**place: Any) -> dict[str, Any]:
    document = deepcopy(EXAMPLE)
    document["vehicles"][0] |= {"in_flight": place}
    return document


def _course_deg(plan: Plan) -> float:
    """Of the first metres of the path."""
    (lon0, lat0, _), (lon1, lat1, _) = next(
        (a, b) for a, b in zip(plan.paths[0].line, plan.paths[0].line[1:], strict=False) if a[:2] != b[:2]
    )
    return GEOD.inv(lon0, lat0, lon1, lat1)[0] % 360.0


@pytest.mark.parametrize(("height_m", "heading_deg"), [(60.0, 10.0), (900.0, 200.0)])
def test_the_flight_goes_on_from_where_it_is(height_m: float, heading_deg: float) -> None:
    """Low and climbing, high and sinking: no take-off, all regions seen, the judge content."""
    start = next(f for f in EXAMPLE["features"] if f["properties"]["role"] == "start")
    lon_deg, lat_deg = (value + 0.01 for value in start["geometry"]["coordinates"][:2])
    document = _aloft(lon_deg=lon_deg, lat_deg=lat_deg, height_m=height_m, heading_deg=heading_deg)
    plan = make_plan(read_scenario(document))
    assert plan.hard_violations == ()
    (path,) = plan.paths
    assert GEOD.inv(lon_deg, lat_deg, *path.line[0][:2])[2] < 0.1
    home_m = plan.vehicles[0].home_altitude_m
    assert home_m is not None
    assert path.line[0][2] - home_m == pytest.approx(height_m, abs=0.01)
    # The first edge may be a chord of an arc, 10 m of a turn of 100 m or more.
    assert abs((_course_deg(plan) - heading_deg + 180.0) % 360.0 - 180.0) < math.degrees(0.06)
    assert path.phases[0].kind == "mission"
    assert min(plan.metrics.coverage.values()) > 0.9999
    assert plan.home == pytest.approx(tuple(start["geometry"]["coordinates"][:2]), abs=1e-7)
    again = read_plan(write_plan(plan))
    assert again.vehicles == plan.vehicles
    mission = encode(again).mission
    commands = {item.command for item in mission}
    assert Command.NAV_TAKEOFF not in commands
    # Heights are over home, which is not where the path begins.
    highest_m = max(item.z for item in mission if item.command == Command.NAV_WAYPOINT)
    assert highest_m == pytest.approx(max(place[2] for place in path.line) - home_m, abs=0.5)


@pytest.mark.parametrize(
    ("place", "rule"),
    [
        ({"lon_deg": -117.7, "lat_deg": 33.5, "height_m": 100.0}, "missing-property"),
        ({"lon_deg": -117.7, "lat_deg": 33.5, "height_m": 0.0, "heading_deg": 0.0}, "out-of-range"),
        ({"lon_deg": 200.0, "lat_deg": 33.5, "height_m": 100.0, "heading_deg": 0.0}, "out-of-range"),
        (
            {"lon_deg": -117.7, "lat_deg": 33.5, "height_m": 9.0, "heading_deg": 0.0, "x": 1},
            "unknown-property",
        ),
    ],
)
def test_a_place_that_is_none_is_refused(place: dict[str, Any], rule: str) -> None:
    """Wings without a course, on the ground, off the earth, with a property that nobody knows."""
    with pytest.raises(ScenarioError) as caught:
        read_scenario(_aloft(**place))
    assert rule in {finding.rule for finding in caught.value.findings}


def test_what_flies_already_changes_no_battery() -> None:
    """Several flights begin on the ground."""
    document = _aloft(lon_deg=-117.7, lat_deg=33.5, height_m=100.0, heading_deg=0.0)
    document["vehicles"][0]["batteries"] = 2
    with pytest.raises(ScenarioError) as caught:
        read_scenario(document)
    assert any("flies already" in finding.message for finding in caught.value.findings)
