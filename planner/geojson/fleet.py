"""What a scenario says of several aircraft: where each starts, what is on board, what they keep apart."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from planner.geojson.features import RawFeature
from planner.geojson.fields import Fields, Findings
from planner.route import Terminal
from planner.scenario import Scenario
from planner.vehicle.aircraft import Aircraft
from planner.wishes import DEFAULT_SEPARATION, Separation


def read_separation(raw: Any, findings: Findings) -> Separation | None:
    """Member ``separation``; None where it is absent."""
    if raw is None:
        return None
    if not isinstance(raw, dict):
        findings.error(
            "scenario",
            "bad-value",
            "separation is not an object",
            'Write separation: {"horizontal_m": 100, "vertical_m": 30}.',
        )
        return None
    fields = Fields("separation", raw, findings)
    horizontal_m = fields.number("horizontal_m", DEFAULT_SEPARATION.horizontal_m, minimum=0.0)
    vertical_m = fields.number("vertical_m", DEFAULT_SEPARATION.vertical_m, minimum=0.0)
    fields.refuse_unknown()
    if horizontal_m is None or vertical_m is None:
        return None
    return Separation(horizontal_m, vertical_m)


def start_of(
    starts: Sequence[Terminal],
    bases: Sequence[Terminal],
    aircraft: Sequence[Aircraft | None],
    raws: Sequence[RawFeature],
    findings: Findings,
) -> Terminal | None:
    """Where the flight starts: that of the aircraft that name no base, else the first one's base."""
    known = {base.name: base for base in bases}
    named = [(one.name, one.base) for one in aircraft if one is not None and one.base is not None]
    missing = [(name, base) for name, base in named if base not in known]
    for name, base in missing:
        findings.error(
            f"vehicle {name}",
            "unknown-base",
            f"starts from the base {base!r}, which is not here",
            f"Use one of: {', '.join(sorted(known))}." if known else "Add a Point of role base.",
        )
    if missing:
        return None
    if len(named) == len(aircraft) and named and (len(aircraft) == 1 or not starts):
        return known[str(named[0][1])]
    if starts:
        return starts[0]
    if len(bases) == 1:
        return bases[0]
    if not any(raw.role == "start" for raw in raws):
        findings.error("scenario", "no-start", "has no start", "Add a Point of role start.")
    return None


#: Weights of the objective that count among several flights alone.
OF_FLEETS = ("last_landing", "total_time", "priority")


def check_fleet(scenario: Scenario, bases: Sequence[Terminal], objective: Any, findings: Findings) -> None:
    """Bases that nobody uses, sensors on board, and visits that no window leaves the time for."""
    for name in OF_FLEETS if isinstance(objective, dict) and not scenario.is_fleet else ():
        if objective.get(name) is not None:
            findings.warning(
                "objective", "not-used", f"{name} weighs several flights, and there is one", "Remove it."
            )
    known = {base.name for base in bases}
    for aircraft in scenario.aircraft:
        for name in aircraft.end_bases or ():
            if name not in known:
                findings.error(
                    f"vehicle {aircraft.name}",
                    "unknown-base",
                    f"may land at the base {name!r}, which is not here",
                    f"Use some of: {', '.join(sorted(known))}." if known else "Add a Point of role base.",
                )
        if aircraft.end_bases is not None and _circles(aircraft):
            findings.error(
                f"vehicle {aircraft.name}",
                "finish-not-apart",
                f"ends its flight circling (finish {aircraft.finish}), and is to land at a base",
                "Set finish to land, or leave it out.",
            )
    used = {end.position for end in scenario.terminals()}
    for base in bases:
        if base.position not in used:
            findings.warning(
                base.name, "not-used", "is a base that no vehicle starts from or lands at", "Remove it."
            )
    sensors = [sensor.name for sensor in scenario.sensors]
    for aircraft in scenario.aircraft:
        for name in aircraft.sensors or ():
            if name not in sensors:
                findings.error(
                    f"vehicle {aircraft.name}",
                    "unknown-sensor",
                    f"has the sensor {name!r} on board, which is not among the scenario's",
                    f"Use some of: {', '.join(sensors)}.",
                )
        if (len(scenario.aircraft) > 1 or aircraft.batteries > 1) and _circles(aircraft):
            findings.error(
                f"vehicle {aircraft.name}",
                "finish-not-apart",
                f"ends its flight circling (finish {aircraft.finish}), where others take off and land",
                "Set finish to land, or leave it out.",
            )
        limits = (aircraft.energy_wh, aircraft.max_range_m, aircraft.max_flight_time_s)
        if aircraft.batteries > 1 and not any(limits):
            findings.warning(
                f"vehicle {aircraft.name}",
                "not-used",
                f"batteries is {aircraft.batteries}, and nothing limits one flight",
                "Add energy_wh, max_range_m or max_flight_time_s.",
            )
    for region in scenario.regions:
        asked = scenario.suite.first if region.sensor is None else region.sensor
        if asked in sensors and not any(aircraft.carries(asked) for aircraft in scenario.aircraft):
            findings.error(
                region.name,
                "sensor-not-on-board",
                f"is to be seen with {asked}, which no aircraft has on board",
                f"Add {asked} to the sensors of a vehicle, or see it with another.",
            )
        if region.time_window_s is None:
            continue
        first_s, last_s = region.time_window_s
        least_s = (region.revisits - 1) * region.revisit_after_s
        if least_s >= last_s - first_s:
            findings.error(
                region.name,
                "window-too-short",
                f"is open for {last_s - first_s:g} s, and its {region.revisits} visits take {least_s:g} s at "
                "least, revisit_after_s apart",
                f"Widen time_window_s by more than {least_s - (last_s - first_s):g} s, or lower "
                "revisit_after_s.",
            )


def _circles(aircraft: Aircraft) -> bool:
    """Whether its flight ends in the air, by what is asked for."""
    return aircraft.finish == "loiter" or (aircraft.finish == "return" and not aircraft.hovers)
