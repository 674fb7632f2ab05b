"""Mission files of other programs as plans: judged by the line they are flown on, sent as they are.

The document is that of a plan with a member ``mission_file`` more: the file's text and how it was read. What
goes to a vehicle are the file's own items, never a line encoded anew.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from app.services.documents import read_object, write_json
from app.services.errors import RefusedError
from app.services.plans.filed_mission import MEMBER, read_as
from app.services.plans.mission_scene import FileChoice, Scene, Terrains, scene_of
from app.services.plans.summary import summary_of
from app.services.terrain.rasters import stored_terrain
from mavlink.dialects.mission import Mission
from mavlink.encoding.trace import Trace, length_m, start_of, trace
from mavlink.formats import FormatError
from mavlink.formats.reading import decoded
from mavlink.wire.items import MissionItem
from planner.check import judge_line, tight_turns
from planner.check.energy import line_wh
from planner.errors import Finding
from planner.geojson import scenario_hash, write_plan
from planner.metrics import SAMPLE_M, Floats, risks_along
from planner.plan import FlownPath, LonLat, Metrics, Plan, PlanVehicle, Violation
from planner.scenario import Scenario
from planner.version import __version__

#: Places are rounded to 1e-7 degrees: a turn may be so much tighter than its aircraft flies.
ROUNDED = 1e-3


@dataclass(frozen=True, slots=True)
class FiledPlan:
    """A mission file as it is kept: a plan's document, its scenario and its summary."""

    name: str
    plan: str
    scenario: str
    scenario_hash: str
    digest: str
    summary: dict[str, Any]
    warnings: list[dict[str, str]]


def filed(
    content: bytes, choice: FileChoice, scenario_text: str | None = None, terrains: Terrains | None = None
) -> FiledPlan:
    """Read and judge a mission file.

    Parameters
    ----------
    scenario_text
        The scenario whose zones, area, ground and aircraft it is judged by; None for its own fence alone.
    terrains
        Elevation rasters by name.

    Raises
    ------
    RefusedError
        With line or member that cannot be read, or where the scenario does not go with it.
    """
    text, mission = _read(content, choice)
    scene = scene_of(mission, choice, scenario_text, terrains)
    mission = replace(mission, vehicle=scene.aircraft.name)
    flown = _traced(mission, scene)
    plan = _plan(mission, choice, scene, flown, read_object(scene.text))
    notes = [*mission.notes, *scene.notes]
    told: dict[str, Any] = {
        "text": text,
        "autopilot": choice.autopilot,
        "vehicle_type": choice.vehicle_type,
        "vehicle": scene.aircraft.name,
        "notes": notes,
    }
    document = write_plan(plan)
    document["features"] += list(_features(mission, plan))
    document[MEMBER] = told
    warnings = [
        {"feature": "mission file", "rule": "mended", "message": note, "fix": "", "severity": "warning"}
        for note in notes
    ]
    return FiledPlan(
        choice.name,
        write_json(document),
        scene.text,
        plan.scenario_hash,
        hashlib.sha256(content).hexdigest(),
        summary_of(document),
        warnings,
    )


def filed_beside(
    content: bytes, choice: FileChoice, scenario_text: str | None, terrain_folder: str | None
) -> FiledPlan:
    """The same with uploaded rasters, which are in a folder."""
    terrains = None if terrain_folder is None else partial(stored_terrain, terrain_folder)
    return filed(content, choice, scenario_text, terrains)


def _read(content: bytes, choice: FileChoice) -> tuple[str, Mission]:
    try:
        text = decoded(content)
        return text, read_as(text, choice.autopilot, choice.vehicle_type)
    except FormatError as error:
        place = f"line {error.line}" if error.line is not None else "file"
        fix = "mend it there, or save it anew in the program that wrote it"
        finding = Finding(place, "mission-format", error.message, fix)
        raise RefusedError(f"the mission file is refused: {error}", (finding,)) from error


def _traced(mission: Mission, scene: Scene) -> Trace:
    scenario = scene.scenario
    home_amsl_m = scenario.home_amsl_m
    if home_amsl_m is None and start_of(mission) == mission.home:
        home_amsl_m = mission.home_altitude_m or None
    ground, home_m = scenario.terrain, scenario.home_amsl_m or 0.0

    def ground_m(place: LonLat) -> float:
        if ground is None:
            return 0.0
        over_m = float(ground.at(scenario.frame.to_local([place]))[0]) - home_m
        return over_m if math.isfinite(over_m) else 0.0

    radius_m = scene.aircraft.in_wind(scenario.wind.speed_m_s).ground_turn_radius_m
    return trace(mission, radius_m, radius_m, home_amsl_m, ground_m)


def _plan(
    mission: Mission, choice: FileChoice, scene: Scene, flown: Trace, document: Mapping[str, Any]
) -> Plan:
    aircraft, scenario = scene.aircraft, scene.scenario
    long_m = length_m(flown.line)
    duration_s = long_m / aircraft.airspeed_m_s
    vehicle = PlanVehicle(
        aircraft.name,
        mission.vehicle_type,
        mission.autopilot,
        aircraft.airspeed_m_s,
        aircraft.min_turn_radius_m,
        aircraft.max_climb_deg,
        flown.finish if flown.finish == "land" else "loiter",
    )
    energy_wh = line_wh(
        scenario.frame.to_local([place[:2] for place in flown.line]),
        np.array([place[2] for place in flown.line]),
        aircraft,
        scenario.wind,
        scenario.home_amsl_m or 0.0,
        duration_s,
    )
    path = FlownPath(aircraft.name, flown.line, (), long_m, duration_s, energy_wh, None)
    top_m = max((place[2] for place in flown.line), default=0.0)
    plan = Plan(
        name=choice.name,
        vehicles=(vehicle,),
        altitude_m=top_m,
        altitude_reference="home",
        home=flown.line[0][:2],
        end=flown.line[-1][:2],
        paths=(path,),
        collects=(),
        transits=(),
        footprints=(),
        uncovered=(),
        fence=scene.fence,
        metrics=_metrics(scenario, flown, path),
        violations=(),
        methods={},
        scenario_hash=scenario_hash(document),
        planner_version=__version__,
        seed=0,
        warnings=(*mission.notes, *scene.notes),
    )
    return replace(plan, violations=tuple(_violations(scenario, plan, path, flown, scene)))


def _metrics(scenario: Scenario, flown: Trace, path: FlownPath) -> Metrics:
    """Of the whole line; nothing is collected by one that nobody planned to see anything."""
    missile, radar = risks_along(*_sampled(scenario, flown), scenario.threats)
    return Metrics(
        length_m=path.length_m,
        collection_length_m=0.0,
        duty_cycle=0.0,
        path_length_ratio=None,
        risk_missile=missile,
        risk_radar=radar,
        turns=len(flown.turns),
        duration_s=path.duration_s,
        energy_wh=path.energy_wh,
        coverage={},
        flight_length_m=path.length_m,
        flight_duration_s=path.duration_s,
    )


def _sampled(scenario: Scenario, flown: Trace) -> tuple[Floats, Floats]:
    """Places along the line, close together, and their heights over home."""
    line_m = scenario.frame.to_local([place[:2] for place in flown.line])
    reached_m = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line_m, axis=0).T))])
    at_m = np.linspace(0.0, reached_m[-1], max(2, math.ceil(reached_m[-1] / SAMPLE_M)))
    places = np.stack([np.interp(at_m, reached_m, line_m[:, k]) for k in (0, 1)], axis=1)
    return places, np.interp(at_m, reached_m, [place[2] for place in flown.line])


def _violations(
    scenario: Scenario, plan: Plan, path: FlownPath, flown: Trace, scene: Scene
) -> Iterator[Violation]:
    aircraft = scene.aircraft.in_wind(scenario.wind.speed_m_s)
    turns = ((turn.radius_m, turn.place, turn.seq) for turn in flown.turns)
    # Of a file that nobody says the vehicle of, turns forbid only what turns out to have wings.
    limit_m = aircraft.ground_turn_radius_m * (1.0 - ROUNDED)
    yield from tight_turns(path.vehicle, limit_m, turns, hard=scene.type_is_said)
    yield from judge_line(scenario, aircraft, plan, path, (flown.line, flown.corners))
    if flown.unknown_heights:
        numbers = ", ".join(str(seq) for seq in flown.unknown_heights[:8])
        message = (
            f"items {numbers} say no height over home: they count from the sea, whose depth below home is not"
            " told, or have none"
        )
        yield Violation("altitude", path.vehicle, message, float(len(flown.unknown_heights)), "items")


def _features(mission: Mission, plan: Plan) -> Iterator[dict[str, Any]]:
    """Fence and rally points for the map."""
    for kind, zones in (("inclusion", plan.fence.inclusion), ("exclusion", plan.fence.exclusion)):
        for zone in zones:
            ring = [list(place) for place in (*zone.ring, zone.ring[0])]
            yield _feature({"type": "Polygon", "coordinates": [ring]}, "fence", kind=kind, name=zone.name)
    for circle in plan.fence.exclusion_circles:
        point = {"type": "Point", "coordinates": list(circle.centre)}
        yield _feature(point, "fence", kind="exclusion", name=circle.name, radius_m=circle.radius_m)
    for item in mission.rally:
        yield _feature({"type": "Point", "coordinates": _position(item)}, "rally", seq=item.seq)


def _position(item: MissionItem) -> list[float]:
    return [item.y / 1e7, item.x / 1e7, item.z]


def _feature(geometry: dict[str, Any], role: str, **properties: Any) -> dict[str, Any]:
    return {"type": "Feature", "geometry": geometry, "properties": {"role": role, **properties}}
