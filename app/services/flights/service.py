"""What was flown, and what was really seen."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Any

from app.services.desk import Desk
from app.services.documents import read_object
from app.services.errors import ConflictError, NotFoundError
from app.services.flights.as_flown import SEEN_FRACTION, SLIVER_M, SLIVER_M2, gaps, regions_json, triggers
from app.services.flights.gpx import write_gpx
from app.services.flights.phases import flown_phases
from app.services.flights.photos import photos_of, spacing_of, switched_by_photos
from app.services.flights.refly import refly_scenario
from app.services.plans.missions import plan_of
from app.services.plans.planning import PlanningService
from app.services.records import FlightEvent, FlightRecord, TrackSample
from app.services.reports.report import write_flight_report
from app.services.store.flights import FlightStore
from app.services.terrain.rasters import stored_terrain
from planner.airspace.terrain import Terrains
from planner.as_flown import track as record_of
from planner.as_flown.coverage import FlownCoverage
from planner.geojson import read_scenario
from planner.geojson.geometry import written
from planner.geojson.sheet import continued
from planner.plan import Plan
from planner.scenario import Scenario
from planner.tasks.flown import flown_coverage


class FlightService:
    """Flights, their tracks, and the ground they saw."""

    def __init__(self, store: FlightStore, planning: PlanningService, desk: Desk) -> None:
        self._store = store
        self._planning = planning
        self._desk = desk

    async def newest(self, limit: int, offset: int, vehicle_id: str | None) -> tuple[FlightRecord, ...]:
        """Flights, newest first."""
        return await self._store.newest(limit, offset, vehicle_id)

    async def get(self, flight_id: str) -> FlightRecord:
        """One flight; raises NotFoundError."""
        return await self._store.get(flight_id)

    async def track(self, flight_id: str) -> dict[str, Any]:
        """The track as GeoJSON: the line, a piece for each time the sensor was on, the photos."""
        record = await self._store.get(flight_id)
        samples, photos, events = await self._as_recorded(record)
        return track_geojson(record, samples, photos, events)

    async def track_gpx(self, flight_id: str) -> str:
        """The track as GPX 1.1."""
        record = await self._store.get(flight_id)
        return write_gpx(record, await self._store.track(flight_id))

    async def coverage(self, flight_id: str) -> dict[str, Any]:
        """The ground seen, as GeoJSON, with the fraction of each region and the cross-track errors.

        Raises
        ------
        ConflictError
            The flight followed no plan of this service, or the plan has been deleted.
        """
        return await self._desk.run("flight", _coverage, await self._flown(flight_id))

    async def report(self, flight_id: str) -> str:
        """What was flown and seen, as one printable HTML page; raises as ``coverage``."""
        return await self._desk.run("flight", _report, await self._flown(flight_id))

    async def refly(self, flight_id: str, here: tuple[float, float, float | None] | None) -> dict[str, Any]:
        """The scenario of what a flight did not see.

        Parameters
        ----------
        here
            Longitude, latitude and course in degrees of the aircraft while it flies; None once it has landed.

        Raises
        ------
        ConflictError
            As ``coverage``, and when nothing worth a pass was missed.
        """
        return await self._desk.run("flight", _refly, await self._flown(flight_id), here)

    async def _as_recorded(
        self, record: FlightRecord
    ) -> tuple[tuple[TrackSample, ...], tuple[FlightEvent, ...], tuple[FlightEvent, ...]]:
        """Track, photos and all events; photos say where a sensor that is a camera was on."""
        samples = await self._store.track(record.id)
        events = await self._store.events(record.id)
        photos = photos_of(events)
        spacing = spacing_of(record.payload)
        if spacing is not None:
            samples = switched_by_photos(samples, photos, spacing)
        return samples, photos, events

    async def _flown(self, flight_id: str) -> _Flown:
        record = await self._store.get(flight_id)
        if record.plan_id is None:
            raise ConflictError("the flight followed no plan of this service")
        try:
            plan_text = await self._planning.plan_text(record.plan_id)
            scenario_text = await self._planning.scenario_text(record.plan_id)
        except NotFoundError as error:
            raise ConflictError("the flight's plan has been deleted") from error
        samples, photos, events = await self._as_recorded(record)
        return _Flown(
            record, plan_text, scenario_text, samples, photos, events, self._planning.terrain_folder
        )


@dataclass(frozen=True, slots=True)
class _Flown:
    """All that is known of a flight and its plan."""

    record: FlightRecord
    plan_text: str
    scenario_text: str
    samples: tuple[TrackSample, ...]
    photos: tuple[FlightEvent, ...]
    events: tuple[FlightEvent, ...]
    terrain_folder: Path | None

    @property
    def terrain(self) -> Terrains | None:
        """Uploaded rasters by their ids."""
        return None if self.terrain_folder is None else partial(stored_terrain, self.terrain_folder)


def _feature(geometry: dict[str, Any], **properties: Any) -> dict[str, Any]:
    return {"type": "Feature", "geometry": geometry, "properties": properties}


def _line(samples: Sequence[TrackSample]) -> list[list[float]]:
    """A line's positions; its longitudes go on from the first, beyond ±180° where it crosses there."""
    places = continued([(sample.lon_deg, sample.lat_deg) for sample in samples], samples[0].lon_deg)
    return [
        [lon, lat] if sample.altitude_amsl_m is None else [lon, lat, sample.altitude_amsl_m]
        for (lon, lat), sample in zip(places, samples, strict=True)
    ]


_OF_A_PHOTO = ("time_s", "index", "altitude_home_m", "heading_deg", "roll_deg", "pitch_deg")


def track_geojson(
    record: FlightRecord,
    samples: tuple[TrackSample, ...],
    photos: Sequence[FlightEvent] = (),
    events: Sequence[FlightEvent] = (),
) -> dict[str, Any]:
    """A track as a FeatureCollection: roles ``track``, ``sensor_on`` and ``photo``.

    Beside the line stand the vehicle's times in seconds since boot, the height above home, heading, roll and
    ground speed, one of each for every vertex. The member ``switches`` tells when the sensor, or the output
    that switches it, was reported on and off; ``actions`` what the service did by itself.
    """
    features = []
    if len(samples) > 1:
        line = {"type": "LineString", "coordinates": _line(samples)}
        columns = {
            "times_s": [sample.time_s for sample in samples],
            "altitudes_home_m": [sample.altitude_home_m for sample in samples],
            "headings_deg": [sample.heading_deg for sample in samples],
            "rolls_deg": [sample.roll_deg for sample in samples],
            "ground_speeds_m_s": [sample.ground_speed_m_s for sample in samples],
            "sensor_on": [sample.sensor_on for sample in samples],
        }
        features.append(_feature(line, role="track", vehicle=record.vehicle_name, **columns))
    for run in _runs(samples):
        line = {"type": "LineString", "coordinates": _line(run)}
        times = {"start_s": run[0].time_s, "end_s": run[-1].time_s}
        features.append(_feature(line, role="sensor_on", vehicle=record.vehicle_name, **times))
    for photo in photos:
        height = [] if photo.altitude_amsl_m is None else [photo.altitude_amsl_m]
        point = {"type": "Point", "coordinates": [photo.lon_deg, photo.lat_deg, *height]}
        told = {name: getattr(photo, name) for name in _OF_A_PHOTO}
        features.append(_feature(point, role="photo", vehicle=record.vehicle_name, **told))
    return {
        "type": "FeatureCollection",
        "flight": record.id,
        "plan": record.plan_id,
        "payload": record.payload,
        "switches": [
            {"time_s": event.time_s, "state": event.kind, "source": event.source, "index": event.index}
            for event in events
            if event.kind != "photo"
        ],
        "actions": [asdict(action) | {"at": action.at.isoformat()} for action in record.actions],
        "features": features,
    }


def _runs(samples: tuple[TrackSample, ...]) -> list[list[TrackSample]]:
    runs: list[list[TrackSample]] = [[]]
    for sample in samples:
        if sample.sensor_on:
            runs[-1].append(sample)
        elif runs[-1]:
            runs.append([])
    return [run for run in runs if len(run) > 1]


def seen_by(scenario: Scenario, plan: Plan, samples: tuple[TrackSample, ...]) -> FlownCoverage:
    """The ground a track saw; without a height or a roll nothing is seen."""
    track = [
        record_of.TrackSample(
            time_s=sample.time_s,
            lon_deg=sample.lon_deg,
            lat_deg=sample.lat_deg,
            height_m=math.nan if sample.altitude_home_m is None else sample.altitude_home_m,
            roll_deg=math.nan if sample.roll_deg is None else sample.roll_deg,
            sensor_on=sample.sensor_on,
            heading_deg=sample.heading_deg,
        )
        for sample in samples
    ]
    return flown_coverage(scenario, plan, track)


def _coverage(flight: _Flown) -> dict[str, Any]:
    """What a flight saw: roles ``seen`` and ``unseen`` by region, and figures as foreign members.

    Members: ``coverage`` {region: fraction as flown}, ``planned_coverage``, ``collects`` with the
    distance of the track from each planned line while the sensor was on, ``triggers`` with how the sensor
    was switched over each and which photos are missing, ``phases`` with how long each of the flight's was to
    take and took, and ``regions`` with what was wanted of each, what
    is missing, and whether it counts as ``seen``: from ``seen_fraction`` of it on.
    """
    record, samples = flight.record, flight.samples
    scenario = read_scenario(read_object(flight.scenario_text), flight.terrain)
    plan = plan_of(flight.plan_text)
    result = seen_by(scenario, plan, samples)
    switched = triggers(
        scenario, plan, record.plan_vehicle, samples, flight.photos, spacing_of(record.payload)
    )
    features = [
        _feature(written(shape, scenario.frame), role=role, roi=name, fraction=result.fraction[name])
        for role, shapes in (("seen", result.seen), ("unseen", result.unseen))
        for name, shape in shapes.items()
        if not shape.is_empty
    ]
    return {
        "type": "FeatureCollection",
        "flight": record.id,
        "plan": record.plan_id,
        "coverage": result.fraction,
        "planned_coverage": plan.metrics.coverage,
        "collects": [asdict(collect) for collect in result.passes],
        "triggers": [asdict(trigger) for trigger in switched],
        "phases": [
            asdict(phase)
            for path in plan.paths
            if path.vehicle == record.plan_vehicle or len(plan.paths) == 1
            for phase in flown_phases(path, samples)
        ],
        "seen_fraction": SEEN_FRACTION,
        "regions": regions_json(scenario, plan, result),
        "features": features,
    }


def _refly(flight: _Flown, here: tuple[float, float, float | None] | None) -> dict[str, Any]:
    document = read_object(flight.scenario_text)
    scenario = read_scenario(document, flight.terrain)
    missing = gaps(scenario, seen_by(scenario, plan_of(flight.plan_text), flight.samples))
    if not missing:
        raise ConflictError(
            "nothing is left to fly again for: what was not seen are slivers, each narrower "
            f"than {2 * SLIVER_M:g} m or smaller than {SLIVER_M2:g} m²"
        )
    return refly_scenario(document, missing, scenario.frame, flight.record.plan_vehicle, here)


def _report(flight: _Flown) -> str:
    track = track_geojson(flight.record, flight.samples)
    return write_flight_report(flight.record, read_object(flight.scenario_text), track, _coverage(flight))
