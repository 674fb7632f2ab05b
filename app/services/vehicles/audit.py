"""What is ordered of vehicles, written before it is sent and completed with what became of it.

What cannot be written is not sent, but for what makes an aircraft safe: a full disk must not hold that up. It
goes out at once, its entry is written as soon as the database takes it, and the answer says so.
"""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Mapping
from dataclasses import replace
from datetime import UTC, datetime
from typing import Any, Final

import structlog

from app.services.errors import StorageError
from app.services.records import AuditEntry, AuditKind
from app.services.store.audit import AuditStore

log = structlog.get_logger(__name__)

#: Whoever orders, until the service knows users; and the service by itself.
LOCAL: Final = "local"
SERVICE: Final = "service"
#: So long the database is waited for: before what makes safe goes out all the same, and before other orders
#: are refused, seconds.
SAFE_WAIT_S, WAIT_S = 0.03, 3.0
#: How often what could not be written is tried again, seconds.
RETRY_S = 1.0


class Entry:
    """One entry as it stands, written or not."""

    def __init__(self, values: AuditEntry) -> None:
        self.values = values
        self.stored: AuditEntry | None = None

    @property
    def unrecorded(self) -> str | None:
        """That it is not written yet, in words; None once it is."""
        if self.stored is not None:
            return None
        return "its entry in the audit could not be written yet; it is tried again until it can"


class Audit:
    """Entries of one service: begun before anything is sent, ended with the outcome."""

    def __init__(self, store: AuditStore) -> None:
        self._store = store
        self._waiting: list[Entry] = []
        self._turn = asyncio.Lock()
        self._writer: asyncio.Task[None] | None = None
        self._failing = False

    async def open(self) -> None:
        """Say of what an earlier service left pending that nobody can tell."""
        await self._store.recover("the service ended before it was settled; it may have been carried out")

    async def close(self) -> None:
        """Write what waits, once more; the log has what the database does not take."""
        if self._writer is not None:
            self._writer.cancel()
            await asyncio.gather(self._writer, return_exceptions=True)
        with contextlib.suppress(StorageError):
            await self._write_waiting()
        for entry in self._waiting:
            log.error("not in the audit", entry=str(entry.values))

    async def begin(
        self, kind: AuditKind, vehicle_id: str, vehicle_name: str, what: Mapping[str, Any], actor: str = LOCAL
    ) -> Entry:
        """Write an entry before what it is about is sent.

        Raises
        ------
        StorageError
            It cannot be written: nothing must be sent.
        """
        entry = self._new(kind, vehicle_id, vehicle_name, what, actor)
        writing = self._write_soon(entry)
        try:
            await asyncio.wait((writing,), timeout=WAIT_S)
        except asyncio.CancelledError:
            self.end(entry, "refused", "not sent: it was given up")
            raise
        if entry.stored is not None:
            return entry
        self.end(entry, "refused", "not sent: it could not be recorded")
        reason = "the database does not answer"
        if writing.done() and not writing.cancelled() and (error := writing.exception()) is not None:
            reason = str(error)
        raise StorageError(f"{vehicle_name}: not sent, as it cannot be recorded: {reason}")

    async def begin_safe(
        self, kind: AuditKind, vehicle_id: str, vehicle_name: str, what: Mapping[str, Any], actor: str = LOCAL
    ) -> Entry:
        """The same for what makes safe: it waits for the database a moment only, and never fails."""
        entry = self._new(kind, vehicle_id, vehicle_name, what, actor)
        await asyncio.wait((self._write_soon(entry),), timeout=SAFE_WAIT_S)
        return entry

    def end(self, entry: Entry, outcome: str, reason: str = "") -> None:
        """Complete an entry, as soon as the database takes it; what is known of it once stands."""
        if entry.values.outcome in ("pending", "unknown"):
            entry.values = replace(entry.values, outcome=outcome, reason=reason, ended_at=datetime.now(UTC))
            self._write_soon(entry)

    def _new(
        self, kind: AuditKind, vehicle_id: str, vehicle_name: str, what: Mapping[str, Any], actor: str
    ) -> Entry:
        moment = datetime.now(UTC)
        return Entry(AuditEntry(0, moment, actor, kind, vehicle_id, vehicle_name, what, "pending", "", None))

    def _write_soon(self, entry: Entry) -> asyncio.Task[None]:
        if entry not in self._waiting:
            self._waiting.append(entry)
        if self._writer is None or self._writer.done():
            self._writer = asyncio.create_task(self._keep_writing())
        return asyncio.create_task(self._write_waiting())

    async def _keep_writing(self) -> None:
        """Try again until nothing waits."""
        while self._waiting:
            await asyncio.sleep(RETRY_S)
            with contextlib.suppress(StorageError):
                await self._write_waiting()

    async def _write_waiting(self) -> None:
        async with self._turn:
            while self._waiting:
                entry = self._waiting[0]
                values = entry.values
                try:
                    if entry.stored is None:
                        values = replace(values, number=await self._store.add(values))
                    else:
                        values = replace(values, number=entry.stored.number)
                        await self._store.complete(values)
                except StorageError as error:
                    if not self._failing:
                        log.error("audit cannot be written", reason=str(error))
                    self._failing = True
                    raise
                self._failing = False
                entry.stored = values
                # Ended meanwhile, it is written once more.
                if values.outcome == entry.values.outcome:
                    self._waiting.remove(entry)
