"""Scenarios people are at work on: kept by the service, so that no page's memory is the only one."""

from __future__ import annotations

from app.services.desk import Desk
from app.services.records import KeptScenario
from app.services.scenarios.received import received
from app.services.store.scenarios import ScenarioStore


class ScenarioService:
    """Kept scenarios; none is judged before it is planned."""

    def __init__(self, store: ScenarioStore, desk: Desk) -> None:
        self._store = store
        self._desk = desk

    async def add(self, body: bytes) -> KeptScenario:
        """Keep a new one, sent as JSON."""
        kept = await self._desk.run("scenario", received, body)
        return await self._store.add(kept.name, kept.text, kept.scenario_hash)

    async def get(self, scenario_id: str) -> KeptScenario:
        """One without its text; raises NotFoundError."""
        return (await self._store.read(scenario_id))[0]

    async def read(self, scenario_id: str) -> tuple[KeptScenario, str]:
        """One and its text, as JSON; raises NotFoundError."""
        return await self._store.read(scenario_id)

    async def text(self, scenario_id: str) -> str:
        """The text of one; raises NotFoundError."""
        return (await self._store.read(scenario_id))[1]

    async def newest(self, limit: int, offset: int) -> tuple[KeptScenario, ...]:
        """Without their texts, the one changed last first."""
        return await self._store.newest(limit, offset)

    async def count(self) -> int:
        """How many there are."""
        return await self._store.count()

    async def change(self, scenario_id: str, body: bytes, revision: int | None) -> KeptScenario:
        """Put another text in its place.

        Parameters
        ----------
        revision
            The one the change was made to; None for whichever it is at.

        Raises
        ------
        NotFoundError
            There is none of this id.
        ChangedError
            Somebody else has changed it since that revision.
        """
        kept = await self._desk.run("scenario", received, body)
        return await self._store.change(scenario_id, kept.name, kept.text, kept.scenario_hash, revision)

    async def remove(self, scenario_id: str, revision: int | None) -> None:
        """Forget one; raises as ``change``."""
        await self._store.delete(scenario_id, revision)
