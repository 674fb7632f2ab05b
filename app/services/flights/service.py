"""What was flown, and what was really seen."""

from __future__ import annotations

import asyncio
import tempfile
from collections.abc import Sequence
from typing import Any

from app.services.desk import Desk
from app.services.errors import ConflictError, NotFoundError
from app.services.flights.filling import filling
from app.services.flights.gpx import write_gpx
from app.services.flights.photo_raster import RasterKind, raster_of
from app.services.flights.photos import photos_of, spacing_of, switched_by_photos
from app.services.flights.seen import Flown, Sortie, coverage_of, refly_of, report_of
from app.services.flights.track_json import track_geojson
from app.services.plans.planning import PlanningService
from app.services.plans.replanning import Asked, replan_of
from app.services.records import FlightEvent, FlightRecord, TrackSample
from app.services.store.flights import FlightStore


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
        """The ground one flight saw, as GeoJSON; see ``seen.coverage_of``.

        Raises
        ------
        ConflictError
            The flight followed no plan of this service, or the plan has been deleted.
        """
        return await self._desk.run("flight", coverage_of, await self._alone(flight_id))

    async def raster(self, flight_id: str, kind: RasterKind, roi: str | None) -> bytes:
        """How often or how finely one flight's photos saw regions, as GeoTIFF; raises as ``coverage``."""
        return await self._desk.run("flight", raster_of, await self._alone(flight_id), kind, roi)

    async def plan_raster(self, plan_id: str, kind: RasterKind, roi: str | None) -> bytes:
        """The same of all flights of a plan together; raises as ``plan_coverage``."""
        return await self._desk.run("flight", raster_of, await self._sortie(plan_id), kind, roi)

    async def plan_coverage(self, plan_id: str) -> dict[str, Any]:
        """The ground that all flights of a plan saw together.

        Raises
        ------
        NotFoundError
            There is no such plan.
        ConflictError
            It is not done, or was not flown.
        """
        return await self._desk.run("flight", coverage_of, await self._sortie(plan_id))

    async def report(self, flight_id: str) -> str:
        """What was flown and seen, as one printable HTML page; raises as ``coverage``."""
        return await self._desk.run("flight", report_of, await self._alone(flight_id))

    async def refly(self, flight_id: str, here: tuple[float, float, float | None] | None) -> dict[str, Any]:
        """The scenario of what a flight and the others of its plan did not see.

        Parameters
        ----------
        here
            Longitude, latitude and course in degrees of the aircraft while it flies; None once it has landed.

        Raises
        ------
        ConflictError
            As ``coverage``, and when nothing worth a pass was missed.
        """
        record = await self._planned(flight_id)
        sortie = await self._sortie(str(record.plan_id))
        return await self._desk.run("flight", refly_of, sortie, record.plan_vehicle, here)

    async def plan_refly(self, plan_id: str) -> dict[str, Any]:
        """The scenario of what no flight of a plan saw; raises as ``plan_coverage`` and ``refly``."""
        return await self._desk.run("flight", refly_of, await self._sortie(plan_id), None, None)

    async def replan(self, plan_id: str, asked: Asked) -> dict[str, Any]:
        """The scenario of what is left of a plan while it is flown.

        Raises
        ------
        NotFoundError
            There is no such plan.
        ConflictError
            It is not done, nobody says where its aircraft are, or nothing is left.
        RefusedError
            What is told has no place in its scenario.
        """
        await self._planning.get(plan_id)
        records = await self._store.of_plan(plan_id)
        sortie = await self._flown(plan_id, records, "the plan has been deleted")
        return await self._desk.run("flight", replan_of, sortie, asked)

    async def fill(self, flight_id: str, name: str, data: bytes) -> dict[str, Any]:
        """Fill gaps of a flight's record from a log; sent again, there is nothing left to fill.

        Raises
        ------
        ConflictError
            The flight is under way, or nothing of it was recorded.
        RefusedError
            The log cannot be read, or is not of this flight.
        """
        record = await self._store.get(flight_id)
        samples = await self._store.track(flight_id)
        if record.state == "flying" or not samples:
            raise ConflictError("logs fill the records of flights that are over, where there is a record")
        behind_s = record.started_at.timestamp() - samples[0].time_s
        open_end = record.state == "interrupted" and not samples[-1].from_log
        with tempfile.NamedTemporaryFile(prefix="swathplan-log-") as file:
            await asyncio.to_thread(file.write, data)
            await asyncio.to_thread(file.flush)
            found = await self._desk.run(
                "log", filling, file.name, record.payload, samples, behind_s, open_end
            )
        if found.samples or found.events:
            await self._store.fill(flight_id, name, found.samples, found.events)
        return found.json()

    async def _planned(self, flight_id: str) -> FlightRecord:
        record = await self._store.get(flight_id)
        if record.plan_id is None:
            raise ConflictError("the flight followed no plan of this service")
        return record

    async def _alone(self, flight_id: str) -> Sortie:
        record = await self._planned(flight_id)
        return await self._flown(str(record.plan_id), (record,), "the flight's plan has been deleted")

    async def _sortie(self, plan_id: str) -> Sortie:
        await self._planning.get(plan_id)
        records = await self._store.of_plan(plan_id)
        if not records:
            raise ConflictError("no flight of this plan was recorded")
        return await self._flown(plan_id, records, "the plan has been deleted")

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

    async def _flown(self, plan_id: str, records: Sequence[FlightRecord], deleted: str) -> Sortie:
        try:
            plan_text = await self._planning.plan_text(plan_id)
            scenario_text = await self._planning.scenario_text(plan_id)
        except NotFoundError as error:
            raise ConflictError(deleted) from error
        flown = []
        for record in records:
            samples, photos, events = await self._as_recorded(record)
            flown.append(Flown(record, samples, photos, events))
        return Sortie(plan_id, plan_text, scenario_text, tuple(flown), self._planning.terrain_folder)
