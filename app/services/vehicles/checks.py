"""Vehicles asked whether they are ready to fly a plan; nothing in them is changed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from app.services.plans.library import PlanLibrary
from app.services.plans.missions import MissionChoice
from app.services.vehicles.brief import Brief, brief_of
from app.services.vehicles.inspection import ParameterReport, inspect, read_parameters
from app.services.vehicles.preflight import Preflight
from app.services.vehicles.vehicle import Vehicle
from mavlink.dialects.mission import Mission


class Checks:
    """Pre-flight checks and parameters."""

    def __init__(self, plans: PlanLibrary) -> None:
        self._plans = plans

    async def preflight(self, vehicle: Vehicle, plan_id: str, choice: MissionChoice) -> Preflight:
        """Ask the vehicle whether it is ready to fly a plan; changes nothing in it.

        What is read back for it also tells whether the vehicle still holds what it was sent.
        """
        async with vehicle.turns.busy(f"pre-flight check for plan {plan_id}"):
            choice = for_vehicle(vehicle, choice)
            brief = await self._brief(plan_id, choice)
            report = await inspect(vehicle.client, plan_id, brief)
            asked = replace(choice, payload=brief.payload)
            if report.mission_held is not None and _as_sent(vehicle, plan_id, brief.mission, asked):
                vehicle.found(report.mission_held)
                vehicle.tell()
            return report

    async def parameters(
        self, vehicle: Vehicle, names: Sequence[str], plan_id: str | None, choice: MissionChoice
    ) -> ParameterReport:
        """Parameters by name; with a plan also those it needs, judged.

        Raises
        ------
        RefusedError
            A name cannot be one, or neither names nor a plan are given.
        LinkError
            The vehicle is not there, or answers about none of them.
        """
        async with vehicle.turns.busy("reading parameters"):
            if plan_id is None:
                return await read_parameters(vehicle.client, names, None)
            brief = await self._brief(plan_id, for_vehicle(vehicle, choice))
            return await read_parameters(vehicle.client, names, (brief.mission, brief.needs))

    async def _brief(self, plan_id: str, choice: MissionChoice) -> Brief:
        plan_text = await self._plans.plan_text(plan_id)
        return await self._plans.worked(brief_of, plan_text, await self._plans.scenario_text(plan_id), choice)


def _as_sent(vehicle: Vehicle, plan_id: str, mission: Mission, choice: MissionChoice) -> bool:
    """Whether a mission asked about is the one last sent, payload, gimbal, arcs and all."""
    sent = vehicle.upload
    return (
        sent is not None
        and vehicle.sent is not None
        and vehicle.sent.plan_id == sent.plan_id == plan_id
        and sent.choice.held(plan_id, sent.plan_vehicle) == choice.held(plan_id, mission.vehicle)
        and "mission" in sent.parts
    )


def for_vehicle(vehicle: Vehicle, choice: MissionChoice) -> MissionChoice:
    """The choice, encoded for the autopilot that is really there, and for its kind where a file says none."""
    autopilot, kind = vehicle.state.autopilot, vehicle.state.type
    if kind != "other":
        choice = replace(choice, vehicle_type=kind)
    if choice.autopilot is not None or autopilot == "generic":
        return choice
    return replace(choice, autopilot=autopilot)
