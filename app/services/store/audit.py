"""The table of what was ordered of vehicles; rows are added and completed, never deleted."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from typing import cast

from sqlalchemy import Select, func, select, update

from app.services.pages import total_of
from app.services.records import AuditEntry, AuditKind
from app.services.store.database import Database
from app.services.store.plans import now
from app.services.store.tables import AuditRow


@dataclass(frozen=True, slots=True)
class AuditFilter:
    """Which entries are meant; None: whichever.

    Parameters
    ----------
    vehicle
        Its id, or its name.
    since, until
        Entries begun at or after, and before.
    """

    vehicle: str | None = None
    kind: AuditKind | None = None
    since: datetime | None = None
    until: datetime | None = None

    def of(self, query: Select[AuditRow]) -> Select[AuditRow]:
        """A query of these alone."""
        for condition in (
            None
            if self.vehicle is None
            else (AuditRow.vehicle_id == self.vehicle) | (AuditRow.vehicle_name == self.vehicle),
            None if self.kind is None else AuditRow.kind == self.kind,
            None if self.since is None else AuditRow.at >= self.since,
            None if self.until is None else AuditRow.at < self.until,
        ):
            query = query if condition is None else query.where(condition)
        return query


def _entry(row: AuditRow) -> AuditEntry:
    return AuditEntry(
        number=row.number,
        at=row.at,
        actor=row.actor,
        kind=cast(AuditKind, row.kind),
        vehicle_id=row.vehicle_id,
        vehicle_name=row.vehicle_name,
        what=row.what,
        outcome=row.outcome,
        reason=row.reason,
        ended_at=row.ended_at,
    )


class AuditStore:
    """Entries: added, completed, read."""

    def __init__(self, database: Database) -> None:
        self._database = database

    async def add(self, entry: AuditEntry) -> int:
        """A new entry; returns its number."""
        row = AuditRow(
            at=entry.at,
            actor=entry.actor,
            kind=entry.kind,
            vehicle_id=entry.vehicle_id,
            vehicle_name=entry.vehicle_name,
            what=dict(entry.what),
            outcome=entry.outcome,
            reason=entry.reason,
            ended_at=entry.ended_at,
        )
        async with self._database.writing() as session:
            session.add(row)
        return row.number

    async def complete(self, entry: AuditEntry) -> None:
        """What became of one."""
        async with self._database.writing() as session:
            await session.execute(
                update(AuditRow)
                .where(AuditRow.number == entry.number)
                .values(outcome=entry.outcome, reason=entry.reason, ended_at=entry.ended_at)
            )

    async def recover(self, reason: str) -> None:
        """After a restart: nobody can tell what became of what was pending."""
        async with self._database.writing() as session:
            await session.execute(
                update(AuditRow)
                .where(AuditRow.outcome == "pending")
                .values(outcome="unknown", reason=reason, ended_at=now())
            )

    async def newest(self, which: AuditFilter, limit: int, offset: int) -> tuple[tuple[AuditEntry, ...], int]:
        """Entries, newest first, and how many there are."""
        query = which.of(select(AuditRow))
        async with self._database.reading() as session:
            rows = await session.scalars(query.order_by(AuditRow.number.desc()).limit(limit).offset(offset))
            entries = tuple(_entry(row) for row in rows)

            async def count() -> int:
                return await session.scalar(select(func.count()).select_from(query.subquery())) or 0

            total = await total_of(len(entries), limit, offset, count)
        return entries, total
