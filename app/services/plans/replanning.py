"""What is left of a plan while it is flown, from what is told, recorded, or planned up to a time."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from pyproj import Geod
from shapely import union_all
from shapely.geometry.base import BaseGeometry

from app.services.documents import read_object
from app.services.errors import ConflictError, RefusedError
from app.services.flights.seen import Sortie, judged
from app.services.plans.along import Now, Soon, ahead, allowance_s, where_planned
from app.services.plans.looked import Looked, flown_looks, footprint_of, heading_deg, planned_looks
from app.services.plans.missions import plan_of
from app.services.plans.replanned import Changes, replanned, seen_by_plan
from app.services.records import FlightRecord, TrackSample
from planner.errors import Finding
from planner.geojson import read_scenario
from planner.geojson.fields import Findings
from planner.geojson.geometry import area
from planner.geojson.going_on import MOST_S
from planner.plan import Plan
from planner.replanned import order_of, unflown_of
from planner.scenario import Scenario
from planner.wishes import GoingOn

Line = tuple[tuple[float, float, float], ...]

GEOD = Geod(ellps="WGS84")
#: A search that goes on in flight is planned for so long where its scenario does not say: sooner is more.
SEARCH_S = 4.0
#: The course is told by places this far apart.
TELLING_M = 5.0


@dataclass(frozen=True, slots=True)
class Told:
    """What a client says of one aircraft; None is taken from its record, or from the plan."""

    lon_deg: float | None = None
    lat_deg: float | None = None
    height_m: float | None = None
    heading_deg: float | None = None
    energy_left_wh: float | None = None
    flown_m: float | None = None
    flown_s: float | None = None


@dataclass(frozen=True, slots=True)
class Asked:
    """What to plan anew.

    Parameters
    ----------
    at_s
        Seconds of the plan's own clock: where aircraft are that nobody tells of, and what is seen by then.
        None where that is told, or recorded.
    vehicles
        By name.
    seen
        GeoJSON areas that have been seen, of any region; None to take them from records, or from the plan.
    begins_in_s
        When, from now on, aircraft in flight take up the new plan: until then they fly on by the old one.
        None for as long as planning it and sending it up takes about; ``along.allowance_s``.
    unless_better
        Who sees what in which order stays, unless another order is better by this part.
    """

    at_s: float | None
    vehicles: Mapping[str, Told]
    seen: Sequence[Mapping[str, Any]] | None
    changes: Changes
    begins_in_s: float | None = None
    unless_better: float = GoingOn().unless_better


def replan_of(sortie: Sortie, asked: Asked) -> dict[str, Any]:
    """The scenario to post.

    Parameters
    ----------
    sortie
        The plan, and its flights as far as they are recorded.

    Raises
    ------
    ConflictError
        Nobody says where the aircraft are, or nothing is left to be seen.
    RefusedError
        What is told of has no place in the scenario.
    """
    document = read_object(sortie.scenario_text)
    scenario, plan = read_scenario(document, sortie.terrain), plan_of(sortie.plan_text)
    return left_of(document, scenario, plan, asked, sortie)


def left_of(
    document: Mapping[str, Any], scenario: Scenario, plan: Plan, asked: Asked, sortie: Sortie | None = None
) -> dict[str, Any]:
    """The scenario that is left of one; raises as ``replan_of``.

    Parameters
    ----------
    sortie
        Recorded flights of the plan; None without any.
    """
    flights = () if sortie is None else sortie.flights
    planned = {} if asked.at_s is None else where_planned(scenario, plan, asked.at_s)
    flying = [flown for flown in flights if flown.record.state == "flying" and flown.samples]
    recorded = {_name(f.record, scenario): _recorded(f.samples) for f in flying}
    now = {**planned, **recorded}
    for name, told in asked.vehicles.items():
        now[name] = _told(name, told, now.get(name))
    now = {name: place for name, place in now.items() if name not in asked.changes.lost}
    low = [name for name, place in now.items() if not place.height_m > 0.0]
    if low:
        raise RefusedError(
            "the height of an aircraft is not known",
            tuple(
                Finding(n, "no-height", "has no height over home on record", "Tell height_m.") for n in low
            ),
        )
    if not now and asked.at_s is None:
        raise ConflictError(
            "none of the plan's aircraft is on a recorded flight of it: say where they are (vehicles), or at"
            " which time of the plan (at_s)"
        )
    at_s = asked.at_s if asked.at_s is not None else max((n.flown_s for n in now.values()), default=0.0)
    begins_in_s = asked.begins_in_s
    if scenario.task == "search" and now and scenario.time_budget_s is None:
        document = {**document, "time_budget_s": SEARCH_S}
    if begins_in_s is None:
        begins_in_s = allowance_s(plan, list(now))
        if scenario.task == "search" and now:
            begins_in_s = min(begins_in_s + (scenario.time_budget_s or SEARCH_S), MOST_S)
    now, soon, until = _ahead(scenario, plan, now, begins_in_s)
    as_flown = sortie if flying or (flights and asked.at_s is None) else None
    if scenario.task == "search":
        looks = _looks(scenario, plan, asked, as_flown, at_s)
        looks += [
            Looked(s.ground, at_s + s.in_s, at_s + s.until_s, heading_deg(scenario, s.collect)) for s in soon
        ]
        begins_s = at_s + begins_in_s
        going_on = GoingOn(begins_in_s, unflown=unflown_of(scenario, plan, begins_s), until=until)
        return replanned(document, scenario, now, {}, begins_s, asked.changes, looks, going_on)
    if asked.seen is not None:
        ground = union_all([_area(shape, scenario, k) for k, shape in enumerate(asked.seen)])
        seen: Mapping[str, BaseGeometry] = {region.name: ground for region in scenario.regions}
    elif as_flown is not None:
        seen = judged(as_flown, scenario, plan).seen
    else:
        seen = seen_by_plan(scenario, plan, at_s)
        # What is being seen then is seen from its beginning.
        soon = [replace(s, ground=footprint_of(scenario, plan, s.collect)) for s in soon]
    seen = _and_soon(seen, soon)
    going_on = GoingOn(begins_in_s, order_of(plan, at_s + begins_in_s), asked.unless_better, until=until)
    return replanned(document, scenario, now, seen, at_s + begins_in_s, asked.changes, going_on=going_on)


def _ahead(
    scenario: Scenario, plan: Plan, now: Mapping[str, Now], by_s: float
) -> tuple[dict[str, Now], list[Soon], dict[str, Line]]:
    """Where aircraft are so much later, what they see and fly until then; those on no line of it stay."""
    found: dict[str, Now] = {}
    soon: list[Soon] = []
    until: dict[str, Line] = {}
    for name, place in now.items():
        later = ahead(scenario, plan, name, place, by_s) if by_s > 0.0 else None
        found[name] = place if later is None else later.then
        if later is not None:
            soon += later.soon
            lonlats = np.array(later.line)
            places = np.column_stack([scenario.frame.to_local(lonlats[:, :2]), lonlats[:, 2]]).tolist()
            until[name] = tuple((east_m, north_m, height_m) for east_m, north_m, height_m in places)
    return found, soon, until


def _and_soon(seen: Mapping[str, BaseGeometry], soon: Sequence[Soon]) -> dict[str, BaseGeometry]:
    """What has been seen of regions by then: of passes those alone that are over."""
    found: dict[str, list[BaseGeometry]] = {name: [ground] for name, ground in seen.items()}
    for each in soon:
        for name in each.collect.regions if each.whole else ():
            found.setdefault(name, []).append(each.ground)
    return {name: union_all(grounds) for name, grounds in found.items()}


def _looks(
    scenario: Scenario, plan: Plan, asked: Asked, as_flown: Sortie | None, at_s: float
) -> list[Looked]:
    """What a search has looked at: as told, which was right now; as recorded; or as planned."""
    if asked.seen is not None:
        return [Looked(_area(shape, scenario, k), at_s, at_s) for k, shape in enumerate(asked.seen)]
    if as_flown is not None:
        return flown_looks(as_flown, scenario, plan)
    return planned_looks(scenario, plan, at_s)


def _name(record: FlightRecord, scenario: Scenario) -> str:
    """Which of the scenario's aircraft flew it."""
    return record.plan_vehicle or scenario.aircraft[0].name


def _recorded(samples: Sequence[TrackSample]) -> Now:
    """Where the record has it last; without a height it stays to be told."""
    first, last = samples[0], samples[-1]
    flown_m = math.fsum(_apart_m(one, other) for one, other in itertools.pairwise(samples))
    return Now(
        last.lon_deg,
        last.lat_deg,
        math.nan if last.altitude_home_m is None else last.altitude_home_m,
        _course_deg(samples),
        flown_m,
        last.time_s - first.time_s,
    )


def _course_deg(samples: Sequence[TrackSample]) -> float | None:
    """Over the ground: of the last places far enough apart to tell; else where the nose points."""
    last = samples[-1]
    for sample in reversed(samples[:-1]):
        bearing_deg, _, apart_m = GEOD.inv(sample.lon_deg, sample.lat_deg, last.lon_deg, last.lat_deg)
        if apart_m >= TELLING_M:
            return float(bearing_deg) % 360.0
    return last.heading_deg


def _apart_m(one: TrackSample, other: TrackSample) -> float:
    """In three dimensions."""
    up_m = (other.altitude_home_m or 0.0) - (one.altitude_home_m or 0.0)
    return math.hypot(GEOD.inv(one.lon_deg, one.lat_deg, other.lon_deg, other.lat_deg)[2], up_m)


def _told(name: str, told: Told, known: Now | None) -> Now:
    """What is told, and what is known besides."""
    given = {key: value for key in Told.__slots__ if (value := getattr(told, key)) is not None}
    missing = [key for key in ("lon_deg", "lat_deg", "height_m") if known is None and key not in given]
    if missing:
        raise RefusedError(
            f"where {name} is was not told",
            tuple(
                Finding(name, "missing-property", f"{key} is missing, and nobody recorded it", f"Add {key}.")
                for key in missing
            ),
        )
    if known is None:
        return Now(**{"heading_deg": None, **given})
    return replace(known, **given)


def _area(shape: Mapping[str, Any], scenario: Scenario, number: int) -> BaseGeometry:
    findings = Findings()
    owner = f"seen[{number}]"
    geometry = shape.get("geometry", shape) if shape.get("type") == "Feature" else shape
    if geometry.get("type") not in ("Polygon", "MultiPolygon"):
        findings.error(
            owner, "bad-geometry", f"is a {geometry.get('type')}", "Give a Polygon or MultiPolygon."
        )
        raise RefusedError("what was seen cannot be read", findings.errors)
    found = area(owner, geometry, scenario.frame, findings)
    if found is None or findings.errors:
        raise RefusedError("what was seen cannot be read", findings.errors)
    return found
