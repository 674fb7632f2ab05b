"""Plans as those read them who put them into vehicles: out of the database, worked on at a desk."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from app.services.desk import Desk
from app.services.errors import ConflictError
from app.services.records import PlanRecord
from app.services.store.plans import PlanStore

Made = TypeVar("Made")


class PlanLibrary:
    """Stored plans and scenarios.

    Their texts may be large, so nothing here parses one: functions of texts run at the desk.
    """

    def __init__(self, store: PlanStore, desk: Desk) -> None:
        self._store = store
        self._desk = desk

    async def get(self, plan_id: str) -> PlanRecord:
        """One plan's record; raises NotFoundError."""
        return await self._store.get(plan_id)

    async def newest(self, limit: int) -> tuple[PlanRecord, ...]:
        """Records, newest first."""
        return await self._store.newest(limit, 0, None)

    async def scenario_text(self, plan_id: str) -> str:
        """The scenario as it was sent."""
        return (await self._store.documents(plan_id))[0]

    async def plan_text(self, plan_id: str) -> str:
        """The plan as GeoJSON text; raises ConflictError while there is none."""
        record = await self._store.get(plan_id)
        _, plan = await self._store.documents(plan_id)
        if plan is None:
            reason = f": {record.error['detail']}" if record.error else ""
            raise ConflictError(f"plan {plan_id} is {record.state}, it has no plan{reason}")
        return plan

    async def worked(self, function: Callable[..., Made], *arguments: Any) -> Made:
        """The result of a function of texts, before other requests: an operator at a vehicle waits for it."""
        return await self._desk.run("plan", function, *arguments, urgent=True)
