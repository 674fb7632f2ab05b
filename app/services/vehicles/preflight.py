"""Is this vehicle ready to fly this plan? Each question by itself: ok, warning or failed, in words."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from app.services.plans.missions import PARTS, PartName, mission_findings
from app.services.vehicles.pointing import pointing_findings
from app.services.vehicles.recorder import is_flying
from mavlink.dialects.mission import Mission
from mavlink.encoding.arcs import circles_widen_m
from mavlink.rules.firmware import note_on
from mavlink.rules.table import Needs, ParameterFinding, judge_parameters
from mavlink.state.telemetry import VehicleState
from mavlink.wire.geometry import distance_m
from planner.errors import Finding
from planner.plan import Plan

Status = Literal["ok", "warning", "failed"]

#: A vehicle this near to the plan's start stands there; beyond the second it is the wrong place.
NEAR_M = 50.0
FAR_M = 1000.0
#: A fixed wing on the ground that points further from where the plan takes off is to be turned.
TURNED_DEG = 20.0
#: Less than this times the need is too little battery for comfort.
RESERVE = 1.2
#: A charge that is taken as low where nothing says what the flight needs.
LOW_PERCENT = 50.0
FEW_SATELLITES = 6
GOOD_FIXES = frozenset({"3d", "dgps", "rtk_float", "rtk_fixed"})
#: A home whose height differs more from the scenario's stands elsewhere, or one datum is wrong.
HEIGHT_M = 10.0
#: Rasters of the world are this far off here and there; more is another place, or another datum.
RASTER_M = 30.0
#: Circles wider by this leave little of the margin that transits keep from zones.
WIDER_M = 5.0
#: Wind above this part of the airspeed leaves too little for turns.
WIND_PART = 0.5


@dataclass(frozen=True, slots=True)
class Check:
    """One question and its answer."""

    name: str
    status: Status
    detail: str


@dataclass(frozen=True, slots=True)
class Preflight:
    """All answers; a vehicle is ready when none has failed.

    Parameters
    ----------
    mission_held
        Whether reading back showed the plan's mission in the vehicle; None when it could not be read.
    """

    plan_id: str
    checks: tuple[Check, ...]
    parameters: tuple[ParameterFinding, ...] = ()
    mission_held: bool | None = None

    @property
    def ready(self) -> bool:
        """Whether nothing stands against the flight."""
        return all(check.status != "failed" for check in self.checks)


@dataclass(frozen=True, slots=True)
class Observed:
    """What was asked of the vehicle.

    Parameters
    ----------
    held
        Differences between what is meant and what the vehicle holds, by part; None where it could not be
        read back.
    values
        Parameters by name; None when reading them failed.
    unread
        Parameters that were asked for and not answered.
    """

    state: VehicleState
    held: Mapping[PartName, Sequence[Any] | None]
    values: Mapping[str, float] | None
    unread: tuple[str, ...] = ()


def preflight(
    plan_id: str,
    plan: Plan,
    scenario: Mapping[str, Any],
    mission: Mission,
    needs: Needs,
    observed: Observed,
) -> Preflight:
    """Answer every question.

    Parameters
    ----------
    scenario
        The plan's scenario as it was posted.
    """
    found = (
        ()
        if observed.values is None
        else judge_parameters(mission.autopilot, mission.vehicle_type, needs, observed.values)
    )
    state = observed.state
    checks = (
        _plan(plan),
        _vehicle(mission, state),
        _dialect(mission, state.firmware),
        _held("mission", mission, observed),
        _fence(mission, observed),
        _parameters(found, observed),
        *_gimbal(plan, scenario, mission, needs),
        _battery(plan, scenario, mission, state),
        _place(plan, mission.vehicle, state),
        *_heading(plan, mission, state),
        _gps(state),
        _datum(plan, scenario, mission, state),
        *_circles(mission, state),
        *_wind(plan, scenario, mission),
    )
    differences = observed.held.get("mission")
    return Preflight(plan_id, checks, found, None if differences is None else not differences)


def _plan(plan: Plan) -> Check:
    if plan.hard_violations:
        return Check("plan", "failed", f"it breaks a hard constraint: {plan.hard_violations[0].message}")
    if plan.violations:
        return Check("plan", "warning", f"a soft constraint is not kept: {plan.violations[0].message}")
    return Check("plan", "ok", "every constraint is kept")


def _vehicle(mission: Mission, state: VehicleState) -> Check:
    if not state.connected:
        return Check("vehicle", "failed", "it is not connected")
    if state.booting:
        return Check("vehicle", "failed", f"it is still starting ({state.mode or 'boot'})")
    if state.autopilot != mission.autopilot:
        message = f"its autopilot is {state.autopilot}, the mission is for {mission.autopilot}"
        return Check("vehicle", "warning" if state.autopilot == "generic" else "failed", message)
    if state.type != mission.vehicle_type:
        message = f"it is a {state.type}, the mission is for a {mission.vehicle_type}"
        return Check("vehicle", "warning" if state.type == "other" else "failed", message)
    known = f" {state.firmware}" if state.firmware else ""
    detail = f"connected: {mission.dialect.name}{known}, mode {state.mode or 'not said'}"
    note = note_on(state.autopilot, state.firmware)
    if note is None:
        return Check("vehicle", "ok", detail)
    return Check("vehicle", "warning" if state.firmware else "ok", f"{detail}; {note}")


def _dialect(mission: Mission, firmware: str | None) -> Check:
    found: tuple[Finding, ...] = mission_findings(mission, list(PARTS.values()), firmware)
    worst = next((f for f in found if f.severity == "error"), found[0] if found else None)
    if worst is None:
        return Check("dialect", "ok", f"{mission.dialect.name} takes every item as it is meant")
    status: Status = "failed" if worst.severity == "error" else "warning"
    more = f", and {len(found) - 1} more" if len(found) > 1 else ""
    return Check("dialect", status, f"{worst.feature}: {worst.message}{more}")


def _held(part: PartName, mission: Mission, observed: Observed) -> Check:
    differences = observed.held.get(part)
    if differences is None:
        return Check(part, "failed", f"the {part} could not be read back")
    if differences:
        more = f", and {len(differences) - 1} more" if len(differences) > 1 else ""
        return Check(part, "failed", f"the vehicle does not hold what is meant: {differences[0]}{more}")
    count = len(mission.items_of(PARTS[part]))
    return Check(part, "ok", f"read back and compared: all {count} items are held as meant")


def _fence(mission: Mission, observed: Observed) -> Check:
    if not mission.fence:
        return Check("fence", "ok", "the plan asks for none")
    return _held("fence", mission, observed)


def _parameters(found: Sequence[ParameterFinding], observed: Observed) -> Check:
    if observed.values is None:
        return Check("parameters", "warning", "they could not be read")
    if found:
        failed = any(finding.severity == "error" for finding in found)
        return Check("parameters", "failed" if failed else "warning", "; ".join(str(f) for f in found))
    if observed.unread:
        return Check("parameters", "warning", f"no answer about {', '.join(observed.unread)}")
    return Check("parameters", "ok", f"{len(observed.values)} read, all as the mission needs them")


def _gimbal(plan: Plan, scenario: Mapping[str, Any], mission: Mission, needs: Needs) -> Iterator[Check]:
    if needs.gimbal is None:
        return
    found = pointing_findings(plan, scenario, mission, needs)
    if not found:
        tilt_deg = 90.0 + needs.gimbal.pitch_deg
        yield Check("gimbal", "ok", f"it holds the sensor {tilt_deg:g}° from straight down, as planned")
        return
    failed = any(finding.severity == "error" for finding in found)
    yield Check("gimbal", "failed" if failed else "warning", "; ".join(f.message for f in found))


def _battery(plan: Plan, scenario: Mapping[str, Any], mission: Mission, state: VehicleState) -> Check:
    percent = state.battery_percent
    if percent is None:
        return Check("battery", "warning", "the vehicle does not say how full it is")
    path = next(path for path in plan.paths if path.vehicle == mission.vehicle)
    limits = _limits(scenario, mission.vehicle)
    for needed, name, unit in (
        (path.energy_wh, "energy_wh", "Wh"),
        (path.duration_s, "max_flight_time_s", "s"),
        (path.length_m, "max_range_m", "m"),
    ):
        capacity = limits.get(name)
        if needed is None or not isinstance(capacity, (int, float)):
            continue
        there = capacity * percent / 100.0
        words = (
            f"{percent:.0f} % of {capacity:.0f} {unit} are {there:.0f} {unit}, the flight takes "
            f"{needed:.0f} {unit}"
        )
        if there < needed:
            return Check("battery", "failed", words)
        return Check("battery", "warning" if there < RESERVE * needed else "ok", words)
    words = (
        f"{percent:.0f} %; whether that is enough for {path.duration_s / 60.0:.0f} minutes is not known: the"
        " scenario names neither energy_wh nor max_flight_time_s"
    )
    return Check("battery", "warning" if percent < LOW_PERCENT else "ok", words)


def _limits(scenario: Mapping[str, Any], name: str) -> Mapping[str, Any]:
    vehicles = scenario.get("vehicles") or ()
    return next((vehicle for vehicle in vehicles if vehicle.get("name") == name), {})


def settle_m(scenario: Mapping[str, Any], name: str) -> float | None:
    """The straight flight a scenario's vehicle wants before each collect, itself or for its autopilot."""
    vehicle = _limits(scenario, name)
    value = vehicle.get("settle_m")
    if isinstance(value, (int, float)):
        return float(value)
    # Here: it brings all the planner with it, and who only puts missions into vehicles reads no scenario.
    from planner.geojson.equipment import named_steadiness

    steady, airspeed_m_s = named_steadiness(vehicle), vehicle.get("airspeed_m_s")
    if steady is None or not isinstance(airspeed_m_s, (int, float)):
        return None
    return steady.settle_s * airspeed_m_s


def _place(plan: Plan, name: str, state: VehicleState) -> Check:
    if state.lon_deg is None or state.lat_deg is None:
        return Check("place", "failed", "the vehicle does not know where it is")
    aloft = any(vehicle.name == name and vehicle.home_altitude_m is not None for vehicle in plan.vehicles)
    if aloft and is_flying(state):
        # It flies on while its mission is made and sent: where it is by now tells nothing.
        words = "the vehicle flies, and the plan begins in the air"
        return _from_home(plan, state, words)
    away_m = distance_m((state.lon_deg, state.lat_deg), plan.home)
    words = f"the vehicle is {away_m:.0f} m from the plan's start"
    if away_m > FAR_M:
        return Check("place", "failed", words)
    if away_m > NEAR_M:
        return Check("place", "warning", words)
    return _from_home(plan, state, words)


def _from_home(plan: Plan, state: VehicleState, words: str) -> Check:
    """Where the place itself is right, whether returns go there, too."""
    if state.home_lon_deg is not None and state.home_lat_deg is not None:
        home_m = distance_m((state.home_lon_deg, state.home_lat_deg), plan.home)
        if home_m > NEAR_M:
            detail = f"{words}, but its home, where returns go to, is {home_m:.0f} m from it"
            return Check("place", "warning", detail)
    return Check("place", "ok", words)


def _heading(plan: Plan, mission: Mission, state: VehicleState) -> Iterator[Check]:
    """A fixed wing takes off the way it points: ArduPlane climbs on so, PX4 swings on its runway."""
    path = next(path for path in plan.paths if path.vehicle == mission.vehicle)
    planned_deg, heading_deg = path.take_off_heading_deg, state.heading_deg
    if mission.vehicle_type != "fixed_wing" or planned_deg is None or state.landed is False:
        return
    if heading_deg is None:
        yield Check("heading", "warning", "the vehicle does not say where it points")
        return
    off_deg = abs(math.remainder(heading_deg - planned_deg, 360.0))
    words = f"it points to {heading_deg:.0f}°, the plan takes off to {planned_deg:.0f}°"
    if off_deg > TURNED_DEG:
        words += ": turn it there, or plan with that heading_deg of the start"
    yield Check("heading", "warning" if off_deg > TURNED_DEG else "ok", words)


def _gps(state: VehicleState) -> Check:
    if state.gps_fix is None:
        return Check("gps", "warning", "the vehicle does not say whether it has a fix")
    seen = "" if state.satellites is None else f", {state.satellites} satellites"
    if state.gps_fix not in GOOD_FIXES:
        return Check("gps", "failed", f"fix: {state.gps_fix}{seen}")
    few = state.satellites is not None and state.satellites < FEW_SATELLITES
    return Check("gps", "warning" if few else "ok", f"fix: {state.gps_fix}{seen}")


def _datum(plan: Plan, scenario: Mapping[str, Any], mission: Mission, state: VehicleState) -> Check:
    """What the altitudes count from, and whether vehicle and plan mean the same by it."""
    home_m = state.home_altitude_amsl_m
    if home_m is None:
        return Check("altitude", "warning", "the vehicle has not said how high its home is")
    said = f"home is at {home_m:.0f} m above mean sea level (the autopilot's geoid, EGM96)"
    planned_m = _home_altitude_m(scenario, mission.vehicle)
    if plan.altitude_reference == "amsl":
        if scenario.get("terrain") and mission.declared is None:
            # Whatever a third coordinate says: the plan takes off from the raster's ground.
            return _on_raster(mission.home_altitude_m, home_m, said)
        if planned_m is None:
            words = f"{said}; the plan counts from sea level and does not know the height of its start"
            return Check("altitude", "warning", words)
        if abs(planned_m - home_m) > HEIGHT_M:
            return Check("altitude", "failed", f"{said}; the plan takes it to be at {planned_m:.0f} m")
        return Check("altitude", "ok", f"{said}, the plan takes it to be at {planned_m:.0f} m")
    if planned_m is not None and abs(planned_m - home_m) > HEIGHT_M:
        words = f"{said}; the scenario takes it to be at {planned_m:.0f} m, and its zones with it"
        return Check("altitude", "warning", words)
    if plan.altitude_reference == "terrain" and not scenario.get("terrain"):
        words = f"{said}; without a terrain raster the ground is taken to be flat at that height"
        return Check("altitude", "warning", words)
    return Check("altitude", "ok", f"{said}; the plan counts from {plan.altitude_reference}")


def _on_raster(ground_m: float, home_m: float, said: str) -> Check:
    """Where the raster's ground is the height of the start: it may be off itself."""
    words = f"{said}; the terrain raster has the ground of the plan's start at {ground_m:.0f} m"
    off_m = abs(ground_m - home_m)
    return Check("altitude", "failed" if off_m > RASTER_M else "warning" if off_m > HEIGHT_M else "ok", words)


def _home_altitude_m(scenario: Mapping[str, Any], vehicle: str) -> float | None:
    """The height of a vehicle's base, else of the start, where its position has a third coordinate."""
    base = _limits(scenario, vehicle).get("base")
    known: dict[Any, Mapping[str, Any]] = {}
    for feature in scenario.get("features") or ():
        properties = feature.get("properties") or {}
        if properties.get("role") in ("start", "base"):
            name = feature.get("id", properties.get("name"))
            known.setdefault(properties["role"], feature)
            known.setdefault(("base", name), feature)
    own = known.get(("base", base)) or known.get("start") or known.get("base")
    place = [] if own is None else own["geometry"]["coordinates"]
    return float(place[2]) if len(place) > 2 else None


def _circles(mission: Mission, state: VehicleState) -> Iterator[Check]:
    home_m = state.home_altitude_amsl_m
    if mission.autopilot != "ardupilot" or home_m is None:
        return
    wider_m = circles_widen_m(mission, home_m)
    if wider_m > WIDER_M:
        message = (
            f"its home is {home_m:.0f} m above the sea, where ArduPlane circles up to {wider_m:.0f} m wider"
            " than planned: plan with as much more clearance, or on terrain, where heights count from the sea"
        )
        yield Check("turns", "warning", message)


def _wind(plan: Plan, scenario: Mapping[str, Any], mission: Mission) -> Iterator[Check]:
    wind = scenario.get("wind")
    if not isinstance(wind, Mapping) or not wind.get("speed_m_s"):
        return
    speed_m_s = float(wind["speed_m_s"])
    words = f"planned for {speed_m_s:g} m/s from {float(wind.get('from_deg', 0.0)):.0f}°"
    strong = speed_m_s > WIND_PART * mission.speed_m_s
    detail = f"{words}, more than half the airspeed of {mission.speed_m_s:g} m/s" if strong else words
    yield Check("wind", "warning" if strong else "ok", detail)
