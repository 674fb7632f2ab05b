"""Missions of plans that begin in the air are taken up late, and name nothing that is behind by then."""

from __future__ import annotations

import pytest
from pyproj import Geod

from mavlink.encoding.encode import TAKEN_UP_S, encode
from mavlink.wire.items import Command
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from tests.planner.geojson.proof_scenarios import aloft

GEOD = Geod(ellps="WGS84")


@pytest.mark.parametrize("heading_deg", [0.0, 90.0, 200.0, 290.0])
def test_no_place_is_named_that_is_behind_when_it_is_taken_up(heading_deg: float) -> None:
    """The first place is a waypoint that lies three seconds on or more along the line."""
    plan = make_plan(read_scenario(aloft(heading_deg=heading_deg)))
    path = plan.paths[0]
    near_m = TAKEN_UP_S * plan.vehicles[0].airspeed_m_s
    mission = encode(plan, plan.vehicles[0].name)
    placed = [
        item
        for item in mission.mission[1:]
        if item.command in (Command.NAV_WAYPOINT, Command.NAV_LOITER_TURNS)
    ]
    first = placed[0]
    assert first.command == Command.NAV_WAYPOINT
    along_m, best_m = 0.0, float("inf")
    reached_m = 0.0
    for here, there in zip(path.line, path.line[1:], strict=False):
        off_m = GEOD.inv(*there[:2], first.y / 1e7, first.x / 1e7)[2]
        reached_m += GEOD.inv(*here[:2], *there[:2])[2]
        if off_m < best_m:
            along_m, best_m = reached_m, off_m
    assert along_m >= near_m - 10.0
