"""Plans in the database."""

from __future__ import annotations

import uuid
from collections.abc import Sequence
from dataclasses import asdict
from datetime import UTC, datetime
from typing import Any, cast

from sqlalchemy import ColumnElement, Select, delete, func, select, update
from sqlalchemy.exc import IntegrityError

from app.services.errors import ConflictError, NotFoundError, OverloadedError, StorageError
from app.services.records import PlanRecord, PlanState
from app.services.store.database import Database
from app.services.store.tables import PlanDocumentRow, PlanRow, ScenarioRow
from app.services.store.unwritten import Failure, Unwritten

#: When to come again where too many plans wait, seconds.
_RETRY_AFTER_S = 10


def now() -> datetime:
    """The present moment."""
    return datetime.now(UTC)


def _records() -> Select[PlanRow, str]:
    """Plans, each with the present hash of the kept scenario it was made of."""
    return select(PlanRow, ScenarioRow.scenario_hash).outerjoin(
        ScenarioRow, ScenarioRow.id == PlanRow.scenario_id
    )


def _record(row: PlanRow, kept_hash: str | None) -> PlanRecord:
    return PlanRecord(
        id=row.id,
        name=row.name,
        state=cast(PlanState, row.state),
        stage=row.stage,
        progress=row.progress,
        created_at=row.created_at,
        started_at=row.started_at,
        ended_at=row.ended_at,
        warnings=tuple(row.warnings),
        summary=row.summary,
        error=row.error,
        scenario_id=row.scenario_id,
        scenario_hash=row.scenario_hash,
        kept_hash=kept_hash,
    )


class PlanStore:
    """Plans: added, moved from state to state, read, deleted."""

    def __init__(self, database: Database) -> None:
        self._database = database
        self._unwritten = Unwritten()

    async def add(
        self,
        name: str,
        scenario: str,
        body_sha256: str,
        warnings: Sequence[dict[str, Any]],
        key: str | None,
        scenario_id: str | None,
        scenario_hash: str,
        most_queued: int,
    ) -> PlanRecord:
        """A new queued plan.

        Raises
        ------
        ConflictError
            The idempotency key has been used meanwhile.
        OverloadedError
            So many plans are queued already, however many are posted at once.
        """
        row = PlanRow(
            id=str(uuid.uuid4()),
            name=name,
            state="queued",
            progress=0.0,
            created_at=now(),
            idempotency_key=key,
            body_sha256=body_sha256,
            warnings=list(warnings),
            scenario_id=scenario_id,
            scenario_hash=scenario_hash,
        )
        try:
            async with self._database.writing() as session:
                session.add(row)
                await session.flush()
                queued = select(func.count()).select_from(PlanRow).where(PlanRow.state == "queued")
                if (await session.scalar(queued) or 0) > most_queued:
                    raise OverloadedError("too many plans are waiting; try again later", _RETRY_AFTER_S)
                session.add(PlanDocumentRow(plan_id=row.id, scenario=scenario))
                found = (await session.execute(_records().where(PlanRow.id == row.id))).one()
                return _record(*found)
        except IntegrityError as error:
            raise ConflictError(f"the idempotency key {key} is in use") from error

    async def add_done(
        self,
        name: str,
        scenario: str,
        plan: str,
        body_sha256: str,
        warnings: Sequence[dict[str, Any]],
        scenario_id: str | None,
        scenario_hash: str,
        summary: dict[str, Any],
    ) -> PlanRecord:
        """A plan that was made elsewhere, and is done."""
        moment = now()
        row = PlanRow(
            id=str(uuid.uuid4()),
            name=name,
            state="done",
            stage="done",
            progress=1.0,
            created_at=moment,
            started_at=moment,
            ended_at=moment,
            body_sha256=body_sha256,
            warnings=list(warnings),
            scenario_id=scenario_id,
            scenario_hash=scenario_hash,
            summary=summary,
        )
        async with self._database.writing() as session:
            session.add(row)
            await session.flush()
            session.add(PlanDocumentRow(plan_id=row.id, scenario=scenario, plan=plan))
            found = (await session.execute(_records().where(PlanRow.id == row.id))).one()
            return _record(*found)

    async def by_key(self, key: str) -> tuple[PlanRecord, str] | None:
        """The plan an idempotency key stands for, and the digest of its scenario."""
        async with self._database.reading() as session:
            found = (await session.execute(_records().where(PlanRow.idempotency_key == key))).first()
        return None if found is None else (self._unwritten.seen(_record(*found)), found[0].body_sha256)

    async def get(self, plan_id: str) -> PlanRecord:
        """One plan; raises NotFoundError."""
        async with self._database.reading() as session:
            found = (await session.execute(_records().where(PlanRow.id == plan_id))).first()
        if found is None:
            raise NotFoundError("plan", plan_id)
        return self._unwritten.seen(_record(*found))

    async def newest(self, limit: int, offset: int = 0, state: str | None = None) -> tuple[PlanRecord, ...]:
        """Plans, newest first."""
        query = _records().order_by(PlanRow.number.desc()).limit(limit).offset(offset)
        if state is not None:
            query = query.where(self._is(state))
        async with self._database.reading() as session:
            return tuple(self._unwritten.seen(_record(*found)) for found in await session.execute(query))

    async def count(self, state: str | None = None) -> int:
        """How many plans there are, of one state or of all."""
        query = select(func.count()).select_from(PlanRow)
        if state is not None:
            query = query.where(self._is(state))
        async with self._database.reading() as session:
            return await session.scalar(query) or 0

    def _is(self, state: str) -> ColumnElement[bool]:
        """Whether a plan is in a state, whatever its row still says."""
        unwritten = PlanRow.id.in_(self._unwritten.ids)
        if state == "failed":
            return (PlanRow.state == state) | unwritten
        return (PlanRow.state == state) & ~unwritten

    async def documents(self, plan_id: str) -> tuple[str, str | None]:
        """Scenario and plan as JSON texts; raises NotFoundError."""
        async with self._database.reading() as session:
            row = await session.get(PlanDocumentRow, plan_id)
        if row is None:
            raise NotFoundError("plan", plan_id)
        return row.scenario, row.plan

    async def start(self, plan_id: str) -> bool:
        """Queued to running; False when it is not queued any more."""
        return await self._move(plan_id, ("queued",), state="running", started_at=now(), progress=0.0)

    async def requeue(self, plan_id: str) -> bool:
        """Running back to queued."""
        return await self._move(
            plan_id, ("running",), state="queued", started_at=None, stage=None, progress=0.0
        )

    async def done(self, plan_id: str, plan: str, summary: dict[str, Any]) -> bool:
        """Running to done, with its result; False when it was cancelled meanwhile."""
        async with self._database.writing() as session:
            result = await session.execute(
                update(PlanRow)
                .where(PlanRow.id == plan_id, PlanRow.state == "running")
                .values(state="done", stage="done", progress=1.0, ended_at=now(), summary=summary)
                .returning(PlanRow.id)
            )
            if result.first() is None:
                return False
            await session.execute(
                update(PlanDocumentRow).where(PlanDocumentRow.plan_id == plan_id).values(plan=plan)
            )
            return True

    async def bounded(self, plan_id: str, plan: str, summary: dict[str, Any]) -> bool:
        """A done plan once more, with its bound; False when it was deleted meanwhile."""
        async with self._database.writing() as session:
            result = await session.execute(
                update(PlanRow)
                .where(PlanRow.id == plan_id, PlanRow.state == "done")
                .values(summary=summary)
                .returning(PlanRow.id)
            )
            if result.first() is None:
                return False
            await session.execute(
                update(PlanDocumentRow).where(PlanDocumentRow.plan_id == plan_id).values(plan=plan)
            )
            return True

    async def fail(self, plan_id: str, error: dict[str, Any], stage: str | None, progress: float) -> bool:
        """Queued or running to failed, with the reason; it holds also where it cannot be written."""
        failure = Failure(error, stage, progress, now())
        try:
            return await self._write(plan_id, failure)
        except StorageError:
            self._unwritten.add(plan_id, failure)
            return True

    async def settle(self) -> tuple[str, ...]:
        """Write the failures that could not be written before; returns the ids of those that are now."""
        written = []
        for plan_id in self._unwritten.ids:
            try:
                await self._write(plan_id, self._unwritten.get(plan_id))
            except StorageError:
                break
            self._unwritten.drop(plan_id)
            written.append(plan_id)
        return tuple(written)

    @property
    def unsettled(self) -> bool:
        """Whether there are failures to write yet."""
        return bool(self._unwritten.ids)

    async def _write(self, plan_id: str, failure: Failure) -> bool:
        return await self._move(plan_id, ("queued", "running"), state="failed", **asdict(failure))

    async def cancel(self, plan_id: str) -> bool:
        """Queued or running to cancelled."""
        return await self._move(plan_id, ("queued", "running"), state="cancelled", ended_at=now())

    async def delete(self, plan_id: str) -> bool:
        """Remove an ended plan; False when it has not ended."""
        ended = PlanRow.state.in_(("done", "failed", "cancelled")) | PlanRow.id.in_(self._unwritten.ids)
        async with self._database.writing() as session:
            result = await session.execute(
                delete(PlanRow).where(PlanRow.id == plan_id, ended).returning(PlanRow.id)
            )
            found = result.first() is not None
        if found:
            self._unwritten.drop(plan_id)
        return found

    async def recover(self, error: dict[str, Any]) -> tuple[str, ...]:
        """After a crash: fail what was running, for a reason given; return what was queued, oldest first."""
        async with self._database.writing() as session:
            await session.execute(
                update(PlanRow)
                .where(PlanRow.state == "running")
                .values(state="failed", error=error, ended_at=now())
            )
            rows = await session.scalars(
                select(PlanRow.id).where(PlanRow.state == "queued").order_by(PlanRow.number)
            )
            return tuple(rows)

    async def _move(self, plan_id: str, states: tuple[str, ...], **values: Any) -> bool:
        async with self._database.writing() as session:
            result = await session.execute(
                update(PlanRow)
                .where(PlanRow.id == plan_id, PlanRow.state.in_(states))
                .values(**values)
                .returning(PlanRow.id)
            )
            return result.first() is not None
