"""Kept scenarios in the database."""

from __future__ import annotations

import uuid

from sqlalchemy import ColumnElement, and_, delete, func, select, update

from app.services.errors import ChangedError, NotFoundError
from app.services.records import KeptScenario
from app.services.store.database import Database
from app.services.store.plans import now
from app.services.store.tables import ScenarioRow


def _record(row: ScenarioRow) -> KeptScenario:
    return KeptScenario(
        id=row.id,
        name=row.name,
        revision=row.revision,
        scenario_hash=row.scenario_hash,
        created_at=row.created_at,
        changed_at=row.changed_at,
    )


class ScenarioStore:
    """Kept scenarios: added, read, changed from a revision on, deleted."""

    def __init__(self, database: Database) -> None:
        self._database = database

    async def add(self, name: str, document: str, scenario_hash: str) -> KeptScenario:
        """A new one, at revision 1."""
        moment = now()
        row = ScenarioRow(
            id=str(uuid.uuid4()),
            name=name,
            revision=1,
            scenario_hash=scenario_hash,
            document=document,
            created_at=moment,
            changed_at=moment,
        )
        async with self._database.writing() as session:
            session.add(row)
        return _record(row)

    async def read(self, scenario_id: str) -> tuple[KeptScenario, str]:
        """One and its text; raises NotFoundError."""
        async with self._database.reading() as session:
            row = await session.scalar(select(ScenarioRow).where(ScenarioRow.id == scenario_id))
        if row is None:
            raise NotFoundError("scenario", scenario_id)
        return _record(row), row.document

    async def newest(self, limit: int, offset: int) -> tuple[KeptScenario, ...]:
        """The one changed last first."""
        query = (
            select(ScenarioRow)
            .order_by(ScenarioRow.changed_at.desc(), ScenarioRow.number.desc())
            .limit(limit)
            .offset(offset)
        )
        async with self._database.reading() as session:
            return tuple(_record(row) for row in await session.scalars(query))

    async def count(self) -> int:
        """How many there are."""
        async with self._database.reading() as session:
            return await session.scalar(select(func.count()).select_from(ScenarioRow)) or 0

    async def change(
        self, scenario_id: str, name: str, document: str, scenario_hash: str, revision: int | None
    ) -> KeptScenario:
        """Another text, at the next revision; the same text changes nothing.

        Parameters
        ----------
        revision
            The one it must still be at; None for any.

        Raises
        ------
        NotFoundError
            There is none of this id.
        ChangedError
            It is at another revision, with another text than this.
        """
        async with self._database.writing() as session:
            other = ScenarioRow.scenario_hash != scenario_hash
            changed = await session.scalar(
                update(ScenarioRow)
                .where(_at(scenario_id, revision), other)
                .values(
                    name=name,
                    document=document,
                    scenario_hash=scenario_hash,
                    revision=ScenarioRow.revision + 1,
                    changed_at=now(),
                )
                .returning(ScenarioRow)
            )
            if changed is not None:
                return _record(changed)
        record, _ = await self.read(scenario_id)
        if record.scenario_hash != scenario_hash:
            raise _changed(record, revision)
        return record

    async def delete(self, scenario_id: str, revision: int | None) -> None:
        """Forget one; raises as ``change``."""
        async with self._database.writing() as session:
            query = delete(ScenarioRow).where(_at(scenario_id, revision)).returning(ScenarioRow.id)
            result = await session.execute(query)
            if result.first() is not None:
                return
        record, _ = await self.read(scenario_id)
        raise _changed(record, revision)


def _at(scenario_id: str, revision: int | None) -> ColumnElement[bool]:
    """The scenario of an id, at a revision or, without one, at any."""
    whichever = ScenarioRow.id == scenario_id
    return whichever if revision is None else and_(whichever, ScenarioRow.revision == revision)


def _changed(record: KeptScenario, revision: int | None) -> ChangedError:
    return ChangedError(
        f"{record.name} is at revision {record.revision} and was read at {revision}: somebody else has "
        "changed it since; read it again, or keep yours as a scenario of its own"
    )
