"""Asks a vehicle for what the pre-flight check must know: what it holds, and its parameters."""

from __future__ import annotations

import contextlib
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from app.services.errors import LinkError, RefusedError
from app.services.plans.missions import PARTS, PartName
from app.services.vehicles.brief import Brief
from app.services.vehicles.preflight import Observed, Preflight, preflight
from app.services.vehicles.uploads import UploadReport, comparing
from mavlink.dialects.mission import Mission
from mavlink.errors import TransferFailedError
from mavlink.rules.firmware import called, still_to_ask
from mavlink.rules.table import (
    Needs,
    ParameterFinding,
    judge_parameters,
    names_to_read,
    unanswered,
)
from mavlink.station.client import VehicleClient
from mavlink.transfer.parameters import Parameter
from planner.errors import Finding


@dataclass(frozen=True, slots=True)
class ParameterReport:
    """Parameters read, names without answer, and what is not as a plan needs it."""

    values: tuple[Parameter, ...]
    missing: tuple[str, ...]
    findings: tuple[ParameterFinding, ...]


async def read_parameters(
    client: VehicleClient, names: Sequence[str], judged_by: tuple[Mission, Needs] | None
) -> ParameterReport:
    """Read parameters, and those a mission needs too.

    Raises
    ------
    RefusedError
        Nothing is asked for, or a name cannot be one.
    LinkError
        None was answered.
    """
    wanted = list(dict.fromkeys(names))
    if judged_by is not None:
        mission, needs = judged_by
        wanted += [
            n for n in names_to_read(mission.autopilot, mission.vehicle_type, needs) if n not in wanted
        ]
    if not wanted:
        message = "no parameter is named"
        raise RefusedError(message, (Finding("name", "name-missing", message, "send name or plan_id"),))
    try:
        found = await _read(client, wanted)
    except ValueError as error:
        finding = Finding("name", "parameter-name", str(error), "write e.g. name=WP_RADIUS")
        raise RefusedError(str(error), (finding,)) from error
    except TransferFailedError as error:
        raise LinkError(str(error)) from error
    findings: tuple[ParameterFinding, ...] = ()
    if judged_by is not None:
        values = {name: parameter.value for name, parameter in found.items()}
        findings = judge_parameters(mission.autopilot, mission.vehicle_type, needs, values)
    return ParameterReport(tuple(found.values()), unanswered(wanted, found), findings)


async def _read(client: VehicleClient, names: Sequence[str]) -> dict[str, Parameter]:
    """Read parameters as the vehicle's firmware calls them; those unanswered as other versions do, too."""
    first = called(names, client.state.autopilot, client.state.firmware)
    try:
        found = await client.read_parameters(first)
    except TransferFailedError:
        if first == tuple(names):
            raise
        found = {}
    others = still_to_ask(names, first, found)
    if others:
        with contextlib.suppress(TransferFailedError):
            found |= await client.read_parameters(others)
    return found


async def inspect(
    client: VehicleClient,
    plan_id: str,
    brief: Brief,
    report: UploadReport | None = None,
) -> Preflight:
    """Ask the vehicle, and judge; one that is not connected is not asked.

    Parameters
    ----------
    report
        Of an upload just made, whose read-back needs no repetition.

    Raises
    ------
    NotConnectedError, BusyError
        It vanished meanwhile, or something else is under way.
    """
    plan, scenario, mission, needs = brief.plan, brief.scenario, brief.mission, brief.needs
    if not client.state.connected:
        return preflight(plan_id, plan, scenario, mission, needs, Observed(client.state, {}, None))
    held: dict[PartName, list[Any] | None] = {}
    for part in ("mission", "fence") if mission.fence else ("mission",):
        held[part] = await _held(client, mission, part, report)
    names = names_to_read(mission.autopilot, mission.vehicle_type, needs)
    values: dict[str, Parameter] | None = None
    with contextlib.suppress(TransferFailedError):
        values = await _read(client, names)
    observed = Observed(
        client.state,
        held,
        None if values is None else {name: parameter.value for name, parameter in values.items()},
        unanswered(names, values or {}),
    )
    return preflight(plan_id, plan, scenario, mission, needs, observed)


async def _held(
    client: VehicleClient, mission: Mission, part: PartName, report: UploadReport | None
) -> list[Any] | None:
    """Differences between what is meant and what is held, in words; None when it could not be read."""
    if report is not None and part in report.parts:
        known = report.parts[part].differences
        return None if known is None else [difference["message"] for difference in known]
    try:
        held = await client.download(PARTS[part])
    except TransferFailedError:
        return None
    return list(comparing(mission.dialect)(mission.items_of(PARTS[part]), held))
