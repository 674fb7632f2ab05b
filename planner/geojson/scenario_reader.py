"""GeoJSON FeatureCollection to Scenario: everything wrong is found, nothing is guessed."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Collection, Mapping
from dataclasses import replace
from typing import Any

from shapely.geometry import Polygon

from planner.airspace.terrain import NO_DATUM, Terrains, find_terrain
from planner.errors import ScenarioError
from planner.geojson import equipment, features
from planner.geojson.extent import check_bbox, frame_of, within
from planner.geojson.far import near_features
from planner.geojson.fields import Fields, Findings
from planner.geojson.fleet import check_fleet, read_separation, start_of
from planner.geojson.going_on import read_going_on
from planner.geojson.heights import Heights, at_chosen_heights, tell_unused, with_wishes
from planner.geojson.home import check_flat, home_amsl_m, kept_clear
from planner.geojson.plausible import check_plausible
from planner.geojson.relief import set_on_terrain
from planner.geojson.rules import check_together
from planner.geojson.searching import (
    check_search,
    importance_of,
    longest_s,
    read_search,
    read_worth,
    searched,
    tell_collected,
    tell_unsearched,
    with_importance,
)
from planner.geojson.shutter import at_camera_speed
from planner.geojson.size import check_size
from planner.geojson.slots import check_slots
from planner.route import Terminal
from planner.scenario import Scenario
from planner.tasks.registry import TASKS
from planner.wishes import HIGHEST_M, Importance, ImportancePatch, ImportancePoint, Region

MEMBERS = (
    "type", "features", "name", "bbox", "crs", "vehicles", "sensors", "altitude_m", "min_height_m",
    "max_height_m", "altitude_reference", "terrain", "terrain_following", "wind", "clearance_m", "objective",
    "task", "method", "seed", "time_budget_s", "separation", "importance_raster", "search",
    "replan",
)  # fmt: skip

CRS84 = (
    "urn:ogc:def:crs:OGC:1.3:CRS84",
    "urn:ogc:def:crs:OGC::CRS84",
    "EPSG:4326",
    "urn:ogc:def:crs:EPSG::4326",
)

#: What generators of random numbers take.
MOST_SEED = 2**32 - 1


def scenario_hash(document: Mapping[str, Any]) -> str:
    """SHA-256 of the document in canonical JSON (sorted keys, no spaces)."""
    canonical = json.dumps(document, sort_keys=True, separators=(",", ":"), ensure_ascii=False)
    return hashlib.sha256(canonical.encode(errors="surrogatepass")).hexdigest()


def read_scenario(document: Any, terrains: Terrains | None = None) -> Scenario:
    """Read and validate a scenario.

    Parameters
    ----------
    document
        The parsed JSON of a GeoJSON FeatureCollection with the roles and members of the contract.
    terrains
        Elevation rasters by the id that the member ``terrain`` names: a mapping, or a function that answers
        None for an unknown id.

    Raises
    ------
    ScenarioError
        With every finding, when anything is wrong.
    """
    findings = Findings()
    scenario = _read(document, findings, terrains)
    if findings.errors or scenario is None:
        raise ScenarioError(findings.all())
    return scenario


def _read(document: Any, findings: Findings, terrains: Terrains | None) -> Scenario | None:
    if isinstance(document, dict) and document.get("fileType") == "Plan":
        findings.error(
            "scenario", "is-a-mission", "is a mission of QGroundControl, not a scenario",
            "Upload it as it is, or turn what its surveys ask for into regions: swathplan import, or "
            "POST /api/v1/scenarios/import.",
        )  # fmt: skip
        return None
    if not isinstance(document, dict) or document.get("type") != "FeatureCollection":
        findings.error(
            "scenario", "not-a-feature-collection", "is not a GeoJSON FeatureCollection",
            'Send {"type": "FeatureCollection", "features": [...], ...}.',
        )  # fmt: skip
        return None
    if "scenario_hash" in document and "metrics" in document:
        findings.error(
            "scenario", "is-a-plan", "is a plan, not a scenario", "Send the scenario that it was made of.",
        )  # fmt: skip
        return None
    raw_features = document.get("features")
    if not isinstance(raw_features, list):
        findings.error("scenario", "no-features", "has no list of features", "Add features.")
        return None
    _check_crs(document.get("crs"), findings)
    check_bbox(document.get("bbox"), raw_features, findings)
    counted = near_features(raw_features, findings)
    raw_features = counted.features
    if not check_size([f for k, f in enumerate(raw_features) if k not in counted.left_out], findings):
        return None
    frame = frame_of(raw_features, findings, counted.left_out)
    raws = _raw_features(raw_features, findings, counted.left_out)
    if frame is None:
        return None
    # What is too far off is found already, and has no place in the frame.
    near = raws if not findings.errors else [raw for raw in raws if within(frame, raw)]

    def each(role: str, reader: Any) -> list[Any]:
        values = [reader(raw, frame, findings) for raw in near if raw.role == role]
        return [value for value in values if value is not None]

    regions = each("roi", features.read_region)
    threats = each("threat", features.read_threat)
    no_fly = each("no_fly", features.read_no_fly)
    obstacles = each("obstacle", features.read_obstacle)
    areas: list[Polygon] = each("area", features.read_area)
    starts: list[Terminal] = each("start", features.read_terminal)
    ends: list[Terminal] = each("end", features.read_terminal)
    bases: list[Terminal] = each("base", features.read_terminal)
    for role, most in (("area", 1), ("start", 1), ("end", 1)):
        named = [raw.name for raw in raws if raw.role == role]
        for extra in named[most:]:
            findings.error(extra, f"several-{role}s", f"is a second {role}", f"Keep one {role}.")
    worth: list[ImportancePatch | ImportancePoint] = each("importance", read_worth)

    top = Fields("scenario", document, findings)
    top.refuse_unknown(also_known=MEMBERS)
    vehicles = equipment.listed(document, "vehicles", findings)
    aircraft = [equipment.read_aircraft(raw, i, findings) for i, raw in enumerate(vehicles)]
    steady = equipment.shared_steadiness(vehicles)
    sensors = [
        equipment.read_sensor(raw, i, findings, steady)
        for i, raw in enumerate(equipment.listed(document, "sensors", findings))
    ]
    altitude_m = top.number("altitude_m", None, minimum=features.LOWEST_M, maximum=HIGHEST_M)
    heights = Heights.read(top)
    if not heights.decided(regions) and "altitude_m" not in top:
        top.wrong(
            "altitude_m",
            "is missing, and nothing else says how high to fly",
            "Add altitude_m: a number; or, for the planner to choose the height, gsd_m, min_resolution_m or "
            "min_niirs of a region, or max_height_m.",
            "missing-property",
        )
    reference: Any = top.choice("altitude_reference", ("amsl", "home", "terrain"), "terrain")
    task = top.choice("task", tuple(TASKS), "collect")
    if task != "search":
        tell_unsearched(worth, top, findings)
    raster_name = top.text("importance_raster", None) if task == "search" else None
    terrain_name = top.text("terrain", None)
    terrain = None if terrain_name is None else find_terrain(terrains, terrain_name)
    if terrain_name is not None and terrain is None:
        findings.error(
            "scenario", "unknown-terrain", f"names the terrain {terrain_name!r}, which is not here",
            "Send the raster first and name it by its id; without terrain the ground is flat at the height "
            "of home.",
        )  # fmt: skip
    if terrain is not None and terrain.datum == NO_DATUM:
        findings.error(
            "scenario", "no-heights", f"names the terrain {terrain_name!r}, whose values are no heights",
            "Name an elevation raster; one of importance is an importance_raster.",
        )  # fmt: skip
    following = top.flag("terrain_following", False)
    if following and terrain_name is None:
        findings.error(
            "scenario", "terrain-following", "follows the terrain, but names none",
            "Name the raster as terrain, or leave terrain_following out.",
        )  # fmt: skip
    clearance_m = top.number("clearance_m", equipment.kept_m(aircraft), minimum=0.0)
    budget_s = top.number("time_budget_s", None, above=0.0)
    name = top.text("name", "scenario")
    seed = top.integer("seed", 0, minimum=0, maximum=MOST_SEED)
    wind = equipment.read_wind(document.get("wind"), frame, findings)
    objective = equipment.read_objective(document.get("objective"), findings)
    method = equipment.read_method(document.get("method"), findings)
    importance = Importance()
    if task == "search":
        named = [raw.name for raw in raws if raw.role == "area"]
        importance = importance_of(worth, read_search(document.get("search"), frame, findings))
        regions = searched(regions, areas, named, importance, longest_s(aircraft), findings)
    else:
        tell_collected(method, findings)
    if task != "search" and not regions and not any(raw.role == "roi" for raw in raws):
        findings.error("scenario", "no-region", "has no region of interest", "Add a feature of role roi.")
    separation = read_separation(document.get("separation"), findings)
    if len(aircraft) == 1 and separation is not None:
        findings.warning("separation", "not-used", "is kept between aircraft, and there is one", "Remove it.")
    going_on = read_going_on(document.get("replan"), frame, findings)
    start = start_of(starts, bases, aircraft, raws, findings)
    if findings.errors or start is None or clearance_m is None:
        return None
    scenario = Scenario(
        name=name or "scenario",
        frame=frame,
        regions=tuple(regions),
        aircraft=tuple(a for a in aircraft if a is not None),
        sensors=tuple(s for s in sensors if s is not None),
        start=start,
        end=ends[0] if ends else Terminal(start.name, start.position),
        altitude_m=altitude_m or 0.0,
        altitude_reference=reference,
        area=areas[0] if areas else None,
        threats=tuple(threats),
        no_fly=tuple(zone for zones in no_fly for zone in zones),
        obstacles=tuple(obstacle for parts in obstacles for obstacle in parts),
        wind=wind,
        clearance_m=clearance_m,
        objective=objective,
        method=method,
        task=task or "collect",
        seed=seed,
        time_budget_s=budget_s,
        scenario_hash=scenario_hash(document),
        looked_at=counted.looked_at(frame),
        home_amsl_m=None if terrain is not None else home_amsl_m(raws, start.name),
        terrain_following=following,
        max_height_m=heights.max_m,
        band=heights.band(regions),
        bases=tuple(bases) if len(aircraft) > 1 or any(one.end_bases for one in aircraft if one) else (),
        separation=separation if len(aircraft) > 1 else None,
        going_on=going_on,
    )
    check_fleet(scenario, bases, document.get("objective"), findings)
    if task == "search":
        raster = None if raster_name is None else find_terrain(terrains, raster_name)
        scenario = with_importance(scenario, importance, raster_name, raster, findings)
    scenario = with_wishes(scenario)
    tell_unused(scenario, heights, findings)
    if terrain is not None:
        scenario = set_on_terrain(scenario, terrain, heights, "clearance_m" in top, findings)
    else:
        check_flat(raws, scenario, findings)
        scenario = kept_clear(at_chosen_heights(scenario, heights, findings), findings)
    if findings.errors and not heights.altitude_given:
        return None
    scenario = replace(scenario, regions=_at_their_altitudes(scenario.regions, scenario.altitude_m))
    check_together(scenario, findings)
    if scenario.task == "search":
        check_search(scenario, findings)
    if not findings.errors:
        scenario = at_camera_speed(scenario, findings)
        check_slots(scenario, findings)
        check_plausible(scenario, findings)
    return replace(scenario, warnings=findings.warnings)


def _at_their_altitudes(regions: tuple[Region, ...], altitude_m: float) -> tuple[Region, ...]:
    """Where one region has an altitude of its own, every region has one; but for those that are followed."""
    if all(region.altitude_m in (None, altitude_m) for region in regions):
        return tuple(replace(region, altitude_m=None) for region in regions)
    return tuple(
        replace(region, altitude_m=altitude_m)
        if region.altitude_m is None and region.over_ground_m is None
        else region
        for region in regions
    )


def _check_crs(crs: Any, findings: Findings) -> None:
    if crs is None:
        return
    name = crs.get("properties", {}).get("name") if isinstance(crs, dict) else crs
    if name not in CRS84:
        findings.error(
            "scenario", "unknown-crs", f"has the crs {name!r}", "RFC 7946 knows WGS 84 only: remove crs."
        )


def _raw_features(
    raw_features: list[Any], findings: Findings, left_out: Collection[int]
) -> list[features.RawFeature]:
    raws = []
    seen: set[str] = set()
    for index, feature in enumerate(raw_features):
        if not isinstance(feature, dict) or feature.get("type") != "Feature":
            findings.error(
                f"features[{index}]", "not-a-feature", "is not a GeoJSON Feature", "Give a Feature."
            )
            continue
        name = features.name_of(index, feature)
        if name in seen:
            findings.error(name, "duplicate-id", "names two features", "Give each feature its own id.")
        seen.add(name)
        if index in left_out:
            continue
        raw = features.read_role(name, feature, findings)
        if raw is not None:
            raws.append(raw)
    return raws
