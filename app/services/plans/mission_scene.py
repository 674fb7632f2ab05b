"""What a mission file is judged in: a scenario's zones, area and ground, or none but its own fence."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any, NoReturn, cast

import numpy as np
from pyproj import Geod
from shapely import make_valid
from shapely.geometry import Point, Polygon
from shapely.geometry.base import BaseGeometry

from app.services.documents import read_object, write_json
from app.services.errors import RefusedError
from mavlink.dialects.base import CIRCLE_COMMANDS, fence_shapes, is_polygon
from mavlink.dialects.mission import Mission
from mavlink.encoding.trace import FARTHEST_M, start_of, steers
from mavlink.wire.geometry import distance_m
from mavlink.wire.items import Command, MissionItem
from planner.airspace.terrain import Ground, Terrain, local_ground
from planner.airspace.values import NoFlyZone
from planner.errors import Finding, ScenarioError
from planner.frames import LocalFrame
from planner.geojson import read_scenario
from planner.plan import Fence, LonLat, ZoneCircle, ZonePolygon
from planner.route import Terminal
from planner.scenario import Scenario
from planner.vehicle.aircraft import Aircraft, VehicleType
from planner.vehicle.energy import STANDARD_GRAVITY_M_S2

#: Rasters by name; None for one that is not there.
Terrains = Callable[[str], Terrain | None]
#: A circle of this radius holds the whole Earth.
_HALF_ROUND_M = 20_100_000.0
_WGS84, _CORNERS = Geod(ellps="WGS84"), 256
#: The ground is looked at so far beyond the mission's places.
_GROUND_MARGIN_M = 2_000.0
#: What vehicles come with (AIRSPEED_CRUISE and ROLL_LIMIT_DEG of ArduPlane 4.6, FW_AIRSPD_TRIM and FW_R_LIM
#: of PX4 1.16, WPNAV_SPEED, MPC_XY_CRUISE): taken where nobody says how fast and how steeply banked it flies.
_DEFAULTS: dict[tuple[str, bool], tuple[float, float]] = {
    ("ardupilot", True): (12.0, 45.0),
    ("px4", True): (15.0, 50.0),
    ("ardupilot", False): (10.0, 45.0),
    ("px4", False): (5.0, 45.0),
}


@dataclass(frozen=True, slots=True)
class FileChoice:
    """What whoever sends a mission file says beside it; None for what the file or its autopilot says.

    Parameters
    ----------
    name
        Of the plan that it becomes.
    vehicle
        Name of a vehicle of the scenario it is judged in.
    terrain
        Id of an uploaded raster, for a file that is judged in no scenario.
    """

    name: str = "mission"
    autopilot: str | None = None
    vehicle_type: VehicleType | None = None
    vehicle: str | None = None
    airspeed_m_s: float | None = None
    min_turn_radius_m: float | None = None
    terrain: str | None = None


@dataclass(frozen=True, slots=True)
class Scene:
    """Where and by what a mission is judged.

    Parameters
    ----------
    scenario
        With the file's own fence as area and zones.
    text
        The scenario as it is kept beside the plan.
    notes
        What was assumed.
    type_is_said
        Whether anybody says the type of its vehicle.
    """

    scenario: Scenario
    aircraft: Aircraft
    text: str
    fence: Fence
    notes: tuple[str, ...]
    type_is_said: bool


def scene_of(
    mission: Mission, choice: FileChoice, scenario_text: str | None, terrains: Terrains | None
) -> Scene:
    """The scene of a mission; raises RefusedError where scenario and mission do not go together."""
    start = start_of(mission)
    _check_extent(mission, start)
    if scenario_text is None:
        aircraft, notes = _assumed(mission, choice)
        scenario = _bare(mission, choice, aircraft, start, terrains)
    else:
        scenario = _read(scenario_text, terrains)
        aircraft, notes = _named(scenario, mission, choice)
    away_m = distance_m(start, _lonlat(scenario, scenario.start.position))
    if away_m > FARTHEST_M:
        message = f"the mission begins {away_m / 1000.0:.0f} km from the start of the scenario"
        _refuse("scenario", "elsewhere", message, "judge it in the scenario of its own place, or in none")
    fence, fenced = _fenced(scenario, mission)
    text = scenario_text if scenario_text is not None else _document(mission, choice, aircraft, start, fence)
    declared = mission.declared
    said = choice.vehicle_type is not None or (declared is not None and declared.mav_type is not None)
    return Scene(fenced, aircraft, text, fence, (*notes, *_away(mission, start)), said)


def _refuse(feature: str, rule: str, message: str, fix: str) -> NoReturn:
    raise RefusedError(f"the mission file is refused: {message}", (Finding(feature, rule, message, fix),))


def _away(mission: Mission, start: LonLat) -> tuple[str, ...]:
    if not any(mission.home) or mission.home == start:
        return ()
    away_m = distance_m(mission.home, start)
    return (f"home is {away_m / 1000.0:.0f} km from the mission: its first place is taken for its start",)


def _check_extent(mission: Mission, start: LonLat) -> None:
    for item in mission.mission:
        if steers(item) and (item.x or item.y):
            away_m = distance_m(start, (item.y / 1e7, item.x / 1e7))
            if away_m > FARTHEST_M and not (mission.dialect.home_row and item.seq == 0):
                message = f"it is {away_m / 1000.0:.0f} km from the mission's start"
                _refuse(f"item {item.seq}", "too-far", message, "leave out what lies elsewhere")


def _read(text: str, terrains: Terrains | None) -> Scenario:
    try:
        return read_scenario(read_object(text), terrains)
    except ScenarioError as error:
        raise RefusedError(f"the scenario is refused: {error}", error.findings) from error


def _named(scenario: Scenario, mission: Mission, choice: FileChoice) -> tuple[Aircraft, tuple[str, ...]]:
    """The aircraft of a scenario that flies it."""
    known = scenario.aircraft
    if choice.vehicle is not None:
        found = [aircraft for aircraft in known if aircraft.name == choice.vehicle]
        if not found:
            names = ", ".join(aircraft.name for aircraft in known)
            message = f"the scenario has no vehicle {choice.vehicle}"
            _refuse("vehicle", "vehicle-unknown", message, f"name one of {names}")
        return found[0], ()
    alike = [aircraft for aircraft in known if aircraft.type == mission.vehicle_type] or list(known)
    return alike[0], (f"judged as flown by {alike[0].name} of the scenario",)


def _assumed(mission: Mission, choice: FileChoice) -> tuple[Aircraft, tuple[str, ...]]:
    """An aircraft by what the file says, and what its autopilot comes with."""
    wing = mission.vehicle_type != "multirotor"
    speed_m_s, bank_deg = _DEFAULTS[mission.autopilot, wing]
    notes = []
    told_m_s = choice.airspeed_m_s or mission.speed_m_s or _ordered_m_s(mission)
    if told_m_s:
        speed_m_s = told_m_s
    else:
        notes.append(
            f"nobody says how fast it is flown: {speed_m_s:g} m/s, the autopilot's default, are taken"
        )
    radius_m = choice.min_turn_radius_m
    if radius_m is None:
        radius_m = speed_m_s**2 / (STANDARD_GRAVITY_M_S2 * math.tan(math.radians(bank_deg)))
        if wing:
            notes.append(
                f"turns of {radius_m:.0f} m are taken for its tightest: {speed_m_s:g} m/s banked by"
                f" {bank_deg:g}°, its autopilot's default"
            )
    name = choice.vehicle or "vehicle"
    aircraft = Aircraft(name, mission.vehicle_type, mission.autopilot, speed_m_s, radius_m)
    return aircraft, tuple(notes)


def _ordered_m_s(mission: Mission) -> float | None:
    """The first speed that the mission itself orders."""
    for item in mission.mission:
        if item.command == Command.DO_CHANGE_SPEED and item.param1 in (0.0, 1.0) and item.param2 > 0.0:
            return float(item.param2)
    return None


def _bare(
    mission: Mission, choice: FileChoice, aircraft: Aircraft, start: LonLat, terrains: Terrains | None
) -> Scenario:
    """A scenario of nothing but the mission's place, its aircraft and the ground where it is named."""
    frame = LocalFrame(*start)
    here = Terminal("start", (0.0, 0.0))
    known = mission.home_altitude_m if start == mission.home and mission.home_altitude_m else None
    scenario = Scenario(choice.name, frame, (), (aircraft,), (), here, here, 0.0, "home", home_amsl_m=known)
    ground = None if choice.terrain is None else _ground(mission, choice.terrain, frame, terrains)
    if ground is None:
        return scenario
    home_m = float(ground.at([(0.0, 0.0)])[0])
    if math.isnan(home_m):
        message = "the raster has no height at the mission's start"
        _refuse("terrain", "terrain-elsewhere", message, "name another raster")
    return replace(scenario, terrain=ground, home_amsl_m=home_m)


def _ground(mission: Mission, name: str, frame: LocalFrame, terrains: Terrains | None) -> Ground:
    terrain = None if terrains is None else terrains(name)
    if terrain is None:
        fix = "upload it first (POST /api/v1/terrain)"
        _refuse("terrain", "terrain-unknown", f"there is no raster {name}", fix)
    places = [(item.y / 1e7, item.x / 1e7) for item in mission.mission if item.x or item.y]
    line_m = frame.to_local(places or [(frame.lon_deg, frame.lat_deg)])
    (west_m, south_m), (east_m, north_m) = line_m.min(axis=0), line_m.max(axis=0)
    margin_m = _GROUND_MARGIN_M
    bounds = (west_m - margin_m, south_m - margin_m, east_m + margin_m, north_m + margin_m)
    return local_ground(terrain, frame, bounds)


def _lonlat(scenario: Scenario, place_m: tuple[float, float]) -> LonLat:
    lon_deg, lat_deg = scenario.frame.to_wgs84(place_m)
    return float(lon_deg), float(lat_deg)


def _fenced(scenario: Scenario, mission: Mission) -> tuple[Fence, Scenario]:
    """The file's fence as a plan tells it, and the scenario with it.

    ArduPilot keeps a vehicle inside all of its inclusions, PX4 inside any of them.
    """
    inclusions: list[tuple[ZonePolygon, BaseGeometry]] = []
    exclusions: list[ZonePolygon] = []
    circles: list[ZoneCircle] = []
    zones: list[NoFlyZone] = []
    for number, (command, shape) in enumerate(fence_shapes(mission.fence), start=1):
        name = f"fence {number}"
        ring = tuple(_place(item) for item in shape)
        if command in CIRCLE_COMMANDS and shape[0].param1 > 0.0:
            centre = scenario.frame.to_local([ring[0]])[0]
            radius_m = min(shape[0].param1, _HALF_ROUND_M)
            disc = Point(*centre).buffer(radius_m, quad_segs=64)
            if command == Command.NAV_FENCE_CIRCLE_INCLUSION:
                inclusions.append((ZonePolygon(name, _round(ring[0], radius_m)), disc))
            else:
                circles.append(ZoneCircle(name, ring[0], radius_m))
                zones.append(NoFlyZone(name, None, (float(centre[0]), float(centre[1])), radius_m))
        elif is_polygon(command) and len(ring) >= 3:
            # A ring that crosses itself holds what its autopilot counts as inside: the odd parts.
            held = make_valid(Polygon(scenario.frame.to_local(list(ring))))
            if command == Command.NAV_FENCE_POLYGON_VERTEX_INCLUSION:
                inclusions.append((ZonePolygon(name, ring), held))
            else:
                exclusions.append(ZonePolygon(name, ring))
                zones += [NoFlyZone(name, part) for part in _parts(held)]
    fence = Fence(tuple(zone for zone, _ in inclusions), tuple(exclusions), tuple(circles))
    area: BaseGeometry | None = scenario.area
    if inclusions:
        kept = inclusions[0][1]
        for _, shape_m in inclusions[1:]:
            kept = kept.intersection(shape_m) if mission.autopilot == "ardupilot" else kept.union(shape_m)
        area = kept if area is None else area.intersection(kept)
    # Several inclusions can leave several polygons; the judge takes any shape.
    return fence, replace(scenario, area=cast("Polygon | None", area), no_fly=(*scenario.no_fly, *zones))


def _parts(area: BaseGeometry) -> Iterator[Polygon]:
    for part in getattr(area, "geoms", [area]):
        if isinstance(part, Polygon) and not part.is_empty:
            yield part


def _place(item: MissionItem) -> LonLat:
    return item.y / 1e7, item.x / 1e7


def _round(centre: LonLat, radius_m: float) -> tuple[LonLat, ...]:
    """Corners of a circle, along geodesics: one that is half round the Earth has none in a projection."""
    lon_deg, lat_deg, _ = _WGS84.fwd(
        np.full(_CORNERS, centre[0]),
        np.full(_CORNERS, centre[1]),
        np.linspace(0.0, 360.0, _CORNERS, endpoint=False),
        np.full(_CORNERS, radius_m),
    )
    return tuple(zip(lon_deg.tolist(), lat_deg.tolist(), strict=True))


def _document(mission: Mission, choice: FileChoice, aircraft: Aircraft, start: LonLat, fence: Fence) -> str:
    """The file's place, aircraft and fence as a scenario that regions can be drawn into."""
    place = [*start, mission.home_altitude_m] if mission.home_altitude_m else [*start]
    features: list[dict[str, Any]] = [_feature("start", {"type": "Point", "coordinates": place}, "start")]
    for zone in fence.inclusion[:1]:
        features.append(_feature("area", _polygon(zone), zone.name))
    features += [_feature("no_fly", _polygon(zone), zone.name) for zone in fence.exclusion]
    for circle in fence.exclusion_circles:
        point = {"type": "Point", "coordinates": list(circle.centre)}
        features.append(_feature("no_fly", point, circle.name, radius_m=circle.radius_m))
    vehicle = {
        "name": aircraft.name,
        "type": aircraft.type,
        "autopilot": aircraft.autopilot,
        "airspeed_m_s": aircraft.airspeed_m_s,
        "min_turn_radius_m": round(aircraft.min_turn_radius_m, 2),
    }
    body: dict[str, Any] = {"type": "FeatureCollection", "name": choice.name, "features": features}
    body |= {"vehicles": [vehicle], "sensors": [], "altitude_m": 100, "altitude_reference": "home"}
    if choice.terrain is not None:
        body["terrain"] = choice.terrain
    return write_json(body)


def _feature(role: str, geometry: dict[str, Any], name: str, **properties: Any) -> dict[str, Any]:
    return {
        "type": "Feature",
        "id": name,
        "geometry": geometry,
        "properties": {"role": role, "name": name, **properties},
    }


def _polygon(zone: ZonePolygon) -> dict[str, Any]:
    corners = [list(place) for place in zone.ring]
    shape = Polygon(corners)
    if shape.is_valid and not shape.exterior.is_ccw:
        corners.reverse()
    return {"type": "Polygon", "coordinates": [[*corners, corners[0]]]}
