"""What the flights of a plan saw together, and what is left to fly again for.

A flight that was split by a restart, a change of battery or an upload is one sortie: its parts are judged
together, and where nobody recorded between two of them it is not known what was seen.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from datetime import datetime, timedelta
from functools import partial
from pathlib import Path
from typing import Any

from app.services.documents import read_object
from app.services.errors import ConflictError
from app.services.flights.as_flown import (
    SEEN_FRACTION,
    SLIVER_M,
    SLIVER_M2,
    Recorded,
    Trigger,
    collects_of,
    gaps,
    regions_json,
    triggers,
)
from app.services.flights.phases import flown_phases
from app.services.flights.photo_coverage import photo_triggers, photos_json, taken_of
from app.services.flights.photos import spacing_of
from app.services.flights.refly import refly_scenario
from app.services.flights.track_json import feature, line_of, track_geojson
from app.services.plans.filed_mission import MEMBER
from app.services.plans.missions import plan_of
from app.services.records import FlightEvent, FlightRecord, TrackSample
from app.services.reports.report import write_flight_report
from app.services.terrain.rasters import stored_terrain
from planner.airspace.terrain import Terrains
from planner.as_flown.coverage import FlownCoverage
from planner.as_flown.passes import REASONS
from planner.as_flown.track import Gap, Record, silences
from planner.as_flown.track import TrackSample as Place
from planner.geojson import read_scenario
from planner.geojson.geometry import written
from planner.plan import FlownPath, Plan
from planner.scenario import Scenario
from planner.tasks.flown import sortie_coverage


@dataclass(frozen=True, slots=True)
class Flown:
    """All that was recorded of one flight; a sensor that is a camera is on where its photos say so."""

    record: FlightRecord
    samples: tuple[TrackSample, ...]
    photos: tuple[FlightEvent, ...]
    events: tuple[FlightEvent, ...]


@dataclass(frozen=True, slots=True)
class Sortie:
    """Flights of one plan, as they were begun."""

    plan_id: str
    plan_text: str
    scenario_text: str
    flights: tuple[Flown, ...]
    terrain_folder: Path | None

    @property
    def terrain(self) -> Terrains | None:
        """Uploaded rasters by their ids."""
        return None if self.terrain_folder is None else partial(stored_terrain, self.terrain_folder)


def seen_by(
    scenario: Scenario,
    plan: Plan,
    samples: tuple[TrackSample, ...],
    photos: Sequence[FlightEvent] = (),
) -> FlownCoverage:
    """The ground a track saw, and its photos; without a height or a roll nothing is seen."""
    return sortie_coverage(scenario, plan, (Record(_places(samples), photos=taken_of(photos, samples)),))


def _places(samples: Sequence[TrackSample]) -> tuple[Place, ...]:
    return tuple(
        Place(
            time_s=sample.time_s,
            lon_deg=sample.lon_deg,
            lat_deg=sample.lat_deg,
            height_m=math.nan if sample.altitude_home_m is None else sample.altitude_home_m,
            roll_deg=math.nan if sample.roll_deg is None else sample.roll_deg,
            sensor_on=sample.sensor_on,
            heading_deg=sample.heading_deg,
            pitch_deg=sample.pitch_deg,
            mount_deg=_mount_deg(sample),
        )
        for sample in samples
    )


def _mount_deg(sample: TrackSample) -> tuple[float, float, float] | None:
    roll_deg, pitch_deg, yaw_deg = sample.mount_roll_deg, sample.mount_pitch_deg, sample.mount_yaw_deg
    if roll_deg is None or pitch_deg is None or yaw_deg is None:
        return None
    return roll_deg, pitch_deg, yaw_deg


def judged(sortie: Sortie, scenario: Scenario, plan: Plan) -> FlownCoverage:
    """What was seen, and what nobody knows."""
    return sortie_coverage(scenario, plan, records_of(sortie))


def records_of(sortie: Sortie) -> list[Record]:
    """What the judge takes of its flights."""
    records = []
    for number, flight in enumerate(sortie.flights):
        later = [
            other
            for other in sortie.flights[number + 1 :]
            if other.record.vehicle_id == flight.record.vehicle_id and other.samples
        ]
        gap = _gap_after(flight, later[0] if later else None)
        photos = taken_of(flight.photos, flight.samples)
        own = flight.record
        records.append(Record(_places(flight.samples), own.plan_vehicle, gap, photos, own.plan_sortie))
    return records


def _gap_after(flight: Flown, later: Flown | None) -> Gap | None:
    """What was flown when the record had ended; None where the flight had ended, too, or goes on."""
    if flight.record.state != "interrupted" or not flight.samples:
        return None
    last = flight.samples[-1]
    if last.from_log:
        return None  # the log goes on to its own end, where the vehicle was disarmed
    here = (last.lon_deg, last.lat_deg)
    if later is None:
        return Gap(last.time_s, None, None, (here, None))
    first = later.samples[0]
    lasted_s = (moment(later, first.time_s) - moment(flight, last.time_s)).total_seconds()
    if first.time_s >= last.time_s:
        # The clock of an aircraft that flew on has run on; that of the service may have been set.
        lasted_s = max(lasted_s, first.time_s - last.time_s)
    return Gap(last.time_s, first.time_s, max(lasted_s, 0.0), (here, (first.lon_deg, first.lat_deg)))


def moment(flight: Flown, time_s: float) -> datetime:
    """When it was by the service's clock."""
    began_s = flight.samples[0].time_s if flight.samples else time_s
    return flight.record.started_at + timedelta(seconds=time_s - began_s)


def coverage_of(sortie: Sortie) -> dict[str, Any]:
    """What flights saw: roles ``seen``, ``unseen``, ``unknown`` by region, ``not_counted`` along the tracks.

    Foreign members: ``coverage`` {region: fraction as flown}, ``unknown_coverage`` {region: fraction that
    nobody knows of}, ``planned_coverage``, ``collects`` with the distance of the track from each planned line
    while the sensor was on, ``triggers`` with how the sensor was switched over each and which photos are
    missing, ``phases`` with how long each of a flight's was to take and took, ``regions`` with what was
    wanted of each, what is missing, and whether it counts as ``seen``: from ``seen_fraction`` of it on;
    ``photos`` with how many were taken, counted and lost, and the overlaps and ground sampled distances
    reached; ``assumed`` ground is that of photos which nobody reported, and neither seen nor unseen by it;
    ``gaps`` of the record, each with its time; ``not_counted`` with what was flown with the sensor on for
    nothing, and why; ``energy`` planned and drawn; ``flights``.
    """
    document = read_object(sortie.scenario_text)
    if names_no_region(sortie.plan_text, document):
        return record_of_file(sortie)
    scenario, plan = _asked(sortie, document), plan_of(sortie.plan_text)
    result = judged(sortie, scenario, plan)
    recorded = [
        Recorded(
            f.record.plan_vehicle, f.samples, f.photos, spacing_of(f.record.payload), f.record.plan_sortie
        )
        for f in sortie.flights
    ]
    by_photos = {} if result.photos is None else result.photos.regions
    assumed = {name: region.assumed for name, region in by_photos.items()}
    shapes = (
        ("seen", result.seen),
        ("unseen", result.unseen),
        ("unknown", result.unknown),
        ("assumed", assumed),
    )
    features = [
        feature(written(shape, scenario.frame), role=role, roi=name, fraction=result.fraction[name])
        for role, by_name in shapes
        for name, shape in by_name.items()
        if not shape.is_empty
    ]
    left = _not_counted(sortie, result)
    for one, (first, last) in left:
        samples = sortie.flights[one["record"]].samples[first : last + 1]
        line = {"type": "LineString", "coordinates": line_of(samples)}
        features.append(feature(line, role="not_counted", **one))
    return _told(sortie, plan) | {
        "coverage": result.fraction,
        "unknown_coverage": result.unknown_fraction,
        "planned_coverage": plan.metrics.coverage,
        "collects": [asdict(collect) for collect in result.passes],
        "triggers": [asdict(t) for t in _triggers(scenario, plan, recorded, result)],
        "photos": photos_json(scenario, result, collects_of(plan, recorded)),
        "regions": regions_json(scenario, plan, result),
        "gaps": _gaps(sortie, result.gaps),
        "not_counted": [one for one, _ in left],
        "features": features,
    }


def _triggers(
    scenario: Scenario, plan: Plan, recorded: Sequence[Recorded], result: FlownCoverage
) -> list[Trigger]:
    """Of all collects flown for; those of photos by their photos, whatever of the payload was recorded."""
    by_photos = photo_triggers(plan, result, collects_of(plan, recorded))
    told = {(trigger.vehicle, trigger.seq) for trigger in by_photos}
    switched = triggers(scenario, plan, recorded, result.unknown_parts)
    left = [trigger for trigger in switched if (trigger.vehicle, trigger.seq) not in told]
    return sorted([*by_photos, *left], key=lambda trigger: trigger.seq)


def asked_of(sortie: Sortie) -> tuple[Scenario, Plan]:
    """What was to be seen, and the plan to see it; raises as ``coverage_of``."""
    return _asked(sortie, read_object(sortie.scenario_text)), plan_of(sortie.plan_text)


def _asked(sortie: Sortie, document: dict[str, Any]) -> Scenario:
    """What was to be seen; raises ConflictError for a mission file that names no regions."""
    if names_no_region(sortie.plan_text, document):
        raise ConflictError("the flight followed a mission file without regions: nothing was to be seen")
    return read_scenario(document, sortie.terrain)


def names_no_region(plan_text: str, scenario: Mapping[str, Any]) -> bool:
    """Whether a flight followed a mission file that no scenario with regions goes with."""
    roles = {feature["properties"].get("role") for feature in scenario["features"]}
    return MEMBER in read_object(plan_text) and "roi" not in roles


def record_of_file(sortie: Sortie) -> dict[str, Any]:
    """As ``coverage_of``, where nothing was to be seen: gaps of the record, phases and energy."""
    plan = plan_of(sortie.plan_text)
    return _told(sortie, plan) | {
        "coverage": {},
        "unknown_coverage": {},
        "planned_coverage": {},
        "collects": [],
        "triggers": [],
        "photos": None,
        "regions": [],
        "gaps": _gaps(sortie, [silences(record) for record in records_of(sortie)]),
        "not_counted": [],
        "features": [],
    }


def _told(sortie: Sortie, plan: Plan) -> dict[str, Any]:
    """What does not depend on regions."""
    alone = len(sortie.flights) == 1
    return {
        "type": "FeatureCollection",
        "flight": sortie.flights[0].record.id if alone else None,
        "flights": [flight.record.id for flight in sortie.flights],
        "plan": sortie.plan_id,
        "phases": [
            asdict(phase)
            for flight in sortie.flights[:1]
            if alone
            for path in _paths_of(flight.record, plan)
            for phase in flown_phases(path, flight.samples, _home_altitude_m(plan, path.vehicle))
        ],
        "seen_fraction": SEEN_FRACTION,
        "energy": [_energy(flight, plan) for flight in sortie.flights],
    }


def _home_altitude_m(plan: Plan, name: str) -> float | None:
    """Of a vehicle that the plan begins with in the air; None for the others."""
    return next((vehicle.home_altitude_m for vehicle in plan.vehicles if vehicle.name == name), None)


def _paths_of(record: FlightRecord, plan: Plan) -> list[FlownPath]:
    """The line of a plan that a flight followed, of its own sortie; none where the plan has no such."""
    if len(plan.paths) == 1:
        return list(plan.paths)
    own = (record.plan_vehicle, record.plan_sortie)
    return [path for path in plan.paths if (path.vehicle, path.sortie) == own]


def _gaps(sortie: Sortie, gaps_of: Sequence[Sequence[Gap]]) -> list[dict[str, Any]]:
    return [
        {
            "flight": flight.record.id,
            "start_s": gap.start_s,
            "end_s": gap.end_s,
            "duration_s": gap.duration_s,
            "start_at": moment(flight, gap.start_s).isoformat(),
            "end_at": None
            if gap.duration_s is None
            else moment(flight, gap.start_s + gap.duration_s).isoformat(),
            "from": list(gap.places[0]),
            "to": None if gap.places[1] is None else list(gap.places[1]),
        }
        for flight, gaps_ in zip(sortie.flights, gaps_of, strict=True)
        for gap in gaps_
    ]


def _not_counted(sortie: Sortie, result: FlownCoverage) -> list[tuple[dict[str, Any], tuple[int, int]]]:
    return [
        (
            {
                "record": one.record,
                "flight": sortie.flights[one.record].record.id,
                "start_s": one.start_s,
                "end_s": one.end_s,
                "length_m": one.length_m,
                "reason": one.reason,
                "why": REASONS[one.reason],
            },
            one.samples,
        )
        for one in result.not_counted
    ]


def _energy(flight: Flown, plan: Plan) -> dict[str, Any]:
    """What the plan says a flight takes, and what its batteries told."""
    record = flight.record
    paths = _paths_of(record, plan)
    drawn = record.energy
    return {
        "flight": record.id,
        "planned_wh": paths[0].energy_wh if paths else None,
        "drawn_wh": None if drawn is None else drawn.used_wh,
        "source": None if drawn is None else drawn.source,
        "complete": None if drawn is None else drawn.complete,
    }


def refly_of(
    sortie: Sortie, vehicle: str | None, here: tuple[float, float, float | None] | None
) -> dict[str, Any]:
    """The scenario of what none of the flights is known to have seen."""
    document = read_object(sortie.scenario_text)
    scenario = _asked(sortie, document)
    missing = gaps(scenario, judged(sortie, scenario, plan_of(sortie.plan_text)))
    if not missing:
        raise ConflictError(
            "nothing is left to fly again for: what was not seen are slivers, each narrower "
            f"than {2 * SLIVER_M:g} m or smaller than {SLIVER_M2:g} m²"
        )
    return refly_scenario(document, missing, scenario.frame, vehicle, here)


def report_of(sortie: Sortie) -> str:
    """The printable report of one flight."""
    flight = sortie.flights[0]
    track = track_geojson(flight.record, flight.samples)
    return write_flight_report(flight.record, read_object(sortie.scenario_text), track, coverage_of(sortie))
