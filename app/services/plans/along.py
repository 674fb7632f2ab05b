"""A plan's flights by their times: where each is when, where on its line a place is, what it sees between."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry

from app.services.plans.looked import beginning, footprint_of
from planner.plan import Collect, Plan
from planner.scenario import Scenario

Floats = NDArray[np.float64]

#: An aircraft this near to its line, across and in height, and on this course about, is flying it.
NEAR_M, NEAR_UP_M, COURSE_RAD = 60.0, 60.0, math.radians(60.0)
#: How long until a new mission is flown: planning, and each of its items sent up and read back.
PLANNING_S, ITEM_S = 2.0, 0.1
#: A mission has about so many items for each piece of its line.
ITEMS_EACH = 2


@dataclass(frozen=True, slots=True)
class Now:
    """Where an aircraft is, and what it has used: degrees, metres over its home, course from true north.

    ``energy_left_wh`` is what its battery holds; None where that is not known.
    """

    lon_deg: float
    lat_deg: float
    height_m: float
    heading_deg: float | None
    flown_m: float = 0.0
    flown_s: float = 0.0
    energy_left_wh: float | None = None


@dataclass(frozen=True, slots=True)
class Soon:
    """What a plan sees of a pass until an aircraft takes up another mission.

    Parameters
    ----------
    ground
        In the scenario's frame.
    in_s, until_s
        When, from now on.
    whole
        Whether the pass is over by then.
    """

    collect: Collect
    ground: BaseGeometry
    in_s: float
    until_s: float
    whole: bool


class Course:
    """One flight of a plan, its line by time; seconds are from its lift-off."""

    def __init__(self, scenario: Scenario, plan: Plan, vehicle: str, sortie: int) -> None:
        own = plan.of(vehicle, sortie)
        path = own.paths[0]
        self._scenario, self._path, self._plan = scenario, path, plan
        self._collects = own.collects
        self._own = own
        marks = {(phase.start_s, phase.start_m) for phase in path.phases}
        marks |= {(phase.end_s, phase.end_m) for phase in path.phases}
        for collect in own.collects:
            marks |= {(collect.start_s, collect.start_m), (collect.end_s, collect.end_m)}
        knots = np.array(sorted(marks | {(0.0, 0.0), (path.duration_s, path.length_m)}))
        self._times_s, self._marks_m = knots[:, 0], np.maximum.accumulate(knots[:, 1])
        line = np.array(path.line)
        self._places = np.column_stack([scenario.frame.to_local(line[:, :2]), line[:, 2]])
        steps = np.diff(self._places, axis=0)
        along_m = np.concatenate([[0.0], np.cumsum(np.sqrt((steps**2).sum(axis=1)))])
        # Chords of arcs are a little shorter than what is flown.
        self._along_m = along_m * (path.length_m / along_m[-1])
        self._home_m = plan.home_altitude_m(vehicle, sortie)

    @property
    def duration_s(self) -> float:
        """From lift-off to its end."""
        return float(self._path.duration_s)

    @property
    def leaves_s(self) -> float:
        """When it begins to land; its end where it does not."""
        lands = [phase.start_s for phase in self._path.phases if phase.kind == "landing"]
        return float(lands[-1]) if lands else self.duration_s

    def place(self, since_s: float) -> Now:
        """Where it is, and what it has used."""
        along_m = self._mark_m(since_s)
        k = int(np.clip(np.searchsorted(self._along_m, along_m, side="right") - 1, 0, len(self._places) - 2))
        here, there = self._places[k], self._places[k + 1]
        step_m = self._along_m[k + 1] - self._along_m[k]
        part = min(max((along_m - self._along_m[k]) / step_m, 0.0), 1.0) if step_m > 0.0 else 0.0
        east_m, north_m, altitude_m = (here + part * (there - here)).tolist()
        lon_deg, lat_deg = (float(v) for v in self._scenario.frame.to_wgs84(np.array([east_m, north_m])))
        angle_rad = math.atan2(*(there - here)[1::-1].tolist())
        heading_deg = self._scenario.frame.true_heading_deg(east_m, north_m, angle_rad)
        left_wh = None
        aircraft = next(a for a in self._scenario.aircraft if a.name == self._path.vehicle)
        if aircraft.energy_wh is not None and self._path.energy_wh is not None:
            left_wh = aircraft.energy_wh - since_s / self.duration_s * self._path.energy_wh
        return Now(lon_deg, lat_deg, altitude_m - self._home_m, heading_deg, along_m, since_s, left_wh)

    def line(self, from_s: float, until_s: float) -> tuple[tuple[float, float, float], ...]:
        """Its way between two times: degrees, and metres over its home."""
        first_m, last_m = self._mark_m(from_s), self._mark_m(until_s)
        between = self._along_m[(self._along_m > first_m) & (self._along_m < last_m)]
        at_m = np.concatenate([[first_m], between, [last_m]])
        places = np.column_stack([np.interp(at_m, self._along_m, column) for column in self._places.T])
        lonlats = self._scenario.frame.to_wgs84(places[:, :2])
        rows = np.column_stack([lonlats, places[:, 2] - self._home_m]).tolist()
        return tuple((lon_deg, lat_deg, height_m) for lon_deg, lat_deg, height_m in rows)

    def _mark_m(self, since_s: float) -> float:
        return float(np.interp(since_s, self._times_s, self._marks_m))

    def since_s(self, now: Now) -> float | None:
        """When it is where an aircraft is, on its course; None where the aircraft is not on its line.

        Of several times, where the line crosses itself, that which is nearest to what has been flown.
        """
        here = np.append(
            self._scenario.frame.to_local((now.lon_deg, now.lat_deg)), now.height_m + self._home_m
        )
        begins, steps = self._places[:-1], np.diff(self._places, axis=0)
        square = np.maximum((steps[:, :2] ** 2).sum(axis=1), 1e-12)
        parts = np.clip(((here - begins)[:, :2] * steps[:, :2]).sum(axis=1) / square, 0.0, 1.0)
        off = begins + parts[:, None] * steps - here
        off_m = np.hypot(off[:, 0], off[:, 1])
        near = (off_m <= NEAR_M) & (np.abs(off[:, 2]) <= NEAR_UP_M)
        if now.heading_deg is not None:
            angle_rad = self._scenario.frame.angle_rad(float(here[0]), float(here[1]), now.heading_deg)
            turned = np.arctan2(steps[:, 1], steps[:, 0]) - angle_rad
            near &= np.abs(np.mod(turned + math.pi, math.tau) - math.pi) <= COURSE_RAD
        found_s: list[float] = []
        for run in _runs(near):
            k = run[int(np.argmin(off_m[run]))]
            along_m = self._along_m[k] + parts[k] * (self._along_m[k + 1] - self._along_m[k])
            found_s.append(float(np.interp(along_m, self._marks_m, self._times_s)))
        return min(found_s, key=lambda each: abs(each - now.flown_s)) if found_s else None

    def seen(self, from_s: float, until_s: float) -> list[Soon]:
        """What it sees between two times."""
        found = []
        for collect in self._collects:
            begin_s, end_s = max(collect.start_s, from_s), min(collect.end_s, until_s)
            if begin_s >= end_s:
                continue
            shape = footprint_of(self._scenario, self._own, collect)
            ends = self._scenario.frame.to_local([place[:2] for place in (collect.line[0], collect.line[-1])])
            way = ends[1] - ends[0]
            lasts_s = collect.end_s - collect.start_s
            done = beginning(shape, way, (end_s - collect.start_s) / lasts_s)
            if begin_s > collect.start_s:
                done = done.difference(beginning(shape, way, (begin_s - collect.start_s) / lasts_s))
            found.append(Soon(collect, done, begin_s - from_s, end_s - from_s, collect.end_s <= until_s))
        return found


def _runs(mask: NDArray[np.bool_]) -> list[NDArray[np.int64]]:
    """Numbers of what is true, those that follow each other together."""
    places = np.flatnonzero(mask)
    return [run for run in np.split(places, np.flatnonzero(np.diff(places) > 1) + 1) if len(run)]


def where_planned(scenario: Scenario, plan: Plan, at_s: float) -> dict[str, Now]:
    """Where a plan has its aircraft at a time of its own; those on the ground then are left out."""
    found: dict[str, Now] = {}
    for path in plan.paths:
        if path.start_s < at_s < path.start_s + path.duration_s:
            place = Course(scenario, plan, path.vehicle, path.sortie).place(at_s - path.start_s)
            if place.height_m > 0.0:
                found[path.vehicle] = place
    return found


def allowance_s(plan: Plan, names: Sequence[str]) -> float:
    """How long until aircraft in flight have a new mission, about as long as the one they fly."""
    items = [ITEMS_EACH * len(path.segments) for path in plan.paths if path.vehicle in names]
    return round(PLANNING_S + ITEM_S * max(items), 1) if items else 0.0


@dataclass(frozen=True, slots=True)
class Ahead:
    """What an aircraft flies until it takes up another mission.

    Parameters
    ----------
    then
        Where it is by then.
    soon
        What it sees on its way there.
    line
        That way: degrees, and metres over its home.
    """

    then: Now
    soon: list[Soon]
    line: tuple[tuple[float, float, float], ...]


def ahead(scenario: Scenario, plan: Plan, name: str, now: Now, by_s: float) -> Ahead | None:
    """Where an aircraft is so much later by the mission that it flies, and what it sees until then.

    One that begins to land before is where it does. None where it is on no line of the plan, or lands.
    """
    found: list[tuple[float, Course, float]] = []
    for path in plan.paths:
        if path.vehicle != name:
            continue
        course = Course(scenario, plan, name, path.sortie)
        since_s = course.since_s(now)
        if since_s is not None and since_s < course.leaves_s:
            found.append((abs(since_s - now.flown_s), course, since_s))
    if not found:
        return None
    _, course, since_s = min(found, key=lambda each: each[0])
    until_s = min(since_s + by_s, course.leaves_s)
    here, there = course.place(since_s), course.place(until_s)
    left_wh = now.energy_left_wh
    if left_wh is not None and here.energy_left_wh is not None and there.energy_left_wh is not None:
        left_wh -= here.energy_left_wh - there.energy_left_wh
    later = replace(
        there,
        flown_m=now.flown_m + there.flown_m - here.flown_m,
        flown_s=now.flown_s + until_s - since_s,
        energy_left_wh=left_wh,
    )
    return Ahead(later, course.seen(since_s, until_s), course.line(since_s, until_s))
