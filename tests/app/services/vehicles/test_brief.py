"""What is known of a plan at a vehicle: as much as the whole plan tells, without what makes it large."""

from __future__ import annotations

import json
import pickle
from pathlib import Path

import pytest

from app.routers.bodies import EXAMPLE
from app.services.plans.missions import MissionChoice, encode_plan, plan_of
from app.services.vehicles.brief import brief_of, mission_needs, start_of
from app.services.vehicles.pointing import pointing_findings
from app.services.vehicles.preflight import Observed, preflight
from mavlink.state.telemetry import VehicleState


@pytest.mark.parametrize("gimbal", [None, "manager:tilt=30"])
def test_a_brief_is_judged_as_the_whole_plan(plan_file: Path, gimbal: str | None) -> None:
    """Pre-flight and gimbal findings are the same of both; the brief that crosses processes is smaller."""
    text, scenario = plan_file.read_text(), json.loads(json.dumps(EXAMPLE))
    choice = MissionChoice(None, "ardupilot", None, gimbal)
    brief = pickle.loads(pickle.dumps(brief_of(text, json.dumps(scenario), choice)))
    plan = plan_of(text)
    mission = encode_plan(plan, choice)
    needs = mission_needs(plan, scenario, mission, choice)
    assert (brief.mission, brief.needs) == (mission, needs)
    state = VehicleState(
        connected=True, battery_percent=40.0, lon_deg=-117.75, lat_deg=33.49, home_altitude_amsl_m=20.0
    )
    observed = Observed(state, {"mission": [], "fence": None}, {"WP_RADIUS": 5.0})
    assert preflight("p", brief.plan, brief.scenario, brief.mission, brief.needs, observed) == preflight(
        "p", plan, scenario, mission, needs, observed
    )
    assert pointing_findings(brief.plan, brief.scenario, mission, needs) == pointing_findings(
        plan, scenario, mission, needs
    )
    assert len(pickle.dumps(brief.plan)) < 0.5 * len(pickle.dumps(plan))


def test_a_start_is_found_where_there_is_one() -> None:
    """Longitude and latitude of the feature with that role; None of a scenario without."""
    start = next(f for f in EXAMPLE["features"] if f["properties"]["role"] == "start")
    assert start_of(json.dumps(EXAMPLE)) == tuple(start["geometry"]["coordinates"][:2])
    assert start_of('{"features": [{"properties": null}]}') is None
