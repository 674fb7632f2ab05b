"""Everything wrong with a scenario, found before any planning."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from typing import Any, Literal

from planner.airspace.terrain import Terrains
from planner.coverage.registry import family_of
from planner.coverage.seen import check_visible
from planner.errors import Finding, InfeasibleError, ScenarioError
from planner.geojson import read_scenario
from planner.scenario import Scenario
from planner.tasks.setting import Setting, seeing
from planner.tasks.sought import refuse_unsearchable
from planner.tasks.urban import cut_by_obstacles, lanes_cut, refuse_filled, refuse_out_of_sight
from planner.vehicle.aircraft import Aircraft
from planner.vehicle.model import FlightModel

#: From so many passes on planning takes tens of seconds, then minutes.
MANY_PASSES = 120
#: More passes over one region are not planned.
MOST_PASSES = 1000


def findings(
    document: Any,
    terrains: Terrains | None = None,
    besides: Callable[[Scenario], Iterable[Finding]] | None = None,
) -> tuple[Finding, ...]:
    """Every finding about a scenario document, errors and warnings; plans nothing.

    Besides the rules of reading, each region must be seen by some pass that stays in the operating area; and
    ``besides`` may have more to say of the scenario.
    """
    try:
        scenario = read_scenario(document, terrains)
    except ScenarioError as error:
        return error.findings
    more = () if besides is None else tuple(besides(scenario))
    return scenario.warnings + more + unseeable(scenario) + laborious(scenario)


def read_valid(document: Any, terrains: Terrains | None = None) -> Scenario:
    """Read a scenario and refuse it when a required region cannot be seen, or takes too many passes.

    Raises
    ------
    ScenarioError
        With every finding.
    """
    scenario = read_scenario(document, terrains)
    found = unseeable(scenario) + laborious(scenario)
    if any(finding.severity == "error" for finding in found):
        raise ScenarioError(scenario.warnings + found)
    return scenario


def unseeable(scenario: Scenario) -> tuple[Finding, ...]:
    """A finding for each region that no pass can see: a warning where the region is not required.

    Where each can be seen by itself, also what hard zones, terrain and the wind forbid. Of several aircraft
    one that sees a region is enough.
    """
    if scenario.task == "search":
        return _unsearchable(scenario)
    if len(scenario.aircraft) > 1:
        return _unseen_by_all(scenario)
    found = []
    # The paper's methods, asked for by name, know two passes at most.
    wide = scenario.method.coverage == "auto" and scenario.method.routing in ("auto", "joint")
    required = {region.name for region in scenario.regions if region.required}
    settle_m = scenario.aircraft[0].in_wind(scenario.wind.speed_m_s).settle_m
    # What takes passes without number is not looked at pass by pass, nor held against an area or zones.
    of_labour = laborious(scenario)
    endless = {finding.feature for finding in of_labour if finding.severity == "error"}
    level, suite, airspace = scenario.level, scenario.suite, scenario.airspace
    for region in scenario.regions:
        if region.name in endless:
            continue
        try:
            sensor, height_m = suite.over(region.sensor, region.area, airspace, level.of(region))
            family_of(sensor).check_seen(region, sensor, height_m, scenario.area, settle_m, wide=wide)
        except InfeasibleError as error:
            found.append(_finding(error, region.name in required))
    said = (*found, *of_labour)
    if wide and not any(finding.severity == "error" for finding in said):
        try:
            asked = seeing(scenario, Setting.of(scenario))
            if (
                scenario.task == "collect"
                and len(scenario.aircraft) == 1
                and (cut_by_obstacles(asked) or lanes_cut(asked))
            ):
                refuse_filled(asked)
                refuse_out_of_sight(asked)
            else:
                check_visible(asked, asked.surroundings())
        except InfeasibleError as error:
            found.append(_finding(error, True))
    return tuple(found)


def _unseen_by_all(scenario: Scenario) -> tuple[Finding, ...]:
    """What is said of a region by each aircraft that has its sensor on board; what else is said by any."""
    names = {region.name for region in scenario.regions}
    said: dict[str, list[tuple[Finding, ...]]] = {}
    found: list[Finding] = []
    grounded = {
        name: error for aircraft in scenario.aircraft for name, error in _grounded(scenario, aircraft)
    }
    if len(grounded) == len(scenario.aircraft):
        return tuple(_finding(error, True) for error in grounded.values())
    for aircraft in scenario.aircraft:
        if aircraft.name in grounded:
            # Others may do its work: whether they can is for planning to find.
            found.append(_finding(grounded[aircraft.name], aircraft.aloft is not None))
            continue
        alone = scenario.of_one(aircraft)
        own = unseeable(alone)
        found += [finding for finding in own if finding.feature not in names]
        for region in alone.regions:
            about = tuple(finding for finding in own if finding.feature == region.name)
            said.setdefault(region.name, []).append(about)
    for each in said.values():
        found += each[0] if all(each) else ()
    return tuple(dict.fromkeys(found))


def _grounded(scenario: Scenario, aircraft: Aircraft) -> Iterator[tuple[str, InfeasibleError]]:
    """Its name and why, of an aircraft that the wind keeps on the ground."""
    try:
        FlightModel.of(aircraft, scenario.wind, scenario.level.amsl_m - scenario.level.height_m)
    except InfeasibleError as error:
        yield aircraft.name, error


def _unsearchable(scenario: Scenario) -> tuple[Finding, ...]:
    """What forbids a search: nothing to be seen, or no way to its end within the limits.

    Of several aircraft one that searches is enough: what keeps others at home is a warning.
    """
    if len(scenario.aircraft) > 1:
        alone = [scenario.of_one(aircraft) for aircraft in scenario.aircraft]
        said = [_unsearchable(one) for one in alone if one.regions]
        severity: Literal["error", "warning"] = "error" if all(said) else "warning"
        return tuple(dict.fromkeys(replace(each, severity=severity) for own in said for each in own))
    try:
        refuse_unsearchable(scenario)
    except InfeasibleError as error:
        rule = error.constraint if error.constraint != "wind" else "wind-too-strong"
        return (Finding(error.feature, rule, error.message, error.relaxation, "error"),)
    return ()


def laborious(scenario: Scenario) -> tuple[Finding, ...]:
    """What takes more passes than can be planned, or than are planned soon; most often a slip of height.

    A search flies no more of them than it has energy for.
    """
    if scenario.task == "search":
        return ()
    found, passes, narrowest_m = [], 0, math.inf
    level, suite, airspace = scenario.level, scenario.suite, scenario.airspace
    for region in scenario.regions:
        try:
            sensor, height_m = suite.over(region.sensor, region.area, airspace, level.of(region))
        except InfeasibleError:
            continue
        fewest, widest_m = family_of(sensor).fewest_passes(region, sensor, height_m)
        passes += fewest * region.revisits
        narrowest_m = min(narrowest_m, widest_m)
        if fewest > MOST_PASSES:
            said = f"{height_m:g} m up a pass sees {widest_m:.3g} m of ground: {fewest} passes"
            found.append(Finding(region.name, "too-many-passes", said, _HIGHER, "error"))
    if passes > MANY_PASSES and not found:
        said = f"takes at least {passes} passes, the narrowest {narrowest_m:.3g} m wide: planning takes long"
        found.append(Finding("scenario", "many-passes", said, _HIGHER, "warning"))
    return tuple(found)


_HIGHER = "Fly higher (altitude_m), widen the beam, or cut the regions"


def _finding(error: InfeasibleError, required: bool) -> Finding:
    return Finding(
        error.feature,
        f"not-seen-{error.constraint}" if error.constraint != "wind" else "wind-too-strong",
        error.message,
        error.relaxation,
        "error" if required else "warning",
    )
