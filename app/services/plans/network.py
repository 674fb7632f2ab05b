"""The network of segments round a plan's targets, as GeoJSON."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from app.services.documents import read_object
from app.services.errors import ConflictError, RefusedError
from app.services.plans.filed_mission import MEMBER
from app.services.terrain.rasters import stored_terrain
from planner.errors import Finding, InfeasibleError, ScenarioError
from planner.geojson import read_plan, read_scenario
from planner.geojson.network_writer import write_network
from planner.plan import Plan
from planner.scenario import Scenario
from planner.tasks.network.network import network_of


def network_text(
    plan_text: str, scenario_text: str, terrain_folder: Path | None, targets: Sequence[str]
) -> str:
    """The network of a stored plan; of some targets, or of all.

    Raises
    ------
    ConflictError
        The plan is of a mission file or a search, or its scenario's raster is gone.
    RefusedError
        A target is not of its scenario.
    """
    document = read_object(plan_text)
    if MEMBER in document:
        raise ConflictError("a mission file has no scenario, and so no segments round targets")
    terrains = None if terrain_folder is None else partial(stored_terrain, terrain_folder)
    try:
        scenario = read_scenario(read_object(scenario_text), terrains)
    except ScenarioError as error:
        raise ConflictError(f"the scenario cannot be read any more: {error}") from error
    told = network_document(scenario, read_plan(document), targets)
    return json.dumps(told, ensure_ascii=False, allow_nan=False, separators=(",", ":"))


def network_document(scenario: Scenario, plan: Plan, targets: Sequence[str]) -> Mapping[str, Any]:
    """The same of what was read; raises as ``network_text``."""
    if scenario.task != "collect":
        raise ConflictError(f"a {scenario.task} chooses no segments round targets: its ground is searched")
    names = [region.name for region in scenario.regions]
    unknown = [name for name in targets if name not in names]
    if unknown:
        known = ", ".join(names[:20])
        raise RefusedError(
            "the scenario has no such target",
            tuple(
                Finding(n, "unknown-target", "is none of its regions", f"One of {known}.") for n in unknown
            ),
        )
    strangers = {c.vehicle for c in plan.collects} - {aircraft.name for aircraft in scenario.aircraft}
    if strangers:
        raise ConflictError(f"the plan is not of this scenario: {', '.join(sorted(strangers))} is not in it")
    try:
        return write_network(scenario, network_of(scenario, plan, targets))
    except InfeasibleError as error:
        raise ConflictError(f"{error.feature} {error.message}") from error
