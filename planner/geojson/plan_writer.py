"""Plan to GeoJSON, role by role.

Where the plan crosses the antimeridian its lines go on beyond ±180°, since a mission is one line; ground is
cut in two, as RFC 7946 (3.1.9) asks.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import asdict
from typing import Any

from planner.geojson.sheet import cut
from planner.plan import (
    Collect,
    FlownPath,
    Footprint,
    LonLat,
    Metrics,
    PathSegment,
    Phase,
    Plan,
    PlanVehicle,
    Ring,
    ZoneCircle,
    ZonePolygon,
)

#: A hundredth of a nanodegree is a micrometre: so fine that no turn on the line gets tighter by rounding.
DECIMALS_DEG = 11
DECIMALS_M = 4


def write_plan(plan: Plan) -> dict[str, Any]:
    """The plan as a GeoJSON FeatureCollection; ``read_plan`` reads it back."""
    features = [
        *(_collect(c, fleet=plan.is_fleet) for c in plan.collects),
        *(
            _feature(
                "LineString",
                _line3(t.line),
                role="transit",
                vehicle=t.vehicle,
                seq=t.seq,
                **{"from": t.from_name, "to": t.to_name},
                length_m=_m(t.length_m),
                risk_missile=t.risk_missile,
                risk_radar=t.risk_radar,
                method=t.method,
                clearance_m=None if t.clearance_m is None else _m(t.clearance_m),
                **({"sortie": t.sortie} if plan.is_fleet else {}),
            )
            for t in plan.transits
        ),
        *(_path(p, fleet=plan.is_fleet) for p in plan.paths),
        *(
            _ground(
                [(f.ring, *f.holes)],
                role="footprint",
                vehicle=f.vehicle,
                seq=f.seq,
                roi=f.roi,
                sensor=f.sensor,
                resolution_m=f.resolution_m,
                niirs=f.niirs,
                **_quality(f),
                **_hidden(f),
            )
            for f in plan.footprints
        ),
        *(
            _feature(
                "MultiPoint",
                _line3(p.places),
                role="photos",
                vehicle=p.vehicle,
                seq=p.seq,
                sensor=p.sensor,
                count=len(p.places),
                interval_m=_m(p.interval_m),
                interval_s=None if p.interval_s is None else round(p.interval_s, 3),
            )
            for p in plan.photos
        ),
        *(
            _ground(
                u.polygons,
                role="uncovered",
                roi=u.roi,
                area_m2=round(u.area_m2, 2),
                reason=u.reason,
            )
            for u in plan.uncovered
        ),
    ]
    return {
        "type": "FeatureCollection",
        "name": plan.name,
        "features": features,
        "vehicles": [_vehicle(v) for v in plan.vehicles],
        "cameras": [asdict(c) for c in plan.cameras],
        "wind": asdict(plan.wind),
        "altitude_m": plan.altitude_m,
        "altitude_reference": plan.altitude_reference,
        "home": list(_lonlat(plan.home)),
        "end": list(_lonlat(plan.end)),
        "fence": {
            "inclusion": [_zone(z) for z in plan.fence.inclusion],
            "exclusion": [_zone(z) for z in plan.fence.exclusion],
            "exclusion_circles": [_circle(z) for z in plan.fence.exclusion_circles],
            "home_altitude_m": None if plan.fence.home_altitude_m is None else _m(plan.fence.home_altitude_m),
        },
        "metrics": _metrics(plan.metrics),
        "violations": [
            {**asdict(v), "where": None if v.where is None else list(_lonlat(v.where))}
            for v in plan.violations
        ],
        "warnings": list(plan.warnings),
        "methods": plan.methods,
        "scenario_hash": plan.scenario_hash,
        "planner_version": plan.planner_version,
        "seed": plan.seed,
    }


def _vehicle(vehicle: PlanVehicle) -> dict[str, Any]:
    """Its places only where they are not the plan's; the altitude of home only of one that is in the air."""
    places = {name: getattr(vehicle, name) for name in ("home", "end")}
    given = {name: list(_lonlat(place)) for name, place in places.items() if place is not None}
    written = {name: value for name, value in asdict(vehicle).items() if name not in places} | given
    if vehicle.home_altitude_m is None:
        del written["home_altitude_m"]
    return written


def _metrics(metrics: Metrics) -> dict[str, Any]:
    """What only several flights have, or one made in flight, is left out of others."""
    written = asdict(metrics)
    if not metrics.vehicles:
        del written["vehicles"], written["last_landing_s"], written["assignment"]
    if metrics.replan is None:
        del written["replan"]
    return written


def _quality(f: Footprint) -> dict[str, float]:
    """What a camera's photos are worth; nothing for other sensors."""
    given = {"gsd_m": f.gsd_m, "gsd_mean_m": f.gsd_mean_m, "niirs_mean": f.niirs_mean}
    return {name: value for name, value in given.items() if value is not None}


def _hidden(f: Footprint) -> dict[str, float]:
    """What terrain hides; nothing on flat ground."""
    given = {"shadow_m2": f.shadow_m2, "layover_m2": f.layover_m2}
    return {name: round(value, 1) for name, value in given.items() if value is not None}


def _collect(c: Collect, *, fleet: bool) -> dict[str, Any]:
    return _feature(
        "LineString",
        _line3(c.line),
        role="collect",
        vehicle=c.vehicle,
        seq=c.seq,
        roi=c.roi,
        rois=list(c.regions),
        sensor=c.sensor,
        look=c.look,
        heading_deg=round(c.heading_deg, 6),
        start_m=_m(c.start_m),
        end_m=_m(c.end_m),
        start_s=round(c.start_s, 3),
        end_s=round(c.end_s, 3),
        **({} if c.speed_m_s is None else {"speed_m_s": round(c.speed_m_s, 3)}),
        **({"sortie": c.sortie} if fleet else {}),
    )


def _path(p: FlownPath, *, fleet: bool) -> dict[str, Any]:
    return _feature(
        "LineString",
        _line3(p.line),
        role="path",
        vehicle=p.vehicle,
        length_m=_m(p.length_m),
        duration_s=round(p.duration_s, 3),
        energy_wh=p.energy_wh,
        min_turn_radius_m=p.min_turn_radius_m,
        sortie=p.sortie,
        take_off_heading_deg=None if p.take_off_heading_deg is None else round(p.take_off_heading_deg, 6),
        phases=[_phase(phase) for phase in p.phases],
        segments=[_segment(s) for s in p.segments],
        **({"start_s": round(p.start_s, 3)} if fleet else {}),
    )


def _phase(phase: Phase) -> dict[str, Any]:
    return {
        "kind": phase.kind,
        "start_m": _m(phase.start_m),
        "end_m": _m(phase.end_m),
        "start_s": round(phase.start_s, 3),
        "end_s": round(phase.end_s, 3),
    }


def _segment(s: PathSegment) -> dict[str, Any]:
    out: dict[str, Any] = {
        "kind": s.kind,
        "start": list(_lonlat(s.start)),
        "end": list(_lonlat(s.end)),
        "start_m": _m(s.start_m),
        "length_m": _m(s.length_m),
        "start_altitude_m": _m(s.start_altitude_m),
        "end_altitude_m": _m(s.end_altitude_m),
    }
    if s.centre is not None:
        out |= {"radius_m": s.radius_m, "centre": list(_lonlat(s.centre)), "turn_deg": s.turn_deg}
    return out


def _ground(polygons: Sequence[Sequence[Ring]], **properties: Any) -> dict[str, Any]:
    """Polygons on the ground, cut where they cross the antimeridian (RFC 7946, 3.1.9)."""
    rings = [[_ring(ring) for ring in part] for polygon in polygons for part in cut(polygon)]
    if len(rings) > 1:
        return _feature("MultiPolygon", rings, **properties)
    return _feature("Polygon", rings[0], **properties)


def _feature(kind: str, coordinates: Any, **properties: Any) -> dict[str, Any]:
    return {
        "type": "Feature",
        "properties": properties,
        "geometry": {"type": kind, "coordinates": coordinates},
    }


def _zone(zone: ZonePolygon) -> dict[str, Any]:
    return {
        "name": zone.name,
        "ring": [list(_lonlat(p)) for p in zone.ring],
        "floor_m": zone.floor_m,
        "ceiling_m": zone.ceiling_m,
    }


def _circle(zone: ZoneCircle) -> dict[str, Any]:
    return asdict(zone) | {"centre": list(_lonlat(zone.centre))}


def _lonlat(place: LonLat) -> LonLat:
    return (round(place[0], DECIMALS_DEG), round(place[1], DECIMALS_DEG))


def _line3(line: Iterable[tuple[float, float, float]]) -> list[list[float]]:
    return [[*_lonlat((lon, lat)), round(alt, DECIMALS_M)] for lon, lat, alt in line]


def _ring(ring: Sequence[LonLat]) -> list[list[float]]:
    """A closed ring of whatever winding the writer of the plan gave it."""
    return [list(_lonlat(place)) for place in ring]


def _m(metres: float) -> float:
    return round(metres, DECIMALS_M)
