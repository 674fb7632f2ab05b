"""Flights and their tracks in the database."""

from __future__ import annotations

import uuid
from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import asdict, replace
from datetime import datetime
from typing import Any, cast

from sqlalchemy import ColumnElement, Select, func, insert, select, update

from app.services.errors import NotFoundError
from app.services.records import (
    FlightEvent,
    FlightRecord,
    FlightState,
    FlownEnergy,
    LinkEvent,
    SensorAction,
    TrackSample,
)
from app.services.store.database import Database
from app.services.store.plans import now
from app.services.store.tables import FlightEventRow, FlightRow, TrackPointRow

#: A log's place so near in time tells of the sensor at one heard.
TOLD_BY_LOG_S = 1.0


def _records() -> Select[FlightRow, int, int]:
    points: ColumnElement[int] = (
        select(func.count()).where(TrackPointRow.flight_id == FlightRow.id).scalar_subquery()
    )
    photos: ColumnElement[int] = (
        select(func.count())
        .where(FlightEventRow.flight_id == FlightRow.id, FlightEventRow.kind == "photo")
        .scalar_subquery()
    )
    return select(FlightRow, points, photos)


def _record(row: FlightRow, points: int, photos: int) -> FlightRecord:
    return FlightRecord(
        id=row.id,
        vehicle_id=row.vehicle_id,
        vehicle_name=row.vehicle_name,
        plan_id=row.plan_id,
        plan_vehicle=row.plan_vehicle,
        state=cast(FlightState, row.state),
        started_at=row.started_at,
        ended_at=row.ended_at,
        points=points,
        payload=row.payload,
        photos=photos,
        actions=tuple(
            SensorAction(**(kept | {"at": datetime.fromisoformat(kept["at"])})) for kept in row.actions or ()
        ),
        energy=None if row.energy is None else FlownEnergy(**row.energy),
        logs=tuple(row.logs or ()),
        plan_sortie=row.plan_sortie or 1,
        link=tuple(
            LinkEvent(**(kept | {"at": datetime.fromisoformat(kept["at"])})) for kept in row.link or ()
        ),
    )


def _merged(rows: Sequence[TrackSample]) -> tuple[TrackSample, ...]:
    """Places of onboard logs among those heard, by time; the time goes back where the clock began anew.

    Where nothing heard told of the sensor, the log's nearest place does.
    """
    heard = [row for row in rows if not row.from_log]
    logged = sorted((row for row in rows if row.from_log), key=lambda row: row.time_s)
    if not logged:
        return tuple(rows)
    boots: list[list[TrackSample]] = [[]]
    for row in heard:
        if boots[-1] and row.time_s < boots[-1][-1].time_s:
            boots.append([])
        boots[-1].append(row)

    def away_s(boot: Sequence[TrackSample], time_s: float) -> float:
        return max(boot[0].time_s - time_s, time_s - boot[-1].time_s, 0.0) if boot else 0.0

    for row in logged:
        min(boots, key=lambda boot: away_s(boot, row.time_s)).append(row)
    return tuple(row for boot in boots for row in _told(sorted(boot, key=lambda row: row.time_s)))


def _told(rows: Sequence[TrackSample]) -> list[TrackSample]:
    """Places in order of time, with the sensor as the log's nearest says where nothing else does."""
    logged = [row for row in rows if row.from_log]
    times_s = [row.time_s for row in logged]
    made = []
    for row in rows:
        if row.sensor_on is None and not row.from_log:
            at = bisect_left(times_s, row.time_s)
            near = min(logged[max(at - 1, 0) : at + 1], key=lambda k: abs(k.time_s - row.time_s), default=row)
            if abs(near.time_s - row.time_s) <= TOLD_BY_LOG_S:
                row = replace(row, sensor_on=near.sensor_on)
        made.append(row)
    return made


def _rows(flight_id: str, values: Sequence[TrackSample] | Sequence[FlightEvent]) -> list[dict[str, Any]]:
    return [{"flight_id": flight_id} | asdict(value) | _sensor(value) for value in values]


def _sensor(value: TrackSample | FlightEvent) -> dict[str, bool]:
    """A place's sensor as two columns: the first has a value where nothing told of it, too."""
    if isinstance(value, FlightEvent):
        return {}
    return {"sensor_on": bool(value.sensor_on), "sensor_untold": value.sensor_on is None}


class FlightStore:
    """Flights: begun, added to, ended, read."""

    def __init__(self, database: Database) -> None:
        self._database = database

    async def begin(
        self,
        vehicle_id: str,
        vehicle_name: str,
        plan_id: str | None,
        plan_vehicle: str | None,
        payload: str | None = None,
        started_at: datetime | None = None,
        plan_sortie: int = 1,
    ) -> str:
        """A new flight; returns its id. It starts now, unless it was flown at another time."""
        flight_id = str(uuid.uuid4())
        async with self._database.writing() as session:
            session.add(
                FlightRow(
                    id=flight_id,
                    vehicle_id=vehicle_id,
                    vehicle_name=vehicle_name,
                    plan_id=plan_id,
                    plan_vehicle=plan_vehicle,
                    plan_sortie=plan_sortie,
                    payload=payload,
                    state="flying",
                    started_at=started_at or now(),
                )
            )
        return flight_id

    async def add(self, flight_id: str, samples: Sequence[TrackSample]) -> None:
        """Append to a flight's track."""
        if samples:
            async with self._database.writing() as session:
                await session.execute(insert(TrackPointRow), _rows(flight_id, samples))

    async def add_events(self, flight_id: str, events: Sequence[FlightEvent]) -> None:
        """Append photos and switches."""
        if events:
            async with self._database.writing() as session:
                await session.execute(insert(FlightEventRow), _rows(flight_id, events))

    async def act(self, flight_id: str, action: SensorAction) -> None:
        """Append what the service did by itself; a flight that has just ended takes it too."""
        async with self._database.writing() as session:
            row = await session.scalar(select(FlightRow).where(FlightRow.id == flight_id))
            if row is not None:
                row.actions = [*(row.actions or ()), asdict(action) | {"at": action.at.isoformat()}]

    async def end(
        self,
        flight_id: str,
        state: FlightState,
        samples: Sequence[TrackSample] = (),
        events: Sequence[FlightEvent] = (),
        ended_at: datetime | None = None,
        energy: FlownEnergy | None = None,
    ) -> None:
        """Close a flight, with the last of its track and its events, now or when it was flown."""
        async with self._database.writing() as session:
            if samples:
                await session.execute(insert(TrackPointRow), _rows(flight_id, samples))
            if events:
                await session.execute(insert(FlightEventRow), _rows(flight_id, events))
            values: dict[str, Any] = {"state": state, "ended_at": ended_at or now()}
            if energy is not None:
                values["energy"] = asdict(energy)
            await session.execute(
                update(FlightRow)
                .where(FlightRow.id == flight_id, FlightRow.state == "flying")
                .values(**values)
            )

    async def heard(self, flight_id: str, event: LinkEvent) -> None:
        """Append a loss of the link, or its end."""
        async with self._database.writing() as session:
            row = await session.scalar(select(FlightRow).where(FlightRow.id == flight_id))
            if row is not None:
                row.link = [*(row.link or ()), asdict(event) | {"at": event.at.isoformat()}]

    async def draw(self, flight_id: str, energy: FlownEnergy) -> None:
        """What a flight drew from its batteries so far."""
        async with self._database.writing() as session:
            await session.execute(
                update(FlightRow).where(FlightRow.id == flight_id).values(energy=asdict(energy))
            )

    async def fill(
        self, flight_id: str, name: str, samples: Sequence[TrackSample], events: Sequence[FlightEvent]
    ) -> None:
        """Places and events of an onboard log, in the gaps of a flight's track."""
        async with self._database.writing() as session:
            row = await session.scalar(select(FlightRow).where(FlightRow.id == flight_id))
            if row is None:
                raise NotFoundError("flight", flight_id)
            if samples:
                await session.execute(insert(TrackPointRow), _rows(flight_id, samples))
            if events:
                await session.execute(insert(FlightEventRow), _rows(flight_id, events))
            row.logs = [*(row.logs or ()), name]

    async def recover(self) -> None:
        """After a restart: flights nobody watched to their end are interrupted."""
        async with self._database.writing() as session:
            await session.execute(
                update(FlightRow)
                .where(FlightRow.state == "flying")
                .values(state="interrupted", ended_at=now())
            )

    async def newest(self, limit: int, offset: int, vehicle_id: str | None) -> tuple[FlightRecord, ...]:
        """Flights, newest first."""
        query = _records().order_by(FlightRow.number.desc()).limit(limit).offset(offset)
        if vehicle_id is not None:
            query = query.where(FlightRow.vehicle_id == vehicle_id)
        async with self._database.reading() as session:
            return tuple(_record(*found) for found in await session.execute(query))

    async def of_plan(self, plan_id: str) -> tuple[FlightRecord, ...]:
        """All flights of a plan, as they were begun."""
        query = _records().where(FlightRow.plan_id == plan_id).order_by(FlightRow.number)
        async with self._database.reading() as session:
            return tuple(_record(*found) for found in await session.execute(query))

    async def get(self, flight_id: str) -> FlightRecord:
        """One flight; raises NotFoundError."""
        async with self._database.reading() as session:
            found = (await session.execute(_records().where(FlightRow.id == flight_id))).first()
        if found is None:
            raise NotFoundError("flight", flight_id)
        return _record(*found)

    async def track(self, flight_id: str) -> tuple[TrackSample, ...]:
        """The recorded places in order."""
        query = (
            select(TrackPointRow).where(TrackPointRow.flight_id == flight_id).order_by(TrackPointRow.number)
        )
        async with self._database.reading() as session:
            rows = await session.scalars(query)
            return _merged(
                [
                    TrackSample(
                        time_s=row.time_s,
                        lon_deg=row.lon_deg,
                        lat_deg=row.lat_deg,
                        altitude_amsl_m=row.altitude_amsl_m,
                        altitude_home_m=row.altitude_home_m,
                        heading_deg=row.heading_deg,
                        roll_deg=row.roll_deg,
                        ground_speed_m_s=row.ground_speed_m_s,
                        mission_seq=row.mission_seq,
                        sensor_on=None if row.sensor_untold else row.sensor_on,
                        pitch_deg=row.pitch_deg,
                        from_log=bool(row.from_log),
                        mount_roll_deg=row.mount_roll_deg,
                        mount_pitch_deg=row.mount_pitch_deg,
                        mount_yaw_deg=row.mount_yaw_deg,
                    )
                    for row in rows
                ]
            )

    async def events(self, flight_id: str) -> tuple[FlightEvent, ...]:
        """Photos and switches in the order they were reported."""
        query = (
            select(FlightEventRow)
            .where(FlightEventRow.flight_id == flight_id)
            .order_by(FlightEventRow.number)
        )
        async with self._database.reading() as session:
            rows = await session.scalars(query)
            return tuple(
                FlightEvent(**{name: getattr(row, name) for name in FlightEvent.__slots__}) for row in rows
            )
