"""The printable report of a plan."""

from __future__ import annotations

import json
import math
from functools import lru_cache
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined, Template, select_autoescape

from app.services.errors import NotFoundError
from app.services.records import FlightRecord, PlanRecord
from app.services.reports.report_map import draw_map
from app.services.reports.report_photos import camera_figures, region_qualities

TEMPLATES = Path(__file__).resolve().parents[2] / "templates"


def _number(value: float | None, decimals: int = 1) -> str:
    if value is None or not math.isfinite(value):
        return "–"
    return f"{value:,.{decimals}f}".replace(",", "\u202f")


def _ground(value_m: float | None) -> str:
    """A length on the ground, in centimetres where it is short."""
    if value_m is None:
        return "–"
    return f"{100.0 * value_m:.2f} cm" if value_m < 1.0 else f"{value_m:.2f} m"


def _clock(seconds: float | None) -> str:
    if seconds is None:
        return "–"
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{rest:02d}" if hours else f"{minutes}:{rest:02d}"


@lru_cache(maxsize=4)
def _template(name: str) -> Template:
    environment = Environment(
        loader=FileSystemLoader(TEMPLATES),
        autoescape=select_autoescape(default=True, default_for_string=True),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {"number": _number, "clock": _clock, "ground": _ground}
    return environment.get_template(name)


def _of_vehicle(plan: dict[str, Any], vehicle: str) -> dict[str, Any]:
    """A plan without what other vehicles fly."""
    if vehicle not in {each["name"] for each in plan["vehicles"]}:
        raise NotFoundError("vehicle in the plan called", vehicle)
    return plan | {
        "vehicles": [each for each in plan["vehicles"] if each["name"] == vehicle],
        "features": [
            feature
            for feature in plan["features"]
            if feature["properties"].get("vehicle", vehicle) == vehicle
        ],
    }


def write_report(record: PlanRecord, plan_text: str, scenario_text: str, vehicle: str | None = None) -> str:
    """The report of a done plan as one HTML page without scripts or outside parts.

    With a vehicle what others fly is left out; what is said of the whole stays.
    """
    plan: dict[str, Any] = json.loads(plan_text)
    if vehicle is not None:
        plan = _of_vehicle(plan, vehicle)
    scenario: dict[str, Any] = json.loads(scenario_text)
    by_role: dict[str, list[dict[str, Any]]] = {}
    for feature in plan["features"]:
        by_role.setdefault(feature["properties"]["role"], []).append(feature["properties"])
    return _template("report.html.jinja").render(
        plan=plan,
        scenario=scenario,
        record=record,
        map=draw_map(scenario, plan),
        metrics=plan["metrics"],
        collects=sorted(by_role.get("collect", []), key=lambda c: (c["vehicle"], c["seq"])),
        transits=sorted(by_role.get("transit", []), key=lambda t: (t["vehicle"], t["seq"])),
        paths=by_role.get("path", []),
        footprints={(f["vehicle"], f["seq"]): f for f in by_role.get("footprint", [])},
        uncovered=by_role.get("uncovered", []),
        cameras=camera_figures(plan, by_role),
        qualities=region_qualities(by_role),
        photos={(p["vehicle"], p["seq"]): p for p in by_role.get("photos", [])},
    )


#: Roles of a flight's features, and those of a plan that are drawn as they shall be.
_DRAWN_AS = {
    "track": "path",
    "sensor_on": "collect",
    "seen": "footprint",
    "unknown": "unknown",
    "not_counted": "not_counted",
}


def _camera(photos: dict[str, Any] | None) -> dict[str, Any] | None:
    """Photos with how many were planned and are missing."""
    if photos is None:
        return None
    return photos | {name: sum(each[name] for each in photos["passes"]) for name in ("planned", "missing")}


def write_flight_report(
    record: FlightRecord, scenario: dict[str, Any], track: dict[str, Any], coverage: dict[str, Any]
) -> str:
    """The report of a flight as one HTML page without scripts or outside parts."""
    features = [
        feature | {"properties": {"role": _DRAWN_AS[feature["properties"]["role"]]}}
        for feature in (*track["features"], *coverage["features"])
        if feature["properties"]["role"] in _DRAWN_AS
        and feature["geometry"]["type"] in ("Polygon", "MultiPolygon", "LineString")
    ]
    lines = {(collect["vehicle"], collect["seq"]): collect for collect in coverage["collects"]}
    return _template("flight_report.html.jinja").render(
        record=record,
        name=scenario.get("name") or "Flight",
        map=draw_map(scenario, {"features": features}),
        regions=coverage["regions"],
        seen_percent=f"{100 * coverage['seen_fraction']:g}",
        triggers=[t | {"line": lines.get((t["vehicle"], t["seq"]))} for t in coverage["triggers"]],
        photos=any(t["photos_taken"] or t["photos_expected"] for t in coverage["triggers"]),
        missed=[trigger for trigger in coverage["triggers"] if trigger["state"] != "ok"],
        camera=_camera(coverage["photos"]),
        gaps=coverage["gaps"],
        not_counted=coverage["not_counted"],
        energy=coverage["energy"][0] if coverage["energy"] else None,
        unseen=[region for region in coverage["regions"] if not region["seen"]],
    )
