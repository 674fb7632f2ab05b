"""GeoJSON to Plan: what ``write_plan`` wrote, checked again at the edge."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NoReturn

from planner.errors import Finding, ScenarioError
from planner.geojson.sheet import joined
from planner.plan import (
    Assigned,
    Collect,
    Fence,
    FlownPath,
    Footprint,
    LeftOut,
    Metrics,
    PathSegment,
    Phase,
    Photos,
    Plan,
    PlanCamera,
    PlanVehicle,
    PlanWind,
    Replanned,
    Surveyed,
    Transit,
    Uncovered,
    VehicleMetrics,
    Violation,
    ZoneCircle,
    ZonePolygon,
)


def read_plan(document: Any) -> Plan:
    """Read a plan written by ``write_plan``.

    Raises
    ------
    ScenarioError
        Naming the feature and member that is missing or wrong.
    """
    if not isinstance(document, dict) or document.get("type") != "FeatureCollection":
        _refuse("plan", "not-a-feature-collection", "is not a GeoJSON FeatureCollection", "Send a plan.")
    if "metrics" not in document or "scenario_hash" not in document:
        fix = "A scenario becomes a plan by `swathplan plan`."
        _refuse("plan", "not-a-plan", "has no metrics and scenario_hash: it is not a plan", fix)
    features = document.get("features")
    if not isinstance(features, list):
        _refuse("plan", "no-features", "has no list of features", "Send the plan whole.")

    def each(role: str, make: Callable[[Mapping[str, Any], Any], Any]) -> tuple[Any, ...]:
        values = []
        for index, feature in enumerate(features):
            try:
                if feature["properties"]["role"] == role:
                    values.append(make(feature["properties"], feature["geometry"]["coordinates"]))
            except (KeyError, TypeError, ValueError, IndexError) as error:
                _refuse(
                    f"features[{index}]",
                    "bad-plan-feature",
                    f"({role}) cannot be read: {error!r}",
                    "Plan again.",
                )
        return tuple(values)

    try:
        return Plan(
            name=str(document.get("name", "plan")),
            vehicles=tuple(_vehicle(v) for v in document["vehicles"]),
            altitude_m=float(document["altitude_m"]),
            altitude_reference=document["altitude_reference"],
            home=_place(document["home"]),
            end=_place(document["end"]),
            paths=each("path", _path),
            collects=each("collect", _collect),
            transits=each("transit", _transit),
            footprints=each("footprint", _footprint),
            uncovered=each("uncovered", _uncovered),
            fence=Fence(
                tuple(_zone(z) for z in document["fence"]["inclusion"]),
                tuple(_zone(z) for z in document["fence"]["exclusion"]),
                tuple(
                    ZoneCircle(**(z | {"centre": _place(z["centre"])}))
                    for z in document["fence"]["exclusion_circles"]
                ),
                document["fence"].get("home_altitude_m"),
            ),
            metrics=_metrics(document["metrics"]),
            violations=tuple(
                Violation(**(v | {"where": None if v["where"] is None else _place(v["where"])}))
                for v in document["violations"]
            ),
            methods=dict(document["methods"]),
            scenario_hash=str(document["scenario_hash"]),
            planner_version=str(document["planner_version"]),
            seed=int(document["seed"]),
            warnings=tuple(document.get("warnings", ())),
            photos=each("photos", _photos),
            cameras=tuple(PlanCamera(**c) for c in document.get("cameras", ())),
            wind=PlanWind(**document.get("wind", {})),
        )
    except (KeyError, TypeError, ValueError) as error:
        _refuse("plan", "bad-plan-member", f"cannot be read: {error!r}", "Send the plan as it was written.")


def _refuse(feature: str, rule: str, message: str, fix: str) -> NoReturn:
    raise ScenarioError((Finding(feature, rule, message, fix),))


def _place(value: Any) -> tuple[float, float]:
    return (float(value[0]), float(value[1]))


def _line(value: Any) -> tuple[tuple[float, float, float], ...]:
    return tuple((float(p[0]), float(p[1]), float(p[2])) for p in value)


def _ring(value: Any) -> tuple[tuple[float, float], ...]:
    return tuple(_place(p) for p in value)


def _zone(value: Any) -> ZonePolygon:
    return ZonePolygon(value["name"], _ring(value["ring"]), value["floor_m"], value["ceiling_m"])


def _path(p: Mapping[str, Any], line: Any) -> FlownPath:
    segments = tuple(
        PathSegment(
            s["kind"],
            _place(s["start"]),
            _place(s["end"]),
            float(s["start_m"]),
            float(s["length_m"]),
            s.get("radius_m"),
            _place(s["centre"]) if s.get("centre") is not None else None,
            s.get("turn_deg"),
            float(s["start_altitude_m"]),
            float(s["end_altitude_m"]),
        )
        for s in p["segments"]
    )
    return FlownPath(
        p["vehicle"],
        _line(line),
        segments,
        p["length_m"],
        p["duration_s"],
        p["energy_wh"],
        p["min_turn_radius_m"],
        tuple(Phase(**phase) for phase in p["phases"]),
        p["take_off_heading_deg"],
        p["sortie"],
        float(p.get("start_s", 0.0)),
    )


def _collect(p: Mapping[str, Any], line: Any) -> Collect:
    first, last = _line(line)
    return Collect(
        p["vehicle"],
        p["seq"],
        p["roi"],
        tuple(p.get("rois", [p["roi"]])),
        p["sensor"],
        p["look"],
        (first, last),
        p["heading_deg"],
        p["start_m"],
        p["end_m"],
        p["start_s"],
        p["end_s"],
        p.get("sortie", 1),
        p.get("speed_m_s"),
    )


def _transit(p: Mapping[str, Any], line: Any) -> Transit:
    return Transit(
        p["vehicle"],
        p["seq"],
        p["from"],
        p["to"],
        _line(line),
        p["length_m"],
        p["risk_missile"],
        p["risk_radar"],
        p["method"],
        p.get("clearance_m"),
        p.get("sortie", 1),
    )


def _footprint(p: Mapping[str, Any], coordinates: Any) -> Footprint:
    (rings,) = _polygons(coordinates)
    return Footprint(
        p["vehicle"],
        p["seq"],
        p["roi"],
        p["sensor"],
        rings[0],
        p["resolution_m"],
        p["niirs"],
        rings[1:],
        p.get("shadow_m2"),
        p.get("layover_m2"),
        p.get("gsd_m"),
        p.get("gsd_mean_m"),
        p.get("niirs_mean"),
    )


def _photos(p: Mapping[str, Any], places: Any) -> Photos:
    return Photos(p["vehicle"], p["seq"], p["sensor"], _line(places), p["interval_m"], p["interval_s"])


def _metrics(p: Mapping[str, Any]) -> Metrics:
    surveys = {name: Surveyed(**each) for name, each in p.get("surveys", {}).items()}
    left_out = tuple(LeftOut(**each) for each in p.get("left_out", ()))
    vehicles = {name: VehicleMetrics(**each) for name, each in p.get("vehicles", {}).items()}
    told = None if p.get("assignment") is None else Assigned(**p["assignment"])
    replan = None if p.get("replan") is None else _replanned(p["replan"])
    read = {
        "left_out": left_out,
        "surveys": surveys,
        "vehicles": vehicles,
        "assignment": told,
        "replan": replan,
    }
    return Metrics(**{**p, **read})


def _replanned(p: Mapping[str, Any]) -> Replanned:
    lists = {name: tuple(p.get(name, ())) for name in ("kept", "moved", "new")}
    return Replanned(**{**p, **lists})


def _vehicle(v: Mapping[str, Any]) -> PlanVehicle:
    places = {name: _place(v[name]) for name in ("home", "end") if v.get(name) is not None}
    return PlanVehicle(**{**v, **places})


def _uncovered(p: Mapping[str, Any], coordinates: Any) -> Uncovered:
    return Uncovered(p["roi"], _polygons(coordinates), p["area_m2"], p["reason"])


def _polygons(coordinates: Any) -> tuple[tuple[tuple[tuple[float, float], ...], ...], ...]:
    """Polygons as rings; what was cut at the antimeridian is one again."""
    many = isinstance(coordinates[0][0][0], list)
    read = [[_ring(ring) for ring in rings] for rings in (coordinates if many else [coordinates])]
    return tuple(tuple(_ring(ring) for ring in rings) for rings in joined(read))
