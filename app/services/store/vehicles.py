"""Vehicles that were added, kept for the next start of the service."""

from __future__ import annotations

from typing import Any, cast

from sqlalchemy import delete, select, update

from app.services.records import HeldMission, SentMission, VehicleRecord
from app.services.store.database import Database
from app.services.store.tables import VehicleRow
from mavlink.encoding.options import Arcs
from mavlink.station.forward.address import ForwardAddress


def _record(row: VehicleRow) -> VehicleRecord:
    held = None
    if row.held_plan_id is not None and row.held_plan_vehicle is not None:
        held = HeldMission(
            row.held_plan_id,
            row.held_plan_vehicle,
            row.held_payload,
            row.held_gimbal,
            cast("Arcs | None", row.held_arcs),
            row.held_chord_error_m,
            row.held_sortie or 1,
        )
    sent = None if row.last_plan_id is None else SentMission(row.last_plan_id, row.last_list_id)
    forward = tuple(ForwardAddress(entry["url"], entry["write"]) for entry in row.forward or ())
    return VehicleRecord(row.id, row.name, row.url, row.created_at, held, sent, forward, row.system_id or 0)


def _forward_json(forward: tuple[ForwardAddress, ...]) -> list[dict[str, Any]]:
    return [{"url": address.url, "write": address.write} for address in forward]


class VehicleStore:
    """Vehicles: added, let go; and the plan each was last seen to hold."""

    def __init__(self, database: Database) -> None:
        self._database = database

    async def add(self, record: VehicleRecord) -> None:
        """A new vehicle."""
        row = VehicleRow(
            id=record.id,
            name=record.name,
            url=record.url,
            created_at=record.created_at,
            forward=_forward_json(record.forward),
            system_id=record.system_id or None,
        )
        async with self._database.writing() as session:
            session.add(row)

    async def all(self) -> tuple[VehicleRecord, ...]:
        """Every vehicle, oldest first."""
        async with self._database.reading() as session:
            rows = await session.scalars(select(VehicleRow).order_by(VehicleRow.number))
            return tuple(_record(row) for row in rows)

    async def hold(self, vehicle_id: str, held: HeldMission | None) -> None:
        """Note what a vehicle holds; nothing for one that is not kept."""
        values = {
            "held_plan_id": held.plan_id if held else None,
            "held_plan_vehicle": held.plan_vehicle if held else None,
            "held_payload": held.payload if held else None,
            "held_gimbal": held.gimbal if held else None,
            "held_arcs": held.arcs if held else None,
            "held_chord_error_m": held.chord_error_m if held else None,
            "held_sortie": held.sortie if held else None,
        }
        async with self._database.writing() as session:
            await session.execute(update(VehicleRow).where(VehicleRow.id == vehicle_id).values(**values))

    async def send(self, vehicle_id: str, sent: SentMission | None) -> None:
        """Note what a vehicle was sent last; None once it was cleared from here."""
        values = {
            "last_plan_id": sent.plan_id if sent else None,
            "last_list_id": sent.list_id if sent else None,
        }
        async with self._database.writing() as session:
            await session.execute(update(VehicleRow).where(VehicleRow.id == vehicle_id).values(**values))

    async def forward(self, vehicle_id: str, forward: tuple[ForwardAddress, ...]) -> None:
        """Note where a vehicle's link is forwarded to."""
        values = {"forward": _forward_json(forward)}
        async with self._database.writing() as session:
            await session.execute(update(VehicleRow).where(VehicleRow.id == vehicle_id).values(**values))

    async def identify(self, vehicle_id: str, system_id: int) -> None:
        """Note which system a vehicle is."""
        values = {"system_id": system_id}
        async with self._database.writing() as session:
            await session.execute(update(VehicleRow).where(VehicleRow.id == vehicle_id).values(**values))

    async def forget(self, vehicle_id: str) -> None:
        """Let one go; nothing for one that is not kept."""
        async with self._database.writing() as session:
            await session.execute(delete(VehicleRow).where(VehicleRow.id == vehicle_id))
