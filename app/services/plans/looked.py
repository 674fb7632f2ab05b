"""What a search has looked at so far, as its scenario says it: the member ``search.seen``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import timedelta
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from app.services.errors import ConflictError
from app.services.flights.as_flown import SLIVER_M, SLIVER_M2
from app.services.flights.seen import Sortie, judged, moment, records_of
from planner.geojson.geometry import areal, written
from planner.plan import Collect, Plan
from planner.scenario import Scenario
from planner.tasks.flown import sortie_looks

#: Outlines of what was seen are straightened by no more than this, to the inside: in doubt nothing is seen.
STRAIGHT_M = 0.2


@dataclass(frozen=True, slots=True)
class Looked:
    """One look at ground, in the scenario's frame.

    Parameters
    ----------
    start_s, end_s
        Seconds after the search's start.
    heading_deg
        Flown over in this direction; None where all at once.
    """

    ground: BaseGeometry
    start_s: float
    end_s: float
    heading_deg: float | None = None


def footprint_of(scenario: Scenario, plan: Plan, collect: Collect) -> BaseGeometry:
    """The ground that one pass of a plan sees, in the scenario's frame."""
    return shapely.union_all(
        [
            Polygon(scenario.frame.to_local(f.ring), [scenario.frame.to_local(hole) for hole in f.holes])
            for f in plan.footprints
            if (f.vehicle, f.seq) == (collect.vehicle, collect.seq)
        ]
    )


def planned_looks(scenario: Scenario, plan: Plan, at_s: float) -> list[Looked]:
    """The looks of a plan up to a time of its own; one that is being had then as far as it has come."""
    found = []
    for collect in plan.collects:
        if collect.start_s >= at_s:
            continue
        shape = footprint_of(scenario, plan, collect)
        begin, end = scenario.frame.to_local([place[:2] for place in (collect.line[0], collect.line[-1])])
        part = min((at_s - collect.start_s) / max(collect.end_s - collect.start_s, 1e-9), 1.0)
        ground = beginning(shape, end - begin, part)
        if not ground.is_empty:
            until_s = min(collect.end_s, at_s)
            found.append(Looked(ground, collect.start_s, until_s, heading_deg(scenario, collect)))
    return found


def heading_deg(scenario: Scenario, collect: Collect) -> float:
    """In which direction it is flown."""
    begin, end = scenario.frame.to_local([place[:2] for place in (collect.line[0], collect.line[-1])])
    angle_rad = float(np.arctan2(*(end - begin)[::-1]))
    return scenario.frame.true_heading_deg(float(begin[0]), float(begin[1]), angle_rad)


def beginning(shape: BaseGeometry, way: NDArray[np.float64], part: float) -> BaseGeometry:
    """So much of ground along a way, from its rear on."""
    if part >= 1.0 or shape.is_empty:
        return shape
    along = way / float(np.hypot(*way))
    aside = np.array([-along[1], along[0]])
    own = shapely.get_coordinates(shape) @ np.stack([along, aside], axis=1)
    (rear_m, right_m), (front_m, left_m) = own.min(axis=0), own.max(axis=0)
    ahead_m = rear_m + part * (front_m - rear_m)
    corners = [(rear_m, right_m), (ahead_m, right_m), (ahead_m, left_m), (rear_m, left_m)]
    return shapely.intersection(shape, Polygon([a * along + b * aside for a, b in corners]))


def flown_looks(sortie: Sortie, scenario: Scenario, plan: Plan) -> list[Looked]:
    """The looks that recorded flights had, of any aircraft."""
    if _once(scenario):
        return [Looked(shapely.union_all(list(judged(sortie, scenario, plan).seen.values())), 0.0, 0.0)]
    begun = [flight for flight in sortie.flights if flight.samples]
    start = min(moment(flight, flight.samples[0].time_s) for flight in begun)

    def since_s(number: int, time_s: float) -> float:
        return (moment(sortie.flights[number], time_s) - start) / timedelta(seconds=1.0)

    return [
        Looked(
            look.ground,
            since_s(look.record, look.start_s),
            since_s(look.record, look.end_s),
            scenario.frame.heading_deg(look.course_rad),
        )
        for look in sortie_looks(scenario, plan, records_of(sortie))
    ]


def _once(scenario: Scenario) -> bool:
    """Whether a look finds all there is, and when it was is nothing to it."""
    return scenario.importance.detection >= 1.0 and scenario.importance.drift is None


def searched_on(
    made: dict[str, Any], scenario: Scenario, looks: Sequence[Looked], at_s: float, *, changed: bool
) -> None:
    """Put looks into a scenario of a search that goes on at a time of the old one's.

    Parameters
    ----------
    changed
        Whether features come in: they may be ground to be seen.

    Raises
    ------
    ConflictError
        Nothing is left to be seen.
    """
    old: Mapping[str, Any] = made.get("search") or {}
    seen = [_earlier(entry, at_s) for entry in old.get("seen") or []]
    if _once(scenario):
        ground = shapely.union_all([region.area for region in scenario.regions])
        found = shapely.union_all([look.ground for look in looks])
        found = shapely.union_all([found, *_slivers(ground, found)])
        if not changed and shapely.difference(ground, found).area < SLIVER_M2:
            raise ConflictError("nothing is left to be seen")
        looks = [Looked(found, at_s, at_s)]
    for look in looks:
        shape = areal(look.ground.buffer(-STRAIGHT_M).simplify(STRAIGHT_M))
        if shape.is_empty:
            continue
        told: dict[str, Any] = {}
        if not _once(scenario):
            # One that the clock has after the search's new start was had right before it.
            ago_s = [round(max(at_s - s, 0.0), 3) for s in (look.start_s, look.end_s)]
            told = {"ago_s": ago_s}
            if look.heading_deg is not None:
                told["heading_deg"] = round(look.heading_deg % 360.0, 4)
        seen.append({"type": "Feature", "geometry": written(shape, scenario.frame), "properties": told})
    search = {**old, "seen": seen}
    if search.get("drift") is not None:
        drift = search["drift"]
        search["drift"] = {**drift, "elapsed_s": (drift.get("elapsed_s") or 0.0) + at_s}
    made["search"] = search


def _earlier(entry: Mapping[str, Any], by_s: float) -> dict[str, Any]:
    """A look that is longer ago now."""
    if entry.get("type") != "Feature":
        entry = {"type": "Feature", "geometry": entry, "properties": {}}
    told = dict(entry.get("properties") or {})
    told["ago_s"] = [value + by_s for value in told.get("ago_s", (0.0, 0.0))]
    return {**entry, "properties": told}


def _slivers(ground: BaseGeometry, seen: BaseGeometry) -> list[BaseGeometry]:
    """What is left beside what was seen, and too little to fly for again."""
    parts = [
        p for p in shapely.get_parts(shapely.difference(ground, seen)).tolist() if isinstance(p, Polygon)
    ]
    return [
        part
        for part in parts
        if (part.area < SLIVER_M2 or part.buffer(-SLIVER_M).is_empty) and part.distance(seen) <= STRAIGHT_M
    ]
