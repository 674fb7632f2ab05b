"""What is left of a scenario while it is being flown: the scenario that a new plan is made of."""

from __future__ import annotations

import copy
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from shapely import union_all
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from app.services.errors import ConflictError, RefusedError
from app.services.flights.as_flown import SLIVER_M, SLIVER_M2
from app.services.plans.along import Now
from app.services.plans.looked import Looked, footprint_of, searched_on
from planner.errors import Finding
from planner.geojson.geometry import areal, written
from planner.plan import Plan
from planner.scenario import Scenario
from planner.vehicle.aircraft import Aircraft
from planner.wishes import GoingOn, Unflown

AT_ONCE = GoingOn()
#: Corners of what is left lie on a grid, so that written places round to no other shape.
GRID_M = 0.1
#: So much of a region unseen counts as all of it: it is asked for as it was.
WHOLE = 0.999
#: Properties of a region that no longer hold for what is left of it.
OF_THE_WHOLE = frozenset({"width_m", "radius_m"})
#: Of energy that a reserve is part of, at least; less is none to fly on.
LEAST_WH = 1e-6


@dataclass(frozen=True, slots=True)
class Changes:
    """What is other than it was.

    Parameters
    ----------
    features
        GeoJSON features that come in, or take the place of those of the same id.
    removed
        Ids of features that are no longer.
    lost
        Names of aircraft that fly no more.
    members
        Members of the collection that are other now, such as ``wind``.
    """

    features: Sequence[Mapping[str, Any]] = ()
    removed: Sequence[str] = ()
    lost: Sequence[str] = ()
    members: Mapping[str, Any] = field(default_factory=dict)


def seen_by_plan(scenario: Scenario, plan: Plan, at_s: float) -> dict[str, BaseGeometry]:
    """The ground that a plan has seen up to a time of its own, by region."""
    done: dict[str, list[BaseGeometry]] = {}
    for collect in plan.collects:
        if collect.end_s > at_s:
            continue
        shape = footprint_of(scenario, plan, collect)
        for name in collect.regions:
            done.setdefault(name, []).append(shape)
    return {name: union_all(shapes) for name, shapes in done.items()}


def replanned(
    document: Mapping[str, Any],
    scenario: Scenario,
    now: Mapping[str, Now],
    seen: Mapping[str, BaseGeometry],
    at_s: float,
    changes: Changes,
    looks: Sequence[Looked] = (),
    going_on: GoingOn = AT_ONCE,
) -> dict[str, Any]:
    """The scenario that is left.

    Parameters
    ----------
    document, scenario
        As it was asked, and as it was read.
    now
        Where the aircraft are that fly, by name; the others start from the ground.
    seen
        The ground seen of each region, in the scenario's frame.
    at_s
        Seconds since the mission's start: windows count from now on.
    looks
        What a search has looked at; its regions stay as they are.
    going_on
        How long after the call that is: where aircraft are, and what has been seen, is told for then; and
        what they would have seen from then on.

    Raises
    ------
    RefusedError
        A name that is none of the scenario's, or no aircraft is left.
    ConflictError
        Nothing is left to be seen.
    """
    _check_names(document, scenario, now, changes)
    made = copy.deepcopy(dict(document))
    made["name"] = f"{document.get('name') or 'flight'}-replan"
    made.update(copy.deepcopy(dict(changes.members)))
    made["replan"] = {
        "begins_in_s": going_on.begins_in_s,
        "unless_better": going_on.unless_better,
        "order": {name: list(order) for name, order in going_on.order.items() if name not in changes.lost},
    }
    unflown = {
        name: [_pass(one, scenario) for one in passes]
        for name, passes in going_on.unflown.items()
        if name not in changes.lost
    }
    if unflown:
        made["replan"]["unflown"] = unflown
    until = {name: _line(line, scenario) for name, line in going_on.until.items() if name not in changes.lost}
    if until:
        made["replan"]["until"] = until
    coming = {_name(feature): feature for feature in changes.features}
    features: list[dict[str, Any]] = []
    for feature in made["features"]:
        name = _name(feature)
        if name in changes.removed or name in coming:
            continue
        if feature["properties"].get("role") == "roi" and scenario.task != "search":
            features += _left(feature, name, scenario, seen, at_s)
        else:
            features.append(feature)
    made["features"] = features + [copy.deepcopy(dict(feature)) for feature in coming.values()]
    if made.get("task", "collect") == "collect" and not any(
        feature["properties"].get("role") == "roi" for feature in made["features"]
    ):
        raise ConflictError("nothing is left to be seen")
    if scenario.task == "search":
        searched_on(made, scenario, looks, at_s, changed=bool(changes.features))
    crew = {aircraft.name: aircraft for aircraft in scenario.aircraft}
    made["vehicles"] = [
        _flying(vehicle, now.get(str(vehicle.get("name"))), crew.get(str(vehicle.get("name"))))
        for vehicle in made.get("vehicles", [])
        if vehicle.get("name") not in changes.lost
    ]
    if not made["vehicles"]:
        raise RefusedError(
            "no aircraft is left",
            (Finding("lost", "no-aircraft", "names every aircraft", "Leave one that flies."),),
        )
    return made


def _pass(one: Unflown, scenario: Scenario) -> dict[str, Any]:
    """A pass of a search as a scenario says it."""
    line = scenario.frame.to_wgs84([one.start, one.end]).round(7).tolist()
    return {"line": line, "look": one.look}


def _line(line: Sequence[tuple[float, float, float]], scenario: Scenario) -> list[list[float]]:
    """What is flown until a plan begins, as a scenario says it."""
    lonlats = scenario.frame.to_wgs84([place[:2] for place in line]).round(7).tolist()
    return [[*lonlat, round(place[2], 2)] for lonlat, place in zip(lonlats, line, strict=True)]


def _left(
    feature: dict[str, Any],
    name: str,
    scenario: Scenario,
    seen: Mapping[str, BaseGeometry],
    at_s: float,
) -> list[dict[str, Any]]:
    """What of a region is still to be seen, as one feature; none where all of it has been."""
    feature = _later(feature, at_s)
    region = next((region for region in scenario.regions if region.name == name), None)
    if region is None or name not in seen or region.revisits > 1:
        return [feature]
    # Outlines of what was flown are frayed: what is left of each is its hull within the region.
    hulls = [
        part.convex_hull.buffer(SLIVER_M, join_style="mitre").intersection(region.area)
        for part in _polygons(region.area.difference(seen[name]))
        if part.area >= SLIVER_M2 and not part.buffer(-SLIVER_M).is_empty
    ]
    left = areal(union_all(hulls, grid_size=GRID_M))
    if left.is_empty:
        return []
    if left.area >= WHOLE * region.area.area:
        return [feature]
    properties = {k: v for k, v in feature["properties"].items() if k not in OF_THE_WHOLE}
    return [feature | {"geometry": written(left, scenario.frame), "properties": properties}]


def _later(feature: dict[str, Any], at_s: float) -> dict[str, Any]:
    """A region whose window counts from a later time."""
    window_s = feature["properties"].get("time_window_s")
    if window_s is None or at_s <= 0.0:
        return feature
    opens_s, closes_s = (max(float(value) - at_s, 0.0) for value in window_s)
    return feature | {"properties": feature["properties"] | {"time_window_s": [opens_s, closes_s]}}


def _flying(vehicle: dict[str, Any], now: Now | None, aircraft: Aircraft | None) -> dict[str, Any]:
    """An aircraft where it is, with what is left of its limits."""
    if now is None or aircraft is None:
        return vehicle
    made = dict(vehicle)
    place = {"lon_deg": now.lon_deg, "lat_deg": now.lat_deg, "height_m": round(now.height_m, 3)}
    if now.heading_deg is not None:
        place["heading_deg"] = round(now.heading_deg % 360.0, 6)
    made["in_flight"] = place
    limits = {
        "max_range_m": (aircraft.max_range_m, now.flown_m),
        "max_flight_time_s": (aircraft.max_flight_time_s, now.flown_s),
    }
    for name, (limit, used) in limits.items():
        if limit is not None:
            made[name] = max(limit - used, LEAST_WH)
    # As read: the store may be told as charge and voltage, or by the airframe's name.
    if aircraft.energy_wh is not None and now.energy_left_wh is not None:
        kept_wh = aircraft.energy_wh * aircraft.reserve
        made["energy_wh"] = max(now.energy_left_wh, LEAST_WH)
        made["reserve"] = min(kept_wh / made["energy_wh"], 0.999999)
        for name in ("charge_mah", "voltage_v"):
            made.pop(name, None)
    for name in ("batteries", "turnaround_s"):
        made.pop(name, None)
    return made


def _check_names(
    document: Mapping[str, Any], scenario: Scenario, now: Mapping[str, Now], changes: Changes
) -> None:
    names = {_name(feature) for feature in document["features"]}
    crew = {aircraft.name for aircraft in scenario.aircraft}
    found = [
        Finding(name, "unknown-feature", "is no feature of the scenario", "Name one of its features.")
        for name in changes.removed
        if name not in names
    ]
    found += [
        Finding(name, "unknown-vehicle", "is no vehicle of the scenario", f"Use: {', '.join(sorted(crew))}.")
        for name in {*now, *changes.lost} - crew
    ]
    if found:
        raise RefusedError("the changes name what is not there", tuple(found))


def _name(feature: Mapping[str, Any]) -> str:
    return str(feature.get("id", feature.get("properties", {}).get("name")))


def _polygons(shape: BaseGeometry) -> Iterable[Polygon]:
    return [part for part in getattr(shape, "geoms", [shape]) if isinstance(part, Polygon)]
