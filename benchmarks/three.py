"""Three simulated aircraft in the air at once, planned anew in the middle: how near do they really come?

All is done as in operation but for the waiting: missions are encoded for each autopilot, uploaded and read
back by the library's own machines; the new plan is made of what telemetry recorded, and takes the place of
the missions being flown. Where the aircraft really are is looked at every ``STEP_S``, and between two looks
their lines are taken to be straight. ``swathplan bench three``; ``--paths DIR`` keeps the record: both plans,
``tracks.geojson`` with what was really flown, and the links' frames, a folder of ``.tlog`` for each aircraft.
"""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.services.flights.seen import Flown, Sortie, judged
from app.services.plans.replanned import Changes
from app.services.plans.replanning import Asked, replan_of
from app.services.records import FlightRecord, TrackSample
from benchmarks.sky import EPOCH_S, STEP_S, FlightError, Linked, Sky
from mavlink.encoding.encode import encode
from mavlink.links.recording import TlogWriter
from mavlink.rules.heights import heights_of
from mavlink.sim.geodesy import Place
from mavlink.sim.settings import SimSettings
from planner.frames import LocalFrame
from planner.geojson import read_scenario, write_plan
from planner.pipeline import make_plan
from planner.plan import Plan, PlanVehicle
from planner.scenario import Scenario
from planner.wishes import Separation

NAME = "three-aircraft"
#: The ground at home, above sea level; nothing depends on it.
GROUND_M = 500.0
#: All are on the ground before this time, or something has gone wrong.
MOST_S = 1500.0
#: How early PX4's fixed wings pass a waypoint, seconds: 31 m at 14 m/s (measured, v1.16.0).
PX4_EARLY_S = 31.0 / 14.0
#: Climb and sink rates by those of the plan: what is set is no less than what is needed.
RATES_SPARE = 1.1
WIND_FROM_DEG = 270.0

Floats = NDArray[np.float64]


def run(
    at_s: float | tuple[float, ...] = (150.0, 300.0, 450.0),
    delay_s: float = 2.0,
    begins_in_s: float | None = None,
    wind_m_s: float = 0.0,
    paths: Path | None = None,
) -> Iterator[dict[str, Any]]:
    """For each time a row for each aircraft, and one on all of them.

    Parameters
    ----------
    at_s
        When the new plan is asked for, seconds after the first take-off; several of them one after the other.
    delay_s
        From the last telemetry that the new plan is made of to its missions going up.
    begins_in_s
        When the new plan is thought to begin, as the call for it takes it; None for its own choice.
    wind_m_s
        From the west, planned with and flown in.
    paths
        Folder for the record, one in it for each time.

    Raises
    ------
    FlightError
        An aircraft did not take or not fly its mission, or two came nearer than is to be kept.
    """
    document = json.loads(_example(f"{NAME}.geojson").read_text())
    if wind_m_s > 0.0:
        document["wind"] = {"speed_m_s": wind_m_s, "from_deg": WIND_FROM_DEG}
    changes = json.loads(_example(f"{NAME}-changes.json").read_text())
    asked = Changes(changes["add"], changes["remove"])
    scenario = read_scenario(document)
    plan = make_plan(scenario)
    for time_s in at_s if isinstance(at_s, tuple) else (at_s,):
        folder = None if paths is None else paths / f"{time_s:g}"
        flown = flight(document, scenario, plan, asked, time_s, delay_s, folder, begins_in_s)
        yield from flown.rows()
        flown.judge()


def _example(name: str) -> Path:
    return Path(__file__).parents[1] / "examples" / name


def flight(
    document: Mapping[str, Any],
    scenario: Scenario,
    plan: Plan,
    changes: Changes,
    at_s: float,
    delay_s: float,
    folder: Path | None,
    begins_in_s: float | None = None,
) -> Together:
    """Fly a plan, plan anew at a time, and fly on.

    Raises
    ------
    FlightError
        An aircraft did not take its mission, or is not down in time.
    """
    sky = Sky()
    writers = {}
    if folder is not None:
        writers = {v.name: TlogWriter(folder / v.name, clock=sky.clock_s) for v in plan.vehicles}
    for number, vehicle in enumerate(plan.vehicles, 1):
        tap = writers[vehicle.name].write if writers else None
        sky.add(Linked(vehicle.name, _settings(plan, vehicle, number, scenario), tap))
    try:
        flown = _fly(sky, document, scenario, plan, changes, at_s, delay_s, begins_in_s)
    finally:
        for writer in writers.values():
            writer.close()
    if folder is not None:
        _keep(folder, flown)
    return flown


def _fly(
    sky: Sky,
    document: Mapping[str, Any],
    scenario: Scenario,
    plan: Plan,
    changes: Changes,
    at_s: float,
    delay_s: float,
    begins_in_s: float | None,
) -> Together:
    for path in plan.paths:
        sky.give(path.vehicle, encode(plan, path.vehicle))
    begun_s = sky.now_s
    for path in sorted(plan.paths, key=lambda path: path.start_s):
        if path.start_s <= at_s:
            sky.until(begun_s + path.start_s)
            sky.start(path.vehicle)
    sky.until(begun_s + at_s)
    # What the new plan is made of is what was heard until now; they fly on while it is made.
    before = {name: each.cut_record() for name, each in sky.aircraft.items() if each.state.armed}
    left = replan_of(_sortie(document, plan, before), Asked(None, {}, None, changes, begins_in_s))
    left_scenario = read_scenario(left)
    again = make_plan(left_scenario)
    sky.until(begun_s + at_s + delay_s)
    again_s = begun_s + at_s + left["replan"]["begins_in_s"]
    for path in sorted(again.paths, key=lambda path: path.start_s):
        if path.vehicle not in before:
            sky.until(again_s + path.start_s)
        sky.give(path.vehicle, encode(again, path.vehicle))
        if path.vehicle not in before:
            sky.start(path.vehicle)
    sky.until_landed(MOST_S)
    after = {name: each.record() for name, each in sky.aircraft.items() if each.places}
    seen = judged(_sortie(left, again, after), left_scenario, again)
    least = min(seen.fraction.values())
    return Together(scenario, plan, again, sky, begun_s, at_s, again_s - begun_s, tuple(before), least)


@dataclass(frozen=True, slots=True)
class Together:
    """What came of it.

    Parameters
    ----------
    plan, again
        As it was planned, and planned anew.
    begun_s
        On the sky's clock, when the first took off.
    again_s
        When the new plan was to begin, after the first took off.
    aloft
        Who flew when it was planned anew.
    least_seen
        Part of the region seen least, of what was then left.
    """

    scenario: Scenario
    plan: Plan
    again: Plan
    sky: Sky
    begun_s: float
    at_s: float
    again_s: float
    aloft: tuple[str, ...]
    least_seen: float

    @property
    def nearest(self) -> Nearest:
        """How near any two came to each other."""
        rows = {
            name: _rows(each, self.scenario.frame) for name, each in self.sky.aircraft.items() if each.places
        }
        kept = self.scenario.kept_apart
        found = [Nearest((a, b), *near(rows[a], rows[b], kept)) for a, b in itertools.combinations(rows, 2)]
        return min(found, key=lambda each: each.across_m)

    def rows(self) -> Iterator[dict[str, Any]]:
        """One for each aircraft, and one on all of them."""
        for name, each in self.sky.aircraft.items():
            yield {
                "bench": "three",
                "at_s": self.at_s,
                "aircraft": name,
                "autopilot": each.aircraft.settings.autopilot.value,
                "items": [len(items) for items in each.given],
                "airborne_s": round(each.places[-1][0] - each.places[0][0], 1) if each.places else 0.0,
                "late_s": self.late_s(name),
                "landed": not each.aircraft.armed and each.aircraft.mission_complete,
            }
        kept, nearest = self.scenario.kept_apart, self.nearest
        yield {
            "bench": "three-total",
            "at_s": self.at_s,
            "aloft": len(self.aloft),
            "kept_m": kept.horizontal_m,
            "kept_up_m": kept.vertical_m,
            "least_m": round(nearest.across_m, 1),
            "least_of": ", ".join(nearest.of),
            "least_after_s": round(nearest.at_s - self.begun_s, 1),
            "hard_violations": len(self.plan.hard_violations) + len(self.again.hard_violations),
            "least_seen": round(self.least_seen, 4),
        }

    def late_s(self, name: str) -> float | None:
        """How much later than planned anew one has landed: who turns back is late by a circle or more."""
        path = next((path for path in self.again.paths if path.vehicle == name), None)
        if path is None or not self.sky.aircraft[name].places:
            return None
        planned_s = self.begun_s + self.again_s + path.start_s + path.duration_s
        return round(self.sky.aircraft[name].places[-1][0] - planned_s, 1)

    def judge(self) -> None:
        """Raise FlightError where two came too near, or one did not fly its mission to the end."""
        kept, nearest = self.scenario.kept_apart, self.nearest
        if nearest.across_m < kept.horizontal_m:
            raise FlightError(
                f"{' and '.join(nearest.of)} came within {nearest.across_m:.1f} m of each other and "
                f"{kept.vertical_m:g} m in height; {kept.horizontal_m:g} m are to be kept"
            )
        flown = {name: each for name, each in self.sky.aircraft.items() if each.places}
        unfinished = [name for name, each in flown.items() if not each.aircraft.mission_complete]
        if unfinished:
            raise FlightError(f"{', '.join(unfinished)} did not fly the mission to its end")


@dataclass(frozen=True, slots=True)
class Nearest:
    """How near two aircraft came across while they were nearer in height than is kept, and when.

    Infinite where they never were so near in height.
    """

    of: tuple[str, str]
    across_m: float
    at_s: float


def near(one: Floats, other: Floats, kept: Separation) -> tuple[float, float]:
    """The least distance across of two aircraft while they are near in height, and when.

    From one look to the next they move straight against each other; who is near in height anywhere between
    two looks counts as near there all the time.

    Parameters
    ----------
    one, other
        float64, shape (N, 4): seconds, in steps of ``STEP_S``, east_m, north_m, altitude_m; in flight only.
    """
    steps, here, there = np.intersect1d(
        np.rint(one[:, 0] / STEP_S), np.rint(other[:, 0] / STEP_S), return_indices=True
    )
    if not len(steps):
        return math.inf, math.nan
    apart = one[here, 1:] - other[there, 1:]
    # The last look of a run stands by itself.
    move = np.vstack([np.diff(apart, axis=0), np.zeros((1, 3))])
    move[np.append(np.diff(steps) > 1.0, True)] = 0.0
    speed2 = np.maximum((move[:, :2] ** 2).sum(axis=1), 1e-12)
    part = np.clip(-(apart[:, :2] * move[:, :2]).sum(axis=1) / speed2, 0.0, 1.0)
    across_m = np.hypot(*(apart[:, :2] + part[:, None] * move[:, :2]).T)
    ends_m = np.stack([apart[:, 2], apart[:, 2] + move[:, 2]])
    up_m = np.where(ends_m[0] * ends_m[1] <= 0.0, 0.0, np.abs(ends_m).min(axis=0))
    across_m = np.where(up_m < kept.vertical_m, across_m, np.inf)
    at = int(np.argmin(across_m))
    return float(across_m[at]), float((steps[at] + part[at]) * STEP_S)


def _settings(plan: Plan, vehicle: PlanVehicle, number: int, scenario: Scenario) -> SimSettings:
    """The aircraft that the plan is for, with the parameters that its preflight asks for."""
    lon_deg, lat_deg = vehicle.home
    needs = heights_of(plan, vehicle.name)
    aircraft = next(each for each in scenario.aircraft if each.name == vehicle.name)
    # Planned anew it may come down as steeply as it may at all, with the wind behind it.
    steepest_m_s = (vehicle.airspeed_m_s + scenario.wind.speed_m_s) * math.tan(
        math.radians(aircraft.max_climb_deg)
    )
    return SimSettings(
        home=Place(lat_deg, lon_deg, GROUND_M),
        autopilot=vehicle.autopilot,
        vehicle_type=vehicle.type,
        system_id=number,
        airspeed_m_s=vehicle.airspeed_m_s,
        turn_radius_m=vehicle.min_turn_radius_m,
        climb_m_s=RATES_SPARE * needs.climb_m_s,
        sink_m_s=RATES_SPARE * max(needs.sink_m_s, steepest_m_s),
        acceptance_m=PX4_EARLY_S * vehicle.airspeed_m_s if vehicle.autopilot == "px4" else 0.0,
        wind_m_s=scenario.wind.speed_m_s,
        wind_from_deg=WIND_FROM_DEG,
    )


def _sortie(
    document: Mapping[str, Any], plan: Plan, samples: Mapping[str, tuple[TrackSample, ...]]
) -> Sortie:
    """What was recorded of a plan's flights."""
    flights = tuple(
        Flown(
            FlightRecord(
                id=name,
                vehicle_id=name,
                vehicle_name=name,
                plan_id=NAME,
                plan_vehicle=name,
                state="flying",
                started_at=datetime.fromtimestamp(EPOCH_S, UTC),
                ended_at=None,
                points=len(track),
            ),
            track,
            (),
            (),
        )
        for name, track in samples.items()
    )
    return Sortie(NAME, json.dumps(write_plan(plan)), json.dumps(document), flights, None)


def _rows(linked: Linked, frame: LocalFrame) -> Floats:
    """Where it was while it flew: rows of seconds, east_m, north_m, altitude_m."""
    told = np.array(linked.places)
    return np.column_stack([told[:, 0], frame.to_local(told[:, [2, 1]]), told[:, 3]])


def _keep(folder: Path, flown: Together) -> None:
    """Write both plans, and what was flown; links were recorded as they spoke."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, plan in (("plan", flown.plan), ("replan", flown.again)):
        (folder / f"{name}.geojson").write_text(json.dumps(write_plan(plan)))
    features = [
        {
            "type": "Feature",
            "properties": {
                "role": "track",
                "vehicle": name,
                "times_s": [round(time_s - flown.begun_s, 2) for time_s, *_ in each.places],
            },
            "geometry": {
                "type": "LineString",
                "coordinates": [
                    [round(lon, 8), round(lat, 8), round(up, 2)] for _, lat, lon, up in each.places
                ],
            },
        }
        for name, each in flown.sky.aircraft.items()
        if len(each.places) > 1
    ]
    (folder / "tracks.geojson").write_text(json.dumps({"type": "FeatureCollection", "features": features}))
