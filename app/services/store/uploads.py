"""The log of uploads: what was meant for a vehicle, how it ended, who overrode what."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from sqlalchemy import select, update

from app.services.records import HeldMission, LeftUpload
from app.services.store.database import Database
from app.services.store.plans import now
from app.services.store.tables import UploadRow


class UploadStore:
    """Uploads: begun, ended, never forgotten."""

    def __init__(self, database: Database) -> None:
        self._database = database

    async def begin(
        self,
        vehicle_id: str,
        vehicle_name: str,
        plan_id: str,
        parts: Sequence[str],
        override_reason: str | None,
        meant: HeldMission,
    ) -> int:
        """A new upload of what is meant to be held; returns its number."""
        row = UploadRow(
            vehicle_id=vehicle_id,
            vehicle_name=vehicle_name,
            plan_id=plan_id,
            parts=list(parts),
            outcome="pending",
            override_reason=override_reason,
            detail={
                "plan_vehicle": meant.plan_vehicle,
                "payload": meant.payload,
                "gimbal": meant.gimbal,
                "arcs": meant.arcs,
                "chord_error_m": meant.chord_error_m,
                "sortie": meant.sortie,
            },
            started_at=now(),
        )
        async with self._database.writing() as session:
            session.add(row)
        return row.number

    async def end(self, number: int, outcome: str, detail: dict[str, Any]) -> None:
        """How it ended: ``accepted``, ``refused`` or ``unknown``; later ``unknown`` may be resolved."""
        async with self._database.writing() as session:
            await session.execute(
                update(UploadRow)
                .where(UploadRow.number == number)
                .values(outcome=outcome, detail=detail, ended_at=now())
            )

    async def pending(self) -> tuple[LeftUpload, ...]:
        """Those without an outcome, oldest first."""
        query = select(UploadRow).where(UploadRow.outcome == "pending").order_by(UploadRow.number)
        async with self._database.reading() as session:
            return tuple(
                LeftUpload(
                    row.number,
                    row.vehicle_id,
                    tuple(row.parts),
                    HeldMission(
                        row.plan_id,
                        row.detail.get("plan_vehicle") or "",
                        row.detail.get("payload"),
                        row.detail.get("gimbal"),
                        row.detail.get("arcs"),
                        row.detail.get("chord_error_m"),
                        row.detail.get("sortie") or 1,
                    ),
                    row.override_reason,
                )
                for row in await session.scalars(query)
            )

    async def of_vehicle(self, vehicle_id: str, limit: int = 50) -> tuple[dict[str, Any], ...]:
        """The newest uploads to a vehicle."""
        query = (
            select(UploadRow)
            .where(UploadRow.vehicle_id == vehicle_id)
            .order_by(UploadRow.number.desc())
            .limit(limit)
        )
        async with self._database.reading() as session:
            return tuple(
                {
                    "number": row.number,
                    "plan_id": row.plan_id,
                    "parts": row.parts,
                    "outcome": row.outcome,
                    "override_reason": row.override_reason,
                    "detail": row.detail,
                    "started_at": row.started_at,
                    "ended_at": row.ended_at,
                }
                for row in await session.scalars(query)
            )
