"""All services of one process, opened and closed together."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Callable, Mapping
from concurrent.futures import Future
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import structlog

from app.services import work
from app.services.planning import PlanningService, Task
from app.services.pool import WorkerPool
from app.services.store.database import Database
from app.services.store.plans import PlanStore
from app.services.validation import Verdict, judge

log = structlog.get_logger(__name__)


@dataclass(frozen=True, slots=True)
class Limits:
    """How much the services take on."""

    database: Path
    workers: int
    plan_time_limit_s: float
    max_queued_plans: int
    track_interval_s: float


class House:
    """The services, wired."""

    def __init__(
        self,
        limits: Limits,
        *,
        task: Task = work.plan_scenario,
        judge_scenario: Callable[[Mapping[str, Any]], Verdict] = judge,
        initialiser: Callable[[], None] = work.initialise,
    ) -> None:
        self.database = Database(limits.database)
        self.pool = WorkerPool(limits.workers, initialiser)
        self.planning = PlanningService(
            PlanStore(self.database),
            self.pool,
            workers=limits.workers,
            time_limit_s=limits.plan_time_limit_s,
            max_queued=limits.max_queued_plans,
            task=task,
            judge_scenario=judge_scenario,
        )
        self._warm: Future[int] | None = None

    async def open(self) -> None:
        """Open the database, start the workers, take up waiting plans."""
        await self.database.open()
        self._warm = self.pool.warm()
        await self.planning.start()

    async def close(self) -> None:
        """Stop everything, in the opposite order."""
        with contextlib.suppress(asyncio.CancelledError):
            await self.planning.stop()
        await self.pool.stop()
        await self.database.close()

    @property
    def workers_ready(self) -> bool:
        """Whether a planning process has its kernels compiled."""
        return self._warm is not None and self._warm.done() and self._warm.exception() is None
