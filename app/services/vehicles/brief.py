"""What has to be known of a plan at a vehicle, made where texts may take their time to be read."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from app.services.documents import read_object
from app.services.plans.missions import MissionChoice, mission_of, plan_of, sent
from app.services.vehicles.preflight import settle_m
from mavlink.dialects.mission import Mission
from mavlink.encoding.payload import Payload, parse_payload
from mavlink.encoding.payload_in import payload_in
from mavlink.encoding.trigger import payload_of, specified
from mavlink.rules.table import Needs, needs_of
from planner.plan import LonLat, Plan


@dataclass(frozen=True, slots=True)
class Brief:
    """A plan for one vehicle.

    Parameters
    ----------
    plan
        Without its lines and the ground it sees, which make it large.
    scenario
        As it was posted, of its features the start alone.
    payload
        How the sensor is switched, its spacing filled in where the plan's cameras say it; None for the usual
        output.
    """

    plan: Plan
    scenario: dict[str, Any]
    mission: Mission
    needs: Needs
    payload: str | None = None


def brief_of(plan_text: str, scenario_text: str, choice: MissionChoice) -> Brief:
    """Read both, encode the mission, or fit that of a file; raises as ``missions.mission_of``.

    Of a plan of several flights it is the brief of one.
    """
    plan, scenario = plan_of(plan_text), read_object(scenario_text)
    mission = sent(mission_of(plan_text, choice))
    if mission.declared is None:
        plan = plan.of(mission.vehicle, choice.sortie)
    needs = mission_needs(plan, scenario, mission, choice)
    payload = choice.payload if mission.declared else specified(plan, mission.vehicle, choice.payload)
    paths = tuple(replace(path, line=(), segments=()) for path in plan.paths)
    plan = replace(plan, paths=paths, transits=(), footprints=(), uncovered=())
    starts = [feature for feature in scenario.get("features") or () if _role(feature) == "start"]
    return Brief(plan, scenario | {"features": starts}, mission, needs, payload)


def mission_needs(plan: Plan, scenario: Mapping[str, Any], mission: Mission, choice: MissionChoice) -> Needs:
    """What a mission needs of its vehicle."""
    wanted = None if choice.payload is None else parse_payload(choice.payload)
    payload: Payload | None
    if mission.declared is None:
        payload = payload_of(plan, mission.vehicle, wanted)
    else:
        payload = payload_in(mission) if wanted is None else wanted
    return needs_of(plan, mission, payload, settle_m(scenario, mission.vehicle))


def first_vehicle(plan_text: str) -> str:
    """The name of a plan's first vehicle."""
    return plan_of(plan_text).vehicles[0].name


def start_of(scenario_text: str) -> LonLat | None:
    """Where a scenario's flights begin; None where it does not say."""
    for feature in read_object(scenario_text)["features"]:
        if _role(feature) == "start":
            lon_deg, lat_deg = feature["geometry"]["coordinates"][:2]
            return float(lon_deg), float(lat_deg)
    return None


def _role(feature: Mapping[str, Any]) -> Any:
    return (feature.get("properties") or {}).get("role")
