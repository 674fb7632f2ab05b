"""Everything wrong with a scenario, found before any planning."""

from __future__ import annotations

from typing import Any

from planner.coverage.neighbourhood import can_be_seen
from planner.environment.terrain import Terrains
from planner.errors import Finding, InfeasibleError, ScenarioError
from planner.geojson import read_scenario
from planner.routing.visible import sides_of
from planner.scenario import Scenario
from planner.sensors.view import sensing
from planner.vehicle.wind import in_wind


def findings(document: Any, terrains: Terrains | None = None) -> tuple[Finding, ...]:
    """Every finding about a scenario document, errors and warnings; plans nothing.

    Besides the rules of reading, each region must be seen by some pass that stays in the operating area.
    """
    try:
        scenario = read_scenario(document, terrains)
    except ScenarioError as error:
        return error.findings
    return scenario.warnings + unseeable(scenario)


def read_valid(document: Any, terrains: Terrains | None = None) -> Scenario:
    """Read a scenario and refuse it when a required region cannot be seen.

    Raises
    ------
    ScenarioError
        With every finding.
    """
    scenario = read_scenario(document, terrains)
    found = unseeable(scenario)
    if any(finding.severity == "error" for finding in found):
        raise ScenarioError(scenario.warnings + found)
    return scenario


def unseeable(scenario: Scenario) -> tuple[Finding, ...]:
    """A finding for each region that no pass can see: a warning where the region is not required.

    Where each can be seen by itself, also what hard zones, terrain and the wind forbid.
    """
    found = []
    # The paper's methods, asked for by name, know two passes at most.
    wide = scenario.method.coverage == "auto" and scenario.method.routing in ("auto", "joint")
    required = {region.name for region in scenario.regions if region.required}
    for region in scenario.regions:
        try:
            sensor, height_m = sensing(scenario, scenario.sensor_for(region), region.area)
            can_be_seen(region, sensor, height_m, scenario.area, wide=wide)
        except InfeasibleError as error:
            found.append(_finding(error, region.name in required))
    if wide and not any(finding.severity == "error" for finding in found):
        try:
            flown = in_wind(scenario)
            sides_of(flown, flown.aircraft[0])
        except InfeasibleError as error:
            found.append(_finding(error, True))
    return tuple(found)


def _finding(error: InfeasibleError, required: bool) -> Finding:
    return Finding(
        error.feature,
        f"not-seen-{error.constraint}" if error.constraint != "wind" else "wind-too-strong",
        error.message,
        error.relaxation,
        "error" if required else "warning",
    )
